/* Beams on slice panes: the projected line, where it crosses the plane, and the section of the aperture. */
#include "tests/render/beam_scene.h"

static const struct vec3 origin = { 0, 0, 0 };

static void a_slice_shows_the_line_strong_in_its_plane_and_faint_beside_it(void **state)
{
    (void)state;
    const double places_mm[] = { 0, 0.45, -0.45, 0.6, 20 }; /* slices are 1 mm thick */
    for (size_t i = 0; i < sizeof places_mm / sizeof places_mm[0]; i++) {
        struct plan *plan = beam_plan_sideways(NAN);
        struct scene scene = beam_scene(plan);
        scene.image.slices.coronal.position_mm = places_mm[i];
        struct image *image =
            shots_plain(plan, scene, shots_view(SCENE_KIND_CORONAL, vec3(0, places_mm[i], 0), PX_PER_MM));
        const uint8_t *pixel = shots_pixel(image, column_of(-20), row_of(10));
        double share = fabs(places_mm[i]) < 0.5 ? 1 : 0.45;
        for (int c = 0; c < 3; c++)
            assert_close(pixel[c], share * (BEAM_SCENE_RGB >> (16 - 8 * c) & 255) + (1 - share) * shots_background[c],
                         3);
        image_destroy(image);
        shots_forget(plan);
    }
}

/* Across the beam: a ring of 5 pixels where the line crosses, the aperture's circle around it. */
static void a_slice_across_the_beam_shows_where_it_crosses_and_its_circle(void **state)
{
    (void)state;
    struct plan *plan = beam_plan(vec3(-60, 6, 10), vec3(0, 6, 10), 44);
    struct scene scene = beam_scene(plan);
    scene.image.slices.sagittal.position_mm = 25;
    struct image *image = shots_plain(plan, scene, shots_view(SCENE_KIND_SAGITTAL, vec3(25, 0, 0), PX_PER_MM));
    for (int i = 0; i < 16; i++) { /* sagittal: posterior is right */
        double x = MIDDLE_X + 6 * PX_PER_MM, y = MIDDLE_Y - 10 * PX_PER_MM, angle = 2 * MATH_PI * i / 16;
        const double radii[2] = { 5, 22 * PX_PER_MM };
        for (int r = 0; r < 2; r++) {
            const uint8_t *pixel =
                shots_pixel(image, (int)(x + radii[r] * cos(angle)), (int)(y + radii[r] * sin(angle)));
            assert_true(pixel[2] > 120 && pixel[2] > pixel[0] + 60); /* its edges are smooth */
        }
        assert_true(is_background(
            shots_pixel(image, (int)(x + 40 * cos(angle)), (int)(y + 40 * sin(angle))))); /* nothing between them */
    }
    image_destroy(image);
    shots_forget(plan);
}

/* At 30 degrees to the plane a circle of radius r is an ellipse of r by 2 r. */
static void a_slanted_slice_shows_the_ellipse_of_the_aperture(void **state)
{
    (void)state;
    double c = cos(MATH_PI / 6), s = sin(MATH_PI / 6);
    struct plan *plan = beam_plan(vec3(-100 * c, 0, 100 * s), vec3(0, 0, 0), 24);
    struct scene scene = beam_scene(plan);
    scene.image.slices.axial.position_mm = 0;
    struct image *image = shots_plain(plan, scene, shots_view(SCENE_KIND_AXIAL, origin, PX_PER_MM));
    int high, low, n_at_end[2] = { 0, 0 };
    assert_true(extent_of_column(image, MIDDLE_X, &high, &low));
    /* lines of two pixels with a dark rim of one, on a background as dark */
    assert_close(high, MIDDLE_Y - 12 * PX_PER_MM - 1, 1.5);
    assert_close(low + 1, MIDDLE_Y + 12 * PX_PER_MM + 1, 1.5);
    for (int side = 0; side < 2; side++)
        for (int x = -2; x <= 2; x++)
            n_at_end[side] += shots_pixel(image, MIDDLE_X + (side ? 24 : -24) * PX_PER_MM + x, MIDDLE_Y + 8)[2] > 120;
    assert_true(n_at_end[0] >= 1 && n_at_end[1] >= 1); /* off the line's own row: the ellipse is steep there */
    image_destroy(image);
    shots_forget(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_slice_shows_the_line_strong_in_its_plane_and_faint_beside_it),
        cmocka_unit_test(a_slice_across_the_beam_shows_where_it_crosses_and_its_circle),
        cmocka_unit_test(a_slanted_slice_shows_the_ellipse_of_the_aperture),
    };
    return shots_run_soft("beams on panes", tests, sizeof tests / sizeof tests[0]);
}
