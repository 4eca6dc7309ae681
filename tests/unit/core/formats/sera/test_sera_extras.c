/* Companions of a plan of SERA's: tables of doses over depth and radius, and preferences. Published tables are those of
 * the SERA package; their figures are quoted from it and from notes made when the original programs ran. */
#include "core/formats/sera/sera_rsc.h"
#include "core/formats/sera/sera_table.h"
#include "core/load/load.h"
#include "core/plan/plan.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/plan_help.h"

enum { TEXT_SIZE = 1 << 15 };

/* ---- tables ----------------------------------------------------------------------------------------------------- */

/* Three depths and radii: -1, 0 and 1.5 cm; 0, 1 and 2 cm. Total is depth number * 10 + radius number + 1; the other
 * columns are a hundredth of it more each; the last radius of the first depth holds zeros. */
static size_t make_table(char text[TEXT_SIZE], const char *special)
{
    static const double depths[] = { -1, 0, 1.5 };
    size_t n = (size_t)snprintf(
        text, TEXT_SIZE,
        " Center Point   -3.84000E+00    2.49000E+00    .649000E+01\n"
        " no. d,r points used         3 no. azimuthal angles used for average dose at d,r         50\n"
        "   depth    radius      dist   reg   total    B-10      gamma      N-14      fast      Gp 1      Gp 2     thermal\n"
        "   (cm)     (cm)       (cm)          dose     dose      dose       dose      dose     fluence   fluence   fluence\n\n");
    for (int d = 0; d < 3; d++)
        for (int r = 0; r < 3; r++) {
            n += (size_t)snprintf(text + n, TEXT_SIZE - n, "%10.3E%10.3E%10.3E   0", depths[d], (double)r, 0.0);
            for (int c = 0; c < 8; c++) {
                char word[32];
                snprintf(word, sizeof word, "%10.3E", d == 0 && r == 2 ? 0.0 : d * 10 + r + 1 + 0.01 * c);
                if (special && d == 1 && r == 0 && c == 1)
                    snprintf(word, sizeof word, "%10s", special);
                n += (size_t)snprintf(text + n, TEXT_SIZE - n, "%s", word);
            }
            n += (size_t)snprintf(text + n, TEXT_SIZE - n, "\n");
        }
    return n + (size_t)snprintf(text + n, TEXT_SIZE - n, "\n Notes:\nThis is not a point\n");
}

static bool read_table(const char *text, size_t n, struct dose_curve *curve, struct report *report, struct error *err)
{
    *err = (struct error){ 0 };
    return sera_table_parse((const uint8_t *)text, n, "a.dose", curve, report, err);
}

static void a_table_has_its_depths_radii_and_columns(void **state)
{
    (void)state;
    char text[TEXT_SIZE];
    struct dose_curve curve;
    struct report report = { 0 };
    struct error err;
    size_t n = make_table(text, ".5E+00");
    assert_true(read_table(text, n, &curve, &report, &err));
    assert_int_equal(curve.n_depths, 3);
    assert_int_equal(curve.n_columns, 8);
    assert_close(curve.depths_mm[0], -10, 1e-9);
    assert_close(curve.depths_mm[2], 15, 1e-9);
    assert_close(curve.radii_mm[2], 20, 1e-9);
    /* (PA, RL, IS) (-3.84, 2.49, 6.49) cm */
    assert_close(curve.center_lps_mm.x, 24.9, 1e-9);
    assert_close(curve.center_lps_mm.y, 38.4, 1e-9);
    assert_close(curve.center_lps_mm.z, 64.9, 1e-9);
    static const enum dose_quantity order[] = { DOSE_TOTAL,
                                                DOSE_BORON,
                                                DOSE_GAMMA,
                                                DOSE_NITROGEN,
                                                DOSE_FAST,
                                                DOSE_FAST_FLUENCE,
                                                DOSE_EPITHERMAL_FLUENCE,
                                                DOSE_THERMAL_FLUENCE };
    for (size_t c = 0; c < 8; c++) {
        assert_int_equal(curve.quantities[c], order[c]);
        assert_int_equal(curve.is_per_ppm[c], order[c] == DOSE_BORON);
    }
    double value, depth;
    assert_true(dose_curve_value(&curve, 0, 15, 10, &value));
    assert_close(value, 22, 1e-5);
    assert_true(dose_curve_value(&curve, 2, 7.5, 5, &value)); /* halfway each way: (11 + 12 + 21 + 22) / 4 + 0.02 */
    assert_close(value, 16.52, 1e-2);
    assert_true(dose_curve_value(&curve, 1, 0, 0, &value));
    assert_close(value, 0.5, 1e-6);
    assert_false(dose_curve_value(&curve, 0, -10, 20, &value)); /* zeros alone: outside the run's mesh */
    assert_false(dose_curve_value(&curve, 0, -5, 15, &value));
    assert_false(dose_curve_value(&curve, 0, 15.1, 0, &value));
    assert_false(dose_curve_value(&curve, 0, 0, -1, &value));
    assert_false(dose_curve_value(&curve, 0, NAN, 0, &value));
    assert_true(dose_curve_peak(&curve, 0, &depth, &value));
    assert_close(depth, 15, 1e-9);
    assert_close(value, 21, 1e-5);
    assert_non_null(strstr(report_said(&report, "dose.outside-mesh"), "1 of 9 points"));
    dose_curve_finish(&curve);
    report_finish(&report);
    n = make_table(text, "**********");
    assert_true(read_table(text, n, &curve, &report, &err));
    assert_false(dose_curve_value(&curve, 1, 0, 0, &value));
    assert_non_null(strstr(report_said(&report, "dose.bad-values"), "1 values too large"));
    assert_non_null(strstr(report_said(&report, "dose.bad-values"), "line 9"));
    dose_curve_finish(&curve);
    report_finish(&report);
}

