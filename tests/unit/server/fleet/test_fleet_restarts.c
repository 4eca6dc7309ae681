/* Restarts after a renderer has ended: at once, after a pause, or not at all. */
#include <signal.h>
#include <unistd.h>

#include "server/fleet/restarts.h"
#include "tests/check.h"
#include "tests/unit/fake_renderer.h"
#include "tests/unit/fleet_world.h"

static void begin(struct world *world, const char *behave)
{
    world_begin_with_plan(world, behave);
    world_start(world, 1);
}

static void end_it(struct world *world)
{
    assert_int_equal(kill(world_plan_of(world, "a").pid, SIGKILL), 0);
    WORLD_UNTIL(world, world_plan_of(world, "a").state != FLEET_READY);
}

static void pauses_double_from_one_second_to_thirty(void **state)
{
    (void)state;
    static const int expected[] = { 0, 0, 1000, 2000, 4000, 8000, 16000, 30000, 30000, 30000 };
    for (int i = 0; i < 10; i++)
        assert_int_equal(restart_pause_ms(i), expected[i]);
    assert_int_equal(restart_pause_ms(2000000000), 30000);
}

static void one_that_had_drawn_is_started_at_once_however_often_it_ends(void **state)
{
    (void)state;
    struct world world;
    begin(&world, "");
    assert_true(fleet_hold(world.fleet, "a"));
    for (uint32_t i = 1; i <= 10; i++) {
        world_draw(&world, "a");
        assert_int_equal(world_plan_of(&world, "a").generation, i);
        end_it(&world);
        assert_int_equal(world_plan_of(&world, "a").state, FLEET_RESTARTING);
        assert_int_equal(world_plan_of(&world, "a").generation, i + 1); /* its process has been started already */
    }
    world_draw(&world, "a");
    fleet_release(world.fleet, "a");
    world_end(&world);
}

static void one_that_ends_after_each_picture_does_not_use_up_the_machine(void **state)
{
    (void)state;
    struct world world;
    begin(&world, "");
    assert_true(fleet_hold(world.fleet, "a"));
    int64_t began_us = clock_now_us();
    int n = 0;
    for (; n < 100; n++) {
        world_draw(&world, "a");
        uint32_t generation = world_plan_of(&world, "a").generation;
        end_it(&world);
        if (world_plan_of(&world, "a").generation == generation)
            break; /* a pause */
    }
    int64_t elapsed_s = (clock_now_us() - began_us) / 1000000;
    if (elapsed_s < 38) { /* a machine that is slower than that starts less than two a second in any case */
        assert_true(n >= 60 &&
                    n < 62 + elapsed_s); /* a minute's worth at one a second, and one more each second that passed */
    }
    world_draw(&world, "a"); /* it comes back all the same */
    world_end(&world);
}

static void one_that_never_drew_is_tried_again_after_growing_pauses_while_somebody_is_there(void **state)
{
    (void)state;
    static const int expected_ms[] = { 0, 1000, 2000, 4000 };
    struct world world;
    begin(&world, "crash-on-render");
    assert_true(fleet_hold(world.fleet, "a"));
    for (size_t i = 0; i < 4; i++) {
        struct reply reply = { 0 };
        world_wait_for_state(&world, "a", FLEET_READY);
        world_ask(&world, "a", "render", &reply);
        world_wait_for_reply(&world, &reply);
        assert_int_equal(reply.problem.type, PROBLEM_RENDERER);
        assert_int_equal(reply.problem.retry_after_ms, expected_ms[i] + 500);
    }
    assert_int_equal(world_plan_of(&world, "a").state, FLEET_RESTARTING);
    assert_string_equal(world_plan_of(&world, "a").phase,
                        "the renderer stopped (signal 9); it is started again in 4 s");
    WORLD_UNTIL(&world, strcmp(world_plan_of(&world, "a").phase,
                               "the renderer stopped (signal 9); it is started again in 2 s") == 0);
    assert_string_equal(world_plan_of(&world, "a").phase,
                        "the renderer stopped (signal 9); it is started again in 2 s");
    fleet_release(world.fleet, "a"); /* nobody holds it any more: it is not tried again */
    world_wait_for_state(&world, "a", FLEET_CLOSED);
    assert_true(fleet_hold(world.fleet, "a")); /* a viewer enters */
    world_wait_for_state(&world, "a", FLEET_READY);
    world_end(&world);
}

static void a_crash_while_loading_is_tried_again_while_somebody_is_there(void **state)
{
    (void)state;
    struct world world;
    begin(&world, "crash-loading");
    assert_true(fleet_hold(world.fleet, "a"));
    WORLD_UNTIL(&world, world_plan_of(&world, "a").generation >= 3);
    assert_true(world_plan_of(&world, "a").generation >= 3);
    assert_int_not_equal(world_plan_of(&world, "a").state, FLEET_FAILED);
    world_end(&world);
}

