/* Packets between daemon and renderer: proto/fixtures/.../packets, the limits of each type, and the stream. */
#define _GNU_SOURCE
#include <dirent.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "server/wire/packet.h"
#include "tests/check.h"

/* ---- examples --------------------------------------------------------------------------------------------------- */

static cJSON *read_fixture(const char *folder, const char *name)
{
    static char text[65536];
    char path[512];
    (void)snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "rb");
    if (!file)
        fail_msg("%s cannot be read", path);
    size_t n = fread(text, 1, sizeof text, file);
    fclose(file);
    struct problem problem = { 0 };
    cJSON *json = json_read(text, n, &problem);
    if (!json)
        fail_msg("%s: %s", path, problem.detail);
    return json;
}

static enum packet_direction direction_of(const cJSON *fixture)
{
    return strcmp(json_text(fixture, "to"), "daemon") == 0 ? PACKET_TO_DAEMON : PACKET_TO_RENDERER;
}

static bool decode(const cJSON *fixture, struct packet *packet, struct problem *problem)
{
    cJSON *json = cJSON_Duplicate(cJSON_GetObjectItemCaseSensitive(fixture, "packet"), true);
    return packet_from_json(json, direction_of(fixture), (size_t)json_number(fixture, "blob_bytes", 0), packet,
                            problem);
}

static int for_each_fixture(const char *folder, void (*check)(const char *name, const cJSON *fixture))
{
    DIR *dir = opendir(folder);
    assert_non_null(dir);
    int n = 0;
    for (const struct dirent *entry; (entry = readdir(dir));) {
        if (!strstr(entry->d_name, ".json"))
            continue;
        cJSON *fixture = read_fixture(folder, entry->d_name);
        check(entry->d_name, fixture);
        cJSON_Delete(fixture);
        n++;
    }
    closedir(dir);
    return n;
}

static bool is_seen[PACKET_N_TYPES];

static void check_good(const char *name, const cJSON *fixture)
{
    struct packet packet;
    struct problem problem = { 0 };
    if (!decode(fixture, &packet, &problem))
        fail_msg("%s was refused: %s", name, problem.detail);
    cJSON *again = packet_to_json(&packet);
    char *text = json_write(again);
    if (!cJSON_Compare(again, cJSON_GetObjectItemCaseSensitive(fixture, "packet"), true))
        fail_msg("%s came back as %s", name, text);
    is_seen[packet.type] = true;
    free(text);
    cJSON_Delete(again);
    packet_finish(&packet);
}

static void check_bad(const char *name, const cJSON *fixture)
{
    struct packet packet;
    struct problem problem = { 0 };
    if (decode(fixture, &packet, &problem))
        fail_msg("%s was accepted", name);
    const cJSON *error = cJSON_GetObjectItemCaseSensitive(fixture, "error");
    if (strcmp(problem_word(problem.type), json_text(error, "type")) != 0 ||
        strcmp(problem.code, json_text(error, "code")) != 0 ||
        strcmp(problem.pointer, json_text(error, "pointer")) != 0)
        fail_msg("%s was refused with %s %s %s", name, problem_word(problem.type), problem.code, problem.pointer);
    assert_true(problem.detail[0] != 0);
}

static void every_good_packet_decodes_and_encodes_to_itself(void **state)
{
    (void)state;
    (void)for_each_fixture("proto/fixtures/good/packets", check_good);
    for (int type = 0; type < PACKET_N_TYPES; type++)
        if (!is_seen[type])
            fail_msg("there is no example of \"%s\"", packet_descriptions[type].name);
}

static void every_bad_packet_is_refused_with_the_error_it_names(void **state)
{
    (void)state;
    assert_true(for_each_fixture("proto/fixtures/bad/packets", check_bad) >= 35);
}

/* An example of a type that decodes. */
static cJSON *example(enum packet_type type)
{
    char name[64];
    (void)snprintf(name, sizeof name, "%s.json", packet_descriptions[type].name);
    cJSON *fixture = read_fixture("proto/fixtures/good/packets", name);
    cJSON *json = cJSON_DetachItemFromObjectCaseSensitive(fixture, "packet");
    cJSON_Delete(fixture);
    return json;
}

