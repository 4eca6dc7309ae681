/* Colourwash on planes: each pixel has the colour of the dose at its point, by closed forms. */
#include "tests/render/wash_scene.h"

static struct wash_field any_field(void)
{
    struct vec3 g = vec3(wash_random() - 0.5, wash_random() - 0.5, wash_random() - 0.5);
    return (struct wash_field){ vec3_scale(vec3_normalize(g), 1.6), 45 + 10 * wash_random() };
}

static struct wash_places places_of(struct view view, struct plane plane)
{
    struct wash_places places = { .point = wash_on_plane, .plane = plane };
    struct plan *none = plan_create("none");
    camera_of_view(none, &view, &plane, NULL, &places.camera);
    plan_destroy(none);
    return places;
}

static const enum scene_kind kinds[] = { SCENE_KIND_AXIAL, SCENE_KIND_CORONAL, SCENE_KIND_SAGITTAL };

/* A pane through a point, with the picture in its middle. */
static void expect_pane(struct plan *plan, struct scene scene, enum scene_kind kind, struct vec3 target,
                        const struct wash_dose *dose, const char *what)
{
    struct view view = shots_view(kind, target, 5.3);
    double position[] = { target.z, target.y, target.x };
    scene.image.slices.axial.position_mm = target.z;
    scene.image.slices.coronal.position_mm = target.y;
    scene.image.slices.sagittal.position_mm = target.x;
    for (int i = 0; i < 3; i++)
        if (kinds[i] == kind) {
            struct plane plane = plane_of_kind(kind, position[i]);
            struct wash_places places = places_of(view, plane);
            places.is_over_background = plan->n_images == 0;
            wash_expect(plan, scene, view, places, dose, 8000, what);
        }
}

static void a_pane_shows_a_linear_dose_on_any_grid(void **state)
{
    (void)state;
    for (int i = 0; i < 12; i++) {
        struct grid grid = wash_random_grid(i);
        struct wash_field field = any_field();
        struct plan *plan = wash_plan(&grid, &field);
        struct wash_dose dose = { wash_dose_linear, &grid, &field, i % 4 == 3 };
        struct scene scene = wash_scene(plan, i % 2, i % 3 ? 0.4 : 1);
        scene.dose.interpolation = dose.is_per_slice ? SCENE_DOSE_INTERPOLATION_SLICE : SCENE_DOSE_INTERPOLATION_LINEAR;
        struct vec3 target = vec3(4 * wash_random() - 2, 4 * wash_random() - 2, 4 * wash_random() - 2);
        expect_pane(plan, scene, kinds[i % 3], target, &dose, "a pane");
        shots_forget(plan);
    }
}

static void an_oblique_plane_in_space_shows_it_too(void **state)
{
    (void)state;
    for (int i = 0; i < 6; i++) {
        struct grid grid = wash_random_grid(i);
        struct wash_field field = any_field();
        struct plan *plan = wash_plan(&grid, &field);
        struct wash_dose dose = { wash_dose_linear, &grid, &field, false };
        struct scene scene = wash_scene(plan, i % 2, 0.6);
        struct vec3 normal = vec3(wash_random(), wash_random() - 2, wash_random()), at = vec3(1, -2, 0.7);
        free(scene.image.obliques);
        scene.image.obliques = mem_new(sizeof *scene.image.obliques);
        scene.image.n_obliques = 1;
        scene.image.obliques[0].value = scene_oblique_default;
        snprintf(scene.image.obliques[0].id, sizeof scene.image.obliques[0].id, "o");
        scene.image.obliques[0].value.visible = true;
        scene.image.obliques[0].value.origin_mm = at;
        scene.image.obliques[0].value.normal = normal;
        for (size_t r = 0; r < scene.n_regions; r++)
            scene.regions[r].value.visible = false;
        struct view view = shots_view_from(at, vec3(0.3, -1, 0.4), vec3(0, 0, 1), 5);
        if (i % 2) {
            view.camera.projection = SCENE_PROJECTION_PERSPECTIVE;
            view.camera.has_height_mm = false;
            view.camera.fov_deg = 40;
            view.camera.position_mm = vec3_add(at, vec3(20, -85, 25));
        }
        struct plane plane = plane_of_normal(at, normal);
        struct error err = { 0 };
        char field_name[128];
        struct scene copy;
        scene_copy(&copy, &scene);
        struct view view_copy = view;
        struct snapshot *snapshot = snapshot_create(derived_of(plan), &copy, &view_copy, 1, field_name, &err);
        assert_string_equal(err.text, "");
        struct wash_places places = { .point = wash_on_plane, .plane = plane };
        camera_resolve(snapshot, &places.camera);
        snapshot_unref(snapshot);
        wash_expect(plan, scene, view, places, &dose, 8000, "an oblique plane");
        shots_forget(plan);
    }
}

