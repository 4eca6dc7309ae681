/* SERA's dose files: texts laid out by hand in the columns of seraMC, and its own sample with the figures published
 * beside it. */
#include "core/formats/sera/sera_rst.h"
#include "core/load/load.h"
#include "core/load/summary.h"
#include "core/plan/plan.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/plan_help.h"

struct text {
    char *at;
    size_t n;
};

enum { TEXT_SIZE = 1 << 16 };

static struct text make_header(const char *histories, const char *mesh)
{
    struct text text = { malloc(TEXT_SIZE), 0 };
    text.n = (size_t)
        snprintf(text.at, TEXT_SIZE,
                 "   1seraMC_1C0  \nnone\nA plan\ncg.geom\nhead.uv\nx.mat\nx.sigma\nrun\n%s\n      32      72      94\n"
                 "N     20_NOV_2026       1.000000E+00   1.000000E+00   3.600000E+06\n%s\nx.source\n 1\n"
                 "   0.000000E+00\nhead.rst\n       5\n   1.0\n   0.0\n",
                 mesh, histories);
    return text;
}

/* 2^3 cells of 2 cm with corner (PA, RL, IS) = (-10, -20, -30) cm. Each value of the array is its cell's number in the
 * file, z fastest, with a share of .001 times its column. */
#define MESH "  -1.000000E+01  -2.000000E+01  -3.000000E+01   2.000000E+00       2       3"
#define HISTORIES "10000000       0       0   2.500000E-01"
static struct text make(size_t n_columns, const char *special, size_t special_at)
{
    struct text text = make_header(HISTORIES, MESH);
    size_t n = 8 * n_columns;
    for (size_t i = 0; i < n; i++) {
        char word[32];
        snprintf(word, sizeof word, "%15.6E", (double)(i / n_columns) + 0.001 * (double)(i % n_columns));
        if (special && i == special_at)
            snprintf(word, sizeof word, "%15s", special);
        text.n +=
            (size_t)snprintf(text.at + text.n, TEXT_SIZE - text.n, "%s%s", word, i % 6 == 5 || i + 1 == n ? "\n" : "");
    }
    return text;
}

static bool read_text(const struct text *text, struct sera_doses *doses, struct report *report, struct error *err)
{
    struct bytes bytes = { (uint8_t *)text->at, text->n };
    *err = (struct error){ 0 };
    return rst_read(&bytes, "a.rst", doses, report, err);
}

/* In the order the header promises. */
static const struct volume *nth(const struct sera_doses *doses, size_t n)
{
    assert_int_equal(doses->n_components, RST_N_DOSES);
    return doses->components[n].values;
}

static void columns_axes_and_scale_are_those_of_the_program(void **state)
{
    (void)state;
    for (size_t n_columns = 12; n_columns <= 14; n_columns += 2) {
        struct text text = make(n_columns, NULL, 0);
        struct sera_doses doses;
        struct report report = { 0 };
        struct error err;
        assert_true(read_text(&text, &doses, &report, &err));
        assert_int_equal(report.n_lines, 0);
        /* Calculated by hand: neutron 3.6e6 0.75 / 8 = 337500; gammas made: sum of column 5 is 28 + 8 * 0.004 = 28.032;
         * photon 3.6e6 * (0.75 * 28.032 + 0.25) / 3600 / 8 = 2659.25. Cell 6 of the file is x 1, y 1, z 0. */
        static const double column[RST_N_DOSES] = { 0.003, 0.005, 0.001, 0, 0.011, 0.006, 0.007, 0.008 };
        for (size_t d = 0; d < RST_N_DOSES; d++) {
            double factor = d == 3 ? 2659.25 : 337500;
            for (uint32_t cell = 0; cell < 8; cell++) {
                uint32_t x = cell / 4, y = cell / 2 % 2, z = cell % 2;
                assert_near(volume_value(nth(&doses, d), y, x, z), factor * (cell + column[d]), 1e-6);
            }
        }
        /* centre of the first cell: (PA, RL, IS) = (-9, -19, -29) cm, so L = -190, P = 90, S = -290 mm; RL along i, PA
         * along j */
        struct vec3 first = affine_point(&nth(&doses, 0)->grid.lps_mm_from_ijk, vec3(0, 0, 0));
        struct vec3 last = affine_point(&nth(&doses, 0)->grid.lps_mm_from_ijk, vec3(1, 1, 1));
        assert_close(first.x, -190, 1e-9);
        assert_close(first.y, 90, 1e-9);
        assert_close(first.z, -290, 1e-9);
        assert_close(last.x, -170, 1e-9);
        assert_close(last.y, 70, 1e-9);
        assert_close(last.z, -270, 1e-9);
        sera_doses_finish(&doses);
        free(text.at);
    }
}