static void a_plan_whose_file_is_bad_is_not_tried_again_until_the_file_has_changed(void **state)
{
    (void)state;
    struct world world;
    begin(&world, "fails");
    assert_true(fleet_hold(world.fleet, "a"));
    world_wait_for_state(&world, "a", FLEET_FAILED);
    assert_true(fleet_hold(world.fleet, "a")); /* one more enters */
    world_step_for_ms(&world, 1500);           /* longer than the first pause */
    assert_int_equal(world_plan_of(&world, "a").state, FLEET_FAILED);
    assert_int_equal(world_plan_of(&world, "a").generation, 1);
    assert_string_equal(world_plan_of(&world, "a").problem->detail, "ct.nii: byte 40: 9 axes, expected 3");

    char path[512]; /* until the file's time differs */
    snprintf(path, sizeof path, "%s/a/behave", world.plans);
    assert_int_equal(unlink(path), 0);
    fleet_rescan(world.fleet);
    world_wait_for_state(&world, "a", FLEET_READY);
    world_end(&world);
}

static void a_plan_that_was_read_before_outlives_a_lack_of_memory_at_its_next_start(void **state)
{
    (void)state;
    struct world world;
    begin(&world, "memory-at-second-start");
    assert_true(fleet_hold(world.fleet, "a"));
    world_draw(&world, "a");
    end_it(&world);
    WORLD_UNTIL(&world, world_plan_of(&world, "a").generation == 3 || world_plan_of(&world, "a").state == FLEET_FAILED);
    assert_int_not_equal(world_plan_of(&world, "a").state, FLEET_FAILED);
    world_draw(&world, "a");
    assert_int_equal(world_plan_of(&world, "a").generation, 3);
    world_end(&world);
}

static void one_that_gets_no_further_is_tried_again_while_somebody_is_there(void **state)
{
    (void)state;
    struct world world;
    world_begin_with_plan(&world, "stalls");
    world.options.times.stall = 300;
    world_start(&world, 1);
    assert_true(fleet_hold(world.fleet, "a"));
    WORLD_UNTIL(&world, world_plan_of(&world, "a").generation >= 3 || world_plan_of(&world, "a").state == FLEET_FAILED);
    assert_true(world_plan_of(&world, "a").generation >= 3);
    assert_int_not_equal(world_plan_of(&world, "a").state, FLEET_FAILED);
    world_end(&world);
}

static void one_that_takes_more_memory_than_it_may_is_ended_with_both_figures(void **state)
{
    (void)state;
    struct world world;
    world_begin_with_plan(&world, "takes-shared-memory");
    world.options.max_renderer_bytes = 1 << 20; /* and 256 MiB beyond */
    world.options.times.silent = 60000;         /* it does not answer either */
    world_start(&world, 1);
    world_open_plan(&world, "a");
    world_wait_for_state(&world, "a", FLEET_FAILED);
    const char *detail = world_plan_of(&world, "a").problem->detail;
    assert_non_null(strstr(detail, "MiB of memory, more than the 1 MiB it may and 256 MiB beyond"));
    world_end(&world);
}

static void who_enters_a_plan_without_a_place_gets_one_when_another_leaves(void **state)
{
    (void)state;
    struct world world;
    world_begin_with_plan(&world, "");
    world_add_plan(&world, "b", "");
    world.options.max_renderers = 1;
    world_start(&world, 2);
    assert_true(fleet_hold(world.fleet, "a"));
    assert_true(fleet_hold(world.fleet, "b"));
    world_wait_for_state(&world, "a", FLEET_READY);
    world_wait_for_state(&world, "b", FLEET_FAILED);
    assert_int_equal(world_plan_of(&world, "b").problem->type, PROBLEM_BUSY);
    fleet_release(world.fleet, "a");
    world_wait_for_state(&world, "b", FLEET_READY);
    assert_int_equal(world_plan_of(&world, "a").state, FLEET_CLOSED);
    assert_false(fleet_hold(world.fleet, "nobody"));
    world_end(&world);
}

int main(int argc, char **argv)
{
    if (argc > 1)
        return fake_renderer_main(argc, argv);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pauses_double_from_one_second_to_thirty),
        cmocka_unit_test(one_that_had_drawn_is_started_at_once_however_often_it_ends),
        cmocka_unit_test(one_that_ends_after_each_picture_does_not_use_up_the_machine),
        cmocka_unit_test(one_that_never_drew_is_tried_again_after_growing_pauses_while_somebody_is_there),
        cmocka_unit_test(a_crash_while_loading_is_tried_again_while_somebody_is_there),
        cmocka_unit_test(a_plan_whose_file_is_bad_is_not_tried_again_until_the_file_has_changed),
        cmocka_unit_test(a_plan_that_was_read_before_outlives_a_lack_of_memory_at_its_next_start),
        cmocka_unit_test(one_that_gets_no_further_is_tried_again_while_somebody_is_there),
        cmocka_unit_test(one_that_takes_more_memory_than_it_may_is_ended_with_both_figures),
        cmocka_unit_test(who_enters_a_plan_without_a_place_gets_one_when_another_leaves),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
