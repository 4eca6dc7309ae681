/* A room plays recordings that are written by hand: whole, with their beginning lost, damaged, and on a disk that has
 * too much to do. */
#include <stdlib.h>

#include "core/base/log.h"
#include "server/room/log/meeting_log.h"
#include "server/room/log/recording.h"
#include "server/room/log/replay.h"
#include "server/room/state/room_state.h"
#include "tests/unit/room_fake.h"

/* ---- the world --------------------------------------------------------------------------------------------------- */

static struct fake_room fake;
static struct fake_page page;

/* Request of the replay to the disk. */
static struct {
    bool is_busy;
    int64_t t_ms; /* -1: nothing */
    size_t n;
} asked;

/* Batches on the disk. */
static const char *const *disk;

static bool is_asked(void *context, struct room *room, const char *of_room, const char *recording, int64_t t_ms,
                     struct problem *problem)
{
    (void)context, (void)room;
    assert_string_equal(of_room, "k3rw-8vxa");
    assert_string_equal(recording, "rec-1");
    asked.n++;
    if (asked.is_busy)
        return problem_set(problem, PROBLEM_BUSY, "", "", "made up");
    asked.t_ms = t_ms;
    return true;
}

/* A state in which the only member is of this name. */
#define STATE(t_ms, name) \
    "[{\"t_ms\":" #t_ms ",\"part\":\"state\",\"whole\":{\"scene\":{},\"views\":{},\"pointers\":{},\"items\":{}," \
    "\"members\":{\"m1\":{\"name\":\"" name "\"}}}}]"
#define CHANGE(t_ms, name) "[{\"t_ms\":" #t_ms ",\"part\":\"members\",\"id\":\"m1\",\"patch\":{\"name\":\"" name "\"}}]"

static cJSON *read_first(const char *text)
{
    struct problem problem = { 0 };
    cJSON *events = meeting_log_read(text, strlen(text), &problem);
    assert_string_equal(problem.detail, "");
    return events;
}

/* Answers like a store. */
static void answer(void)
{
    const char *texts[16];
    size_t first = SIZE_MAX, n = 0;
    int64_t next_ms = INT64_MAX;
    for (int turn = 0; asked.t_ms >= 0; turn++) {
        assert_true(turn < 4); /* else it asks again and again */
        for (size_t i = 0; disk[i]; i++) {
            cJSON *events = read_first(disk[i]);
            const bool is_state = log_event_is_state(events->child);
            const int64_t t_ms = log_event_ms(events->child);
            cJSON_Delete(events);
            if (is_state && (first == SIZE_MAX || t_ms <= asked.t_ms)) {
                first = i;
                n = 0;
                next_ms = INT64_MAX;
            } else if (is_state && next_ms == INT64_MAX) {
                next_ms = t_ms;
            }
            if (first != SIZE_MAX && next_ms == INT64_MAX)
                texts[n++] = disk[i];
        }
        asked.t_ms = -1;
        room_replay_came(fake.room, texts, n, next_ms, NULL, fake.now_us);
        fake.again_us = room_settle(fake.room, fake.now_us);
    }
}

static int set_up(void **state)
{
    (void)state;
    asked.is_busy = false;
    asked.t_ms = -1;
    asked.n = 0;
    fake_room_start(&fake, 3);
    fake.room->callbacks.replay_read = is_asked;
    return 0;
}

/* Begins a replay of ten seconds with these batches. */
static void begin(const char *const *batches)
{
    const struct room_recording facts = { .id = "rec-1", .length_ms = 10000, .state = WIRE_RECORDING_STATE_STOPPED };
    disk = batches;
    room_replay_begin(fake.room, "k3rw-8vxa", 0, &facts, fake.now_us);
    fake_plan_ready(&fake, true);
    fake_hello(&fake, &page);
}

static int tear_down(void **state)
{
    (void)state;
    fake_room_end(&fake);
    fake_page_end(&page);
    return 0;
}

static void seek(int t_ms)
{
    fake_say(&fake, &page, "{\"type\":\"replay.seek\",\"t_ms\":%d}", t_ms);
}