static void a_table_that_is_wrong_is_refused_with_its_line(void **state)
{
    (void)state;
    static const struct {
        const char *find, *instead, *words;
    } wrong[] = { { "Center", "Centre", "line 1: found \"Centre Point" },
                  { "used         3", "used      1001", "line 2: 1001 points, expected a whole number from 2 to 1000" },
                  { "used         3", "used     65535", "line 2: 65535 points" },
                  { "used         3", "used       NaN", "line 2: found" },
                  { "used         3", "used         4", "line 9: depth 0 and radius 0 cm, expected -1 and" },
                  { "used         3", "used       900", "bytes are too few for 900 x 900 points" },
                  { " 1.500E+00 1.000E+00", " 1.500E+00 3.000E+00", "radius 3 cm, expected 1.5 and 1" },
                  { " 1.500E+00 0.000E+00", "-1.500E+00 0.000E+00", "do not rise" } };
    char text[TEXT_SIZE];
    struct dose_curve curve;
    struct error err;
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        size_t n = make_table(text, NULL);
        char *at = strstr(text, wrong[i].find);
        assert_non_null(at);
        memcpy(at, wrong[i].instead, strlen(wrong[i].instead));
        if (read_table(text, n, &curve, NULL, &err) || !strstr(err.text, wrong[i].words) || !strstr(err.text, "a.dose"))
            fail_msg("%s: \"%s\"", wrong[i].words, err.text);
        assert_null(curve.depths_mm);
    }
}

static void every_cut_and_changed_byte_of_a_table_is_survived(void **state)
{
    (void)state;
    char text[TEXT_SIZE];
    struct dose_curve curve;
    struct error err;
    size_t n = make_table(text, NULL);
    for (size_t cut = 0; cut < n; cut++) {
        char *part = malloc(cut + 1); /* of exactly that size, for the address sanitizer */
        memcpy(part, text, cut);
        if (read_table(part, cut, &curve, NULL, &err))
            dose_curve_finish(&curve);
        else
            assert_true(err.text[0] != 0);
        free(part);
    }
    for (size_t i = 0; i < n; i++)
        for (int bit = 0; bit < 8; bit++) {
            text[i] = (char)(text[i] ^ 1 << bit);
            if (read_table(text, n, &curve, NULL, &err))
                dose_curve_finish(&curve);
            text[i] = (char)(text[i] ^ 1 << bit);
        }
}

static const struct dose_curve *curve_of(const struct plan *plan, const char *id)
{
    for (size_t i = 0; i < plan->n_curves; i++)
        if (strcmp(plan->curves[i].id, id) == 0)
            return &plan->curves[i];
    fail_msg("no curve %s", id);
    return NULL;
}

