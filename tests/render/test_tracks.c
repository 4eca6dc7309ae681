/* Particle tracks in pictures: where their lines lie, which of them are drawn and how. */
#include "tests/render/track_scene.h"

static size_t n_lit(const struct image *image)
{
    size_t n = 0;
    for (int y = 0; y < image->height_px; y++)
        for (int x = 0; x < image->width_px; x++)
            n += tracks_is_lit(image, x, y);
    return n;
}

static size_t n_of_color(const struct image *image, uint32_t rgb)
{
    size_t n = 0;
    for (int y = 0; y < image->height_px; y++)
        for (int x = 0; x < image->width_px; x++) {
            const uint8_t *p = shots_pixel(image, x, y);
            n += p[0] == rgb >> 16 && p[1] == (rgb >> 8 & 255) && p[2] == (rgb & 255);
        }
    return n;
}

/* How much of each pixel a line of this colour covers, summed over the picture. */
static double covered_px(const struct image *image, uint32_t rgb)
{
    double sum = 0;
    for (int y = 0; y < image->height_px; y++)
        for (int x = 0; x < image->width_px; x++)
            sum += ((double)shots_pixel(image, x, y)[1] - shots_background[1]) /
                   ((double)(rgb >> 8 & 255) - shots_background[1]);
    return sum;
}

/* ---- where lines lie -------------------------------------------------------------------------------------------- */

/* A pinhole: 300 mm before the target, 30 degrees over the shorter side, which is the height. */
static void project(struct vec3 eye, struct vec3 p, double *x, double *y)
{
    struct vec3 forward = vec3_normalize(vec3_scale(eye, -1)), right = vec3_normalize(vec3_cross(forward, tracks_up)),
                above = vec3_cross(right, forward), way = vec3_sub(p, eye);
    double scale = SHOTS_HEIGHT / 2.0 / tan(15 * MATH_PI / 180) / vec3_dot(way, forward);
    *x = SHOTS_WIDTH / 2.0 + scale * vec3_dot(way, right);
    *y = SHOTS_HEIGHT / 2.0 - scale * vec3_dot(way, above);
}

static void lines_lie_where_their_points_are_projected(void **context)
{
    (void)context;
    tracks_random_begin();
    struct plan *plan = tracks_plan();
    const struct vec3 eye = vec3_scale(vec3_normalize(vec3(0.4, -1, 0.3)), 300);
    struct view view = shots_view_from(tracks_middle, eye, tracks_up, 1);
    view.camera.projection = SCENE_PROJECTION_PERSPECTIVE;
    view.camera.has_height_mm = false;
    view.camera.position_mm = eye;
    view.camera.fov_deg = 30;
    for (int line = 0; line < 12; line++) {
        struct vec3 a = tracks_random_in_ball(40), b = tracks_random_in_ball(40);
        plan->tracks.n_segments = plan->tracks.n_of_class[TRACK_NEUTRON_LOW] = 0;
        tracks_add(plan, TRACK_NEUTRON_LOW, a, b);
        renderer_forget(shots_renderer, plan); /* the plan has changed */
        for (int still = 0; still < 2; still++) {
            struct image *image = tracks_take_alone(plan, view, still);
            double x, y, ax, ay, bx, by;
            for (int i = 0; i <= 50; i++) {
                project(eye, vec3_add(a, vec3_scale(vec3_sub(b, a), i / 50.0)), &x, &y);
                bool is_found = false; /* within a pixel: the ends are half pixels */
                for (int dy = -1; dy <= 1; dy++)
                    for (int dx = -1; dx <= 1; dx++)
                        is_found |= tracks_is_lit(image, (int)x + dx, (int)y + dy) && hypot(dx, dy) < 1.1;
                assert_true(is_found);
            }
            project(eye, a, &ax, &ay);
            project(eye, b, &bx, &by);
            double length = hypot(bx - ax, by - ay);
            for (int row = 0; row < SHOTS_HEIGHT; row++)
                for (int column = 0; column < SHOTS_WIDTH; column++) {
                    double u = column + 0.5 - ax, v = row + 0.5 - ay,
                           along = fmin(fmax((u * (bx - ax) + v * (by - ay)) / length, 0), length),
                           away = hypot(u - along * (bx - ax) / length, v - along * (by - ay) / length);
                    if (away > 1.6)
                        assert_false(tracks_is_lit(image, column, row));
                }
            image_destroy(image);
        }
    }
    shots_forget(plan);
}

