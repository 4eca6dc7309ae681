/* The beam slice and the clip plane across the beam: which point of the patient each pixel shows, in 3-D, in the
 * beam's-eye view and as a pane; image, colourwash and isodose lines, alone and in one plane with caps. */
#include "core/render/visible/visible.h"
#include "tests/render/dose_scene.h"
#include "tests/render/wash_scene.h"

static struct vec3 along(struct vec3 from, struct vec3 direction, double mm)
{
    return vec3_add(from, vec3_scale(direction, mm));
}

static const struct vec3 directions[] = { { 3 / 13.0, 4 / 13.0, 12 / 13.0 },
                                          { -24 / 41.0, 32 / 41.0, 9 / 41.0 },
                                          { 12 / 25.0, -9 / 25.0, -20 / 25.0 },
                                          { 0, 0, -1 } };
enum { N_DIRECTIONS = sizeof directions / sizeof directions[0] };
static const struct vec3 beam_target = { 1.3, -0.7, 2.1 };

/* The entry is 60 mm before the target, so that 60 + mm is the slice mm beyond the target. */
static void set_beam(struct plan *plan, struct vec3 direction)
{
    plan->n_beams = 1;
    plan->beams[0] = (struct beam){
        .id = "b", .entry_lps_mm = along(beam_target, direction, -60), .target_lps_mm = beam_target, .aperture_mm = 100
    };
}

/* The expected plane: through the point, square to the beam. */
static struct plane slice_plane(struct vec3 direction, double beyond_target_mm)
{
    struct beam_shown axes = { .direction = direction,
                               .entry_lps_mm = along(beam_target, direction, beyond_target_mm) };
    return beam_plane(&axes, 0);
}

enum picture { SPACE_BEFORE, SPACE_ASKEW, EYE_PARALLEL, EYE_PERSPECTIVE, EYE_AT_THE_SLICE, PANE, N_PICTURES };
static const char *const pictures[] = {
    "3-D from the entry", "3-D askew", "beam's eye", "beam's eye in perspective", "beam's eye at the slice", "pane"
};

static struct view view_of(enum picture picture, struct vec3 direction, double beyond_target_mm)
{
    struct plane plane = slice_plane(direction, beyond_target_mm);
    struct view view = shots_view_from(vec3(1, 0, 0.5), vec3_scale(direction, -1), plane.up, 4.6);
    if (picture == SPACE_ASKEW) {
        struct vec3 from =
            vec3_add(vec3_scale(direction, -1), vec3_add(vec3_scale(plane.right, 0.4), vec3_scale(plane.up, -0.3)));
        view.camera.projection = SCENE_PROJECTION_PERSPECTIVE;
        view.camera.has_height_mm = false;
        view.camera.fov_deg = 30;
        view.camera.position_mm = vec3_add(view.camera.target_mm, vec3_scale(vec3_normalize(from), 130));
    }
    if (picture == SPACE_BEFORE || picture == SPACE_ASKEW)
        return view;
    view.kind = picture == PANE ? SCENE_KIND_BEAM_SLICE : SCENE_KIND_BEAM;
    view.beam.crosshair = false;
    view.beam.has_along_mm = picture == EYE_PERSPECTIVE || picture == EYE_AT_THE_SLICE;
    view.beam.along_mm = picture == EYE_PERSPECTIVE ? -80 : 60 + beyond_target_mm;
    if (picture == EYE_PERSPECTIVE)
        view.camera.projection = SCENE_PROJECTION_PERSPECTIVE;
    return view;
}

static struct camera camera_in(struct plan *plan, const struct scene *scene, struct view view)
{
    struct error err = { 0 };
    char field[128];
    struct scene copy;
    struct camera camera;
    scene_copy(&copy, scene);
    struct snapshot *snapshot = snapshot_create(derived_of(plan), &copy, &view, 1, field, &err);
    assert_string_equal(err.text, "");
    camera_resolve(snapshot, &camera);
    snapshot_unref(snapshot);
    return camera;
}

