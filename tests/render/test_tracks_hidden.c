/* Cuts and covers of particle tracks: clip planes, caps, surfaces, slices. */
#include "tests/render/track_scene.h"

/* ---- what cuts and hides them ----------------------------------------------------------------------------------- */

static void clip_planes_cut_segments_exactly(void **context)
{
    (void)context;
    tracks_random_begin();
    struct plan *plan = tracks_plan();
    for (int i = 0; i < 60; i++)
        tracks_add(plan, TRACK_NEUTRON_LOW, tracks_random_in_ball(30), tracks_random_in_ball(30));
    struct scene scene = tracks_scene(plan);
    struct image *whole = tracks_take(plan, &scene, tracks_front_view(), false);
    scene.clip.free.enabled = true;
    scene.clip.free.cap = false;
    scene.clip.free.origin_mm = vec3(2.03, 0, 1.01);
    scene.clip.free.normal = vec3(1, 0, 2); /* seen edge-on: it is a line in the picture */
    struct image *cut = tracks_take(plan, &scene, tracks_front_view(), false);
    size_t n_above = 0, n_below = 0;
    for (int y = 0; y < SHOTS_HEIGHT; y++)
        for (int x = 0; x < SHOTS_WIDTH; x++) {
            double height_px =
                ((x + 0.5 - 200 - 2.03 * TRACKS_PX_PER_MM) + 2 * (150 - y - 0.5 - 1.01 * TRACKS_PX_PER_MM)) / sqrt(5);
            if (height_px > 0.01) {
                n_above += tracks_is_lit(whole, x, y);
                assert_false(tracks_is_lit(cut, x, y));
            } else if (height_px < -1.5) { /* a cut line's samples may be one beside the whole line's */
                n_below += tracks_is_lit(whole, x, y) && tracks_is_lit(cut, x, y);
            }
        }
    size_t n_whole_below = 0;
    for (int y = 0; y < SHOTS_HEIGHT; y++)
        for (int x = 0; x < SHOTS_WIDTH; x++)
            n_whole_below += tracks_is_lit(whole, x, y) &&
                             (x + 0.5 - 200 - 2.03 * TRACKS_PX_PER_MM) + 2 * (150 - y - 0.5 - 1.01 * TRACKS_PX_PER_MM) <
                                 -1.5 * sqrt(5);
    assert_true(n_above > 1000 && n_whole_below > 1000);
    assert_true((double)n_below > 0.97 * (double)n_whole_below);
    scene.tracks.clipped = false;
    struct image *exempt = tracks_take(plan, &scene, tracks_front_view(), false);
    assert_memory_equal(exempt->rgba, whole->rgba, (size_t)SHOTS_WIDTH * SHOTS_HEIGHT * 4);
    image_destroy(whole);
    image_destroy(cut);
    image_destroy(exempt);
    scene_finish(&scene);
    shots_forget(plan);
}

/* Tracks in an opaque ball that is cut and capped: surface and cap hide all of them, also those that end at the cap. */
static void caps_and_opaque_surfaces_hide_the_tracks_behind_them(void **context)
{
    (void)context;
    tracks_random_begin();
    static const struct vec3 from[] = { { 0.2, -1, 0.9 }, { 0.7, -1, 0.15 }, { 0.05, -0.1, 1 } };
    struct plan *plan = tracks_plan();
    for (int i = 0; i < 1500; i++) {
        struct vec3 a = tracks_random_in_ball(25), b = vec3_add(a, tracks_random_in_ball(10));
        tracks_add(plan, TRACK_NEUTRON_LOW, a, vec3_length(b) < 25 ? b : a);
    }
    for (size_t i = 0; i < sizeof from / sizeof from[0]; i++)
        for (int still = 0; still < 2; still++) {
            struct scene scene = tracks_scene(plan);
            shots_style(&scene, "ball")->visible = true;
            scene.clip.axial_high.enabled = true;
            scene.clip.axial_high.position_mm = 4.3;
            scene.clip.coronal_low.enabled = true;
            scene.clip.coronal_low.position_mm = -7.7;
            struct view view = shots_view_from(tracks_middle, from[i], tracks_up, TRACKS_PX_PER_MM);
            struct image *with = tracks_take(plan, &scene, view, still);
            scene.tracks.visible = false;
            struct image *without = tracks_take(plan, &scene, view, still);
            assert_memory_equal(with->rgba, without->rgba, (size_t)SHOTS_WIDTH * SHOTS_HEIGHT * 4);
            image_destroy(with);
            scene_finish(&scene);
            image_destroy(without);
        }
    shots_forget(plan);
}

