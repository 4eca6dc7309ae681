/* Reading NIfTI 1 and 2: geometry, data types, scaling, packed files, damaged files. */
#include "core/formats/nifti.h"
#include "tests/check.h"
#include "tests/unit/nifti_bytes.h"
#include "tests/unit/plan_help.h"

enum {
    U8 = 2,
    I16 = 4,
    I32 = 8,
    F32 = 16,
    F64 = 64,
    I8 = 256,
    U16 = 512,
    U32 = 768,
    I64 = 1024,
    U64 = 1280,
    RGB = 128
};

static const double identity_ras[3][4] = { { 1, 0, 0, 0 }, { 0, 1, 0, 0 }, { 0, 0, 1, 0 } };

static struct volume *read_from(const struct nifti_bytes *file, enum raw_use use, struct report *report,
                                struct error *err)
{
    struct bytes bytes = { file->data, file->size };
    *err = (struct error){ 0 };
    return nifti_read(&bytes, "a.nii", use, report, err);
}

static void the_sform_becomes_patient_lps(void **state)
{
    (void)state;
    /* i grows to the anterior, j to the superior, k to the left side: RAS columns (0,2,0), (0,0,3), (-4,0,0) */
    const double rows[3][4] = { { 0, 0, -4, 10 }, { 2, 0, 0, 20 }, { 0, 3, 0, 30 } };
    struct nifti_bytes file = nifti_bytes_make(2, 3, 4, U8, 8, 24, false);
    nifti_put_sform(&file, rows);
    struct error err;
    struct volume *volume = read_from(&file, RAW_IMAGE, NULL, &err);
    assert_non_null(volume);
    /* by hand: RAS (10 - 4*3, 20 + 2*1, 30 + 3*2) = (-2, 22, 36), so LPS (2, -22, 36) */
    assert_point(affine_point(&volume->grid.lps_mm_from_ijk, vec3(1, 2, 3)), 2, -22, 36, 1e-4);
    int sign;
    assert_int_equal(grid_index_axis(&volume->grid, 0, &sign), 2); /* L along k */
    assert_int_equal(sign, 1);
    assert_int_equal(grid_index_axis(&volume->grid, 1, &sign), 0); /* P along i, against it */
    assert_int_equal(sign, -1);
    volume_unref(volume);
    nifti_bytes_free(&file);
}

static void the_qform_is_a_rotation_with_a_sign_for_k(void **state)
{
    (void)state;
    /* Half a turn about S: quaternion (0, 0, 0, 1): RAS x = -i, y = -j; qfac -1 turns k downward. */
    struct nifti_bytes file = nifti_bytes_make(2, 2, 2, U8, 8, 8, false);
    nifti_put_i16(&file, 252, 1);
    nifti_put_f32(&file, 264, 1); /* quatern_d */
    nifti_put_f32(&file, 268, 5); /* qoffset x, y, z */
    nifti_put_f32(&file, 272, 6);
    nifti_put_f32(&file, 276, 7);
    nifti_put_f32(&file, 76, -1); /* qfac */
    nifti_put_f32(&file, 80, 2);
    nifti_put_f32(&file, 84, 3);
    nifti_put_f32(&file, 88, 4);
    struct error err;
    struct volume *volume = read_from(&file, RAW_IMAGE, NULL, &err);
    assert_non_null(volume);
    /* RAS of (1,1,1): (5 - 2, 6 - 3, 7 - 4) = (3, 3, 3); LPS (-3, -3, 3) */
    assert_point(affine_point(&volume->grid.lps_mm_from_ijk, vec3(1, 1, 1)), -3, -3, 3, 1e-4);
    volume_unref(volume);
    /* A quarter turn about S: (0, 0, sin 45): i goes to RAS +y. */
    nifti_put_f32(&file, 264, sqrt(0.5));
    volume = read_from(&file, RAW_IMAGE, NULL, &err);
    assert_point(affine_point(&volume->grid.lps_mm_from_ijk, vec3(1, 0, 0)), -5, -8, 7, 1e-4);
    volume_unref(volume);
    nifti_bytes_free(&file);
}

/* A qform of identity with code 1 beside an sform with another code: two spaces may be turned against each other, but
 * not put the sides differently. */
