/* Shapes as the store keeps them: by algorithm, detail and representation; within its budget; many at once. */
#include "core/base/parallel.h"
#include "core/derive/region_masks.h"
#include "tests/check.h"
#include "tests/derived_of.h"
#include "tests/made_plan.h"
#include "tests/unit/plan_help.h"

/* A box of 134^3 voxels, far from it one of 2^3, one of a single voxel. */
static double boxes_label(struct vec3 p)
{
    if (fabs(p.x) < 67 && fabs(p.y) < 67 && fabs(p.z) < 67)
        return 1;
    if (fabs(p.x - 72) < 1 && fabs(p.y) < 1 && fabs(p.z) < 1)
        return 2;
    return fabs(p.x + 71.5) < 0.4 && fabs(p.y - 0.5) < 0.4 && fabs(p.z - 0.5) < 0.4 ? 3 : 0;
}
static const struct made_region boxes[] = { { "large", -1, 0xff8040 },
                                            { "small", -1, 0x40ff80 },
                                            { "lone", -1, 0x8040ff } };

static struct plan *plan_of_boxes(void)
{
    const uint32_t size[3] = { 150, 150, 150 };
    struct affine map = made_affine(vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1), size, vec3(0, 0, 0));
    struct grid grid = made_grid(150, 150, 150, map);
    return made_plan(&grid, boxes_label, boxes, 3);
}

static void surfaces_are_kept_by_algorithm(void **state)
{
    (void)state;
    struct plan *plan = plan_of_boxes();
    struct error err = { 0 };
    struct shape_facts facts;
    struct mesh *cubes = surface_of(plan, 1, SURFACE_MARCHING_CUBES, SURFACE_FULL, NULL, &err);
    struct mesh *cells = surface_of(plan, 1, SURFACE_EIGHT_CELL, SURFACE_FULL, &facts, &err);
    struct mesh *again = surface_of(plan, 1, SURFACE_EIGHT_CELL, SURFACE_FULL, NULL, &err);
    assert_ptr_not_equal(cubes, cells);
    assert_ptr_equal(cells, again);
    assert_int_equal(facts.n_triangles, 12); /* a cube between the eight centres */
    assert_int_equal(facts.n_vertices, 8);
    assert_close(facts.volume_mm3, 1, 1e-6);
    assert_close(facts.area_mm2, 6, 1e-6);
    assert_int_equal(facts.n_univels, 8);
    assert_close(facts.univel_volume_mm3, 8, 1e-9);
    assert_non_null(cells->normals);
    mesh_unref(cubes);
    mesh_unref(cells);
    mesh_unref(again);

    struct mesh *lone = surface_of(plan, 2, SURFACE_EIGHT_CELL, SURFACE_FULL, &facts, &err);
    assert_non_null(lone); /* a surface, but an empty one */
    assert_int_equal(facts.n_triangles, 0);
    assert_int_equal(facts.n_univels, 1);
    mesh_unref(lone);
    plan_and_derived_destroy(plan);
}

static void a_small_region_does_not_vanish_in_motion(void **state)
{
    (void)state;
    struct plan *plan = plan_of_boxes();
    struct error err = { 0 };
    struct shape_facts large, small, lone;
    mesh_unref(surface_of(plan, 0, SURFACE_EIGHT_CELL, SURFACE_COARSE, &large, &err));
    mesh_unref(surface_of(plan, 1, SURFACE_EIGHT_CELL, SURFACE_COARSE, &small, &err));
    mesh_unref(surface_of(plan, 2, SURFACE_EIGHT_CELL, SURFACE_COARSE, &lone, &err));
    assert_true(large.reduction > 1); /* 12 x 133 x 133 triangles are too many */
    assert_true(large.n_triangles < COARSE_MAX_TRIANGLES);
    assert_int_equal(small.reduction, 1); /* two voxels wide: any reduction makes it one, and so nothing */
    assert_int_equal(small.n_triangles, 12);
    assert_int_equal(lone.n_triangles, 0);
    plan_and_derived_destroy(plan);
}

static bool no_more_than(void *context)
{
    size_t *left = context;
    return (*left)-- > 0;
}

