/* SERA's dose contours: small sets laid out by hand as seraMC (fixed columns, numbers that touch) and seraPlan (blanks,
 * another order of columns) write them. */
#include "core/formats/sera/sera_row.h"
#include "tests/unit/made_chd.h"
#include "tests/unit/plan_help.h"

static void columns_are_found_by_their_names_whoever_wrote_them(void **state)
{
    (void)state;
    for (int writer = 0; writer < 4; writer++) {
        struct made_chd made = chd_plain;
        made.names = writer % 2 ? chd_sera_plan : chd_sera_mc;
        made.version = writer % 2 ? "seraPlan_1C0" : "seraMC_1A0";
        made.is_plan = writer >= 2;
        struct chd_result result = chd_read_made(&made);
        static const enum dose_quantity all[] = {
            DOSE_BLOOD_BORON, DOSE_GAMMA,        DOSE_NITROGEN,           DOSE_FAST,
            DOSE_OTHER,       DOSE_FAST_FLUENCE, DOSE_EPITHERMAL_FLUENCE, DOSE_THERMAL_FLUENCE
        };
        assert_int_equal(result.doses.n_components, 9);
        for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
            chd_check_quantity(&result.doses, all[i]);
        assert_near(result.doses.reference[DOSE_THERMAL_FLUENCE], 1.25e11, 1e-5);
        assert_near(result.doses.reference[DOSE_OTHER], 0.125, 1e-5);
        assert_true((strstr(report_said(&result.report, "dose.column-order"), "Column 5 holds other") != NULL) ==
                    (writer % 2 == 1));
        chd_result_finish(&result);
    }
}

static void negative_numbers_that_touch_are_told_apart_by_their_columns(void **state)
{
    (void)state;
    const char line[] =
        "-1.000E+00-1.000E+00-2.038E+00   4-5.353E-01 4.183E-03 4.224E-01-8.696E-03-9.385E-02 1.619E+08 4.137E+09 4.889E+08 6.092E-03";
    struct sera_row row;
    assert_int_equal(sizeof line - 1, 124);
    assert_true(sera_row_is_fixed(line, sizeof line - 1, 9));
    assert_true(sera_row_parse(line, sizeof line - 1, true, 9, &row));
    assert_close(row.at[1], -1, 0);
    assert_close(row.at[2], -2.038, 1e-12);
    assert_close(row.region, 4, 0);
    assert_close(row.values[0], -0.5353, 1e-12);
    assert_close(row.values[4], -0.09385, 1e-12);
    assert_close(row.values[8], 6.092e-3, 1e-12);
    assert_false(sera_row_parse(line, sizeof line - 1, false, 9, &row));
    assert_false(sera_row_parse(line, 100, true, 9, &row));
    const char blanks[] = " 1.0 .5E+00 -2 12 1 2 3 4 5 6 7 8 1.0-101";
    assert_false(sera_row_is_fixed(blanks, sizeof blanks - 1, 9));
    assert_true(sera_row_parse(blanks, sizeof blanks - 1, false, 9, &row));
    assert_close(row.at[1], 0.5, 0);
    assert_close(row.region, 12, 0);
    assert_close(row.values[8], 0, 1e-99);
}

static void fov_is_half_the_width_and_rows_run_toward_the_front(void **state)
{
    (void)state;
    struct chd_result result = chd_read_made(&chd_plain);
    const struct grid *grid = &chd_volume_of(&result.doses, DOSE_GAMMA)->grid;
    /* FOV 10 cm: x runs from -100 to 100 mm in three columns; y from the posterior (P +100) up; z -5 and -4 cm */
    struct vec3 first = affine_point(&grid->lps_mm_from_ijk, vec3(0, 0, 0)),
                last = affine_point(&grid->lps_mm_from_ijk, vec3(2, 1, 1));
    assert_close(first.x, -100, 1e-6);
    assert_close(first.y, 100, 1e-6);
    assert_close(first.z, -50, 1e-6);
    assert_close(last.x, 100, 1e-6);
    assert_close(last.y, -100, 1e-6);
    assert_close(last.z, -40, 1e-6);
    chd_result_finish(&result);
}

