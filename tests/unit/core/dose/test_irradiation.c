/* The output of a source at which a figure reaches its limit: units, figures against a plain count, bounds. */
#include "core/dose/irradiation.h"
#include "tests/check.h"
#include "tests/made_plan.h"

/* ---- the source's output ---------------------------------------------------------------------------------------- */

static void units_of_output_are_read_in_their_spellings(void **state)
{
    (void)state;
    static const struct {
        const char *per;
        enum source_output_kind kind;
        double amount;
        const char *words;
    } rows[] = {
        { "250 kw-min", SOURCE_ENERGY, 0.25, "MW-min" },
        { "mw-min", SOURCE_ENERGY, 1, "MW-min" },
        { "mw\xc2\xb7min", SOURCE_ENERGY, 1, "MW-min" },
        { "5 mw min", SOURCE_ENERGY, 5, "MW-min" },
        { "kwh", SOURCE_ENERGY, 0.06, "MW-min" },
        { "ma-min", SOURCE_CHARGE, 1, "mA-min" },
        { "c", SOURCE_CHARGE, 1000.0 / 60, "mA-min" }, /* 1 C = 1 A s = 1000 mA s */
        { "minute", SOURCE_TIME, 1, "min" },
        { "30 s", SOURCE_TIME, 0.5, "min" },
        { "minute at 1e10 n/cm2/s", SOURCE_TIME, 1, "min at 1e10 n/cm2/s" },
        { "fraction", SOURCE_COUNT, 1, "fraction" },
        { "1e6 source neutrons", SOURCE_COUNT, 1e6, "source neutrons" },
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        struct source_output output;
        assert_true(source_output_parse(rows[i].per, &output));
        assert_int_equal(output.kind, rows[i].kind);
        assert_near(output.amount, rows[i].amount, 1e-12 * rows[i].amount);
        assert_string_equal(output.words, rows[i].words);
    }
    static const char *const none[] = { "", "   ", "0 min", "250", "nan", "infinity min", "-1 min" };
    for (size_t i = 0; i < sizeof none / sizeof *none; i++) {
        struct source_output output;
        bool is_read = source_output_parse(none[i], &output);
        assert_true(!is_read || output.kind == SOURCE_COUNT); /* words of no unit are counted as they stand */
        if (i < 4)
            assert_false(is_read);
    }
}

static void minutes_need_a_rate_in_a_unit_that_fits(void **state)
{
    (void)state;
    struct source_output energy, charge, time, count;
    assert_true(source_output_parse("mw-min", &energy) && source_output_parse("ma-min", &charge) &&
                source_output_parse("minute", &time) && source_output_parse("fraction", &count));
    assert_near(source_minutes(&energy, 5, SOURCE_MEGAWATT), 0.2, 1e-12);
    assert_near(source_minutes(&energy, 250, SOURCE_KILOWATT), 4, 1e-12);
    assert_near(source_minutes(&charge, 30, SOURCE_MILLIAMPERE), 1.0 / 30, 1e-12);
    assert_near(source_minutes(&time, 0, SOURCE_MEGAWATT), 1, 0);
    assert_true(isnan(source_minutes(&energy, 30, SOURCE_MILLIAMPERE)));
    assert_true(isnan(source_minutes(&charge, 5, SOURCE_MEGAWATT)));
    assert_true(isnan(source_minutes(&energy, 0, SOURCE_MEGAWATT)));
    assert_true(isnan(source_minutes(&count, 5, SOURCE_MEGAWATT)));
    assert_false(source_outputs_add(&energy, &charge));
    assert_true(source_outputs_add(&energy, &energy));
}

/* ---- the output at a limit -------------------------------------------------------------------------------------- */

enum { SIDE = 10, N = SIDE * SIDE * SIDE };
static float values[N];

/* Univels of 1 mm with random doses per output, some of them without one, which have `missing` unless it is NAN. */
static struct dvh made(unsigned seed, double part, double missing)
{
    struct grid grid = made_cube_grid(SIDE);
    struct error err = { 0 };
    struct volume *labels = volume_create(&grid, VOXEL_U8, &err), *dose = volume_create(&grid, VOXEL_F32, &err);
    struct dvh dvh;
    assert_int_equal(grid_n_voxels(&grid), N);
    memset(labels->voxels, 1, N);
    srand(seed);
    for (size_t i = 0; i < N; i++) {
        double value = 0.3 * rand() / RAND_MAX + 0.01;
        values[i] = (float)((double)rand() / RAND_MAX < part ? missing : value);
    }
    memcpy(dose->voxels, values, sizeof values);
    volume_measure(dose);
    const struct volume *rows[1] = { dose };
    assert_true(dvh_sweep(&(struct dvh_sweep){ .labels = labels, .rows = rows, .n_rows = 1 },
                          &(struct dvh_label){ 1, 1 }, 1, &dvh, &err));
    volume_unref(labels);
    volume_unref(dose);
    return dvh;
}

