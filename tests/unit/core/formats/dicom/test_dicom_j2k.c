/* JPEG 2000 images: made-up ones of every kind, damaged ones, and real ones with published values. */
#include "core/formats/dicom/dicom_j2k.h"

#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/made_j2k.h"
#include "tests/unit/made_series.h"
#include "tests/unit/plan_help.h"

#define TAG DICOM_TAG

static int32_t ramp(uint32_t x, uint32_t y)
{
    return (int32_t)(100 * y + x);
}
static int32_t signed_ramp(uint32_t x, uint32_t y)
{
    return 40 * (int32_t)y - 1000 + (int32_t)x;
}
static int32_t wave(uint32_t x, uint32_t y)
{
    return 2048 + (int32_t)lround(500 * sin(x / 9.0) * cos(y / 7.0));
}

static struct dicom_pixels pixels_of(const struct made_j2k *like, uint32_t allocated)
{
    return (struct dicom_pixels){ .rows = like->rows,
                                  .columns = like->columns,
                                  .n_frames = 1,
                                  .bits_allocated = allocated,
                                  .bits_stored = like->bits,
                                  .high_bit = like->bits - 1,
                                  .is_signed = like->is_signed,
                                  .n_samples = 1 };
}

static void pictures_without_loss_have_their_values_in_every_kind_of_cell(void **state)
{
    (void)state;
    static const struct {
        struct made_j2k like;
        uint32_t allocated;
    } cases[] = { { { 37, 21, 12, false, false, false, 0 }, 16 },
                  { { 37, 21, 16, true, false, false, 0 }, 16 },
                  { { 37, 21, 13, true, false, true, 0 }, 16 },
                  { { 70, 45, 16, false, false, false, 32 }, 16 },
                  { { 37, 21, 20, true, false, false, 0 }, 32 } };
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        const struct made_j2k *like = &cases[c].like;
        int32_t (*value)(uint32_t, uint32_t) = like->is_signed ? signed_ramp : ramp;
        struct dicom_pixels pixels = pixels_of(like, cases[c].allocated);
        struct dicom_decoded decoded;
        struct error err = { 0 };
        size_t size;
        uint8_t *bytes = made_j2k_bytes(like, value, &size);
        int32_t *out = calloc(like->rows * like->columns, sizeof *out);
        if (!dicom_j2k_decode(bytes, size, &pixels, "made", out, &decoded, &err))
            fail_msg("case %zu: %s", c, err.text);
        for (uint32_t y = 0; y < like->rows; y++)
            for (uint32_t x = 0; x < like->columns; x++) {
                size_t i = y * like->columns + x;
                int32_t found = cases[c].allocated == 32 ? out[i]
                                : like->is_signed        ? ((int16_t *)out)[i]
                                                         : ((uint16_t *)out)[i];
                assert_int_equal(found, value(x, y));
            }
        assert_false(decoded.is_lossy);
        assert_int_equal(decoded.is_signed, like->is_signed);
        assert_int_equal(decoded.n_bits, like->bits);
        free(out);
        free(bytes);
    }
}

static void a_picture_with_loss_is_near_and_says_so(void **state)
{
    (void)state;
    const struct made_j2k like = { 128, 96, 12, false, true, false, 0 };
    struct dicom_pixels pixels = pixels_of(&like, 16);
    struct dicom_decoded decoded;
    struct error err = { 0 };
    size_t size;
    uint8_t *bytes = made_j2k_bytes(&like, wave, &size);
    uint16_t *out = calloc(like.rows * like.columns, sizeof *out);
    assert_true(dicom_j2k_decode(bytes, size, &pixels, "made", out, &decoded, &err));
    double sum = 0;
    for (uint32_t y = 0; y < like.rows; y++)
        for (uint32_t x = 0; x < like.columns; x++)
            sum += pow(out[y * like.columns + x] - wave(x, y), 2);
    assert_true(decoded.is_lossy);
    assert_true(sqrt(sum / (like.rows * like.columns)) < 5); /* 1 % of the amplitude, at a quarter of the bytes */
    free(out);
    free(bytes);
}

