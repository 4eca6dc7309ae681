/* Picking in a scene with clip planes: caps, opened regions, exempt regions, cut slices. Expected hits come from the
 * intervals in which rays cross boxes and spheres. */
#include "core/pick/pick.h"
#include "core/scene/camera.h"
#include "core/scene/snapshot.h"
#include "tests/check.h"
#include "tests/derived_of.h"
#include "tests/made_plan.h"

enum { SIZE_PX = 64, N_SHELLS = 3 };

/* Nested shells around the origin, half sides or radii 15, 10 and 5 mm, in voxels of 1 mm with faces at whole
 * millimetres. */
static const double half_mm[N_SHELLS] = { 15, 10, 5 };
static double boxes(struct vec3 p)
{
    double r = fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z)));
    return r < 5 ? 3 : r < 10 ? 2 : r < 15 ? 1 : 0;
}
static double spheres(struct vec3 p)
{
    double r = vec3_length(p);
    return r < 5 ? 3 : r < 10 ? 2 : r < 15 ? 1 : 0;
}
static const struct made_region tree[] = { { "body", -1, 0xff0000 },
                                           { "organ", 0, 0x00ff00 },
                                           { "tumour", 1, 0x0000ff } };
static double grey(struct vec3 p)
{
    return 100 + p.x * 0;
}

static struct plan *shells(double (*label)(struct vec3 p))
{
    struct grid grid = made_cube_grid(40);
    struct plan *plan = made_plan(&grid, label, tree, N_SHELLS);
    made_plan_add_image(plan, &grid, VOXEL_U8, grey);
    return plan;
}

static uint32_t state_of_random;
static double random_in(double low, double high)
{
    state_of_random = state_of_random * 1664525u + 1013904223u;
    return low + (high - low) * (double)(state_of_random >> 8) / 16777216.0;
}
static struct vec3 random_direction(void)
{
    for (;;) {
        struct vec3 v = vec3(random_in(-1, 1), random_in(-1, 1), random_in(-1, 1));
        if (vec3_length(v) > 0.1 && vec3_length(v) < 1)
            return vec3_normalize(v);
    }
}

static struct scene_clip_style cut;
static bool is_exempt[N_SHELLS];
static bool is_slice_shown, is_slice_exempt;
static enum scene_representation drawn_as;

static struct snapshot *look(struct plan *plan, struct vec3 from)
{
    struct scene scene;
    struct view view = view_default;
    struct error err = { 0 };
    char field[128];
    scene_for_plan(plan, &scene);
    scene.image.slices.axial.visible = is_slice_shown;
    scene.image.slices.axial.position_mm = 2.5;
    scene.image.clipped = !is_slice_exempt;
    scene.image.cull_below = -1e12;
    scene.clip = cut;
    for (size_t i = 0; i < scene.n_regions; i++) {
        scene.regions[i].value.clipped = !is_exempt[i];
        scene.regions[i].value.representation = drawn_as;
    }
    view.size_px[0] = view.size_px[1] = SIZE_PX;
    view.camera.has_position_mm = view.camera.has_target_mm = true;
    view.camera.position_mm = from;
    struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err);
    assert_string_equal(err.text, "");
    return snapshot;
}

static void reset(void **state)
{
    (void)state;
    cut = scene_default.clip;
    memset(is_exempt, 0, sizeof is_exempt);
    is_slice_shown = is_slice_exempt = false;
    drawn_as = SCENE_REPRESENTATION_SURFACE;
    state_of_random = 7;
}

/* Half-spaces that a random cut keeps: normal . p <= position. */
struct kept {
    struct vec3 normal[3];
    double position_mm[3];
    bool is_capped[3];
    int n;
};

static struct kept random_cut(void)
{
    struct kept kept = { .n = 0 };
    struct vec3 normal = random_direction();
    double position = random_in(-8, 8);
    cut = scene_default.clip;
    cut.free = (struct scene_clip_free){ true, vec3_scale(normal, position), normal, random_in(0, 1) < 0.7 };
    kept.normal[kept.n] = normal;
    kept.position_mm[kept.n] = position;
    kept.is_capped[kept.n++] = cut.free.cap;
    if (random_in(0, 1) < 0.5) {
        cut.axial_high = (struct scene_clip_axis){ true, random_in(-8, 8), random_in(0, 1) < 0.7 };
        kept.normal[kept.n] = vec3(0, 0, 1);
        kept.position_mm[kept.n] = cut.axial_high.position_mm;
        kept.is_capped[kept.n++] = cut.axial_high.cap;
    }
    if (random_in(0, 1) < 0.5) {
        cut.sagittal_low = (struct scene_clip_axis){ true, random_in(-8, 8), random_in(0, 1) < 0.7 };
        kept.normal[kept.n] = vec3(-1, 0, 0);
        kept.position_mm[kept.n] = -cut.sagittal_low.position_mm;
        kept.is_capped[kept.n++] = cut.sagittal_low.cap;
    }
    return kept;
}

