/* Isodose lines in pictures: where they are by geometry on panes, slices and caps, what hides them, and that both back
 * ends draw the same. */
#include "core/scene/camera.h"
#include "tests/render/dose_scene.h"

static const uint32_t line_rgb = 0x30ff40;
enum { WIDTH_PX = 6 };
static const double level_gy = 30, pixels_per_mm = 5;
static const struct vec3 middle = { 1.3, -2.2, 3.05 };

static void set_level(struct scene *scene, double gy)
{
    free(scene->dose.levels);
    scene->dose.levels = mem_new(sizeof *scene->dose.levels);
    scene->dose.n_levels = 1;
    scene->dose.levels[0] = (struct scene_dose_level_entry){ .id = "a", .value = scene_dose_level_default };
    scene->dose.levels[0].value.value = gy;
    scene->dose.levels[0].value.unit = SCENE_DOSE_UNIT_DOSE;
    scene->dose.levels[0].value.color_rgb = line_rgb;
    scene->dose.lines = (struct scene_dose_lines){ true, WIDTH_PX };
}

static bool is_line(const uint8_t *pixel)
{
    return pixel[0] == line_rgb >> 16 && pixel[1] == (line_rgb >> 8 & 255) && pixel[2] == (line_rgb & 255);
}

/* Beyond, the dose is constant: half a voxel, and what a line is wide. */
static bool is_between_centres(const struct grid *grid, struct vec3 p)
{
    struct vec3 at = affine_point(&grid->ijk_from_lps_mm, p);
    const double ijk[3] = { at.x, at.y, at.z };
    for (int i = 0; i < 3; i++)
        if (ijk[i] < 0.5 || ijk[i] > grid->size[i] - 1.5)
            return false;
    return true;
}

/* Compares a picture in an upright plane with one without lines. rim_px: of dark around lines. is_there: where the
 * plane is seen. */
static void expect_circle(struct plan *plan, struct scene scene, struct view view, struct vec3 right, struct vec3 up,
                          double rim_px, bool (*is_there)(struct vec3 p, double margin_mm))
{
    struct scene plain;
    scene_copy(&plain, &scene);
    plain.dose.lines.visible = false;
    struct image *with = shots_plain(plan, scene, view), *without = shots_plain(plan, plain, view);
    /* The dose is 60 Gy less the distance from its peak, between voxels 3 mm apart: off by h^2 / 8 / distance along
     * each axis, 0.11 mm in all; half a pixel of the edge's softness */
    const double slack_px = 0.11 * pixels_per_mm + 0.5 + 0.2;
    size_t n_line = 0, n_out = 0, n_wrong = 0;
    for (int y = 0; y < SHOTS_HEIGHT; y++)
        for (int x = 0; x < SHOTS_WIDTH; x++) {
            const uint8_t *pixel = shots_pixel(with, x, y), *under = shots_pixel(without, x, y);
            struct vec3 p = vec3_add(middle, vec3_add(vec3_scale(right, (x + 0.5 - SHOTS_WIDTH / 2.0) / pixels_per_mm),
                                                      vec3_scale(up, (SHOTS_HEIGHT / 2.0 - y - 0.5) / pixels_per_mm)));
            if (!is_between_centres(&plan->doses[0].components[0].values->grid, p))
                continue;
            struct vec3 from = vec3_sub(p, dose_scene_peak_mm), normal = vec3_cross(right, up);
            double height = vec3_dot(from, normal), radius = sqrt(pow(60 - level_gy, 2) - height * height);
            double off_px = fabs(sqrt(vec3_dot(from, from) - height * height) - radius) * pixels_per_mm;
            if (off_px < WIDTH_PX / 2.0 - slack_px && is_there(p, 1)) {
                n_line++;
                n_wrong += !is_line(pixel);
            } else if (off_px > WIDTH_PX / 2.0 + rim_px + slack_px || !is_there(p, -1)) {
                n_out++;
                n_wrong += memcmp(pixel, under, 3) != 0;
            }
        }
    if (n_wrong > 0)
        fail_msg("%zu pixels are wrong", n_wrong);
    assert_true(n_line > 500 && n_out > 50000);
    image_destroy(with);
    image_destroy(without);
}