/* Writes a slice whose pixels are a codestream; sign and bits as given to the data set. */
static void put_slice(const char *folder, const char *name, int number, const struct made_j2k *like,
                      int32_t (*value)(uint32_t, uint32_t), bool says_signed, int says_bits)
{
    struct made_slice slice = made_slice_defaults;
    struct made_dicom made;
    size_t size;
    uint8_t *bytes = made_j2k_bytes(like, value, &size);
    slice.transfer_syntax = like->is_lossy ? "1.2.840.10008.1.2.4.91" : "1.2.840.10008.1.2.4.90";
    slice.rows = (int)like->rows;
    slice.columns = (int)like->columns;
    slice.stored = says_bits;
    slice.is_signed = says_signed;
    slice.number = number;
    slice.position[2] = number;
    made_slice_bytes(&made, &slice);
    made.size -= 12 + 2 * (size_t)(like->rows * like->columns); /* without its pixels */
    made_head(&made, TAG(0x7FE0, 0x0010), "OB", UINT32_MAX);
    made_head(&made, TAG(0xFFFE, 0xE000), "", 0);
    made_head(&made, TAG(0xFFFE, 0xE000), "", (uint32_t)(size + size % 2));
    made_raw(&made, bytes, size);
    if (size % 2)
        made_raw(&made, "", 1);
    made_sequence_end(&made);
    folder_put(folder, name, made.data, made.size);
    made_finish(&made);
    free(bytes);
}

static int32_t as_13_bits(uint32_t x, uint32_t y)
{
    return signed_ramp(x, y) & 0x1FFF;
}

static void the_data_set_says_the_sign_and_the_codestream_the_bits(void **state)
{
    (void)state;
    const struct made_j2k plain = { 20, 10, 13, true, false, false, 0 },
                          other_sign = { 20, 10, 13, false, false, false, 0 };
    for (int way = 0; way < 3; way++) { /* correct; unsigned codestream; other bits in the data set */
        struct scanned s = { 0 };
        folder_make(s.path);
        for (int k = 1; k <= 2; k++)
            put_slice(s.path, k == 1 ? "a" : "b", k, way == 1 ? &other_sign : &plain,
                      way == 1 ? as_13_bits : signed_ramp, true, way == 2 ? 16 : 13);
        scanned_open(&s);
        struct volume *volume = scanned_read(&s, 0);
        for (uint32_t y = 0; y < 10; y++)
            for (uint32_t x = 0; x < 20; x++)
                assert_close(volume_value(volume, x, y, 1), signed_ramp(x, y), 0);
        const char *said = report_said(&s.report, "image.coded-otherwise");
        if (way == 0)
            assert_string_equal(said, "");
        else
            assert_non_null(strstr(
                said,
                way == 1
                    ? "(0028,0103), pixel representation: found 1, but the JPEG 2000 codestream of 2 of 2 slices holds unsigned"
                    : "(0028,0101), bits stored: found 16, but the JPEG 2000 codestream of 2 of 2 slices holds values of 13 bits"));
        volume_unref(volume);
        scanned_finish(&s);
    }
}

static void loss_that_the_file_does_not_mention_is_said(void **state)
{
    (void)state;
    const struct made_j2k like = { 64, 64, 12, false, true, false, 0 };
    struct scanned s = { 0 };
    folder_make(s.path);
    put_slice(s.path, "a", 1, &like, wave, false, 12);
    put_slice(s.path, "b", 2, &like, wave, false, 12);
    scanned_open(&s);
    volume_unref(scanned_read(&s, 0));
    assert_non_null(strstr(report_said(&s.report, "image.lossy"), "2 of 2 slices were compressed with loss"));
    scanned_finish(&s);
}

/* The codestream must be refused, and the error must name what is wrong. */
static void refuse_with(const uint8_t *bytes, size_t size, const struct dicom_pixels *pixels, enum error_code code,
                        const char *words)
{
    uint16_t out[20 * 10];
    struct dicom_decoded decoded;
    struct error err = { 0 };
    assert_false(dicom_j2k_decode(bytes, size, pixels, "made", out, &decoded, &err));
    if (err.code != code || !strstr(err.text, words))
        fail_msg("\"%s\" does not say \"%s\"", err.text, words);
}

static size_t find_marker(const uint8_t *bytes, size_t size, uint8_t marker)
{
    for (size_t i = 0; i + 1 < size; i++)
        if (bytes[i] == 0xFF && bytes[i + 1] == marker)
            return i;
    fail_msg("no marker %02X", marker);
    return 0;
}