static void several_surfaces_are_built_at_once_and_are_those_built_one_by_one(void **state)
{
    (void)state;
    struct plan *plan = plan_of_boxes(), *other = plan_of_boxes();
    struct once_cache_usage usage;
    const struct subject regions[3] = { subject_region(2), subject_region(0), subject_region(1) };
    derive_build_surfaces(derived_of(plan), regions, 3, SURFACE_SMOOTH, SURFACE_FULL, NULL, NULL);
    derive_usage(derived_of(plan), &usage);
    assert_int_equal(usage.n_results, 3);
    for (size_t r = 0; r < 3; r++) {
        struct mesh *together = surface_of(plan, r, SURFACE_SMOOTH, SURFACE_FULL, NULL, NULL);
        struct mesh *alone = surface_of(other, r, SURFACE_SMOOTH, SURFACE_FULL, NULL, NULL);
        assert_int_equal(together->n_vertices, alone->n_vertices);
        assert_memory_equal(together->positions_lps_mm, alone->positions_lps_mm, 3 * alone->n_vertices * sizeof(float));
        assert_memory_equal(together->normals, alone->normals, 3 * alone->n_vertices * sizeof(float));
        mesh_unref(together);
        mesh_unref(alone);
    }
    derive_usage(derived_of(plan), &usage);
    assert_int_equal(usage.n_results, 3); /* they were there */
    plan_and_derived_destroy(plan);

    size_t left = 0;
    plan = plan_of_boxes();
    derive_build_surfaces(derived_of(plan), regions, 1, SURFACE_SMOOTH, SURFACE_FULL, no_more_than, &left);
    derive_usage(derived_of(plan), &usage);
    assert_int_equal(usage.n_results, 0);
    derive_build_surfaces(derived_of(plan), regions, 0, SURFACE_SMOOTH, SURFACE_FULL, NULL,
                          NULL); /* nothing is asked for */
    plan_and_derived_destroy(plan);
    plan_and_derived_destroy(other);
}

static void assert_same_shape(const struct shape *a, const struct shape *b)
{
    assert_int_equal(a->kind, b->kind);
    assert_int_equal(a->n_bytes, b->n_bytes);
    if (a->mesh) {
        assert_memory_equal(a->mesh->positions_lps_mm, b->mesh->positions_lps_mm,
                            3 * b->mesh->n_vertices * sizeof(float));
        assert_memory_equal(a->mesh->indices, b->mesh->indices, 3 * b->mesh->n_triangles * sizeof(uint32_t));
        assert_memory_equal(a->mesh->normals, b->mesh->normals, 3 * b->mesh->n_vertices * sizeof(float));
    }
    if (a->points)
        assert_memory_equal(a->points->positions_lps_mm, b->points->positions_lps_mm,
                            3 * b->points->n_points * sizeof(float));
}

static void shapes_of_all_kinds_built_at_once_are_those_built_one_by_one(void **state)
{
    (void)state;
    struct plan *plan = plan_of_boxes(), *other = plan_of_boxes();
    const struct shape_want wants[] = {
        { subject_region(0), { .representation = REPRESENTATION_UNIVELS }, SURFACE_FULL },
        { subject_region(0), { .representation = REPRESENTATION_POINTS, .has_inner_boundary = true }, SURFACE_FULL },
        { subject_region(1), { .representation = REPRESENTATION_FAN }, SURFACE_COARSE },
        { subject_region(1),
          { .representation = REPRESENTATION_SURFACE, .algorithm = SURFACE_MARCHING_CUBES },
          SURFACE_COARSE },
        { subject_region(2),
          { .representation = REPRESENTATION_SURFACE, .algorithm = SURFACE_EIGHT_CELL },
          SURFACE_FULL },
        { subject_region(9), { .representation = REPRESENTATION_POINTS }, SURFACE_FULL }, /* there is no such region */
    };
    enum { N = sizeof wants / sizeof *wants };
    derive_build_shapes(derived_of(plan), wants, N, NULL, NULL);
    derive_build_shapes(derived_of(plan), wants, N, NULL, NULL); /* all are there */
    for (size_t i = 0; i + 1 < N; i++) {
        struct shape_facts facts, alone_facts;
        struct shape *together = derive_shape(derived_of(plan), &wants[i], &facts, NULL);
        struct shape *alone = derive_shape(derived_of(other), &wants[i], &alone_facts, NULL);
        assert_same_shape(together, alone);
        assert_int_equal(facts.n_univels, alone_facts.n_univels);
        assert_int_equal(facts.reduction, alone_facts.reduction);
        shape_unref(together);
        shape_unref(alone);
    }
    plan_and_derived_destroy(plan);
    plan_and_derived_destroy(other);
}

