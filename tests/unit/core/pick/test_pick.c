/* Picking: the regions and slices along a pixel's ray, front to back. */
#include "core/pick/pick.h"
#include "core/scene/camera.h"
#include "core/scene/snapshot.h"
#include "tests/check.h"
#include "tests/derived_of.h"
#include "tests/made_plan.h"

/* Nested boxes around the origin, half sides 5, 10, 15 along the grid's own axes, whatever their direction in the
 * patient. */
static struct affine axes;
static double nested(struct vec3 p)
{
    double r = 0;
    for (int a = 0; a < 3; a++)
        r = fmax(r, fabs(vec3_dot(p, vec3_normalize(axes.columns[a]))));
    return r < 5 ? 3 : r < 10 ? 2 : r < 15 ? 1 : 0;
}
static const struct made_region tree[] = { { "body", -1, 0xff0000 },
                                           { "organ", 0, 0x00ff00 },
                                           { "tumour", 1, 0x0000ff } };
static double grey(struct vec3 p)
{
    return 100 + p.x * 0;
}

static struct plan *nested_plan(bool is_oblique)
{
    const uint32_t size[3] = { 40, 40, 20 };
    double c = cos(0.4), s = sin(0.4);
    struct vec3 i = is_oblique ? vec3(c, s, 0) : vec3(1, 0, 0), j = is_oblique ? vec3(-s, c, 0) : vec3(0, 1, 0);
    axes = made_affine(i, j, vec3(0, 0, 2), size, vec3(0, 0, 0)); /* 2 mm slices: faces at whole even millimetres */
    struct grid grid = made_grid(size[0], size[1], size[2], axes);
    return made_plan(&grid, nested, tree, 3);
}

static struct snapshot *look(struct plan *plan, struct vec3 from, struct vec3 at, void (*change)(struct scene *scene),
                             enum scene_kind kind)
{
    struct scene scene;
    struct view view = view_default;
    struct error err = { 0 };
    char field[128];
    scene_for_plan(plan, &scene);
    scene.image.slices.axial.visible = false;
    if (change)
        change(&scene);
    view.kind = kind;
    view.size_px[0] = view.size_px[1] = 101; /* the middle pixel's middle is the line of sight */
    view.camera.has_position_mm = view.camera.has_target_mm = view.camera.has_height_mm = true;
    view.camera.position_mm = from;
    view.camera.target_mm = at;
    view.camera.height_mm = 101; /* 1 mm a pixel in panes */
    struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err);
    assert_string_equal(err.text, "");
    return snapshot;
}

/* region -1: an image slice */
static void expect_subject(const struct pick_hit *hit, int region)
{
    assert_int_equal(hit->subject.kind, region < 0 ? SUBJECT_IMAGE : SUBJECT_REGION);
    assert_int_equal(hit->subject.index, region < 0 ? 0 : region);
}

static void expect_hit(const struct pick_hit *hit, int region, struct vec3 point, double distance_mm)
{
    expect_subject(hit, region);
    assert_close(hit->point_lps_mm.x, point.x, 1e-6);
    assert_close(hit->point_lps_mm.y, point.y, 1e-6);
    assert_close(hit->point_lps_mm.z, point.z, 1e-6);
    assert_close(hit->distance_mm, distance_mm, 1e-6);
}