static void what_would_take_too_much_or_is_damaged_is_refused_by_name(void **state)
{
    (void)state;
    const struct made_j2k like = { 20, 10, 12, false, false, false, 0 };
    struct dicom_pixels pixels = pixels_of(&like, 16), larger = pixels, narrow = pixels;
    size_t size;
    uint8_t *bytes = made_j2k_bytes(&like, ramp, &size), kept[16];
    size_t cod = find_marker(bytes, size, 0x52), sot = find_marker(bytes, size, 0x90);
    larger.rows = 11;
    narrow.bits_allocated = 8;
    refuse_with(bytes, size, &larger, ERROR_FORMAT, "20 x 10, 1 components of 12 bits; expected 20 x 11");
    refuse_with(bytes, size, &narrow, ERROR_FORMAT, "of 12 bits; expected 20 x 10, 1 of at most 8");
    refuse_with(bytes, 1, &pixels, ERROR_FORMAT, "does not begin with FF 4F");
    refuse_with(bytes, size - 40, &pixels, ERROR_FORMAT, "a tile that is longer than it is");
    const struct made_j2k wide = { 64, 64, 12, false, false, false, 0 };
    size_t wide_size;
    uint8_t *wide_bytes = made_j2k_bytes(&wide, ramp, &wide_size);
    struct dicom_pixels wide_pixels = pixels_of(&wide, 16);
    size_t wide_siz = find_marker(wide_bytes, wide_size, 0x51);
    memcpy(wide_bytes + wide_siz + 2 + 20, "\0\0\0\1\0\0\0\1", 8);
    refuse_with(wide_bytes, wide_size, &wide_pixels, ERROR_LIMIT, "64 x 64 tiles; at most 1024");
    free(wide_bytes);
    memcpy(kept, bytes + cod, 16);
    bytes[cod + 2 + 8] = bytes[cod + 2 + 9] = 9; /* code-blocks of 2^22 */
    refuse_with(bytes, size, &pixels, ERROR_FORMAT, "coding style (COD)");
    memcpy(bytes + cod, kept, 16);
    bytes[cod + 2 + 10] = 0x40;
    refuse_with(bytes, size, &pixels, ERROR_UNSUPPORTED, "high throughput");
    memcpy(bytes + cod, kept, 16);
    bytes[cod + 1] = 0x5F;
    refuse_with(bytes, size, &pixels, ERROR_UNSUPPORTED, "POC");
    memcpy(bytes + cod, kept, 16);
    memset(bytes + sot + 14, 0xFF, size - sot - 16); /* invalid data */
    uint16_t out[200];
    struct dicom_decoded decoded;
    struct error err = { 0 };
    assert_false(dicom_j2k_decode(bytes, size, &pixels, "made", out, &decoded, &err));
    assert_memory_equal(err.text, "made: ", 6);
    free(bytes);
}

/* Layers and precincts that OpenJPEG would visit one by one, from a header of a hundred bytes. */
static void a_small_stream_that_asks_for_much_work_is_refused(void **state)
{
    (void)state;
    const struct made_j2k like = { 512, 512, 12, false, false, false, 0 };
    struct dicom_pixels pixels = pixels_of(&like, 16);
    struct dicom_decoded decoded;
    struct error err = { 0 };
    size_t size;
    uint8_t *bytes = made_j2k_bytes(&like, ramp, &size);
    uint16_t *out = calloc(512 * 512, sizeof *out);
    size_t cod = find_marker(bytes, size, 0x52);
    size_t n = 2 + (size_t)(bytes[cod + 2] << 8 | bytes[cod + 3]);
    uint8_t *fine = malloc(size + 3); /* precincts of 1 x 1 at all three resolutions */
    memcpy(fine, bytes, cod + n);
    fine[cod + 3] = (uint8_t)(fine[cod + 3] + 3);
    fine[cod + 2 + 2] |= 1;
    fine[cod + 2 + 4] = fine[cod + 2 + 5] = 0xFF; /* 65535 layers */
    memset(fine + cod + n, 0x11, 3);
    memcpy(fine + cod + n + 3, bytes + cod + n, size - cod - n);
    assert_false(dicom_j2k_decode(fine, size + 3, &pixels, "made", out, &decoded, &err));
    assert_int_equal(err.code, ERROR_LIMIT);
    assert_non_null(strstr(err.text, "65535 layers"));
    free(fine);
    free(out);
    free(bytes);
}

/* ---- real ones -------------------------------------------------------------------------------------------------- */

static int16_t *read_real(const char *name, size_t *n)
{
    char path[1024], folder[160];
    snprintf(folder, sizeof folder, "dicom-jpeg2000/%s", name);
    if (!data_path(folder, path, sizeof path))
        return NULL;
    size_t size;
    uint8_t *data = file_bytes(path, &size);
    struct error err = { 0 };
    struct dicom_file *file = dicom_file_parse(data, size, name, DICOM_WHOLE, &err);
    struct dicom_pixels pixels;
    assert_non_null(file);
    assert_true(dicom_pixels_look(file, &pixels, &err));
    assert_int_equal(pixels.bits_allocated, 16);
    *n = (size_t)pixels.rows * pixels.columns;
    int16_t *values = malloc(*n * pixels.n_frames * sizeof *values);
    for (uint32_t f = 0; f < pixels.n_frames; f++)
        if (!dicom_pixels_read(file, f, values + f * *n, &err))
            fail_msg("%s", err.text);
    dicom_file_destroy(file);
    free(data);
    return values;
}

