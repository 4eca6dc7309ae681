/* SERA's text headers, images and tracks: geometry by hand, and every trap of its files. */
#include "core/formats/hierarchy.h"
#include "core/formats/sera/sera_axes.h"
#include "core/formats/sera/sera_pp.h"
#include "core/formats/sera/sera_qhd.h"
#include "core/formats/sera/sera_uvh.h"
#include "core/formats/text.h"
#include "tests/check.h"
#include "tests/unit/nifti_bytes.h"
#include "tests/unit/plan_help.h"

/* 4 columns of 2, 3 rows of 3, 2 slices of 5; faces RL -40..., given as words so that tests can change them. */
struct uvh_words {
    const char *version, *unit, *orientation, *column_axis, *row_axis, *slice_axis, *faces, *more;
};
static const struct uvh_words plain = {
    "uvh2.0",
    "mm",
    "Transverse",
    "RL+",
    "PA-",
    "IS+",
    "RLaxisMin: 100\nRLaxisMax: 180\nPAaxisMin: 10\nPAaxisMax: 70\nISaxisMin: -50\nISaxisMax: 50\n",
    ""
};

static bool parse(const struct uvh_words *w, struct uvh *uvh, struct report *report, struct error *err)
{
    char text[4096];
    int n = snprintf(
        text, sizeof text,
        "# a comment\n\nVersion: %s\nDimensionality: %s\nSliceOrientation:%s\nImageColumns: 4\nimagerows: 3\n"
        "ImageSlices: 2\nPixelSizeColumns: 20\nPixelSizeRows: 20.0\nPixelSizeSlices: .5E+02\n%sImageColumnAxis: %s\n"
        "ImageRowAxis: %s\nImageSliceAxis: %s\nbegin: 'brain' # quoted\n uvval: 3\n color_red: 200\nend\n%s",
        w->version, w->unit, w->orientation, w->faces, w->column_axis, w->row_axis, w->slice_axis, w->more);
    *err = (struct error){ 0 };
    return uvh_parse((const uint8_t *)text, (size_t)n, "a.uvh", uvh, report, err);
}

static void the_standard_axial_header_puts_row_0_in_front(void **state)
{
    (void)state;
    struct uvh uvh;
    struct error err;
    struct report report = { 0 };
    assert_true(parse(&plain, &uvh, &report, &err));
    /* faces, so centres lie half a univel inside: RL 110, PA 70 - 10 = 60 (P = -60), IS -25 */
    assert_point(affine_point(&uvh.grid.lps_mm_from_ijk, vec3(0, 0, 0)), 110, -60, -25, 1e-6);
    assert_point(affine_point(&uvh.grid.lps_mm_from_ijk, vec3(3, 2, 1)), 170, -20, 25, 1e-6);
    assert_int_equal(uvh.n_bodies, 1);
    assert_string_equal(uvh.bodies[0].name, "brain");
    assert_int_equal(uvh.bodies[0].uvval, 3);
    assert_int_equal(uvh.bodies[0].rgb[0], 200);
    assert_true(isnan(uvh.bodies[0].cbe_boron));
    assert_int_equal(report.n_lines, 0);
    uvh_finish(&uvh);
}