static bool is_everywhere(struct vec3 p, double margin_mm)
{
    (void)p, (void)margin_mm;
    return true;
}

/* Within the body by a margin, in the plane of the cap; univels are 1.3 mm, and lines end a step of the samples before
 * the cap's edge. */
static bool is_in_body(struct vec3 p, double margin_mm)
{
    double off = 1.3 + WIDTH_PX / pixels_per_mm, grown = margin_mm > 0 ? -off : off;
    return vec3_length(vec3(p.x / (40 + grown), p.y / (34 + grown), p.z / 38)) < 1;
}

static void lines_on_panes_are_circles_of_the_doses_radius(void **state)
{
    (void)state;
    struct plan *plan = dose_scene_plan(false);
    struct view view = shots_view(SCENE_KIND_AXIAL, middle, pixels_per_mm);
    struct scene scene = dose_scene(plan);
    scene.image.slices.axial.position_mm = middle.z;
    set_level(&scene, level_gy);
    expect_circle(plan, scene, view, vec3(1, 0, 0), vec3(0, -1, 0), 1, is_everywhere);
    view = shots_view(SCENE_KIND_SAGITTAL, middle, pixels_per_mm);
    scene = dose_scene(plan);
    scene.image.slices.sagittal.position_mm = middle.x;
    set_level(&scene, level_gy);
    expect_circle(plan, scene, view, vec3(0, 1, 0), vec3(0, 0, 1), 1, is_everywhere);
    shots_forget(plan);
}

static void lines_on_slices_and_caps_in_space_are_there_and_what_is_nearer_hides_them(void **state)
{
    (void)state;
    struct plan *plan = dose_scene_plan(false);
    struct view view = shots_view_from(middle, vec3(0, 0, 1), vec3(0, -1, 0), pixels_per_mm);
    struct scene scene = dose_scene(plan);
    scene.image.slices.axial = (struct scene_slice){ .visible = true, .position_mm = middle.z };
    set_level(&scene, level_gy);
    expect_circle(plan, scene, view, vec3(-1, 0, 0), vec3(0, -1, 0), 0, is_everywhere);

    scene = dose_scene(plan); /* the body's cap, which ends at the body's border */
    shots_style(&scene, "body")->visible = true;
    scene.clip.axial_high = (struct scene_clip_axis){ true, middle.z, true };
    set_level(&scene, level_gy);
    expect_circle(plan, scene, view, vec3(-1, 0, 0), vec3(0, -1, 0), 0, is_in_body);

    scene = dose_scene(plan); /* the body hides its own inside */
    shots_style(&scene, "body")->visible = true;
    scene.image.slices.axial = (struct scene_slice){ .visible = true, .position_mm = middle.z };
    set_level(&scene, 50);
    scene.dose.levels[0].value.value = 45; /* a circle within the body */
    struct scene plain;
    scene_copy(&plain, &scene);
    plain.dose.lines.visible = false;
    struct image *with = shots_plain(plan, scene, view), *without = shots_plain(plan, plain, view);
    for (int y = 0; y < SHOTS_HEIGHT; y++)
        for (int x = 0; x < SHOTS_WIDTH; x++) {
            struct vec3 p = vec3_add(middle, vec3(-(x + 0.5 - SHOTS_WIDTH / 2.0) / pixels_per_mm,
                                                  -(SHOTS_HEIGHT / 2.0 - y - 0.5) / pixels_per_mm, 0));
            if (is_in_body(p, 1))
                assert_memory_equal(shots_pixel(with, x, y), shots_pixel(without, x, y), 3);
        }
    image_destroy(with);
    image_destroy(without);
    shots_forget(plan);
}

