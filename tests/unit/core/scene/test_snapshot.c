/* A scene may only name things that the plan has. */
#include "core/plan/plan_bounds.h"
#include "core/scene/snapshot.h"
#include "tests/check.h"
#include "tests/derived_of.h"
#include "tests/made_plan.h"

static double label(struct vec3 p)
{
    return p.x > 0 ? 1 : 0;
}
static const struct made_region regions[] = { { "half", -1, 0xffffff } };

static struct plan *make_plan(void)
{
    struct grid grid = made_cube_grid(4);
    struct plan *plan = made_plan(&grid, label, regions, 1);
    made_plan_add_image(plan, &grid, VOXEL_U8, label);
    made_plan_add_image(plan, &grid, VOXEL_U8, label);
    for (size_t i = 0; i < 2; i++) {
        struct dose *dose = &plan->doses[plan->n_doses++];
        snprintf(dose->id, sizeof dose->id, "dose-%zu", i);
        dose->components[dose->n_components++].values = made_volume(&grid, VOXEL_F32, label);
    }
    return plan;
}

enum named { IMAGE, DOSE, CHECKED };

static struct snapshot *name(struct plan *plan, enum named what, const char *id, char field[128], struct error *err)
{
    struct scene scene;
    struct view view = view_default;
    scene_for_plan(plan, &scene);
    snprintf(what == IMAGE  ? scene.image.id
             : what == DOSE ? scene.dose.id
                            : scene.check.region,
             sizeof scene.image.id, "%s", id);
    return snapshot_create(derived_of(plan), &scene, &view, 1, field, err);
}

static void images_and_doses_are_found_by_their_id_and_the_first_without_one(void **state)
{
    (void)state;
    static const char *const ids[] = { "", "image-1", "image-2", "dose-0", "dose-1" };
    static const int expected[] = { 0, 0, 1, 0, 1 };
    struct plan *plan = make_plan();
    for (int i = 0; i < 5; i++) {
        struct error err = { 0 };
        char field[128];
        struct snapshot *snapshot = name(plan, i < 3 ? IMAGE : DOSE, ids[i], field, &err);
        assert_string_equal(err.text, "");
        assert_int_equal(i < 3 ? snapshot->image : snapshot->dose, expected[i]);
        snapshot_unref(snapshot);
    }
    plan_and_derived_destroy(plan);
}

/* Values below cull_below are left out in space, as air. Inverted images have no such limit, unless they are in HU. */
static void a_new_room_leaves_out_air_and_not_what_is_white(void **state)
{
    (void)state;
    static const struct {
        bool is_inverted;
        const char *unit;
        double cull_below;
    } images[] = { { false, "", 100 - 0.45 * 200 }, { true, "", -1e12 }, { false, "HU", -500 }, { true, "HU", -500 } };
    struct plan *plan = make_plan();
    plan->images[0].window_center = 100;
    plan->images[0].window_width = 200;
    for (size_t i = 0; i < sizeof images / sizeof images[0]; i++) {
        struct scene scene;
        plan->images[0].is_inverted = images[i].is_inverted;
        snprintf(plan->images[0].unit, sizeof plan->images[0].unit, "%s", images[i].unit);
        scene_for_plan(plan, &scene);
        assert_close(scene.image.cull_below, images[i].cull_below, 1e-9);
        assert_int_equal(scene.image.low_values, SCENE_LOW_VALUES_OWN);
        scene_finish(&scene);
    }
    plan_and_derived_destroy(plan);
}

/* Image 1, the half and a beam are of another patient than the 20 mm of image 2, who has more slices. */
static void a_new_room_begins_with_the_image_of_the_shown_patient(void **state)
{
    (void)state;
    struct plan *plan = make_plan();
    struct grid grid = made_cube_grid(20);
    struct scene scene;
    volume_unref(plan->images[1].volume);
    plan->images[1].volume = made_volume(&grid, VOXEL_U8, label);
    plan->n_patients = 2;
    plan->image_origins[0] = (struct part_origin){ .patient = 0, .treatment_plan = -1 };
    plan->image_origins[1] = (struct part_origin){ .patient = 1, .treatment_plan = -1 };
    plan->region_origins = mem_new(sizeof *plan->region_origins);
    plan->region_origins[0] = (struct part_origin){ .patient = 0, .treatment_plan = -1 };
    plan->n_region_origins = 1;
    plan->regions.regions[0].origin = 1;
    plan->regions.regions[0].is_target = true;
    for (int d = 0; d < 2; d++)
        plan->dose_origins[d] = (struct part_origin){ .patient = 0, .treatment_plan = -1 };
    plan->images[1].window_center = 77;

    scene_for_plan(plan, &scene);
    assert_string_equal(scene.image.id, "image-2");
    assert_close(scene.image.window.center, 77, 1e-9);
    assert_close(fabs(scene.image.slices.sagittal.position_mm), 0.5, 1e-9); /* the image's middle, not the target's 1 */
    plan_measure_bounds(plan);
    assert_close(plan->bounds_lps_mm.high.x, 10, 1e-9);
    struct view view = view_default;
    struct error err = { 0 };
    char field[128];
    struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err);
    assert_string_equal(err.text, "");
    assert_int_equal(snapshot->image, 1);
    assert_false(snapshot->styles[0].visible);
    assert_false(snapshot->has_dose_choice);
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

