/* Isodose surfaces as results, as draws and under a pixel: against spheres and planes in closed form. */
#include "core/derive/coverage_shape.h"
#include "core/pick/pick.h"
#include "core/render/visible/draw_isodoses.h"
#include "core/render/visible/draw_list.h"
#include "core/scene/isodoses.h"
#include "tests/check.h"
#include "tests/derived_of.h"
#include "tests/made_plan.h"

static struct vec3 centre_mm;

static double gauss(struct vec3 p)
{
    struct vec3 d = vec3_sub(p, centre_mm);
    return 100 * exp(-vec3_dot(d, d) / (2 * 12.0 * 12.0));
}

static double level_at(double radius_mm)
{
    return 100 * exp(-radius_mm * radius_mm / (2 * 12.0 * 12.0));
}

static double ramp(struct vec3 p)
{
    return 50 + p.z;
}

static double halves(struct vec3 p)
{
    return p.x < 0 ? 1 : 2;
}

static const struct made_region regions[] = { { "left", -1, 0xff0000 }, { "right", -1, 0x00ff00 } };

static void add_dose(struct plan *plan, const struct grid *grid, enum dose_quantity quantity,
                     double (*value)(struct vec3))
{
    struct dose *dose = &plan->doses[plan->n_doses++];
    snprintf(dose->id, sizeof dose->id, "dose");
    snprintf(dose->unit, sizeof dose->unit, "Gy");
    dose->components[dose->n_components++] =
        (struct dose_component){ .quantity = quantity, .values = made_volume(grid, VOXEL_F32, value) };
}

/* Univels of 2 mm, a dose on a turned grid of 1.5 mm about the middle. */
static struct plan *make_plan(enum dose_quantity quantity, double (*value)(struct vec3))
{
    const uint32_t size[3] = { 48, 48, 48 };
    struct grid univels = made_grid(40, 40, 40,
                                    made_affine(vec3(2, 0, 0), vec3(0, 2, 0), vec3(0, 0, 2),
                                                (const uint32_t[3]){ 40, 40, 40 }, vec3(0, 0, 0)));
    struct grid grid =
        made_grid(48, 48, 48,
                  made_affine(vec3(1.2, 0.9, 0), vec3(-0.9, 1.2, 0), vec3(0, 0, 1.5), size, vec3(0.3, -0.2, 0.1)));
    struct plan *plan = made_plan(&univels, halves, regions, 2);
    add_dose(plan, &grid, quantity, value);
    return plan;
}

/* The dose's one quantity, everywhere. */
static struct isodose_choice choice_of(enum isodose_grid grid, double value)
{
    struct isodose_choice choice;
    memset(&choice, 0, sizeof choice);
    choice.dose.n_parts = 1;
    choice.dose.parts[0].factor = 1;
    choice.dose.shown = DOSE_SHOWN_QUANTITY;
    choice.dose.quantity = DOSE_TOTAL;
    choice.dose.n_rows = 1;
    choice.dose.is_everywhere = true;
    choice.grid = grid;
    choice.value = value;
    return choice;
}

static struct isodose_shape *isodose_of(const struct plan *plan, const struct isodose_choice *choice,
                                        enum surface_detail detail)
{
    struct error err = { 0 };
    struct isodose_shape *made = isodose_shape_get(derived_of(plan), choice, detail, &err);
    if (!made)
        fail_msg("%s", err.text);
    return made;
}

static void isodoses_of_a_gaussian_are_spheres_on_both_grids(void **state)
{
    (void)state;
    centre_mm = vec3(1.3, -0.7, 0.4);
    struct plan *plan = make_plan(DOSE_TOTAL, gauss);
    for (int grid = 0; grid < 2; grid++)
        for (double radius = 8; radius < 30; radius += 7) {
            struct isodose_choice choice = choice_of((enum isodose_grid)grid, level_at(radius));
            struct isodose_shape *made = isodose_of(plan, &choice, SURFACE_FULL);
            struct shape_facts facts;
            isodose_shape_measure(made, &facts);
            /* grid of 2 mm, sampled linearly from one of 1.5 mm: 2 h^2 / r^2 covers chords and both interpolations */
            double share = 2 * 4 / (radius * radius);
            assert_near(facts.area_mm2, 4 * MATH_PI * radius * radius, share);
            assert_near(facts.volume_mm3, 4 / 3.0 * MATH_PI * pow(radius, 3), share);
            assert_int_equal(facts.n_triangles, made->shape->mesh->n_triangles);
            derive_result_unref(&made->base);
        }
    struct isodose_choice above = choice_of(ISODOSE_ON_DOSE, 101), wide = choice_of(ISODOSE_ON_DOSE, level_at(36));
    struct isodose_shape *none = isodose_of(plan, &above, SURFACE_FULL), *open = isodose_of(plan, &wide, SURFACE_FULL);
    struct shape_facts facts;
    assert_int_equal(none->shape->mesh->n_triangles, 0);
    isodose_shape_measure(open, &facts);
    assert_true(isnan(facts.volume_mm3)); /* the sphere reaches beyond the dose's grid */
    derive_result_unref(&none->base);
    derive_result_unref(&open->base);
    plan_and_derived_destroy(plan);
}