static void a_still_covers_the_width_of_a_line_and_its_square_ends(void **context)
{
    (void)context;
    tracks_random_begin();
    static const struct vec3 ends[][2] = {
        { { -30, 0, 3 }, { 30, 0, 3 } }, { { 5, 0, -25 }, { 5, 0, 25 } }, { { -20, 0, -17 }, { 22, 0, 19 } },
        { { -20, 0, 9 }, { 22, 0, 4 } }, { { 3, 0, 9 }, { 4, 0, -20 } },
    };
    for (size_t i = 0; i < sizeof ends / sizeof ends[0]; i++)
        for (int width = 2; width <= 8; width += 3) {
            struct plan *plan = tracks_plan();
            struct scene scene = tracks_scene(plan);
            scene.tracks.width_px = width;
            tracks_add(plan, TRACK_NEUTRON_LOW, ends[i][0], ends[i][1]);
            struct image *image = tracks_take(plan, &scene, tracks_front_view(), true);
            double length = TRACKS_PX_PER_MM * vec3_length(vec3_sub(ends[i][1], ends[i][0]));
            assert_close(covered_px(image, color_of(TRACK_NEUTRON_LOW)), (length + width) * width,
                         0.04 * length * width);
            scene_finish(&scene);
            image_destroy(image);
            shots_forget(plan);
        }
}

static void a_moving_picture_has_one_sample_a_column_or_row(void **context)
{
    (void)context;
    tracks_random_begin();
    struct plan *plan = tracks_plan();
    tracks_add(plan, TRACK_NEUTRON_LOW, vec3(-30.1, 0, -7.3), vec3(30.1, 5, 11.7)); /* 79.6 .. 320.4 */
    tracks_add(plan, TRACK_NEUTRON_HIGH, vec3(3.6, 0, -30.2), vec3(-4.3, 5, 30.2)); /* 29.2 .. 270.8 */
    struct scene scene = tracks_scene(plan);
    scene.tracks.classes.neutron_high = false;
    struct image *image = tracks_take(plan, &scene, tracks_front_view(), false);
    for (int x = 0; x < SHOTS_WIDTH; x++) {
        int n = 0;
        for (int y = 0; y < SHOTS_HEIGHT; y++)
            n += tracks_is_lit(image, x, y);
        assert_int_equal(n, x >= 79 && x <= 320);
    }
    assert_int_equal(n_of_color(image, color_of(TRACK_NEUTRON_LOW)), 242);
    image_destroy(image);
    scene.tracks.classes.neutron_high = true;
    scene.tracks.classes.neutron_low = false;
    image = tracks_take(plan, &scene, tracks_front_view(), false);
    for (int y = 0; y < SHOTS_HEIGHT; y++) {
        int n = 0;
        for (int x = 0; x < SHOTS_WIDTH; x++)
            n += tracks_is_lit(image, x, y);
        assert_int_equal(n, y >= 29 && y <= 270);
    }
    image_destroy(image);
    scene_finish(&scene);
    shots_forget(plan);
}

