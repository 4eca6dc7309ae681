/* Renderers that do not answer; and delays that are not theirs, of a disk or of this process. */
#include <semaphore.h>
#include <signal.h>
#include <stdatomic.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "tests/check.h"
#include "tests/unit/fake_renderer.h"
#include "tests/unit/fleet_world.h"

/* 2 s are promised; 5 s are for machines that are busy with other things, and less than a renderer has while nothing is
 * due. */
static void one_that_was_stopped_is_replaced_soon_while_a_picture_is_due(void **state)
{
    (void)state;
    struct world world;
    struct reply lost = { 0 };
    world_begin_with_plan(&world, "");
    world_start(&world, 1);
    world_open_plan(&world, "a");
    world_draw(&world, "a");
    int64_t began_us = clock_now_us();
    assert_int_equal(kill(world_plan_of(&world, "a").pid, SIGSTOP), 0);
    world_ask(&world, "a", "render", &lost);
    world_wait_for_reply(&world, &lost);
    assert_int_equal(lost.problem.type, PROBLEM_RENDERER);
    world_draw(&world, "a");
    assert_true(clock_now_us() - began_us < 5000000);
    assert_int_equal(world_plan_of(&world, "a").generation, 2);
    world_end(&world);
}

static void one_that_was_stopped_while_nothing_is_due_has_the_longer_time(void **state)
{
    (void)state;
    struct world world;
    world_begin_with_plan(&world, "");
    world.options.times.awaited_ping = 50;
    world.options.times.awaited_silent = 100;
    world_start(&world, 1);
    world_open_plan(&world, "a");
    world_draw(&world, "a");
    world_step_for_ms(&world, 600); /* until it is known that nothing is due */
    assert_int_equal(kill(world_plan_of(&world, "a").pid, SIGSTOP), 0);
    world_step_for_ms(&world, 1500);
    assert_int_equal(world_plan_of(&world, "a").state, FLEET_READY);
    assert_int_equal(kill(world_plan_of(&world, "a").pid, SIGCONT), 0);
    world_draw(&world, "a");
    assert_int_equal(world_plan_of(&world, "a").generation, 1);
    world_end(&world);
}

/* The renderer's main thread computes for 2 s and answers no ping, like one that gets no processor time. */
static void one_whose_main_thread_runs_has_the_longer_time(void **state)
{
    (void)state;
    struct world world;
    struct reply reply = { 0 };
    world_begin_with_plan(&world, "computes");
    world.options.times.awaited_ping = 50;
    world.options.times.awaited_silent = 200;
    world.options.times.silent = 30000;
    world_start(&world, 1);
    world_open_plan(&world, "a");
    world_ask(&world, "a", "probe", &reply);
    world_wait_for_reply(&world, &reply);
    assert_string_equal(reply.type, "probe");
    assert_int_equal(world_plan_of(&world, "a").generation, 1);
    reply_finish(&reply);
    world_end(&world);
}

/* Runs in a child process, which its parent stops and continues. Returns 0 on success. */
static int be_stopped(int told)
{
    struct world world;
    struct reply query = { 0 };
    world_begin_with_plan(&world, "never-draws");
    world.options.times.ping = 100;
    world.options.times.silent = 2000;
    world.options.times.request = 4000;
    world.options.times.stall = 2000;
    world_start(&world, 1);
    world_open_plan(&world, "a");
    world_wait_for_state(&world, "a", FLEET_READY);
    struct reply picture = { 0 };
    world_ask(&world, "a", "render",
              &picture); /* due for a moment only when we are stopped: it is not late after that */
    world_step_for_ms(&world, 300);
    if (write(told, "", 1) != 1)
        return 2;
    world_step_for_ms(&world, 700); /* somewhere in here we are stopped */
    world_step_for_ms(&world, 700);
    world_ask(&world, "a", "probe", &query);
    world_wait_for_reply(&world, &query);
    int result = picture.n > 0                                     ? 3
                 : world_plan_of(&world, "a").generation != 1      ? 4
                 : world_plan_of(&world, "a").state != FLEET_READY ? 5
                                                                   : 0;
    reply_finish(&query);
    world_end(&world);
    return result;
}

static void renderers_and_requests_outlive_that_we_were_stopped_ourselves(void **state)
{
    (void)state;
    int ends[2], status;
    char letter;
    assert_int_equal(pipe(ends), 0);
    pid_t child = fork();
    if (child == 0)
        _exit(be_stopped(ends[1]));
    assert_int_equal(read(ends[0], &letter, 1), 1);
    assert_int_equal(kill(child, SIGSTOP), 0);
    nanosleep(&(struct timespec){ .tv_sec = 6 }, NULL); /* longer than any of its times */
    assert_int_equal(kill(child, SIGCONT), 0);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
    close(ends[0]);
    close(ends[1]);
}