static void a_compared_dose_has_dashes_of_seven_pixels_with_gaps_of_five(void **state)
{
    (void)state;
    struct plan *plan = dose_scene_plan(false);
    struct dose *second = &plan->doses[plan->n_doses++];
    *second = plan->doses[0];
    snprintf(second->id, sizeof second->id, "second");
    second->n_components = 1;
    second->mask = second->mask ? volume_ref(second->mask) : NULL;
    second->components[0].values = volume_ref(plan->doses[0].components[0].values);
    /* a second dose of other values: half of the first's */
    struct volume *half = volume_create(&second->components[0].values->grid, VOXEL_F32, &(struct error){ 0 });
    const float *from = second->components[0].values->voxels;
    for (size_t i = 0; i < grid_n_voxels(&half->grid); i++)
        ((float *)half->voxels)[i] = from[i] / 2;
    volume_measure(half);
    volume_unref(second->components[0].values);
    second->components[0].values = half;

    struct view view =
        shots_view(SCENE_KIND_AXIAL, middle, 4); /* a power of two: dashes are in pixels of such a view */
    struct scene scene = dose_scene(plan), compared;
    scene.image.slices.axial.position_mm = middle.z;
    set_level(&scene, 16); /* of the first dose outside of the picture; of the second at 32 Gy of the first */
    scene.dose.lines.width_px = 1.6;
    scene_copy(&compared, &scene);
    snprintf(compared.dose.compare.id, sizeof compared.dose.compare.id, "second");
    compared.dose.compare.mode = SCENE_DOSE_COMPARISON_LINES;
    compared.dose.lines.visible = false; /* a comparison is seen also without */
    struct image *alone = shots_plain(plan, scene, view), *both = shots_plain(plan, compared, view);
    size_t n_on = 0, n_all = 0;
    double height = middle.z - dose_scene_peak_mm.z, radius = sqrt(28.0 * 28 - height * height);
    for (double turn = 0; turn < 2 * MATH_PI; turn += 0.5 / (4 * radius)) { /* half pixels along the circle */
        double px = (dose_scene_peak_mm.x + radius * cos(turn) - middle.x) * 4 + SHOTS_WIDTH / 2.0,
               py = (dose_scene_peak_mm.y + radius * sin(turn) - middle.y) * 4 + SHOTS_HEIGHT / 2.0;
        if (px < 4 || py < 4 || px > SHOTS_WIDTH - 4 || py > SHOTS_HEIGHT - 4)
            continue;
        const uint8_t *pixel = shots_pixel(both, (int)px, (int)py), *under = shots_pixel(alone, (int)px, (int)py);
        n_all++;
        n_on += pixel[1] > under[1] + 40 && pixel[1] > pixel[0] + 60;
    }
    /* 7 of 12 pixels, and round ends of 0.8 px that the softness halves */
    assert_true(n_all > 400);
    assert_close((double)n_on / (double)n_all, 7 / 12.0, 0.15);
    image_destroy(alone);
    image_destroy(both);
    shots_forget(plan);
}

static struct scene look_scene(const struct plan *plan, const void *context)
{
    const int *look = context;
    struct scene scene = dose_scene(plan);
    set_level(&scene, level_gy);
    scene.dose.lines.width_px = 2;
    if (*look == 0)
        scene.image.slices.axial.visible = scene.image.slices.coronal.visible = true;
    else {
        shots_style(&scene, "body")->visible = true;
        scene.clip.axial_high = (struct scene_clip_axis){ true, middle.z, true };
    }
    return scene;
}

static void the_back_ends_agree_on_lines_in_space(void **state)
{
    (void)state;
    for (int look = 0; look < 2; look++)
        for (int is_still = 0; is_still < 2; is_still++)
            dose_scene_expect_agreement(look_scene, &look,
                                        shots_view_from(middle, vec3(0.4, -0.6, 0.7), vec3(0, 0, 1), 3), is_still,
                                        10000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lines_on_panes_are_circles_of_the_doses_radius),
        cmocka_unit_test(lines_on_slices_and_caps_in_space_are_there_and_what_is_nearer_hides_them),
        cmocka_unit_test(a_compared_dose_has_dashes_of_seven_pixels_with_gaps_of_five),
        cmocka_unit_test(the_back_ends_agree_on_lines_in_space),
    };
    return shots_run("test_isoline_pictures", tests, sizeof tests / sizeof tests[0]);
}
