/* Archives that become plans, against a made-up unpacker: this program itself, started by the fleet. */
#include <dirent.h>
#include <signal.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "tests/check.h"
#include "tests/unit/fake_renderer.h"
#include "tests/unit/fleet_world.h"

static int n_archives;

/* unpack_ms: how long the unpacker may be silent; 0 the default */
static void start_with(struct world *world, int unpack_ms)
{
    world_begin(world);
    world_add_plan(world, "head", "");
    world->options.times.unpack = unpack_ms;
    world_start(world, 1);
}

static void start(struct world *world)
{
    start_with(world, 0);
}

static size_t n_in(const struct world *world, const char *name)
{
    char path[200];
    size_t n = 0;
    snprintf(path, sizeof path, "%s/%s", world->data, name);
    DIR *folder = opendir(path);
    assert_non_null(folder);
    for (const struct dirent *entry; (entry = readdir(folder));)
        n += entry->d_name[0] != '.';
    closedir(folder);
    return n;
}

static uint64_t try_upload(struct world *world, const char *name, const char *inside, struct problem *problem)
{
    char path[200];
    snprintf(path, sizeof path, "%s/uploads/%d.part", world->data, ++n_archives);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(inside, file);
    fclose(file);
    return fleet_upload(world->fleet, path, name, problem);
}

static uint64_t begin_upload(struct world *world, const char *name, const char *inside)
{
    struct problem problem = { 0 };
    uint64_t number = try_upload(world, name, inside, &problem);
    assert_string_equal(problem.detail, "");
    assert_true(number > 0);
    return number;
}

static struct fleet_upload upload_of(struct world *world, uint64_t number)
{
    struct fleet_upload upload;
    assert_true(fleet_upload_find(world->fleet, number, &upload));
    return upload;
}

static struct fleet_upload wait_for_end(struct world *world, uint64_t number)
{
    WORLD_UNTIL(world, upload_of(world, number).state > UPLOAD_RUNNING);
    return upload_of(world, number);
}

static void wait_until_empty(struct world *world)
{
    WORLD_UNTIL(world, n_in(world, "uploads") == 0);
    assert_int_equal(n_in(world, "uploads"), 0);
}

static void assert_fails(const char *inside, enum problem_type type, const char *says)
{
    struct world world;
    start_with(&world, strcmp(inside, "hangs") == 0 ? 400 : 0);
    struct fleet_upload upload = wait_for_end(&world, begin_upload(&world, "x.zip", inside));
    assert_int_equal(upload.state, UPLOAD_FAILED);
    assert_int_equal(upload.problem->type, type);
    if (!strstr(upload.problem->detail, says))
        fail_msg("\"%s\" does not say \"%s\"", upload.problem->detail, says);
    assert_null(upload.plan_id);
    wait_until_empty(&world);
    assert_int_equal(n_in(&world, "plans"), 0);
    assert_int_equal(fleet_n_plans(world.fleet), 1);
    world_end(&world);
}

static void an_archive_becomes_a_plan_and_goes_again(void **state)
{
    (void)state;
    struct world world;
    struct problem problem = { 0 };
    char path[200];
    start(&world);
    struct fleet_upload upload = wait_for_end(&world, begin_upload(&world, "Mr. X.tar.gz", "wrapped/ready"));
    assert_int_equal(upload.state, UPLOAD_DONE);
    assert_close(upload.percent, 100, 0);
    assert_string_equal(upload.plan_id, "mr-x");
    struct fleet_plan plan = world_plan_of(&world, "mr-x");
    assert_true(plan.is_uploaded);
    assert_int_equal(cJSON_GetArraySize(plan.parts), 1); /* done means that it was scanned */
    assert_false(world_plan_of(&world, "head").is_uploaded);
    snprintf(path, sizeof path, "%s/plans/mr-x/behave", world.data); /* without the folder around it */
    assert_int_equal(access(path, F_OK), 0);
    wait_until_empty(&world);

    world_open_plan(&world, "mr-x");
    world_wait_for_state(&world, "mr-x", FLEET_READY);
    pid_t pid = world_plan_of(&world, "mr-x").pid;
    assert_int_equal(n_in(&world, "cache"), 1);
    assert_true(fleet_remove_plan(world.fleet, "mr-x", &problem));
    assert_false(fleet_plan_find(world.fleet, "mr-x", &plan)); /* at once */
    assert_int_equal(n_in(&world, "plans"), 0);
    assert_int_equal(n_in(&world, "cache"), 0);
    wait_until_empty(&world);
    WORLD_UNTIL(&world, kill(pid, 0) != 0 && fleet_n_plans(world.fleet) == 1); /* its end is reported by an event */
    assert_int_equal(kill(pid, 0), -1);
    assert_int_equal(fleet_n_plans(world.fleet), 1);
    assert_false(fleet_remove_plan(world.fleet, "mr-x", &problem));
    assert_int_equal(problem.type, PROBLEM_NOT_FOUND);
    world_end(&world);
}

