#include "server/wire/frame_header.h"
#include "server/wire/packet.h"
#include "tests/check.h"

static struct frame_header sample(void)
{
    struct frame_header header = { .codec = 1, .flags = FRAME_STILL | FRAME_SHARED, .quality = 92, .scale_percent = 100, .view = 3,
                                   .sequence = 0x01020304, .scene_revision = 42, .input_id = 0xfffffffe, .width_px = 1024,
                                   .height_px = 768, .render_us = 20000, .encode_us = 3000, .payload_bytes = 5, .pixels_per_mm_1000 = 2500 };
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

static void packets_come_whole_however_the_stream_is_cut(void **state)
{
    (void)state;
    cJSON *json = cJSON_Parse("{\"type\":\"frame\",\"id\":7}");
    uint8_t blob[1000];
    for (size_t i = 0; i < sizeof blob; i++)
        blob[i] = (uint8_t)(i * 7);
    size_t n;
    uint8_t *bytes = packet_write(json, blob, sizeof blob, &n);
    struct error err = { 0 };
    for (size_t step = 1; step < n; step = step * 3 + 1) {
        struct packet_reader *reader = packet_reader_create();
        int n_packets = 0;
        for (size_t sent = 0; sent < 2 * n;) { /* the packet twice over */
            size_t room, part = step < n - sent % n ? step : n - sent % n;
            uint8_t *space = packet_reader_space(reader, &room, &err);
            assert_non_null(space);
            part = part < room ? part : room;
            memcpy(space, bytes + sent % n, part);
            packet_reader_added(reader, part);
            sent += part;
            struct packet packet;
            while (packet_reader_take(reader, &packet, &err) == 1) {
                assert_true(cJSON_Compare(packet.json, json, true));
                assert_int_equal(packet.n_blob, sizeof blob);
                assert_memory_equal(packet.blob, blob, sizeof blob);
                packet_finish(&packet);
                n_packets++;
            }
        }
        assert_int_equal(n_packets, 2);
        packet_reader_destroy(reader);
    }
    free(bytes);
    cJSON_Delete(json);
}

static void expect_broken(const void *bytes, size_t n)
{
    struct packet_reader *reader = packet_reader_create();
    struct error err = { 0 };
    size_t room;
    uint8_t *space = packet_reader_space(reader, &room, &err);
    assert_true(room >= n);
    memcpy(space, bytes, n);
    packet_reader_added(reader, n);
    struct packet packet;
    assert_int_equal(packet_reader_take(reader, &packet, &err), -1);
    assert_true(err.text[0] != 0);
    packet_reader_destroy(reader);
}

static void a_stream_that_is_not_packets_is_closed(void **state)
{
    (void)state;
    expect_broken("GET / HTTP/1.1\r\n\r\n", 18);
    const uint32_t huge[3] = { 0x4b505242, 1, UINT32_MAX };
    expect_broken(huge, sizeof huge);
    uint32_t no_object[4] = { 0x4b505242, 4, 0, 0 };
    memcpy(&no_object[3], "[1] ", 4);
    expect_broken(no_object, sizeof no_object);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_header_has_the_bytes_the_description_says),
        cmocka_unit_test(a_header_that_lies_is_refused),
        cmocka_unit_test(packets_come_whole_however_the_stream_is_cut),
        cmocka_unit_test(a_stream_that_is_not_packets_is_closed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
