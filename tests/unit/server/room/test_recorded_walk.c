/* The walk through a recorded meeting: when a picture of its film is drawn, of which view, and how long it stands. Logs
 * are written by hand. */
#include "server/room/log/recorded_walk.h"

#include <stdio.h>
#include <string.h>

#include "tests/check.h"

/* Ann presents, and moved the 3-D view; Ben moved the axial one. */
#define MEETING \
    "\"scene\":{\"scene\":{\"revision\":1,\"scene\":{\"a\":1}}}," \
    "\"views\":{\"axial-1\":{\"document\":{\"kind\":\"axial\",\"size_px\":[9,9]},\"by\":\"m2\"}," \
    "\"3d-1\":{\"document\":{\"kind\":\"3d\",\"at\":1},\"by\":\"m1\"}}," \
    "\"pointers\":{},\"items\":{}," \
    "\"members\":{\"m1\":{\"name\":\"Ann\",\"presenting\":true},\"m2\":{\"name\":\"Ben\"}}"
#define SORTED \
    "\"scene\":{\"scene\":{\"revision\":1,\"scene\":{\"a\":1}}}," \
    "\"views\":{\"3d-1\":{\"document\":{\"kind\":\"3d\",\"at\":1},\"by\":\"m1\"}," \
    "\"axial-1\":{\"document\":{\"kind\":\"axial\",\"size_px\":[9,9]},\"by\":\"m2\"}}," \
    "\"pointers\":{},\"items\":{}," \
    "\"members\":{\"m1\":{\"name\":\"Ann\",\"presenting\":true},\"m2\":{\"name\":\"Ben\"}}"
#define STATE(t_ms, whole) "{\"t_ms\":" #t_ms ",\"part\":\"state\",\"whole\":{" whole "}}"
#define RESIZED(t_ms) \
    "{\"t_ms\":" #t_ms ",\"part\":\"views\",\"id\":\"axial-1\",\"patch\":{\"document\":{\"size_px\":[8,8]}}}"
#define MOVED(t_ms) "{\"t_ms\":" #t_ms ",\"part\":\"views\",\"id\":\"axial-1\",\"patch\":{\"document\":{\"at\":2}}}"
#define POINTED(t_ms) "{\"t_ms\":" #t_ms ",\"part\":\"pointers\",\"id\":\"m2\",\"whole\":{\"view\":1}}"
#define GIVEN(t_ms) \
    "{\"t_ms\":" #t_ms ",\"part\":\"members\",\"id\":\"m1\",\"patch\":{\"presenting\":null}}," \
    "{\"t_ms\":" #t_ms ",\"part\":\"members\",\"id\":\"m2\",\"patch\":{\"presenting\":true}}"

static const char *const meeting[] = { "[" STATE(0, SORTED) "," POINTED(1100) "," MOVED(2300) "]",
                                       "[" GIVEN(4000) "]" };

/* Each step as "time frames kind presenter". */
static void walk(struct recorded_walk *walk, const char *const *texts, size_t n, char said[1024])
{
    struct problem problem = { 0 };
    struct recorded_step step = { 0 };
    said[0] = 0;
    while (!step.is_last) {
        const enum recorded_next next = recorded_walk_next(walk, &step, &problem);
        if (next == RECORDED_WANTED) {
            assert_true(recorded_walk_take(walk, texts, n, INT64_MAX, &problem));
            continue;
        }
        assert_int_equal(next, RECORDED_STEP);
        const char *kind = json_text(step.view, "kind");
        (void)snprintf(said + strlen(said), 1024 - strlen(said), "%s%.0f %d %s %s", said[0] ? ", " : "", step.t_ms,
                       step.n_frames, kind ? kind : "none", step.presenter);
        assert_non_null(step.scene);
        assert_true(strlen(said) < 1000);
    }
}

static void expect(const struct recorded_times *times, const char *expected)
{
    char said[1024];
    struct recorded_walk *walked = recorded_walk_create(times);
    assert_non_null(walked);
    for (int i = 0; i < 2; i++) { /* a second time, as after a renderer's end */
        walk(walked, meeting, 2, said);
        assert_string_equal(said, expected);
        recorded_walk_restart(walked);
    }
    recorded_walk_destroy(walked);
}

