/* The part of a region within limits of dose, marked on panes, slices and caps: where it is by geometry, and as both
 * back ends draw it. */
#include "core/render/visible/draw.h"
#include "core/scene/camera.h"
#include "tests/render/dose_scene.h"

static const double low_gy = 20, high_gy = 34;
static const uint32_t mark_rgb = 0xff5cf4;
static const struct vec3 origin = { 0, 0, 0 };

static void mark(struct scene *scene)
{
    scene->dose.coverage = (struct scene_dose_coverage){ .visible = true,
                                                         .region = "target",
                                                         .has_low = true,
                                                         .low = low_gy,
                                                         .has_high = true,
                                                         .high = high_gy,
                                                         .unit = SCENE_DOSE_UNIT_DOSE,
                                                         .color_rgb = mark_rgb };
}

/* Judges by the univel that holds the point. */
static bool is_within(const struct plan *plan, struct vec3 p)
{
    const struct grid *grid = &plan->regions.layers[0]->grid;
    struct vec3 centre = grid_nearest_centre_lps_mm(grid, p);
    double gy = dose_scene_dose(centre);
    return dose_scene_label(centre) > 1 && gy >= low_gy && gy < high_gy;
}

/* 1 within, 0 not, -1: the pixel's neighbourhood has both, or a univel whose dose is next to a limit: between the
 * dose's voxels it is interpolated. */
static int expected_at(const struct plan *plan, const struct view *view, struct vec3 right, struct vec3 up, double x,
                       double y, double margin_px)
{
    double mm_per_px = view->camera.height_mm / view->size_px[1];
    int all = -2;
    for (int dy = -1; dy <= 1; dy++)
        for (int dx = -1; dx <= 1; dx++) {
            struct vec3 p =
                vec3_add(view->camera.target_mm, vec3_add(vec3_scale(right, (x + dx * margin_px) * mm_per_px),
                                                          vec3_scale(up, (y + dy * margin_px) * mm_per_px)));
            struct vec3 centre = grid_nearest_centre_lps_mm(&plan->regions.layers[0]->grid, p);
            double gy = dose_scene_dose(centre);
            bool is_near = dose_scene_label(centre) > 1 && (fabs(gy - low_gy) < 0.15 || fabs(gy - high_gy) < 0.15);
            int here = is_near ? -1 : is_within(plan, p);
            all = all == -2 || all == here ? here : -1;
        }
    return all;
}

static bool is_mixed(const uint8_t *under, const uint8_t *pixel, uint32_t rgb, double part)
{
    for (int c = 0; c < 3; c++) {
        double color = rgb >> (16 - 8 * c) & 255;
        if (fabs(pixel[c] - (under[c] + (color - under[c]) * part)) > 1.5)
            return false;
    }
    return true;
}

/* Compares a picture with one without marks in an upright plane, seen along its normal. */
static void expect_marks(struct plan *plan, struct scene scene, struct view view, struct vec3 right, struct vec3 up)
{
    struct scene plain;
    scene_copy(&plain, &scene);
    mark(&scene);
    struct image *with = shots_plain(plan, scene, view), *without = shots_plain(plan, plain, view);
    size_t n_stripe = 0, n_between = 0, n_edge = 0, n_out = 0, n_wrong = 0;
    for (int y = 0; y < SHOTS_HEIGHT; y++)
        for (int x = 0; x < SHOTS_WIDTH; x++) {
            const uint8_t *pixel = shots_pixel(with, x, y), *under = shots_pixel(without, x, y);
            double from_middle = x + 0.5 - SHOTS_WIDTH / 2.0, above = SHOTS_HEIGHT / 2.0 - y - 0.5;
            int inner = expected_at(plan, &view, right, up, from_middle, above, 1.7);
            int border = expected_at(plan, &view, right, up, from_middle, above, 0.1);
            bool is_stripe = is_mixed(under, pixel, mark_rgb, DRAW_MARKS_STRIPE),
                 is_between = is_mixed(under, pixel, 0, DRAW_MARKS_BLACK),
                 is_edge = is_mixed(under, pixel, mark_rgb, 1);
            n_stripe += inner == 1 && is_stripe;
            n_between += inner == 1 && is_between;
            n_edge += border == 1 && inner != 1 && is_edge;
            n_out += border == 0;
            n_wrong += inner == 1 && !((x + y) % 8 < 4 ? is_stripe : is_between);
            n_wrong += border == 1 && !is_stripe && !is_between && !is_edge;
            n_wrong += border == 0 && memcmp(pixel, under, 3) != 0;
        }
    if (n_wrong > 0)
        fail_msg("%zu pixels are wrong", n_wrong);
    assert_true(n_stripe > 1500 && n_between > 1500 && n_edge > 200 && n_out > 20000);
    image_destroy(with);
    image_destroy(without);
}

