/* Limits of a recording: when it is full everybody is told, the meeting goes on, and the recorded part plays. */
#include <stdlib.h>

#include "core/base/log.h"
#include "server/room/log/meeting_log.h"
#include "server/room/log/recording.h"
#include "server/room/state/room_state.h"
#include "tests/unit/room_fake.h"

static struct fake_room fake;
static struct fake_page ann, ben;

static struct {
    char *texts[64];
    size_t n;
} disk;

static void recorded(void *context, struct room *room, const struct room_recording *facts, struct log_batch *batch)
{
    (void)context, (void)room, (void)facts;
    if (!batch)
        return;
    assert_true(disk.n < sizeof disk.texts / sizeof disk.texts[0]);
    disk.texts[disk.n++] = batch->text;
}

static int set_up(void **state)
{
    (void)state;
    disk.n = 0;
    fake_room_start(&fake, 3);
    fake.room->callbacks.recorded = recorded;
    fake_plan_ready(&fake, true);
    fake_hello(&fake, &ann);
    fake_hello(&fake, &ben);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    fake_room_end(&fake);
    fake_page_end(&ann);
    fake_page_end(&ben);
    for (size_t i = 0; i < disk.n; i++)
        free(disk.texts[i]);
    return 0;
}

static void sets_opacity(const char *opacity)
{
    fake_say(&fake, &ann, "{\"type\":\"scene.patch\",\"patch\":{\"regions\":{\"scalp\":{\"opacity\":%s}}}}", opacity);
    fake_pass(&fake, 2 * RECORDING_BATCH_MS);
}

static void assert_hears(const struct fake_page *page, const char *recording_state)
{
    cJSON *message = fake_heard(page, "recording");
    assert_string_equal(json_text(message, "state"), recording_state);
    cJSON_Delete(message);
}

static double opacity_in(const cJSON *scene)
{
    const cJSON *regions = cJSON_GetObjectItem(scene, "regions");
    return json_number(cJSON_GetObjectItem(regions, "scalp"), "opacity", -1);
}

static double opacity_recorded(int64_t t_ms)
{
    struct problem problem = { 0 };
    cJSON *state = room_recorded_state((const char *const *)disk.texts, disk.n, t_ms, &problem);
    assert_string_equal(problem.detail, "");
    double opacity = opacity_in(cJSON_GetObjectItem(state, "scene"));
    cJSON_Delete(state);
    return opacity;
}

/* A recording that was begun, with one change, and then comes to a limit; the change after it is not in it. */
static void assert_ends_full(void)
{
    const size_t n_before = disk.n;
    sets_opacity("0.5");
    assert_null(fake.room->recorder);
    assert_int_equal(fake.room->recordings->list[0].state, WIRE_RECORDING_STATE_FULL);
    assert_hears(&ann, "full");
    assert_hears(&ben, "full");
    assert_int_equal(disk.n, n_before);
    assert_true(opacity_in(room_scene(fake.room, NULL)) == 0.5); /* the meeting goes on */
    assert_true(opacity_recorded(fake.room->recordings->list[0].length_ms) == 0.25);
    assert_true(opacity_recorded(0) == 0.4);
    fake_say(&fake, &ann, "{\"type\":\"recording.start\"}"); /* another one may follow */
    assert_hears(&ben, "running");
}

static void begins(void)
{
    fake_say(&fake, &ann, "{\"type\":\"recording.start\"}");
    assert_hears(&ben, "running");
    fake_pass(&fake, 2 * RECORDING_BATCH_MS);
    sets_opacity("0.25");
}

static void after_twelve_hours_it_is_full(void **state)
{
    (void)state;
    begins();
    fake_pass(&fake, ROOM_MAX_RECORDING_S * INT64_C(1000) - 8 * RECORDING_BATCH_MS);
    sets_opacity("0.25"); /* nothing new */
    assert_non_null(fake.room->recorder);
    fake_pass(&fake, 8 * RECORDING_BATCH_MS);
    assert_ends_full();
}

static void with_all_its_bytes_it_is_full(void **state)
{
    (void)state;
    begins();
    fake.room->recordings->list[0].n_bytes = ROOM_MAX_RECORDING_BYTES - 1;
    assert_ends_full();
}

static void with_all_its_events_it_is_full(void **state)
{
    (void)state;
    begins();
    fake.room->recordings->list[0].n_events = ROOM_MAX_RECORDING_EVENTS;
    assert_ends_full();
}

static void a_room_keeps_so_many(void **state)
{
    (void)state;
    for (int i = 0; i < ROOM_MAX_RECORDINGS; i++) {
        fake_say(&fake, &ann, "{\"type\":\"recording.start\"}");
        assert_hears(&ben, "running");
        fake_say(&fake, &ann, "{\"type\":\"recording.stop\"}");
        assert_hears(&ben, "stopped");
    }
    assert_null(fake_heard(&ann, "problem"));
    fake_say(&fake, &ann, "{\"type\":\"recording.start\"}");
    cJSON *problem = fake_heard(&ann, "problem");
    assert_string_equal(json_text(cJSON_GetObjectItem(problem, "problem"), "type"), "/problems/limit");
    cJSON_Delete(problem);
    assert_null(fake.room->recorder);
    char first[32];
    (void)snprintf(first, sizeof first, "%s", fake.room->recordings->list[0].id);
    assert_true(room_recording_delete(fake.room, first, fake.now_us));
    fake_say(&fake, &ann, "{\"type\":\"recording.start\"}");
    assert_hears(&ben, "running");
}

int main(void)
{
    log_start("test_recording_limits", LOG_ERROR + 1);
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(after_twelve_hours_it_is_full),
        TEST(with_all_its_bytes_it_is_full),
        TEST(with_all_its_events_it_is_full),
        TEST(a_room_keeps_so_many),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