/* Percent of the univels with at least this dose at an output, counted one by one. */
static double percent_from(double dose, double output)
{
    size_t n = 0;
    for (size_t i = 0; i < N; i++)
        n += output * values[i] >= dose;
    return 100.0 * (double)n / N;
}

static double plain(const char *word, double output)
{
    double sum = 0, low = INFINITY, high = 0;
    for (size_t i = 0; i < N; i++) {
        sum += values[i];
        low = fmin(low, values[i]);
        high = fmax(high, values[i]);
    }
    return output * (word[0] == 'm' && word[1] == 'e' ? sum / N : word[1] == 'i' ? low : high);
}

static struct dvh_metric metric_of(const char *word)
{
    struct dvh_metric metric;
    assert_true(dvh_metric_parse(word, &metric, NULL));
    return metric;
}

static void at_the_output_the_figure_is_the_limit(void **state)
{
    (void)state;
    static const char *const doses[] = { "mean", "min", "max" };
    for (unsigned seed = 1; seed <= 8; seed++) {
        struct dvh dvh = made(seed, 0, NAN);
        struct irradiation_reach reach;
        for (size_t i = 0; i < sizeof doses / sizeof *doses; i++) {
            struct dvh_metric metric = metric_of(doses[i]);
            double least, most;
            assert_true(irradiation_reach_of(&dvh, &metric, true, 12.5, &reach, NULL));
            assert_true(reach.least == reach.most);
            assert_near(plain(doses[i], reach.least), 12.5, 12.5 * 1e-6);
            irradiation_figure(&dvh, &metric, reach.least, &least, &most);
            assert_near(least, 12.5, 1e-9);
            assert_near(most, 12.5, 1e-9);
        }
        /* V10 <= 30 %: before the output fewer, after it more. A bin of the histogram is 1/2048 wide. */
        struct dvh_metric volume = metric_of("V10");
        double least, most;
        assert_true(irradiation_reach_of(&dvh, &volume, true, 30, &reach, NULL));
        assert_true(percent_from(10, reach.least * (1 - 1e-3)) <= 30);
        assert_true(percent_from(10, reach.least * (1 + 1e-3)) >= 30);
        irradiation_figure(&dvh, &volume, reach.least, &least, &most);
        assert_near(least, 30, 0.3);
        struct dvh_metric cubic = metric_of("V10cc"); /* all are 1 cm3 */
        struct irradiation_reach same;
        assert_true(irradiation_reach_of(&dvh, &cubic, true, 0.3, &same, NULL));
        assert_near(same.least, reach.least, 1e-9);
        /* D30% <= 10 waits for the same */
        struct dvh_metric dose = metric_of("D30%");
        assert_true(irradiation_reach_of(&dvh, &dose, true, 10, &same, NULL));
        assert_near(same.least, reach.least, 1e-9);
        dvh_finish(&dvh);
    }
}

static void limits_that_no_output_reaches_are_never_reached(void **state)
{
    (void)state;
    struct dvh dvh = made(3, 0, NAN), none = { .univel_cm3 = 1e-3, .n_missing = 8 };
    struct irradiation_reach reach;
    struct error err = { 0 };
    struct dvh_metric volume = metric_of("V10"), cubic = metric_of("V10cc"), even = metric_of("HI"),
                      hot = metric_of("D2cc"), mean = metric_of("mean");
    assert_true(irradiation_reach_of(&dvh, &volume, true, 100, &reach, NULL));
    assert_true(isinf(reach.least));
    assert_true(irradiation_reach_of(&dvh, &cubic, true, 1.5, &reach, NULL));
    assert_true(isinf(reach.least));
    assert_true(irradiation_reach_of(&dvh, &cubic, false, 1.5, &reach, NULL)); /* more than there is */
    assert_true(isinf(reach.least));
    assert_true(irradiation_reach_of(&dvh, &mean, true, 0, &reach, NULL));
    assert_true(reach.least == 0 && reach.most == 0);
    assert_false(irradiation_reach_of(&dvh, &even, true, 1, &reach, &err));
    assert_int_equal(err.code, ERROR_STATE);
    err = (struct error){ 0 };
    assert_false(irradiation_reach_of(&dvh, &hot, true, 1, &reach, &err));
    assert_int_equal(err.code, ERROR_RANGE);
    err = (struct error){ 0 };
    assert_false(irradiation_reach_of(&none, &mean, true, 1, &reach, &err));
    assert_int_equal(err.code, ERROR_NOT_FOUND);
    dvh_finish(&dvh);
}