static void published_tables_have_their_published_figures(void **state)
{
    (void)state;
    char folder[256];
    struct error err = { 0 };
    if (!data_path("sera-st/beam/BPTB_B_8cm.dose.gz", folder, sizeof folder))
        skip();
    folder_make(folder);
    folder_put_data(folder, "BPTB_B_8cm.dose.gz", "sera-st/beam/BPTB_B_8cm.dose.gz");
    folder_put_data(folder, "LTright.dose.gz", "sera-st/beam/LTright.dose.gz");
    folder_put_data(folder, "head1.dose", "sera-head/generated/head1.dose");
    folder_put_data(folder, "ST.uv.gz", "sera-st/ST.uv.gz");
    folder_put_data(folder, "ST.uvh", "sera-st/ST.uvh");
    struct plan *plan = plan_load(folder, "p", NULL, &err);
    assert_string_equal(err.text, "");
    assert_int_equal(plan->n_curves, 3);
    const struct dose_curve *bmrr = curve_of(plan, "bptb-b-8cm"), *left = curve_of(plan, "ltright"),
                            *head = curve_of(plan, "head1");
    assert_string_equal(bmrr->name, "BPTB_B_8cm");
    assert_string_equal(bmrr->unit, "cGy");
    /* depth; total, boron, gamma, nitrogen, fast; fluences: the table of the 8 cm beam, on its axis */
    static const double anchor[][9] = { { 0, 3.439, .0980, 1.935, .168, 1.238, 1.91e9, 3.58e10, 1.31e10 },
                                        { 10, 4.418, .255, 2.839, .433, .891, 1.10e9, 2.89e10, 3.53e10 },
                                        { 20, 4.765, .302, 3.366, .510, .586, 5.88e8, 1.62e10, 4.14e10 },
                                        { 30, 4.731, .287, 3.541, .486, .417, 3.56e8, 8.51e9, 3.90e10 },
                                        { 50, 3.471, .167, 2.818, .282, .204, 1.48e8, 1.99e9, 2.26e10 },
                                        { 80, 1.686, .0505, 1.471, .0854, .0791, 0, 0, 6.77e9 },
                                        { 100, 1.037, .0204, .939, .0345, .0431, 0, 0, 2.74e9 } };
    for (size_t i = 0; i < sizeof anchor / sizeof anchor[0]; i++)
        for (size_t c = 0; c < 8; c++) {
            double value;
            assert_true(dose_curve_value(bmrr, c, anchor[i][0], 0, &value));
            if (anchor[i][c + 1] > 0)
                assert_near(value, anchor[i][c + 1], 5e-3); /* three digits are quoted */
        }
    for (size_t d = 0; d < bmrr->n_depths; d++) { /* components sum to the total */
        double total, part, sum = 0;
        if (!dose_curve_value(bmrr, 0, bmrr->depths_mm[d], 0, &total))
            continue;
        for (size_t c = 1; c < 5; c++) {
            assert_true(dose_curve_value(bmrr, c, bmrr->depths_mm[d], 0, &part));
            sum += part;
        }
        assert_near(sum, total, 2e-3);
    }
    double depth, value, tenth;
    assert_true(dose_curve_peak(left, 7, &depth, &value));
    assert_near(value, 3.95e10, 2e-3);
    assert_close(depth, 20, 1e-9);
    assert_true(dose_curve_peak(head, 7, &depth, &value)); /* 4.25e11 at 2.0 cm, total at 2.5 cm, a tenth at 9.8 cm */
    assert_near(value, 4.25e11, 2e-3);
    assert_close(depth, 20, 1e-9);
    assert_true(dose_curve_value(head, 7, 98, 0, &tenth));
    assert_near(tenth, value / 10, 0.02);
    assert_true(dose_curve_peak(head, 0, &depth, &value));
    assert_close(depth, 25, 1e-9);
    assert_close(head->center_lps_mm.x, 24.9, 1e-9); /* the target */
    plan_destroy(plan);
    folder_remove(folder);
}

/* ---- preferences ------------------------------------------------------------------------------------------------ */

static bool read_rsc(const char *text, const char *name, struct rsc *rsc, struct report *report, struct error *err)
{
    *err = (struct error){ 0 };
    return rsc_parse((const uint8_t *)text, strlen(text), name, rsc, report, err);
}