/* The name of the member who is shown now. */
static const char *name_shown(void)
{
    static char name[64];
    cJSON *message = fake_heard(&page, "replay.members");
    const char *found = json_text(cJSON_GetArrayItem(cJSON_GetObjectItem(message, "members"), 0), "name");
    (void)snprintf(name, sizeof name, "%s", found ? found : "");
    cJSON_Delete(message);
    return name;
}

static const char *state_told(void)
{
    static char word[64];
    cJSON *message = fake_heard(&page, "replay.at");
    (void)snprintf(word, sizeof word, "%s", json_text(message, "state"));
    cJSON_Delete(message);
    return word;
}

/* Returns the name that is shown after a seek to this time. */
static const char *shown_at(int t_ms)
{
    seek(t_ms);
    answer();
    fake_pass(&fake, REPLAY_EVERY_MS);
    return name_shown();
}

/* ---- tests ------------------------------------------------------------------------------------------------------- */

static void each_time_shows_what_was_then(void **state)
{
    static const char *const batches[] = { STATE(0, "a"),    CHANGE(1000, "b"), CHANGE(3000, "c"),
                                           STATE(5000, "d"), CHANGE(7000, "e"), NULL };
    (void)state;
    begin(batches);
    answer();
    assert_string_equal(shown_at(9999), "e");
    assert_string_equal(shown_at(0), "a");
    assert_string_equal(shown_at(2999), "b");
    assert_string_equal(shown_at(5000), "d");
    assert_string_equal(shown_at(4999), "c");
    assert_string_equal(shown_at(6999), "d");
    assert_string_equal(shown_at(7000), "e");
}

static void where_the_beginning_is_lost_the_first_there_is_is_shown(void **state)
{
    static const char *const batches[] = { CHANGE(1000, "b"), STATE(5000, "d"), CHANGE(7000, "e"), NULL };
    (void)state;
    begin(batches);
    answer();
    assert_string_equal(shown_at(0), "d");
    assert_string_equal(shown_at(2000), "d");
    assert_string_equal(shown_at(8000), "e");
    assert_string_equal(shown_at(4999), "d");
    const size_t n_before = asked.n;
    fake_pass(&fake, 60000); /* nothing more is to be read */
    assert_int_equal(asked.n, n_before);
    fake_say(&fake, &page, "{\"type\":\"replay.seek\",\"t_ms\":0}");
    fake_say(&fake, &page, "{\"type\":\"replay.play\",\"rate\":16}");
    answer();
    fake_pass(&fake, 1000);
    assert_string_equal(state_told(), "ended");
    assert_string_equal(name_shown(), "e");
}

/* The kind of the view in the small picture, and the number of frames of it. */
static const char *small_picture(size_t *n_frames)
{
    static char kind[64];
    cJSON *message = fake_heard(&page, "view");
    assert_int_equal((int)json_number(message, "view", 0), ROOM_WATCH);
    (void)snprintf(kind, sizeof kind, "%s", json_text(cJSON_GetObjectItem(message, "document"), "kind"));
    cJSON_Delete(message);
    *n_frames = 0;
    for (size_t i = 0; i < page.n_frames; i++)
        *n_frames += page.frames[i].view == ROOM_WATCH;
    return kind;
}

static void who_looks_for_themselves_has_a_small_picture_of_the_replay(void **state)
{
    static const char *const batches[] = {
        "[{\"t_ms\":0,\"part\":\"state\",\"whole\":{\"scene\":{},\"views\":{\"3d-1\":{\"document\":{\"kind\":\"3d\"}},"
        "\"axial-1\":{\"document\":{\"kind\":\"axial\"}}},\"pointers\":{},\"items\":{},\"members\":{}}}]",
        "[{\"t_ms\":1000,\"part\":\"views\",\"id\":\"axial-1\",\"patch\":{\"document\":{\"size_px\":[500,300]}}}]", NULL
    };
    size_t n_frames, n_requests;
    (void)state;
    begin(batches);
    answer();
    fake_pass(&fake, REPLAY_EVERY_MS);
    fake_say(&fake, &page, "{\"type\":\"watch\",\"size_px\":[260,195]}");
    assert_string_equal(small_picture(&n_frames), "3d");
    assert_int_equal(fake_outstanding(&fake), 1); /* nobody else takes pictures */
    fake_draw(&fake, fake_oldest(&fake));
    assert_string_equal(small_picture(&n_frames), "3d");
    assert_int_equal(n_frames, 1);
    n_requests = fake.n_requests;
    fake_pass(&fake, 5000);
    assert_int_equal(fake.n_requests, n_requests); /* not acknowledged */
    fake_say(&fake, &page, "{\"type\":\"frame.shown\",\"view\":9,\"sequence\":1}");
    fake_pass(&fake, 500);
    assert_true(fake.n_requests > n_requests); /* the still */
    fake_draw(&fake, fake_oldest(&fake));
    fake_say(&fake, &page, "{\"type\":\"frame.shown\",\"view\":9,\"sequence\":2}");

    (void)shown_at(1500); /* the axial view was moved */
    assert_string_equal(small_picture(&n_frames), "axial");
    fake_pass(&fake, 500);
    fake_draw(&fake, fake_oldest(&fake));
    assert_string_equal(small_picture(&n_frames), "axial");
    assert_int_equal(n_frames, 3);
}

