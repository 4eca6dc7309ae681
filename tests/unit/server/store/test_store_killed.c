/* A process that writes is killed at random moments: what it was told is on disk must be there, and nothing torn. */
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/store_world.h"

enum { N_ROOMS = 3, N_KILLED = 24, N_KILLED_LONG = 300, MOST_US = 60000 };

struct told { /* on the pipe */
    uint32_t room, revision;
};

static size_t scene_bytes(uint32_t revision) /* of one revision always the same; small ones and some of many pages */
{
    return 100 + revision * 7919U % 30000U;
}

static void room_name(uint32_t room, char id[16])
{
    (void)snprintf(id, 16, "room-%u", room);
}

/* Writes revision after revision of all rooms, two at a time of each, and tells what is on disk; never returns. */
static void write_until_killed(struct store_world *world, int pipe_fd, const uint32_t from[N_ROOMS])
{
    uint32_t revision[N_ROOMS];
    memcpy(revision, from, sizeof revision);
    store_world_open(world);
    store_answer_free(store_world_await(world, STORE_OPENED));
    for (uint32_t i = 0; i < 2 * N_ROOMS; i++) {
        char id[16];
        uint32_t room = i % N_ROOMS, next = ++revision[room];
        room_name(room, id);
        (void)store_write(world->store, store_made_room(id, next, scene_bytes(next), 1 + next % 5),
                          (uint64_t)room << 32 | next);
    }
    for (;;) {
        char id[16];
        struct store_answer *answer = store_world_await(world, STORE_WRITTEN);
        const struct told told = { (uint32_t)(answer->ticket >> 32), (uint32_t)answer->ticket };
        store_answer_free(answer);
        if (write(pipe_fd, &told, sizeof told) != sizeof told)
            _exit(1);
        uint32_t next = ++revision[told.room];
        room_name(told.room, id);
        (void)store_write(world->store, store_made_room(id, next, scene_bytes(next), 1 + next % 5),
                          (uint64_t)told.room << 32 | next);
    }
}

/* Reopens the file; each room must be whole and at least as new as was told. */
static void check(struct store_world *world, uint32_t told[N_ROOMS])
{
    store_world_open(world);
    struct store_answer *opened = store_world_await(world, STORE_OPENED);
    assert_false(opened->is_new);
    store_answer_free(opened);
    for (uint32_t i = 0; i < N_ROOMS; i++) {
        char id[16];
        room_name(i, id);
        struct store_room *room = store_world_read(world, id);
        if (!room) {
            assert_int_equal(told[i], 0);
            continue;
        }
        assert_in_range(room->revision, told[i], told[i] + 2); /* two more were under way */
        assert_int_equal(strlen(room->scene), scene_bytes(room->revision) + 2);
        assert_int_equal(room->n_members, 1 + room->revision % 5);
        told[i] = room->revision;
        store_room_free(room);
    }
    store_world_close(world);
}

static void what_was_acknowledged_is_there_after_the_process_was_killed(void **state)
{
    (void)state;
    struct store_world world = { 0 };
    uint32_t told[N_ROOMS] = { 0 };
    const char *faults = getenv("FAULTS");
    const bool is_long = getenv("LONG_TESTS") || (faults && strcmp(faults, "whole") == 0);
    const char *kills = getenv("KILLS");
    const long n_kills = kills ? strtol(kills, NULL, 10) : is_long ? N_KILLED_LONG : N_KILLED;
    folder_make(world.folder);
    srand((unsigned)clock_now_us());
    for (long n = 0; n < n_kills; n++) {
        int fds[2];
        struct told one;
        assert_int_equal(pipe(fds), 0);
        pid_t child = fork();
        assert_true(child >= 0);
        if (child == 0) {
            (void)close(fds[0]);
            write_until_killed(&world, fds[1], told);
        }
        (void)close(fds[1]);
        assert_int_equal(read(fds[0], &one, sizeof one), sizeof one); /* it writes; else it ended by itself */
        told[one.room] = one.revision;
        (void)usleep((useconds_t)(rand() % MOST_US));
        assert_int_equal(kill(child, SIGKILL), 0);
        int status;
        assert_int_equal(waitpid(child, &status, 0), child);
        assert_true(WIFSIGNALED(status));
        while (read(fds[0], &one, sizeof one) == sizeof one)
            told[one.room] = one.revision;
        (void)close(fds[0]);
        check(&world, told);
    }
    for (int i = 0; i < N_ROOMS; i++)
        assert_true(told[i] > 0);
    store_world_end(&world);
}

int main(void)
{
    log_start("test_store_killed", LOG_ERROR + 1);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_was_acknowledged_is_there_after_the_process_was_killed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