/* Presets in HU are taken as they are, those in parts of the window are laid over it. */
static void a_new_room_has_a_transfer_function_that_fits_the_first_image_and_shows_no_volume(void **state)
{
    (void)state;
    struct plan *plan = make_plan();
    plan->images[0].window_center = 100;
    plan->images[0].window_width = 200;
    for (int is_hu = 0; is_hu < 2; is_hu++) {
        struct scene scene;
        snprintf(plan->images[0].unit, sizeof plan->images[0].unit, "%s", is_hu ? "HU" : "");
        scene_for_plan(plan, &scene);
        const struct scene_volume_style *style = &scene.image.volume;
        assert_false(style->visible);
        assert_true(style->n_points >= 2);
        assert_close(style->points[0].opacity, 0, 0); /* what is below is not drawn */
        for (size_t i = 1; i < style->n_points; i++)
            assert_true(style->points[i].value > style->points[i - 1].value);
        if (is_hu)
            assert_true(style->points[0].value > 60); /* bone: above soft tissue */
        else
            assert_close(style->points[style->n_points - 1].value, 200, 1e-9); /* the window's upper end */
        scene_finish(&scene);
    }
    plan_and_derived_destroy(plan);
}

static double blob(struct vec3 p)
{
    return vec3_length(vec3_sub(p, vec3(3.2, -4.7, 6.1))) < 3 ? 2 : 1;
}
static double grey(struct vec3 p)
{
    return p.x;
}

static struct vec3 crosshair(const struct plan *plan, bool *are_all_visible)
{
    struct scene scene;
    scene_for_plan(plan, &scene);
    const struct scene_slices *slices = &scene.image.slices;
    struct vec3 at = vec3(slices->sagittal.position_mm, slices->coronal.position_mm, slices->axial.position_mm);
    *are_all_visible = slices->axial.visible && slices->coronal.visible && slices->sagittal.visible;
    scene_finish(&scene);
    return at;
}

/* The image has voxels of 2 x 3 x 5 mm, some axes reversed: centres at odd 1, at 3 n and at 5 n + 2.5. */
static void a_new_room_begins_at_a_voxel_in_the_first_target_or_in_the_images_middle(void **state)
{
    (void)state;
    static const struct made_region targets[] = { { "brain", -1, 0 }, { "gtv", 0, 0 } };
    static const struct made_region organs[] = { { "brain", -1, 0 }, { "eye", 0, 0 } };
    const uint32_t size[3] = { 10, 11, 8 };
    struct grid fine = made_cube_grid(31);
    struct grid coarse =
        made_grid(10, 11, 8, made_affine(vec3(-2, 0, 0), vec3(0, 3, 0), vec3(0, 0, -5), size, vec3(0, 0, 0)));
    bool are_all;
    for (int has_target = 0; has_target < 2; has_target++) {
        struct plan *plan = made_plan(&fine, blob, has_target ? targets : organs, 2);
        made_plan_add_image(plan, &coarse, VOXEL_I16, grey);
        struct vec3 at = crosshair(plan, &are_all);
        struct vec3 wanted = has_target ? vec3(3, -6, 7.5) /* around the blob's middle */ : vec3(-1, 0, -2.5);
        assert_false(are_all);
        assert_close(at.y, wanted.y, 1e-9);
        assert_close(fabs(at.x), fabs(wanted.x), 1e-9); /* the image's middle lies between two voxels */
        assert_close(fabs(at.z), fabs(wanted.z), 1e-9);
        assert_true(!has_target || (at.x > 0 && at.z > 0));
        plan_and_derived_destroy(plan);
    }
}

static void a_plan_without_regions_shows_its_three_slices_in_space(void **state)
{
    (void)state;
    bool are_all;
    struct grid grid = made_cube_grid(5);
    struct plan *plan = made_plan(&grid, label, NULL, 0);
    (void)crosshair(plan, &are_all);
    assert_false(are_all); /* nor an image */
    made_plan_add_image(plan, &grid, VOXEL_U8, label);
    struct vec3 at = crosshair(plan, &are_all);
    assert_true(are_all);
    assert_close(vec3_length(at), 0, 1e-9);
    plan_and_derived_destroy(plan);
}

static void what_the_plan_does_not_have_is_refused_by_the_fields_place(void **state)
{
    (void)state;
    static const char *const fields[] = { [IMAGE] = "/image/id", [DOSE] = "/dose/id", [CHECKED] = "/check/region" };
    struct plan *plan = make_plan();
    for (enum named what = IMAGE; what <= CHECKED; what++) {
        struct error err = { 0 };
        char field[128];
        assert_null(name(plan, what, "nowhere", field, &err));
        assert_int_equal(err.code, ERROR_NOT_FOUND);
        assert_string_equal(field, fields[what]);
        assert_non_null(strstr(err.text, "nowhere"));
    }
    plan_and_derived_destroy(plan);
}

static void a_plan_without_images_and_doses_has_neither(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(4);
    struct plan *plan = made_plan(&grid, label, regions, 1);
    struct error err = { 0 };
    char field[128];
    struct snapshot *snapshot = name(plan, CHECKED, "half", field, &err);
    assert_string_equal(err.text, "");
    assert_int_equal(snapshot->image, -1);
    assert_int_equal(snapshot->dose, -1);
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(images_and_doses_are_found_by_their_id_and_the_first_without_one),
        cmocka_unit_test(what_the_plan_does_not_have_is_refused_by_the_fields_place),
        cmocka_unit_test(a_plan_without_images_and_doses_has_neither),
        cmocka_unit_test(a_new_room_begins_at_a_voxel_in_the_first_target_or_in_the_images_middle),
        cmocka_unit_test(a_plan_without_regions_shows_its_three_slices_in_space),
        cmocka_unit_test(a_new_room_begins_with_the_image_of_the_shown_patient),
        cmocka_unit_test(a_new_room_leaves_out_air_and_not_what_is_white),
        cmocka_unit_test(a_new_room_has_a_transfer_function_that_fits_the_first_image_and_shows_no_volume),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
