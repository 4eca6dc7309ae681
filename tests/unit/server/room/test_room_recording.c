/* A meeting of two hours, with random acts of five people, is recorded; at random times the state that the log gives is
 * what the room was then, digit for digit, and a room that plays it shows it, forwards and backwards. */
#include <stdlib.h>

#include "core/base/mem.h"
#include "server/room/items/item_list.h"
#include "server/room/log/meeting_log.h"
#include "server/room/log/recorded_parts.h"
#include "server/room/state/room_state.h"
#include "server/room/streams/stream.h"
#include "tests/unit/room_fake.h"

enum { N_PEOPLE = 5, N_STEPS = 24000, N_MOMENTS = 300, MAX_BATCHES = 8192, MEETING_MS = 2 * 3600 * 1000 };

/* ---- the world: rooms without pictures, and a disk --------------------------------------------------------------- */

static struct person {
    char id[64], secret[64];
    bool is_here;
} people[N_PEOPLE];

static struct fake_room meeting, replay;
static struct fake_page viewer;

static struct {
    struct log_batch batches[MAX_BATCHES];
    size_t n, n_bytes;
    struct room_recording facts; /* as last told; without marks */
    char deleted[32];
} disk;

static struct {
    int64_t t_ms;
    char *state;
} moments[N_MOMENTS];
static size_t n_moments;

static void draws_nothing(void *context, struct room *room, const struct room_render *request)
{
    (void)context, (void)room, (void)request;
}

static void forgets_nothing(void *context, struct room *room, uint64_t request)
{
    (void)context, (void)room, (void)request;
}

static void hears(void *context, void *connection, const char *text)
{
    struct person *person = connection;
    (void)context;
    if (!strstr(text, "\"type\":\"welcome\""))
        return;
    cJSON *json = json_read(text, strlen(text), NULL);
    (void)snprintf(person->id, sizeof person->id, "%s", json_text(json, "member"));
    (void)snprintf(person->secret, sizeof person->secret, "%s", json_text(json, "secret"));
    cJSON_Delete(json);
}

static void hears_latest(void *context, void *connection, uint32_t key, const char *text)
{
    (void)context, (void)connection, (void)key, (void)text;
}

static void closes(void *context, void *connection)
{
    (void)context, (void)connection;
}

static void recorded(void *context, struct room *room, const struct room_recording *facts, struct log_batch *batch)
{
    (void)context, (void)room;
    disk.facts = *facts;
    disk.facts.marks = NULL;
    if (!batch)
        return;
    assert_true(disk.n < MAX_BATCHES);
    assert_int_equal(facts->n_batches, disk.n + 1);
    disk.n_bytes += strlen(batch->text);
    disk.batches[disk.n++] = *batch;
}

static void deleted(void *context, struct room *room, const char *id)
{
    (void)context, (void)room;
    (void)snprintf(disk.deleted, sizeof disk.deleted, "%s", id);
}

/* The batches from the last one with a state at or before t_ms on, up to the next such one, as a store reads them. */
static size_t find_part(int64_t t_ms, const char **texts, int64_t *next_ms)
{
    size_t first = 0, n = 0;
    for (size_t i = 0; i < disk.n; i++)
        if (disk.batches[i].is_state && disk.batches[i].t_ms <= t_ms)
            first = i;
    *next_ms = INT64_MAX;
    for (size_t i = first; i < disk.n; i++) {
        if (i > first && disk.batches[i].is_state) {
            *next_ms = disk.batches[i].t_ms;
            break;
        }
        texts[n++] = disk.batches[i].text;
    }
    return n;
}

static int64_t asked_ms = -1; /* by the replay; -1: nothing */
static size_t n_asked;

static bool is_asked(void *context, struct room *room, const char *of_room, const char *recording, int64_t t_ms,
                     struct problem *problem)
{
    (void)context, (void)room, (void)problem;
    assert_string_equal(of_room, "7q4k-m2wz");
    assert_string_equal(recording, disk.facts.id);
    asked_ms = t_ms;
    n_asked++;
    return true;
}