static void segments_without_length_and_seen_end_on_are_dots(void **context)
{
    (void)context;
    tracks_random_begin();
    struct plan *plan = tracks_plan();
    tracks_add(plan, TRACK_NEUTRON_LOW, vec3(0.1, 0, 0.1), vec3(0.1, 0, 0.1));
    tracks_add(plan, TRACK_NEUTRON_HIGH, vec3(10.1, -9, 0.1), vec3(10.1, 9, 0.1));
    struct scene scene = tracks_scene(plan);
    struct image *image = tracks_take(plan, &scene, tracks_front_view(), false);
    assert_int_equal(n_lit(image), 2);
    assert_true(tracks_is_lit(image, 200, 149) && tracks_is_lit(image, 240, 149));
    image_destroy(image);
    scene.tracks.width_px = 4;
    scene.tracks.classes.neutron_high = false;
    image = tracks_take(plan, &scene, tracks_front_view(), true);
    assert_close(covered_px(image, color_of(TRACK_NEUTRON_LOW)), 16, 0.1);
    image_destroy(image);
    scene_finish(&scene);
    shots_forget(plan);
}

static void tracks_from_far_outside_the_plan_are_whole(void **context)
{
    (void)context;
    tracks_random_begin();
    struct plan *plan = tracks_plan();
    tracks_add(plan, TRACK_NEUTRON_LOW, vec3(-1e6, 2e5, 1), vec3(1e6, -2e5, 1));
    tracks_add(plan, TRACK_NEUTRON_LOW, vec3(NAN, 0, 9), vec3(20, 0, 9));
    tracks_add(plan, TRACK_NEUTRON_LOW, vec3(-20, 5000, -9), vec3(20, 5000, -9));   /* beyond the far plane */
    tracks_add(plan, TRACK_NEUTRON_LOW, vec3(-20, -450, -12), vec3(20, -450, -12)); /* before the near plane */
    for (int still = 0; still < 2; still++) {
        struct image *image = tracks_take_alone(plan, tracks_front_view(), still);
        for (int x = 0; x < SHOTS_WIDTH; x++)
            assert_true(tracks_is_lit(image, x, 145) || tracks_is_lit(image, x, 146));
        for (int x = 121; x < 279; x++) {
            assert_true(tracks_is_lit(image, x, 186) || tracks_is_lit(image, x, 185));
            assert_true(tracks_is_lit(image, x, 198) || tracks_is_lit(image, x, 197));
            assert_false(tracks_is_lit(image, x, 114) || tracks_is_lit(image, x, 113));
        }
        image_destroy(image);
    }
    shots_forget(plan);
}

/* ---- which are drawn, and how ----------------------------------------------------------------------------------- */