static void sform_and_qform_that_put_the_sides_differently_are_said(void **state)
{
    (void)state;
    static const struct {
        double rows[3][4];
        const char *said; /* NULL: nothing */
    } cases[] = {
        { { { 1, 0, 0, 0 }, { 0, 1, 0, 0 }, { 0, 0, 1, 0 } }, NULL },
        { { { 0.98, -0.17, 0, 30 }, { 0.17, 0.98, 0, 20 }, { 0, 0, 1, 0 } }, NULL },
        { { { -1, 0, 0, 90 }, { 0, 1, 0, 0 }, { 0, 0, 1, 0 } },
          "axis 1 runs to the patient's left by sform, to the right" },
        { { { -1, 0, 0, 9 }, { 0, -1, 0, 9 }, { 0, 0, 1, 0 } }, "axis 1 runs to the patient's left by sform" },
        { { { 1, 0, 0, 0 }, { 0, 1, 0, 0 }, { 0, 0, -1, 0 } }, "axis 3 runs to the patient's inferior by sform" },
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct nifti_bytes file = nifti_bytes_make(2, 2, 2, U8, 8, 8, false);
        struct report report = { 0 };
        struct error err;
        nifti_put_sform(&file, cases[i].rows);
        nifti_put_i16(&file, 252, 1); /* qform_code */
        nifti_put_i16(&file, 254, 2); /* sform_code */
        struct volume *volume = read_from(&file, RAW_IMAGE, &report, &err);
        assert_non_null(volume);
        const char *said = report_said(&report, "geometry.forms-disagree");
        if (cases[i].said ? !strstr(said, cases[i].said) : said[0] != 0)
            fail_msg("case %zu: \"%s\"", i, said);
        volume_unref(volume);
        report_finish(&report);
        nifti_bytes_free(&file);
    }
}

static void an_sform_of_zeros_gives_way_to_the_qform(void **state)
{
    (void)state;
    static const double zeros[3][4] = { { 0 } };
    struct nifti_bytes file = nifti_bytes_make(2, 2, 2, U8, 8, 8, false);
    struct report report = { 0 };
    struct error err;
    nifti_put_sform(&file, zeros);
    struct volume *volume = read_from(&file, RAW_IMAGE, NULL, &err);
    assert_null(volume); /* without a qform nothing is left */
    nifti_put_i16(&file, 252, 1);
    nifti_put_f32(&file, 268, 100); /* qoffset_x */
    volume = read_from(&file, RAW_IMAGE, &report, &err);
    assert_string_equal(err.text, "");
    assert_point(volume->grid.lps_mm_from_ijk.origin, -100, 0, 0, 1e-4);
    assert_non_null(strstr(report_said(&report, "geometry.forms-disagree"), "all 0"));
    volume_unref(volume);
    report_finish(&report);
    nifti_bytes_free(&file);
}

static void the_sform_wins_and_a_missing_orientation_is_said(void **state)
{
    (void)state;
    struct nifti_bytes file = nifti_bytes_make(2, 2, 2, U8, 8, 8, false);
    struct report report = { 0 };
    struct error err;
    struct volume *volume = read_from(&file, RAW_IMAGE, &report, &err);
    assert_non_null(volume);
    assert_true(report_has(&report, "geometry.assumed"));
    volume_unref(volume);
    report_finish(&report);
    nifti_put_sform(&file, identity_ras);
    nifti_put_i16(&file, 252, 1);
    nifti_put_f32(&file, 268, 100);
    volume = read_from(&file, RAW_IMAGE, &report, &err);
    assert_point(volume->grid.lps_mm_from_ijk.origin, 0, 0, 0, 1e-4);
    assert_true(report_has(&report, "geometry.forms-disagree"));
    volume_unref(volume);
    report_finish(&report);
    nifti_bytes_free(&file);
}

static void metres_and_microns_become_millimetres(void **state)
{
    (void)state;
    const double rows[3][4] = { { 0.002, 0, 0, 0.1 }, { 0, 0.002, 0, 0 }, { 0, 0, 0.002, 0 } };
    struct nifti_bytes file = nifti_bytes_make(2, 2, 2, U8, 8, 8, false);
    nifti_put_sform(&file, rows);
    file.data[123] = 1;
    struct error err;
    struct volume *volume = read_from(&file, RAW_IMAGE, NULL, &err);
    assert_close(grid_spacing_mm(&volume->grid).x, 2, 1e-6);
    assert_close(volume->grid.lps_mm_from_ijk.origin.x, -100, 1e-4);
    volume_unref(volume);
    nifti_bytes_free(&file);
}