/* Whatever the univels without a dose have, the output lies between the bounds. */
static void a_part_without_dose_gives_bounds(void **state)
{
    (void)state;
    static const char *const words[] = { "mean", "min", "max", "D95%", "D50%", "D2%", "D0.1cc", "V10", "V10cc" };
    int n_open = 0;
    for (unsigned seed = 1; seed <= 12; seed++) {
        double part = 0.5 * seed / 12;
        struct dvh found = made(seed, part, NAN);
        struct dvh filled[2] = { made(seed, part, 0), made(seed, part, 3 * found.high) };
        for (size_t w = 0; w < sizeof words / sizeof *words; w++) {
            struct dvh_metric metric = metric_of(words[w]);
            double limit = metric.kind == DVH_VOLUME_PERCENT ? 40 : metric.kind == DVH_VOLUME_CC ? 0.4 : 7;
            struct irradiation_reach bounds, exact;
            assert_true(irradiation_reach_of(&found, &metric, true, limit, &bounds, NULL));
            n_open += bounds.least < bounds.most;
            for (int f = 0; f < 2; f++) {
                assert_true(irradiation_reach_of(&filled[f], &metric, true, limit, &exact, NULL));
                assert_true(bounds.least <= exact.least * (1 + 2e-3));
                assert_true(exact.least <= bounds.most * (1 + 2e-3));
            }
        }
        for (int f = 0; f < 2; f++)
            dvh_finish(&filled[f]);
        dvh_finish(&found);
    }
    assert_true(n_open > 50);
}

/* ---- a dose that is not proportional ----------------------------------------------------------------------------- */

/* Univels whose effect is a T + b T^2 after T minutes, without repair, and photons of alpha and beta: the dose D solves
 * alpha D + beta D^2 = a T + b T^2, so both D(T) and T(D) are positive roots of a quadratic. */
static const double alpha = 0.2, beta = 0.02;
static double linear[N], square[N];
static int n_asked;

static double root(double first, double second, double effect)
{
    return (-first + sqrt(first * first + 4 * second * effect)) / (2 * second);
}

static double minutes_to(size_t univel, double dose)
{
    return root(linear[univel], square[univel], alpha * dose + beta * dose * dose);
}

static void make_univels(unsigned seed)
{
    srand(seed);
    for (size_t i = 0; i < N; i++) {
        linear[i] = 0.02 + 0.2 * rand() / RAND_MAX;
        square[i] = 1e-4 + 4e-3 * rand() / RAND_MAX;
    }
}

static double part_missing; /* of the univels */

static bool grown(void *context, double output, struct dvh *dvh, struct error *err)
{
    struct grid grid = made_cube_grid(SIDE);
    struct volume *labels = volume_create(&grid, VOXEL_U8, err), *dose = volume_create(&grid, VOXEL_F32, err);
    (void)context;
    n_asked++;
    memset(labels->voxels, 1, N);
    for (size_t i = 0; i < N; i++)
        ((float *)dose->voxels)[i] = (double)i < part_missing * N
                                         ? NAN
                                         : (float)root(alpha, beta, linear[i] * output + square[i] * output * output);
    volume_measure(dose);
    const struct volume *rows[1] = { dose };
    bool is_good = dvh_sweep(&(struct dvh_sweep){ .labels = labels, .rows = rows, .n_rows = 1 },
                             &(struct dvh_label){ 1, 1 }, 1, dvh, err);
    volume_unref(labels);
    volume_unref(dose);
    return is_good;
}