static void classes_places_in_the_file_and_energies_choose_the_segments(void **context)
{
    (void)context;
    tracks_random_begin();
    struct plan *plan = tracks_plan();
    for (int class = 0; class < TRACK_N_CLASSES; class ++)
        for (int i = 0; i < 2; i++) { /* rows 16 px apart; the second one has an energy */
            double z = 30 - 4 * (2 * class + i);
            struct track_segment *segment = tracks_add(plan, (enum track_class) class, vec3(-20, 0, z), vec3(20, 0, z));
            segment->energy_mev = i ? (float)class : NAN;
        }
    struct scene scene = tracks_scene(plan);
    struct {
        struct scene_track_style style;
        uint32_t rows; /* by bit 2 class + i */
    } cases[9];
    for (int i = 0; i < 9; i++)
        cases[i].style = scene.tracks;
    cases[0].rows = 0xffff;
    cases[1].style.classes.neutron_medium = cases[1].style.classes.gamma_low = false;
    cases[1].rows = 0xffff & ~(3u << 2) & ~(3u << 10);
    cases[2].style.first = 5;
    cases[2].rows = 0xffe0;
    cases[3].style.first = 5;
    cases[3].style.has_count = true;
    cases[3].style.count = 6;
    cases[3].rows = 0x07e0;
    cases[4].style.has_count = true;
    cases[4].style.count = 0;
    cases[4].rows = 0;
    cases[5].style.has_energy_low_mev = true;
    cases[5].style.energy_low_mev = 3;
    cases[5].rows = 0xffff & ~0x2au; /* energies 0, 1, 2 */
    cases[6].style.has_energy_high_mev = true;
    cases[6].style.energy_high_mev = 3;
    cases[6].rows = 0xffff & ~0xaa00u; /* energies 4, 5, 6, 7 */
    cases[7].style.first = 16;
    cases[7].rows = 0;
    cases[8].style.visible = false;
    cases[8].rows = 0;
    for (int i = 0; i < 9; i++)
        for (int still = 0; still < 2; still++) {
            scene.tracks = cases[i].style;
            struct image *image = tracks_take(plan, &scene, tracks_front_view(), still);
            for (int row = 0; row < 16; row++) {
                int y = (int)(150 - TRACKS_PX_PER_MM * (30 - 4 * row)), n = 0;
                for (int x = 110; x < 250; x++)
                    n += tracks_is_lit(image, x, y) || tracks_is_lit(image, x, y - 1);
                assert_int_equal(n > 50, cases[i].rows >> row & 1);
                if (n > 50 && !still) {
                    const uint8_t *p = shots_pixel(image, 121, tracks_is_lit(image, 121, y) ? y : y - 1);
                    uint32_t rgb = color_of((enum track_class)(row / 2));
                    assert_int_equal(p[0] << 16 | p[1] << 8 | p[2], rgb);
                }
            }
            image_destroy(image);
        }
    scene_finish(&scene);
    shots_forget(plan);
}

static void lost_particles_are_dashed_and_end_in_a_cross(void **context)
{
    (void)context;
    tracks_random_begin();
    struct plan *plan = tracks_plan();
    tracks_add(plan, TRACK_LOST, vec3(-24.95, 0, 10.1), vec3(25.05, 0, 10.1)); /* from x = 100.2 to 300.2, row 109 */
    tracks_add(plan, TRACK_GAMMA_MEDIUM, vec3(25.05, 0, -10.1),
               vec3(-24.95, 0, -10.1)); /* from 300.2 to 100.2, row 190 */
    struct image *image = tracks_take_alone(plan, tracks_front_view(), false);
    for (int x = 101; x < 294; x++) {
        double along = x + 0.5 - 100.2;
        double phase = fmod(along, 10);
        if (phase > 1 && fabs(phase - 6) > 1 && phase < 9)
            assert_int_equal(tracks_is_lit(image, x, 109), phase < 6);
        phase = fmod(300.2 - x - 0.5, 11);
        if (phase > 1 && fabs(phase - 8) > 1 && phase < 10)
            assert_int_equal(tracks_is_lit(image, x, 190), phase < 8);
    }
    /* the arms of the cross, and nothing above and below its middle; none at the first end */
    for (int i = -3; i <= 3; i++) {
        assert_true(tracks_is_lit(image, 300 + i, 109 + i) || tracks_is_lit(image, 300 + i, 110 + i));
        assert_true(tracks_is_lit(image, 300 + i, 109 - i) || tracks_is_lit(image, 300 + i, 110 - i));
    }
    assert_false(tracks_is_lit(image, 300, 105) || tracks_is_lit(image, 300, 114));
    for (int i = 2; i <= 4; i++)
        assert_false(tracks_is_lit(image, 100 - i, 109 - i) || tracks_is_lit(image, 100 + i, 109 + i) ||
                     tracks_is_lit(image, 300 + i, 190 + i));
    image_destroy(image);
    struct scene scene = tracks_scene(plan); /* the end is cut off: no cross */
    scene.clip.sagittal_high.enabled = true;
    scene.clip.sagittal_high.position_mm = 10;
    scene.tracks.classes.gamma_medium = false;
    image = tracks_take(plan, &scene, tracks_front_view(), false);
    for (int y = 0; y < SHOTS_HEIGHT; y++)
        for (int x = 0; x < SHOTS_WIDTH; x++)
            assert_true(!tracks_is_lit(image, x, y) || y == 109);
    image_destroy(image);
    scene_finish(&scene);
    shots_forget(plan);
}