/* The slice, and the clip plane `apart_mm` before it; NAN: none. */
static void set_slice(struct scene *scene, double beyond_target_mm, double apart_mm)
{
    scene->beam.slice.visible = true;
    scene->beam.slice.along_mm = 60 + beyond_target_mm;
    scene->clip.beam.enabled = !isnan(apart_mm);
    scene->clip.beam.along_mm = isnan(apart_mm) ? 0 : 60 + beyond_target_mm - apart_mm;
}

/* ---- the image -------------------------------------------------------------------------------------------------- */

static double linear(struct vec3 p)
{
    return 100 + p.x + 0.8 * p.y - 1.2 * p.z;
}

static double box(struct vec3 p)
{
    return wash_is_in_box(p);
}

/* A cube of 64 mm, the image between the centres of its outermost voxels linear, a box of 48 x 40 x 44 mm in it. */
static struct plan *linear_plan(void)
{
    static const struct made_region regions[] = { { "box", -1, 0xff2020 } };
    struct grid grid = made_cube_grid(64);
    struct plan *plan = made_plan(&grid, box, regions, 1);
    made_plan_add_image(plan, &grid, VOXEL_F32, linear);
    return plan;
}

static bool is_within(struct vec3 p, double half_mm)
{
    return fabs(p.x) < half_mm && fabs(p.y) < half_mm && fabs(p.z) < half_mm;
}

/* On a side of the box: where its wall ends in the slice, at the same depth. */
static bool is_at_wall(struct vec3 p)
{
    return wash_is_in_box(vec3_scale(p, 0.995)) && !wash_is_in_box(vec3_scale(p, 1.005));
}

/* True if the ray through p passes the line of the scene's draft, which is drawn but in its own view, within 4 mm. */
static bool is_at_draft(const struct scene *scene, const struct camera *camera, struct vec3 p)
{
    const struct scene_beam_line *line = &scene->beam.draft.line;
    struct vec3 from = vec3_sub(p, line->entry_mm), d = vec3_normalize(vec3_sub(line->target_mm, line->entry_mm));
    struct vec3 ray = camera->is_parallel ? camera->forward : vec3_normalize(vec3_sub(p, camera->eye_lps_mm));
    struct vec3 across = vec3_cross(ray, d);
    double apart_mm = vec3_length(across) > 1e-3 ? fabs(vec3_dot(from, vec3_normalize(across)))
                                                 : vec3_length(vec3_sub(from, vec3_scale(d, vec3_dot(from, d))));
    return scene->beam.draft.enabled && apart_mm < 4;
}

/* Each pixel whose ray meets the slice inside the image shows its value there, whatever else lies in the plane. */
static void expect_image(struct plan *plan, struct scene scene, struct view view, struct plane plane, const char *what)
{
    struct wash_places places = { .camera = camera_in(plan, &scene, view), .plane = plane };
    scene.image.window = (struct scene_window){ .center = 100, .width = 240, .gamma = 1 };
    const struct scene same = scene; /* its numbers */
    struct image *image = shots_plain(plan, scene, view);
    size_t n = 0;
    for (int y = 0; y < SHOTS_HEIGHT; y++)
        for (int x = 0; x < SHOTS_WIDTH; x++) {
            struct vec3 p;
            (void)wash_on_plane(&places, x, y, &p);
            if (!is_within(p, 31) || is_at_wall(p) ||
                (view.kind != SCENE_KIND_BEAM && is_at_draft(&same, &places.camera, p)))
                continue;
            double grey = 255 * ((linear(p) - 100) / 240 + 0.5);
            const uint8_t *pixel = shots_pixel(image, x, y);
            for (int c = 0; c < 3; c++)
                if (fabs(pixel[c] - grey) > 1.1)
                    fail_msg("%s: pixel %d %d is %d %d %d, expected %g", what, x, y, pixel[0], pixel[1], pixel[2],
                             grey);
            n++;
        }
    assert_true(n > 20000);
    image_destroy(image);
}

static struct scene linear_scene(const struct plan *plan, bool has_box)
{
    struct scene scene = shots_scene(plan);
    scene.regions[0].value.visible = has_box;
    scene.outline.on_slices = false;
    return scene;
}

