/* Weighted means of SERA's sample head against the tables that seraMC and seraPlan printed, in every digit. What is
 * theirs is done here: which points are averaged, and how cells are interpolated. Cells, labels, weights and factors
 * are ours. */
#include "core/dose/weights.h"
#include "core/plan/plan.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/plan_help.h"

/* How SERA interpolates: along each axis the parabola whose means over the cell and its two neighbours are theirs, the
 * three multiplied and divided by the cell's value squared; never below zero; the cell's value beside a cell without
 * dose. The other dose also where this leaves the range of cells around: in seraMC of 3^3 cells, in seraPlan of the 2^3
 * from the one before to the cell. `held` counts those along an edge; 0: not held. */
static double interpolate(const struct volume *volume, const uint32_t cell[3], const double between[3], uint32_t held)
{
    const uint32_t *size = volume->grid.size;
    double here = volume_value(volume, cell[0], cell[1], cell[2]), product = 1, least = INFINITY, most = 0;
    for (int a = 0; a < 3; a++)
        if (cell[a] == 0 || cell[a] + 1 >= size[a])
            return NAN; /* no region of the head reaches there */
    for (int n = 0; n < 27; n++) {
        double value = volume_value(volume, cell[0] + (uint32_t)(n % 3) - 1, cell[1] + (uint32_t)(n / 3 % 3) - 1,
                                    cell[2] + (uint32_t)(n / 9) - 1);
        if (!(value > 0))
            return here;
    }
    for (int a = 0; a < 3; a++) {
        const uint32_t d[3] = { a == 0, a == 1, a == 2 };
        double before = volume_value(volume, cell[0] - d[0], cell[1] - d[1], cell[2] - d[2]),
               after = volume_value(volume, cell[0] + d[0], cell[1] + d[1], cell[2] + d[2]),
               bend = before - 2 * here + after;
        product *= here - bend / 24 + (after - before) / 2 * between[a] + bend / 2 * between[a] * between[a];
    }
    double value = fmax(product / (here * here), 0);
    for (uint32_t n = 0; n < held * held * held; n++) {
        double corner =
            volume_value(volume, cell[0] + n % held - 1, cell[1] + n / held % held - 1, cell[2] + n / held / held - 1);
        least = fmin(least, corner);
        most = fmax(most, corner);
    }
    return held > 0 && (value < least || value > most) ? here : value;
}

static double value_at(const struct volume *volume, struct vec3 point_lps_mm, uint32_t held)
{
    struct vec3 at = affine_point(&volume->grid.ijk_from_lps_mm, point_lps_mm);
    const double c[3] = { at.x, at.y, at.z };
    uint32_t cell[3];
    double between[3];
    assert_true(volume_voxel_at(volume, point_lps_mm, cell));
    for (int a = 0; a < 3; a++)
        between[a] = c[a] - cell[a];
    return interpolate(volume, cell, between, held);
}

/* ---- what was printed ------------------------------------------------------------------------------------------- */

enum { N = 5 };
static const enum dose_quantity quantities[N] = { DOSE_BORON, DOSE_GAMMA, DOSE_NITROGEN, DOSE_FAST, DOSE_OTHER };

struct printed {
    const char *region;
    double cbe, volume_cm3;
    double total, means[N]; /* in the order of quantities */
};
/* seraMC, "DV mean", five digits. Scalp's CBE differs from the plan's file. */
static const struct printed by_mc[] = {
    { "tumor", 3.8, 67.6993, 453.11, { 410.12, 26.524, 13.443, 2.9443, 0.075494 } },
    { "brain", 1.3, 1717.52, 22.814, { 9.1019, 9.5249, 3.0538, 1.1027, 0.030315 } },
    { "scalp", 2.5, 3333.80, 12.566, { 7.3796, 3.5244, 0.86070, 0.78051, 0.020930 } },
};
/* seraPlan, "DV mean", three decimals. */
static const struct printed by_plan[] = {
    { "tumor", 3.8, 67.152, 455.185, { 412.046, 26.600, 13.506, 2.957, 0.075 } },
    { "brain", 1.3, 1713.7, 22.868, { 9.132, 9.541, 3.064, 1.100, 0.030 } },
    { "scalp", 1.3, 3352.1, 9.017, { 3.836, 3.522, 0.860, 0.779, 0.021 } },
};

struct sums {
    double means[N];
    size_t n;
};

static void add_point(const struct dose *dose, struct vec3 point, const struct dose_factors *factors, uint32_t held,
                      struct sums *sums)
{
    for (int q = 0; q < N; q++) {
        const struct dose_component *component = dose_component_of(dose, quantities[q]);
        assert_non_null(component);
        sums->means[q] +=
            factors->of[quantities[q]] * value_at(component->values, point, quantities[q] == DOSE_OTHER ? held : 0);
    }
    sums->n++;
}