/* The other id: 16 digits of sha256sum of "uploads/mr-x". */
static void a_plan_is_erased_by_either_id_with_its_caches_under_both(void **state)
{
    (void)state;
    static const char hidden[] = "7b9238705ce83b32";
    struct world world;
    struct problem problem = { 0 };
    struct fleet_erase what;
    char path[1200];
    for (int hides = 0; hides < 2; hides++) {
        world_begin(&world);
        world_add_plan(&world, "head", "");
        world.options.hides_folders = hides;
        world_start(&world, 1);
        const char *id = hides ? hidden : "mr-x", *other = hides ? "mr-x" : hidden;
        assert_string_equal(wait_for_end(&world, begin_upload(&world, "Mr. X.tar.gz", "wrapped/ready")).plan_id, id);
        wait_until_empty(&world);
        for (int i = 0; i < 2; i++) {
            fleet_erase_of(world.fleet, i ? other : id, &what);
            assert_string_equal(what.id, id);
            assert_string_equal(what.other_id, other);
            assert_string_equal(what.folder, "plans/mr-x");
            assert_memory_equal(what.cache, "cache/", 6);
            assert_string_equal(what.cache + 6, id);
            assert_string_equal(what.other_cache + 6, other);
            snprintf(path, sizeof path, "%s/%s", world.data, i ? what.cache : what.other_cache);
            assert_int_equal(mkdir(path, 0700), 0);
        }
        assert_true(fleet_erase_plan(world.fleet, hides ? id : other, &problem));
        assert_int_equal(n_in(&world, "cache"), 0);
        assert_int_equal(n_in(&world, "plans"), 0);
        fleet_erase_of(world.fleet, "mr-x", &what);
        assert_string_equal(what.id, "mr-x");
        assert_string_equal(what.folder, "");
        assert_string_equal(what.cache, "cache/mr-x");
        assert_string_equal(what.other_id, "");
        assert_string_equal(what.other_cache, "");
        world_end(&world);
    }
}

static void a_plan_of_a_configured_folder_is_never_removed(void **state)
{
    (void)state;
    struct world world;
    struct problem problem = { 0 };
    start(&world);
    assert_false(fleet_remove_plan(world.fleet, "head", &problem));
    assert_int_equal(problem.type, PROBLEM_FORBIDDEN);
    assert_string_equal(world_plan_of(&world, "head").id, "head");
    world_end(&world);
}

static void plans_of_one_name_get_numbers_and_keep_them(void **state)
{
    (void)state;
    struct world world;
    struct error err = { 0 };
    start(&world);
    assert_string_equal(wait_for_end(&world, begin_upload(&world, "Head", "a/")).plan_id,
                        "head-2"); /* beside the one that is read */
    assert_string_equal(wait_for_end(&world, begin_upload(&world, "head.zip", "a/")).plan_id, "head-3");
    assert_string_equal(wait_for_end(&world, begin_upload(&world, "../../etc", "a/")).plan_id, "etc");
    assert_string_equal(wait_for_end(&world, begin_upload(&world, "***.zip", "a/")).plan_id,
                        "plan"); /* nothing of it is left */
    fleet_destroy(world.fleet);
    world.fleet = NULL;
    world_start(&world, 5);
    assert_string_equal(err.text, "");
    assert_true(world_plan_of(&world, "head-2").is_uploaded);
    assert_true(world_plan_of(&world, "head-3").is_uploaded);
    assert_false(world_plan_of(&world, "head").is_uploaded);
    world_end(&world);
}