static void preferences_give_colours_levels_maps_and_tissues(void **state)
{
    (void)state;
    static struct rsc rsc;
    struct report report = { 0 };
    struct error err;
    assert_true(read_rsc(
        "# Sera3d resources\nMain_Window_Size: 650\nGamma: 65535 0 0 1 2\ncontour_level: 95 65535 0 32896  #(level r g b )\n"
        "contour_level: 50 0 65535 65535\nLeft-Eye_color: 65535 42663 0 40 # (R G B Opacity(0-100))\nBad_color: 70000 0 0\n",
        "Sera3d.rsc", &rsc, &report, &err));
    assert_int_equal(rsc.n_levels, 2);
    assert_close(rsc.levels[0].percent, 95, 0);
    assert_int_equal(rsc.levels[0].rgb[0], 255);
    assert_int_equal(rsc.levels[0].rgb[2], 128); /* 32896 = 128 * 257 */
    assert_int_equal(rsc.n_bodies, 1);
    const struct rsc_body *eye = rsc_find(&rsc, "left_eye");
    assert_non_null(eye);
    assert_int_equal(eye->rgb[1], 166); /* 42663 / 257 = 166.0 */
    assert_close(eye->opacity, 0.4, 1e-9);
    assert_null(rsc_find(&rsc, "left_ey"));
    assert_null(rsc_find(&rsc, "left_eyes"));
    assert_non_null(
        strstr(report_said(&report, "header.bad-number"), "1 values are not numbers in range, the first in line 7"));
    report_finish(&report);
    assert_true(read_rsc("view contour lines:True\ncontour levels:\n10:White\n90:Red\nMax:Blue\n", "seradose_prefs.rsc",
                         &rsc, NULL, &err));
    assert_int_equal(rsc.n_levels, 2);
    assert_close(rsc.levels[1].percent, 90, 0);
    assert_int_equal(rsc.levels[1].rgb[0], 255);
    assert_int_equal(rsc.levels[1].rgb[1], 0);
    assert_true(read_rsc("0 0 0\n51 0 68 \n255 255 255", "a.cmap", &rsc, NULL, &err));
    assert_int_equal(rsc.n_colors, 3);
    assert_int_equal(rsc.colors[1][2], 68);
    assert_true(read_rsc(
        "* 11 Jan 1999\n\nbegin: brain\n boron_CF:  1.3\n nitrogen_RBE: 3.2\n tissue_to_blood: 1.0\n matname: x\n"
        "end: brain\nboron_CF: 9\n",
        "body_data.txt", &rsc, NULL, &err));
    assert_close(rsc.bodies[0].cbe_boron, 1.3, 0);
    assert_close(rsc.bodies[0].boron_ratio, 1, 0);
    assert_true(isnan(rsc.bodies[0].rbe_gamma));
    assert_false(read_rsc("\x01\x02nothing", "x.rsc", &rsc, NULL, &err));
    assert_non_null(strstr(err.text, "x.rsc: not one of 1 lines"));
    assert_false(read_rsc("0 0 0\n1 2\n", "x.cmap", &rsc, NULL, &err));
    assert_non_null(strstr(err.text, "line 2: expected three numbers"));
    assert_false(read_rsc("0 0 256\n", "x.cmap", &rsc, NULL, &err));
    assert_false(read_rsc("", "body_data.txt", &rsc, NULL, &err));
    assert_int_equal(rsc.n_bodies, 0);
}

static void preferences_fill_only_what_regions_do_not_have(void **state)
{
    (void)state;
    char folder[256];
    struct error err = { 0 };
    folder_make(folder);
    static const char header[] =
        "Version: uvh2.0\nDimensionality: mm\nSliceOrientation: Axial\nImageRows: 16\nImageColumns: 16\nImageSlices: 2\n"
        "PixelSizeRows: 10\nPixelSizeColumns: 10\nPixelSizeSlices: 10\nRLaxisMin: -80\nRLaxisMax: 80\nPAaxisMin: -80\n"
        "PAaxisMax: 80\nISaxisMin: 0\nISaxisMax: 20\nImageRowAxis: PA-\nImageColumnAxis: RL+\nImageSliceAxis: IS+\n"
        "begin: Brain\nuvval: 3\ntissue_to_blood: 2\nend\nbegin: Tumor\nuvval: 4\ncolor_red: 1\ncolor_green: 2\n"
        "color_blue: 3\nend\nbegin: something\nuvval: 5\nend\n";
    uint8_t univels[512];
    for (size_t i = 0; i < sizeof univels; i++)
        univels[i] = (uint8_t)(3 + i % 3);
    static const char colors[] =
        "contour_level: 80 0 65535 0\nBrain_color: 257 514 771 30\nTumor_color: 65535 65535 65535 100\n"
        "Default_color: 2570 2570 2570 100\n";
    static const char tissues[] = "begin: brain\ntissue_to_blood: 1\nboron_CF: 1.3\nend\n", map[] = "0 0 0\n255 0 0\n";
    folder_put(folder, "a.uvh", header, sizeof header - 1);
    folder_put(folder, "a.uv", univels, sizeof univels);
    folder_put(folder, "S.rsc", colors, sizeof colors - 1);
    folder_put(folder, "body_data.txt", tissues, sizeof tissues - 1);
    folder_put(folder, "x.cmap", map, sizeof map - 1);
    folder_put(folder, "y.cmap", "no", 2);
    folder_put(folder, "z.dose", "no", 2);
    struct plan *plan = plan_load(folder, "p", NULL, &err);
    assert_string_equal(err.text, "");
    const struct region *brain = region_find(&plan->regions, "brain"), *tumor = region_find(&plan->regions, "tumor"),
                        *other = region_find(&plan->regions, "something");
    assert_int_equal(brain->rgb[0] << 16 | brain->rgb[1] << 8 | brain->rgb[2], 0x010203);
    assert_close(brain->file_opacity, 0.3, 1e-9);
    assert_true(brain->has_file_color);
    assert_close(brain->boron_ratio, 2, 0); /* its own */
    assert_close(brain->cbe_boron, 1.3, 0);
    assert_int_equal(tumor->rgb[0] << 16 | tumor->rgb[1] << 8 | tumor->rgb[2], 0x010203);
    assert_true(isnan(tumor->boron_ratio));
    assert_int_equal(other->rgb[0], 10);
    assert_int_equal(plan->preferences.n_levels, 1);
    assert_close(plan->preferences.levels[0].percent, 80, 0);
    assert_int_equal(plan->preferences.levels[0].rgb[1], 255);
    assert_int_equal(plan->preferences.n_colors, 2);
    assert_non_null(strstr(report_said(&plan->report, "preferences.colors"), "2 regions without a colour"));
    assert_non_null(strstr(report_said(&plan->report, "preferences.tissues"), "1 regions"));
    assert_non_null(strstr(report_said(&plan->report, "preferences.unread"), "y.cmap: line 1"));
    assert_non_null(strstr(report_said(&plan->report, "curve.unread"), "z.dose: line 1"));
    plan_destroy(plan);
    folder_remove(folder);
}