/* Answers with one batch, and the time of the state behind it, until nothing is asked; time passes meanwhile. */
static size_t n_reads_in(int64_t ms, const char *text, int64_t next_ms)
{
    const size_t n_before = asked.n;
    for (int64_t end_us = fake.now_us + ms * 1000; fake.now_us < end_us; fake_pass(&fake, 100))
        for (int turn = 0; asked.t_ms >= 0; turn++) {
            assert_true(turn < 4);
            asked.t_ms = -1;
            room_replay_came(fake.room, &text, text ? 1 : 0, next_ms, NULL, fake.now_us);
            fake.again_us = room_settle(fake.room, fake.now_us);
        }
    return asked.n - n_before;
}

/* Pauses of 2, 4, 8, 16, 32 and 64 s between reads. */
static void what_cannot_be_played_is_read_again_after_growing_pauses(void **state)
{
    static const char *const batches[] = { STATE(0, "a"), STATE(4000, "b"), NULL };
    static const struct {
        const char *text;
        int64_t next_ms;
    } damaged[] = {
        { STATE(0, "x"), 3000 },       /* it ends before the time it was read for */
        { CHANGE(0, "x"), INT64_MAX }, /* no state */
        { STATE(6000, "x"), 6000 },    /* nothing in it */
        { "[]", INT64_MAX },           { "[{", INT64_MAX }, { NULL, INT64_MAX },
    };
    (void)state;
    begin(batches);
    answer();
    for (size_t i = 0; i < sizeof damaged / sizeof damaged[0]; i++) {
        assert_string_equal(shown_at(0), "a");
        seek(5000);
        assert_int_equal(n_reads_in(63000, damaged[i].text, damaged[i].next_ms), 5);
        assert_string_equal(state_told(), "failed");
        assert_string_equal(name_shown(), "a"); /* nothing of it */
    }
}

static void a_disk_that_has_too_much_to_do_is_asked_again_after_pauses(void **state)
{
    static const char *const batches[] = { STATE(0, "a"), STATE(4000, "b"), NULL };
    (void)state;
    begin(batches);
    answer();
    asked.is_busy = true;
    const size_t n_before = asked.n;
    seek(5000);
    assert_string_equal(state_told(), "failed");
    fake_pass(&fake, 13000);
    assert_int_equal(asked.n, n_before + 3); /* at once, after 2 s, after 6 s */
    asked.is_busy = false;
    fake_pass(&fake, 2000);
    answer();
    fake_pass(&fake, REPLAY_EVERY_MS);
    assert_string_equal(name_shown(), "b");
    assert_string_equal(state_told(), "paused");
}

static bool is_told_that_the_plan_changed(void)
{
    cJSON *message = fake_heard(&page, "replay");
    const bool has_changed = json_flag(message, "plan_changed", false);
    cJSON_Delete(message);
    return has_changed;
}

static void another_plan_than_the_recorded_one_is_said(void **state)
{
    static const char *const batches[] = { STATE(0, "a"), NULL };
    struct room_recording facts = { .id = "rec-1", .length_ms = 10000, .state = WIRE_RECORDING_STATE_STOPPED };
    (void)state;
    disk = batches;
    fake_plan_ready(&fake, true);
    assert_true(recording_plan_sum(fake.room, facts.plan_sum));
    room_replay_begin(fake.room, "k3rw-8vxa", 0, &facts, fake.now_us);
    fake_hello(&fake, &page);
    answer();
    assert_false(is_told_that_the_plan_changed());
    fake_other_plan_ready(&fake);
    assert_true(is_told_that_the_plan_changed());
    fake_plan_ready(&fake, true);
    assert_false(is_told_that_the_plan_changed());
}