static void a_plan_without_a_name_is_called_after_the_day(void **state)
{
    (void)state;
    struct world world;
    start(&world);
    for (int i = 0; i < 2; i++) {
        const char *id = wait_for_end(&world, begin_upload(&world, "", "a/")).plan_id;
        int year, month, day, number = 1, n = sscanf(id, "upload-%4d-%2d-%2d-%d", &year, &month, &day, &number);
        assert_true(n == 3 || (n == 4 && i > 0 && number == 2)); /* another day may have begun */
        assert_in_range(year, 2020, 9999);
        assert_in_range(month, 1, 12);
        assert_in_range(day, 1, 31);
    }
    world_end(&world);
}

static void a_plan_removed_while_it_is_looked_at_stays_away_and_its_name_is_free(void **state)
{
    (void)state;
    struct world world;
    struct problem problem = { 0 };
    start(&world);
    for (int i = 0; i < 3; i++) {
        assert_string_equal(wait_for_end(&world, begin_upload(&world, "again", "a/")).plan_id, "again");
        fleet_rescan(world.fleet);
        assert_true(fleet_remove_plan(world.fleet, "again", &problem));
    }
    for (int i = 0; i < 50; i++)
        world_step(&world);
    assert_int_equal(fleet_n_plans(world.fleet), 1);
    world_end(&world);
}

static void what_cannot_be_unpacked_says_why(void **state)
{
    (void)state;
    assert_fails("refuses", PROBLEM_VALIDATION, "entry 3 leads out");
    assert_fails("dies", PROBLEM_PLAN_UNREADABLE, "signal 9");
    assert_fails("says-nothing", PROBLEM_PLAN_UNREADABLE, "said nothing");
    assert_fails("hangs", PROBLEM_PLAN_UNREADABLE, "longer than it may");
    assert_fails("one-line", PROBLEM_PLAN_UNREADABLE, "printed more");
}

static void what_is_no_plan_says_why(void **state)
{
    (void)state;
    assert_fails("a/unreadable", PROBLEM_PLAN_UNREADABLE, "a DICOM folder");
    assert_fails("a/scan-crashes", PROBLEM_PLAN_UNREADABLE, "signal 9");
}

static void impossible_progress_is_not_believed(void **state)
{
    (void)state;
    struct world world;
    start(&world);
    uint64_t number = begin_upload(&world, "x", "lies");
    double most = 0, now = 0;
    for (int64_t until_us = clock_now_us() + 60000000; now != 12.75 && clock_now_us() < until_us; world_step(&world)) {
        now = upload_of(&world, number).percent;
        most = now > most ? now : most;
        assert_close(now, most, 0); /* never decreases */
    }
    assert_close(most, 12.75, 0); /* the last one reported */
    world_end(&world);
}

static void one_that_is_slow_but_says_so_is_left_alone(void **state)
{
    (void)state;
    struct world world;
    start_with(&world, 3000); /* it takes four seconds and is never silent for longer than a tenth */
    assert_int_equal(wait_for_end(&world, begin_upload(&world, "x", "slow")).state, UPLOAD_DONE);
    world_end(&world);
}

static void cancelling_ends_the_unpacker_and_leaves_nothing(void **state)
{
    (void)state;
    struct world world;
    start(&world);
    uint64_t hanging = begin_upload(&world, "x", "hangs"), flooding = begin_upload(&world, "y", "floods");
    uint64_t waiting = begin_upload(&world, "z", "a/");
    assert_int_equal(upload_of(&world, waiting).state, UPLOAD_QUEUED); /* two at once */
    WORLD_UNTIL(&world, upload_of(&world, hanging).percent >= 12 && upload_of(&world, flooding).percent >= 13);
    assert_close(upload_of(&world, hanging).percent, 12.5, 0);
    assert_string_equal(upload_of(&world, hanging).phase, "unpacking");
    fleet_upload_cancel(world.fleet, hanging);
    fleet_upload_cancel(world.fleet, flooding);
    assert_int_equal(upload_of(&world, hanging).state, UPLOAD_CANCELLED);
    assert_int_equal(wait_for_end(&world, waiting).state, UPLOAD_DONE); /* its turn came */
    fleet_upload_cancel(world.fleet, waiting);
    assert_int_equal(upload_of(&world, waiting).state, UPLOAD_DONE); /* an ended upload is still known */
    wait_until_empty(&world);
    assert_int_equal(upload_of(&world, hanging).state, UPLOAD_CANCELLED);
    assert_int_equal(n_in(&world, "plans"), 1);
    world_end(&world);
}