static void all_axis_codes_in_all_places_put_the_first_univel_where_the_header_says(void **state)
{
    (void)state;
    static const char *const codes[3][2] = { { "RL+", "RL-" }, { "PA+", "PA-" }, { "IS+", "IS-" } };
    const int permutations[6][3] = { { 0, 1, 2 }, { 0, 2, 1 }, { 1, 0, 2 }, { 1, 2, 0 }, { 2, 0, 1 }, { 2, 1, 0 } };
    const double steps[3] = { 20, 20, 50 }, low[3] = { 0, 0, 0 };
    const uint32_t size[3] = { 4, 3, 2 };
    for (int p = 0; p < 6; p++)
        for (int signs = 0; signs < 8; signs++) {
            const int *axis = permutations[p];
            double high[3];
            for (int a = 0; a < 3; a++)
                high[axis[a]] = size[a] * steps[a];
            char faces[256];
            snprintf(faces, sizeof faces,
                     "RLaxisMin: 0\nRLaxisMax: %g\nPAaxisMin: 0\nPAaxisMax: %g\nISaxisMin: 0\nISaxisMax: %g\n", high[0],
                     high[1], high[2]);
            struct uvh_words w = plain;
            w.faces = faces;
            w.orientation = axis[2] == 0 ? "Sagittal" : axis[2] == 1 ? "Coronal" : "Axial";
            w.column_axis = codes[axis[0]][signs & 1];
            w.row_axis = codes[axis[1]][signs >> 1 & 1];
            w.slice_axis = codes[axis[2]][signs >> 2 & 1];
            struct uvh uvh;
            struct error err;
            struct report report = { 0 };
            assert_true(parse(&w, &uvh, &report, &err));
            assert_int_equal(report.n_lines, 0);
            double rpi[3];
            for (int a = 0; a < 3; a++)
                rpi[axis[a]] = signs >> a & 1 ? high[axis[a]] - steps[a] / 2 : low[axis[a]] + steps[a] / 2;
            assert_point(uvh.grid.lps_mm_from_ijk.origin, rpi[0], -rpi[1], rpi[2], 1e-6);
            uvh_finish(&uvh);
        }
}

static void an_orientation_that_disagrees_with_the_axes_is_reported(void **state)
{
    (void)state;
    struct uvh_words w = plain;
    w.orientation = "Sagittal";
    struct uvh uvh;
    struct error err;
    struct report report = { 0 };
    assert_true(parse(&w, &uvh, &report, &err));
    assert_true(report_has(&report, "geometry.orientation-differs"));
    uvh_finish(&uvh);
    report_finish(&report);
}

static void centimetres_become_millimetres_unless_the_patient_would_be_metres_wide(void **state)
{
    (void)state;
    struct uvh_words w = plain;
    struct uvh uvh;
    struct error err;
    struct report report = { 0 };
    w.unit = "cm"; /* 80 cm: wide, but a couch fits */
    assert_true(parse(&w, &uvh, &report, &err));
    assert_close(grid_spacing_mm(&uvh.grid).x, 200, 1e-9);
    assert_int_equal(report.n_lines, 0);
    uvh_finish(&uvh);
    const char *trap =
        "Version: uvh2.0\nDimensionality: cm\nSliceOrientation:Transverse\nImageColumns: 256\nImageRows: 256\n"
        "ImageSlices: 48\nPixelSizeRows: 1.015620\nPixelSizeColumns: 1.015620\nPixelSizeSlices: 5.499910\n"
        "RLaxisMin: -130\nRLaxisMax: 130\nPAaxisMin: -130\nPAaxisMax: 130\nISaxisMin: -267.7491\n"
        "ISaxisMax: -3.75342\nImageColumnAxis: RL+\nImageRowAxis: PA-\nImageSliceAxis: IS+\n";
    assert_true(uvh_parse((const uint8_t *)trap, strlen(trap), "a.uvh", &uvh, &report, &err));
    assert_close(grid_spacing_mm(&uvh.grid).x, 1.01562, 1e-9);
    assert_true(report_has(&report, "geometry.unit-assumed"));
    uvh_finish(&uvh);
    report_finish(&report);
}

static void a_grid_smaller_than_any_patient_is_reported(void **state)
{
    (void)state;
    const char *text = "uvh1.0\n2\n2\n2\n0.1\n0.1\n0.1\n0\n0\n0\n";
    struct uvh uvh;
    struct error err = { 0 };
    struct report report = { 0 };
    assert_true(uvh_parse((const uint8_t *)text, strlen(text), "a.uvh", &uvh, &report, &err));
    assert_true(report_has(&report, "geometry.unit-doubtful"));
    uvh_finish(&uvh);
    report_finish(&report);
}

