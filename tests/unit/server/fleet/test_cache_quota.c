/* The quota on data/cache, with folders made by the test in place of the renderers'. */
#define _GNU_SOURCE
#include "server/fleet/cache_quota.h"

#include <fcntl.h>
#include <pthread.h>
#include <stdatomic.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "tests/check.h"
#include "tests/unit/fleet_world.h"

#define MIB (UINT64_C(1) << 20)

struct fixture {
    char folder[64];
    struct cache_quota *cache;
    atomic_int n_ended;
    _Atomic uint64_t ended[8]; /* processes, in the order they were ended */
    char reason[160];          /* of the first */
};

static void end_one(void *context, uint64_t process, const char *reason)
{
    struct fixture *fixture = context;
    int n = atomic_load(&fixture->n_ended);
    if (n == 0)
        snprintf(fixture->reason, sizeof fixture->reason, "%s", reason);
    if (n < 8)
        atomic_store(&fixture->ended[n], process);
    atomic_fetch_add(&fixture->n_ended, 1);
}

static struct fixture quota; /* of the test that runs */

static int begin(void **state)
{
    (void)state;
    memset(&quota, 0, sizeof quota);
    snprintf(quota.folder, sizeof quota.folder, "/tmp/beamroom-cache-XXXXXX");
    return mkdtemp(quota.folder) ? 0 : -1;
}

static int finish(void **state)
{
    (void)state;
    cache_quota_destroy(quota.cache);
    world_remove_folder(quota.folder);
    return 0;
}

static char *path_of(const struct fixture *fixture, const char *name)
{
    static char path[256];
    snprintf(path, sizeof path, "%s/%s", fixture->folder, name);
    return path;
}

/* A plan's folder with one file, last used so many hours ago. */
static void add(const struct fixture *fixture, const char *id, uint64_t n_bytes, int hours)
{
    char name[80];
    struct timespec now, times[2];
    (void)mkdir(path_of(fixture, id), 0700);
    snprintf(name, sizeof name, "%s/plan.cache", id);
    int file = open(path_of(fixture, name), O_RDWR | O_CREAT, 0600);
    assert_true(file >= 0);
    assert_int_equal(posix_fallocate(file, 0, (off_t)n_bytes), 0);
    close(file);
    clock_gettime(CLOCK_REALTIME, &now);
    times[0] = times[1] = (struct timespec){ .tv_sec = now.tv_sec - hours * 3600 };
    assert_int_equal(utimensat(AT_FDCWD, path_of(fixture, id), times, 0), 0);
}

static bool is_there(const struct fixture *fixture, const char *name)
{
    return access(path_of(fixture, name), F_OK) == 0;
}

#define UNTIL(condition) \
    do { \
        for (int64_t until_us_ = clock_now_us() + 60000000; !(condition) && clock_now_us() < until_us_;) \
            nanosleep(&(struct timespec){ .tv_nsec = 5000000 }, NULL); \
        assert_true(condition); \
    } while (0)

/* Returns when the thread has looked once: what is added later counts as written by a renderer. */
static void start(struct fixture *fixture, uint64_t max_bytes, uint64_t reserve_bytes)
{
    struct error err = { 0 };
    struct cache_quota_options options = { fixture->folder, max_bytes, reserve_bytes, end_one, fixture };
    add(fixture, "oldest", max_bytes + MIB, 10000);
    fixture->cache = cache_quota_create(&options, &err);
    assert_string_equal(err.text, "");
    UNTIL(!is_there(fixture, "oldest/plan.cache"));
}

static void the_longest_unused_go_first(void **state)
{
    (void)state;
    add(&quota, "second", 2 * MIB, 20);
    add(&quota, "first", 2 * MIB, 30);
    add(&quota, "last", 2 * MIB, 1);
    add(&quota, "third", 2 * MIB, 10);
    start(&quota, 5 * MIB, 0); /* two of four have place */
    UNTIL(!is_there(&quota, "first/plan.cache") && !is_there(&quota, "second/plan.cache"));
    assert_true(is_there(&quota, "third/plan.cache") && is_there(&quota, "last/plan.cache"));
    assert_int_equal(quota.n_ended, 0);
}