/* Its bytes of JSON, made longer by spaces; *n 0: as short as it is. */
static char *example_text(enum packet_type type, size_t *n)
{
    cJSON *json = example(type);
    char *bare = json_write(json), *text;
    size_t n_bare = strlen(bare);
    *n = *n > 0 ? *n : n_bare;
    text = malloc(*n + 1);
    assert_non_null(text);
    assert_true(n_bare <= *n);
    memset(text, ' ', *n);
    memcpy(text, bare, n_bare);
    text[*n] = 0;
    free(bare);
    cJSON_Delete(json);
    return text;
}

static uint8_t *encode_example(enum packet_type type, const uint8_t *blob, size_t n_blob, size_t *n)
{
    struct packet packet;
    struct problem problem = { 0 };
    assert_true(packet_from_json(example(type), packet_descriptions[type].direction, n_blob, &packet, &problem));
    uint8_t *bytes = packet_encode(&packet, blob, n_blob, n, &problem);
    if (!bytes)
        fail_msg("%s", problem.detail);
    packet_finish(&packet);
    return bytes;
}

static void a_packet_out_of_its_range_is_not_written(void **state)
{
    (void)state;
    struct packet packet;
    struct problem problem = { 0 };
    size_t n;
    packet_init(&packet, PACKET_RENDER);
    assert_true(packet.render.quality == 85 && packet.render.scale_percent == 100);
    uint8_t *bytes = packet_encode(&packet, NULL, 0, &n, &problem);
    assert_non_null(bytes);
    free(bytes);
    packet.render.quality = 101;
    assert_null(packet_encode(&packet, NULL, 0, &n, &problem));
    assert_int_equal(problem.type, PROBLEM_VALIDATION);
    assert_string_equal(problem.pointer, "/quality");
    packet_init(&packet, PACKET_FRAME);
    packet.frame.clip_from_lps_mm[3] = NAN;
    assert_null(packet_encode(&packet, (const uint8_t *)"x", 1, &n, &problem));
    packet.frame.clip_from_lps_mm[3] = 0;
    assert_null(packet_encode(&packet, NULL, 0, &n, &problem)); /* no picture */
    assert_string_equal(problem.code, "required");
    bytes = packet_encode(&packet, (const uint8_t *)"x", 1, &n, &problem);
    assert_non_null(bytes);
    free(bytes);
}

/* Whatever a driver or a file name holds: the packet can be sent, and its text is cut, not refused. */
static void any_text_fits_a_text_field_after_it_was_cut(void **state)
{
    (void)state;
    static const char *const pieces[] = { "a", "\x01", "\xff", "\xc3", "\xe2\x82\xac", "\xed\xa0\x80", "\x7f" };
    for (size_t i = 0; i < sizeof pieces / sizeof *pieces; i++) {
        char text[2000] = "";
        for (size_t at = 0; at + 8 < sizeof text; at += strlen(pieces[i]))
            memcpy(text + at, pieces[i], strlen(pieces[i]) + 1);
        struct packet packet, back;
        struct problem problem = { 0 };
        struct error err = { 0 };
        size_t n, room;
        packet_init(&packet, PACKET_PROGRESS);
        packet_put_text(packet.progress.phase, sizeof packet.progress.phase, text);
        uint8_t *bytes = packet_encode(&packet, NULL, 0, &n, &problem);
        if (!bytes)
            fail_msg("piece %zu: %s", i, problem.detail);
        struct packet_reader *reader = packet_reader_create(PACKET_TO_DAEMON);
        memcpy(packet_reader_space(reader, &room, &err), bytes, n);
        packet_reader_added(reader, n);
        if (packet_reader_take(reader, &back, &err) != 1)
            fail_msg("piece %zu: %s", i, err.text);
        packet_finish(&back);
        packet_reader_destroy(reader);
        free(bytes);
    }
}

/* ---- the stream ------------------------------------------------------------------------------------------------- */