/* One file of 1 x 1 x 2 voxels of a type, with the two stored values given as raw bytes by put. */
static void check_type(int datatype, int bytes, double first, double second, enum voxel_type expected, bool is_big)
{
    struct nifti_bytes file = nifti_bytes_make(1, 1, 2, datatype, 8 * bytes, 2 * (size_t)bytes, is_big);
    nifti_put_sform(&file, identity_ras);
    const double values[2] = { first, second };
    for (size_t i = 0; i < 2; i++) {
        size_t at = 352 + i * (size_t)bytes;
        if (datatype == F32)
            nifti_put_f32(&file, at, values[i]);
        else if (datatype == F64)
            nifti_put_f64(&file, at, values[i]);
        else if (bytes == 1)
            file.data[at] = (uint8_t)(int)values[i];
        else if (bytes == 2)
            nifti_put_i16(&file, at, (int)values[i]);
        else if (bytes == 4)
            nifti_put_i32(&file, at, (int64_t)values[i]);
        else
            nifti_put_i64(&file, at, (int64_t)values[i]);
    }
    struct error err;
    struct volume *volume = read_from(&file, RAW_IMAGE, NULL, &err);
    assert_string_equal(err.text, "");
    assert_int_equal(volume->type, expected);
    assert_close(volume_value(volume, 0, 0, 0), first, 1e-6 * fabs(first));
    assert_close(volume_value(volume, 0, 0, 1), second, 1e-6 * fabs(second));
    assert_close(volume->low, fmin(first, second), 1e-6 * fabs(first) + 1e-6);
    assert_close(volume->high, fmax(first, second), 1e-6 * fabs(second) + 1e-6);
    volume_unref(volume);
    nifti_bytes_free(&file);
}

static void every_real_data_type_is_read_in_both_byte_orders(void **state)
{
    (void)state;
    for (int big = 0; big < 2; big++) {
        check_type(U8, 1, 0, 255, VOXEL_U8, big);
        check_type(I8, 1, -128, 127, VOXEL_I16, big);
        check_type(I16, 2, -1024, 3071, VOXEL_I16, big);
        check_type(U16, 2, 0, 65535, VOXEL_U16, big);
        check_type(U16, 2, 0, 200, VOXEL_U8, big);
        check_type(I32, 4, -1024, 3071, VOXEL_I16, big);
        check_type(I32, 4, -100000, 7, VOXEL_F32, big);
        check_type(U32, 4, 0, 40000, VOXEL_U16, big);
        check_type(U32, 4, 0, 4000000000.0, VOXEL_F32, big);
        check_type(I64, 8, -5, 5, VOXEL_I16, big);
        check_type(U64, 8, 1, 2, VOXEL_U8, big);
        check_type(F32, 4, -0.25, 1.5, VOXEL_F32, big);
        check_type(F64, 8, -0.25, 1.5e10, VOXEL_F32, big);
    }
}

static void scaling_is_applied_and_a_slope_of_zero_is_none(void **state)
{
    (void)state;
    struct nifti_bytes file = nifti_bytes_make(1, 1, 2, I16, 16, 4, false);
    nifti_put_sform(&file, identity_ras);
    nifti_put_i16(&file, 352, 10);
    nifti_put_i16(&file, 354, 30);
    nifti_put_f32(&file, 112, -2);
    nifti_put_f32(&file, 116, 100);
    struct error err;
    struct volume *volume = read_from(&file, RAW_IMAGE, NULL, &err);
    assert_close(volume_value(volume, 0, 0, 0), 80, 0);
    assert_close(volume->low, 40, 0);
    assert_close(volume->high, 80, 0);
    volume_unref(volume);
    nifti_put_f32(&file, 112, 0);
    volume = read_from(&file, RAW_IMAGE, NULL, &err);
    assert_close(volume_value(volume, 0, 0, 0), 10, 0);
    volume_unref(volume);
    nifti_bytes_free(&file);
}

static void labels_are_whole_numbers_and_others_are_refused_with_their_place(void **state)
{
    (void)state;
    struct nifti_bytes file = nifti_bytes_make(2, 2, 2, F32, 32, 32, false);
    nifti_put_sform(&file, identity_ras);
    for (size_t i = 0; i < 8; i++)
        nifti_put_f32(&file, 352 + 4 * i, (double)i * 40);
    struct error err;
    struct volume *volume = read_from(&file, RAW_LABELS, NULL, &err);
    assert_non_null(volume);
    assert_int_equal(volume->type, VOXEL_U16); /* 280 does not fit a byte */
    assert_int_equal(volume_label(volume, 1, 1, 1), 280);
    volume_unref(volume);
    const struct {
        double value;
        const char *said;
    } bad[] = { { -1, "is -1" }, { 0.5, "is 0.5" }, { 65536, "is 65536" }, { NAN, "is " } };
    for (size_t i = 0; i < 4; i++) {
        nifti_put_f32(&file, 352 + 4 * 5, bad[i].value);
        assert_null(read_from(&file, RAW_LABELS, NULL, &err));
        assert_int_equal(err.code, ERROR_RANGE);
        assert_non_null(strstr(err.text, "a.nii: voxel (1, 0, 1)"));
        assert_non_null(strstr(err.text, bad[i].said));
    }
    nifti_bytes_free(&file);
}