struct line {
    struct vec3 from, along;
};

static struct line line_of(const struct snapshot *snapshot, double px, double py)
{
    struct camera camera;
    camera_resolve(snapshot, &camera);
    struct vec3 far = mat4_project(&camera.lps_mm_from_clip, vec3(2 * px / SIZE_PX - 1, 1 - 2 * py / SIZE_PX, 1));
    return (struct line){ camera.eye_lps_mm, vec3_normalize(vec3_sub(far, camera.eye_lps_mm)) };
}

/* An interval of a line, and the plane it starts and ends at; -1: none. */
struct interval {
    double low, high;
    int from, to;
};

static struct interval kept_interval(const struct line *line, const struct kept *kept)
{
    struct interval found = { 0, 1e9, -1, -1 };
    for (int i = 0; i < kept->n; i++) {
        double rise = vec3_dot(line->along, kept->normal[i]);
        double at = (kept->position_mm[i] - vec3_dot(line->from, kept->normal[i])) / rise;
        if (rise < 0 && at > found.low) {
            found.low = at;
            found.from = i;
        } else if (rise > 0 && at < found.high) {
            found.high = at;
            found.to = i;
        }
    }
    return found;
}

/* Where the line is inside the box of this half side. */
static struct interval box_interval(const struct line *line, double half)
{
    const double o[3] = { line->from.x, line->from.y, line->from.z },
                 d[3] = { line->along.x, line->along.y, line->along.z };
    struct interval found = { -1e9, 1e9, -1, -1 };
    for (int a = 0; a < 3; a++) {
        double t = (-half - o[a]) / d[a], u = (half - o[a]) / d[a];
        found.low = fmax(found.low, fmin(t, u));
        found.high = fmin(found.high, fmax(t, u));
    }
    return found;
}

static struct interval ball_interval(const struct line *line, double radius)
{
    double middle = -vec3_dot(line->from, line->along);
    double aside_squared = vec3_dot(line->from, line->from) - middle * middle;
    if (aside_squared >= radius * radius)
        return (struct interval){ 1, 0, -1, -1 };
    double half = sqrt(radius * radius - aside_squared);
    return (struct interval){ middle - half, middle + half, -1, -1 };
}

/* Expected hits of one region: at most a wall and a cap. */
struct expected {
    double wall_mm, cap_mm; /* from the eye; 0: none */
};

static struct expected expect(const struct interval *kept, const struct interval *solid, const struct kept *planes)
{
    struct expected found = { 0, 0 };
    double low = fmax(kept->low, solid->low), high = fmin(kept->high, solid->high);
    if (low >= high)
        return found;
    bool is_entered = solid->low > kept->low, is_left = solid->high < kept->high;
    if (is_entered)
        found.wall_mm = solid->low;
    else if (planes->is_capped[kept->from])
        return (struct expected){ 0, kept->low };
    else if (is_left)
        found.wall_mm = solid->high;
    if (!is_left && planes->is_capped[kept->to])
        found.cap_mm = kept->high;
    return found;
}

/* Finds the hit of a region on a wall or a cap. */
static const struct pick_hit *find_hit(const struct pick_hit *hits, size_t n, size_t region, bool is_cap)
{
    for (size_t i = 0; i < n; i++)
        if (hits[i].subject.kind == SUBJECT_REGION && hits[i].subject.index == region && hits[i].is_on_cap == is_cap)
            return &hits[i];
    return NULL;
}

static void compare_hit(const struct pick_hit *hit, double expected_mm, double tolerance_mm)
{
    assert_int_equal(hit != NULL, expected_mm > 0);
    if (hit)
        assert_close(hit->distance_mm, expected_mm, tolerance_mm);
}