static void planes_are_placed_by_their_z_and_not_by_their_order(void **state)
{
    (void)state;
    struct made_chd made = chd_plain;
    made.n_planes = 4;
    const double z[4] = { -1, -4, -2, -3 };
    const size_t order[4] = { 2, 0, 3, 1 };
    memcpy(made.z, z, sizeof z);
    memcpy(made.order, order, sizeof order);
    struct chd_result result = chd_read_made(&made);
    const struct volume *gamma = chd_volume_of(&result.doses, DOSE_GAMMA);
    assert_close(affine_point(&gamma->grid.lps_mm_from_ijk, vec3(0, 0, 0)).z, -40, 1e-6);
    static const size_t header_plane[4] = { 1, 3, 2, 0 }; /* rising */
    for (uint32_t k = 0; k < 4; k++)
        assert_near(volume_value(gamma, 1, 1, k), chd_physical(DOSE_GAMMA, header_plane[k] * 6 + 4), 6e-4);
    chd_result_finish(&result);
}

static void uneven_planes_are_resampled_and_said_so_or_refused(void **state)
{
    (void)state;
    struct made_chd made = chd_plain;
    made.n_planes = 3;
    const double z[4] = { -5, -4, -2 };
    memcpy(made.z, z, sizeof z);
    made.order[2] = 2;
    struct chd_result result = chd_read_made(&made);
    const struct volume *gamma = chd_volume_of(&result.doses, DOSE_GAMMA);
    assert_int_equal(gamma->grid.size[2], 4); /* -5, -4, -3, -2 cm */
    assert_non_null(strstr(report_said(&result.report, "dose.planes-uneven"), "resampled to 4 planes every 10 mm"));
    assert_near(volume_value(gamma, 0, 0, 0), chd_physical(DOSE_GAMMA, 0), 6e-4);
    assert_near(volume_value(gamma, 0, 0, 1), chd_physical(DOSE_GAMMA, 6), 6e-4);
    assert_near(volume_value(gamma, 0, 0, 2), (chd_physical(DOSE_GAMMA, 6) + chd_physical(DOSE_GAMMA, 12)) / 2, 6e-4);
    assert_near(volume_value(gamma, 0, 0, 3), chd_physical(DOSE_GAMMA, 12), 6e-4);
    chd_result_finish(&result);
    made.z[2] = made.z[1] + 0.0011; /* 5 cm and 0.011 mm apart */
    made.z[0] = -9;
    struct chd_text header = chd_make_header(&made), table = chd_make_table(&made);
    assert_false(chd_read_both(&header, &table, NULL, &result));
    assert_int_equal(result.err.code, ERROR_UNSUPPORTED);
    free(header.at);
    free(table.at);
    chd_result_finish(&result);
}