static void answer(void)
{
    static const char *texts[MAX_BATCHES];
    int64_t next_ms;
    while (asked_ms >= 0) {
        size_t n = find_part(asked_ms, texts, &next_ms);
        asked_ms = -1;
        room_replay_came(replay.room, texts, n, next_ms, NULL, replay.now_us);
        fake_pass(&replay, 0);
        replay.again_us = room_settle(replay.room, replay.now_us);
    }
}

static void start_meeting(void)
{
    memset(&disk, 0, sizeof disk);
    memset(people, 0, sizeof people);
    n_moments = 0;
    fake_room_start(&meeting, N_PEOPLE);
    struct room_callbacks *callbacks = &meeting.room->callbacks;
    callbacks->render = draws_nothing;
    callbacks->forget = forgets_nothing;
    callbacks->send_text = hears;
    callbacks->send_latest = hears_latest;
    callbacks->item_changed = NULL;
    callbacks->recorded = recorded;
    callbacks->recording_deleted = deleted;
    callbacks->close = closes;
    fake_plan_ready(&meeting, true);
}

static void end_meeting(void)
{
    fake_room_end(&meeting);
    for (size_t i = 0; i < disk.n; i++)
        free(disk.batches[i].text);
    for (size_t i = 0; i < n_moments; i++)
        free(moments[i].state);
    disk.n = n_moments = 0;
}

/* ---- the meeting ------------------------------------------------------------------------------------------------- */

static uint32_t seed;
static int below(int n)
{
    seed = seed * 1664525 + 1013904223;
    return (int)((seed >> 8) % (uint32_t)n);
}

static void says(int who, const char *format, ...)
{
    char text[2048];
    va_list args;
    va_start(args, format);
    int n = vsnprintf(text, sizeof text, format, args);
    va_end(args);
    room_text_came(meeting.room, &people[who], text, (size_t)n, meeting.now_us);
    meeting.again_us = room_settle(meeting.room, meeting.now_us);
}

static void enters(int who)
{
    static const char *const kinds[] = { "3d", "axial", "coronal", "sagittal" };
    static const char *const names[] = { "Ann", "Ben", "Cem", "Dee", "Özlem" };
    says(who, "{\"type\":\"hello\",\"protocol\":2,\"name\":\"%s\",\"member\":\"%s\",\"secret\":\"%s\"}", names[who],
         people[who].id, people[who].secret);
    people[who].is_here = true;
    for (int v = 1; v <= 4; v++)
        says(who,
             "{\"type\":\"view.open\",\"view\":%d,\"document\":{\"kind\":\"%s\",\"size_px\":[%d,%d]},\"follow\":true}",
             v, kinds[v - 1], 300 + 10 * who, 200 + below(100));
}

static void leaves(int who)
{
    room_connection_closed(meeting.room, &people[who], meeting.now_us);
    people[who].is_here = false;
    meeting.again_us = room_settle(meeting.room, meeting.now_us);
}

static int presenter(void)
{
    for (int who = 0; who < N_PEOPLE; who++)
        if (people[who].is_here && meeting.room->presenter && meeting.room->presenter->connection == &people[who])
            return who;
    return -1;
}

static void changes_the_scene(int who)
{
    switch (below(6)) {
    case 0:
        says(who, "{\"type\":\"scene.patch\",\"patch\":{\"image\":{\"slices\":{\"axial\":{\"position_mm\":%d.%d}}}}}",
             below(90), below(1000));
        break;
    case 1:
        says(who, "{\"type\":\"scene.patch\",\"patch\":{\"regions\":{\"scalp\":{\"opacity\":0.%d}}}}", below(100));
        break;
    case 2: /* an entry comes and goes */
        says(who, "{\"type\":\"scene.patch\",\"patch\":{\"dose\":{\"levels\":{\"l-%d\":%s}}}}", below(4),
             below(2) ? "null" : "{\"value\":80,\"unit\":\"%\",\"color\":\"#00ff00\"}");
        break;
    case 3: /* a field is null, and not */
        says(who, "{\"type\":\"scene.patch\",\"patch\":{\"image\":{\"window\":%s}}}",
             below(2) ? "{\"center\":40,\"width\":400}" : "null");
        break;
    case 4:
        says(who, "{\"type\":\"scene.patch\",\"patch\":{\"image\":{\"obliques\":{\"%c\":%s}}}}", 'a' + below(3),
             below(2) ? "null" : "{\"origin_mm\":[1,2,3],\"normal\":[0,0.6,0.8]}");
        break;
    default:
        says(who, "{\"type\":\"scene.patch\",\"patch\":{\"clip\":{\"axial_low\":{\"enabled\":%s,\"position_mm\":%d}}}}",
             below(2) ? "true" : "false", below(50));
    }
}

