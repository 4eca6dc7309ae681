/* Aperture ring and crosshair over pictures along a beam: their size and place in pixels, against regions of known
 * size; what lies behind the eye. */
#include <math.h>

#include "core/render/visible/beam_eye_marks.h"
#include "tests/render/beam_views.h"

/* A ball of 40 mm, off the origin. */
#define BALL_MM 20.0
static const struct vec3 ball_mm = { 6, -4, 5 };
static const struct made_region ball_region[] = { { "ball", -1, 0x20d020 } };
static double ball(struct vec3 p)
{
    return vec3_length(vec3_sub(p, ball_mm)) < BALL_MM;
}
static double value(struct vec3 p)
{
    return 100 * ball(p) + 50;
}

/* Univels of 0.6 mm in a cube of 60 mm; an image of the same. */
static struct plan *ball_plan(void)
{
    const uint32_t size[3] = { 100, 100, 100 };
    struct grid grid =
        made_grid(100, 100, 100, made_affine(vec3(0.6, 0, 0), vec3(0, 0.6, 0), vec3(0, 0, 0.6), size, vec3(0, 0, 0)));
    struct plan *plan = made_plan(&grid, ball, ball_region, 1);
    made_plan_add_image(plan, &grid, VOXEL_U8, value);
    return plan;
}

static bool is_white(const uint8_t *p)
{
    return p[0] > 170 && p[1] > 170 && p[2] > 170;
}

/* A circle of what is bright in one picture and not in another; without its four ticks. */
struct circle {
    double x, y, radius, least, most; /* pixels */
    size_t n;
};
static struct circle ring_in(const struct image *image, const struct image *without)
{
    double sum_x = 0, sum_y = 0, sum = 0;
    size_t n = 0;
    struct circle ring = { .least = INFINITY };
    for (int pass = 0; pass < 2; pass++)
        for (int y = 0; y < image->height_px; y++)
            for (int x = 0; x < image->width_px; x++) {
                if (!is_white(shots_pixel(image, x, y)) || is_white(shots_pixel(without, x, y)))
                    continue;
                double r = hypot(x + 0.5 - ring.x, y + 0.5 - ring.y);
                if (pass && (fabs(x + 0.5 - ring.x) < 4 || fabs(y + 0.5 - ring.y) < 4))
                    continue;
                if (pass == 0) {
                    sum_x += x + 0.5;
                    sum_y += y + 0.5;
                    ring.n++;
                } else {
                    n++;
                    sum += r;
                    ring.least = fmin(ring.least, r);
                    ring.most = fmax(ring.most, r);
                }
                if (pass == 0) {
                    ring.x = sum_x / (double)ring.n;
                    ring.y = sum_y / (double)ring.n;
                }
            }
    ring.radius = sum / (double)n;
    return ring;
}

/* The disc of what `is` tells, by its area and its centre of gravity. */
static struct circle disc_in(const struct image *image, bool (*is)(const uint8_t *pixel))
{
    struct circle disc = { .n = 0 };
    for (int y = 0; y < image->height_px; y++)
        for (int x = 0; x < image->width_px; x++)
            if (is(shots_pixel(image, x, y))) {
                disc.x += x + 0.5;
                disc.y += y + 0.5;
                disc.n++;
            }
    assert_true(disc.n > 0);
    disc.x /= (double)disc.n;
    disc.y /= (double)disc.n;
    disc.radius = sqrt((double)disc.n / MATH_PI);
    return disc;
}

static bool is_green(const uint8_t *p)
{
    return p[1] > p[0] + 25 && p[1] > p[2] + 25;
}

/* ---- the ring --------------------------------------------------------------------------------------------------- */

/* The target lies this far right and up of the ball's centre, so that the ball is that far left and down. */
static const struct {
    struct vec3 direction;
    double off_mm[2];
    int width_px, height_px;
    double height_mm;
    bool is_moving; /* drawn with half the pixels */
} rings[] = {
    { { 1, 0, 0 }, { 0, 0 }, 400, 300, 100, false },
    { { 0, 0, -1 }, { 3, 2 }, 300, 400, 60, false },
    { { 0, 0, 1 }, { -4, 1 }, 360, 360, 48, true },
    { { 0, -1, 0 }, { 0, 5 }, 1000, 700, 70, false },
    { { 3 / 13.0, 4 / 13.0, 12 / 13.0 }, { 2, -2 }, 640, 480, 64, false },
    { { -24 / 41.0, 32 / 41.0, 9 / 41.0 }, { 0, 0 }, 800, 600, 120, true },
    { { -9 / 17.0, -12 / 17.0, 8 / 17.0 }, { -5, -3 }, 500, 400, 80, false },
};