static void fortran_s_numbers_are_read_and_what_is_none_is_counted(void **state)
{
    (void)state;
    /* column 4 (boron) of the first cell */
    static const struct {
        const char *word;
        double value;
    } good[] = { { ".5E+00", 0.5 }, { "1.25D-01", 0.125 }, { "1.500000-101", 0 }, { "-.25", -0.25 }, { "3", 3 } };
    struct sera_doses doses;
    struct report report = { 0 };
    struct error err;
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
        struct text text = make(14, good[i].word, 3);
        assert_true(read_text(&text, &doses, &report, &err));
        assert_close(volume_value(nth(&doses, 0), 0, 0, 0), good[i].value * 337500, 0.01);
        assert_int_equal(report.n_lines, 0);
        sera_doses_finish(&doses);
        free(text.at);
    }
    static const char *const bad[] = { "***************", "NaN", "abc", "1E99" };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        struct text text = make(14, bad[i], 3);
        assert_true(read_text(&text, &doses, &report, &err));
        assert_true(isnan(volume_value(nth(&doses, 0), 0, 0, 0)));
        assert_near(volume_value(nth(&doses, 0), 0, 0, 1), 337500 * 1.003, 1e-6);
        assert_int_equal(report.n_lines, 1);
        assert_string_equal(report.lines[0].code, "dose.bad-values");
        assert_non_null(strstr(report.lines[0].sentence, i == 0 ? "1 values too large" : "and 1 that are no numbers"));
        assert_non_null(strstr(report.lines[0].sentence, "first in line 20"));
        report_finish(&report);
        sera_doses_finish(&doses);
        free(text.at);
    }
}

static void history_counts_that_touch_are_told_apart_by_their_columns(void **state)
{
    (void)state;
    struct text text = make_header("       010000000       0   2.500000E-01", MESH);
    struct rst_header header;
    struct error err = { 0 };
    assert_true(rst_parse_header((const uint8_t *)text.at, text.n, "a.rst", &header, &err));
    assert_string_equal(header.version, "seraMC_1C0");
    assert_string_equal(header.title, "A plan");
    assert_int_equal(header.n_sets, 1);
    assert_int_equal(header.sets[0].directive, 'N');
    assert_int_equal(header.sets[0].n_histories[0], 0);
    assert_int_equal(header.sets[0].n_histories[1], 10000000);
    assert_int_equal(header.sets[0].n_histories[2], 0);
    assert_close(header.sets[0].gamma_fraction, 0.25, 0);
    free(text.at);
    text = make_header("       0 10010744       0   2.500000E-01", MESH); /* parted by hand: a column too far */
    assert_true(rst_parse_header((const uint8_t *)text.at, text.n, "a.rst", &header, &err));
    assert_int_equal(header.sets[0].n_histories[1], 10010744);
    assert_close(header.sets[0].gamma_fraction, 0.25, 0);
    free(text.at);
}

static void expect_refusal(struct text text, enum error_code code, const char *words)
{
    struct sera_doses doses;
    struct error err;
    if (read_text(&text, &doses, NULL, &err) || err.code != code || !strstr(err.text, words) ||
        !strstr(err.text, "a.rst"))
        fail_msg("%s: \"%s\"", words, err.text);
    assert_int_equal(doses.n_components, 0);
    free(text.at);
}

static struct text cut(struct text text, size_t n)
{
    text.n = n;
    return text;
}

static struct text copy_of(const char *words)
{
    struct text text = { malloc(TEXT_SIZE), strlen(words) };
    memcpy(text.at, words, text.n);
    return text;
}