static void each_voxel_has_the_weights_of_its_tissue(void **state)
{
    (void)state;
    struct plan *plan = make_plan(DOSE_GAMMA, ramp);
    for (int grid = 0; grid < 2; grid++) {
        struct isodose_choice choice = choice_of((enum isodose_grid)grid, 50);
        choice.dose.shown = DOSE_SHOWN_WEIGHTED;
        choice.dose.is_everywhere = false;
        choice.dose.n_rows = 2;
        memset(choice.dose.row_of_region, DOSE_NO_ROW, sizeof choice.dose.row_of_region);
        for (uint8_t r = 0; r < 2; r++) {
            choice.dose.row_of_region[r] = r;
            choice.dose.rows[r] = (struct tissue_weights){ 1, 1, 1, 1, 1.0 + r, 1 };
        }
        struct isodose_shape *made = isodose_of(plan, &choice, SURFACE_FULL);
        size_t n[2] = { 0, 0 };
        for (size_t v = 0; v < made->shape->mesh->n_vertices; v++) {
            const float *p = made->shape->mesh->positions_lps_mm + 3 * v;
            if (fabsf(p[0]) < 4) /* a wall stands where the weights jump */
                continue;
            /* 50 + z = 50 where the weight is 1; twice that where it is 2 */
            assert_close(p[2], p[0] < 0 ? 0 : -25, 1e-4);
            n[p[0] > 0]++;
        }
        assert_true(n[0] > 100 && n[1] > 100);
        derive_result_unref(&made->base);
    }
    plan_and_derived_destroy(plan);
}

static double cone(struct vec3 p)
{
    return 100 - vec3_length(vec3_sub(p, centre_mm));
}

static void moving_pictures_get_fewer_triangles_of_the_same_sphere(void **state)
{
    (void)state;
    centre_mm = vec3(1.3, -0.7, 0.4);
    const uint32_t size[3] = { 150, 150, 150 };
    struct grid grid =
        made_grid(150, 150, 150, made_affine(vec3(0.5, 0, 0), vec3(0, 0.5, 0), vec3(0, 0, 0.5), size, vec3(0, 0, 0)));
    struct plan *plan = made_plan(&grid, halves, regions, 2);
    add_dose(plan, &grid, DOSE_TOTAL, cone);
    for (int on = 0; on < 2; on++) {
        struct isodose_choice choice = choice_of((enum isodose_grid)on, 66); /* radius 34 mm, about 170,000 triangles */
        struct isodose_shape *coarse = isodose_of(plan, &choice, SURFACE_COARSE),
                             *full = isodose_of(plan, &choice, SURFACE_FULL);
        struct shape_facts facts;
        isodose_shape_measure(coarse, &facts);
        assert_int_equal(facts.reduction, 2);
        assert_true(facts.n_triangles < ISODOSE_COARSE_TRIANGLES);
        assert_near(facts.area_mm2, 4 * MATH_PI * 34 * 34, 0.002);
        isodose_shape_measure(full, &facts);
        assert_int_equal(facts.reduction, 1);
        assert_true(facts.n_triangles > ISODOSE_COARSE_TRIANGLES);
        assert_near(facts.area_mm2, 4 * MATH_PI * 34 * 34, 0.001);
        derive_result_unref(&coarse->base);
        derive_result_unref(&full->base);
    }
    plan_and_derived_destroy(plan);
}