static void what_is_in_use_goes_last(void **state)
{
    (void)state;
    add(&quota, "used", 2 * MIB, 30);
    add(&quota, "unused", 2 * MIB, 1);
    start(&quota, 5 * MIB, 0);
    cache_quota_begin(quota.cache, "used", 7);
    add(&quota, "used", 4 * MIB, 30); /* it writes: 6 MiB together */
    UNTIL(!is_there(&quota, "unused/plan.cache"));
    assert_true(is_there(&quota, "used/plan.cache"));
    add(&quota, "other", 2 * MIB, 30);
    cache_quota_begin(quota.cache, "other", 8);
    UNTIL(!is_there(&quota, "used/plan.cache")); /* both are in use: the one that began earlier */
    assert_true(is_there(&quota, "other/plan.cache") && is_there(&quota, "used"));
    assert_int_equal(quota.n_ended, 0);
}

static void is_ended_and_emptied(struct fixture *at)
{
    UNTIL(at->n_ended > 0);
    assert_true(at->ended[0] == 7);
    assert_non_null(strstr(at->reason, "wrote more to its cache"));
    cache_quota_end(at->cache, 7);
    UNTIL(rmdir(path_of(at, "a")) == 0 ||
          !is_there(at, "a")); /* empty; the folder itself stays for the next renderer */
    assert_int_equal(at->n_ended, 1);
}

static void a_renderer_that_writes_too_much_is_ended_and_its_cache_emptied(void **state)
{
    (void)state;
    start(&quota, 2 * MIB, 0);
    add(&quota, "a", MIB, 0);
    cache_quota_begin(quota.cache, "a", 7);
    /* 2 and 64 of slack. A file that is seen while it grows is over the quota of all and is removed: then it writes
     * again. */
    UNTIL((add(&quota, "a", 67 * MIB, 0), quota.n_ended > 0));
    is_ended_and_emptied(&quota);
}

/* 300 nested folders: no path is long enough for the last, and its files still count. */
static void a_cache_deeper_than_any_honest_one_ends_its_renderer(void **state)
{
    (void)state;
    start(&quota, 100 * MIB, 0);
    add(&quota, "a", MIB, 0);
    int folder = open(path_of(&quota, "a"), O_RDONLY | O_DIRECTORY);
    char name[] = "a-name-of-some-length-to-make-the-path-long";
    for (int i = 0; i < 300; i++) {
        assert_int_equal(mkdirat(folder, name, 0700), 0);
        int inner = openat(folder, name, O_RDONLY | O_DIRECTORY);
        close(folder);
        folder = inner;
    }
    close(folder);
    cache_quota_begin(quota.cache, "a", 7);
    is_ended_and_emptied(&quota);
}

static void a_folder_that_cannot_be_seen_ends_its_renderer(void **state)
{
    (void)state;
    if (geteuid() == 0)
        skip(); /* root sees all */
    start(&quota, 100 * MIB, 0);
    add(&quota, "a", MIB, 0);
    assert_int_equal(mkdir(path_of(&quota, "a/dark"), 0300), 0);
    assert_int_equal(mkdir(path_of(&quota, "a/dark/inner"), 0300), 0);
    cache_quota_begin(quota.cache, "a", 7);
    is_ended_and_emptied(&quota);
}

static void more_files_than_any_honest_cache_has_end_its_renderer(void **state)
{
    (void)state;
    start(&quota, 100 * MIB, 0);
    add(&quota, "a", MIB, 0);
    int folder = open(path_of(&quota, "a"), O_RDONLY | O_DIRECTORY);
    for (int i = 0; i < CACHE_QUOTA_MAX_FILES; i++) { /* one is there */
        char name[32];
        snprintf(name, sizeof name, "%d", i);
        int file = openat(folder, name, O_RDWR | O_CREAT, 0600);
        assert_true(file >= 0);
        close(file);
    }
    close(folder);
    cache_quota_begin(quota.cache, "a", 7);
    is_ended_and_emptied(&quota);
}