static int rising(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static struct irradiation_reach reach_growing(const char *word, bool is_at_most, double limit)
{
    struct dvh_metric metric = metric_of(word);
    struct irradiation_reach reach;
    struct error err = { 0 };
    n_asked = 0;
    if (!irradiation_reach_growing(grown, NULL, &metric, is_at_most, limit, &reach, &err))
        fail_msg("%s: %s", word, err.text);
    assert_in_range(n_asked, 1, 40);
    return reach;
}

static void a_growing_dose_reaches_a_limit_at_the_root_of_the_quadratic(void **state)
{
    (void)state;
    const double limits[] = { 0.05, 2, 12.5, 60 };
    part_missing = 0;
    for (unsigned seed = 1; seed <= 4; seed++)
        for (size_t l = 0; l < sizeof limits / sizeof *limits; l++) {
            double minutes[N], mean = 0, limit = limits[l];
            char v[24];
            make_univels(seed);
            for (size_t i = 0; i < N; i++)
                minutes[i] = minutes_to(i, limit);
            qsort(minutes, N, sizeof *minutes, rising);
            /* the hottest univel is the first to have the dose, the coldest the last; 1e-4 of the output, and a float
             */
            assert_near(reach_growing("max", true, limit).least, minutes[0], 1.1e-4 * minutes[0]);
            assert_near(reach_growing("min", false, limit).least, minutes[N - 1], 1.1e-4 * minutes[N - 1]);
            /* 300 of 1000 have it from the 300th on; a bin is 1/2048 of a dose that grows slower than the square */
            const double least = minutes[N * 3 / 10 - 2] * (1 - 1e-3), most = minutes[N * 3 / 10 + 1] * (1 + 1e-3);
            snprintf(v, sizeof v, "V%g", limit);
            const double of_volume = reach_growing(v, true, 30).least,
                         of_dose = reach_growing("D30%", true, limit).least;
            assert_true(least <= of_volume && of_volume <= most);
            assert_near(of_dose, of_volume, 2e-4 * of_volume);
            struct irradiation_reach reach = reach_growing("mean", true, limit);
            assert_true(reach.least == reach.most);
            for (size_t i = 0; i < N; i++)
                mean += root(alpha, beta, linear[i] * reach.least + square[i] * reach.least * reach.least) / N;
            assert_near(mean, limit, 2e-4 * limit);
        }
}

/* Every univel without a dose has it later than all others in the one extreme, and before them in the other. */
static void a_growing_dose_with_a_part_unknown_has_bounds(void **state)
{
    (void)state;
    make_univels(7);
    part_missing = 0;
    const double mean = reach_growing("mean", true, 8).least, median = reach_growing("D50%", true, 8).least;
    part_missing = 0.2;
    struct irradiation_reach reach = reach_growing("mean", true, 8);
    assert_true(reach.least == 0 && mean < reach.most);
    reach = reach_growing("D50%", true, 8);
    assert_true(reach.least < median && median < reach.most);
    assert_true(isinf(reach_growing("min", false, 8).most)); /* perhaps there is none at all */
    part_missing = 0;
}

static void what_a_growing_dose_never_reaches_is_said(void **state)
{
    (void)state;
    struct dvh_metric even = metric_of("HI"), hot = metric_of("D2cc"), mean = metric_of("mean");
    struct irradiation_reach reach;
    struct error err = { 0 };
    make_univels(3);
    assert_true(isinf(reach_growing("V10", true, 100).least));
    assert_true(reach_growing("mean", true, 0).most == 0);
    assert_false(irradiation_reach_growing(grown, NULL, &even, true, 1, &reach, &err));
    assert_int_equal(err.code, ERROR_STATE);
    err = (struct error){ 0 };
    assert_false(irradiation_reach_growing(grown, NULL, &hot, true, 1, &reach, &err));
    assert_int_equal(err.code, ERROR_RANGE);
    part_missing = 1;
    err = (struct error){ 0 };
    assert_false(irradiation_reach_growing(grown, NULL, &mean, true, 1, &reach, &err));
    assert_int_equal(err.code, ERROR_NOT_FOUND);
    part_missing = 0;
    for (size_t i = 0; i < N; i++)
        linear[i] = square[i] = 0;
    assert_true(isinf(reach_growing("mean", true, 8).least));
    for (size_t i = 0; i < N; i++)
        linear[i] = 1e-13; /* 8 Gy after 2.88 / 1e-13 min */
    assert_true(isinf(reach_growing("max", true, 8).least));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(units_of_output_are_read_in_their_spellings),
        cmocka_unit_test(minutes_need_a_rate_in_a_unit_that_fits),
        cmocka_unit_test(at_the_output_the_figure_is_the_limit),
        cmocka_unit_test(limits_that_no_output_reaches_are_never_reached),
        cmocka_unit_test(a_part_without_dose_gives_bounds),
        cmocka_unit_test(a_growing_dose_reaches_a_limit_at_the_root_of_the_quadratic),
        cmocka_unit_test(a_growing_dose_with_a_part_unknown_has_bounds),
        cmocka_unit_test(what_a_growing_dose_never_reaches_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
