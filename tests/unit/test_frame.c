#define _GNU_SOURCE
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "server/wire/frame_header.h"
#include "server/wire/packet.h"
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

static void packets_come_whole_however_the_stream_is_cut(void **state)
{
    (void)state;
    cJSON *json = cJSON_Parse("{\"type\":\"frame\",\"id\":7}");
    uint8_t blob[1000];
    for (size_t i = 0; i < sizeof blob; i++)
        blob[i] = (uint8_t)(i * 7);
    size_t n;
    struct error err = { 0 };
    uint8_t *bytes = packet_write(json, blob, sizeof blob, &n, &err);
    assert_non_null(bytes);
    for (size_t step = 1; step < n; step = step * 3 + 1) {
        struct packet_reader *reader = packet_reader_create(PACKET_TO_DAEMON);
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
    struct packet_reader *reader = packet_reader_create(PACKET_TO_DAEMON);
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

/* Head and JSON as they come, and what the reader says to them. */
static int feed(struct packet_reader *reader, const char *json, size_t n_json, size_t n_blob, struct packet *packet,
                struct error *err)
{
    const uint32_t head[3] = { 0x4b505242, (uint32_t)n_json, (uint32_t)n_blob };
    const struct {
        const void *bytes;
        size_t n;
    } parts[] = { { head, sizeof head }, { json, n_json } };
    for (size_t i = 0; i < 2; i++)
        for (size_t at = 0, room; at < parts[i].n; at += room) {
            uint8_t *space = packet_reader_space(reader, &room, err);
            assert_non_null(space);
            room = room < parts[i].n - at ? room : parts[i].n - at;
            memcpy(space, (const uint8_t *)parts[i].bytes + at, room);
            packet_reader_added(reader, room);
        }
    return packet_reader_take(reader, packet, err);
}

/* {"type":"TYPE"} made longer by spaces. */
static char *padded(const char *type, size_t n)
{
    char start[64], *text = malloc(n + 1);
    assert_non_null(text);
    int used = snprintf(start, sizeof start, "{\"type\":\"%s\"}", type);
    memset(text, ' ', n);
    memcpy(text, start, (size_t)used);
    text[n] = 0;
    return text;
}

static const char *const to_daemon[] = { "gl", "progress", "ready", "failed", "frame", "answer", "problem", "pong" };
static const char *const to_renderer[] = { "scene", "forget", "drop", "render", "query", "ping" };

static int read_one(enum packet_direction direction, const char *type, size_t n_json, size_t n_blob, struct error *err)
{
    struct packet_reader *reader = packet_reader_create(direction);
    struct packet packet;
    char *json = padded(type, n_json);
    int got = feed(reader, json, n_json, n_blob, &packet, err);
    if (got == 1)
        packet_finish(&packet);
    packet_reader_destroy(reader);
    free(json);
    return got;
}

/* A frame of a 4096 x 4096 picture has at most 64 MiB of pixels (4 bytes each), and a MiB for the codec's own; the JSON
 * of a frame has 24 numbers and up to 32 missing regions, each with an id of 63 letters and a reason of 239, which JSON
 * may write six times as long: 58 KiB. What is larger is refused before memory is taken for it. */
static void a_packet_larger_than_its_type_may_be_is_refused_before_its_blob(void **state)
{
    (void)state;
    const size_t picture = ((size_t)64 << 20) + (1 << 20);
    struct error err = { 0 };
    assert_int_equal(read_one(PACKET_TO_DAEMON, "frame", 100, picture, &err), 0); /* it waits for the picture */
    assert_int_equal(read_one(PACKET_TO_DAEMON, "frame", 100, picture + 1, &err), -1);
    assert_int_equal(err.code, ERROR_LIMIT);
    assert_non_null(strstr(err.text, "\"frame\" of 100 + 68157441 bytes, at most 65536 + 68157440"));
    assert_int_equal(read_one(PACKET_TO_DAEMON, "frame", 65537, 10, &err), -1);
    assert_int_equal(read_one(PACKET_TO_DAEMON, "progress", 16384, 0, &err), 1);
    assert_int_equal(read_one(PACKET_TO_DAEMON, "progress", 16385, 0, &err), -1);
    assert_int_equal(read_one(PACKET_TO_DAEMON, "progress", 100, 1, &err), -1);
    assert_int_equal(read_one(PACKET_TO_DAEMON, "ready", 8 << 20, 0, &err), 1);
    assert_int_equal(read_one(PACKET_TO_DAEMON, "ready", 100, 1, &err), -1);
    assert_int_equal(read_one(PACKET_TO_DAEMON, "answer", 100, (size_t)512 << 20, &err), 0);
    assert_int_equal(read_one(PACKET_TO_DAEMON, "answer", 100, ((size_t)512 << 20) + 1, &err), -1);
    assert_int_equal(read_one(PACKET_TO_RENDERER, "scene", 8 << 20, 0, &err), 1);
    assert_int_equal(read_one(PACKET_TO_RENDERER, "scene", (8 << 20) + 1, 0, &err), -1);
    assert_int_equal(read_one(PACKET_TO_RENDERER, "scene", 100, 1, &err), -1);
}

static void each_end_takes_only_what_is_for_it(void **state)
{
    (void)state;
    struct error err = { 0 };
    for (size_t i = 0; i < sizeof to_daemon / sizeof *to_daemon; i++) {
        assert_int_equal(read_one(PACKET_TO_DAEMON, to_daemon[i], 100, 0, &err), 1);
        assert_int_equal(read_one(PACKET_TO_RENDERER, to_daemon[i], 100, 0, &err), -1);
    }
    for (size_t i = 0; i < sizeof to_renderer / sizeof *to_renderer; i++) {
        assert_int_equal(read_one(PACKET_TO_RENDERER, to_renderer[i], 100, 0, &err), 1);
        assert_int_equal(read_one(PACKET_TO_DAEMON, to_renderer[i], 100, 0, &err), -1);
    }
    assert_int_equal(read_one(PACKET_TO_DAEMON, "gossip", 100, 0, &err), -1);
    assert_non_null(strstr(err.text, "\"gossip\""));
}

/* The writer's limits are the reader's: whatever is written can be read, and the first that cannot be read is not
 * written. */
static void what_one_end_writes_the_other_reads(void **state)
{
    (void)state;
    const size_t n_types[] = { sizeof to_daemon / sizeof *to_daemon, sizeof to_renderer / sizeof *to_renderer };
    for (int direction = 0; direction < 2; direction++)
        for (size_t i = 0; i < n_types[direction]; i++) {
            const char *type = direction == 0 ? to_daemon[i] : to_renderer[i];
            const struct packet_limit *limit = packet_limit_find(type);
            assert_non_null(limit);
            for (size_t more = 0; more < 2; more++) {
                struct error err = { 0 };
                cJSON *json = cJSON_CreateObject();
                cJSON_AddStringToObject(json, "type", type);
                char *bare = json_write(json);
                size_t n_long = limit->max_json + more - strlen(bare) - strlen(",\"x\":\"\""), n;
                char *words = malloc(n_long + 1);
                assert_non_null(words);
                memset(words, 'a', n_long);
                words[n_long] = 0;
                cJSON_AddStringToObject(json, "x", words);
                uint8_t *bytes = packet_write(json, NULL, 0, &n, &err);
                if (more == 0) {
                    assert_non_null(bytes);
                    assert_int_equal(n, 12 + limit->max_json);
                    struct packet_reader *reader =
                        packet_reader_create(direction == 0 ? PACKET_TO_DAEMON : PACKET_TO_RENDERER);
                    struct packet packet;
                    assert_int_equal(feed(reader, (char *)bytes + 12, n - 12, 0, &packet, &err), 1);
                    packet_finish(&packet);
                    packet_reader_destroy(reader);
                } else {
                    assert_null(bytes);
                    assert_int_equal(err.code, ERROR_LIMIT);
                }
                free(bytes);
                free(words);
                free(bare);
                cJSON_Delete(json);
            }
        }
    struct error err = { 0 };
    size_t n;
    cJSON *json = cJSON_Parse("{\"type\":\"gossip\"}"), *none = cJSON_CreateObject();
    assert_null(packet_write(json, NULL, 0, &n, &err));
    assert_null(packet_write(none, NULL, 0, &n, &err));
    assert_int_equal(err.code, ERROR_FORMAT);
    cJSON_Delete(json);
    cJSON_Delete(none);
}

static void the_memory_of_a_large_packet_is_given_back(void **state)
{
    (void)state;
    struct packet_reader *reader = packet_reader_create(PACKET_TO_DAEMON);
    struct error err = { 0 };
    struct packet packet;
    size_t room;
    char *large = padded("ready", 8 << 20), *small = padded("pong", 20);
    assert_int_equal(feed(reader, large, 8 << 20, 0, &packet, &err), 1);
    packet_finish(&packet);
    assert_true(packet_reader_held(reader) < 1 << 20);
    /* a large one of which the next has come already */
    assert_int_equal(feed(reader, large, (8 << 20) - 100, 0, &packet, &err), 1);
    packet_finish(&packet);
    assert_int_equal(feed(reader, small, 20, 0, &packet, &err), 1);
    packet_finish(&packet);
    assert_non_null(packet_reader_space(reader, &room, &err));
    assert_true(packet_reader_held(reader) < 1 << 20);
    /* a picture's memory leaves with the picture */
    assert_int_equal(feed(reader, "{\"type\":\"frame\"}", 16, 30 << 20, &packet, &err), 0);
    for (size_t left = 30 << 20; left > 0; left -= room) {
        uint8_t *space = packet_reader_space(reader, &room, &err);
        assert_non_null(space);
        room = room < left ? room : left;
        memset(space, 7, room);
        packet_reader_added(reader, room);
    }
    assert_int_equal(packet_reader_take(reader, &packet, &err), 1);
    assert_int_equal(packet.n_blob, 30 << 20);
    assert_int_equal(packet.blob[(30 << 20) - 1], 7);
    packet_finish(&packet);
    assert_true(packet_reader_held(reader) < 1 << 20);
    packet_reader_destroy(reader);
    free(large);
    free(small);
}

/* In a process that may have 64 MiB: reading and writing say so, and the process goes on. */
static int run_short_of_memory(void)
{
    const size_t blob_bytes = (size_t)256 << 20;
    struct rlimit limit = { 64 << 20, 64 << 20 };
    struct packet_reader *reader = packet_reader_create(PACKET_TO_DAEMON);
    struct packet packet;
    struct error err = { 0 };
    size_t n;
    void *blob =
        mmap(NULL, blob_bytes, PROT_READ, MAP_SHARED | MAP_ANONYMOUS, -1, 0); /* shared memory does not count */
    cJSON *json = cJSON_Parse("{\"type\":\"answer\"}");
    if (blob == MAP_FAILED || setrlimit(RLIMIT_DATA, &limit) != 0)
        return 1;
    if (feed(reader, "{\"type\":\"answer\"}", 17, blob_bytes, &packet, &err) != -1 || err.code != ERROR_MEMORY)
        return 2;
    err = (struct error){ 0 };
    return packet_write(json, blob, blob_bytes, &n, &err) || err.code != ERROR_MEMORY ? 3 : 0;
}

static void no_memory_for_a_packet_is_an_error_and_no_end(void **state)
{
    (void)state;
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    skip(); /* they have an allocator of their own, which ends the process */
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
    skip();
#endif
#endif
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0)
        _exit(run_short_of_memory());
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
}

static cJSON *frame_of(double width, double height, double pixels_per_mm)
{
    cJSON *json = cJSON_CreateObject(), *matrix;
    cJSON_AddStringToObject(json, "type", "frame");
    cJSON_AddNumberToObject(json, "width_px", width);
    cJSON_AddNumberToObject(json, "height_px", height);
    cJSON_AddNumberToObject(json, "scene_revision", 4294967295.0);
    cJSON_AddNumberToObject(json, "render_us", 3);
    cJSON_AddNumberToObject(json, "encode_us", 4);
    cJSON_AddNumberToObject(json, "pixels_per_mm", pixels_per_mm);
    matrix = cJSON_AddArrayToObject(json, "clip_from_lps_mm");
    for (int i = 0; i < 16; i++)
        cJSON_AddItemToArray(matrix, cJSON_CreateNumber(i));
    return json;
}

static bool is_frame(cJSON *json, size_t n_blob, struct packet_frame *frame)
{
    uint8_t byte = 0;
    struct packet packet = { json, n_blob ? &byte : NULL, n_blob };
    bool is_read = packet_frame_read(&packet, frame);
    cJSON_Delete(json);
    return is_read;
}

static void a_frame_has_numbers_within_bounds_and_a_picture(void **state)
{
    (void)state;
    struct packet_frame frame;
    assert_true(is_frame(frame_of(4096, 1, 2.5), 1, &frame));
    assert_int_equal(frame.width_px, 4096);
    assert_int_equal(frame.height_px, 1);
    assert_true(frame.scene_revision == UINT32_MAX && frame.render_us == 3 && frame.encode_us == 4);
    assert_true(frame.pixels_per_mm == 2.5 && frame.clip_from_lps_mm[15] == 15.0F);
    assert_false(is_frame(frame_of(4097, 1, 1), 1, &frame)); /* no view is larger: proto/scene.json */
    assert_false(is_frame(frame_of(1, 4097, 1), 1, &frame));
    assert_false(is_frame(frame_of(0, 1, 1), 1, &frame));
    assert_false(is_frame(frame_of(1, -1, 1), 1, &frame));
    assert_false(is_frame(frame_of(1, 1, NAN), 1, &frame));
    assert_false(is_frame(frame_of(1, 1, 1), 0, &frame));
    cJSON *json = frame_of(1, 1, 1);
    cJSON_AddItemToArray(cJSON_GetObjectItemCaseSensitive(json, "clip_from_lps_mm"), cJSON_CreateNumber(1));
    assert_false(is_frame(json, 1, &frame));
    json = frame_of(1, 1, 1);
    cJSON_ReplaceItemInArray(cJSON_GetObjectItemCaseSensitive(json, "clip_from_lps_mm"), 3,
                             cJSON_CreateNumber(1e300)); /* no float holds it */
    assert_false(is_frame(json, 1, &frame));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_header_has_the_bytes_the_description_says),
        cmocka_unit_test(a_header_that_lies_is_refused),
        cmocka_unit_test(packets_come_whole_however_the_stream_is_cut),
        cmocka_unit_test(a_stream_that_is_not_packets_is_closed),
        cmocka_unit_test(a_packet_larger_than_its_type_may_be_is_refused_before_its_blob),
        cmocka_unit_test(each_end_takes_only_what_is_for_it),
        cmocka_unit_test(what_one_end_writes_the_other_reads),
        cmocka_unit_test(the_memory_of_a_large_packet_is_given_back),
        cmocka_unit_test(no_memory_for_a_packet_is_an_error_and_no_end),
        cmocka_unit_test(a_frame_has_numbers_within_bounds_and_a_picture),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