static void weights_and_ppm_are_divided_away_and_a_weighted_total_keeps_its_name(void **state)
{
    (void)state;
    struct made_chd made = chd_plain;
    made.ppm = 15;
    made.weight = 1.3;
    made.other_weight = 3.2;
    struct chd_result result = chd_read_made(&made);
    /* 12 points are too few to say that the ratio is 1: boron keeps the name that says so */
    assert_null(chd_volume_of(&result.doses, DOSE_TOTAL));
    assert_null(chd_volume_of(&result.doses, DOSE_BORON));
    const struct volume *total = chd_volume_of(&result.doses, DOSE_WEIGHTED_TOTAL),
                        *boron = chd_volume_of(&result.doses, DOSE_BLOOD_BORON);
    assert_non_null(total);
    assert_non_null(boron);
    assert_near(volume_value(total, 0, 0, 0), chd_printed(&made, "total", 0, 6), 6e-4);
    assert_near(volume_value(boron, 2, 1, 1), chd_physical(DOSE_BORON, 11), 6e-4);
    assert_near(result.doses.reference[DOSE_BLOOD_BORON], 1.25 * chd_physical(DOSE_BORON, 0), 1e-5);
    chd_check_quantity(&result.doses, DOSE_GAMMA);
    chd_check_quantity(&result.doses, DOSE_NITROGEN);
    chd_check_quantity(&result.doses, DOSE_FAST);
    chd_check_quantity(&result.doses, DOSE_OTHER);
    chd_check_quantity(&result.doses, DOSE_THERMAL_FLUENCE);
    assert_non_null(strstr(report_said(&result.report, "dose.total-boron"), "weighted, with 15 ppm"));
    for (size_t c = 0; c < result.doses.n_components; c++) { /* of no other quantity is it said */
        const struct dose_component *component = &result.doses.components[c];
        assert_int_equal(component->has_boron_ppm, component->quantity == DOSE_WEIGHTED_TOTAL);
        assert_close(component->boron_ppm, component->quantity == DOSE_WEIGHTED_TOTAL ? 15 : 0, 0);
    }
    chd_result_finish(&result);
    made.weight = 0;
    result = chd_read_made(&made);
    assert_null(chd_volume_of(&result.doses, DOSE_BLOOD_BORON));
    assert_non_null(strstr(report_said(&result.report, "dose.weight-zero"), "boron"));
    chd_result_finish(&result);
}

/* Needs some points a region: a set of 40 columns. */
static struct chd_result read_wide_with(double ratio, const char *concentrations)
{
    struct chd_text header = { malloc(CHD_TEXT_SIZE), 0 }, table = { malloc(CHD_TEXT_SIZE), 0 };
    struct chd_result result;
    chd_put(
        &header,
        "Version_stamp: seraMC_1C0\nFOV: 10\nxmin: -1\nxmax: 1\nymin: -1\nymax: 1\nnum_cols: 41\nnum_rows: 2\nnum_planes: 1\n"
        "z_value_00: 0\nref_dose_7: 1E11\n%s",
        concentrations);
    for (int i = 0; i < 9; i++)
        chd_put(&header, "dose_comp_%d: %s\nrbe_val_%d: 1\n", i, chd_sera_mc[i], i);
    for (int r = 0; r < 2; r++)
        for (int c = 0; c < 41; c++)
            chd_put(&table, "%.4f %d 0 %d 1 %.5E 1 1 1 1 1 1E11 1\n", -1 + c * 0.05, 2 * r - 1, 6 + r,
                    10 * 0.73 * (r == 1 ? ratio : 1));
    if (!chd_read_both(&header, &table, NULL, &result))
        fail_msg("%s", result.err.text);
    free(header.at);
    free(table.at);
    return result;
}

static struct chd_result read_wide(double ratio)
{
    return read_wide_with(ratio, "conc_1: 10\nconc_0: 1\n");
}

static void a_total_tells_its_boron_only_where_the_header_does(void **state)
{
    (void)state;
    static const char *const concentrations[] = { "conc_1: 10\n", "", "conc_0: 1\n" };
    for (int i = 0; i < 3; i++) {
        struct chd_result result = read_wide_with(1, concentrations[i]);
        const struct dose_component *total = NULL;
        for (size_t c = 0; c < result.doses.n_components; c++)
            if (result.doses.components[c].quantity == DOSE_TOTAL)
                total = &result.doses.components[c];
        assert_non_null(total);
        assert_int_equal(total->has_boron_ppm, i == 0);
        assert_close(total->boron_ppm, i == 0 ? 10 : 0, 0);
        assert_int_equal(report_said(&result.report, "dose.weights-missing")[0] != 0, i != 0);
        assert_int_equal(strstr(report_said(&result.report, "dose.total-boron"), "ppm") != NULL, i == 0);
        chd_result_finish(&result);
    }
}