static void a_file_that_is_wrong_is_refused_with_its_line(void **state)
{
    (void)state;
    expect_refusal(copy_of(""), ERROR_FORMAT, "ends after line 0");
    expect_refusal(copy_of("rstfile 20030630\n"), ERROR_FORMAT, "line 1, column 1: found \"rstf\"");
    expect_refusal(copy_of("   3\n"), ERROR_FORMAT, "line 1, column 5: found \"\", expected the version");
    expect_refusal(copy_of("   3seraMC_1C0\nnone\n"), ERROR_FORMAT, "ends after line 2");
#define CELLS(n, groups) "  -1.000000E+01  -2.000000E+01  -3.000000E+01   2.000000E+00" n groups
    expect_refusal(make_header(HISTORIES, CELLS("     129", "       3")), ERROR_FORMAT,
                   "line 9, column 61: found \"129\"");
    expect_refusal(make_header(HISTORIES, CELLS("       0", "       3")), ERROR_FORMAT,
                   "cells along an edge, 1 to 128");
    expect_refusal(make_header(HISTORIES, CELLS("       2", "99999999")), ERROR_FORMAT, "line 9, column 69");
    expect_refusal(make_header(HISTORIES,
                               "            NaN  -2.000000E+01  -3.000000E+01   2.000000E+00       2       3"),
                   ERROR_FORMAT, "line 9, column 1: found \"NaN\"");
    expect_refusal(make_header(HISTORIES,
                               "  -1.000000E+01  -2.000000E+01  -3.000000E+01   0.000000E+00       2       3"),
                   ERROR_FORMAT, "the width of a cell");
    expect_refusal(make_header("10000000       x       0   2.500000E-01", MESH), ERROR_FORMAT,
                   "line 12, column 16: found \"x\"");
    expect_refusal(make_header("10000000       0       0   2.500000E+01", MESH), ERROR_FORMAT, "line 12, column 28");
    expect_refusal(make_header(HISTORIES, MESH), ERROR_FORMAT, "0 values after line 19; 2^3 cells need 112, or 96");
    struct text whole = make(14, NULL, 0);
    expect_refusal(cut(whole, whole.n - 16), ERROR_FORMAT, "111 values after line 19");
    whole = make(14, NULL, 0);
    whole.at[whole.n - 90] = ' ';
    for (size_t i = 0; i < whole.n; i++) /* one endless line */
        if (i > 700 && whole.at[i] == '\n')
            whole.at[i] = ' ';
    expect_refusal(whole, ERROR_FORMAT, "expected at most 6 numbers of 15");
}

static void every_cut_and_every_changed_byte_is_survived(void **state)
{
    (void)state;
    struct text whole = make(12, NULL, 0);
    struct sera_doses doses;
    struct error err;
    for (size_t n = 0; n < whole.n - 15; n++) {
        struct text part = { malloc(n + 1), n }; /* of exactly that size, for the address sanitizer */
        memcpy(part.at, whole.at, n);
        assert_false(read_text(&part, &doses, NULL, &err));
        free(part.at);
    }
    for (size_t i = 0; i < whole.n; i++)
        for (int bit = 0; bit < 8; bit += 3) {
            whole.at[i] = (char)(whole.at[i] ^ 1 << bit);
            if (read_text(&whole, &doses, NULL, &err))
                sera_doses_finish(&doses);
            whole.at[i] = (char)(whole.at[i] ^ 1 << bit);
        }
    free(whole.at);
}

static void a_plan_may_ask_for_all_of_it_or_for_one_quantity(void **state)
{
    (void)state;
    char folder[256];
    struct error err = { 0 };
    folder_make(folder);
    struct text text = make(14, NULL, 0);
    folder_put(folder, "a.rst", text.at, text.n);
    static const char all[] =
        "{\"format\":\"beamroom-plan\",\"version\":1,\"doses\":[{\"path\":\"a.rst\",\"unit\":\"Gy\"},{\"per\":\"250 kW-min\","
        "\"components\":[{\"path\":\"a.rst\",\"quantity\":\"gamma\"},{\"path\":\"a.rst\",\"quantity\":\"boron\"}]}]}";
    folder_put(folder, "plan.json", all, sizeof all - 1);
    struct plan *plan = plan_load(folder, "p", NULL, &err);
    assert_string_equal(err.text, "");
    assert_int_equal(plan->n_doses, 2);
    assert_int_equal(plan->doses[0].n_components, RST_N_DOSES);
    assert_string_equal(plan->doses[0].unit, "cGy");
    assert_string_equal(plan->doses[0].per, "unit of the source");
    assert_non_null(strstr(report_said(&plan->report, "dose.unit-differs"), "is in Gy; a file of SERA is in cGy"));
    assert_non_null(strstr(report_said(&plan->report, "dose.no-per"), "one unit of the source"));
    assert_int_equal(plan->doses[1].n_components, 2);
    assert_string_equal(plan->doses[1].per, "250 kW-min");
    assert_int_equal(plan->doses[1].components[0].quantity, DOSE_GAMMA);
    assert_false(plan->doses[1].components[0].is_per_ppm);
    assert_int_equal(plan->doses[1].components[1].quantity, DOSE_BORON);
    assert_true(plan->doses[1].components[1].is_per_ppm);
    plan_destroy(plan);
    struct plan_summary summary;
    plan_summarize(folder, &summary);
    assert_string_equal(summary.parts[0], "10 dose components");
    folder_remove(folder);
    free(text.at);
}

