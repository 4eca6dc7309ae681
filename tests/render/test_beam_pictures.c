/* Pictures of twenty beam's-eye views worked out by hand: each shows things where they are, in all back ends. */
#include <math.h>

#include "tests/golden_beams.h"
#include "tests/render/beam_views.h"

/* Three balls near the target, whose places tell left from right, above from below and near from far. */
static struct vec3 balls_mm[3];
static double balls_radius_mm;
static double balls(struct vec3 p)
{
    for (int i = 0; i < 3; i++)
        if (vec3_length(vec3_sub(p, balls_mm[i])) < balls_radius_mm)
            return i + 1;
    return 0;
}

/* The target in the middle of a cube as large as the picture; the balls towards L, P and S of it, around centres of
 * univels, so that they are as symmetric as balls are. */
static struct plan *balls_plan(const struct golden_beam *g, double side_mm)
{
    static const struct made_region regions[] = { { "red", -1, 0xff0000 },
                                                  { "green", -1, 0x00ff00 },
                                                  { "blue", -1, 0x0000ff } };
    static const struct vec3 parts[3] = { { 14.5, 4.5, 2.5 }, { -3.5, 15.5, -6.5 }, { 2.5, -5.5, 16.5 } };
    const uint32_t size[3] = { 60, 60, 60 };
    double mm = side_mm / 60;
    struct grid grid =
        made_grid(60, 60, 60, made_affine(vec3(mm, 0, 0), vec3(0, mm, 0), vec3(0, 0, mm), size, g->target));
    balls_radius_mm = 3.7 * mm;
    for (int i = 0; i < 3; i++)
        balls_mm[i] = along(g->target, parts[i], mm);
    return made_plan(&grid, balls, regions, 3);
}

/* On the ring's circle all is white, 4 px inside and outside nothing is. The ring alone makes the picture parallel. */
static void expect_ring(const struct golden_beam *g, struct plan *plan, const struct scene *scene, struct view view)
{
    struct scene copy;
    scene_copy(&copy, scene);
    view.camera.projection = SCENE_PROJECTION_PERSPECTIVE;
    struct image *image = shots_plain(plan, copy, ring_of(view, g->ring_mm));
    for (int i = 5; i < 360; i += 10)
        for (int off = -4; off <= 4; off += 4) {
            double turn = i * MATH_PI / 180, r = g->ring_px + off;
            const uint8_t *p = shots_pixel(image, (int)floor(g->width_px / 2.0 + r * cos(turn)),
                                           (int)floor(g->height_px / 2.0 + r * sin(turn)));
            bool is_white = p[0] > 150 && p[1] > 150 && p[2] > 150;
            assert_int_equal(is_white, off == 0);
        }
    image_destroy(image);
}

/* Draws the beam's view and compares the balls that are wholly in the picture, apart from each other. */
static size_t expect_balls(const struct golden_beam *g)
{
    struct vec3 d = vec3_scale(g->d, 1 / g->n), right = vec3_scale(g->right, 1 / g->n_right),
                up = vec3_scale(g->up, 1 / g->n_up), entry = along(g->target, d, -g->length_mm);
    bool has_ring = !isnan(g->ring_mm);
    double side_mm = has_ring ? g->height_mm : 60;
    struct plan *plan = balls_plan(g, side_mm);
    /* a planned beam beside a draft is far out of the picture, with its ring */
    set_beam(plan, g->is_draft ? along(g->target, right, 9 * side_mm) : g->target, g->is_draft ? vec3(0, 0.6, 0.8) : d,
             g->length_mm);
    struct scene scene = smooth_scene(plan);
    scene.beam.draft.enabled = g->is_draft;
    scene.beam.draft.line.entry_mm = entry;
    scene.beam.draft.line.target_mm = g->target;
    struct view view = view_of(SCENE_KIND_BEAM, g->width_px, g->height_px, side_mm);
    view.camera.projection = has_ring ? SCENE_PROJECTION_PARALLEL : SCENE_PROJECTION_PERSPECTIVE;
    view.camera.fov_deg = g->fov_deg;
    view.beam.has_along_mm = !isnan(g->eye_mm);
    view.beam.along_mm = view.beam.has_along_mm ? g->eye_mm : 0;
    if (has_ring)
        expect_ring(g, plan, &scene, view);
    struct image *image = shots_plain(plan, scene, view);
    struct vec3 half = vec3(side_mm / 2, side_mm / 2, side_mm / 2);
    double back_mm = isnan(g->eye_mm) ? golden_home_mm(g, g->target, half, d, right, up) : g->length_mm - g->eye_mm;
    struct vec3 eye = along(g->target, d, -back_mm);
    double x[3], y[3], radius[3], depth[3], smaller = fmin(g->width_px, g->height_px);
    size_t n_compared = 0;
    for (int i = 0; i < 3; i++) {
        struct vec3 from = vec3_sub(balls_mm[i], eye);
        depth[i] = vec3_dot(from, d);
        double pixels_per_mm =
            has_ring ? 2 * g->ring_px / g->ring_mm : smaller / (2 * depth[i] * tan(g->fov_deg / 2 * MATH_PI / 180));
        x[i] = g->width_px / 2.0 + vec3_dot(from, right) * pixels_per_mm;
        y[i] = g->height_px / 2.0 - vec3_dot(from, up) * pixels_per_mm;
        radius[i] = balls_radius_mm * pixels_per_mm;
    }
    for (int i = 0; i < 3; i++) {
        bool is_clear = depth[i] > 2 * balls_radius_mm && x[i] > radius[i] + 3 && y[i] > radius[i] + 3 &&
                        x[i] < g->width_px - radius[i] - 3 && y[i] < g->height_px - radius[i] - 3 && radius[i] > 4;
        for (int j = 0; j < 3; j++)
            is_clear &= j == i || depth[j] < -balls_radius_mm ||
                        hypot(x[i] - x[j], y[i] - y[j]) > 1.2 * (radius[i] + radius[j]);
        double found_x, found_y;
        if (!is_clear)
            continue;
        n_compared++;
        assert_true(shots_centroid(image, i, &found_x, &found_y) > 20);
        /* a ball off the axis of a perspective is drawn a little longer, away from the middle */
        assert_close(found_x, x[i], has_ring ? 0.6 : 1.2);
        assert_close(found_y, y[i], has_ring ? 0.6 : 1.2);
    }
    image_destroy(image);
    shots_forget(plan);
    return n_compared;
}

static void the_pictures_of_twenty_beams_show_things_where_they_are(void **state)
{
    (void)state;
    size_t n = 0;
    for (int i = 0; i < GOLDEN_BEAMS; i++) {
        size_t n_compared = expect_balls(&golden_beams[i]);
        print_message("beam %d, %s: %zu balls\n", i + 1, golden_beams[i].what, n_compared);
        n += n_compared;
    }
    assert_true(n >= 40);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_pictures_of_twenty_beams_show_things_where_they_are),
    };
    return shots_run_drivers("beam pictures", tests, sizeof tests / sizeof tests[0]);
}