static void a_ray_enters_regions_on_the_faces_of_their_univels(void **state)
{
    (void)state;
    struct plan *plan = nested_plan(false);
    struct snapshot *snapshot = look(plan, vec3(0.3, -100, 0.7), vec3(0.3, 0, 0.7), NULL, SCENE_KIND_3D);
    struct pick_hit hits[PICK_MAX_HITS];
    assert_int_equal(snapshot_pick(snapshot, 50.5, 50.5, hits), 3);
    expect_hit(&hits[0], 0, vec3(0.3, -15, 0.7), 85);
    expect_hit(&hits[1], 1, vec3(0.3, -10, 0.7), 90);
    expect_hit(&hits[2], 2, vec3(0.3, -5, 0.7), 95);
    assert_int_equal(snapshot_pick(snapshot, 0.5, 0.5, hits), 0); /* the corner looks past */
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

static void an_oblique_grid_is_hit_on_its_own_faces(void **state)
{
    (void)state;
    struct plan *plan = nested_plan(true);
    struct vec3 along = vec3(-sin(0.4), cos(0.4), 0); /* the grid's j axis */
    struct snapshot *snapshot = look(plan, vec3_scale(along, -100), vec3(0, 0, 0), NULL, SCENE_KIND_3D);
    struct pick_hit hits[PICK_MAX_HITS];
    assert_int_equal(snapshot_pick(snapshot, 50.5, 50.5, hits), 3);
    expect_hit(&hits[0], 0, vec3_scale(along, -15), 85);
    expect_hit(&hits[2], 2, vec3_scale(along, -5), 95);
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

static enum scene_representation drawn_as;
static void draw_as(struct scene *scene)
{
    for (size_t i = 0; i < scene->n_regions; i++)
        scene->regions[i].value.representation = drawn_as;
}

static void whatever_a_region_is_drawn_as_its_univels_are_hit(void **state)
{
    (void)state;
    struct plan *plan = nested_plan(false);
    for (drawn_as = SCENE_REPRESENTATION_SURFACE; drawn_as <= SCENE_REPRESENTATION_FAN; drawn_as++) {
        struct snapshot *snapshot = look(plan, vec3(0.3, -100, 0.7), vec3(0.3, 0, 0.7), draw_as, SCENE_KIND_3D);
        struct pick_hit hits[PICK_MAX_HITS];
        assert_int_equal(snapshot_pick(snapshot, 50.5, 50.5, hits), 3); /* between lines and points too */
        expect_hit(&hits[0], 0, vec3(0.3, -15, 0.7), 85);
        expect_hit(&hits[2], 2, vec3(0.3, -5, 0.7), 95);
        snapshot_unref(snapshot);
    }
    plan_and_derived_destroy(plan);
}

static void every_pixel_agrees_with_small_steps_along_its_ray(void **state)
{
    (void)state;
    struct plan *plan = nested_plan(true);
    struct snapshot *snapshot = look(plan, vec3(40, -70, 30), vec3(1, 2, 3), NULL, SCENE_KIND_3D);
    struct camera camera;
    camera_resolve(snapshot, &camera);
    int n_compared = 0;
    for (int px = 5; px < 101; px += 9)
        for (int py = 4; py < 101; py += 9) {
            struct pick_hit hits[PICK_MAX_HITS];
            size_t n = snapshot_pick(snapshot, px + 0.5, py + 0.5, hits);
            struct vec3 far =
                mat4_project(&camera.lps_mm_from_clip, vec3((px + 0.5) / 50.5 - 1, 1 - (py + 0.5) / 50.5, 1));
            struct vec3 direction = vec3_normalize(vec3_sub(far, camera.eye_lps_mm));
            double first = -1; /* of the body, by steps of 0.02 mm on label values */
            for (double t = 0; t < 200 && first < 0; t += 0.02) {
                uint32_t ijk[3];
                const struct volume *layer = plan->regions.layers[0];
                if (volume_voxel_at(layer, vec3_add(camera.eye_lps_mm, vec3_scale(direction, t)), ijk) &&
                    volume_label(layer, ijk[0], ijk[1], ijk[2]))
                    first = t;
            }
            if (first < 0 && n == 0)
                continue;
            if ((first < 0) != (n == 0)) /* a corner cut by less than a step */
                continue;
            n_compared++;
            expect_subject(&hits[0], 0);
            assert_close(hits[0].distance_mm, first, 0.05);
        }
    assert_true(n_compared > 20);
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

static void hide_body_fade_organ(struct scene *scene)
{
    scene->regions[0].value.visible = false;
    scene->regions[1].value.opacity = 0;
}

static void only_what_is_shown_is_hit(void **state)
{
    (void)state;
    struct plan *plan = nested_plan(false);
    struct snapshot *snapshot = look(plan, vec3(0, -100, 0.5), vec3(0, 0, 0.5), hide_body_fade_organ, SCENE_KIND_3D);
    struct pick_hit hits[PICK_MAX_HITS];
    assert_int_equal(snapshot_pick(snapshot, 50.5, 50.5, hits), 1);
    expect_hit(&hits[0], 2, vec3(0, -5, 0.5), 95);
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

static void from_inside_a_region_its_own_wall_is_not_a_hit(void **state)
{
    (void)state;
    struct plan *plan = nested_plan(false);
    struct snapshot *snapshot =
        look(plan, vec3(0.2, -12, 0.5), vec3(0.2, 0, 0.5), NULL, SCENE_KIND_3D); /* in the body */
    struct pick_hit hits[PICK_MAX_HITS];
    assert_int_equal(snapshot_pick(snapshot, 50.5, 50.5, hits), 2);
    expect_hit(&hits[0], 1, vec3(0.2, -10, 0.5), 2);
    expect_hit(&hits[1], 2, vec3(0.2, -5, 0.5), 7);
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

static void show_coronal(struct scene *scene)
{
    scene->image.slices.coronal.visible = true;
    scene->image.slices.coronal.position_mm = -7;
}

static void slices_in_space_are_hit_between_regions(void **state)
{
    (void)state;
    struct plan *plan = nested_plan(false);
    struct grid grid = plan->regions.layers[0]->grid;
    made_plan_add_image(plan, &grid, VOXEL_U8, grey);
    struct snapshot *snapshot = look(plan, vec3(0, -100, 0.5), vec3(0, 0, 0.5), show_coronal, SCENE_KIND_3D);
    struct pick_hit hits[PICK_MAX_HITS];
    assert_int_equal(snapshot_pick(snapshot, 50.5, 50.5, hits), 4);
    expect_hit(&hits[2], -1, vec3(0, -7, 0.5), 93);
    expect_subject(&hits[3], 2);
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

static double ramp(struct vec3 p)
{
    return 100 + p.y;
}

static void show_coronal_of_dense(struct scene *scene)
{
    show_coronal(scene);
    scene->image.cull_below = 93.5;
}

static void a_pick_goes_through_where_a_slice_leaves_out_air(void **state)
{
    (void)state;
    struct plan *plan = nested_plan(false);
    struct grid grid = plan->regions.layers[0]->grid;
    made_plan_add_image(plan, &grid, VOXEL_F32, ramp); /* 93 on the slice at P-7 */
    struct snapshot *snapshot = look(plan, vec3(0, -100, 0.5), vec3(0, 0, 0.5), show_coronal_of_dense, SCENE_KIND_3D);
    struct pick_hit hits[PICK_MAX_HITS];
    assert_int_equal(snapshot_pick(snapshot, 50.5, 50.5, hits), 3);
    for (int i = 0; i < 3; i++)
        expect_subject(&hits[i], i);
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

static void move_slice(struct scene *scene)
{
    scene->image.slices.axial.position_mm = 3;
}

static void a_pane_gives_the_point_and_its_regions_innermost_first(void **state)
{
    (void)state;
    struct plan *plan = nested_plan(false);
    struct grid grid = plan->regions.layers[0]->grid;
    made_plan_add_image(plan, &grid, VOXEL_U8, grey);
    struct snapshot *snapshot = look(plan, vec3(0, 0, 0), vec3(0, 0, 0), move_slice, SCENE_KIND_AXIAL);
    struct pick_hit hits[PICK_MAX_HITS];
    /* 7 mm to screen right is L+7, 2 mm up is P-2 */
    assert_int_equal(snapshot_pick(snapshot, 50.5 + 7, 50.5 - 2, hits), 3);
    expect_hit(&hits[0], 1, vec3(7, -2, 3), 0);
    expect_hit(&hits[1], 0, vec3(7, -2, 3), 0);
    expect_hit(&hits[2], -1, vec3(7, -2, 3), 0);
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

static double stripes(struct vec3 p)
{
    return 1 + floor(p.y + 20);
}

static void more_hits_than_fit_keep_the_nearest(void **state)
{
    (void)state;
    const uint32_t size[3] = { 10, 40, 10 };
    struct grid grid =
        made_grid(10, 40, 10, made_affine(vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1), size, vec3(0, 0, 0)));
    char ids[40][8];
    struct made_region regions[40];
    for (int i = 0; i < 40; i++) {
        snprintf(ids[i], sizeof ids[i], "r%d", i);
        regions[i] = (struct made_region){ ids[i], -1, 0xffffff };
    }
    struct plan *plan = made_plan(&grid, stripes, regions, 40);
    for (int side = -1; side <= 1; side += 2) {
        struct snapshot *snapshot = look(plan, vec3(0.5, side * 100, 0.5), vec3(0.5, 0, 0.5), NULL, SCENE_KIND_3D);
        struct pick_hit hits[PICK_MAX_HITS];
        assert_int_equal(snapshot_pick(snapshot, 50.5, 50.5, hits), PICK_MAX_HITS);
        for (int i = 0; i < PICK_MAX_HITS; i++) {
            expect_subject(&hits[i], side < 0 ? i : 39 - i);
            assert_close(hits[i].distance_mm, 80 + i, 1e-6);
        }
        snapshot_unref(snapshot);
    }
    plan_and_derived_destroy(plan);
}

/* Nested spheres around the origin, radii 5, 10, 15 mm, in voxels of 1 mm. */
static double spheres(struct vec3 p)
{
    double r = vec3_length(p);
    return r < 5 ? 3 : r < 10 ? 2 : r < 15 ? 1 : 0;
}

/* Opacities of body, organ and tumour, and how they blend. */
static double opacity[3];
static enum scene_translucency translucency;
static enum scene_representation body_as;
static void see_through(struct scene *scene)
{
    for (int i = 0; i < 3; i++)
        scene->regions[i].value.opacity = opacity[i];
    scene->regions[0].value.representation = body_as;
    scene->surface.translucency = translucency;
}

/* The region seen along a ray that passes the spheres' middle at this distance; preferred: -1 for none. */
static int seen_at(const struct plan *plan, double aside_mm, int preferred, size_t *n)
{
    struct snapshot *snapshot =
        look((struct plan *)plan, vec3(0, -100, aside_mm), vec3(0, 0, aside_mm), see_through, SCENE_KIND_3D);
    struct pick_hit hits[PICK_MAX_HITS];
    *n = snapshot_pick(snapshot, 50.5, 50.5, hits);
    int seen = *n ? (int)hits[pick_seen(hits, *n, preferred)].subject.index : -1;
    snapshot_unref(snapshot);
    return seen;
}

static void what_is_seen_is_where_half_of_the_light_is_stopped(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(40);
    struct plan *plan = made_plan(&grid, spheres, tree, 3);
    static const struct {
        double opacity[3];
        enum scene_translucency translucency;
        int seen[3]; /* at 0, 7 and 12 mm from the middle: through three, two and one of the spheres */
    } cases[] = {
        /* an opaque skin hides all */
        { { 1, 1, 1 }, SCENE_TRANSLUCENCY_RIM, { 0, 0, 0 } },
        /* plain: 0.7 of the light is left behind the skin, 0.35 behind the organ */
        { { 0.3, 0.5, 1 }, SCENE_TRANSLUCENCY_PLAIN, { 1, 1, 0 } },
        /* 0.7, then 0.56: the tumour stops the rest; without it the skin covers 0.3, the organ 0.14 */
        { { 0.3, 0.2, 1 }, SCENE_TRANSLUCENCY_PLAIN, { 2, 0, 0 } },
        /* just more than half is left behind the skin, then just less */
        { { 0.499, 1, 1 }, SCENE_TRANSLUCENCY_PLAIN, { 1, 1, 0 } },
        { { 0.501, 1, 1 }, SCENE_TRANSLUCENCY_PLAIN, { 0, 0, 0 } },
        /* rim: 0.35 covers 0.105, 0.45 covers 0.135 of the remaining 0.895, which is more */
        { { 0.35, 0.45, 1 }, SCENE_TRANSLUCENCY_RIM, { 2, 1, 0 } },
        /* the same surfaces at 0.99 are still translucent with a rim: 0.297, then 0.703 x 0.297; 0.494 is left */
        { { 0.99, 0.99, 0.1 }, SCENE_TRANSLUCENCY_RIM, { 1, 1, 0 } },
    };
    body_as = SCENE_REPRESENTATION_SURFACE;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        memcpy(opacity, cases[i].opacity, sizeof opacity);
        translucency = cases[i].translucency;
        for (int at = 0; at < 3; at++) {
            size_t n;
            assert_int_equal(seen_at(plan, at == 0 ? 0.5 : at == 1 ? 7.5 : 12.5, -1, &n), cases[i].seen[at]);
            assert_int_equal(n, 3 - at); /* what is seen or not: all are listed */
        }
    }
    plan_and_derived_destroy(plan);
}

static void outlines_and_points_are_seen_through(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(40);
    struct plan *plan = made_plan(&grid, spheres, tree, 3);
    memcpy(opacity, (double[3]){ 1, 1, 1 }, sizeof opacity);
    translucency = SCENE_TRANSLUCENCY_RIM;
    static const struct {
        enum scene_representation as;
        int seen;
    } cases[] = { { SCENE_REPRESENTATION_OUTLINE, 1 },
                  { SCENE_REPRESENTATION_POINTS, 1 },
                  { SCENE_REPRESENTATION_SOLID, 0 },
                  { SCENE_REPRESENTATION_UNIVELS, 0 },
                  { SCENE_REPRESENTATION_FAN, 0 } };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        size_t n;
        body_as = cases[i].as;
        assert_int_equal(seen_at(plan, 0.5, -1, &n), cases[i].seen);
        assert_int_equal(seen_at(plan, 12.5, -1, &n), 0); /* where there is nothing else, they are what is seen */
    }
    plan_and_derived_destroy(plan);
}

static void the_selected_region_is_seen_where_half_of_the_light_reaches_it(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(40);
    struct plan *plan = made_plan(&grid, spheres, tree, 3);
    size_t n;
    body_as = SCENE_REPRESENTATION_SURFACE;
    translucency = SCENE_TRANSLUCENCY_PLAIN;
    memcpy(opacity, (double[3]){ 0.2, 0.2, 1 }, sizeof opacity);
    for (int preferred = -1; preferred < 3; preferred++)
        assert_int_equal(seen_at(plan, 0.5, preferred, &n), preferred < 0 ? 2 : preferred);
    assert_int_equal(seen_at(plan, 7.5, 2, &n), 0); /* the ray passes the tumour by */
    memcpy(opacity, (double[3]){ 0.2, 0.5, 1 }, sizeof opacity);
    assert_int_equal(seen_at(plan, 0.5, 2, &n),
                     1); /* 0.4 of the light is left behind the organ: the tumour is hidden */
    plan_and_derived_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ray_enters_regions_on_the_faces_of_their_univels),
        cmocka_unit_test(an_oblique_grid_is_hit_on_its_own_faces),
        cmocka_unit_test(whatever_a_region_is_drawn_as_its_univels_are_hit),
        cmocka_unit_test(every_pixel_agrees_with_small_steps_along_its_ray),
        cmocka_unit_test(only_what_is_shown_is_hit),
        cmocka_unit_test(from_inside_a_region_its_own_wall_is_not_a_hit),
        cmocka_unit_test(slices_in_space_are_hit_between_regions),
        cmocka_unit_test(a_pick_goes_through_where_a_slice_leaves_out_air),
        cmocka_unit_test(a_pane_gives_the_point_and_its_regions_innermost_first),
        cmocka_unit_test(more_hits_than_fit_keep_the_nearest),
        cmocka_unit_test(what_is_seen_is_where_half_of_the_light_is_stopped),
        cmocka_unit_test(outlines_and_points_are_seen_through),
        cmocka_unit_test(the_selected_region_is_seen_where_half_of_the_light_reaches_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