/* ---- missing values --------------------------------------------------------------------------------------------- */

/* Where a voxel of `hole` has a part in the tri-linear value there is none. */
static bool value_with_a_hole(const struct wash_dose *dose, struct vec3 p, double *value, bool *is_sure)
{
    bool has_value = wash_dose_linear(dose, p, value, is_sure), is_hole = true;
    struct vec3 at = affine_point(&dose->grid->ijk_from_lps_mm, p);
    const double index[3] = { at.x, at.y, at.z };
    for (int axis = 0; axis < 3; axis++) {
        double away = fabs(index[axis] - dose->grid->size[axis] / 2);
        is_hole &= away < 1;
        *is_sure &= fabs(away - 1) > 2e-4;
    }
    return has_value && !is_hole;
}

static void beside_a_value_that_is_not_there_nothing_is_drawn(void **state)
{
    (void)state;
    for (int i = 0; i < 6; i++) {
        struct grid grid = wash_random_grid(i);
        struct wash_field field = any_field();
        struct plan *plan = wash_plan(&grid, &field);
        struct dose *dose = &plan->doses[0];
        uint32_t middle[3] = { grid.size[0] / 2, grid.size[1] / 2, grid.size[2] / 2 };
        size_t at = middle[0] + grid.size[0] * (middle[1] + (size_t)grid.size[1] * middle[2]);
        if (i % 2) {
            struct error err = { 0 };
            dose->mask = volume_create(&grid, VOXEL_U8, &err);
            memset(dose->mask->voxels, 1, grid_n_voxels(&grid));
            ((uint8_t *)dose->mask->voxels)[at] = 0;
        } else
            ((float *)dose->components[0].values->voxels)[at] = i == 0 ? NAN : INFINITY;
        struct wash_dose expected = { value_with_a_hole, &grid, &field, false };
        struct vec3 hole = affine_point(&grid.lps_mm_from_ijk, vec3(middle[0], middle[1], middle[2]));
        hole = vec3_add(hole, vec3(0.3, 0.2, -0.2));
        expect_pane(plan, wash_scene(plan, false, 0.5), kinds[i % 3], hole, &expected, "a hole");
        shots_forget(plan);
    }
}

/* The plane lies exactly in centres of voxels beside missing ones, which have no part in the value. */
static void a_plane_through_centres_ignores_the_slice_beside(void **state)
{
    (void)state;
    const uint32_t size[3] = { 30, 30, 20 };
    struct grid grid =
        made_grid(30, 30, 20, made_affine(vec3(2, 0, 0), vec3(0, 2, 0), vec3(0, 0, 3), size, vec3(0, 0, 0)));
    struct wash_field field = { vec3(1, 0.7, 0), 50 };
    struct plan *plan = wash_plan(&grid, &field);
    float *voxels = plan->doses[0].components[0].values->voxels;
    for (size_t i = 0; i < 900; i++)
        voxels[900 * 12 + i] = voxels[900 * 10 + i] = NAN;
    struct wash_dose dose = { wash_dose_linear, &grid, &field, false };
    double z = affine_point(&grid.lps_mm_from_ijk, vec3(0, 0, 11)).z;
    expect_pane(plan, wash_scene(plan, false, 0.5), SCENE_KIND_AXIAL, vec3(0, 0, z), &dose, "a slice of centres");
    shots_forget(plan);
}

/* ---- tissues ---------------------------------------------------------------------------------------------------- */

/* Weighted: 2 times the dose in region a, once in b, none elsewhere; the univels are 1 mm and end at x = 4. */
static bool value_by_tissue(const struct wash_dose *dose, struct vec3 p, double *value, bool *is_sure)
{
    bool is_in_grid = wash_dose_linear(dose, p, value, is_sure);
    double edge = fmin(fabs(p.x - 4), fmin(fabs(fabs(p.x) - wash_box_mm.x),
                                           fmin(fabs(fabs(p.y) - wash_box_mm.y), fabs(fabs(p.z) - wash_box_mm.z))));
    *is_sure &= edge > 1e-3;
    *value *= p.x < 4 ? 2 : 1;
    return is_in_grid && wash_is_in_box(p);
}
static bool value_everywhere(const struct wash_dose *dose, struct vec3 p, double *value, bool *is_sure)
{
    bool is_in_grid = wash_dose_linear(dose, p, value, is_sure);
    *value *= 2;
    return is_in_grid;
}

