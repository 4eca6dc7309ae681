/* Figures of a histogram of which a part has no dose: their bounds, and what limits may say from them. */
#include "core/dose/dvh.h"
#include "core/dose/dvh_metrics.h"
#include "tests/check.h"
#include "tests/made_plan.h"

static double uniform(void)
{
    return (double)rand() / RAND_MAX;
}

/* 12^3 univels of 1 mm with random doses, some of them without one, which have `missing` instead unless it is NAN. */
static struct dvh part_filled(unsigned seed, double part, double missing)
{
    struct grid grid = made_cube_grid(12);
    struct error err = { 0 };
    struct volume *labels = volume_create(&grid, VOXEL_U8, &err), *dose = volume_create(&grid, VOXEL_F32, &err);
    struct dvh dvh;
    memset(labels->voxels, 1, grid_n_voxels(&grid));
    srand(seed);
    for (size_t i = 0; i < grid_n_voxels(&grid); i++) {
        double value = 20 * uniform() * uniform();
        ((float *)dose->voxels)[i] = (float)(uniform() < part ? missing : value);
    }
    volume_measure(dose);
    const struct volume *rows[1] = { dose };
    assert_true(dvh_sweep(&(struct dvh_sweep){ .labels = labels, .rows = rows, .n_rows = 1 },
                          &(struct dvh_label){ 1, 1 }, 1, &dvh, &err));
    volume_unref(labels);
    volume_unref(dose);
    return dvh;
}

/* -1 not known, else whether the limit is met, as a limit is judged from the bounds of its figure. */
static int state_of(const struct dvh *dvh, const struct dvh_metric *metric, double limit, bool is_at_most)
{
    double least, most;
    dvh_metric_range(dvh, metric, &least, &most);
    bool low = is_at_most ? least <= limit : least >= limit, high = is_at_most ? most <= limit : most >= limit;
    return low == high ? low : -1;
}

static void no_dose_of_the_missing_part_leaves_the_bounds_or_turns_a_limit_from_met_to_not_met(void **state)
{
    (void)state;
    static const char *const words[] = { "mean", "min",    "max", "D98%", "D95%", "D50%",   "D2%",
                                         "D1cc", "D0.1cc", "V5",  "V5cc", "V12",  "V0.5cc", "HI" };
    int n_known = 0, n_open = 0;
    for (unsigned seed = 1; seed <= 24; seed++) {
        double part = seed % 4 == 0 ? 0.82 : 0.4 * seed / 24;
        struct dvh found = part_filled(seed, part, NAN);
        struct dvh filled[2] = { part_filled(seed, part, 0), part_filled(seed, part, 2 * found.high) };
        assert_true(dvh_is_partial(&found));
        for (int f = 0; f < 2; f++) {
            for (double value = 0; value < 45; value += 0.37) { /* the band */
                double from = dvh_univels_from(&filled[f], value), known = dvh_univels_from(&found, value);
                /* a bin is 1/2048 wide, and holds some of 1728 univels */
                assert_true(known - 2 <= from && from <= known + found.n_missing + 2);
            }
            for (size_t w = 0; w < sizeof words / sizeof *words; w++) {
                struct dvh_metric metric;
                double least, most;
                assert_true(dvh_metric_parse(words[w], &metric, NULL));
                dvh_metric_range(&found, &metric, &least, &most);
                double value = dvh_metric_value(&filled[f], &metric);
                assert_true(least <= value + 2e-3 * fabs(value) + 0.12 && value <= most + 2e-3 * fabs(value) + 0.12);
                for (int test = 0; test < 20; test++) {
                    bool is_at_most = test % 2;
                    double limit = metric.kind == DVH_VOLUME_PERCENT ? 100 * uniform() : 40 * uniform() * uniform();
                    int said = state_of(&found, &metric, limit, is_at_most);
                    if (fabs(limit - value) < 2e-3 * fabs(value) + 0.12)
                        continue; /* within a bin of the figure */
                    n_open += said < 0;
                    n_known += said >= 0;
                    assert_true(said < 0 || said == (is_at_most ? value <= limit : value >= limit));
                }
            }
        }
        dvh_finish(&found);
        dvh_finish(&filled[0]);
        dvh_finish(&filled[1]);
    }
    assert_true(n_known > 500 && n_open > 500);
}

static void a_figure_is_said_as_bounds_from_a_thousandth_without_dose_on(void **state)
{
    (void)state;
    struct dvh dvh = { .n = 9991, .n_missing = 9, .univel_cm3 = 0.001, .sum = 9991, .low = 1, .high = 1 };
    const struct dvh_metric mean = { DVH_MEAN, 0 };
    double least, most;
    dvh_metric_range(&dvh, &mean, &least, &most);
    assert_false(dvh_is_partial(&dvh));
    assert_true(least == 1 && most == 1);
    dvh.n = 9990;
    dvh.n_missing = 10;
    dvh.sum = 9990;
    dvh_metric_range(&dvh, &mean, &least, &most);
    assert_true(dvh_is_partial(&dvh));
    assert_near(least, 0.999, 1e-12);
    assert_true(isinf(most));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_dose_of_the_missing_part_leaves_the_bounds_or_turns_a_limit_from_met_to_not_met),
        cmocka_unit_test(a_figure_is_said_as_bounds_from_a_thousandth_without_dose_on),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