static struct dose_factors factors_in(const struct plan *plan, const struct printed *printed)
{
    const struct region *region = region_of(plan, printed->region);
    const struct tissue_weights weights = {
        .boron_ratio = region->boron_ratio, .cbe = printed->cbe, .nitrogen = 3.2, .fast = 3.2, .gamma = 1, .other = 1
    };
    return dose_factors_of(&plan->doses[0], DOSE_SHOWN_WEIGHTED, DOSE_TOTAL, &weights, 15);
}

static void assert_printed(const struct sums *sums, const struct printed *printed, double digits, bool is_relative)
{
    double total = 0;
    for (int q = 0; q < N; q++) {
        double mean = sums->means[q] / (double)sums->n;
        total += mean;
        if (!(fabs(mean - printed->means[q]) <= (is_relative ? digits * printed->means[q] : digits)))
            fail_msg("%s of %s is %.7g, printed is %.7g", dose_quantity_word(quantities[q]), printed->region, mean,
                     printed->means[q]);
    }
    if (!(fabs(total - printed->total) <= (is_relative ? digits * printed->total : digits)))
        fail_msg("the total of %s is %.7g, printed is %.7g", printed->region, total, printed->total);
}

/* seraMC averages points in the region's box (of the .uvh): as many equal steps of at most 0.25 cm as fit and one. */
static void seramc_s_means_come_out_in_every_printed_digit(void **state)
{
    (void)state;
    struct plan *plan = plan_of_data("sera-head");
    if (!plan)
        skip();
    for (size_t p = 0; p < sizeof by_mc / sizeof *by_mc; p++) {
        const struct region *region = region_of(plan, by_mc[p].region);
        const struct volume *labels = plan->regions.layers[region->layer];
        struct dose_factors factors = factors_in(plan, &by_mc[p]);
        struct vec3 low = affine_point(&labels->grid.lps_mm_from_ijk,
                                       vec3(region->low_ijk[0] - 0.5, region->low_ijk[1] - 0.5,
                                            region->low_ijk[2] - 0.5)),
                    high = affine_point(&labels->grid.lps_mm_from_ijk,
                                        vec3(region->high_ijk[0] + 0.5, region->high_ijk[1] + 0.5,
                                             region->high_ijk[2] + 0.5));
        struct vec3 size = vec3_sub(high, low);
        const double lengths[3] = { fabs(size.x), fabs(size.y), fabs(size.z) };
        uint32_t n[3];
        struct sums sums = { 0 };
        for (int a = 0; a < 3; a++)
            n[a] = (uint32_t)(lengths[a] / 2.5) + 1;
        for (uint32_t at = 0; at < n[0] * n[1] * n[2]; at++) {
            struct vec3 point =
                vec3(low.x + size.x * (at % n[0] + 0.5) / n[0], low.y + size.y * (at / n[0] % n[1] + 0.5) / n[1],
                     low.z + size.z * (at / n[0] / n[1] + 0.5) / n[2]);
            uint32_t ijk[3];
            if (volume_voxel_at(labels, point, ijk) && volume_label(labels, ijk[0], ijk[1], ijk[2]) == region->label)
                add_point(&plan->doses[0], point, &factors, 3, &sums);
        }
        assert_near((double)sums.n * lengths[0] * lengths[1] * lengths[2] / (n[0] * n[1] * n[2]) / 1e3,
                    by_mc[p].volume_cm3, 5e-5);
        assert_printed(&sums, &by_mc[p], 6e-5, true);
    }
    plan_destroy(plan);
}

/* seraPlan averages the univels' centres. It counts rows from the back, where the .uvh says that 256 of 1.01562 mm are
 * 260 mm: its centres lie 0.00128 mm behind ours. */
static void seraplan_s_means_come_out_in_every_printed_digit(void **state)
{
    const struct vec3 shift = vec3(0, 260 - 256 * 1.01562, 0);
    (void)state;
    struct plan *plan = plan_of_data("sera-head");
    if (!plan)
        skip();
    for (size_t p = 0; p < sizeof by_plan / sizeof *by_plan; p++) {
        const struct region *region = region_of(plan, by_plan[p].region);
        const struct volume *labels = plan->regions.layers[region->layer];
        struct dose_factors factors = factors_in(plan, &by_plan[p]);
        struct sums sums = { 0 };
        for (uint32_t k = region->low_ijk[2]; k <= region->high_ijk[2]; k++)
            for (uint32_t j = region->low_ijk[1]; j <= region->high_ijk[1]; j++)
                for (uint32_t i = region->low_ijk[0]; i <= region->high_ijk[0]; i++)
                    if (volume_label(labels, i, j, k) == region->label)
                        add_point(&plan->doses[0],
                                  vec3_add(affine_point(&labels->grid.lps_mm_from_ijk, vec3(i, j, k)), shift), &factors,
                                  2, &sums);
        assert_near((double)sums.n * grid_voxel_mm3(&labels->grid) / 1e3, by_plan[p].volume_cm3, 5e-5);
        assert_printed(&sums, &by_plan[p], 6e-4, false);
    }
    plan_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(seramc_s_means_come_out_in_every_printed_digit),
        cmocka_unit_test(seraplan_s_means_come_out_in_every_printed_digit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