static void the_ring_is_as_large_as_a_ball_of_its_diameter_within_a_pixel(void **state)
{
    (void)state;
    struct plan *plan = ball_plan();
    for (size_t i = 0; i < sizeof rings / sizeof rings[0]; i++) {
        struct beam_shown axes = { .direction = rings[i].direction };
        struct plane plane = beam_plane(&axes, 0);
        struct vec3 target = along(along(ball_mm, plane.right, rings[i].off_mm[0]), plane.up, rings[i].off_mm[1]);
        set_beam(plan, target, rings[i].direction, 70);
        struct view view = view_of(SCENE_KIND_BEAM, rings[i].width_px, rings[i].height_px, rings[i].height_mm);
        double part = rings[i].is_moving ? 0.5 : 1;
        struct render_options options = { (int)(rings[i].width_px * part), (int)(rings[i].height_px * part),
                                          SURFACE_FULL, !rings[i].is_moving };
        struct image *bare = shots_take(plan, smooth_scene(plan), view, &options, NULL);
        struct image *image = shots_take(plan, smooth_scene(plan), ring_of(view, 2 * BALL_MM), &options, NULL);
        struct circle silhouette = disc_in(bare, is_green), ring = ring_in(image, bare);
        double pixels_per_mm = part * fmin(rings[i].width_px, rings[i].height_px) / rings[i].height_mm;
        print_message("beam %zu: ring %.2f px, ball %.2f px, true %.2f px\n", i + 1, 2 * ring.radius,
                      2 * silhouette.radius, 2 * BALL_MM * pixels_per_mm);
        assert_close(2 * ring.radius, 2 * BALL_MM * pixels_per_mm, 0.5);
        assert_close(2 * ring.radius, 2 * silhouette.radius, 1);
        assert_close(ring.x, options.width_px / 2.0, 0.5);
        assert_close(ring.y, options.height_px / 2.0, 0.5);
        assert_close(silhouette.x - ring.x, -rings[i].off_mm[0] * pixels_per_mm, 0.5);
        assert_close(silhouette.y - ring.y, rings[i].off_mm[1] * pixels_per_mm, 0.5);
        assert_true(ring.least > ring.radius - 2.5 && ring.most < ring.radius + 2.5); /* round; 2.2 px wide */
        image_destroy(bare);
        image_destroy(image);
    }
    shots_forget(plan);
}

/* Brightness along the circle, of 720 places, and how many runs of bright places there are. */
static double share_bright(const struct image *image, const struct paint_point *places, size_t n, size_t *n_runs)
{
    size_t bright = 0;
    bool was = false;
    *n_runs = 0;
    for (size_t i = 0; i < n; i++) {
        const uint8_t *p = shots_pixel(image, (int)floor(places[i].x), (int)floor(places[i].y));
        bool is = p[0] > 90 && p[1] > 90 && p[2] > 90;
        bright += is;
        *n_runs += is && !was;
        was = is;
    }
    return (double)bright / (double)n;
}

static void hide(struct scene *scene)
{
    for (size_t i = 0; i < scene->n_regions; i++)
        scene->regions[i].value.visible = false;
}

/* Beams are drawn as lines alone. */
static void hide_openings(struct scene *scene)
{
    scene->beam.n_looks = 1;
    scene->beam.looks = mem_new(sizeof *scene->beam.looks);
    scene->beam.looks[0] = (struct scene_beam_look_entry){ .id = "b", .value = scene_beam_look_default };
    scene->beam.looks[0].value.opening = false;
}

