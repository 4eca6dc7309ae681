/* The header before each picture, as proto/frame.md describes it. */
#include "server/wire/frame_header.h"
#include "tests/check.h"

static struct frame_header sample(void)
{
    struct frame_header header = { .codec = 1,
                                   .flags = FRAME_STILL | FRAME_SHARED,
                                   .quality = 92,
                                   .scale_percent = 100,
                                   .view = 3,
                                   .sequence = 0x01020304,
                                   .scene_revision = 42,
                                   .input_id = 0xfffffffe,
                                   .width_px = 1024,
                                   .height_px = 768,
                                   .render_us = 20000,
                                   .encode_us = 3000,
                                   .payload_bytes = 5,
                                   .pixels_per_mm_1000 = 2500 };
    for (int i = 0; i < 16; i++)
        header.clip_from_lps_mm[i] = (float)i * 0.5f;
    return header;
}

/* Offsets and byte order as the table in proto/frame.md gives them. */
static void a_header_has_the_bytes_the_description_says(void **state)
{
    (void)state;
    uint8_t bytes[FRAME_HEADER_BYTES + 5] = { 0 };
    struct frame_header header = sample(), back;
    frame_header_write(&header, bytes);
    assert_memory_equal(bytes, "BRMR", 4);
    assert_int_equal(bytes[4] | bytes[5] << 8, 1);
    assert_int_equal(bytes[6] | bytes[7] << 8, 112);
    assert_int_equal(bytes[16], 4); /* least byte first */
    assert_int_equal(bytes[19], 1);
    assert_int_equal(bytes[28] | bytes[29] << 8, 1024);
    const uint8_t half[4] = { 0, 0, 0, 0x3f }; /* IEEE 754: 0.5f = 0x3f000000 */
    assert_memory_equal(bytes + 52, half, 4);
    struct error err = { 0 };
    size_t start;
    assert_true(frame_header_read(bytes, sizeof bytes, &back, &start, &err));
    assert_int_equal(start, 112);
    assert_memory_equal(&header, &back, sizeof header);
}

/* Where a point lies in a header's picture, in pixels from its left and top. */
static void place(const struct frame_header *header, const double point[3], double px[2])
{
    const float *m = header->clip_from_lps_mm;
    double clip[4];
    for (int row = 0; row < 4; row++)
        clip[row] = (double)m[row] * point[0] + (double)m[4 + row] * point[1] + (double)m[8 + row] * point[2] +
                    (double)m[12 + row];
    px[0] = (clip[0] / clip[3] + 1) / 2 * header->width_px;
    px[1] = (1 - clip[1] / clip[3]) / 2 * header->height_px;
}

/* A pixel of a picture reduced by d covers d pixels of the whole one, from the left and from the top on. */
static void a_point_lies_in_a_reduced_picture_where_it_lies_in_the_whole(void **state)
{
    (void)state;
    static const int sides[][2] = { { 1024, 768 }, { 1441, 901 }, { 803, 17 }, { 5, 3 } };
    static const float perspective[16] = { 1.5f, 0.1f, 0.2f, 0.3f, 0.2f, 2.0f,  0.1f, 0.4f,
                                           0.0f, 0.3f, 1.0f, 0.1f, 3.0f, -5.0f, 2.0f, 90.0f };
    const double points[][3] = { { 0, 0, 0 }, { 20, -30, 10 }, { -25, 12, 40 } };
    for (size_t i = 0; i < sizeof sides / sizeof sides[0]; i++)
        for (int divisor = 2; divisor <= 4; divisor += 2) {
            struct frame_header whole = sample();
            whole.width_px = (uint16_t)sides[i][0];
            whole.height_px = (uint16_t)sides[i][1];
            memcpy(whole.clip_from_lps_mm, perspective, sizeof perspective);
            const struct frame_header reduced = frame_header_reduced(&whole, divisor);
            assert_int_equal(reduced.width_px, ceil(sides[i][0] / (double)divisor));
            assert_int_equal(reduced.height_px, ceil(sides[i][1] / (double)divisor));
            assert_int_equal(reduced.flags, whole.flags | (divisor == 2 ? 32 : 64));
            assert_int_equal(reduced.scale_percent, whole.scale_percent);
            for (size_t p = 0; p < 3; p++) {
                double expected[2], is[2];
                place(&whole, points[p], expected);
                place(&reduced, points[p], is);
                assert_close(is[0] * divisor, expected[0], 1e-3); /* floats of pictures of a thousand pixels */
                assert_close(is[1] * divisor, expected[1], 1e-3);
            }
            if (sides[i][0] % divisor == 0 && sides[i][1] % divisor == 0)
                assert_memory_equal(reduced.clip_from_lps_mm, whole.clip_from_lps_mm, sizeof perspective);
        }
}

static void expect_refused(size_t at, uint8_t value, size_t n)
{
    uint8_t bytes[FRAME_HEADER_BYTES + 5] = { 0 };
    struct frame_header header = sample(), back;
    frame_header_write(&header, bytes);
    bytes[at] = value;
    struct error err = { 0 };
    size_t start;
    if (frame_header_read(bytes, n, &back, &start, &err))
        fail_msg("byte %zu = %u with %zu bytes was accepted", at, value, n);
    assert_int_equal(err.code, ERROR_FORMAT);
}

static void a_header_that_lies_is_refused(void **state)
{
    (void)state;
    const size_t whole = FRAME_HEADER_BYTES + 5;
    expect_refused(0, 'X', whole);
    expect_refused(4, 2, whole);
    expect_refused(6, 111, whole);
    expect_refused(6, 118, whole);
    expect_refused(8, 3, whole);
    expect_refused(11, 9, whole);
    expect_refused(11, 101, whole);
    expect_refused(40, 6, whole);
    expect_refused(0, 'B', whole - 1);
    expect_refused(0, 'B', 111);
    uint8_t bytes[FRAME_HEADER_BYTES + 5] = { 0 };
    struct frame_header header = sample(), back;
    header.clip_from_lps_mm[15] = NAN;
    frame_header_write(&header, bytes);
    struct error err = { 0 };
    size_t start;
    assert_false(frame_header_read(bytes, sizeof bytes, &back, &start, &err));
    header = sample();
    header.height_px = 0;
    frame_header_write(&header, bytes);
    assert_false(frame_header_read(bytes, sizeof bytes, &back, &start, &err));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_header_has_the_bytes_the_description_says),
        cmocka_unit_test(a_point_lies_in_a_reduced_picture_where_it_lies_in_the_whole),
        cmocka_unit_test(a_header_that_lies_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
