/* Dose-volume histograms against closed forms, and against sorted lists of the values themselves. */
#include "core/dose/dvh.h"
#include "core/dose/dvh_kernels.h"
#include "core/dose/dvh_metrics.h"
#include "tests/check.h"

static double uniform(void)
{
    return (double)rand() / RAND_MAX;
}

static struct vec3 rotated(struct vec3 axis, struct vec3 v, double angle)
{
    struct vec3 u = vec3_normalize(axis);
    return vec3_add(vec3_add(vec3_scale(v, cos(angle)), vec3_scale(vec3_cross(u, v), sin(angle))),
                    vec3_scale(u, vec3_dot(u, v) * (1 - cos(angle))));
}

/* Steps of the three index axes, along patient axes order[0..2] (sign: direction), all turned by angle about (1, 2, 3);
 * the grid's middle lies at `middle`. */
static struct grid grid_about(struct vec3 middle, const uint32_t size[3], const double step_mm[3], const int order[3],
                              double angle)
{
    struct affine map = { 0 };
    const struct vec3 unit[3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
    struct grid grid;
    struct error err = { 0 };
    map.origin = middle;
    for (int a = 0; a < 3; a++) {
        map.columns[a] =
            vec3_scale(rotated(vec3(1, 2, 3), unit[abs(order[a]) - 1], angle), order[a] < 0 ? -step_mm[a] : step_mm[a]);
        map.origin = vec3_sub(map.origin, vec3_scale(map.columns[a], (size[a] - 1) / 2.0));
    }
    assert_true(grid_init(&grid, size, &map, &err));
    return grid;
}

static const int straight[3] = { 1, 2, 3 };

/* ---- shapes and doses ------------------------------------------------------------------------------------------- */

struct shape {
    bool is_ball;
    struct vec3 middle;
    double radius_mm; /* or half an edge of a cube along the patient axes */
};

static bool holds(const struct shape *shape, struct vec3 p)
{
    struct vec3 d = vec3_sub(p, shape->middle);
    return shape->is_ball ? vec3_length(d) < shape->radius_mm
                          : fmax(fabs(d.x), fmax(fabs(d.y), fabs(d.z))) < shape->radius_mm;
}

static struct vec3 centre(const struct grid *grid, size_t at)
{
    size_t nx = grid->size[0], ny = grid->size[1];
    return affine_point(&grid->lps_mm_from_ijk,
                        vec3((double)(at % nx), (double)(at / nx % ny), (double)(at / nx / ny)));
}

static struct volume *labels_of(const struct grid *grid, const struct shape *shape)
{
    struct error err = { 0 };
    struct volume *labels = volume_create(grid, VOXEL_U8, &err);
    assert_non_null(labels);
    for (size_t i = 0; i < grid_n_voxels(grid); i++)
        ((uint8_t *)labels->voxels)[i] = holds(shape, centre(grid, i)) ? 3 : 1;
    return labels;
}

enum kind { CONSTANT, LINEAR, GAUSSIAN };
struct field {
    enum kind kind;
    double value, slope, sigma_mm; /* at `middle`; per mm along x */
    struct vec3 middle;
};

static double field_at(const struct field *field, struct vec3 p)
{
    struct vec3 d = vec3_sub(p, field->middle);
    switch (field->kind) {
    case CONSTANT: return field->value;
    case LINEAR: return field->value + field->slope * d.x;
    case GAUSSIAN: return field->value * exp(-vec3_dot(d, d) / (2 * field->sigma_mm * field->sigma_mm));
    }
    return 0;
}

static struct volume *dose_of(const struct grid *grid, const struct field *field)
{
    struct error err = { 0 };
    struct volume *dose = volume_create(grid, VOXEL_F32, &err);
    assert_non_null(dose);
    for (size_t i = 0; i < grid_n_voxels(grid); i++)
        ((float *)dose->voxels)[i] = (float)field_at(field, centre(grid, i));
    return dose;
}

static struct dvh histogram_ways(struct volume *labels, struct volume *dose, int per_side, bool is_general)
{
    const struct volume *rows[1] = { dose };
    struct dvh_sweep sweep = { .labels = labels, .rows = rows, .n_rows = 1, .n_threads = 3, .is_general = is_general };
    struct dvh_label label = { 3, per_side };
    struct dvh dvh;
    struct error err = { 0 };
    if (!dvh_sweep(&sweep, &label, 1, &dvh, &err))
        fail_msg("%s", err.text);
    return dvh;
}

static double figure(const struct dvh *dvh, const char *word)
{
    struct dvh_metric metric;
    struct error err = { 0 };
    if (!dvh_metric_parse(word, &metric, &err))
        fail_msg("%s", err.text);
    return dvh_metric_value(dvh, &metric);
}

/* Labels of 1 mm and a dose of `step_mm` voxels about a shape, both off by a random part of a voxel. */
static struct dvh measure(const struct shape *shape, const struct field *field, double step_mm, double angle)
{
    const double dose_step[3] = { step_mm, step_mm * 0.9, step_mm * 1.2 };
    struct grid fine = grid_about(vec3(uniform(), uniform(), uniform()), (const uint32_t[3]){ 62, 58, 60 },
                                  (const double[3]){ 1, 1, 1 }, straight, 0);
    struct grid coarse = grid_about(vec3(3 * uniform(), 3 * uniform(), 3 * uniform()),
                                    (const uint32_t[3]){ (uint32_t)(110 / step_mm), (uint32_t)(110 / step_mm),
                                                         (uint32_t)(110 / step_mm) },
                                    dose_step, straight, angle);
    struct volume *labels = labels_of(&fine, shape), *dose = dose_of(&coarse, field);
    struct dvh dvh = histogram_ways(labels, dose, 1, false);
    volume_unref(labels);
    volume_unref(dose);
    return dvh;
}

/* ---- closed forms ----------------------------------------------------------------------------------------------- */

static void a_constant_dose_has_one_value_for_every_figure(void **state)
{
    static const char *const words[] = { "mean", "min", "max", "D98%", "D50%", "D2%", "D2cc" };
    (void)state;
    for (int i = 0; i < 4; i++) {
        struct shape shape = { i % 2, vec3(uniform(), uniform(), uniform()), 20 };
        struct field field = { CONSTANT, 3.7e7, 0, 0, shape.middle };
        struct dvh dvh = measure(&shape, &field, 3, i / 2 * 0.4);
        for (size_t w = 0; w < sizeof words / sizeof *words; w++)
            assert_near(figure(&dvh, words[w]), 3.7e7, 1e-7); /* floats */
        assert_close(figure(&dvh, "HI"), 0, 0);
        assert_close(figure(&dvh, "V37000000"), 100, 0);
        assert_close(figure(&dvh, "V37000010"), 0, 0);
        assert_close(dvh.n_missing, 0, 0);
        dvh_finish(&dvh);
    }
}

/* The layer of univels at a face is inside as a whole or not: half a univel at each of two faces. */
static void a_cube_in_a_linear_dose_has_a_straight_histogram(void **state)
{
    (void)state;
    for (int i = 0; i < 6; i++) {
        struct shape shape = { false, vec3(uniform(), uniform(), uniform()), 20.25 };
        struct field field = { LINEAR, 50, 2, 0, shape.middle }; /* 9.5 to 90.5 */
        struct dvh dvh = measure(&shape, &field, 3, i % 2 * 0.4);
        for (int share = 10; share <= 90; share += 20) {
            char word[16];
            snprintf(word, sizeof word, "D%d%%", share);
            assert_close(figure(&dvh, word), 90.5 - 0.81 * share, 2.1); /* a univel: 2 Gy */
            double value = 9.5 + 0.81 * share;
            snprintf(word, sizeof word, "V%g", value);
            assert_close(figure(&dvh, word), 100 - share, 2.6); /* a univel: 2.5 % */
        }
        assert_close(figure(&dvh, "mean"), 50, 1.01);
        assert_close(figure(&dvh, "min"), 10.5, 1.01);
        assert_close(figure(&dvh, "max"), 89.5, 1.01);
        dvh_finish(&dvh);
    }
}

/* V(x): the cap of a ball of radius R beyond the plane at x = c is pi/3 (R - c)^2 (2R + c). */
static void a_ball_in_a_linear_dose_has_caps_as_volumes(void **state)
{
    (void)state;
    const double r = 21.3, whole = 4 * MATH_PI / 3 * r * r * r;
    for (int i = 0; i < 6; i++) {
        struct shape shape = { true, vec3(uniform(), uniform(), uniform()), r };
        struct field field = { LINEAR, 50, 2, 0, shape.middle };
        struct dvh dvh = measure(&shape, &field, 3, i % 2 * 0.4);
        assert_near(dvh.n * dvh.univel_cm3 * 1e3, whole, 0.005);
        for (double c = -18; c <= 18; c += 6) {
            char word[32];
            snprintf(word, sizeof word, "V%.3fcc", 50 + 2 * c);
            /* one univel's shift of the cutting circle, half of it to either side */
            assert_close(figure(&dvh, word) * 1e3, MATH_PI / 3 * (r - c) * (r - c) * (2 * r + c),
                         0.51 * MATH_PI * (r * r - c * c) + 0.005 * whole);
        }
        assert_close(figure(&dvh, "mean"), 50, 0.2); /* the centroid of the univels is off by under 0.1 mm */
        dvh_finish(&dvh);
    }
}

/* Around its peak, V(d) is a ball of radius sigma sqrt(2 ln(peak / d)). Linear interpolation of a Gaussian errs by up
 * to h^2 / (8 sigma^2) of the peak in each direction: 3.6 mm against 16 mm gives 0.6 % and less. */
static void a_ball_in_a_gaussian_dose_has_balls_as_volumes(void **state)
{
    (void)state;
    const double r = 22, sigma = 16;
    for (int i = 0; i < 6; i++) {
        struct shape shape = { true, vec3(uniform(), uniform(), uniform()), r };
        struct field field = { GAUSSIAN, 1, 0, sigma, shape.middle };
        struct dvh dvh = measure(&shape, &field, 3, i % 2 * 0.4);
        for (double share = 0.1; share < 0.95; share += 0.2) {
            char word[32];
            double at = r * cbrt(share), value = exp(-at * at / (2 * sigma * sigma));
            snprintf(word, sizeof word, "D%g%%", 100 * share);
            assert_near(figure(&dvh, word), value, 0.025);
            snprintf(word, sizeof word, "V%.6f", value);
            assert_close(figure(&dvh, word), 100 * share, 2.5);
        }
        assert_near(figure(&dvh, "min"), exp(-r * r / (2 * sigma * sigma)), 0.05);
        dvh_finish(&dvh);
    }
}

/* ---- against the values themselves ------------------------------------------------------------------------------ */

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Random orientations of both grids: every axis order and direction, and oblique; the values of all univels one by
 * one, from volume_sample, sorted. */
static void figures_are_those_of_the_sorted_values_whatever_the_grids(void **state)
{
    static const int orders[6][3] = {
        { 1, 2, 3 }, { -2, 1, 3 }, { 3, -1, -2 }, { 2, 3, 1 }, { -1, -2, -3 }, { 1, 3, 2 }
    };
    static const char *const words[] = { "D98%", "D95%", "D50%", "D20%", "D2%", "D0.5cc", "D0.03cc" };
    (void)state;
    for (int i = 0; i < 24; i++) {
        struct grid fine = grid_about(vec3(uniform(), uniform(), uniform()), (const uint32_t[3]){ 37, 42, 29 },
                                      (const double[3]){ 1.1, 0.9, 1.3 }, straight, i % 4 == 3 ? 0.3 : 0);
        double step = i % 3 == 0 ? 0.7 : 2.9;
        uint32_t n = (uint32_t)(80 / step);
        struct grid other = grid_about(vec3(2 * uniform(), 0, 0), (const uint32_t[3]){ n, n + 3, n + 1 },
                                       (const double[3]){ step, step * 1.1, step * 0.9 }, orders[i % 6],
                                       i % 4 == 3   ? 0.3
                                       : i % 4 == 2 ? 0.1
                                                    : 0);
        struct shape shape = { true, vec3(0, 0, 0), 15 };
        struct field field = { GAUSSIAN, 60 * pow(10, i % 5 * 4 - 8), 0, 12, vec3(4, 1, 2) };
        struct volume *labels = labels_of(&fine, &shape), *dose = dose_of(&other, &field);
        double *values = malloc(grid_n_voxels(&fine) * sizeof *values), sum = 0;
        size_t n_values = 0;
        for (size_t at = 0; at < grid_n_voxels(&fine); at++)
            if (((uint8_t *)labels->voxels)[at] == 3) {
                assert_true(volume_sample(dose, centre(&fine, at), &values[n_values]));
                sum += values[n_values++];
            }
        qsort(values, n_values, sizeof *values, compare_doubles);
        for (int way = 0; way < 2; way++) {
            struct dvh dvh = histogram_ways(labels, dose, 1, way);
            assert_close(dvh.n, (double)n_values, 0);
            assert_near(figure(&dvh, "mean"), sum / (double)n_values, 1e-6);
            assert_near(figure(&dvh, "min"), values[0], 1e-5);
            assert_near(figure(&dvh, "max"), values[n_values - 1], 1e-5);
            for (size_t w = 0; w < sizeof words / sizeof *words; w++) {
                struct dvh_metric metric;
                assert_true(dvh_metric_parse(words[w], &metric, NULL));
                double rank = metric.kind == DVH_DOSE_CC ? metric.amount / dvh.univel_cm3
                                                         : metric.amount / 100 * (double)n_values;
                assert_near(dvh_metric_value(&dvh, &metric), values[n_values - (size_t)ceil(rank - 1e-9)], 1e-3);
            }
            double from = values[n_values / 3];
            assert_close(dvh_univels_from(&dvh, from), (double)(n_values - n_values / 3), 1e-3 * (double)n_values);
            dvh_finish(&dvh);
        }
        free(values);
        volume_unref(labels);
        volume_unref(dose);
    }
}

static void the_loops_for_avx2_give_the_same_bits(void **state)
{
    const struct dvh_kernels *here = dvh_kernels_here();
    (void)state;
    if (here == &dvh_kernels_portable)
        skip();
    enum { N = 77 };
    float row[64], out[2][N + DVH_PADDING];
    int32_t at[N + DVH_PADDING], keys[2][N];
    float between[N + DVH_PADDING];
    for (int i = 0; i < 64; i++)
        row[i] = i % 13 == 5 ? NAN : (float)(exp(20 * uniform() - 10) * (i % 7 ? 1 : -1));
    for (int i = 0; i < N + DVH_PADDING; i++) {
        at[i] = 45 - (i < N ? i : N - 1) * 45 / N;
        between[i] = i % 11 == 3 || i >= N ? NAN : i % 5 == 0 ? 0 : (float)(0.999 * uniform());
    }
    struct dvh_axis axis = { at, between, N, true };
    for (int way = 0; way < 2; way++)
        (way ? here : &dvh_kernels_portable)->resample(row, &axis, 3, N, out[way]);
    for (int i = 3; i < N; i++)
        assert_true(memcmp(&out[0][i], &out[1][i], sizeof(float)) == 0 || (isnan(out[0][i]) && isnan(out[1][i])));
    for (int n = 1; n < N - 3; n++) {
        struct dvh_sums sums[2] = { { .parts = { 1 } }, { .parts = { 1 } } };
        for (int lane = 0; lane < DVH_LANES; lane++)
            sums[0].low[lane] = sums[1].low[lane] = INFINITY;
        for (int way = 0; way < 2; way++) {
            (way ? here : &dvh_kernels_portable)->keys(out[0] + 3, (uint32_t)n, 200000, 60000, keys[way]);
            (way ? here : &dvh_kernels_portable)->measure(out[0] + 3, (uint32_t)n, &sums[way]);
        }
        assert_memory_equal(keys[0], keys[1], (size_t)n * sizeof keys[0][0]);
        assert_memory_equal(&sums[0], &sums[1], sizeof sums[0]);
    }
}

/* ---- missing, tissues, sub-sampling ----------------------------------------------------------------------------- */

static struct volume *simple(const uint32_t size[3], double step_mm, enum voxel_type type)
{
    struct error err = { 0 };
    struct affine map = { { { step_mm, 0, 0 }, { 0, step_mm, 0 }, { 0, 0, step_mm } }, { 0, 0, 0 } };
    struct grid grid;
    assert_true(grid_init(&grid, size, &map, &err));
    struct volume *volume = volume_create(&grid, type, &err);
    assert_non_null(volume);
    return volume;
}

/* 10 x 4 x 4 univels of 2 mm on a dose of 8 x 4 x 4 voxels of 2 mm: columns 8 and 9 lie outside, and a voxel that is
 * no number takes itself only, as all univels lie on voxels. Between voxels it takes those around it. */
static void univels_without_a_dose_are_counted_apart_and_never_as_zero(void **state)
{
    (void)state;
    for (int way = 0; way < 2; way++) {
        struct volume *labels = simple((const uint32_t[3]){ 10, 4, 4 }, 2, VOXEL_U8),
                      *dose = simple((const uint32_t[3]){ 8, 4, 4 }, 2, VOXEL_F32);
        memset(labels->voxels, 3, 160);
        for (int i = 0; i < 128; i++)
            ((float *)dose->voxels)[i] = i == 37 ? NAN : 5;
        struct dvh dvh = histogram_ways(labels, dose, 1, way);
        assert_close(dvh.n, 127, 0);
        assert_close(dvh.n_missing, 33, 0);
        assert_close(dvh.low, 5, 0);
        assert_close(figure(&dvh, "mean"), 5, 0);
        assert_close(figure(&dvh, "V4cc"), 127 * 0.008, 1e-9);
        dvh_finish(&dvh);
        struct dvh_metric max = { DVH_MAX, 0 }, most = { DVH_VOLUME_CC, 4 };
        double low, high;
        dvh = histogram_ways(labels, dose, 1, way);
        dvh_metric_bounds(&dvh, &max, &low, &high);
        assert_close(low, 5, 0);
        assert_true(isinf(high));
        dvh_metric_bounds(&dvh, &most, &low, &high);
        assert_close(low, 127 * 0.008, 1e-9);
        assert_close(high, 160 * 0.008, 1e-9);
        dvh_finish(&dvh);
        volume_unref(labels);
        /* univels of 1 mm: the voxel that is no number is the corner of up to 3^3 points that do not lie on others */
        labels = simple((const uint32_t[3]){ 15, 7, 7 }, 1, VOXEL_U16);
        for (int i = 0; i < 15 * 7 * 7; i++)
            ((uint16_t *)labels->voxels)[i] = 3;
        dvh = histogram_ways(labels, dose, 1, way);
        assert_close(dvh.n_missing, 3 * 2 * 3, 0); /* voxel (5, 0, 1): at j = 0 there is nothing on one side */
        dvh_finish(&dvh);
        volume_unref(labels);
        volume_unref(dose);
    }
}

static void each_univel_has_the_dose_of_its_tissue(void **state)
{
    (void)state;
    struct volume *labels = simple((const uint32_t[3]){ 40, 5, 6 }, 1, VOXEL_U8),
                  *tissue = simple((const uint32_t[3]){ 40, 5, 6 }, 1, VOXEL_U8);
    struct volume *doses[2];
    struct error err = { 0 };
    for (int row = 0; row < 2; row++) {
        doses[row] = simple((const uint32_t[3]){ 21, 4, 4 }, 2, VOXEL_F32);
        for (int i = 0; i < 21 * 4 * 4; i++)
            ((float *)doses[row]->voxels)[i] = (float)(row + 1);
    }
    uint8_t *label = labels->voxels, *row_of = tissue->voxels;
    for (int i = 0; i < 40 * 5 * 6; i++) {
        int x = i % 40;
        label[i] = x < 7 ? 0 : x < 30 ? 3 : 200;
        row_of[i] = x < 10 ? 0 : x < 25 ? 1 : x < 28 ? 255 : 0;
    }
    const struct volume *rows[2] = { doses[0], doses[1] };
    struct dvh_sweep sweep = { .labels = labels, .rows = rows, .n_rows = 2, .row_of = tissue };
    struct dvh_label wanted[2] = { { 200, 1 }, { 3, 1 } };
    struct dvh dvhs[2];
    assert_true(dvh_sweep(&sweep, wanted, 2, dvhs, &err));
    assert_close(dvhs[1].n, (3 + 15 + 2) * 30, 0); /* 7 to 9, 10 to 24, 28 and 29 */
    assert_close(dvhs[1].n_missing, 3 * 30, 0);
    assert_close(dvhs[1].sum, (3 + 2 * 15 + 2) * 30, 1e-9);
    assert_close(dvhs[0].sum, 10 * 30, 1e-9);
    assert_true(dvh_add(&dvhs[0], &dvhs[1], &err));
    assert_close(dvhs[0].n, 30 * 30, 0);
    assert_close(dvh_univels_from(&dvhs[0], 1.5), 15 * 30, 0);
    dvh_finish(&dvhs[0]);
    dvh_finish(&dvhs[1]);
    for (int row = 0; row < 2; row++)
        volume_unref(doses[row]);
    volume_unref(labels);
    volume_unref(tissue);
}

/* One univel of 3 mm in a dose that rises by 1 a mm: its parts lie 1 mm before, at and behind its centre. In a block of
 * 3^3 univels the middle one is no border and counts whole. */
static void univels_at_a_border_can_be_sampled_in_parts(void **state)
{
    (void)state;
    struct volume *labels = simple((const uint32_t[3]){ 9, 9, 9 }, 3, VOXEL_U8),
                  *dose = simple((const uint32_t[3]){ 27, 27, 27 }, 1, VOXEL_F32);
    for (int i = 0; i < 27 * 27 * 27; i++)
        ((float *)dose->voxels)[i] = (float)(i % 27);
    uint8_t *label = labels->voxels;
    label[4 + 9 * (4 + 9 * 4)] = 3;
    struct dvh dvh = histogram_ways(labels, dose, 3, false);
    assert_close(dvh.n, 1, 1e-12);
    assert_close(figure(&dvh, "mean"), 12, 1e-6);
    assert_close(figure(&dvh, "min"), 11, 1e-5);
    assert_close(figure(&dvh, "max"), 13, 1e-5);
    dvh_finish(&dvh);
    for (int i = 0; i < 27; i++)
        label[3 + i % 3 + 9 * (3 + i / 3 % 3 + 9 * (3 + i / 9))] = 3;
    dvh = histogram_ways(labels, dose, 3, false);
    assert_close(dvh.n, 27, 1e-9);
    assert_close(dvh_univels_from(&dvh, 11.5) - dvh_univels_from(&dvh, 12.5), 8 / 3.0 + 1, 0.01);
    assert_close(figure(&dvh, "mean"), 12, 1e-6);
    dvh_finish(&dvh);
    volume_unref(labels);
    volume_unref(dose);
}

static void equal_bins_hold_every_univel(void **state)
{
    (void)state;
    struct shape shape = { true, vec3(0, 0, 0), 20 };
    struct field field = { LINEAR, 50, 2, 0, vec3(0, 0, 0) };
    struct dvh dvh = measure(&shape, &field, 3, 0);
    double counts[200], sum = 0, cumulative = dvh.n;
    dvh_counts(&dvh, 0, dvh.high / 200, 200, counts);
    for (int i = 0; i < 200; i++) {
        assert_close(dvh_univels_from(&dvh, dvh.high / 200 * i), cumulative, 1e-6 * dvh.n);
        cumulative -= counts[i];
        sum += counts[i];
    }
    assert_near(sum, dvh.n, 1e-9);
    dvh_finish(&dvh);
    field = (struct field){ CONSTANT, 7, 0, 0, vec3(0, 0, 0) };
    dvh = measure(&shape, &field, 3, 0);
    dvh_counts(&dvh, 0, 7.0 / 100, 100, counts);
    assert_close(counts[99], dvh.n, 0);
    dvh_finish(&dvh);
}

/* ---- words, definitions ----------------------------------------------------------------------------------------- */

static void words_of_figures_are_read_or_refused(void **state)
{
    static const struct {
        const char *word;
        enum dvh_metric_kind kind;
        double amount;
    } good[] = { { "mean", DVH_MEAN, 0 },
                 { "Max", DVH_MAX, 0 },
                 { " min ", DVH_MIN, 0 },
                 { "D95%", DVH_DOSE_PERCENT, 95 },
                 { "d 0.03 cc", DVH_DOSE_CC, 0.03 },
                 { "D2cm3", DVH_DOSE_CC, 2 },
                 { "V20", DVH_VOLUME_PERCENT, 20 },
                 { "V 7.5 cc", DVH_VOLUME_CC, 7.5 },
                 { "HI", DVH_HOMOGENEITY, 0 } };
    static const char *const bad[] = { "",         "D",      "D95",    "V",
                                       "V20%",     "D-5%",   "D1e2%",  "D.cc",
                                       "D1.2.3cc", "D101%",  "median", "D95%%",
                                       "V0x10",    "Dinfcc", "hi2",    "D11111111111111111111111111111111111111111cc" };
    (void)state;
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        struct dvh_metric metric;
        assert_true(dvh_metric_parse(good[i].word, &metric, NULL));
        assert_int_equal(metric.kind, good[i].kind);
        assert_close(metric.amount, good[i].amount, 0);
    }
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct dvh_metric metric;
        struct error err = { 0 };
        if (dvh_metric_parse(bad[i], &metric, &err))
            fail_msg("%s is read", bad[i]);
        assert_true(err.text[0] != 0);
    }
}