static void a_pane_marks_the_univels_within_limits(void **state)
{
    (void)state;
    struct plan *plan = dose_scene_plan(false);
    struct view view = shots_view(SCENE_KIND_AXIAL, vec3(1.3, -2.2, 3.05), 5);
    struct scene scene = dose_scene(plan);
    scene.image.slices.axial.position_mm = 3.05;
    expect_marks(plan, scene, view, vec3(1, 0, 0), vec3(0, -1, 0));
    view = shots_view(SCENE_KIND_CORONAL, vec3(1.3, -2.2, 3.05), 5);
    scene = dose_scene(plan);
    scene.image.slices.coronal.position_mm = -2.2;
    expect_marks(plan, scene, view, vec3(1, 0, 0), vec3(0, 0, 1));
    shots_forget(plan);
}

static void a_slice_and_a_cap_in_space_are_marked_and_what_lies_before_them_is_not(void **state)
{
    (void)state;
    struct plan *plan = dose_scene_plan(false);
    struct view view = shots_view_from(vec3(1.3, -2.2, 3.05), vec3(0, 0, 1), vec3(0, -1, 0), 5);
    struct scene scene = dose_scene(plan);
    scene.image.slices.axial = (struct scene_slice){ .visible = true, .position_mm = 3.05 };
    scene.clip.axial_high = (struct scene_clip_axis){ true, 3.0502, false }; /* the coverage's surface hides it */
    expect_marks(plan, scene, view, vec3(-1, 0, 0), vec3(0, -1, 0));

    scene = dose_scene(plan); /* the body's cap alone, whose plane is at the same height */
    shots_style(&scene, "body")->visible = true;
    scene.clip.axial_high = (struct scene_clip_axis){ true, 3.05, true };
    expect_marks(plan, scene, view, vec3(-1, 0, 0), vec3(0, -1, 0));

    scene = dose_scene(plan); /* the body hides its own inside */
    shots_style(&scene, "body")->visible = true;
    scene.image.slices.axial = (struct scene_slice){ .visible = true, .position_mm = 3.05 };
    struct scene marked;
    scene_copy(&marked, &scene);
    mark(&marked);
    struct image *with = shots_plain(plan, marked, view), *without = shots_plain(plan, scene, view);
    assert_memory_equal(with->rgba, without->rgba, (size_t)4 * SHOTS_WIDTH * SHOTS_HEIGHT);
    image_destroy(with);
    image_destroy(without);
    shots_forget(plan);
}

/* ---- agreement of the back ends --------------------------------------------------------------------------------- */

enum look { LOOK_PANE, LOOK_SLICES, LOOK_CAP };

static struct scene look_scene(const struct plan *plan, const void *context)
{
    struct scene scene = dose_scene(plan);
    enum look look = *(const enum look *)context;
    mark(&scene);
    scene.image.slices.axial = (struct scene_slice){ .visible = look == LOOK_SLICES, .position_mm = 1.1 };
    scene.image.slices.sagittal = (struct scene_slice){ .visible = look == LOOK_SLICES, .position_mm = 2.2 };
    if (look == LOOK_CAP) {
        shots_style(&scene, "body")->visible = true;
        scene.clip.axial_high = (struct scene_clip_axis){ true, 4.4, true };
    }
    return scene;
}

static void both_back_ends_mark_alike(void **state)
{
    (void)state;
    for (enum look look = LOOK_PANE; look <= LOOK_CAP; look++)
        for (int is_still = 0; is_still < 2; is_still++) {
            struct view view = look == LOOK_PANE
                                   ? shots_view(SCENE_KIND_AXIAL, vec3(1, 2, 1.1), 4)
                                   : shots_view_from(vec3(1, 2, 1.1), vec3(0.5, -1, 0.9), vec3(0, 0, 1), 3);
            if (look != LOOK_PANE && is_still) {
                view.camera.projection = SCENE_PROJECTION_PERSPECTIVE;
                view.camera.position_mm = vec3(90, -150, 140);
            }
            dose_scene_expect_agreement(look_scene, &look, view, is_still, 9000);
        }
}

static void a_coverage_that_cannot_be_found_marks_nothing(void **state)
{
    (void)state;
    struct plan *plan = dose_scene_plan(false);
    struct view view = shots_view(SCENE_KIND_AXIAL, origin, 4);
    struct image *images[3];
    for (int i = 0; i < 3; i++) {
        struct scene scene = dose_scene(plan);
        if (i > 0)
            mark(&scene);
        if (i == 1)
            scene.dose.quantity = SCENE_DOSE_QUANTITY_NITROGEN; /* the dose has none */
        if (i == 2)
            scene.dose.coverage.low = 1000;
        images[i] = shots_plain(plan, scene, view);
    }
    for (int i = 1; i < 3; i++)
        assert_memory_equal(images[i]->rgba, images[0]->rgba, (size_t)4 * SHOTS_WIDTH * SHOTS_HEIGHT);
    for (int i = 0; i < 3; i++)
        image_destroy(images[i]);
    shots_forget(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_pane_marks_the_univels_within_limits),
        cmocka_unit_test(a_slice_and_a_cap_in_space_are_marked_and_what_lies_before_them_is_not),
        cmocka_unit_test(both_back_ends_mark_alike),
        cmocka_unit_test(a_coverage_that_cannot_be_found_marks_nothing),
    };
    return shots_run_drivers("coverage", tests, sizeof tests / sizeof tests[0]);
}
