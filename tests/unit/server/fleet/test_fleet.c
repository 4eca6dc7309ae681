/* The fleet against a made-up renderer: this program itself, started by the fleet. */
#include <signal.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "tests/check.h"
#include "tests/unit/fake_renderer.h"
#include "tests/unit/fleet_world.h"

static void a_plan_is_listed_opened_drawn_and_closed(void **state)
{
    (void)state;
    struct world world;
    world_begin(&world);
    world_add_plan(&world, "Head of Mr. X", "");
    world_add_plan(&world, "head-of-mr-x", "");
    world_start(&world, 2);
    assert_int_equal(fleet_n_plans(world.fleet), 2);
    struct fleet_plan plan = world_plan_of(&world, "head-of-mr-x");
    assert_string_equal(plan.name, "A plan");
    assert_true(plan.is_phantom);
    assert_int_equal(plan.n_bytes, 77);
    assert_int_equal(plan.state, FLEET_CLOSED);
    world_plan_of(&world, "head-of-mr-x-2");

    struct reply frame = { 0 }, answer = { 0 }, forgotten = { 0 };
    world_open_plan(&world, "head-of-mr-x");
    world_ask(&world, "head-of-mr-x", "render", &frame); /* waits for ready */
    world_wait_for_reply(&world, &frame);
    assert_true(frame.is_frame);
    plan = world_plan_of(&world, "head-of-mr-x");
    assert_int_equal(plan.state, FLEET_READY);
    assert_int_equal(plan.generation, 1);
    assert_non_null(plan.document);
    assert_string_equal(plan.confined, "not at all");
    assert_true(plan.pid > 0);
    assert_non_null(fleet_gl(world.fleet, NULL));
    fleet_forget_request(world.fleet, world_ask(&world, "head-of-mr-x", "probe", &forgotten));
    world_ask(&world, "head-of-mr-x", "probe", &answer);
    world_wait_for_reply(&world, &answer);
    assert_string_equal(answer.type, "probe");
    assert_int_equal(forgotten.n, 0);
    reply_finish(&frame);
    reply_finish(&answer);
    assert_true(world.n_changes >= 2);
    assert_true(atomic_load(&world.n_wakes) > 0);

    pid_t pid = plan.pid;
    fleet_close(world.fleet, "head-of-mr-x");
    assert_int_equal(world_plan_of(&world, "head-of-mr-x").state, FLEET_CLOSED);
    WORLD_UNTIL(&world, kill(pid, 0) != 0);
    assert_int_equal(kill(pid, 0), -1);
    world_end(&world);
}

static void what_cannot_be_read_is_listed_with_the_reason_and_not_opened(void **state)
{
    (void)state;
    struct world world;
    world_begin(&world);
    world_add_plan(&world, "a", "unreadable");
    world_add_plan(&world, "b", "scan-crashes");
    world_add_plan(&world, "c", "scan-babbles");
    world_start(&world, 3);
    static const char *const expected[3] = { "a DICOM folder", "the program that looks at plans stopped (signal 9)",
                                             "looking at the plan printed more than it may" };
    for (int i = 0; i < 3; i++) {
        char id[2] = { (char)('a' + i), 0 };
        struct fleet_plan plan = world_plan_of(&world, id);
        assert_int_equal(plan.state, FLEET_UNREADABLE);
        assert_string_equal(plan.problem->detail, expected[i]);
        struct problem problem = { 0 };
        assert_false(fleet_open(world.fleet, id, &problem));
        assert_int_equal(problem.type, PROBLEM_PLAN_UNREADABLE);
    }
    world_end(&world);
}

/* In a world of its own: a limit short enough for a test may be too short for other tests on a busy machine. */
static void one_that_is_looked_at_for_too_long_is_listed_with_the_reason(void **state)
{
    (void)state;
    struct world world;
    world_begin(&world);
    world_add_plan(&world, "a", "scan-hangs");
    world.options.times.scan = 300;
    world_start(&world, 1);
    assert_int_equal(world_plan_of(&world, "a").state, FLEET_UNREADABLE);
    assert_string_equal(world_plan_of(&world, "a").problem->detail, "looking at the plan took longer than it may");
    world_end(&world);
}