static void a_plan_file_names_curves_and_preferences(void **state)
{
    (void)state;
    char folder[256], text[TEXT_SIZE];
    struct error err = { 0 };
    folder_make(folder);
    size_t n = make_table(text, NULL);
    folder_put(folder, "a.dose", text, n);
    folder_put(folder, "S.rsc", "contour_level: 80 0 65535 0\n", 28);
    folder_put(folder, "l.nhdr", "", 0);
    static const char all[] =
        "{\"format\":\"beamroom-plan\",\"version\":1,\"doses\":[{\"path\":\"a.rst\"}],\"curves\":[{\"path\":\"a.dose\","
        "\"name\":\"Phantom\",\"per\":\"MW-min\"},{\"id\":\"b\",\"path\":\"a.dose\"},{\"id\":\"b\",\"path\":\"gone.dose\"},"
        "{\"id\":\"b\",\"path\":\"a.dose\"}],\"preferences\":[{\"path\":\"S.rsc\"}]}";
    static const char rst[] =
        "   1seraMC_1C0\nnone\nA\nc\nu\nm\ns\nr\n   0.000000E+00   0.000000E+00   0.000000E+00   1.000000E+00       1       3\n"
        "      32      72      94\nN     20_NOV_2026       1.000000E+00   1.000000E+00   3.600000E+06\n"
        "10000000       0       0   2.500000E-01\nx\n1\n0\nr\n5\n1\n0\n"
        "   1.0E0          1.0E0          1.0E0          1.0E0          1.0E0          1.0E0\n"
        "   1.0E0          1.0E0          1.0E0          1.0E0          1.0E0          1.0E0\n";
    folder_put(folder, "a.rst", rst, sizeof rst - 1);
    folder_put(folder, "plan.json", all, sizeof all - 1);
    struct plan *plan = plan_load(folder, "p", NULL, &err);
    assert_string_equal(err.text, "");
    assert_int_equal(plan->n_curves, 3);
    assert_string_equal(plan->curves[0].id, "a");
    assert_string_equal(plan->curves[0].name, "Phantom");
    assert_string_equal(plan->curves[0].per, "MW-min");
    assert_string_equal(plan->curves[1].id, "b");
    assert_string_equal(plan->curves[2].id, "b-2");
    assert_string_equal(plan->curves[2].per, "unit of the source");
    assert_non_null(strstr(report_said(&plan->report, "curve.unread"), "gone.dose"));
    assert_int_equal(plan->preferences.n_levels, 1);
    plan_destroy(plan);
    folder_remove(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_table_has_its_depths_radii_and_columns),
        cmocka_unit_test(a_table_that_is_wrong_is_refused_with_its_line),
        cmocka_unit_test(every_cut_and_changed_byte_of_a_table_is_survived),
        cmocka_unit_test(published_tables_have_their_published_figures),
        cmocka_unit_test(preferences_give_colours_levels_maps_and_tissues),
        cmocka_unit_test(preferences_fill_only_what_regions_do_not_have),
        cmocka_unit_test(a_plan_file_names_curves_and_preferences),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