static struct scene weighted_scene(struct plan *plan, const char *tissue)
{
    struct scene scene = wash_scene(plan, false, 0.5);
    free(scene.dose.weights);
    scene.dose.weights = mem_new(2 * sizeof *scene.dose.weights);
    scene.dose.n_weights = 2;
    for (size_t i = 0; i < 2; i++) {
        snprintf(scene.dose.weights[i].id, sizeof scene.dose.weights[i].id, "%s", i ? "b" : "a");
        scene.dose.weights[i].value = scene_tissue_weights_default;
        scene.dose.weights[i].value.nitrogen = i ? 1 : 2;
    }
    scene.dose.quantity = SCENE_DOSE_QUANTITY_WEIGHTED;
    snprintf(scene.dose.tissue, sizeof scene.dose.tissue, "%s", tissue);
    return scene;
}

static void own_tissues_jump_at_the_univels_borders_and_one_does_not(void **state)
{
    (void)state;
    for (int i = 0; i < 6; i++) {
        struct grid grid = wash_random_grid(i);
        struct wash_field field = any_field();
        field.at_origin *= 0.7;
        struct plan *plan = wash_plan(&grid, &field);
        plan->doses[0].components[0].quantity = DOSE_NITROGEN;
        struct wash_dose own = { value_by_tissue, &grid, &field, false };
        struct wash_dose one = { value_everywhere, &grid, &field, false };
        struct vec3 target = vec3(3.3, 0.4, -0.6);
        expect_pane(plan, weighted_scene(plan, ""), kinds[i % 2], target, &own, "own tissues");
        expect_pane(plan, weighted_scene(plan, "a"), kinds[i % 2], target, &one, "one tissue");
        shots_forget(plan);
    }
}

/* ---- plans without an image ------------------------------------------------------------------------------------- */

static void without_an_image_it_lies_over_the_regions(void **state)
{
    (void)state;
    struct grid grid = wash_random_grid(1);
    struct wash_field field = any_field();
    struct plan *plan = wash_plan(&grid, &field);
    struct volume *image = plan->images[0].volume;
    plan->n_images = 0;
    struct wash_dose dose = { wash_dose_linear, &grid, &field, false };
    expect_pane(plan, wash_scene(plan, false, 0.5), SCENE_KIND_CORONAL, vec3(0, 0, 0), &dose, "regions");
    volume_unref(image);
    shots_forget(plan);
}

/* Another frame of reference, no opacity, no level that the dose reaches. */
static void what_may_not_be_drawn_changes_no_pixel(void **state)
{
    (void)state;
    struct grid grid = wash_random_grid(0);
    struct wash_field field = any_field();
    struct plan *plan = wash_plan(&grid, &field);
    plan->doses[0].frame = DOSE_FRAME_DIFFERS;
    for (int i = 0; i < 3; i++) {
        struct view view = shots_view(SCENE_KIND_AXIAL, vec3(0, 0, 0), 5);
        struct scene scene = wash_scene(plan, false, i == 1 ? 0 : 0.5), plain;
        if (i == 2)
            scene.dose.levels[0].value.value = 1000, scene.dose.n_levels = 1;
        scene_copy(&plain, &scene);
        plain.dose.wash.visible = false;
        struct image *a = shots_plain(plan, scene, view), *b = shots_plain(plan, plain, view);
        assert_memory_equal(a->rgba, b->rgba, SHOTS_WIDTH * SHOTS_HEIGHT * 4);
        image_destroy(a);
        image_destroy(b);
        plan->doses[0].frame = DOSE_FRAME_SAME;
    }
    shots_forget(plan);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_pane_shows_a_linear_dose_on_any_grid),
        cmocka_unit_test(an_oblique_plane_in_space_shows_it_too),
        cmocka_unit_test(beside_a_value_that_is_not_there_nothing_is_drawn),
        cmocka_unit_test(a_plane_through_centres_ignores_the_slice_beside),
        cmocka_unit_test(own_tissues_jump_at_the_univels_borders_and_one_does_not),
        cmocka_unit_test(without_an_image_it_lies_over_the_regions),
        cmocka_unit_test(what_may_not_be_drawn_changes_no_pixel),
    };
    return shots_run_drivers("wash", tests, sizeof tests / sizeof tests[0]);
}