static void version_1_is_positional_and_in_centimetres(void **state)
{
    (void)state;
    const char *text =
        "uvh1.0  # version\n 2 # slices\n 4\n 3\n 2.0\n 2.0\n 5.0\n -4.0\n -3.0\n -5.0\n\nuvval 2\n  regionnum 9\n"
        "  bodyname 'left eye'\n";
    struct uvh uvh;
    struct error err = { 0 };
    assert_true(uvh_parse((const uint8_t *)text, strlen(text), "a.uvh", &uvh, NULL, &err));
    assert_int_equal(uvh.grid.size[0], 4);
    assert_int_equal(uvh.grid.size[1], 3);
    assert_int_equal(uvh.grid.size[2], 2);
    /* RL: -40 + 10; PA: row 0 is the most anterior, -30 + 3 * 20 - 10 = 20, P = -20; IS: -50 + 25 */
    assert_point(uvh.grid.lps_mm_from_ijk.origin, -30, -20, -25, 1e-6);
    assert_string_equal(uvh.bodies[0].name, "left eye");
    assert_int_equal(uvh.bodies[0].uvval, 2);
    uvh_finish(&uvh);
}

static void expect_bad_header(const struct uvh_words *w, enum error_code code, const char *said)
{
    struct uvh uvh;
    struct error err;
    if (parse(w, &uvh, NULL, &err) || err.code != code || !strstr(err.text, said) || !strstr(err.text, "a.uvh"))
        fail_msg("%s: %s; expected %s with \"%s\"", error_word(err.code), err.text, error_word(code), said);
}

static void a_broken_header_is_refused_with_its_line(void **state)
{
    (void)state;
    struct uvh_words w = plain;
    w.version = "uvh3.0";
    expect_bad_header(&w, ERROR_FORMAT, "line 3");
    w = plain;
    w.unit = "furlongs";
    expect_bad_header(&w, ERROR_FORMAT, "line 4: Dimensionality is \"furlongs\"");
    w = plain;
    w.orientation = "Oblique";
    expect_bad_header(&w, ERROR_UNSUPPORTED, "oblique");
    w = plain;
    w.row_axis = "RL-";
    expect_bad_header(&w, ERROR_FORMAT, "RL is named for two");
    w.row_axis = "AP+";
    expect_bad_header(&w, ERROR_FORMAT, "ImageRowAxis is \"AP+\"");
    w = plain;
    w.faces = "RLaxisMin: 1\n";
    expect_bad_header(&w, ERROR_FORMAT, "RLaxisMax is missing");
    w = plain;
    w.more = "ImageColumns: 99999\n";
    expect_bad_header(&w, ERROR_FORMAT, "ImageColumns is \"99999\"");
    w.more = "ImageColumns: 1.5\n";
    expect_bad_header(&w, ERROR_FORMAT, "ImageColumns is \"1.5\"");
    w.more = "PixelSizeRows: ********\n";
    expect_bad_header(&w, ERROR_FORMAT, "PixelSizeRows is \"********\"");
    w.more = "PixelSizeRows: nan\n";
    expect_bad_header(&w, ERROR_FORMAT, "PixelSizeRows is \"nan\"");
    w.more = "begin: skull\nregionnum: 1\nend\n";
    expect_bad_header(&w, ERROR_FORMAT, "\"skull\" has no uvval");
    w.more = "begin: skull\nuvval: 256\nend\n";
    expect_bad_header(&w, ERROR_FORMAT, "uvval is \"256\"");
    w.more = "begin: skull\nuvval: 7\n";
    expect_bad_header(&w, ERROR_FORMAT, "ends inside a block");
}