static void writes_a_note(int who)
{
    const struct item *item = meeting.room->items->first;
    for (int i = below(8); item && i > 0; i--)
        item = item->next;
    if (!item || below(2))
        says(
            who,
            "{\"type\":\"item.put\",\"kind\":\"note\",\"body\":{\"text\":\"note %d\",\"anchor\":{\"point_mm\":[%d,2.5,-3]}}}",
            below(1000), below(100));
    else if (below(2))
        says(who, "{\"type\":\"item.delete\",\"item\":\"%s\"}", item->id);
    else
        says(
            who,
            "{\"type\":\"item.put\",\"item\":\"%s\",\"version\":%u,\"kind\":\"note\",\"body\":{\"text\":\"again %d\",\"resolved\":true}}",
            item->id, item->version, below(1000));
}

static void acts(void)
{
    const int who = below(N_PEOPLE), chair = presenter(), what = below(100);
    if (!people[who].is_here) {
        if (below(20) == 0)
            enters(who);
        return;
    }
    if (what < 40 && chair >= 0)
        says(
            chair,
            "{\"type\":\"view.patch\",\"view\":%d,\"patch\":{\"camera\":{\"target_mm\":[%d.%d,1,2],\"height_mm\":%d}}}",
            1 + below(4), below(100), below(100000), 100 + below(100));
    else if (what < 55 && chair >= 0)
        changes_the_scene(chair);
    else if (what < 85)
        says(who, below(10) ? "{\"type\":\"pointer\",\"view\":1,\"point_mm\":[%d,0.%d,3]}" : "{\"type\":\"pointer\"}",
             below(100), below(10000));
    else if (what < 88)
        writes_a_note(who);
    else if (what < 92)
        says(who, "{\"type\":\"follow\",\"follow\":%s}", below(2) ? "true" : "false");
    else if (what < 94 && chair >= 0)
        says(chair, "{\"type\":\"control.give\",\"member\":\"%s\"}", people[who].id);
    else if (what < 96)
        says(who, "{\"type\":\"present\"}");
    else if (what == 96 && who != 0)
        leaves(who);
}

static void remember(int64_t start_us)
{
    cJSON *state = recorded_state(meeting.room);
    moments[n_moments].t_ms = (meeting.now_us - start_us) / 1000;
    moments[n_moments++].state = json_write(state);
    cJSON_Delete(state);
}

/* Two hours. Ann is there from the beginning to the end, and records. */
static void meet(void)
{
    seed = 20261123;
    enters(0);
    says(0, "{\"type\":\"recording.start\"}");
    assert_non_null(meeting.room->recorder);
    const int64_t start_us = meeting.now_us;
    for (int step = 0; step < N_STEPS; step++) {
        acts();
        fake_pass(&meeting, 20 + below(2 * MEETING_MS / N_STEPS - 50));
        if (step % (N_STEPS / N_MOMENTS) == 7) {
            fake_pass(&meeting, 100); /* what the room has become is in the log within 100 ms */
            remember(start_us);
            fake_pass(&meeting, 1); /* what comes next has another time */
        }
    }
    if (presenter() != 0)
        says(0, "{\"type\":\"control.take\"}");
    says(0, "{\"type\":\"recording.stop\"}");
    assert_null(meeting.room->recorder);
}

/* Equal texts of any length; else told with what stands around the first difference. */
static void assert_same(const char *text, const char *expected)
{
    size_t at = 0;
    while (text[at] && text[at] == expected[at])
        at++;
    const size_t from = at > 100 ? at - 100 : 0;
    if (text[at] || expected[at])
        fail_msg("...%.240s...\ninstead of\n...%.240s...", text + from, expected + from);
}