static void every_pixel_of_cut_boxes_hits_the_computed_walls_and_caps(void **state)
{
    reset(state);
    struct plan *plan = shells(boxes);
    int n_caps = 0, n_opened = 0, n_exempt = 0;
    for (int i = 0; i < 60; i++) {
        struct kept kept = random_cut();
        for (int r = 0; r < N_SHELLS; r++)
            is_exempt[r] = random_in(0, 1) < 0.2;
        drawn_as = i % 2 ? SCENE_REPRESENTATION_UNIVELS : SCENE_REPRESENTATION_SURFACE;
        struct snapshot *snapshot = look(plan, vec3_scale(random_direction(), 90));
        for (int pixel = 0; pixel < 40; pixel++) {
            double px = random_in(0, SIZE_PX), py = random_in(0, SIZE_PX);
            struct pick_hit hits[PICK_MAX_HITS];
            size_t n = snapshot_pick(snapshot, px, py, hits), n_expected = 0;
            struct line line = line_of(snapshot, px, py);
            struct interval range = kept_interval(&line, &kept), whole = { 0, 1e9, -1, -1 };
            for (size_t r = 0; r < N_SHELLS; r++) {
                struct interval solid = box_interval(&line, half_mm[r]);
                struct expected found = expect(is_exempt[r] ? &whole : &range, &solid, &kept);
                /* exact boxes: what is left are sums in double precision, 90 mm from the eye */
                compare_hit(find_hit(hits, n, r, false), found.wall_mm, 1e-6);
                compare_hit(find_hit(hits, n, r, true), found.cap_mm, 1e-6);
                n_expected += (size_t)(found.wall_mm > 0) + (size_t)(found.cap_mm > 0);
                n_caps += found.cap_mm > 0;
                n_opened += !is_exempt[r] && found.wall_mm > 0 && found.wall_mm == solid.high;
                n_exempt += is_exempt[r] && found.wall_mm > 0;
            }
            assert_int_equal(n, n_expected);
            for (size_t h = 1; h < n; h++)
                assert_true(hits[h].distance_mm >= hits[h - 1].distance_mm - 1e-9);
        }
        snapshot_unref(snapshot);
    }
    assert_true(n_caps > 100 && n_opened > 30 && n_exempt > 30);
    plan_and_derived_destroy(plan);
}

static void a_cut_ball_is_hit_on_the_plane_or_within_a_voxel_of_its_surface(void **state)
{
    reset(state);
    struct plan *plan = shells(spheres);
    int n_caps = 0, n_walls = 0;
    for (int i = 0; i < 40; i++) {
        struct kept kept = random_cut();
        struct snapshot *snapshot = look(plan, vec3_scale(random_direction(), 90));
        for (int pixel = 0; pixel < 40; pixel++) {
            double px = random_in(0, SIZE_PX), py = random_in(0, SIZE_PX);
            struct pick_hit hits[PICK_MAX_HITS];
            size_t n = snapshot_pick(snapshot, px, py, hits);
            for (size_t h = 0; h < n; h++) {
                struct vec3 p = hits[h].point_lps_mm;
                double above_mm = -1e9;
                for (int k = 0; k < kept.n; k++)
                    above_mm = fmax(above_mm, vec3_dot(p, kept.normal[k]) - kept.position_mm[k]);
                assert_true(above_mm < 1e-6); /* what is cut off is never hit */
                double outside_mm = vec3_length(p) - half_mm[hits[h].subject.index];
                /* a voxel belongs to the ball if its centre does: its corners lie up to sqrt(3)/2 mm off */
                if (hits[h].is_on_cap) {
                    assert_close(above_mm, 0, 1e-6);
                    assert_true(outside_mm < 0.87);
                    assert_close(hits[h].alpha, 1, 0);
                    n_caps++;
                } else {
                    assert_close(outside_mm, 0, 0.87);
                    n_walls++;
                }
            }
            struct line line = line_of(snapshot, px, py);
            struct interval range = kept_interval(&line, &kept);
            for (size_t r = 0; r < N_SHELLS; r++) {
                /* where the plane is met deep inside the ball, the cap must be there */
                struct interval solid = ball_interval(&line, half_mm[r] - 0.87);
                bool is_deep = range.from >= 0 && solid.low < range.low && range.low < solid.high &&
                               range.low < range.high && kept.is_capped[range.from];
                if (is_deep)
                    compare_hit(find_hit(hits, n, r, true), range.low, 1e-6);
            }
        }
        snapshot_unref(snapshot);
    }
    assert_true(n_caps > 100 && n_walls > 100);
    plan_and_derived_destroy(plan);
}