static void packets_come_whole_however_the_stream_is_cut(void **state)
{
    (void)state;
    cJSON *json = example(PACKET_FRAME);
    uint8_t blob[1000];
    for (size_t i = 0; i < sizeof blob; i++)
        blob[i] = (uint8_t)(i * 7);
    size_t n;
    struct error err = { 0 };
    uint8_t *bytes = encode_example(PACKET_FRAME, blob, sizeof blob, &n);
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

/* An example of the type, of n_json bytes, with a blob. */
static int read_one(enum packet_direction direction, enum packet_type type, size_t n_json, size_t n_blob,
                    struct error *err)
{
    struct packet_reader *reader = packet_reader_create(direction);
    struct packet packet;
    char *json = example_text(type, &n_json);
    int got = feed(reader, json, n_json, n_blob, &packet, err);
    if (got == 1)
        packet_finish(&packet);
    packet_reader_destroy(reader);
    free(json);
    return got;
}

/* A frame of a 4096 x 4096 picture with a caption of 1024 lines has at most 80 MiB of pixels (4 bytes each), and a MiB
 * for the codec's own; the JSON of a frame has 24 numbers and up to 32 missing regions, each with an id of 63 letters
 * and a reason of 239, which JSON may write six times as long: 58 KiB. What is larger is refused before memory is taken
 * for it. */
static void a_packet_larger_than_its_type_may_be_is_refused_before_its_blob(void **state)
{
    (void)state;
    const size_t picture = ((size_t)80 << 20) + (1 << 20);
    struct error err = { 0 };
    assert_int_equal(read_one(PACKET_TO_DAEMON, PACKET_FRAME, 1000, picture, &err), 0); /* it waits for the picture */
    assert_int_equal(read_one(PACKET_TO_DAEMON, PACKET_FRAME, 1000, picture + 1, &err), -1);
    assert_int_equal(err.code, ERROR_LIMIT);
    assert_non_null(strstr(err.text, "\"frame\" of 1000 + 84934657 bytes, at most 65536 + 84934656"));
    assert_int_equal(read_one(PACKET_TO_DAEMON, PACKET_FRAME, 65537, 10, &err), -1);
    assert_int_equal(read_one(PACKET_TO_DAEMON, PACKET_PROGRESS, 16384, 0, &err), 1);
    assert_int_equal(read_one(PACKET_TO_DAEMON, PACKET_PROGRESS, 16385, 0, &err), -1);
    assert_int_equal(read_one(PACKET_TO_DAEMON, PACKET_PROGRESS, 1000, 1, &err), -1);
    assert_int_equal(read_one(PACKET_TO_DAEMON, PACKET_READY, 8 << 20, 0, &err), 1);
    assert_int_equal(read_one(PACKET_TO_DAEMON, PACKET_READY, 1000, 1, &err), -1);
    assert_int_equal(read_one(PACKET_TO_DAEMON, PACKET_ANSWER, 1000, (size_t)512 << 20, &err), 0);
    assert_int_equal(read_one(PACKET_TO_DAEMON, PACKET_ANSWER, 1000, ((size_t)512 << 20) + 1, &err), -1);
    assert_int_equal(read_one(PACKET_TO_RENDERER, PACKET_SCENE, 8 << 20, 0, &err), 1);
    assert_int_equal(read_one(PACKET_TO_RENDERER, PACKET_SCENE, (8 << 20) + 1, 0, &err), -1);
    assert_int_equal(read_one(PACKET_TO_RENDERER, PACKET_SCENE, 1000, 1, &err), -1);
}

static void each_end_takes_only_what_is_for_it(void **state)
{
    (void)state;
    struct error err = { 0 };
    for (int type = 0; type < PACKET_N_TYPES; type++) {
        const struct packet_description *description = &packet_descriptions[type];
        int good = description->needs_blob ? 0 : 1; /* it waits for the blob */
        assert_int_equal(read_one(description->direction, (enum packet_type)type, 2000, (size_t)(1 - good), &err),
                         good);
        assert_int_equal(read_one(!description->direction, (enum packet_type)type, 2000, 0, &err), -1);
    }
}

/* The writer's limits are the reader's: whatever is written can be read, and the first that cannot be read is not
 * written. */
static void what_one_end_writes_the_other_reads(void **state)
{
    (void)state;
    struct packet packet, back;
    struct problem problem = { 0 };
    struct error err = { 0 };
    size_t n;
    cJSON *scene = cJSON_CreateObject();
    packet_init(&packet, PACKET_SCENE);
    (void)snprintf(packet.scene.room, sizeof packet.scene.room, "r");
    packet.scene.scene = scene;
    uint8_t *bytes = packet_encode(&packet, NULL, 0, &n, &problem);
    assert_non_null(bytes);
    size_t n_text = PACKET_MAX_DOCUMENT - (n - 12) - strlen("\"x\":\"\"");
    char *text = malloc(n_text + 2);
    assert_non_null(text);
    memset(text, 'a', n_text + 1);
    text[n_text] = text[n_text + 1] = 0;
    cJSON_AddStringToObject(scene, "x", text);
    free(bytes);
    bytes = packet_encode(&packet, NULL, 0, &n, &problem);
    assert_non_null(bytes);
    assert_int_equal(n, 12 + PACKET_MAX_DOCUMENT);
    struct packet_reader *reader = packet_reader_create(PACKET_TO_RENDERER);
    assert_int_equal(feed(reader, (char *)bytes + 12, n - 12, 0, &back, &err), 1);
    packet_finish(&back);
    packet_reader_destroy(reader);
    free(bytes);
    text[n_text] = 'a';
    cJSON_DeleteItemFromObjectCaseSensitive(scene, "x");
    cJSON_AddStringToObject(scene, "x", text);
    assert_null(packet_encode(&packet, NULL, 0, &n, &problem));
    assert_int_equal(problem.type, PROBLEM_LIMIT);
    free(text);
    cJSON_Delete(scene);
}

static void the_memory_of_a_large_packet_is_given_back(void **state)
{
    (void)state;
    struct packet_reader *reader = packet_reader_create(PACKET_TO_DAEMON);
    struct error err = { 0 };
    struct packet packet;
    size_t room;
    size_t n_large = 8 << 20, n_small = 20, n_frame = 0;
    char *large = example_text(PACKET_READY, &n_large), *small = example_text(PACKET_PONG, &n_small),
         *frame = example_text(PACKET_FRAME, &n_frame);
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
    assert_int_equal(feed(reader, frame, n_frame, 30 << 20, &packet, &err), 0);
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
    free(frame);
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
    size_t n_text = 0;
    char *text = example_text(PACKET_ANSWER, &n_text);
    cJSON *body = cJSON_CreateObject();
    if (blob == MAP_FAILED || setrlimit(RLIMIT_DATA, &limit) != 0)
        return 1;
    if (feed(reader, text, n_text, blob_bytes, &packet, &err) != -1 || err.code != ERROR_MEMORY)
        return 2;
    struct problem problem = { 0 };
    packet_init(&packet, PACKET_ANSWER);
    packet.answer.body = body;
    return packet_encode(&packet, blob, blob_bytes, &n, &problem) || problem.type != PROBLEM_MEMORY ? 3 : 0;
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_good_packet_decodes_and_encodes_to_itself),
        cmocka_unit_test(every_bad_packet_is_refused_with_the_error_it_names),
        cmocka_unit_test(a_packet_out_of_its_range_is_not_written),
        cmocka_unit_test(any_text_fits_a_text_field_after_it_was_cut),
        cmocka_unit_test(packets_come_whole_however_the_stream_is_cut),
        cmocka_unit_test(a_stream_that_is_not_packets_is_closed),
        cmocka_unit_test(a_packet_larger_than_its_type_may_be_is_refused_before_its_blob),
        cmocka_unit_test(each_end_takes_only_what_is_for_it),
        cmocka_unit_test(what_one_end_writes_the_other_reads),
        cmocka_unit_test(the_memory_of_a_large_packet_is_given_back),
        cmocka_unit_test(no_memory_for_a_packet_is_an_error_and_no_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