/* Moments that are compared: all of them, or a sixth from all of the meeting. Neither stride has a factor in common
 * with their number. */
static int n_looked_at(void)
{
    return getenv("UNITS") ? N_MOMENTS : N_MOMENTS / 6;
}

static int stride(void)
{
    return getenv("UNITS") ? 7 : 43;
}

/* ---- tests ------------------------------------------------------------------------------------------------------- */

static cJSON *state_at(int64_t t_ms)
{
    static const char *texts[MAX_BATCHES];
    struct problem problem = { 0 };
    int64_t next_ms;
    cJSON *state = NULL;
    size_t n = find_part(t_ms, texts, &next_ms);
    for (size_t i = 0; i < n; i++) {
        cJSON *events = meeting_log_read(texts[i], strlen(texts[i]), &problem), *event;
        assert_non_null(events);
        cJSON_ArrayForEach(event, events) if (log_event_ms(event) <= t_ms)
            assert_true(meeting_log_apply(&state, event, &problem));
        cJSON_Delete(events);
    }
    assert_string_equal(problem.detail, "");
    return state;
}

static void at_any_time_the_log_gives_what_the_room_was(void **state)
{
    (void)state;
    assert_int_equal(disk.facts.state, WIRE_RECORDING_STATE_STOPPED);
    assert_in_range(disk.facts.length_ms, MEETING_MS * 9 / 10, MEETING_MS * 12 / 10);
    assert_in_range(disk.facts.n_events, 15000, ROOM_MAX_RECORDING_EVENTS);
    assert_int_equal(disk.facts.n_bytes, disk.n_bytes);
    assert_in_range(disk.n_bytes, 1 << 20, ROOM_MAX_RECORDING_BYTES / 2);
    assert_int_equal(n_moments, N_MOMENTS);
    size_t n_states = 0, n_most = 0;
    for (size_t i = 0; i < disk.n; i++)
        n_states += disk.batches[i].is_state;
    assert_in_range(n_states, 5, disk.n / 4);
    for (int i = 0; i < n_looked_at(); i++) {
        const int at = (i * stride()) % N_MOMENTS; /* forwards and back */
        cJSON *found = state_at(moments[at].t_ms);
        char *text = json_write(found);
        assert_same(text, moments[at].state);
        n_most = strlen(text) > n_most ? strlen(text) : n_most;
        free(text);
        cJSON_Delete(found);
    }
    print_message("%u events in %zu batches, %zu states, %zu KiB; the largest state has %zu KiB\n", disk.facts.n_events,
                  disk.n, n_states, disk.n_bytes >> 10, n_most >> 10);
}

static void assert_part(const char *whole, enum log_part part, cJSON *shown)
{
    cJSON *state = json_read(whole, strlen(whole), NULL);
    char *expected = json_write(log_state_part(state, part)), *text = json_write(shown);
    assert_same(text, expected);
    free(expected);
    free(text);
    cJSON_Delete(state);
    cJSON_Delete(shown);
}

/* The shared views of the replay that the meeting had at that time; it may have more of them, from other times. */
static cJSON *views_of(const char *whole)
{
    cJSON *state = json_read(whole, strlen(whole), NULL), *shown = cJSON_CreateObject(),
          *all = recorded_views(replay.room);
    const cJSON *entry;
    cJSON_ArrayForEach(entry, log_state_part(state, LOG_VIEWS))
    {
        cJSON *view = cJSON_GetObjectItemCaseSensitive(all, entry->string);
        assert_non_null(view);
        cJSON_ReplaceItemInObjectCaseSensitive(view, "by",
                                               cJSON_Duplicate(cJSON_GetObjectItemCaseSensitive(entry, "by"),
                                                               true)); /* nobody, in a replay */
        json_add(shown, entry->string, cJSON_Duplicate(view, true));
    }
    cJSON_Delete(all);
    cJSON_Delete(state);
    return shown;
}

