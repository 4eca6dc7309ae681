/* Recordings in the store: parts from state to state, what deletes them, and a database of the version before. */
#include <stdlib.h>
#include <string.h>

#include "core/base/log.h"
#include "core/base/mem.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/store_files.h"
#include "tests/unit/store_world.h"

static struct store_world world;

static int set_up(void **state)
{
    (void)state;
    folder_make(world.folder);
    (void)snprintf(world.path, sizeof world.path, "%s/beamroom.db", world.folder);
    store_file_run_file(world.path, "tests/data/store/version4.sql");
    store_world_open(&world);
    struct store_answer *opened = store_world_await(&world, STORE_OPENED);
    assert_int_equal(opened->n_rooms, 2);
    store_answer_free(opened);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    store_world_close(&world);
    folder_remove(world.folder);
    return 0;
}

/* Writes n batches, one a second, of which each third begins with a state. */
static void write_recording(uint32_t n)
{
    struct store_room *room = store_made_room("7q4k-m2wz", 43, 10, 1);
    room->recordings = mem_new(sizeof *room->recordings);
    room->n_recordings = 1;
    struct store_recording *recording = room->recordings;
    (void)snprintf(recording->id, sizeof recording->id, "rec-1");
    recording->facts = mem_copy_text("{\"state\":\"stopped\"}");
    recording->batches = mem_array(n, sizeof *recording->batches, 1 << 20, NULL);
    recording->n_batches = n;
    for (uint32_t i = 0; i < n; i++) {
        char text[32];
        (void)snprintf(text, sizeof text, "[%u]", i);
        recording->batches[i] =
            (struct store_batch){ .place = i, .t_ms = 1000 * i, .is_state = i % 3 == 0, .text = mem_copy_text(text) };
    }
    store_world_write(&world, room);
}

static enum error_code expected_error = ERROR_NOT_FOUND;

/* The texts of the part for t_ms, one after the other; "" when there is none. */
static const char *part_at(int64_t t_ms, int64_t *next_ms)
{
    static char texts[256];
    assert_true(store_read_part(world.store, "7q4k-m2wz", "rec-1", t_ms, 9));
    struct store_answer *answer = store_world_await(&world, STORE_PART);
    assert_int_equal(answer->ticket, 9);
    texts[0] = 0;
    for (size_t i = 0; answer->part && i < answer->part->n; i++)
        (void)strncat(texts, answer->part->texts[i], sizeof texts - strlen(texts) - 1);
    *next_ms = answer->part ? answer->part->next_ms : -1;
    if (!answer->part)
        assert_int_equal(answer->error.code, expected_error);
    store_answer_free(answer);
    return texts;
}

static void a_part_goes_from_a_state_to_the_next(void **state)
{
    (void)state;
    int64_t next_ms;
    write_recording(8);
    assert_string_equal(part_at(0, &next_ms), "[0][1][2]");
    assert_int_equal(next_ms, 3000);
    assert_string_equal(part_at(5999, &next_ms), "[3][4][5]");
    assert_int_equal(next_ms, 6000);
    assert_string_equal(part_at(6000, &next_ms), "[6][7]");
    assert_true(next_ms == INT64_MAX);
    assert_string_equal(part_at(1000000, &next_ms), "[6][7]");
    struct store_room *room = store_world_read(&world, "7q4k-m2wz");
    assert_int_equal(room->n_recordings, 1);
    assert_string_equal(room->recordings[0].id, "rec-1");
    assert_string_equal(room->recordings[0].facts, "{\"state\":\"stopped\"}");
    store_room_free(room);
}

static void a_missing_batch_is_noticed(void **state)
{
    (void)state;
    int64_t next_ms;
    write_recording(11);
    store_world_close(&world);
    store_file_run(world.path, "DELETE FROM recording_batches WHERE place IN (4, 9)"); /* 9 holds a state */
    store_world_open(&world);
    store_answer_free(store_world_await(&world, STORE_OPENED));
    expected_error = ERROR_FORMAT;
    assert_string_equal(part_at(2999, &next_ms), "[0][1][2]");
    assert_int_equal(next_ms, 3000);
    assert_string_equal(part_at(3000, &next_ms), "[3]");
    assert_int_equal(next_ms, 3001);
    assert_string_equal(part_at(3001, &next_ms), "");
    assert_string_equal(part_at(5999, &next_ms), "");
    assert_string_equal(part_at(6000, &next_ms), "[6][7][8]"); /* the next whole state */
    assert_int_equal(next_ms, 8001);
    assert_string_equal(part_at(1000000, &next_ms), "");
    expected_error = ERROR_NOT_FOUND;
}

static void a_deleted_recording_takes_its_batches_along(void **state)
{
    (void)state;
    int64_t next_ms;
    write_recording(3);
    struct store_room *room = store_made_room("7q4k-m2wz", 44, 10, 1);
    room->recordings = mem_new(sizeof *room->recordings);
    room->n_recordings = 1;
    (void)snprintf(room->recordings[0].id, sizeof room->recordings[0].id, "rec-1");
    store_world_write(&world, room);
    assert_string_equal(part_at(0, &next_ms), "");
    store_world_close(&world);
    assert_int_equal(store_file_number(world.path, "SELECT count(*) FROM recording_batches"), 0);
    assert_int_equal(store_file_number(world.path, "SELECT count(*) FROM recordings"), 0);
    store_world_open(&world);
    store_answer_free(store_world_await(&world, STORE_OPENED));
}

static void a_deleted_room_takes_its_recordings_along(void **state)
{
    (void)state;
    write_recording(3);
    assert_true(store_delete(world.store, "7q4k-m2wz", 8));
    store_answer_free(store_world_await(&world, STORE_WRITTEN));
    store_world_close(&world);
    assert_int_equal(store_file_number(world.path, "SELECT count(*) FROM recording_batches"), 0);
    store_world_open(&world);
    store_answer_free(store_world_await(&world, STORE_OPENED));
}

int main(void)
{
    log_start("test_store_recordings", LOG_ERROR + 1);
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(a_part_goes_from_a_state_to_the_next),
        TEST(a_missing_batch_is_noticed),
        TEST(a_deleted_recording_takes_its_batches_along),
        TEST(a_deleted_room_takes_its_recordings_along),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