static void a_mask_counts_half_and_more_as_inside(void **state)
{
    (void)state;
    struct nifti_bytes file = nifti_bytes_make(4, 1, 1, F32, 32, 16, false);
    nifti_put_sform(&file, identity_ras);
    const double values[4] = { 0, 0.4, 0.6, NAN };
    for (size_t i = 0; i < 4; i++)
        nifti_put_f32(&file, 352 + 4 * i, values[i]);
    struct report report = { 0 };
    struct error err;
    struct volume *mask = read_from(&file, RAW_MASK, &report, &err);
    const uint8_t expected[4] = { 0, 0, 1, 0 };
    assert_memory_equal(mask->voxels, expected, 4);
    assert_true(report_has(&report, "mask.fractional"));
    volume_unref(mask);
    report_finish(&report);
    nifti_bytes_free(&file);
}

static void packed_files_are_read_also_in_several_members_and_with_more_behind(void **state)
{
    (void)state;
    struct nifti_bytes file = nifti_bytes_make(4, 4, 4, U8, 8, 64 + 100, false);
    nifti_put_sform(&file, identity_ras);
    for (size_t i = 0; i < 64; i++)
        file.data[352 + i] = (uint8_t)(3 * i);
    struct error err = { 0 };
    struct bytes whole = nifti_bytes_pack(file.data, file.size);
    struct volume *volume = nifti_read(&whole, "a.nii.gz", RAW_IMAGE, NULL, &err);
    assert_non_null(volume);
    assert_close(volume_value(volume, 3, 3, 3), 189, 0);
    volume_unref(volume);
    struct bytes head = nifti_bytes_pack(file.data, 100), tail = nifti_bytes_pack(file.data + 100, 352 + 64 - 100);
    struct bytes both = { malloc(head.size + tail.size), head.size + tail.size };
    memcpy(both.data, head.data, head.size);
    memcpy(both.data + head.size, tail.data, tail.size);
    volume = nifti_read(&both, "a.nii.gz", RAW_IMAGE, NULL, &err);
    assert_string_equal(err.text, "");
    assert_close(volume_value(volume, 3, 3, 3), 189, 0);
    volume_unref(volume);
    whole.size -= 30; /* cut */
    assert_null(nifti_read(&whole, "a.nii.gz", RAW_IMAGE, NULL, &err));
    assert_int_equal(err.code, ERROR_FORMAT);
    bytes_free(&whole);
    bytes_free(&head);
    bytes_free(&tail);
    bytes_free(&both);
    nifti_bytes_free(&file);
}

static void a_packed_file_with_a_wrong_checksum_is_refused(void **state)
{
    (void)state;
    struct nifti_bytes file = nifti_bytes_make(4, 4, 4, U8, 8, 64, false);
    nifti_put_sform(&file, identity_ras);
    struct bytes packed = nifti_bytes_pack(file.data, file.size);
    packed.data[packed.size - 6] ^= 1; /* the checksum is the last eight bytes' first half */
    struct error err = { 0 };
    assert_null(nifti_read(&packed, "a.nii.gz", RAW_IMAGE, NULL, &err));
    assert_int_equal(err.code, ERROR_FORMAT);
    assert_non_null(strstr(err.text, "checksum"));
    bytes_free(&packed);
    nifti_bytes_free(&file);
}