static cJSON *scene_of(const char *whole)
{
    cJSON *state = json_read(whole, strlen(whole), NULL), *shown = cJSON_CreateObject(),
          *entry = recorded_scene(replay.room);
    cJSON_ReplaceItemInObjectCaseSensitive(
        entry, "revision",
        cJSON_Duplicate(cJSON_GetObjectItem(cJSON_GetObjectItem(log_state_part(state, LOG_SCENE), "scene"), "revision"),
                        true)); /* the room's own */
    json_add(shown, "scene", entry);
    cJSON_Delete(state);
    return shown;
}

static void start_replay(void)
{
    fake_room_start(&replay, 3);
    replay.room->callbacks.replay_read = is_asked;
    asked_ms = -1;
    room_replay_begin(replay.room, "7q4k-m2wz", room_n_named(meeting.room), &disk.facts, replay.now_us);
    fake_plan_ready(&replay, true);
    answer();
}

static void end_replay(void)
{
    fake_room_end(&replay);
    fake_page_end(&viewer);
}

/* Sorted by id, as in a state. */
static cJSON *items_of_replay(void)
{
    cJSON *whole = recorded_state(replay.room), *items = cJSON_DetachItemFromObject(whole, "items");
    cJSON_Delete(whole);
    return items;
}

static void a_room_that_plays_it_shows_it_forwards_and_backwards(void **state)
{
    (void)state;
    start_replay();
    fake_hello(&replay, &viewer);
    for (int i = 0; i < n_looked_at(); i++) {
        const int at = (i * stride()) % N_MOMENTS;
        fake_say(&replay, &viewer, "{\"type\":\"replay.seek\",\"t_ms\":%lld}", (long long)moments[at].t_ms);
        answer();
        fake_pass(&replay, 60);
        assert_part(moments[at].state, LOG_SCENE, scene_of(moments[at].state));
        assert_part(moments[at].state, LOG_VIEWS, views_of(moments[at].state));
        assert_part(moments[at].state, LOG_ITEMS, items_of_replay());
        fake_page_end(&viewer);
    }
    end_replay();
}

/* The rows of the meeting name their authors by number: it is nobody's here. */
static void who_leaves_a_replay_owns_nothing_of_the_meeting(void **state)
{
    (void)state;
    start_replay();
    fake_hello(&replay, &viewer);
    cJSON *welcome = fake_heard(&viewer, "welcome");
    unsigned number = 0;
    assert_int_equal(sscanf(json_text(welcome, "member"), "m%u", &number), 1);
    cJSON_Delete(welcome);
    assert_true(number > room_n_named(meeting.room));
    end_replay();
}

/* However small the pane: pictures of a replay are to be the same for all. */
static void a_room_that_plays_it_sends_whole_pictures(void **state)
{
    static struct fake_page other;
    (void)state;
    start_replay();
    fake_join(&replay, &viewer, true);
    fake_hello(&replay, &other);
    fake_say(&replay, &other, "{\"type\":\"view.open\",\"view\":1,\"follow\":true,\"document\":{\"size_px\":[99,99]}}");
    fake_settle(&replay, (struct fake_page *const[]){ &viewer, &other }, 2);
    fake_turn(&replay, &viewer, 5, 0);
    fake_settle(&replay, (struct fake_page *const[]){ &viewer, &other }, 2);
    assert_true(other.n_frames > 0);
    assert_int_equal(other.frames[other.n_frames - 1].width_px, viewer.frames[viewer.n_frames - 1].width_px);
    for (size_t i = 0; i < replay.n_requests; i++)
        assert_false(replay.requests[i].is_reduced[0] || replay.requests[i].is_reduced[1]);
    fake_page_end(&other);
    end_replay();
}

static int two_hours(void **state)
{
    (void)state;
    start_meeting();
    meet();
    return 0;
}

static int end(void **state)
{
    (void)state;
    end_meeting();
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(at_any_time_the_log_gives_what_the_room_was),
        cmocka_unit_test(a_room_that_plays_it_shows_it_forwards_and_backwards),
        cmocka_unit_test(who_leaves_a_replay_owns_nothing_of_the_meeting),
        cmocka_unit_test(a_room_that_plays_it_sends_whole_pictures),
    };
    return cmocka_run_group_tests(tests, two_hours, end);
}
