#define _GNU_SOURCE
/* Sockets that the library does not take. */
#include "server/ws/sockets.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/check.h"

enum { N_ALLOWED = 64, TOO_HIGH = 200 };

static int say_nothing(struct socket *socket, const uint8_t *bytes, size_t n)
{
    (void)socket;
    (void)bytes;
    (void)n;
    return 0;
}

static int do_nothing(struct socket *socket)
{
    (void)socket;
    return 0;
}

static void forget(struct socket *socket)
{
    (void)socket;
}

/* The library has places for as many descriptors as were allowed when it was started. */
static void a_socket_that_the_library_does_not_take_is_closed(void **state)
{
    static const struct sockets_calls calls = { .received = say_nothing, .takes_more = do_nothing, .ended = forget };
    struct error err = { 0 };
    struct rlimit before, few;
    struct socket socket = { 0 };
    int ends[2];
    char byte;
    (void)state;
    assert_int_equal(getrlimit(RLIMIT_NOFILE, &before), 0);
    few = (struct rlimit){ N_ALLOWED, before.rlim_max };
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &few), 0);
    struct sockets *sockets = sockets_create(&calls, &err);
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &before), 0);
    assert_non_null(sockets);
    assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends), 0);
    int high = fcntl(ends[0], F_DUPFD_CLOEXEC, TOO_HIGH);
    assert_true(high >= TOO_HIGH);
    close(ends[0]);
    assert_false(sockets_add(sockets, &socket, high));
    assert_int_equal(recv(ends[1], &byte, 1, MSG_DONTWAIT), 0);
    assert_int_equal(fcntl(high, F_GETFD), -1);
    close(ends[1]);
    sockets_destroy(sockets);
}

static size_t n_descriptors(void)
{
    size_t n = 0;
    for (int fd = 0; fd < 1000; fd++)
        n += fcntl(fd, F_GETFD) != -1;
    return n;
}

/* Opens descriptors until n_free of the allowed ones are left. Returns how many were opened. */
static size_t leave_free(int opened[], size_t n_allowed, size_t n_free)
{
    size_t n = 0;
    for (size_t left = n_allowed - n_descriptors(); left > n_free; left--, n++) {
        opened[n] = fcntl(0, F_DUPFD_CLOEXEC, 0);
        assert_true(opened[n] >= 0);
    }
    return n;
}

/* Descriptors run out at each step of the start in turn. */
static void a_start_that_fails_leaves_no_descriptor(void **state)
{
    static const struct sockets_calls calls = { .received = say_nothing, .takes_more = do_nothing, .ended = forget };
    enum { N_TABLE = 256 };
    struct rlimit before;
    (void)state;
    assert_int_equal(getrlimit(RLIMIT_NOFILE, &before), 0);
    struct rlimit few = { N_TABLE, before.rlim_max };
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &few), 0);
    const size_t n_before = n_descriptors();
    bool has_started = false;
    for (size_t n_free = 0; !has_started && n_free < 40; n_free++) {
        int opened[N_TABLE];
        struct error err = { 0 };
        const size_t n_opened = leave_free(opened, N_TABLE, n_free);
        struct sockets *sockets = sockets_create(&calls, &err);
        has_started = sockets != NULL;
        sockets_destroy(sockets);
        assert_int_equal(n_descriptors(), n_before + n_opened);
        for (size_t i = 0; i < n_opened; i++)
            close(opened[i]);
    }
    assert_true(has_started);
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &before), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(a_socket_that_the_library_does_not_take_is_closed),
                                        cmocka_unit_test(a_start_that_fails_leaves_no_descriptor) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
