/* The facts of recordings as they come from the store: what is damaged is left out, the rest stays. */
#include <stdlib.h>
#include <string.h>

#include "core/base/log.h"
#include "server/net/keep_recordings.h"
#include "tests/unit/room_fake.h"

static struct fake_room fake;

static int set_up(void **state)
{
    (void)state;
    fake_room_start(&fake, 3);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    fake_room_end(&fake);
    return 0;
}

/* Restores a recording with these marks; returns the marks that the room then has, as text for free(). */
static char *marks_after(const char *marks)
{
    char facts[512];
    struct store_recording recording = { .id = "rec-1", .facts = facts };
    const struct store_room row = { .recordings = &recording, .n_recordings = 1 };
    (void)snprintf(facts, sizeof facts, "{\"state\":\"stopped\",\"length_ms\":900,\"by_name\":\"Ann\",\"marks\":%s}",
                   marks);
    keep_recordings_restore(fake.room, &row);
    cJSON *list = room_recordings(fake.room, 0);
    const cJSON *first = cJSON_GetArrayItem(list, 0);
    assert_int_equal(json_number(first, "length_ms", 0), 900);
    assert_string_equal(json_text(first, "by_name"), "Ann");
    char *text = json_print(cJSON_GetObjectItemCaseSensitive(first, "marks"));
    cJSON_Delete(list);
    assert_true(room_recording_delete(fake.room, "rec-1", 0));
    return text;
}

static void marks_that_are_none_are_left_out_and_the_recording_stays(void **state)
{
    static const char *const damaged[] = { "7",
                                           "[7]",
                                           "[[1,\"note\"]]",
                                           "[{\"a\":1,\"b\":\"note\",\"c\":\"Ann\"}]",
                                           "[[\"1\",\"note\",\"Ann\"]]",
                                           "[[1,\"note\",\"Ann\"],[2,\"note\",null]]" };
    (void)state;
    char *text = marks_after("[[1,\"note\",\"Ann\"],[2,\"presenter\",\"\"]]");
    assert_string_equal(text, "[[1,\"note\",\"Ann\"],[2,\"presenter\",\"\"]]");
    free(text);
    for (size_t i = 0; i < sizeof damaged / sizeof damaged[0]; i++) {
        text = marks_after(damaged[i]);
        assert_string_equal(text, "[]");
        free(text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(marks_that_are_none_are_left_out_and_the_recording_stays, set_up, tear_down),
    };
    log_start("test_keep_recordings", LOG_ERROR);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