static void univels_must_be_as_many_as_the_header_says(void **state)
{
    (void)state;
    struct uvh uvh;
    struct error err;
    assert_true(parse(&plain, &uvh, NULL, &err));
    uint8_t univels[25] = { 0 };
    univels[23] = 3;
    struct bytes raw = { univels, 24 };
    struct volume *volume = uvh_read_univels(&uvh, &raw, "a.uv", &err);
    assert_int_equal(volume_label(volume, 3, 2, 1), 3); /* columns fastest, then rows, then slices */
    volume_unref(volume);
    struct bytes packed = nifti_bytes_pack(univels, 24);
    volume = uvh_read_univels(&uvh, &packed, "a.uv.gz", &err);
    assert_int_equal(volume_label(volume, 3, 2, 1), 3);
    volume_unref(volume);
    raw.size = 25;
    assert_null(uvh_read_univels(&uvh, &raw, "a.uv", &err));
    assert_non_null(strstr(err.text, "25 bytes"));
    raw.size = 23;
    assert_null(uvh_read_univels(&uvh, &raw, "a.uv", &err));
    assert_int_equal(err.code, ERROR_FORMAT);
    packed.size -= 9;
    assert_null(uvh_read_univels(&uvh, &packed, "a.uv.gz", &err));
    bytes_free(&packed);
    packed = nifti_bytes_pack(univels, 25);
    assert_null(uvh_read_univels(&uvh, &packed, "a.uv.gz", &err));
    bytes_free(&packed);
    uvh_finish(&uvh);
}

static void numbers_are_read_as_fortran_writes_them(void **state)
{
    (void)state;
    double value;
    const struct {
        const char *word;
        double value;
    } good[] = { { ".5E+00", 0.5 },    { "1.0D-3", 0.001 }, { "1.0-101", 1e-101 },
                 { "-1.000E+00", -1 }, { "+7", 7 },         { "2.", 2 } };
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
        assert_true(text_number(good[i].word, &value));
        assert_near(value, good[i].value, 1e-12);
    }
    static const char *const bad[] = { "", "********", "nan", "inf", "1e999", "0x10", "1 2", ".", "-", "1.0-", "--1" };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        assert_false(text_number(bad[i], &value));
}

/* ---- images ----------------------------------------------------------------------------------------------------- */

static const char axial_qhd[] =
    "Patient Name := nobody\nModality := MR\nSlice Orientation := %s\nDimensionality := %s\n"
    "Bytes Per Pixel := %s\nByte Order := big endian\nNumber of Dimensions := 3\n"
    "Size of Dimension[0] := %d\nSize of Dimension[1] := 3\nSize of Dimension[2] := 4\n"
    "X Pixel Size := 20\nY Pixel Size := 30\n%s";

static struct volume *read_image(const char *orientation, const char *unit, const char *depth, int n_slices,
                                 const char *more, const uint8_t *pixels, size_t n, bool *is_doubtful,
                                 struct report *report, struct error *err)
{
    char text[2048];
    struct qhd qhd;
    int length = snprintf(text, sizeof text, axial_qhd, orientation, unit, depth, n_slices, more);
    *err = (struct error){ 0 };
    if (!qhd_parse((const uint8_t *)text, (size_t)length, "a.qhd", &qhd, report, err))
        return NULL;
    struct bytes bytes = { (uint8_t *)(uintptr_t)pixels, n };
    struct volume *volume = qhd_read_pixels(&qhd, &bytes, "a.qhd", "a.qim", is_doubtful, report, err);
    qhd_finish(&qhd);
    return volume;
}

static void an_axial_image_lies_centred_with_row_0_in_front(void **state)
{
    (void)state;
    uint8_t pixels[24] = { 0 };
    pixels[12 + 4 + 2] = 77; /* slice 1, row 1, column 2 */
    bool is_doubtful;
    struct error err;
    struct report report = { 0 };
    struct volume *volume = read_image("Axial", "mm", "1", 2, "Image Location[0] := -10\nImage Location[1] := 40\n",
                                       pixels, 24, &is_doubtful, &report, &err);
    assert_string_equal(err.text, "");
    assert_false(is_doubtful);
    assert_close(volume_value(volume, 2, 1, 1), 77, 0);
    /* RL -40 + 10; PA 45 - 15 = 30, P = -30; the slice position is a centre */
    assert_point(volume->grid.lps_mm_from_ijk.origin, -30, -30, -10, 1e-6);
    assert_point(affine_point(&volume->grid.lps_mm_from_ijk, vec3(3, 2, 1)), 30, 30, 40, 1e-6);
    assert_true(report_has(&report, "geometry.centred"));
    volume_unref(volume);
    report_finish(&report);
}

