/* The store of derived results, and that a new kind of result needs nothing but a file of its own: this one. */
#include "core/derive/derive.h"

#include <stdlib.h>

#include "core/base/mem.h"
#include "tests/check.h"
#include "tests/derived_of.h"
#include "tests/made_plan.h"

/* ---- a kind: how many of a region's voxels lie below a plane, and the kind's whole interface --------------------- */

struct below_recipe {
    struct derive_recipe base; /* the subject is a region */
    double z_mm;
};
struct below {
    struct derive_result base;
    size_t n_voxels;
};

static int n_builds, n_destroyed;

static bool below_is_equal(const struct derive_recipe *a, const struct derive_recipe *b)
{
    double x = ((const struct below_recipe *)a)->z_mm, y = ((const struct below_recipe *)b)->z_mm;
    return !(x < y) && !(x > y);
}

static struct derive_result *below_build(struct derive *derive, const struct derive_recipe *base, const void *way,
                                         struct error *err);

static void below_destroy(struct derive_result *base)
{
    n_destroyed++;
    free(base);
}

static const struct derive_kind below_kind = { sizeof(struct below_recipe), below_is_equal, below_build,
                                               below_destroy };

static struct derive_result *below_build(struct derive *derive, const struct derive_recipe *base, const void *way,
                                         struct error *err)
{
    (void)way;
    const struct region_set *set = &derive_plan(derive)->regions;
    double z_mm = ((const struct below_recipe *)base)->z_mm;
    const struct region *region = &set->regions[base->subject.index];
    const struct volume *layer = set->layers[region->layer];
    n_builds++;
    if (z_mm < -1000) {
        error_set(err, ERROR_RANGE, "no plan reaches down to %.0f mm", z_mm);
        return NULL;
    }
    struct below *below = mem_new(sizeof *below);
    derive_result_init(&below->base, &below_kind, 1 << 20);
    for (uint32_t k = 0; k < layer->grid.size[2]; k++)
        for (uint32_t j = 0; j < layer->grid.size[1]; j++)
            for (uint32_t i = 0; i < layer->grid.size[0]; i++)
                below->n_voxels += affine_point(&layer->grid.lps_mm_from_ijk, vec3(i, j, k)).z < z_mm &&
                                   volume_label(layer, i, j, k) == region->label;
    return &below->base;
}

static size_t voxels_below(struct derive *derive, size_t region, double z_mm)
{
    const struct below_recipe recipe = { { &below_kind, subject_region(region) }, z_mm };
    struct error err = { 0 };
    struct below *below = (struct below *)derive_get(derive, &recipe.base, NULL, &err);
    assert_non_null(below);
    size_t n = below->n_voxels;
    derive_result_unref(&below->base);
    return n;
}

/* ---- tests ------------------------------------------------------------------------------------------------------ */

/* Two slabs of 4 x 20 x 20 voxels of 1 mm, side by side along L. */
static double slabs_label(struct vec3 p)
{
    return p.x > -8 && p.x < -4 ? 1 : p.x > 4 && p.x < 8 ? 2 : 0;
}
static const struct made_region slabs[] = { { "right", -1, 0xff0000 }, { "left", -1, 0x00ff00 } };

static struct plan *plan_of_slabs(void)
{
    struct grid grid = made_cube_grid(20);
    return made_plan(&grid, slabs_label, slabs, 2);
}

static void a_kind_of_result_is_one_file_and_no_line_elsewhere(void **state)
{
    (void)state;
    struct plan *plan = plan_of_slabs();
    struct derive *derive = derive_create(plan);
    struct once_cache_usage usage;
    n_builds = n_destroyed = 0;
    assert_ptr_equal(derive_plan(derive), plan);
    assert_int_equal(voxels_below(derive, 0, 0), 4 * 20 * 10);
    assert_int_equal(voxels_below(derive, 0, 0), 4 * 20 * 10);
    assert_int_equal(n_builds, 1);
    assert_int_equal(voxels_below(derive, 0, -5), 4 * 20 * 5); /* another input, another result */
    assert_int_equal(voxels_below(derive, 1, 0), 4 * 20 * 10); /* another subject */
    assert_int_equal(n_builds, 3);
    derive_usage(derive, &usage);
    assert_int_equal(usage.n_results, 3);
    assert_int_equal(usage.n_bytes, 3 << 20);
    assert_int_equal(n_destroyed, 0);
    derive_destroy(derive);
    assert_int_equal(n_destroyed, 3);
    plan_destroy(plan);
}