static void a_real_mr_is_the_one_it_was_made_of(void **state)
{
    (void)state;
    size_t n, n_expected;
    int16_t *values = read_real("MR_small_jp2klossless.dcm", &n), *expected = read_real("MR_small.dcm", &n_expected);
    if (!values)
        skip();
    assert_int_equal(n, n_expected);
    assert_memory_equal(values, expected, n * sizeof *values);
    free(values);
    free(expected);
}

/* Values that pydicom's authors state for this file in their tests: stored as unsigned, meant as signed. */
static void a_real_ct_whose_codestream_has_the_other_sign_has_its_published_values(void **state)
{
    (void)state;
    static const int16_t down[] = { 621, 412, 138, -193, -520, -767, -907, -966, -988, -995 };
    static const int16_t up[] = { -377, -121, 141, 383, 633, 910, 1198, 1455, 1638, 1732 };
    size_t n;
    int16_t *values = read_real("J2K_pixelrep_mismatch.dcm", &n);
    if (!values)
        skip();
    assert_int_equal(n, 512 * 512);
    assert_int_equal(values[0], -2000);
    for (size_t i = 0; i < 10; i++) {
        assert_int_equal(values[(47 + i) * 512 + 279], down[i]);
        assert_int_equal(values[(328 + i) * 512 + 106], up[i]);
    }
    free(values);
}

static void a_real_picture_with_loss_is_near_the_one_without(void **state)
{
    (void)state;
    size_t n, size;
    char path[1024];
    int16_t *values = read_real("CTImage.dcm_JPEG2000TransferSyntax_1.2.840.10008.1.2.4.91.dcm", &n);
    if (!values ||
        !data_path("dicom-transfer-syntaxes/CTImage.dcm_LittleEndianExplicitTransferSyntax_1.2.840.10008.1.2.1.dcm",
                   path, sizeof path))
        skip();
    uint8_t *data = file_bytes(path, &size);
    struct error err = { 0 };
    struct dicom_file *file = dicom_file_parse(data, size, "whole", DICOM_WHOLE, &err);
    int16_t *expected = malloc(n * sizeof *expected);
    assert_true(dicom_pixels_read(file, 0, expected, &err));
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += pow(values[i] - expected[i], 2);
    printf("root mean square difference: %.2f HU\n", sqrt(sum / (double)n));
    assert_true(sqrt(sum / (double)n) < 30); /* of 4000 HU: compressed for viewing */
    free(expected);
    dicom_file_destroy(file);
    free(data);
    free(values);
}

/* Two frames in 11 fragments without an offset table: each frame begins where a fragment begins with an image's start
 * marker. */
static void frames_of_a_real_enhanced_ct_in_11_fragments_are_both_read(void **state)
{
    (void)state;
    size_t n;
    int16_t *values = read_real("CT0012.fragmented_no_bot_jpeg_baseline.51.dcm", &n);
    if (!values)
        skip();
    double sum = 0, norm[2] = { 0, 0 };
    for (size_t i = 0; i < n; i++) {
        sum += fabs((double)values[i] - values[n + i]);
        norm[0] += values[i];
        norm[1] += values[n + i];
    }
    assert_true(norm[0] > 0 && norm[1] > 0 && sum > 0); /* neighbouring frames are similar, but not equal */
    assert_true(sum < 0.5 * (norm[0] + norm[1]));
    free(values);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_without_loss_have_their_values_in_every_kind_of_cell),
        cmocka_unit_test(a_picture_with_loss_is_near_and_says_so),
        cmocka_unit_test(the_data_set_says_the_sign_and_the_codestream_the_bits),
        cmocka_unit_test(loss_that_the_file_does_not_mention_is_said),
        cmocka_unit_test(what_would_take_too_much_or_is_damaged_is_refused_by_name),
        cmocka_unit_test(a_small_stream_that_asks_for_much_work_is_refused),
        cmocka_unit_test(a_real_mr_is_the_one_it_was_made_of),
        cmocka_unit_test(a_real_ct_whose_codestream_has_the_other_sign_has_its_published_values),
        cmocka_unit_test(a_real_picture_with_loss_is_near_the_one_without),
        cmocka_unit_test(frames_of_a_real_enhanced_ct_in_11_fragments_are_both_read),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