static void coronal_and_sagittal_images_follow_their_convention(void **state)
{
    (void)state;
    const uint8_t pixels[24] = { 0 };
    const char *where = "Image Location[0] := -10\nImage Location[1] := 40\n";
    bool is_doubtful;
    struct error err;
    /* coronal: columns RL+, rows IS-, slices PA+ */
    struct volume *volume = read_image("Coronal", "mm", "1", 2, where, pixels, 24, &is_doubtful, NULL, &err);
    assert_point(volume->grid.lps_mm_from_ijk.origin, -30, 10, 30, 1e-6);
    assert_point(affine_point(&volume->grid.lps_mm_from_ijk, vec3(1, 1, 1)), -10, -40, 0, 1e-6);
    volume_unref(volume);
    /* sagittal: columns PA-, rows IS-, slices RL+ */
    volume = read_image("Sagittal", "mm", "1", 2, where, pixels, 24, &is_doubtful, NULL, &err);
    assert_point(volume->grid.lps_mm_from_ijk.origin, -10, -30, 30, 1e-6);
    assert_point(affine_point(&volume->grid.lps_mm_from_ijk, vec3(1, 1, 1)), 40, -10, 0, 1e-6);
    volume_unref(volume);
}

static void falling_slice_positions_turn_the_axis(void **state)
{
    (void)state;
    const uint8_t pixels[24] = { 0 };
    bool is_doubtful;
    struct error err;
    struct volume *volume = read_image("Axial", "mm", "1", 2, "Image Location[0] := 40\nImage Location[1] := -10\n",
                                       pixels, 24, &is_doubtful, NULL, &err);
    assert_close(affine_point(&volume->grid.lps_mm_from_ijk, vec3(0, 0, 0)).z, 40, 1e-9);
    assert_close(affine_point(&volume->grid.lps_mm_from_ijk, vec3(0, 0, 1)).z, -10, 1e-9);
    volume_unref(volume);
}

static void the_number_of_bytes_beats_the_header_s_number_of_slices(void **state)
{
    (void)state;
    const uint8_t pixels[36] = { 0 };
    bool is_doubtful;
    struct error err;
    struct report report = { 0 };
    struct volume *volume = read_image("Axial", "mm", "1", 2, "Reference Location := 5\nUniform Spacing := 50\n",
                                       pixels, 36, &is_doubtful, &report, &err);
    assert_int_equal(volume->grid.size[2], 3);
    assert_true(is_doubtful);
    assert_true(report_has(&report, "image.slices-differ"));
    assert_close(affine_point(&volume->grid.lps_mm_from_ijk, vec3(0, 0, 2)).z, 105, 1e-9);
    volume_unref(volume);
    report_finish(&report);
    assert_null(read_image("Axial", "mm", "1", 2, "Reference Location := 5\nUniform Spacing := 50\n", pixels, 35,
                           &is_doubtful, NULL, &err));
    assert_non_null(strstr(err.text, "35 bytes are not whole slices"));
    assert_null(read_image("Axial", "mm", "1", 2, "Reference Location := 5\nUniform Spacing := 50\n", pixels, 0,
                           &is_doubtful, NULL, &err));
}