static void numbers_of_a_header_that_are_none_are_refused_or_said(void **state)
{
    (void)state;
    enum { PIXDIM = 76, SLOPE = 112, QFORM = 252, QUATERN = 256, SROW = 280 };
    static const struct {
        size_t at;
        double value;
        bool is_qform;
        const char *code, *said; /* code NULL: refused with the words */
    } cases[] = { { SLOPE, NAN, false, "image.rescale", "scl_slope is nan" },
                  { SLOPE, INFINITY, false, "image.rescale", "scl_slope is inf" },
                  { PIXDIM + 8, 0, true, "geometry.assumed", "pixdim[2], the size of a voxel, is 0; 1 was taken" },
                  { PIXDIM + 12, NAN, true, "geometry.assumed", "pixdim[3]" },
                  { PIXDIM + 4, -3, true, "geometry.assumed", "pixdim[1], the size of a voxel, is -3" },
                  { PIXDIM + 4, INFINITY, true, NULL, "qform" },
                  { QUATERN + 4, 2, true, NULL, "the sum of their squares is 4, expected 1 or less" },
                  { QUATERN, NAN, true, NULL, "expected 1 or less" },
                  { SROW + 4, NAN, false, NULL, "sform" },
                  { SROW + 12, INFINITY, false, NULL, "sform" } };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct nifti_bytes file = nifti_bytes_make(2, 2, 2, U8, 8, 8, false);
        struct report report = { 0 };
        struct error err = { 0 };
        if (cases[i].is_qform)
            nifti_put_i16(&file, QFORM, 1);
        else
            nifti_put_sform(&file, identity_ras);
        nifti_put_f32(&file, cases[i].at, cases[i].value);
        struct volume *volume = read_from(&file, RAW_IMAGE, &report, &err);
        const char *said = cases[i].code ? report_said(&report, cases[i].code) : err.text;
        if ((volume != NULL) != (cases[i].code != NULL) || !strstr(said, cases[i].said))
            fail_msg("case %zu: \"%s\" and \"%s\" do not say \"%s\"", i, err.text, said, cases[i].said);
        volume_unref(volume);
        report_finish(&report);
        nifti_bytes_free(&file);
    }
}

static void nifti_2_is_read(void **state)
{
    (void)state;
    for (int big = 0; big < 2; big++) {
        struct nifti_bytes file = { .size = 544 + 2, .is_big = big };
        file.data = calloc(file.size, 1);
        nifti_put_i32(&file, 0, 540);
        memcpy(file.data + 4, "n+2\0\r\n\032\n", 8);
        nifti_put_i16(&file, 12, U8);
        nifti_put_i16(&file, 14, 8);
        nifti_put_i64(&file, 16, 3);
        nifti_put_i64(&file, 24, 2);
        nifti_put_i64(&file, 32, 1);
        nifti_put_i64(&file, 40, 1);
        nifti_put_i64(&file, 168, 544);
        nifti_put_i32(&file, 348, 1); /* sform_code */
        for (size_t i = 0; i < 3; i++)
            nifti_put_f64(&file, 400 + 32 * i + 8 * i, 2.5);
        nifti_put_i32(&file, 500, 2);
        file.data[545] = 9;
        struct error err;
        struct volume *volume = read_from(&file, RAW_IMAGE, NULL, &err);
        assert_string_equal(err.text, "");
        assert_close(volume_value(volume, 1, 0, 0), 9, 0);
        assert_point(affine_point(&volume->grid.lps_mm_from_ijk, vec3(1, 0, 0)), -2.5, 0, 0, 1e-4);
        volume_unref(volume);
        nifti_bytes_free(&file);
    }
}

static void expect_refusal(const struct nifti_bytes *file, enum error_code code, const char *said)
{
    struct error err;
    assert_null(read_from(file, RAW_IMAGE, NULL, &err));
    if (err.code != code || !strstr(err.text, said) || !strstr(err.text, "a.nii"))
        fail_msg("%s: %s; expected %s with \"%s\"", error_word(err.code), err.text, error_word(code), said);
}