static void a_folder_that_changes_is_looked_at_again(void **state)
{
    (void)state;
    struct world world;
    world_begin(&world);
    world_add_plan(&world, "a", "unreadable");
    world_add_plan(&world, "b", "");
    world_start(&world, 2);
    char path[512];
    snprintf(path, sizeof path, "%s/a/behave", world.plans);
    assert_int_equal(unlink(path), 0);
    snprintf(path, sizeof path, "%s/b", world.plans);
    world_remove_folder(path);
    world_add_plan(&world, "c", "");
    fleet_rescan(world.fleet);
    world_wait_for_state(&world, "a", FLEET_CLOSED);
    world_wait_for_state(&world, "c", FLEET_CLOSED);
    struct fleet_plan plan;
    assert_false(fleet_plan_find(world.fleet, "b", &plan));
    world_end(&world);
}

static void a_crash_while_loading_fails_the_plan_and_says_how(void **state)
{
    (void)state;
    struct world world;
    world_begin(&world);
    world_add_plan(&world, "a", "crash-loading");
    world_add_plan(&world, "b", "fails");
    world_start(&world, 2);
    struct reply reply = { 0 };
    world_open_plan(&world, "a");
    world_open_plan(&world, "b");
    world_ask(&world, "a", "render", &reply);
    world_wait_for_state(&world, "a", FLEET_FAILED);
    world_wait_for_state(&world, "b", FLEET_FAILED);
    assert_string_equal(world_plan_of(&world, "a").problem->detail,
                        "the renderer stopped while reading the plan (signal 9)");
    assert_string_equal(world_plan_of(&world, "b").problem->detail, "ct.nii: byte 40: 9 axes, expected 3");
    assert_int_equal(world_plan_of(&world, "b").problem->type, PROBLEM_PLAN_UNREADABLE);
    world_wait_for_reply(&world, &reply);
    assert_int_equal(reply.problem.type, PROBLEM_RENDERER);
    world_open_plan(&world, "a"); /* tries again */
    assert_int_equal(world_plan_of(&world, "a").state, FLEET_STARTING);
    world_wait_for_state(&world, "a", FLEET_FAILED);
    world_end(&world);
}

static void a_load_that_fails_while_the_folder_is_first_looked_at_stays_failed(void **state)
{
    (void)state;
    struct world world;
    struct fleet_plan plan = { 0 };
    world_begin(&world);
    world_add_plan(&world, "a", "no-memory");
    world_start(&world, 0);
    WORLD_UNTIL(&world, fleet_plan_find(world.fleet, "a", &plan));
    world_open_plan(&world, "a");
    world_wait_for_state(&world, "a", FLEET_FAILED);
    assert_int_equal(cJSON_GetArraySize(world_plan_of(&world, "a").parts), 0); /* its scan has not ended */
    WORLD_UNTIL(&world, cJSON_GetArraySize(world_plan_of(&world, "a").parts) > 0);
    assert_int_equal(cJSON_GetArraySize(world_plan_of(&world, "a").parts), 1);
    plan = world_plan_of(&world, "a");
    assert_int_equal(plan.state, FLEET_FAILED);
    assert_string_equal(plan.problem->detail, "ct.nii: no memory for 1000 bytes");
    world_end(&world);
}

static void a_crash_answers_what_waits_and_the_next_process_draws(void **state)
{
    (void)state;
    struct world world;
    world_begin(&world);
    world_add_plan(&world, "a", "crash-once");
    world_start(&world, 1);
    struct reply first = { 0 }, second = { 0 };
    world_open_plan(&world, "a");
    world_wait_for_state(&world, "a", FLEET_READY);
    world_ask(&world, "a", "render", &first);
    world_wait_for_reply(&world, &first);
    assert_int_equal(first.problem.type, PROBLEM_RENDERER);
    assert_int_equal(world_plan_of(&world, "a").state, FLEET_RESTARTING);
    assert_non_null(world_plan_of(&world, "a").document); /* the document is kept */
    assert_int_equal(world_plan_of(&world, "a").generation,
                     2);                       /* the first restart has no pause: it was started at once */
    world_ask(&world, "a", "render", &second); /* waits for the new process */
    world_wait_for_reply(&world, &second);
    assert_true(second.is_frame);
    assert_int_equal(world_plan_of(&world, "a").generation, 2);
    reply_finish(&second);
    world_end(&world);
}