static void boron_is_physical_only_where_every_tissue_holds_as_much_as_blood(void **state)
{
    (void)state;
    struct chd_result result = read_wide(1);
    assert_non_null(chd_volume_of(&result.doses, DOSE_BORON));
    assert_close(volume_value(chd_volume_of(&result.doses, DOSE_BORON), 3, 1, 0), 0.73, 1e-6);
    assert_non_null(strstr(report_said(&result.report, "dose.boron-ratio"), "as much boron as blood"));
    chd_result_finish(&result);
    result = read_wide(3.5); /* a tumour's */
    assert_null(chd_volume_of(&result.doses, DOSE_BORON));
    assert_close(volume_value(chd_volume_of(&result.doses, DOSE_BLOOD_BORON), 3, 1, 0), 3.5 * 0.73, 1e-5);
    assert_non_null(strstr(report_said(&result.report, "dose.boron-ratio"), "does not store"));
    assert_non_null(chd_volume_of(&result.doses, DOSE_TOTAL)); /* no weights in it */
    chd_result_finish(&result);
}

static void any_version_is_read_when_its_keys_are_there(void **state)
{
    (void)state;
    struct made_chd made = chd_plain;
    made.version = "seraMC_2B7";
    struct chd_result result = chd_read_made(&made);
    assert_string_equal(report_said(&result.report, "dose.unknown-version"), "");
    chd_result_finish(&result);
    made.version = "another 1.0";
    result = chd_read_made(&made);
    assert_non_null(strstr(report_said(&result.report, "dose.unknown-version"), "\"another 1.0\""));
    chd_check_quantity(&result.doses, DOSE_GAMMA);
    chd_result_finish(&result);
}

static void a_header_in_millimetres_is_told_by_its_width(void **state)
{
    (void)state;
    struct made_chd made = chd_plain;
    made.fov = 129.999;
    made.z[0] = -50;
    made.z[1] = -44.5;
    struct chd_result result = chd_read_made(&made);
    struct vec3 first = affine_point(&chd_volume_of(&result.doses, DOSE_GAMMA)->grid.lps_mm_from_ijk, vec3(0, 0, 0));
    assert_close(first.x, -129.999, 1e-6);
    assert_close(first.z, -50, 1e-6);
    assert_non_null(strstr(report_said(&result.report, "geometry.unit-assumed"), "2.60 m wide in centimetres"));
    chd_result_finish(&result);
}

static void points_that_hold_nothing_are_not_blended_with_their_neighbours(void **state)
{
    (void)state;
    struct chd_text header = chd_make_header(&chd_plain), table = chd_make_table(&chd_plain);
    struct chd_result result;
    /* the first point: zeros alone; the second: region 0 */
    for (int i = 0; i < 9; i++)
        memcpy(table.at + 34 + 10 * i, i % 2 ? " 0.000E+00" : "  .000E+00", 10);
    memcpy(table.at + 125 + 30, "   0", 4);
    assert_true(chd_read_both(&header, &table, NULL, &result));
    const struct volume *gamma = chd_volume_of(&result.doses, DOSE_GAMMA);
    double value;
    assert_true(isnan(volume_value(gamma, 0, 0, 0)));
    assert_true(isnan(volume_value(gamma, 1, 0, 0)));
    assert_false(volume_sample(gamma, vec3(-95, 95, -50), &value));
    assert_true(volume_sample(gamma, vec3(95, -95, -38), &value));
    assert_true(gamma->low > 10);
    assert_non_null(strstr(report_said(&result.report, "dose.outside-mesh"), "2 of 12 points"));
    free(header.at);
    free(table.at);
    chd_result_finish(&result);
}