static void explicit_slice_positions_beat_reference_and_spacing(void **state)
{
    (void)state;
    const uint8_t pixels[24] = { 0 };
    bool is_doubtful;
    struct error err;
    struct report report = { 0 };
    struct volume *volume =
        read_image("Axial", "mm", "1", 2,
                   "Reference Location := 5\nUniform Spacing := 7\nImage Location[0] := -10\nImage Location[1] := 40\n",
                   pixels, 24, &is_doubtful, &report, &err);
    assert_close(volume->grid.lps_mm_from_ijk.origin.z, -10, 1e-9);
    assert_close(grid_spacing_mm(&volume->grid).z, 50, 1e-9);
    assert_true(report_has(&report, "image.locations-differ"));
    volume_unref(volume);
    report_finish(&report);
}

static void uneven_slice_positions_are_refused(void **state)
{
    (void)state;
    const uint8_t pixels[36] = { 0 };
    bool is_doubtful;
    struct error err;
    assert_null(read_image("Axial", "mm", "1", 3,
                           "Image Location[0] := 0\nImage Location[1] := 40\nImage Location[2] := 200\n", pixels, 36,
                           &is_doubtful, NULL, &err));
    assert_int_equal(err.code, ERROR_UNSUPPORTED);
    assert_null(read_image("Axial", "mm", "1", 3,
                           "Image Location[0] := 7\nImage Location[1] := 7\nImage Location[2] := 7\n", pixels, 36,
                           &is_doubtful, NULL, &err));
}

static void two_byte_pixels_follow_the_byte_order_and_inches_are_an_inch(void **state)
{
    (void)state;
    uint8_t pixels[48] = { 0x12, 0x34 };
    bool is_doubtful;
    struct error err;
    struct report report = { 0 };
    struct volume *volume = read_image("Axial", "mm", "2", 2, "Reference Location := 5\nUniform Spacing := 50\n",
                                       pixels, 48, &is_doubtful, NULL, &err);
    assert_int_equal(volume->type, VOXEL_U16);
    assert_close(volume_value(volume, 0, 0, 0), 0x1234, 0);
    volume_unref(volume);
    /* 80 inches wide cannot be: millimetres */
    volume = read_image("Axial", "in", "2", 2, "Reference Location := 5\nUniform Spacing := 50\n", pixels, 48,
                        &is_doubtful, &report, &err);
    assert_close(grid_spacing_mm(&volume->grid).x, 20, 1e-9);
    assert_true(report_has(&report, "geometry.unit-assumed"));
    volume_unref(volume);
    report_finish(&report);
}

/* ---- tracks and hierarchy --------------------------------------------------------------------------------------- */

static void tracks_go_to_lps_and_keep_their_class(void **state)
{
    (void)state;
    const char *text =
        "# header\n   1.0 2.0 3.0  4.0 5.0 6.0  0  3\n 0 0 0 1 0 0 0 1\n 0 0 0 1 0 0 0 2\n 0 0 0 1 0 0  1  0\n"
        "0 0 0 1 1 1 2 0\n0 0 0 2 1 1 3 0\n5 5 5 5 5 5 0 1\n 1 2 3 oops\n 0 0 0 1 0 0 9 0\n";
    struct track_set set = { 0 };
    struct report report = { 0 };
    struct error err = { 0 };
    assert_true(pp_parse((const uint8_t *)text, strlen(text), "a.pp", &set, &report, &err));
    assert_int_equal(set.n_segments, 6);
    assert_close(set.segments[0].from_lps_mm[1], -2, 0); /* PA 2 is P -2 */
    assert_close(set.segments[0].to_lps_mm[2], 6, 0);
    static const uint8_t classes[] = { TRACK_NEUTRON_LOW, TRACK_NEUTRON_HIGH, TRACK_NEUTRON_MEDIUM,
                                       TRACK_GAMMA_HIGH,  TRACK_BEAM_LINE,    TRACK_LOST };
    for (size_t i = 0; i < 6; i++)
        assert_int_equal(set.segments[i].class, classes[i]);
    assert_int_equal(set.n_of_class[TRACK_LOST], 1);
    assert_true(report_has(&report, "tracks.zero-length"));
    assert_true(report_has(&report, "tracks.no-energy"));
    assert_true(report_has(&report, "tracks.bad-lines"));
    track_set_finish(&set);
    report_finish(&report);
    assert_false(pp_parse((const uint8_t *)"hello\n", 6, "a.pp", &set, NULL, &err));
    assert_int_equal(err.code, ERROR_FORMAT);
    track_set_finish(&set);
}