static void all_kinds_share_one_budget(void **state)
{
    (void)state;
    struct plan *plan = plan_of_slabs();
    struct derive *derive = derived_of(plan);
    struct error err = { 0 };
    struct once_cache_usage usage;
    n_builds = n_destroyed = 0;
    (void)voxels_below(derive, 0, 0);
    struct mesh *mesh = surface_of(plan, 0, SURFACE_MARCHING_CUBES, SURFACE_FULL, NULL, &err);
    assert_non_null(mesh);
    derive_usage(derive, &usage);
    assert_int_equal(usage.n_results, 2);
    assert_int_equal(n_destroyed, 0);
    derive_set_budget(derive, usage.n_bytes - 1); /* what was used longest ago goes, of whatever kind */
    assert_int_equal(n_destroyed, 1);
    (void)voxels_below(derive, 0, 0);
    derive_usage(derive, &usage);
    assert_int_equal(usage.n_results, 1); /* now the surface went */
    assert_int_equal(n_builds, 2);
    mesh_unref(mesh);
    plan_and_derived_destroy(plan);
}

static void a_refusal_of_any_kind_is_remembered_with_its_reason(void **state)
{
    (void)state;
    struct plan *plan = plan_of_slabs();
    struct derive *derive = derived_of(plan);
    const struct below_recipe recipe = { { &below_kind, subject_region(1) }, -2000 };
    struct error err = { 0 }, why = { 0 };
    n_builds = 0;
    assert_false(derive_has_refusals(derive));
    assert_false(derive_is_refused(derive, &recipe.base, &why));
    assert_null(derive_get(derive, &recipe.base, NULL, &err));
    assert_null(derive_get(derive, &recipe.base, NULL, &err));
    assert_int_equal(n_builds, 1);
    assert_int_equal(err.code, ERROR_RANGE);
    assert_true(derive_has_refusals(derive));
    assert_true(derive_has(derive, &recipe.base));
    assert_true(derive_is_refused(derive, &recipe.base, &why));
    assert_string_equal(why.text, err.text);
    plan_and_derived_destroy(plan);
}

static void subjects_are_equal_by_kind_and_index_and_have_the_id_of_the_plans_part(void **state)
{
    (void)state;
    struct plan *plan = plan_of_slabs();
    struct subject other = subject_region(1);
    other.key = 3;
    assert_true(subject_equal(subject_region(1), subject_region(1)));
    assert_false(subject_equal(subject_region(1), subject_region(0)));
    assert_false(subject_equal(subject_region(0), subject_plan()));
    assert_false(subject_equal(subject_region(1), other));
    assert_int_equal(subject_hash(subject_region(1)), subject_hash(subject_region(1)));
    assert_true(subject_exists(plan, subject_region(1)));
    assert_false(subject_exists(plan, subject_region(2)));
    assert_true(subject_exists(plan, subject_plan()));
    assert_string_equal(subject_id(plan, subject_region(1)), "left");
    assert_string_equal(subject_id(plan, subject_plan()), "made");
    plan_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_kind_of_result_is_one_file_and_no_line_elsewhere),
        cmocka_unit_test(all_kinds_share_one_budget),
        cmocka_unit_test(a_refusal_of_any_kind_is_remembered_with_its_reason),
        cmocka_unit_test(subjects_are_equal_by_kind_and_index_and_have_the_id_of_the_plans_part),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