static void lines_are_darker_where_they_are_farther_away(void **context)
{
    (void)context;
    tracks_random_begin();
    struct plan *plan = tracks_plan();
    tracks_add(plan, TRACK_NEUTRON_LOW, vec3(-24, -31, 0.1), vec3(24, 31, 0.1)); /* away to the right */
    for (int still = 0; still < 2; still++) {
        struct scene scene = tracks_scene(plan);
        scene.tracks.width_px = 3;
        struct image *plain = tracks_take(plan, &scene, tracks_front_view(), still);
        scene.tracks.depth_cue = true;
        struct image *cued = tracks_take(plan, &scene, tracks_front_view(), still);
        for (int x = 106; x < 294; x++) {
            assert_int_equal(shots_pixel(plain, x, 149)[0], shots_pixel(plain, 106, 149)[0]);
            assert_true(shots_pixel(cued, x, 149)[0] <= shots_pixel(cued, x - 1, 149)[0]);
        }
        double nearest = shots_pixel(cued, 106, 149)[0], farthest = shots_pixel(cued, 293, 149)[0],
               full = color_of(TRACK_NEUTRON_LOW) >> 16;
        assert_true(nearest > 0.93 * full && farthest > 0.4 * full - 1 && farthest < 0.47 * full);
        scene_finish(&scene);
        image_destroy(plain);
        image_destroy(cued);
    }
    shots_forget(plan);
}

static void without_tracks_pictures_are_as_they_were(void **context)
{
    (void)context;
    tracks_random_begin();
    for (int still = 0; still < 2; still++) {
        struct plan *none = tracks_plan(), *some = tracks_plan();
        for (int i = 0; i < 300; i++)
            tracks_add(some, (enum track_class)(i % TRACK_N_CLASSES), tracks_random_in_ball(40),
                       tracks_random_in_ball(40));
        struct scene scene = shots_scene(none);
        shots_style(&scene, "ball")->opacity = 0.5;
        scene.image.slices.axial.visible = true;
        struct image *a = tracks_take(none, &scene, tracks_front_view(), still),
                     *b = tracks_take(some, &scene, tracks_front_view(), still);
        assert_memory_equal(a->rgba, b->rgba, (size_t)SHOTS_WIDTH * SHOTS_HEIGHT * 4);
        image_destroy(a);
        image_destroy(b);
        struct view pane = shots_view(SCENE_KIND_AXIAL, tracks_middle, TRACKS_PX_PER_MM);
        a = tracks_take(some, &scene, pane, still);
        scene.tracks.visible = true;
        b = tracks_take(some, &scene, pane, still);
        assert_memory_equal(a->rgba, b->rgba, (size_t)SHOTS_WIDTH * SHOTS_HEIGHT * 4);
        image_destroy(a);
        image_destroy(b);
        scene_finish(&scene);
        shots_forget(none);
        shots_forget(some);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lines_lie_where_their_points_are_projected),
        cmocka_unit_test(a_still_covers_the_width_of_a_line_and_its_square_ends),
        cmocka_unit_test(a_moving_picture_has_one_sample_a_column_or_row),
        cmocka_unit_test(segments_without_length_and_seen_end_on_are_dots),
        cmocka_unit_test(tracks_from_far_outside_the_plan_are_whole),
        cmocka_unit_test(classes_places_in_the_file_and_energies_choose_the_segments),
        cmocka_unit_test(lost_particles_are_dashed_and_end_in_a_cross),
        cmocka_unit_test(lines_are_darker_where_they_are_farther_away),
        cmocka_unit_test(without_tracks_pictures_are_as_they_were),
    };
    return shots_run_drivers("tracks", tests, sizeof tests / sizeof tests[0]);
}