static void the_unit_of_tracks_is_judged_by_the_patient(void **state)
{
    (void)state;
    const struct box3 head = { { -100, -120, -130 }, { 100, 120, 130 } };
    struct track_set set = { 0 };
    struct report report = { 0 };
    struct error err = { 0 };
    const char *cm = "-9 -11 -14 9 10 12 0 1\n 8 -7 3 -5 5 -8 0 2\n";
    assert_true(pp_parse((const uint8_t *)cm, strlen(cm), "a.pp", &set, NULL, &err));
    assert_close(pp_unit_mm(&set, 0, 0, &head, "a.pp", &report), 10, 0);
    assert_true(report_has(&report, "tracks.unit-assumed"));
    assert_close(pp_unit_mm(&set, 0, 1, &head, "a.pp", &report), 1, 0); /* what the plan says stands, with a warning */
    assert_true(report_has(&report, "tracks.unit-doubtful"));
    pp_scale(&set, 0, 10, "t.pp", NULL);
    assert_close(set.segments[0].from_lps_mm[0], -90, 0);
    report_finish(&report);
    assert_close(pp_unit_mm(&set, 0, 0, &head, "a.pp", &report), 1, 0);
    track_set_finish(&set);
    report_finish(&report);
}

static void hierarchy_lines_are_pairs_and_others_are_reported(void **state)
{
    (void)state;
    const char *text = "scalp > brain\n# no\n\nnonsense\n> brain\nbrain>left eye  \n";
    struct plan_file_pair pairs[8];
    struct report report = { 0 };
    assert_int_equal(hierarchy_parse((const uint8_t *)text, strlen(text), "a.info", pairs, 8, &report), 2);
    assert_string_equal(pairs[1].outer, "brain");
    assert_string_equal(pairs[1].inner, "left eye");
    assert_int_equal(report.n_lines, 2);
    report_finish(&report);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_standard_axial_header_puts_row_0_in_front),
        cmocka_unit_test(all_axis_codes_in_all_places_put_the_first_univel_where_the_header_says),
        cmocka_unit_test(an_orientation_that_disagrees_with_the_axes_is_reported),
        cmocka_unit_test(centimetres_become_millimetres_unless_the_patient_would_be_metres_wide),
        cmocka_unit_test(a_grid_smaller_than_any_patient_is_reported),
        cmocka_unit_test(version_1_is_positional_and_in_centimetres),
        cmocka_unit_test(a_broken_header_is_refused_with_its_line),
        cmocka_unit_test(univels_must_be_as_many_as_the_header_says),
        cmocka_unit_test(numbers_are_read_as_fortran_writes_them),
        cmocka_unit_test(an_axial_image_lies_centred_with_row_0_in_front),
        cmocka_unit_test(coronal_and_sagittal_images_follow_their_convention),
        cmocka_unit_test(falling_slice_positions_turn_the_axis),
        cmocka_unit_test(the_number_of_bytes_beats_the_header_s_number_of_slices),
        cmocka_unit_test(explicit_slice_positions_beat_reference_and_spacing),
        cmocka_unit_test(uneven_slice_positions_are_refused),
        cmocka_unit_test(two_byte_pixels_follow_the_byte_order_and_inches_are_an_inch),
        cmocka_unit_test(tracks_go_to_lps_and_keep_their_class),
        cmocka_unit_test(the_unit_of_tracks_is_judged_by_the_patient),
        cmocka_unit_test(hierarchy_lines_are_pairs_and_others_are_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