static void pictures_of_regions_say_where_the_dose_is_valid(void **state)
{
    (void)state;
    enum { SIDE = 256 };
    struct chd_text header = chd_make_header(&chd_plain), table = chd_make_table(&chd_plain);
    struct bytes mask = { malloc(2 * SIDE * SIDE), 2 * SIDE * SIDE };
    struct chd_result result;
    /* two regions, 6 and 7 of 7: 255 / 7 = 36; the left third is 6; the foremost ten rows hold nothing */
    for (size_t i = 0; i < mask.size; i++)
        mask.data[i] = i / SIDE % SIDE < 10 ? 0 : (uint8_t)(36 * (i % SIDE < 60 ? 6 : 7));
    assert_true(chd_read_both(&header, &table, &mask, &result));
    assert_non_null(result.doses.mask);
    uint32_t at[3];
    assert_true(volume_voxel_at(result.doses.mask, vec3(0, -99, -50), at)); /* P -99: foremost */
    assert_int_equal(volume_label(result.doses.mask, at[0], at[1], at[2]), 0);
    assert_true(volume_voxel_at(result.doses.mask, vec3(0, 99, -41), at));
    assert_int_equal(volume_label(result.doses.mask, at[0], at[1], at[2]), 1);
    assert_true(volume_voxel_at(result.doses.mask, vec3(0, -91, -50), at)); /* 10 rows of 200 / 256 mm end at 92.19 */
    assert_int_equal(volume_label(result.doses.mask, at[0], at[1], at[2]), 1);
    chd_result_finish(&result);
    mask.size -= SIDE;
    assert_true(chd_read_both(&header, &table, &mask, &result));
    assert_null(result.doses.mask);
    assert_non_null(strstr(report_said(&result.report, "dose.mask-unread"), "are not 2 square pictures"));
    chd_result_finish(&result);
    free(mask.data);
    free(header.at);
    free(table.at);
}

static void pictures_of_uneven_planes_go_with_the_nearest(void **state)
{
    (void)state;
    enum { SIDE = 16 };
    struct made_chd made = chd_plain;
    made.n_planes = 3;
    made.z[2] = -1.9;
    made.order[2] = 2;
    struct chd_text header = chd_make_header(&made), table = chd_make_table(&made);
    uint8_t pixels[3 * SIDE * SIDE];
    memset(pixels, 252, 2 * SIDE * SIDE);
    memset(pixels + 2 * SIDE * SIDE, 0, SIDE * SIDE); /* the last plane is not valid */
    const struct bytes mask = { pixels, sizeof pixels };
    struct chd_result result;
    assert_true(chd_read_both(&header, &table, &mask, &result));
    assert_int_equal(result.doses.mask->grid.size[2],
                     4); /* -5, -3.97, -2.93 and -1.9 cm: the third is the nearer to the last */
    for (uint32_t k = 0; k < 4; k++)
        assert_int_equal(volume_label(result.doses.mask, 3, 3, k), k < 2);
    chd_result_finish(&result);
    free(header.at);
    free(table.at);
}

static void pictures_that_show_other_regions_are_not_believed(void **state)
{
    (void)state;
    static const char header[] =
        "FOV: 13\nxmin: -.5\nxmax: .5\nymin: -.5\nymax: .5\nnum_cols: 2\nnum_rows: 2\nnum_planes: 1\nz_value_00: 0\n"
        "dose_comp_2: gamma\nrbe_val_2: 1\n";
    /* region 2 posterior, 1 anterior: 255 / 2 = 127, so 254 below and 127 above */
    static const char points[] =
        "-.5 -.5 0 2 1 1 1 1 1 1 1 1 1\n.5 -.5 0 2 1 1 1 1 1 1 1 1 1\n-.5 .5 0 1 1 1 1 1 1 1 1 1 1\n.5 .5 0 1 1 1 1 1 1 1 1 1 1\n";
    struct chd_text head = { (char *)(uintptr_t)header, sizeof header - 1 },
                    table = { (char *)(uintptr_t)points, sizeof points - 1 };
    uint8_t pixels[256];
    const struct bytes mask = { pixels, sizeof pixels };
    for (int is_turned = 0; is_turned < 2; is_turned++) {
        struct chd_result result;
        for (size_t i = 0; i < sizeof pixels; i++)
            pixels[i] = (i < 128) != is_turned ? 127 : 254;
        pixels[0] = 0;
        assert_true(chd_read_both(&head, &table, &mask, &result));
        assert_int_equal(result.doses.mask != NULL, !is_turned);
        assert_int_equal(strstr(report_said(&result.report, "dose.mask-unread"), "at 100 % of its points") != NULL,
                         is_turned);
        chd_result_finish(&result);
    }
}