/* Target of 10 cm3, isodose of 20, 8 in common: 64 / 200, and 2. */
static void conformity_is_as_paddick_and_rtog_define_it(void **state)
{
    (void)state;
    struct dvh_conformity found = dvh_conformity(10, 20, 8);
    assert_close(found.paddick, 0.32, 1e-12);
    assert_close(found.rtog, 2, 1e-12);
    assert_true(isnan(dvh_conformity(0, 20, 0).rtog));
    assert_true(isnan(dvh_conformity(10, 0, 0).paddick));
    assert_close(dvh_conformity(10, 0, 0).rtog, 0, 0);
}

static void what_is_no_dose_is_refused(void **state)
{
    (void)state;
    struct volume *labels = simple((const uint32_t[3]){ 4, 4, 4 }, 1, VOXEL_U8),
                  *dose = simple((const uint32_t[3]){ 4, 4, 4 }, 1, VOXEL_F32),
                  *other = simple((const uint32_t[3]){ 5, 4, 4 }, 1, VOXEL_F32);
    const struct volume *rows[2] = { dose, other };
    struct dvh_label label = { 1, 1 };
    struct dvh dvh;
    struct error err = { 0 };
    assert_false(dvh_sweep(&(struct dvh_sweep){ .labels = labels, .rows = rows, .n_rows = 2 }, &label, 1, &dvh, &err));
    assert_false(dvh_sweep(&(struct dvh_sweep){ .labels = labels, .rows = rows, .n_rows = 0 }, &label, 1, &dvh, &err));
    assert_false(dvh_sweep(&(struct dvh_sweep){ .labels = dose, .rows = rows, .n_rows = 1 }, &label, 1, &dvh, &err));
    label.per_side = 6;
    assert_false(dvh_sweep(&(struct dvh_sweep){ .labels = labels, .rows = rows, .n_rows = 1 }, &label, 1, &dvh, &err));
    assert_int_equal(err.code, ERROR_RANGE);
    volume_unref(labels);
    volume_unref(dose);
    volume_unref(other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_constant_dose_has_one_value_for_every_figure),
        cmocka_unit_test(a_cube_in_a_linear_dose_has_a_straight_histogram),
        cmocka_unit_test(a_ball_in_a_linear_dose_has_caps_as_volumes),
        cmocka_unit_test(a_ball_in_a_gaussian_dose_has_balls_as_volumes),
        cmocka_unit_test(figures_are_those_of_the_sorted_values_whatever_the_grids),
        cmocka_unit_test(the_loops_for_avx2_give_the_same_bits),
        cmocka_unit_test(univels_without_a_dose_are_counted_apart_and_never_as_zero),
        cmocka_unit_test(each_univel_has_the_dose_of_its_tissue),
        cmocka_unit_test(univels_at_a_border_can_be_sampled_in_parts),
        cmocka_unit_test(equal_bins_hold_every_univel),
        cmocka_unit_test(words_of_figures_are_read_or_refused),
        cmocka_unit_test(conformity_is_as_paddick_and_rtog_define_it),
        cmocka_unit_test(what_is_no_dose_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