static void one_that_hears_nothing_is_ended_and_started_again(void **state)
{
    (void)state;
    struct world world;
    world_begin_with_plan(&world, "deaf");
    world.options.times.ping = 100;
    world.options.times.silent = 600;
    world_start(&world, 1);
    world_open_plan(&world, "a");
    world_wait_for_state(&world, "a", FLEET_READY);
    world_wait_for_state(&world, "a", FLEET_RESTARTING);
    assert_true(world_plan_of(&world, "a").generation >= 1);
    world_end(&world);
}

static void one_that_answers_pings_lives_on(void **state)
{
    (void)state;
    struct world world;
    world_begin_with_plan(&world, "");
    world.options.times.ping = 50;
    world.options.times.silent = 3000; /* a busy machine may delay it by a second */
    world_start(&world, 1);
    world_open_plan(&world, "a");
    world_wait_for_state(&world, "a", FLEET_READY);
    world_step_for_ms(&world, 4000);
    assert_int_equal(world_plan_of(&world, "a").state, FLEET_READY);
    assert_int_equal(world_plan_of(&world, "a").generation, 1);
    assert_true(world_plan_of(&world, "a").memory_bytes > 100000);
    world_end(&world);
}

static void a_load_that_gets_no_further_fails(void **state)
{
    (void)state;
    struct world world;
    world_begin_with_plan(&world, "stalls");
    world.options.times.stall = 300;
    world_start(&world, 1);
    world_open_plan(&world, "a");
    world_wait_for_state(&world, "a", FLEET_FAILED);
    assert_non_null(strstr(world_plan_of(&world, "a").problem->detail, "got no further"));
    world_end(&world);
}

static void a_picture_that_never_comes_is_a_timeout_and_a_restart(void **state)
{
    (void)state;
    struct world world;
    world_begin_with_plan(&world, "never-draws");
    world.options.times.request = 1000;
    world_start(&world, 1);
    world_open_plan(&world, "a");
    world_wait_for_state(&world, "a", FLEET_READY);
    struct reply reply = { 0 };
    world_ask(&world, "a", "render", &reply);
    world_wait_for_reply(&world, &reply);
    assert_int_equal(reply.problem.type, PROBLEM_TIMEOUT);
    world_wait_for_state(&world, "a", FLEET_RESTARTING);
    world_end(&world);
}

/* The request waits 1.5 s of its 2 s for the plan to be read, so the renderer has half a second for it. */
static void one_that_got_a_request_late_has_the_whole_time_for_a_picture(void **state)
{
    (void)state;
    struct world world;
    world_begin_with_plan(&world, "late-and-never-draws");
    world.options.times.request = 2000;
    world_start(&world, 1);
    struct reply reply = { 0 };
    world_open_plan(&world, "a");
    world_ask(&world, "a", "render", &reply);
    world_wait_for_reply(&world, &reply);
    assert_int_equal(reply.problem.type, PROBLEM_TIMEOUT);
    world_step_for_ms(&world, 500);
    world_wait_for_state(&world, "a", FLEET_READY);
    assert_int_equal(world_plan_of(&world, "a").generation, 1);
    world_end(&world);
}

static void one_that_is_late_with_a_picture_but_draws_others_is_left_alone(void **state)
{
    (void)state;
    struct world world;
    world_begin_with_plan(&world, "forgets-first");
    world.options.times.request = 3000; /* the others are to come within it on a busy machine too */
    world_start(&world, 1);
    world_open_plan(&world, "a");
    world_wait_for_state(&world, "a", FLEET_READY);
    uint32_t generation = world_plan_of(&world, "a").generation;
    struct reply late = { 0 };
    world_ask(&world, "a", "render", &late);
    while (late.n == 0) {
        struct reply reply = { 0 };
        world_ask(&world, "a", "render", &reply);
        world_wait_for_reply(&world, &reply);
        assert_true(reply.is_frame);
        reply_finish(&reply);
    }
    assert_int_equal(late.problem.type, PROBLEM_TIMEOUT);
    world_step_for_ms(&world, 300);
    assert_int_equal(world_plan_of(&world, "a").state, FLEET_READY);
    assert_int_equal(world_plan_of(&world, "a").generation, generation);
    world_end(&world);
}

/* ---- a disk that does not answer -------------------------------------------------------------------------------- */

static sem_t disk_answers;
static atomic_bool is_slow;
static atomic_int n_waiting;

static void list_slowly(const char *const *given, size_t n_given, struct folder_list *list)
{
    atomic_fetch_add(&n_waiting, 1);
    while (atomic_load(&is_slow) && sem_wait(&disk_answers) != 0)
        continue;
    atomic_fetch_sub(&n_waiting, 1);
    folders_list(given, n_given, list);
}