static void every_pixel_of_the_slice_shows_the_image_where_its_ray_meets_the_plane(void **state)
{
    (void)state;
    struct plan *plan = linear_plan();
    for (int d = 0; d < N_DIRECTIONS; d++) {
        set_beam(plan, directions[d]);
        for (enum picture picture = 0; picture < N_PICTURES; picture++) {
            double mm = 5.3 - 4 * d;
            struct scene scene = linear_scene(plan, false);
            set_slice(&scene, mm, NAN);
            expect_image(plan, scene, view_of(picture, directions[d], mm), slice_plane(directions[d], mm),
                         pictures[picture]);
        }
    }
    shots_forget(plan);
}

/* In one plane with the cap of the box that the clip plane cuts through, seen from the side that is cut off. */
static void slice_and_clip_plane_at_one_place_show_one_picture(void **state)
{
    (void)state;
    struct plan *plan = linear_plan();
    for (int d = 0; d < N_DIRECTIONS; d++) {
        set_beam(plan, directions[d]);
        for (enum picture picture = 0; picture < PANE; picture++)
            for (int has_cap = (int)picture % 2; has_cap < 2; has_cap++) {
                double mm = 7.7 * d - 9;
                struct scene scene = linear_scene(plan, true);
                set_slice(&scene, mm, 0);
                scene.clip.beam.cap = has_cap;
                expect_image(plan, scene, view_of(picture, directions[d], mm), slice_plane(directions[d], mm),
                             pictures[picture]);
            }
    }
    shots_forget(plan);
}

/* True if no point from here on along the beam, up to a length, is in the box or close to it. */
static bool misses_box(struct vec3 p, struct vec3 direction, double from_mm, double to_mm)
{
    for (double mm = from_mm; mm <= to_mm; mm += 0.5)
        if (wash_is_in_box(vec3_scale(along(p, direction, mm), 0.95)))
            return false;
    return true;
}

/* Apart: with the clip plane 10 mm before the slice the box stands 10 mm over it; with the clip plane 10 mm beyond it
 * the slice is cut off, and the cap shows the image in the clip plane. */
static void slice_and_clip_plane_slide_apart(void **state)
{
    (void)state;
    struct plan *plan = linear_plan();
    for (int d = 0; d < N_DIRECTIONS; d++) {
        set_beam(plan, directions[d]);
        for (int is_beyond = 0; is_beyond < 2; is_beyond++) {
            struct scene scene = linear_scene(plan, true);
            struct view view = view_of(EYE_PARALLEL, directions[d], -2);
            set_slice(&scene, -2, is_beyond ? -10 : 10);
            scene.clip.beam.cap = is_beyond;
            struct wash_places places = { .camera = camera_in(plan, &scene, view),
                                          .plane = slice_plane(directions[d], is_beyond ? 8 : -2) };
            scene.image.window = (struct scene_window){ .center = 100, .width = 240, .gamma = 1 };
            struct image *image = shots_plain(plan, scene, view);
            size_t n_image = 0, n_background = 0;
            for (int y = 0; y < SHOTS_HEIGHT; y++)
                for (int x = 0; x < SHOTS_WIDTH; x++) {
                    struct vec3 p;
                    (void)wash_on_plane(&places, x, y, &p);
                    const uint8_t *pixel = shots_pixel(image, x, y);
                    bool is_image = is_beyond ? wash_is_in_box(vec3_scale(p, 1.05))
                                              : is_within(p, 31) && misses_box(p, directions[d], -10.5, 0);
                    if (is_image) {
                        n_image++;
                        assert_close(pixel[0], 255 * ((linear(p) - 100) / 240 + 0.5), 1.1);
                    } else if (is_beyond && misses_box(p, directions[d], -0.5, 90)) {
                        n_background++;
                        assert_memory_equal(pixel, shots_background, 3);
                    }
                }
            assert_true(n_image > 3000 && (!is_beyond || n_background > 3000));
            image_destroy(image);
        }
    }
    shots_forget(plan);
}