/* A reserve larger than any disk: unused caches are removed, then each renderer is ended once, the newest first. */
static void a_full_disk_costs_caches_first_and_then_each_renderer_once(void **state)
{
    (void)state;
    add(&quota, "unused", MIB, 3);
    add(&quota, "old", MIB, 2);
    add(&quota, "new", MIB, 1);
    start(&quota, 100 * MIB, UINT64_MAX);
    UNTIL(!is_there(&quota, "unused/plan.cache") && !is_there(&quota, "old/plan.cache") &&
          !is_there(&quota, "new/plan.cache"));
    cache_quota_begin(quota.cache, "old", 7);
    cache_quota_begin(quota.cache, "new", 8);
    UNTIL(quota.n_ended >= 2);
    cache_quota_end(quota.cache, quota.ended[0]);
    cache_quota_end(quota.cache, quota.ended[1]);
    cache_quota_begin(quota.cache, "old", 9);                                 /* started again */
    nanosleep(&(struct timespec){ .tv_sec = 2, .tv_nsec = 500000000 }, NULL); /* two looks at least */
    assert_int_equal(quota.n_ended, 2);
    assert_int_equal(quota.ended[0] + quota.ended[1], 15);
}

/* A renderer that makes files as fast as they are removed must not keep the thread from other folders. */
static void *make_files(void *argument)
{
    const struct fixture *at = argument;
    char path[256];
    for (unsigned long n = 0; at->n_ended == 0; n++) {
        snprintf(path, sizeof path, "%s/busy/%lu", at->folder, n % 5000);
        int file = open(path, O_RDWR | O_CREAT, 0600);
        if (file >= 0 && write(file, path, sizeof path) > 0)
            close(file);
    }
    return NULL;
}

static void one_that_fills_its_cache_as_fast_as_it_is_emptied_keeps_nobody_waiting(void **state)
{
    (void)state;
    pthread_t threads[2];
    start(&quota, 2 * MIB, 0);
    add(&quota, "busy", 3 * MIB, 0);
    cache_quota_begin(quota.cache, "busy", 8); /* is over the quota of all at once, and is emptied while it runs */
    for (int i = 0; i < 2; i++)
        assert_int_equal(pthread_create(&threads[i], NULL, make_files, &quota), 0);
    UNTIL(!is_there(&quota, "busy/plan.cache"));
    add(&quota, "a", 67 * MIB, 0);
    cache_quota_begin(quota.cache, "a", 7);
    UNTIL(quota.n_ended > 0);
    for (int i = 0; i < 2; i++)
        pthread_join(threads[i], NULL);
}

static void an_end_for_the_quota_empties_the_folder_and_leaves_it(void **state)
{
    (void)state;
    start(&quota, 2 * MIB, 0);
    add(&quota, "a", 67 * MIB, 0);
    cache_quota_begin(quota.cache, "a", 7);
    UNTIL(quota.n_ended > 0);
    cache_quota_begin(quota.cache, "a", 8); /* before the end of the other is told */
    UNTIL(!is_there(&quota, "a/plan.cache"));
    assert_true(is_there(&quota, "a"));
    assert_int_equal(quota.n_ended, 1);
}

int main(void)
{
#define T(name) cmocka_unit_test_setup_teardown(name, begin, finish)
    const struct CMUnitTest tests[] = {
        T(the_longest_unused_go_first),
        T(what_is_in_use_goes_last),
        T(a_renderer_that_writes_too_much_is_ended_and_its_cache_emptied),
        T(a_cache_deeper_than_any_honest_one_ends_its_renderer),
        T(a_folder_that_cannot_be_seen_ends_its_renderer),
        T(more_files_than_any_honest_cache_has_end_its_renderer),
        T(one_that_fills_its_cache_as_fast_as_it_is_emptied_keeps_nobody_waiting),
        T(an_end_for_the_quota_empties_the_folder_and_leaves_it),
        T(a_full_disk_costs_caches_first_and_then_each_renderer_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