static void a_listing_that_hangs_holds_up_neither_pictures_nor_pings(void **state)
{
    (void)state;
    struct world world;
    assert_int_equal(sem_init(&disk_answers, 0, 0), 0);
    atomic_store(&is_slow, false);
    world_begin_with_plan(&world, "");
    world.options.list_folders = list_slowly;
    world.options.times.ping = 50;
    world.options.times.silent = 1000;
    world_start(&world, 1);
    world_open_plan(&world, "a");
    world_draw(&world, "a");
    atomic_store(&is_slow, true);
    world_add_plan(&world, "b", "");
    fleet_rescan(world.fleet);
    fleet_rescan(world.fleet);
    WORLD_UNTIL(&world, atomic_load(&n_waiting) == 1);
    world_step_for_ms(&world, 2500); /* longer than a renderer may be silent */
    world_draw(&world, "a");
    struct fleet_plan plan;
    assert_false(fleet_plan_find(world.fleet, "b", &plan));
    assert_int_equal(world_plan_of(&world, "a").generation, 1);
    atomic_store(&is_slow, false);
    sem_post(&disk_answers);
    world_wait_for_state(&world, "b", FLEET_CLOSED);
    world_end(&world);
    sem_destroy(&disk_answers);
}

static void before_the_first_listing_a_plan_is_not_known_rather_than_not_there(void **state)
{
    (void)state;
    struct world world;
    struct problem problem = { 0 };
    assert_int_equal(sem_init(&disk_answers, 0, 0), 0);
    atomic_store(&is_slow, true);
    world_begin_with_plan(&world, "");
    world.options.list_folders = list_slowly;
    world_start(&world, 0);
    world_step_for_ms(&world, 100);
    assert_false(fleet_is_listed(world.fleet));
    assert_false(fleet_open(world.fleet, "a", &problem));
    assert_int_equal(problem.type, PROBLEM_BUSY);
    assert_true(problem.retry_after_ms > 0);
    atomic_store(&is_slow, false);
    sem_post(&disk_answers);
    WORLD_UNTIL(&world, fleet_is_listed(world.fleet));
    world_open_plan(&world, "a");
    assert_false(fleet_open(world.fleet, "b", &problem));
    assert_int_equal(problem.type, PROBLEM_NOT_FOUND);
    world_end(&world);
    sem_destroy(&disk_answers);
}

static void a_listing_that_never_ends_does_not_hold_up_the_end(void **state)
{
    (void)state;
    struct world world;
    assert_int_equal(sem_init(&disk_answers, 0, 0), 0);
    atomic_store(&is_slow, true);
    world_begin(&world);
    world.options.list_folders = list_slowly;
    world_start(&world, 0);
    WORLD_UNTIL(&world, atomic_load(&n_waiting) == 1);
    world_end(&world);
    assert_int_equal(atomic_load(&n_waiting), 1); /* the listing still hangs */
    atomic_store(&is_slow, false);
    sem_post(&disk_answers);
    for (int64_t end_us = clock_now_us() + 10000000; atomic_load(&n_waiting) > 0 && clock_now_us() < end_us;)
        nanosleep(&(struct timespec){ .tv_nsec = 10000000 }, NULL);
    assert_int_equal(atomic_load(&n_waiting), 0);
    nanosleep(&(struct timespec){ .tv_nsec = 300000000 }, NULL); /* its thread ends and frees the lister */
}

int main(int argc, char **argv)
{
    if (argc > 1)
        return fake_renderer_main(argc, argv);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(renderers_and_requests_outlive_that_we_were_stopped_ourselves), /* first: it forks */
        cmocka_unit_test(one_that_was_stopped_is_replaced_soon_while_a_picture_is_due),
        cmocka_unit_test(one_that_was_stopped_while_nothing_is_due_has_the_longer_time),
        cmocka_unit_test(one_whose_main_thread_runs_has_the_longer_time),
        cmocka_unit_test(one_that_hears_nothing_is_ended_and_started_again),
        cmocka_unit_test(one_that_answers_pings_lives_on),
        cmocka_unit_test(a_load_that_gets_no_further_fails),
        cmocka_unit_test(a_picture_that_never_comes_is_a_timeout_and_a_restart),
        cmocka_unit_test(one_that_got_a_request_late_has_the_whole_time_for_a_picture),
        cmocka_unit_test(one_that_is_late_with_a_picture_but_draws_others_is_left_alone),
        cmocka_unit_test(a_listing_that_hangs_holds_up_neither_pictures_nor_pings),
        cmocka_unit_test(before_the_first_listing_a_plan_is_not_known_rather_than_not_there),
        cmocka_unit_test(a_listing_that_never_ends_does_not_hold_up_the_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