/* A picture each second at least, for the clock in its caption, and one at the first frame after each change. */
static void pictures_stand_until_something_changes_or_a_second_is_over(void **state)
{
    (void)state;
    expect(&(struct recorded_times){ .to_ms = 6000, .fps = 5 },
           "0 5 3d Ann, 1000 5 3d Ann, 2000 2 3d Ann, 2400 3 axial Ann, 3000 5 axial Ann, 4000 5 axial Ben, "
           "5000 5 axial Ben");
    expect(&(struct recorded_times){ .from_ms = 3500, .to_ms = 4400, .fps = 5 }, "3500 3 axial Ann, 4100 2 axial Ben");
}

static void a_pause_is_left_out_up_to_the_next_change_or_the_end(void **state)
{
    (void)state;
    expect(&(struct recorded_times){ .to_ms = 60000, .fps = 5, .pause_ms = 2000 },
           "0 5 3d Ann, 1000 5 3d Ann, 2300 4 axial Ann, 3100 5 axial Ann, 4100 5 axial Ben, 5100 5 axial Ben, "
           "60000 1 axial Ben");
}

static void what_opens_or_gets_another_size_is_not_the_view_that_moved(void **state)
{
    static const char *const resized[] = { "[" STATE(0, SORTED) "," RESIZED(500) "]" };
    char said[1024];
    (void)state;
    struct recorded_walk *walked = recorded_walk_create(&(struct recorded_times){ .to_ms = 1500, .fps = 2 });
    walk(walked, resized, 1, said);
    assert_string_equal(said, "0 1 3d Ann, 500 1 3d Ann, 1000 1 3d Ann");
    recorded_walk_destroy(walked);
}

/* The log goes on in a second part, which begins with the same state: no change, so that the pause goes on. */
static void a_part_is_wanted_when_its_time_comes(void **state)
{
    static const char *const first[] = { "[" STATE(0, SORTED) "]" }, *const second[] = { "[" STATE(5000, SORTED) "]" };
    struct problem problem = { 0 };
    struct recorded_step step;
    double t_ms = 0;
    int n_wanted = 0;
    (void)state;
    struct recorded_walk *walked =
        recorded_walk_create(&(struct recorded_times){ .to_ms = 9000, .fps = 1, .pause_ms = 2000 });
    do {
        const enum recorded_next next = recorded_walk_next(walked, &step, &problem);
        if (next == RECORDED_STEP) {
            t_ms = step.t_ms;
            continue;
        }
        assert_int_equal(next, RECORDED_WANTED);
        assert_true(step.t_ms == (n_wanted ? 5000 : 0));
        assert_true(recorded_walk_take(walked, n_wanted ? second : first, 1, n_wanted ? INT64_MAX : 5000, &problem));
        step.is_last = false;
        n_wanted++;
    } while (!step.is_last);
    assert_int_equal(n_wanted, 2);
    assert_float_equal(t_ms, 9000, 0);
    recorded_walk_destroy(walked);
}

static void what_is_damaged_is_refused(void **state)
{
    static const char *const no_state[] = { "[" POINTED(0) "]" }, *const unsorted[] = { "[" STATE(0, MEETING) "]" },
                             *const whole[] = { "[" STATE(0, SORTED) "]" };
    struct problem problem = { 0 };
    struct recorded_step step;
    (void)state;
    struct recorded_walk *walked =
        recorded_walk_create(&(struct recorded_times){ .from_ms = 100, .to_ms = 900, .fps = 5 });
    assert_int_equal(recorded_walk_next(walked, &step, &problem), RECORDED_WANTED);
    assert_false(recorded_walk_take(walked, NULL, 0, INT64_MAX, &problem));
    assert_false(recorded_walk_take(walked, no_state, 1, INT64_MAX, &problem));
    assert_false(recorded_walk_take(walked, unsorted, 1, INT64_MAX, &problem));
    assert_false(recorded_walk_take(walked, whole, 1, 100, &problem)); /* it would be asked for again and again */
    assert_int_equal(recorded_walk_next(walked, &step, &problem), RECORDED_WANTED);
    assert_true(recorded_walk_take(walked, whole, 1, 101, &problem));
    assert_int_equal(recorded_walk_next(walked, &step, &problem), RECORDED_STEP);
    recorded_walk_destroy(walked);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_stand_until_something_changes_or_a_second_is_over),
        cmocka_unit_test(a_pause_is_left_out_up_to_the_next_change_or_the_end),
        cmocka_unit_test(what_opens_or_gets_another_size_is_not_the_view_that_moved),
        cmocka_unit_test(a_part_is_wanted_when_its_time_comes),
        cmocka_unit_test(what_is_damaged_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