/* Beams are drawn as lines alone. */
static void hide_openings(struct scene *scene)
{
    scene->beam.n_looks = 1;
    scene->beam.looks = mem_new(sizeof *scene->beam.looks);
    scene->beam.looks[0] = (struct scene_beam_look_entry){ .id = "b", .value = scene_beam_look_default };
    scene->beam.looks[0].value.opening = false;
}

/* A draft slides slice and clip plane with it; the planned beam's are seen nowhere. */
static void the_slice_of_a_draft_lies_across_the_draft(void **state)
{
    (void)state;
    struct plan *plan = linear_plan();
    for (int d = 0; d < N_DIRECTIONS; d++) {
        set_beam(plan, directions[(d + 1) % N_DIRECTIONS]);
        for (int end = 0; end < 2; end++) { /* beside all pictures, as it is drawn too */
            struct vec3 *at = end ? &plan->beams[0].target_lps_mm : &plan->beams[0].entry_lps_mm;
            *at = along(*at, vec3(1, 0, 0), 1000);
        }
        for (enum picture picture = 0; picture < N_PICTURES; picture++) {
            struct scene scene = linear_scene(plan, picture != PANE);
            scene.beam.draft.enabled = true;
            hide_openings(&scene);
            scene.beam.draft.line.entry_mm = along(beam_target, directions[d], -60);
            scene.beam.draft.line.target_mm = beam_target;
            set_slice(&scene, 3, 0);
            expect_image(plan, scene, view_of(picture, directions[d], 3), slice_plane(directions[d], 3),
                         pictures[picture]);
        }
    }
    shots_forget(plan);
}

/* ---- dose ------------------------------------------------------------------------------------------------------- */

static void every_pixel_of_the_slice_has_the_colour_of_the_dose_there(void **state)
{
    (void)state;
    static const struct wash_field field = { { 1.1, -0.4, 0.9 }, 50 };
    for (int d = 0; d < N_DIRECTIONS; d++) {
        struct grid grid = wash_random_grid(d);
        struct plan *plan = wash_plan(&grid, &field);
        struct wash_dose dose = { wash_dose_linear, &grid, &field, false };
        set_beam(plan, directions[d]);
        for (enum picture picture = 0; picture < N_PICTURES; picture++) {
            double mm = 4 * d - 6;
            if (d > 1 && (int)picture % 2 == d % 2)
                continue;
            bool has_caps = d % 2 && picture != PANE;
            struct scene scene = wash_scene(plan, d % 2, 0.6);
            for (size_t i = 0; i < scene.n_regions; i++)
                scene.regions[i].value.visible = has_caps;
            set_slice(&scene, mm, has_caps ? 0 : (double)NAN);
            struct view view = view_of(picture, directions[d], mm);
            struct wash_places places = { .point = wash_on_plane,
                                          .camera = camera_in(plan, &scene, view),
                                          .plane = slice_plane(directions[d], mm),
                                          .slack = 0.04 };
            wash_expect(plan, scene, view, places, &dose, 3000, pictures[picture]);
        }
        shots_forget(plan);
    }
}

/* The dose is 60 Gy less the distance from its peak: on the plane h from the peak the line of 30 Gy is a circle of
 * sqrt(30^2 - h^2) mm around the peak's foot. */