static void a_coverage_is_bounded_by_the_region_and_the_level(void **state)
{
    (void)state;
    struct plan *plan = make_plan(DOSE_TOTAL, ramp);
    struct dose_coverage_choice choice;
    struct error err = { 0 };
    memset(&choice, 0, sizeof choice);
    choice.dose = choice_of(ISODOSE_ON_DOSE, 0).dose;
    choice.region = 1;
    choice.low = 60; /* z >= 10 mm */
    choice.high = INFINITY;
    struct coverage_shape *made = coverage_shape_get(derived_of(plan), &choice, SURFACE_MARCHING_CUBES, &err);
    assert_non_null(made);
    assert_int_equal(mesh_open_edges(made->shape->mesh), 0);
    /* the face of the univels with x > 0; the lowest univels within have z = 11; lifted by a quarter of 2 mm */
    assert_close(made->shape->bounds_lps_mm.low.x, 0 - 0.5, 1e-4);
    assert_close(made->shape->bounds_lps_mm.low.z, 10 - 0.5, 1e-4);
    derive_result_unref(&made->base);
    choice.low = 1000;
    made = coverage_shape_get(derived_of(plan), &choice, SURFACE_SMOOTH, &err);
    assert_non_null(made);
    assert_int_equal(made->shape->mesh->n_triangles, 0);
    derive_result_unref(&made->base);
    plan_and_derived_destroy(plan);
}

/* ---- pictures ---------------------------------------------------------------------------------------------------- */

static struct drawable *make_shape(void *context, const struct shape *shape, int n_passes, struct error *err)
{
    (void)shape, (void)err;
    assert_int_equal(n_passes, 0); /* a field's gradient needs no smoothing */
    ++*(size_t *)context;
    struct drawable *made = mem_new(sizeof *made);
    made->n_bytes = 1;
    return made;
}

static void destroy_shape(void *context, struct drawable *drawable)
{
    --*(size_t *)context;
    free(drawable);
}

/* Regions hidden; spheres of 8, 16 and 24 mm: opaque, and translucent. */
static struct scene scene_of(const struct plan *plan)
{
    struct scene scene;
    scene_for_plan(plan, &scene);
    for (size_t i = 0; i < scene.n_regions; i++)
        scene.regions[i].value.visible = false;
    scene.dose.quantity = SCENE_DOSE_QUANTITY_TOTAL;
    scene.surface.algorithm = SCENE_ALGORITHM_SMOOTH;
    scene.dose.surfaces.visible = true;
    assert_true(scene.dose.n_levels >= 4);
    for (size_t i = 0; i < scene.dose.n_levels; i++) {
        struct scene_dose_level *level = &scene.dose.levels[i].value;
        level->surface = i < 3;
        level->unit = SCENE_DOSE_UNIT_DOSE;
        level->value = level_at(8.0 * (double)(i + 1));
        level->opacity = i == 0 ? 1 : 0.5;
        level->color_rgb = 0x100000u * (uint32_t)(i + 1);
    }
    return scene;
}

static struct snapshot *snapshot_of(struct plan *plan, struct scene scene, enum scene_kind kind)
{
    struct view view = view_default;
    struct error err = { 0 };
    char field[128];
    view.kind = kind;
    struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err);
    assert_string_equal(err.text, "");
    assert_string_equal(snapshot->dose_why.text, "");
    return snapshot;
}

static struct draw_list *list_of(const struct snapshot *snapshot, struct camera *camera, struct draw_cache *cache)
{
    const struct render_options options = { 64, 48, SURFACE_FULL, false };
    struct error err = { 0 };
    camera_resolve(snapshot, camera);
    const struct draw_scope scope = {
        .snapshot = snapshot, .camera = camera, .detail = SURFACE_FULL, .cache = cache, .is_still = true
    };
    struct draw_list *list = draw_list_create(&scope, &options, &err);
    assert_string_equal(err.text, "");
    return list;
}