static void masks_are_the_regions_however_many_are_made_at_once_and_asked_for_again(void **state)
{
    (void)state;
    struct plan *plan = plan_of_boxes();
    const struct mask_wish wishes[] = { { 0, false }, { 1, true }, { 2, false }, { 0, true } };
    const uint64_t one = (uint64_t)3 * 8 * 150 * 150, most[] = { 0, one, 2 * one, UINT64_MAX };
    const size_t order[] = { 1, 0, 3, 1, 2 };
    for (size_t m = 0; m < 4; m++) {
        struct error err = { 0 };
        struct region_masks *masks = region_masks_create(plan, wishes, 4, most[m]);
        for (size_t i = 0; i < 5; i++) {
            struct mask *mask = region_masks_take(masks, order[i], &err),
                        *alone = mask_from_region(&plan->regions, wishes[order[i]].region, 1, &err);
            assert_non_null(mask);
            assert_memory_equal(mask->bits, alone->bits, one);
            mask_destroy(mask);
            mask_destroy(alone);
        }
        region_masks_destroy(masks); /* with what nobody took */
    }
    plan_and_derived_destroy(plan);
}

/* Every other slice of 4 mm is a plate. */
static double plates_label(struct vec3 p)
{
    return fabs(p.x) < 67 && fabs(p.y) < 67 && fabs(p.z) < 78 && (long)floor((p.z + 80) / 4) % 2 == 0;
}

static void thick_slices_are_not_thinned_before_the_pixels_are_as_large(void **state)
{
    (void)state;
    const uint32_t size[3] = { 150, 150, 40 };
    struct affine map = made_affine(vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 4), size, vec3(0, 0, 0));
    struct grid grid = made_grid(150, 150, 40, map);
    for (enum surface_algorithm algorithm = 0; algorithm < SURFACE_N_ALGORITHMS; algorithm++) {
        struct plan *plan = made_plan(&grid, plates_label, boxes, 1);
        struct shape_facts facts;
        struct error err = { 0 };
        struct mesh *mesh = surface_of(plan, 0, algorithm, SURFACE_COARSE, &facts, &err);
        assert_non_null(mesh);
        assert_true(facts.reduction > 1 && facts.reduction <= 5);
        assert_true(facts.n_triangles <= COARSE_MAX_TRIANGLES);
        /* 19 plates still, each on its own; the 8-cell algorithm draws a plate of one univel as two sheets that share
         * their rim */
        if (algorithm != SURFACE_EIGHT_CELL)
            assert_int_equal(mesh_euler(mesh), 2 * 19);
        assert_close(mesh->bounds_lps_mm.high.z - mesh->bounds_lps_mm.low.z, 37 * 4,
                     4); /* between outermost centres and a slice more */
        mesh_unref(mesh);
        plan_and_derived_destroy(plan);
    }
}

static void seras_head_by_either_algorithm_in_full_and_coarse(void **state)
{
    (void)state;
    struct plan *plan = plan_of_data("sera-head");
    if (!plan)
        skip();
    size_t n_coarse = 0;
    for (size_t r = 0; r < plan->regions.n_regions; r++) {
        struct shape_facts cubes, cells, coarse;
        mesh_unref(surface_of(plan, r, SURFACE_MARCHING_CUBES, SURFACE_FULL, &cubes, NULL));
        mesh_unref(surface_of(plan, r, SURFACE_EIGHT_CELL, SURFACE_FULL, &cells, NULL));
        mesh_unref(surface_of(plan, r, SURFACE_EIGHT_CELL, SURFACE_COARSE, &coarse, NULL));
        /* Sera3d on this head: 137,132 of 189,092, 85,240 of 108,558, 10,236 of 13,028; closed at the scan's end the
         * caps, with as many triangles by either, bring the scalp's nearer to 1 */
        double share = (double)cells.n_triangles / (double)cubes.n_triangles;
        assert_true(share > 0.7 && share < 0.85);
        assert_true(cells.volume_mm3 < cubes.volume_mm3);
        assert_true(coarse.n_triangles > 0 && coarse.n_triangles < cells.n_triangles);
        n_coarse += coarse.n_triangles;
    }
    assert_true(n_coarse <= COARSE_MAX_TRIANGLES);
    plan_and_derived_destroy(plan);
}

static struct shape *shape_of(struct plan *plan, size_t region, enum surface_algorithm algorithm,
                              struct shape_facts *facts)
{
    struct error err = { 0 };
    /* a field that surfaces do not use makes no other shape */
    struct shape_key key = { .representation = REPRESENTATION_SURFACE, .algorithm = algorithm, .nurbs_order = 3 };
    const struct shape_want want = { subject_region(region), key, SURFACE_FULL };
    struct shape *shape = derive_shape(derived_of(plan), &want, facts, &err);
    assert_string_equal(err.text, "");
    assert_non_null(shape);
    return shape;
}