static const struct {
    enum picture picture;
    double h_mm, level_gy, eye_mm;
} ways[] = { { EYE_PARALLEL, 12, 30, NAN }, { PANE, 12, 30, NAN }, { EYE_PERSPECTIVE, 3, 45, 30 } };
static void isodose_lines_on_the_slice_are_the_circles_of_the_dose(void **state)
{
    (void)state;
    static const uint32_t line_rgb = 0x30ff40;
    const double width_px = 6;
    struct plan *plan = dose_scene_plan(false);
    for (int d = 0; d < N_DIRECTIONS; d++) {
        plan->n_beams = 1;
        plan->beams[0] = (struct beam){ .id = "b",
                                        .entry_lps_mm = along(dose_scene_peak_mm, directions[d], -50),
                                        .target_lps_mm = along(dose_scene_peak_mm, directions[d], 10),
                                        .aperture_mm = 100 };
        for (int where = 0; where < 3; where++) {
            const double h = ways[where].h_mm, level_gy = ways[where].level_gy, eye_mm = ways[where].eye_mm;
            struct scene scene = dose_scene(plan);
            free(scene.dose.levels);
            scene.dose.levels = mem_new(sizeof *scene.dose.levels);
            scene.dose.n_levels = 1;
            scene.dose.levels[0] = (struct scene_dose_level_entry){ .id = "a", .value = scene_dose_level_default };
            scene.dose.levels[0].value.value = level_gy;
            scene.dose.levels[0].value.unit = SCENE_DOSE_UNIT_DOSE;
            scene.dose.levels[0].value.color_rgb = line_rgb;
            scene.dose.lines = (struct scene_dose_lines){ true, width_px };
            scene.beam.slice.visible = true;
            scene.beam.slice.along_mm = 50 + h;
            struct view view = view_of(ways[where].picture, directions[d], 0);
            double pixels_per_mm = 4.6;
            if (!isnan(eye_mm)) { /* at the very target, which says nothing of how large pixels are */
                view.beam.along_mm = eye_mm;
                view.camera.fov_deg = 100;
                plan->beams[0].target_lps_mm = along(plan->beams[0].entry_lps_mm, directions[d], eye_mm);
                pixels_per_mm = SHOTS_HEIGHT / 2.0 / ((50 + h - eye_mm) * tan(50 * MATH_PI / 180));
            }
            struct beam_shown axes = { .direction = directions[d], .entry_lps_mm = plan->beams[0].entry_lps_mm };
            struct wash_places places = { .camera = camera_in(plan, &scene, view), .plane = beam_plane(&axes, 50 + h) };
            struct image *image = shots_plain(plan, scene, view);
            /* the dose's voxels are 3 mm: 0.11 mm off; half a pixel of the edge's softness */
            const double slack_px = 0.11 * pixels_per_mm + 0.7;
            size_t n_line = 0, n_wrong = 0;
            for (int y = 0; y < SHOTS_HEIGHT; y++)
                for (int x = 0; x < SHOTS_WIDTH; x++) {
                    struct vec3 p;
                    (void)wash_on_plane(&places, x, y, &p);
                    struct vec3 ijk = affine_point(&plan->doses[0].components[0].values->grid.ijk_from_lps_mm, p);
                    if (ijk.x < 0.5 || ijk.y < 0.5 || ijk.z < 0.5 || ijk.x > 27.5 || ijk.y > 31.5 || ijk.z > 22.5)
                        continue; /* beyond its outermost centres the dose is constant */
                    struct vec3 from = vec3_sub(p, dose_scene_peak_mm);
                    double r = sqrt(fmax(0, vec3_dot(from, from) - h * h)),
                           radius = sqrt(pow(60 - level_gy, 2) - h * h);
                    double off = fabs(r - radius) * pixels_per_mm;
                    const uint8_t *pixel = shots_pixel(image, x, y);
                    bool is_line = pixel[0] == 0x30 && pixel[1] == 0xff && pixel[2] == 0x40;
                    n_line += off < width_px / 2 - slack_px;
                    n_wrong += off < width_px / 2 - slack_px ? !is_line : off > width_px / 2 + 1 + slack_px && is_line;
                }
            if (n_wrong > 0)
                fail_msg("direction %d, %s: %zu pixels are wrong", d, pictures[ways[where].picture], n_wrong);
            assert_true(n_line > 300);
            image_destroy(image);
        }
    }
    shots_forget(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_pixel_of_the_slice_shows_the_image_where_its_ray_meets_the_plane),
        cmocka_unit_test(slice_and_clip_plane_at_one_place_show_one_picture),
        cmocka_unit_test(slice_and_clip_plane_slide_apart),
        cmocka_unit_test(the_slice_of_a_draft_lies_across_the_draft),
        cmocka_unit_test(every_pixel_of_the_slice_has_the_colour_of_the_dose_there),
        cmocka_unit_test(isodose_lines_on_the_slice_are_the_circles_of_the_dose),
    };
    return shots_run_drivers("beam slice", tests, sizeof tests / sizeof tests[0]);
}