static void levels_are_drawn_opaque_first_and_the_farthest_translucent_one_before_nearer_ones(void **state)
{
    (void)state;
    centre_mm = vec3(1.3, -0.7, 0.4);
    struct plan *plan = make_plan(DOSE_TOTAL, gauss);
    size_t n_drawables = 0;
    struct draw_cache *cache = draw_cache_create(
        &(struct drawable_maker){ .make_shape = make_shape, .destroy_shape = destroy_shape, .context = &n_drawables });
    struct camera camera;
    struct snapshot *snapshot = snapshot_of(plan, scene_of(plan), SCENE_KIND_3D);
    for (int repeat = 0; repeat < 2; repeat++) { /* the second picture makes nothing anew */
        struct draw_list *list = list_of(snapshot, &camera, cache);
        assert_int_equal(list->n, 3);
        assert_int_equal(n_drawables, 3);
        static const size_t order[3] = { 0, 1, 2 }; /* the largest sphere is nearest to the eye */
        for (size_t i = 0; i < 3; i++) {
            const struct draw *draw = &list->draws[i];
            assert_int_equal(draw->kind, DRAW_SHAPE);
            assert_int_equal(draw->subject.kind, SUBJECT_ISODOSE);
            assert_int_equal(draw->subject.index, order[i]);
            assert_int_equal(draw->pass, i == 0 ? DRAW_OPAQUE : DRAW_TRANSLUCENT);
            assert_int_equal(draw->color_rgb, 0x100000 * (order[i] + 1));
            assert_close(draw->opacity, i == 0 ? 1 : 0.5, 0);
        }
        assert_int_equal(list->n_layers_planned, 2);
        draw_list_destroy(list);
    }
    snapshot_unref(snapshot);

    struct scene none = scene_of(plan);
    none.dose.surfaces.visible = false;
    snapshot = snapshot_of(plan, none, SCENE_KIND_3D);
    struct draw_list *list = list_of(snapshot, &camera, cache);
    assert_int_equal(list->n, 0);
    assert_false(draw_isodoses_are_wanted(snapshot));
    draw_list_destroy(list);
    snapshot_unref(snapshot);

    snapshot = snapshot_of(plan, scene_of(plan), SCENE_KIND_AXIAL);
    assert_false(draw_isodoses_are_wanted(snapshot));
    snapshot_unref(snapshot);
    draw_cache_destroy(cache);
    assert_int_equal(n_drawables, 0);
    plan_and_derived_destroy(plan);
}

static void under_a_pixel_each_level_is_hit_where_its_sphere_is(void **state)
{
    (void)state;
    centre_mm = vec3(1.3, -0.7, 0.4);
    struct plan *plan = make_plan(DOSE_TOTAL, gauss);
    struct snapshot *snapshot = snapshot_of(plan, scene_of(plan), SCENE_KIND_3D);
    struct camera camera;
    struct pick_hit hits[PICK_MAX_HITS];
    camera_resolve(snapshot, &camera);
    struct vec3 clip = mat4_project(&camera.clip_from_lps_mm, centre_mm);
    double px = (clip.x + 1) / 2 * snapshot->view.size_px[0], py = (1 - clip.y) / 2 * snapshot->view.size_px[1];
    size_t n = snapshot_pick(snapshot, px, py, hits);
    assert_int_equal(n, 3);
    for (size_t i = 0; i < 3; i++) {
        assert_int_equal(hits[i].subject.kind, SUBJECT_ISODOSE);
        assert_int_equal(hits[i].subject.index, 2 - i); /* from outside to inside */
        assert_close(vec3_length(vec3_sub(hits[i].point_lps_mm, centre_mm)), 24 - 8.0 * (double)i, 0.1);
    }
    assert_close(hits[2].alpha, 1, 0);
    assert_true(hits[0].alpha < 0.5);
    snapshot_unref(snapshot);

    struct scene cut = scene_of(plan); /* cut through the centre, at right angles to the line of sight */
    cut.clip.free.enabled = true;
    cut.clip.free.origin_mm = centre_mm;
    cut.clip.free.normal = vec3_scale(camera.forward, -1);
    snapshot = snapshot_of(plan, cut, SCENE_KIND_3D);
    n = snapshot_pick(snapshot, px, py, hits);
    assert_int_equal(n, 3);
    for (size_t i = 0; i < 3; i++) /* the far sides are left */
        assert_int_equal(hits[i].subject.index, i);
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(isodoses_of_a_gaussian_are_spheres_on_both_grids),
        cmocka_unit_test(each_voxel_has_the_weights_of_its_tissue),
        cmocka_unit_test(moving_pictures_get_fewer_triangles_of_the_same_sphere),
        cmocka_unit_test(a_coverage_is_bounded_by_the_region_and_the_level),
        cmocka_unit_test(levels_are_drawn_opaque_first_and_the_farthest_translucent_one_before_nearer_ones),
        cmocka_unit_test(under_a_pixel_each_level_is_hit_where_its_sphere_is),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