static void one_that_never_draws_a_picture_is_given_up_after_three_restarts_when_nobody_is_there(void **state)
{
    (void)state;
    struct world world;
    world_begin(&world);
    world_add_plan(&world, "a", "crash-on-render");
    world_start(&world, 1);
    world_open_plan(&world, "a");
    int64_t began_us = clock_now_us();
    for (int i = 0; i < FLEET_MAX_RESTARTS + 1; i++) {
        struct reply reply = { 0 };
        world_wait_for_state(&world, "a", FLEET_READY);
        world_ask(&world, "a", "render", &reply);
        world_wait_for_reply(&world, &reply);
        assert_int_equal(reply.problem.type, PROBLEM_RENDERER);
    }
    assert_int_equal(world_plan_of(&world, "a").state, FLEET_FAILED);
    assert_int_equal(world_plan_of(&world, "a").generation, FLEET_MAX_RESTARTS + 1);
    assert_string_equal(
        world_plan_of(&world, "a").problem->detail,
        "the renderer stopped 4 times without having drawn a picture; the last time it stopped (signal 9)");
    assert_true(clock_now_us() - began_us >= 3000000); /* 0 + 1 + 2 s of waiting */
    world_end(&world);
}

static void closing_cancels_a_load(void **state)
{
    (void)state;
    struct world world;
    world_begin(&world);
    world_add_plan(&world, "a", "loads-for-ever");
    world_start(&world, 1);
    struct reply reply = { 0 };
    world_open_plan(&world, "a");
    world_ask(&world, "a", "render", &reply);
    world_wait_for_state(&world, "a", FLEET_LOADING);
    assert_string_equal(world_plan_of(&world, "a").phase, "reading");
    fleet_close(world.fleet, "a");
    assert_int_equal(world_plan_of(&world, "a").state, FLEET_CLOSED);
    world_wait_for_reply(&world, &reply);
    assert_int_equal(reply.problem.type, PROBLEM_CANCELLED);
    world_end(&world);
}

static void the_longest_unused_plan_makes_room_but_never_a_held_one(void **state)
{
    (void)state;
    struct world world;
    world_begin(&world);
    world_add_plan(&world, "a", "");
    world_add_plan(&world, "b", "");
    world_add_plan(&world, "c", "");
    world_add_plan(&world, "d", "");
    world.options.max_renderers = 2;
    world_start(&world, 4);
    world_open_plan(&world, "a");
    world_wait_for_state(&world, "a", FLEET_READY);
    world_open_plan(&world, "b");
    world_wait_for_state(&world, "b", FLEET_READY);
    assert_true(fleet_hold(world.fleet, "a"));
    world_open_plan(&world, "c");
    assert_int_equal(world_plan_of(&world, "a").state, FLEET_READY);
    assert_int_equal(world_plan_of(&world, "b").state, FLEET_CLOSED);
    world_wait_for_state(&world, "c", FLEET_READY);
    assert_true(fleet_hold(world.fleet, "c"));
    struct problem problem = { 0 };
    assert_false(fleet_open(world.fleet, "d", &problem));
    assert_int_equal(problem.type, PROBLEM_BUSY);
    fleet_release(world.fleet, "a");
    world_open_plan(&world, "d");
    assert_int_equal(world_plan_of(&world, "a").state, FLEET_CLOSED);
    world_end(&world);
}

static void an_idle_plan_is_closed_unless_held(void **state)
{
    (void)state;
    struct world world;
    world_begin(&world);
    world_add_plan(&world, "a", "");
    world_add_plan(&world, "b", "");
    world.options.idle_close_s = 1;
    world_start(&world, 2);
    world_open_plan(&world, "a");
    world_open_plan(&world, "b");
    assert_true(fleet_hold(world.fleet, "b"));
    world_wait_for_state(&world, "a", FLEET_READY);
    world_wait_for_state(&world, "b", FLEET_READY);
    world_wait_for_state(&world, "a", FLEET_CLOSED);
    assert_int_equal(world_plan_of(&world, "b").state, FLEET_READY);
    world_end(&world);
}