static void numbers_that_are_none_and_a_reference_of_zero_are_counted(void **state)
{
    (void)state;
    static const struct {
        const char *word, *sentence;
    } bad[] = { { "**********", "1 values too large" },
                { "NaN", "and 1 that are no numbers" },
                { "1E99", "1 values too large" } };
    struct made_chd made = chd_plain;
    for (size_t i = 0; i < 3; i++) {
        made.special = bad[i].word;
        struct chd_result result = chd_read_made(&made);
        assert_true(isnan(volume_value(chd_volume_of(&result.doses, DOSE_GAMMA), 0, 0, 0)));
        assert_near(volume_value(chd_volume_of(&result.doses, DOSE_NITROGEN), 0, 0, 0), 5, 1e-3);
        assert_non_null(strstr(report_said(&result.report, "dose.bad-values"), bad[i].sentence));
        assert_non_null(strstr(report_said(&result.report, "dose.bad-values"), "first in line 1"));
        chd_result_finish(&result);
    }
    made.special = "  2.0-101";
    made.more = "ref_dose_2: .0E+00\nref_dose_3: ********\n";
    struct chd_result result = chd_read_made(&made);
    assert_close(volume_value(chd_volume_of(&result.doses, DOSE_GAMMA), 0, 0, 0), 0, 1e-30);
    assert_close(result.doses.reference[DOSE_GAMMA], 0, 0);
    assert_non_null(strstr(report_said(&result.report, "dose.no-reference"), "1 of 9"));
    assert_non_null(strstr(report_said(&result.report, "header.bad-number"), "ref_dose_3"));
    chd_result_finish(&result);
}

static void expect_header(const char *more, enum error_code code, const char *words)
{
    struct made_chd made = chd_plain;
    struct chd_result result;
    made.more = more;
    struct chd_text header = chd_make_header(&made), table = chd_make_table(&made);
    if (chd_read_both(&header, &table, NULL, &result) || result.err.code != code || !strstr(result.err.text, words) ||
        !strstr(result.err.text, "a.c"))
        fail_msg("%s: \"%s\"", more, result.err.text);
    free(header.at);
    free(table.at);
    chd_result_finish(&result);
}

static void a_set_that_is_wrong_is_refused_with_its_line(void **state)
{
    (void)state;
    expect_header("num_cols: 65535\n", ERROR_FORMAT, "num_cols is 65535, expected a whole number from 2 to 1024");
    expect_header("num_cols: 1024\nnum_rows: 1024\nnum_planes: 1024\n", ERROR_LIMIT, "1024 x 1024 x 1024 points");
    expect_header("num_planes: 3\n", ERROR_FORMAT, "z_value_02 is missing");
    expect_header("num_planes: NaN\n", ERROR_FORMAT, "num_planes is \"NaN\"");
    expect_header("FOV: 0\n", ERROR_FORMAT, "FOV is 0");
    expect_header("FOV: inf\n", ERROR_FORMAT, "FOV is \"inf\"");
    expect_header("xmax: -1\n", ERROR_FORMAT, "xmin to xmax is -1 to -1");
    expect_header("x_in_field: 2\n", ERROR_FORMAT, "x_in_field is \"2\", expected 1");
    expect_header("z_value_5000: 1\n", ERROR_LIMIT, "more than 1024 planes");
    expect_header("conc_9: 1\n", ERROR_FORMAT, "at most nine columns");
    expect_header("FOV: 20\n", ERROR_FORMAT, "a.cdf.sz: line 1: the point (-1, -1, -0.5) is not one");
    expect_header("num_rows: 3\n", ERROR_FORMAT, "12 points, but the header says 3 x 3 x 2 = 18");
    expect_header("num_planes: 1\n", ERROR_FORMAT, "a.cdf.sz: line 7: more points than the 3 x 2 x 1");
    struct chd_text header = chd_make_header(&chd_plain), table = chd_make_table(&chd_plain);
    struct chd_result result;
    size_t whole = table.n;
    table.n = 300;
    assert_false(chd_read_both(&header, &table, NULL, &result));
    assert_non_null(strstr(result.err.text, "line 3: 50 characters, expected 13 numbers in columns"));
    chd_result_finish(&result);
    table.n = whole;
    memcpy(table.at + 125, table.at, 125);
    assert_false(chd_read_both(&header, &table, NULL, &result));
    assert_non_null(strstr(result.err.text, "line 2: the point (-1, -1, -0.5) is there twice"));
    chd_result_finish(&result);
    header.n = 20;
    assert_false(chd_read_both(&header, &table, NULL, &result));
    assert_non_null(strstr(result.err.text, "the key FOV is missing"));
    chd_result_finish(&result);
    free(header.at);
    free(table.at);
}