static void what_was_not_used_for_longest_is_dropped_but_lives_on_with_who_holds_it(void **state)
{
    (void)state;
    struct plan *plan = plan_of_boxes();
    struct shape_facts facts;
    struct once_cache_usage usage;
    derive_usage(derived_of(plan), &usage);
    assert_int_equal(usage.n_results, 0);
    assert_int_equal(usage.budget_bytes, DERIVE_BUDGET_BYTES);
    struct shape *small = shape_of(plan, 1, SURFACE_MARCHING_CUBES, &facts);
    struct shape *lone = shape_of(plan, 2, SURFACE_MARCHING_CUBES, NULL);
    struct shape *again = shape_of(plan, 1, SURFACE_MARCHING_CUBES, NULL); /* so the lone one is the oldest */
    struct shape *cells = shape_of(plan, 1, SURFACE_EIGHT_CELL, NULL);
    assert_ptr_equal(small, again);
    assert_int_equal(facts.n_bytes, small->n_bytes);
    assert_true(facts.n_bytes >= facts.n_triangles * 12 + facts.n_vertices * 24);
    derive_usage(derived_of(plan), &usage);
    assert_int_equal(usage.n_results, 3);
    assert_int_equal(usage.n_bytes, small->n_bytes + lone->n_bytes + cells->n_bytes);

    derive_set_budget(derived_of(plan), usage.n_bytes - 1);
    derive_usage(derived_of(plan), &usage);
    assert_int_equal(usage.n_results, 2);
    assert_int_equal(usage.n_bytes, small->n_bytes + cells->n_bytes);
    derive_set_budget(derived_of(plan), lone->n_bytes);
    assert_int_equal(lone->mesh->n_triangles, 8); /* an octahedron still, as this test holds it */
    struct shape *rebuilt = shape_of(plan, 2, SURFACE_MARCHING_CUBES, NULL); /* takes the place of the other */
    assert_ptr_not_equal(rebuilt, lone);
    assert_memory_equal(rebuilt->mesh->positions_lps_mm, lone->mesh->positions_lps_mm, 3 * 6 * sizeof(float));
    derive_usage(derived_of(plan), &usage);
    assert_int_equal(usage.n_results, 1);

    derive_set_budget(derived_of(plan),
                      0); /* even then the newest is kept, or two who take turns would build without end */
    shape_unref(shape_of(plan, 0, SURFACE_MARCHING_CUBES, NULL));
    derive_usage(derived_of(plan), &usage);
    assert_int_equal(usage.n_results, 1);
    shape_unref(small);
    shape_unref(again);
    shape_unref(lone);
    shape_unref(cells);
    shape_unref(rebuilt);
    plan_and_derived_destroy(plan);
}

/* Boxes of 5^3, 3^3 and 1 voxels of 10 mm, one inside the other. */
static double nested_boxes_label(struct vec3 p)
{
    double d = fmax(fmax(fabs(p.x), fabs(p.y)), fabs(p.z));
    return d < 5 ? 3 : d < 15 ? 2 : d < 25 ? 1 : 0;
}
static const struct made_region nested_boxes[] = { { "outer", -1, 0xff8040 },
                                                   { "middle", 0, 0x40ff80 },
                                                   { "inner", 1, 0x8040ff } };

static struct plan *plan_of_nested_boxes(void)
{
    const uint32_t size[3] = { 9, 9, 9 };
    struct affine map = made_affine(vec3(10, 0, 0), vec3(0, 10, 0), vec3(0, 0, 10), size, vec3(0, 0, 0));
    struct grid grid = made_grid(9, 9, 9, map);
    return made_plan(&grid, nested_boxes_label, nested_boxes, 3);
}

