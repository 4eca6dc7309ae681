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
        cmocka_unit_test(a_header_that_lies_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