static void more_requests_than_the_limit_are_refused_at_once(void **state)
{
    (void)state;
    struct world world;
    world_begin(&world);
    world_add_plan(&world, "a", "stalls");
    world_start(&world, 1);
    struct reply waiting = { 0 }, one_more = { 0 };
    world_open_plan(&world, "a");
    for (int i = 0; i < FLEET_MAX_REQUESTS; i++)
        world_ask(&world, "a", "probe", &waiting);
    world_ask(&world, "a", "probe", &one_more);
    world_wait_for_reply(&world, &one_more);
    assert_int_equal(one_more.problem.type, PROBLEM_BUSY);
    assert_int_equal(waiting.n, 0);
    fleet_close(world.fleet, "a");
    fleet_handle_events(world.fleet);
    assert_int_equal(waiting.n, FLEET_MAX_REQUESTS);
    world_end(&world);
}

static void what_is_asked_of_no_plan_or_a_closed_one_is_refused(void **state)
{
    (void)state;
    struct world world;
    world_begin(&world);
    world_add_plan(&world, "a", "");
    world_start(&world, 1);
    struct reply unknown = { 0 }, closed = { 0 };
    struct problem problem = { 0 };
    assert_false(fleet_open(world.fleet, "nobody", &problem));
    assert_int_equal(problem.type, PROBLEM_NOT_FOUND);
    world_ask(&world, "nobody", "probe", &unknown);
    world_ask(&world, "a", "probe", &closed);
    assert_int_equal(unknown.n, 0); /* only from fleet_handle_events */
    world_wait_for_reply(&world, &unknown);
    world_wait_for_reply(&world, &closed);
    assert_int_equal(unknown.problem.type, PROBLEM_NOT_FOUND);
    assert_int_equal(closed.problem.type, PROBLEM_BUSY);
    world_end(&world);
}

static void the_end_answers_everybody_and_leaves_no_process(void **state)
{
    (void)state;
    struct world world;
    world_begin(&world);
    world_add_plan(&world, "a", "never-draws");
    world_add_plan(&world, "b", "deaf");
    world_start(&world, 2);
    struct reply reply = { 0 };
    world_open_plan(&world, "a");
    world_open_plan(&world, "b");
    world_wait_for_state(&world, "a", FLEET_READY);
    world_wait_for_state(&world, "b", FLEET_READY);
    world_ask(&world, "a", "render", &reply);
    pid_t pids[2] = { world_plan_of(&world, "a").pid, world_plan_of(&world, "b").pid };
    world_end(&world);
    assert_int_equal(reply.n, 1);
    assert_int_equal(reply.problem.type, PROBLEM_CANCELLED);
    for (int i = 0; i < 2; i++)
        assert_int_equal(kill(pids[i], 0), -1);
}

static void a_renderer_that_is_not_there_is_said_at_once(void **state)
{
    (void)state;
    struct world world;
    world_begin(&world);
    world.options.renderer_path = "/nowhere/beamroom-render";
    struct error err = { 0 };
    assert_null(fleet_create(&world.options, &err));
    assert_int_equal(err.code, ERROR_NOT_FOUND);
    world_remove_folder(world.folder);
}

int main(int argc, char **argv)
{
    if (argc > 1)
        return fake_renderer_main(argc, argv);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_plan_is_listed_opened_drawn_and_closed),
        cmocka_unit_test(what_cannot_be_read_is_listed_with_the_reason_and_not_opened),
        cmocka_unit_test(one_that_is_looked_at_for_too_long_is_listed_with_the_reason),
        cmocka_unit_test(a_folder_that_changes_is_looked_at_again),
        cmocka_unit_test(a_crash_while_loading_fails_the_plan_and_says_how),
        cmocka_unit_test(a_load_that_fails_while_the_folder_is_first_looked_at_stays_failed),
        cmocka_unit_test(a_crash_answers_what_waits_and_the_next_process_draws),
        cmocka_unit_test(one_that_never_draws_a_picture_is_given_up_after_three_restarts_when_nobody_is_there),
        cmocka_unit_test(closing_cancels_a_load),
        cmocka_unit_test(the_longest_unused_plan_makes_room_but_never_a_held_one),
        cmocka_unit_test(an_idle_plan_is_closed_unless_held),
        cmocka_unit_test(more_requests_than_the_limit_are_refused_at_once),
        cmocka_unit_test(what_is_asked_of_no_plan_or_a_closed_one_is_refused),
        cmocka_unit_test(the_end_answers_everybody_and_leaves_no_process),
        cmocka_unit_test(a_renderer_that_is_not_there_is_said_at_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