static void what_is_broken_is_refused_with_a_sentence(void **state)
{
    (void)state;
    struct nifti_bytes file = nifti_bytes_make(2, 2, 2, U8, 8, 8, false);
    nifti_put_sform(&file, identity_ras);
    file.size = 352 + 7;
    expect_refusal(&file, ERROR_FORMAT, "cut short");
    file.size = 100;
    expect_refusal(&file, ERROR_FORMAT, "100 bytes");
    file.size = 0;
    expect_refusal(&file, ERROR_FORMAT, "0 bytes");
    file.size = 360;
    file.data[345] = '*';
    expect_refusal(&file, ERROR_FORMAT, "byte 344");
    memcpy(file.data + 344, "ni1", 4);
    expect_refusal(&file, ERROR_FORMAT, ".img");
    memcpy(file.data + 344, "n+1", 4);
    nifti_put_i32(&file, 0, 347);
    expect_refusal(&file, ERROR_FORMAT, "not a NIfTI file");
    nifti_put_i32(&file, 0, 348);
    nifti_put_i16(&file, 70, RGB);
    expect_refusal(&file, ERROR_UNSUPPORTED, "colour");
    nifti_put_i16(&file, 70, I16);
    expect_refusal(&file, ERROR_FORMAT, "bitpix");
    nifti_put_i16(&file, 70, U8);
    nifti_put_i16(&file, 42, 32767);
    expect_refusal(&file, ERROR_LIMIT, "dim[1] is 32767");
    nifti_put_i16(&file, 42, -2);
    expect_refusal(&file, ERROR_FORMAT, "dim[1] is -2");
    nifti_put_i16(&file, 42, 4096);
    nifti_put_i16(&file, 44, 4096);
    nifti_put_i16(&file, 46, 4096);
    expect_refusal(&file, ERROR_LIMIT, "4096 x 4096 x 4096");
    nifti_put_i16(&file, 42, 2);
    nifti_put_i16(&file, 44, 2);
    nifti_put_i16(&file, 46, 2);
    nifti_put_i16(&file, 40, 5);
    nifti_put_i16(&file, 48, 1);
    nifti_put_i16(&file, 50, 3);
    expect_refusal(&file, ERROR_UNSUPPORTED, "dim[5] is 3");
    nifti_put_i16(&file, 50, 1);
    struct error err;
    struct volume *volume = read_from(&file, RAW_IMAGE, NULL, &err); /* trailing ones do no harm */
    assert_non_null(volume);
    volume_unref(volume);
    nifti_put_i16(&file, 40, 0);
    expect_refusal(&file, ERROR_FORMAT, "dim[0]");
    nifti_put_i16(&file, 40, 3);
    nifti_put_f32(&file, 284, NAN);
    expect_refusal(&file, ERROR_RANGE, "sform");
    nifti_put_f32(&file, 284, 0);
    nifti_put_f32(&file, 280, 0); /* a column of zeros */
    expect_refusal(&file, ERROR_RANGE, "sform");
    nifti_put_f32(&file, 280, 1);
    nifti_put_f32(&file, 108, 10);
    expect_refusal(&file, ERROR_FORMAT, "vox_offset");
    nifti_put_f32(&file, 108, NAN);
    expect_refusal(&file, ERROR_FORMAT, "vox_offset");
    nifti_bytes_free(&file);
}

static void a_small_packed_file_that_claims_gigabytes_is_refused_before_memory_is_asked_for(void **state)
{
    (void)state;
    struct nifti_bytes file = nifti_bytes_make(1024, 1024, 1024, U8, 8, 64, false);
    nifti_put_sform(&file, identity_ras);
    struct bytes packed = nifti_bytes_pack(file.data, file.size);
    struct error err = { 0 };
    assert_null(nifti_read(&packed, "a.nii.gz", RAW_IMAGE, NULL, &err));
    assert_int_equal(err.code, ERROR_FORMAT);
    assert_non_null(strstr(err.text, "cut short"));
    bytes_free(&packed);
    nifti_bytes_free(&file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_sform_becomes_patient_lps),
        cmocka_unit_test(the_qform_is_a_rotation_with_a_sign_for_k),
        cmocka_unit_test(sform_and_qform_that_put_the_sides_differently_are_said),
        cmocka_unit_test(an_sform_of_zeros_gives_way_to_the_qform),
        cmocka_unit_test(the_sform_wins_and_a_missing_orientation_is_said),
        cmocka_unit_test(metres_and_microns_become_millimetres),
        cmocka_unit_test(every_real_data_type_is_read_in_both_byte_orders),
        cmocka_unit_test(scaling_is_applied_and_a_slope_of_zero_is_none),
        cmocka_unit_test(labels_are_whole_numbers_and_others_are_refused_with_their_place),
        cmocka_unit_test(a_mask_counts_half_and_more_as_inside),
        cmocka_unit_test(packed_files_are_read_also_in_several_members_and_with_more_behind),
        cmocka_unit_test(a_packed_file_with_a_wrong_checksum_is_refused),
        cmocka_unit_test(numbers_of_a_header_that_are_none_are_refused_or_said),
        cmocka_unit_test(nifti_2_is_read),
        cmocka_unit_test(what_is_broken_is_refused_with_a_sentence),
        cmocka_unit_test(a_small_packed_file_that_claims_gigabytes_is_refused_before_memory_is_asked_for),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