/* A track in front of the ball, one in it, one behind it. */
static void translucent_surfaces_lie_over_the_tracks_behind_their_front(void **context)
{
    (void)context;
    tracks_random_begin();
    struct plan *plan = tracks_plan();
    tracks_add(plan, TRACK_NEUTRON_LOW, vec3(-10, -40, 10), vec3(10, -40, 10));
    tracks_add(plan, TRACK_NEUTRON_LOW, vec3(-10, 0, 0), vec3(10, 0, 0));
    tracks_add(plan, TRACK_NEUTRON_LOW, vec3(-10, 40, -10), vec3(10, 40, -10));
    struct scene scene = tracks_scene(plan);
    scene.tracks.width_px = 4;
    scene.surface.translucency = SCENE_TRANSLUCENCY_PLAIN;
    shots_style(&scene, "ball")->visible = true;
    shots_style(&scene, "ball")->opacity = 0.4;
    struct image *with = tracks_take(plan, &scene, tracks_front_view(), true);
    scene.tracks.visible = false;
    struct image *without = tracks_take(plan, &scene, tracks_front_view(), true);
    for (int c = 0; c < 3; c++) {
        double track = color_of(TRACK_NEUTRON_LOW) >> (16 - 8 * c) & 255, behind = shots_background[c];
        assert_close(shots_pixel(with, 200, 110)[c], track, 1);
        for (int y = 150; y <= 190; y += 40)
            assert_close((double)shots_pixel(with, 200, y)[c] - shots_pixel(without, 200, y)[c], 0.6 * (track - behind),
                         2);
    }
    image_destroy(with);
    image_destroy(without);
    scene.tracks.visible = true;
    shots_style(&scene, "ball")->opacity = 1;
    with = tracks_take(plan, &scene, tracks_front_view(), true);
    scene.tracks.visible = false;
    without = tracks_take(plan, &scene, tracks_front_view(), true);
    assert_close(shots_pixel(with, 200, 110)[2], color_of(TRACK_NEUTRON_LOW) & 255, 1);
    for (int y = 150; y <= 190; y += 40)
        assert_memory_equal(shots_pixel(with, 200, y), shots_pixel(without, 200, y), 3);
    image_destroy(without);
    image_destroy(with);
    scene_finish(&scene);
    shots_forget(plan);
}

/* A line through an axial slice seen from above: the part above it is drawn. */
static void slices_hide_what_is_below_them(void **context)
{
    (void)context;
    tracks_random_begin();
    struct plan *plan = tracks_plan();
    tracks_add(plan, TRACK_NEUTRON_LOW, vec3(-20, 0, -20), vec3(20, 0, 20)); /* above the slice where L > 5 */
    struct scene scene = tracks_scene(plan);
    scene.image.slices.axial.visible = true;
    scene.image.slices.axial.position_mm = 5;
    struct image *image =
        tracks_take(plan, &scene, shots_view_from(tracks_middle, tracks_up, vec3(0, -1, 0), TRACKS_PX_PER_MM), false);
    /* from above with anterior up right is -L */
    for (int x = 121; x < 279; x++) {
        double left_mm = (200 - x - 0.5) / TRACKS_PX_PER_MM;
        bool is_yellow = shots_pixel(image, x, 149)[2] < 100 && shots_pixel(image, x, 149)[0] > 180;
        bool is_yellow_below = shots_pixel(image, x, 150)[2] < 100 && shots_pixel(image, x, 150)[0] > 180;
        if (fabs(left_mm - 5) > 0.3 && fabs(left_mm) < 19.7)
            assert_int_equal(is_yellow || is_yellow_below, left_mm > 5);
    }
    image_destroy(image);
    scene_finish(&scene);
    shots_forget(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(clip_planes_cut_segments_exactly),
        cmocka_unit_test(caps_and_opaque_surfaces_hide_the_tracks_behind_them),
        cmocka_unit_test(translucent_surfaces_lie_over_the_tracks_behind_their_front),
        cmocka_unit_test(slices_hide_what_is_below_them),
    };
    return shots_run_drivers("tracks, hidden", tests, sizeof tests / sizeof tests[0]);
}