/* The planned beam stands 30 degrees off the draft: its ring of 100 mm is an ellipse of 100 by 86.6 mm. */
static void a_draft_has_the_planned_ring_dashed_around_the_planned_entry(void **state)
{
    (void)state;
    struct plan *plan = ball_plan();
    const double tilt = 30 * MATH_PI / 180, pixels_per_mm = 3;
    set_beam(plan, vec3(0, 0, 0), vec3(sin(tilt), cos(tilt), 0), 60); /* entry (-30, -52, 0) */
    struct scene scene = shots_scene(plan);
    hide(&scene);
    scene.beam.draft.enabled = true;
    hide_openings(&scene);
    scene.beam.draft.line.entry_mm = vec3(-20, -50, 10);
    scene.beam.draft.line.target_mm = vec3(-20, 10, 10);
    struct view view = ring_of(view_of(SCENE_KIND_BEAM, 600, 600, 200), 40);
    struct image *image = shots_plain(plan, scene, view);
    /* seen from the front, right is L and up is S: the planned entry is 10 mm left and 10 mm below the draft's axis */
    double x = 300 - 10 * pixels_per_mm, y = 300 + 10 * pixels_per_mm;
    assert_true(shots_pixel(image, (int)x, (int)y)[0] > 120);
    /* the line of the planned beam, which is level here, is drawn too */
    assert_true(shots_pixel(image, (int)x, (int)y - 4)[0] > 120 && shots_pixel(image, (int)x, (int)y + 4)[0] > 120);
    assert_true(shots_pixel(image, (int)x, (int)y - 9)[0] < 60 && shots_pixel(image, (int)x, (int)y + 9)[0] < 60);
    enum { N = 1440 };
    struct paint_point ellipse[N], draft[N];
    for (int i = 0; i < N; i++) {
        double turn = 2 * MATH_PI * i / N;
        ellipse[i] =
            (struct paint_point){ x + 50 * cos(tilt) * pixels_per_mm * cos(turn), y + 50 * pixels_per_mm * sin(turn) };
        draft[i] = (struct paint_point){ 300 + 20 * pixels_per_mm * cos(turn), 300 + 20 * pixels_per_mm * sin(turn) };
    }
    size_t n_dashes, n_runs;
    double share = share_bright(image, ellipse, N, &n_dashes), whole = share_bright(image, draft, N, &n_runs);
    /* the perimeter by Ramanujan's formula; a dash each 11 px, 6 of them bright */
    double a = 150, b = 150 * cos(tilt), perimeter = MATH_PI * (3 * (a + b) - sqrt((3 * a + b) * (a + 3 * b)));
    assert_close((double)n_dashes, perimeter / 11, 3);
    assert_close(share, 6 / 11.0, 0.12); /* a pixel's brightness is told by one threshold */
    assert_true(whole > 0.99 && n_runs <= 1);
    image_destroy(image);
    shots_forget(plan);
}

/* ---- the crosshair ---------------------------------------------------------------------------------------------- */

/* Ticks each 5 mm reach 3 px to either side, each 10 mm 6 px, each 50 mm 9 px. */
static void expect_ticks(const struct image *image, double x, double y, double pixels_per_mm, int last_mm)
{
    for (int axis = 0; axis < 2; axis++)
        for (int mm = -last_mm; mm <= last_mm; mm += 5) {
            double at = (axis ? y : x) + mm * pixels_per_mm, half = mm % 50 == 0 ? 9 : mm % 10 == 0 ? 6 : 3;
            if (abs(mm) * pixels_per_mm < 12)
                continue;
            for (int side = -1; side <= 1; side += 2) {
                double inside = side * (half - 1), outside = side * (half + 2.6);
                int ix = (int)floor(axis ? x + inside : at), iy = (int)floor(axis ? at : y + inside);
                int ox = (int)floor(axis ? x + outside : at), oy = (int)floor(axis ? at : y + outside);
                assert_true(shots_pixel(image, ix, iy)[0] > 90);
                assert_true(shots_pixel(image, ox, oy)[0] < 60);
            }
            double between = at + 2.5 * pixels_per_mm; /* none there, and the line itself is */
            assert_true(
                shots_pixel(image, (int)floor(axis ? x + 2.9 : between), (int)floor(axis ? between : y + 2.9))[0] < 60);
            assert_true(shots_pixel(image, (int)floor(axis ? x : between), (int)floor(axis ? between : y))[0] > 90);
        }
}