static void sera_s_own_dose_has_the_figures_published_with_it(void **state)
{
    (void)state;
    struct plan *plan = plan_of_data("sera-head");
    if (!plan)
        skip();
    assert_int_equal(plan->n_doses, 2);
    const struct dose *dose = &plan->doses[0];
    assert_int_equal(dose->n_components, RST_N_DOSES);
    assert_string_equal(dose->unit, "cGy");
    assert_string_equal(dose->per, "unit of the source");
    /* "Tri-linear at the reference point" (PA, RL, IS) (-4.5, 4.5, -4.5) cm, in the notes beside the data: four digits
     */
    static const struct {
        enum dose_quantity quantity;
        bool is_per_ppm;
        double value;
    } expected[] = { { DOSE_BORON, true, 2.876 },
                     { DOSE_NITROGEN, false, 5.881 },
                     { DOSE_FAST, false, 1.794 },
                     { DOSE_GAMMA, false, 28.19 } };
    struct plan_probe probe;
    plan_probe(plan, vec3(45, 45, -45), &probe);
    assert_true(probe.n_doses >= RST_N_DOSES);
    for (size_t i = 0; i < 4; i++) {
        assert_int_equal(dose->components[i].quantity, expected[i].quantity);
        assert_int_equal(dose->components[i].is_per_ppm, expected[i].is_per_ppm);
        assert_near(probe.doses[i].value, expected[i].value, 5e-4);
    }
    assert_near(probe.doses[7].value, 4.010e11, 5e-4);
    /* along the beam line the thermal fluence peaks at 4.25e11 (the notes); fast neutrons are most outside the head */
    assert_near(dose->body_high[DOSE_THERMAL_FLUENCE], 4.25e11, 0.05);
    assert_true(dose->body_high[DOSE_FAST] < 0.8 * dose->components[2].values->high);
    /* Values that seraPlan prints for that point (head1-seraplan.edit); it interpolates otherwise, 0.5 to 4 % away. */
    static const struct {
        enum dose_quantity quantity;
        double value;
        const char *unit;
    } printed[] = { { DOSE_OTHER, 0.137468, "cGy" },
                    { DOSE_FAST_FLUENCE, 2.15767e9, "1/cm2" },
                    { DOSE_EPITHERMAL_FLUENCE, 1.71113e11, "1/cm2" },
                    { DOSE_THERMAL_FLUENCE, 4.08357e11, "1/cm2" } };
    for (size_t i = 0; i < 4; i++) {
        char unit[DOSE_UNIT_SIZE];
        assert_int_equal(dose->components[4 + i].quantity, printed[i].quantity);
        assert_near(probe.doses[4 + i].value, printed[i].value, 0.04);
        dose_unit_of(dose, printed[i].quantity, unit);
        assert_string_equal(unit, printed[i].unit);
    }
    plan_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(columns_axes_and_scale_are_those_of_the_program),
        cmocka_unit_test(fortran_s_numbers_are_read_and_what_is_none_is_counted),
        cmocka_unit_test(history_counts_that_touch_are_told_apart_by_their_columns),
        cmocka_unit_test(a_file_that_is_wrong_is_refused_with_its_line),
        cmocka_unit_test(every_cut_and_every_changed_byte_is_survived),
        cmocka_unit_test(a_plan_may_ask_for_all_of_it_or_for_one_quantity),
        cmocka_unit_test(sera_s_own_dose_has_the_figures_published_with_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