static void another_revision_of_the_files_is_said_when_it_is_known(void **state)
{
    static const char *const batches[] = { STATE(0, "a"), NULL };
    struct room_recording facts = { .id = "rec-1", .length_ms = 10000, .plan_revision = "aa" };
    (void)state;
    disk = batches;
    fake_plan_ready(&fake, true);
    assert_true(recording_plan_sum(fake.room, facts.plan_sum));
    room_replay_begin(fake.room, "k3rw-8vxa", 0, &facts, fake.now_us);
    fake_hello(&fake, &page);
    answer();
    assert_true(room_wants_revision(fake.room));
    assert_false(is_told_that_the_plan_changed()); /* not known yet */
    room_revision_came(fake.room, "bb", fake.now_us);
    assert_true(is_told_that_the_plan_changed());
    fake_plan_ready(&fake, true);
    assert_true(is_told_that_the_plan_changed());
    room_revision_came(fake.room, "aa", fake.now_us);
    assert_false(is_told_that_the_plan_changed());
    fake_other_plan_ready(&fake);
    assert_true(is_told_that_the_plan_changed());
    room_revision_came(fake.room, "aa", fake.now_us);
    assert_true(is_told_that_the_plan_changed()); /* the document is another one */
}

static void an_older_recording_knows_no_revision(void **state)
{
    static const char *const batches[] = { STATE(0, "a"), NULL };
    struct room_recording facts = { .id = "rec-1", .length_ms = 10000 };
    (void)state;
    disk = batches;
    fake_plan_ready(&fake, true);
    assert_true(recording_plan_sum(fake.room, facts.plan_sum));
    room_replay_begin(fake.room, "k3rw-8vxa", 0, &facts, fake.now_us);
    fake_hello(&fake, &page);
    answer();
    room_revision_came(fake.room, "bb", fake.now_us);
    assert_false(is_told_that_the_plan_changed());
}

/* ---- what is written --------------------------------------------------------------------------------------------- */

static cJSON *member(const char *name)
{
    cJSON *entry = cJSON_CreateObject();
    cJSON_AddStringToObject(entry, "name", name);
    return entry;
}

static void a_part_that_there_was_no_memory_for_stays_as_it_was(void **state)
{
    struct meeting_log *log = meeting_log_create();
    struct log_batch batch;
    (void)state;
    meeting_log_put(log, 0, LOG_MEMBERS, "m1", member("Ann"));
    assert_true(meeting_log_take(log, 0, &batch));
    free(batch.text);
    meeting_log_put_all(log, 10, LOG_MEMBERS, NULL);
    assert_false(meeting_log_take(log, 20, &batch));
    assert_int_equal(cJSON_GetArraySize(log_state_part(meeting_log_state(log), LOG_MEMBERS)), 1);
    meeting_log_put_all(log, 30, LOG_MEMBERS, cJSON_CreateObject());
    assert_true(meeting_log_take(log, 40, &batch));
    assert_string_equal(batch.text, "[{\"t_ms\":30,\"part\":\"members\",\"id\":\"m1\",\"gone\":true}]");
    free(batch.text);
    meeting_log_destroy(log);
}

int main(void)
{
    log_start("test_replay", LOG_ERROR + 1);
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(each_time_shows_what_was_then),
        TEST(who_looks_for_themselves_has_a_small_picture_of_the_replay),
        TEST(where_the_beginning_is_lost_the_first_there_is_is_shown),
        TEST(what_cannot_be_played_is_read_again_after_growing_pauses),
        TEST(another_plan_than_the_recorded_one_is_said),
        TEST(another_revision_of_the_files_is_said_when_it_is_known),
        TEST(an_older_recording_knows_no_revision),
        TEST(a_disk_that_has_too_much_to_do_is_asked_again_after_pauses),
        cmocka_unit_test(a_part_that_there_was_no_memory_for_stays_as_it_was),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