static void the_crosshair_has_a_tick_each_5_mm_at_the_depth_of_the_target(void **state)
{
    (void)state;
    struct plan *plan = ball_plan();
    set_beam(plan, vec3(3, 1, -2), vec3(-9 / 17.0, -12 / 17.0, 8 / 17.0), 60);
    for (int i = 0; i < 3; i++) {
        struct scene scene = shots_scene(plan);
        hide(&scene);
        struct view view = view_of(SCENE_KIND_BEAM, 601, 601, 150);
        double pixels_per_mm = 601 / 150.0;
        view.beam.crosshair = true;
        if (i) { /* perspective, from 250 and 500 mm before the target */
            view.camera.projection = SCENE_PROJECTION_PERSPECTIVE;
            view.beam.has_along_mm = true;
            view.beam.along_mm = 60 - 250 * i;
            pixels_per_mm = 601 / (2 * 250 * i * tan(15 * MATH_PI / 180));
        }
        struct image *image = shots_plain(plan, scene, view);
        expect_ticks(image, 300.5, 300.5, pixels_per_mm, 5 * (int)(40 / pixels_per_mm));
        /* 36 px from the edge it ends */
        assert_true(shots_pixel(image, 32, 300)[0] < 60 && shots_pixel(image, 40, 300)[0] > 90);
        assert_true(shots_pixel(image, 300, 568)[0] < 60 && shots_pixel(image, 300, 560)[0] > 90);
        image_destroy(image);
    }
    shots_forget(plan);
}

static void with_the_eye_beyond_the_target_the_crosshair_has_no_ticks_in_perspective(void **state)
{
    (void)state;
    struct plan *plan = ball_plan();
    set_beam(plan, vec3(0, 0, 0), vec3(0, 1, 0), 60);
    struct scene scene = shots_scene(plan);
    hide(&scene);
    struct view view = view_of(SCENE_KIND_BEAM, 401, 401, 150);
    view.beam.crosshair = view.beam.has_along_mm = true;
    view.beam.along_mm = 80;
    view.camera.projection = SCENE_PROJECTION_PERSPECTIVE;
    struct image *image = shots_plain(plan, scene, view);
    for (int x = 45; x < 356; x++) {
        assert_true(abs(x - 200) < 10 || shots_pixel(image, x, 200)[0] > 90);
        assert_true(abs(x - 200) < 10 || (shots_pixel(image, x, 204)[0] < 60 && shots_pixel(image, x, 196)[0] < 60));
    }
    image_destroy(image);
    shots_forget(plan);
}

/* ---- the pane of the beam slice --------------------------------------------------------------------------------- */

static bool is_bright(const uint8_t *p)
{
    return p[0] > 150 && p[0] < 235;
}

/* The slice 12 mm from the ball's centre cuts a disc of sqrt(20^2 - 12^2) = 16 mm radius out of it. */
static void on_the_beam_slice_ring_and_crosshair_stand_about_the_axis(void **state)
{
    (void)state;
    struct plan *plan = ball_plan();
    struct vec3 d = vec3(3 / 13.0, 4 / 13.0, 12 / 13.0);
    set_beam(plan, ball_mm, d, 50);
    for (int has_crosshair = 0; has_crosshair < 2; has_crosshair++) {
        struct scene scene = shots_scene(plan);
        scene.outline.on_slices = false;
        scene.image.window.center = 115;
        scene.image.window.width = 100; /* 50 is black, 150 is 217 of 255 */
        scene.beam.slice.along_mm = 38;
        struct view view = view_of(SCENE_KIND_BEAM_SLICE, 500, 400, 80);
        struct beam_shown beam = { .entry_lps_mm = plan->beams[0].entry_lps_mm, .direction = d };
        struct plane plane = beam_plane(&beam, 38);
        view.camera.has_target_mm = true; /* looks past the axis: 10 mm to the right of it, 4 mm above */
        view.camera.target_mm = along(along(plane.origin_lps_mm, plane.right, 10), plane.up, 4);
        struct scene same;
        scene_copy(&same, &scene);
        struct image *bare = shots_plain(plan, scene, view);
        view = ring_of(view, 32);
        view.beam.crosshair = has_crosshair;
        struct image *image = shots_plain(plan, same, view);
        double x = 250 - 10 * 5, y = 200 + 4 * 5;
        struct circle disc = disc_in(bare, is_bright);
        assert_close(disc.radius, 16 * 5, 1);
        assert_close(disc.x, x, 0.7);
        assert_close(disc.y, y, 0.7);
        if (has_crosshair) {
            /* behind the disc's edge, where all is dark */
            for (int mm = 25; mm <= 45; mm += 10)
                assert_true(shots_pixel(image, (int)(x + mm * 5), (int)y - 2)[0] > 90 &&
                            shots_pixel(image, (int)(x + mm * 5 + 12), (int)y - 3)[0] < 90);
        } else {
            struct circle ring = { .x = x, .y = y };
            for (int i = 0; i < 360; i++) { /* on the circle of the true size all is white, apart from it nothing */
                double turn = i * MATH_PI / 180, r = 16 * 5;
                assert_true(is_white(shots_pixel(image, (int)(ring.x + r * cos(turn)), (int)(ring.y + r * sin(turn)))));
                r -= 5;
                assert_true(shots_pixel(image, (int)(ring.x + r * cos(turn)), (int)(ring.y + r * sin(turn)))[0] < 235);
            }
        }
        image_destroy(bare);
        image_destroy(image);
    }
    shots_forget(plan);
}