static void every_cut_and_every_changed_byte_is_survived(void **state)
{
    (void)state;
    struct chd_text header = chd_make_header(&chd_plain), table = chd_make_table(&chd_plain);
    struct chd_result result;
    for (int which = 0; which < 2; which++) {
        struct chd_text *text = which ? &table : &header;
        size_t whole = text->n;
        for (size_t n = 0; n < whole; n += which ? 1 : 3) {
            struct chd_text part = { malloc(n + 1), n }; /* of exactly that size, for the address sanitizer */
            memcpy(part.at, text->at, n);
            if (!chd_read_both(which ? &header : &part, which ? &part : &table, NULL, &result))
                assert_true(result.err.text[0] != 0);
            chd_result_finish(&result);
            free(part.at);
        }
        for (size_t i = 0; i < whole; i++)
            for (int bit = 0; bit < 8; bit += 3) {
                text->at[i] = (char)(text->at[i] ^ 1 << bit);
                if (!chd_read_both(&header, &table, NULL, &result))
                    assert_true(result.err.text[0] != 0);
                chd_result_finish(&result);
                text->at[i] = (char)(text->at[i] ^ 1 << bit);
            }
    }
    free(header.at);
    free(table.at);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(columns_are_found_by_their_names_whoever_wrote_them),
        cmocka_unit_test(negative_numbers_that_touch_are_told_apart_by_their_columns),
        cmocka_unit_test(fov_is_half_the_width_and_rows_run_toward_the_front),
        cmocka_unit_test(planes_are_placed_by_their_z_and_not_by_their_order),
        cmocka_unit_test(uneven_planes_are_resampled_and_said_so_or_refused),
        cmocka_unit_test(weights_and_ppm_are_divided_away_and_a_weighted_total_keeps_its_name),
        cmocka_unit_test(boron_is_physical_only_where_every_tissue_holds_as_much_as_blood),
        cmocka_unit_test(a_total_tells_its_boron_only_where_the_header_does),
        cmocka_unit_test(any_version_is_read_when_its_keys_are_there),
        cmocka_unit_test(a_header_in_millimetres_is_told_by_its_width),
        cmocka_unit_test(points_that_hold_nothing_are_not_blended_with_their_neighbours),
        cmocka_unit_test(pictures_of_regions_say_where_the_dose_is_valid),
        cmocka_unit_test(pictures_of_uneven_planes_go_with_the_nearest),
        cmocka_unit_test(pictures_that_show_other_regions_are_not_believed),
        cmocka_unit_test(numbers_that_are_none_and_a_reference_of_zero_are_counted),
        cmocka_unit_test(a_set_that_is_wrong_is_refused_with_its_line),
        cmocka_unit_test(every_cut_and_every_changed_byte_is_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