static void on_a_cap_the_innermost_region_is_seen(void **state)
{
    reset(state);
    struct plan *plan = shells(boxes);
    cut.coronal_low = (struct scene_clip_axis){ true, 0, true };
    struct snapshot *snapshot = look(plan, vec3(0, -100, 0.5));
    struct pick_hit hits[PICK_MAX_HITS];
    assert_int_equal(snapshot_pick(snapshot, SIZE_PX / 2.0, SIZE_PX / 2.0, hits), 3);
    for (size_t i = 0; i < 3; i++) {
        assert_int_equal(hits[i].subject.index, 2 - i);
        assert_true(hits[i].is_on_cap);
        assert_close(hits[i].point_lps_mm.y, 0, 1e-9);
    }
    assert_int_equal(pick_seen(hits, 3, -1), 0);
    snapshot_unref(snapshot);

    is_exempt[2] = true; /* the whole tumour before the cut */
    snapshot = look(plan, vec3(0, -100, 0.5));
    assert_int_equal(snapshot_pick(snapshot, SIZE_PX / 2.0, SIZE_PX / 2.0, hits), 3);
    assert_int_equal(hits[0].subject.index, 2);
    assert_false(hits[0].is_on_cap);
    assert_close(hits[0].point_lps_mm.y, -5, 1e-6);
    assert_int_equal(hits[1].subject.index, 1);
    assert_true(hits[1].is_on_cap);
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

static void what_is_drawn_as_lines_or_points_has_no_cap(void **state)
{
    reset(state);
    struct plan *plan = shells(boxes);
    cut.coronal_low = (struct scene_clip_axis){ true, 0, true };
    static const struct {
        enum scene_representation as;
        bool has_cap;
    } cases[] = { { SCENE_REPRESENTATION_SURFACE, true },  { SCENE_REPRESENTATION_UNIVELS, true },
                  { SCENE_REPRESENTATION_SOLID, true },    { SCENE_REPRESENTATION_NURBS, true },
                  { SCENE_REPRESENTATION_OUTLINE, false }, { SCENE_REPRESENTATION_POINTS, false },
                  { SCENE_REPRESENTATION_FAN, false } };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        drawn_as = cases[i].as;
        struct snapshot *snapshot = look(plan, vec3(0, -100, 0.5));
        struct pick_hit hits[PICK_MAX_HITS];
        assert_int_equal(snapshot_pick(snapshot, SIZE_PX / 2.0, SIZE_PX / 2.0, hits), 3);
        for (size_t h = 0; h < 3; h++) {
            assert_int_equal(hits[h].is_on_cap, cases[i].has_cap);
            assert_int_equal(hits[h].subject.index, 2 - h); /* the walls behind: the innermost is the nearest */
            assert_close(hits[h].point_lps_mm.y, cases[i].has_cap ? 0 : half_mm[2 - h], 1e-6);
        }
        snapshot_unref(snapshot);
    }
    plan_and_derived_destroy(plan);
}

static void slices_are_cut_unless_they_are_exempt(void **state)
{
    reset(state);
    struct plan *plan = shells(boxes);
    is_slice_shown = true; /* axial, at S 2.5 */
    cut.axial_high = (struct scene_clip_axis){ true, 0, true };
    for (int i = 0; i < 2; i++) {
        is_slice_exempt = i == 1;
        struct snapshot *snapshot = look(plan, vec3(0.3, -30, 95));
        struct pick_hit hits[PICK_MAX_HITS];
        size_t n = snapshot_pick(snapshot, SIZE_PX / 2.0, SIZE_PX / 2.0, hits);
        assert_int_equal(n, 3 + i);
        assert_int_equal(hits[0].subject.kind, i ? SUBJECT_IMAGE : SUBJECT_REGION);
        assert_close(hits[0].point_lps_mm.z, i ? 2.5 : 0, 1e-6);
        snapshot_unref(snapshot);
    }
    cut.axial_high.position_mm = 2.5; /* a slice in the plane is not cut; the cap is listed before it */
    is_slice_exempt = false;
    struct snapshot *snapshot = look(plan, vec3(0.3, -30, 95));
    struct pick_hit hits[PICK_MAX_HITS];
    size_t n = snapshot_pick(snapshot, SIZE_PX / 2.0, SIZE_PX / 2.0, hits);
    assert_int_equal(n, 4);
    assert_true(hits[pick_seen(hits, n, -1)].is_on_cap || hits[0].subject.kind == SUBJECT_IMAGE);
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

static void nothing_is_hit_where_planes_leave_nothing(void **state)
{
    reset(state);
    struct plan *plan = shells(boxes);
    cut.axial_high = (struct scene_clip_axis){ true, -2, true };
    cut.axial_low = (struct scene_clip_axis){ true, 2, true };
    for (int i = 0; i < 20; i++) {
        struct snapshot *snapshot = look(plan, vec3_scale(random_direction(), 90));
        struct pick_hit hits[PICK_MAX_HITS];
        assert_int_equal(snapshot_pick(snapshot, random_in(0, SIZE_PX), random_in(0, SIZE_PX), hits), 0);
        snapshot_unref(snapshot);
    }
    plan_and_derived_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_pixel_of_cut_boxes_hits_the_computed_walls_and_caps),
        cmocka_unit_test(a_cut_ball_is_hit_on_the_plane_or_within_a_voxel_of_its_surface),
        cmocka_unit_test(on_a_cap_the_innermost_region_is_seen),
        cmocka_unit_test(what_is_drawn_as_lines_or_points_has_no_cap),
        cmocka_unit_test(slices_are_cut_unless_they_are_exempt),
        cmocka_unit_test(nothing_is_hit_where_planes_leave_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