/* ---- behind the eye --------------------------------------------------------------------------------------------- */

static size_t n_coloured(const struct image *image)
{
    size_t n = 0;
    for (int y = 0; y < image->height_px; y++)
        for (int x = 0; x < image->width_px; x++)
            n += memcmp(shots_pixel(image, x, y), shots_background, 3) != 0;
    return n;
}

/* Nothing of the ball, a slice through its middle, its volume, the axes and a dose's grid is seen from beyond it. */
static void what_lies_behind_the_eye_is_drawn_in_no_projection(void **state)
{
    (void)state;
    struct plan *plan = ball_plan();
    struct vec3 d = vec3(12 / 25.0, -9 / 25.0, 20 / 25.0);
    set_beam(plan, ball_mm, d, 100);
    for (int is_parallel = 0; is_parallel < 2; is_parallel++)
        for (int is_beyond = 0; is_beyond < 2; is_beyond++)
            for (int what = 0; what < 5; what++) {
                struct scene scene = shots_scene(plan);
                scene.regions[0].value.visible = what == 0 || what == 3;
                scene.regions[0].value.opacity = what == 3 ? 0.5 : 1;
                scene.beam.slice.visible = what == 1;
                scene.beam.slice.along_mm = 100;
                scene.image.volume.visible = what == 2;
                scene.image.volume.method = SCENE_VOLUME_METHOD_MIP;
                scene.axes.visible = what == 4;
                struct view view = view_of(SCENE_KIND_BEAM, 240, 240, 100);
                view.camera.projection = is_parallel ? SCENE_PROJECTION_PARALLEL : SCENE_PROJECTION_PERSPECTIVE;
                view.beam.has_along_mm = true;
                view.beam.along_mm = is_beyond ? 175 : -60; /* the grid's farthest corner is 52 + 9 mm from the ball */
                struct image *image = shots_plain(plan, scene, view);
                if (is_beyond)
                    assert_int_equal(n_coloured(image), 0);
                else
                    assert_true(n_coloured(image) > 300);
                image_destroy(image);
            }
    shots_forget(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_ring_is_as_large_as_a_ball_of_its_diameter_within_a_pixel),
        cmocka_unit_test(a_draft_has_the_planned_ring_dashed_around_the_planned_entry),
        cmocka_unit_test(the_crosshair_has_a_tick_each_5_mm_at_the_depth_of_the_target),
        cmocka_unit_test(with_the_eye_beyond_the_target_the_crosshair_has_no_ticks_in_perspective),
        cmocka_unit_test(on_the_beam_slice_ring_and_crosshair_stand_about_the_axis),
        cmocka_unit_test(what_lies_behind_the_eye_is_drawn_in_no_projection),
    };
    return shots_run_drivers("beam eye", tests, sizeof tests / sizeof tests[0]);
}