/* The flood's own end is reported after its lines; were all of them queued, it would come after hundreds of turns. */
static void a_flood_of_progress_does_not_hold_up_what_is_reported_after_it(void **state)
{
    (void)state;
    struct world world;
    start(&world);
    uint64_t flooding = begin_upload(&world, "y", "floods");
    WORLD_UNTIL(&world, upload_of(&world, flooding).percent >= 13);
    nanosleep(&(struct timespec){ .tv_sec = 1 }, NULL); /* nobody takes what is reported */
    fleet_upload_cancel(world.fleet, flooding);
    int n_turns = 0;
    while (n_in(&world, "uploads") > 0 && n_turns++ < 30) {
        nanosleep(&(struct timespec){ .tv_nsec = 100000000 }, NULL);
        fleet_handle_events(world.fleet);
    }
    assert_int_equal(n_in(&world, "uploads"), 0);
    world_end(&world);
}

static void more_archives_than_the_limit_are_refused_and_removed(void **state)
{
    (void)state;
    struct world world;
    struct problem problem = { 0 };
    uint64_t numbers[FLEET_MAX_UPLOADS];
    start(&world);
    for (int i = 0; i < FLEET_MAX_UPLOADS; i++)
        numbers[i] = begin_upload(&world, "x", "hangs");
    assert_int_equal(try_upload(&world, "x", "hangs", &problem), 0);
    assert_int_equal(problem.type, PROBLEM_LIMIT);
    assert_true(problem.retry_after_ms > 0);
    for (int i = FLEET_MAX_UPLOADS; i-- > 0;)
        fleet_upload_cancel(world.fleet, numbers[i]);
    wait_until_empty(&world);
    begin_upload(&world, "x", "a/");
    world_end(&world);
}

static void what_an_earlier_run_left_is_removed_at_start(void **state)
{
    (void)state;
    struct world world;
    char path[300];
    world_begin(&world);
    snprintf(path, sizeof path, "%s/uploads", world.data);
    mkdir(path, 0700);
    snprintf(path, sizeof path, "%s/uploads/3", world.data);
    mkdir(path, 0700);
    snprintf(path, sizeof path, "%s/uploads/3/deep", world.data);
    mkdir(path, 0700);
    snprintf(path, sizeof path, "%s/uploads/link", world.data);
    assert_int_equal(symlink(world.plans, path), 0);
    world_add_plan(&world, "kept", "");
    world_start(&world, 1);
    wait_until_empty(&world);
    assert_string_equal(world_plan_of(&world, "kept").id, "kept"); /* the link went, not what it points to */
    world_end(&world);
}

int main(int argc, char **argv)
{
    if (argc > 1)
        return fake_renderer_main(argc, argv);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_archive_becomes_a_plan_and_goes_again),
        cmocka_unit_test(a_plan_is_erased_by_either_id_with_its_caches_under_both),
        cmocka_unit_test(a_plan_of_a_configured_folder_is_never_removed),
        cmocka_unit_test(plans_of_one_name_get_numbers_and_keep_them),
        cmocka_unit_test(a_plan_without_a_name_is_called_after_the_day),
        cmocka_unit_test(a_plan_removed_while_it_is_looked_at_stays_away_and_its_name_is_free),
        cmocka_unit_test(what_cannot_be_unpacked_says_why),
        cmocka_unit_test(what_is_no_plan_says_why),
        cmocka_unit_test(impossible_progress_is_not_believed),
        cmocka_unit_test(one_that_is_slow_but_says_so_is_left_alone),
        cmocka_unit_test(cancelling_ends_the_unpacker_and_leaves_nothing),
        cmocka_unit_test(a_flood_of_progress_does_not_hold_up_what_is_reported_after_it),
        cmocka_unit_test(more_archives_than_the_limit_are_refused_and_removed),
        cmocka_unit_test(what_an_earlier_run_left_is_removed_at_start),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