static void surfaces_are_built_once_and_hold_what_lies_inside(void **state)
{
    (void)state;
    struct error err = { 0 };
    struct plan *plan = plan_of_nested_boxes();
    struct shape_facts facts, coarse;
    struct mesh *first = surface_of(plan, 0, SURFACE_MARCHING_CUBES, SURFACE_FULL, &facts, &err);
    struct mesh *second = surface_of(plan, 0, SURFACE_MARCHING_CUBES, SURFACE_FULL, NULL, &err);
    struct mesh *moving = surface_of(plan, 0, SURFACE_MARCHING_CUBES, SURFACE_COARSE, &coarse, &err);
    assert_ptr_equal(first, second);
    assert_ptr_equal(first, moving); /* so few triangles that nothing is to be saved */
    assert_int_equal(coarse.reduction, 1);
    assert_int_equal(facts.n_univels, 125);
    assert_close(facts.univel_volume_mm3, 125000, 1e-6);
    /* through the outermost centres 4^3; on its faces 6 slabs of half a voxel; along its edges 12 prisms of 4 x 1/8; at
     * its corners 8 tetrahedra of 1/48: 118.1667 voxels of 1000 mm3 */
    assert_near(facts.volume_mm3, 118166.667, 1e-5);
    assert_int_equal(mesh_open_edges(first), 0);
    assert_non_null(first->normals);
    mesh_unref(first);
    mesh_unref(second);
    mesh_unref(moving);
    assert_null(surface_of(plan, 99, SURFACE_MARCHING_CUBES, SURFACE_FULL, &facts, &err));
    assert_int_equal(err.code, ERROR_RANGE);
    plan_and_derived_destroy(plan);
}

struct batch {
    struct plan *plan;
    struct mesh *meshes[4][3][2];
};

static void ask_for_all(void *context, int part, int n_parts)
{
    (void)n_parts;
    struct batch *batch = context;
    for (size_t r = 0; r < 3; r++)
        for (int detail = 0; detail < 2; detail++)
            batch->meshes[part][r][detail] =
                surface_of(batch->plan, r, SURFACE_MARCHING_CUBES, (enum surface_detail)detail, NULL, NULL);
}

static void many_threads_get_the_same_surfaces(void **state)
{
    (void)state;
    struct batch batch = { .plan = plan_of_nested_boxes() };
    (void)derived_of(batch.plan); /* before there are threads */
    parallel_run(4, ask_for_all, &batch);
    for (size_t r = 0; r < 3; r++)
        for (int detail = 0; detail < 2; detail++)
            for (int part = 0; part < 4; part++) {
                assert_non_null(batch.meshes[part][r][detail]);
                assert_ptr_equal(batch.meshes[part][r][detail], batch.meshes[0][r][detail]);
                mesh_unref(batch.meshes[part][r][detail]);
            }
    plan_and_derived_destroy(batch.plan);
}

static void coarse_surfaces_of_a_whole_plan_stay_under_their_limit(void **state)
{
    (void)state;
    struct plan *plan = plan_of_data("sera-head");
    if (!plan)
        skip();
    size_t n_full = 0, n_coarse = 0;
    for (size_t r = 0; r < plan->regions.n_regions; r++) {
        struct shape_facts full, coarse;
        mesh_unref(surface_of(plan, r, SURFACE_MARCHING_CUBES, SURFACE_FULL, &full, NULL));
        mesh_unref(surface_of(plan, r, SURFACE_MARCHING_CUBES, SURFACE_COARSE, &coarse, NULL));
        n_full += full.n_triangles;
        n_coarse += coarse.n_triangles;
        assert_int_equal(coarse.n_univels, full.n_univels);
        assert_true(coarse.reduction > 1);
        /* descendants lie inside: scalp holds brain and tumour */
        assert_near(full.volume_mm3, full.univel_volume_mm3, 0.02);
    }
    assert_true(n_full > COARSE_MAX_TRIANGLES);
    assert_true(n_coarse <= COARSE_MAX_TRIANGLES);
    plan_and_derived_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(surfaces_are_built_once_and_hold_what_lies_inside),
        cmocka_unit_test(many_threads_get_the_same_surfaces),
        cmocka_unit_test(coarse_surfaces_of_a_whole_plan_stay_under_their_limit),
        cmocka_unit_test(surfaces_are_kept_by_algorithm),
        cmocka_unit_test(a_small_region_does_not_vanish_in_motion),
        cmocka_unit_test(what_was_not_used_for_longest_is_dropped_but_lives_on_with_who_holds_it),
        cmocka_unit_test(several_surfaces_are_built_at_once_and_are_those_built_one_by_one),
        cmocka_unit_test(shapes_of_all_kinds_built_at_once_are_those_built_one_by_one),
        cmocka_unit_test(masks_are_the_regions_however_many_are_made_at_once_and_asked_for_again),
        cmocka_unit_test(thick_slices_are_not_thinned_before_the_pixels_are_as_large),
        cmocka_unit_test(seras_head_by_either_algorithm_in_full_and_coarse),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
