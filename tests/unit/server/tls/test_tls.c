#define _GNU_SOURCE
/* TLS alone: streams both ways, their ends, limits, renewal. */
#include "server/tls/tls.h"

#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/tls/certificate.h"
#include "tests/check.h"
#include "tests/unit/server/tls/tls_world.h"

enum { N_LARGE = 3 << 20 };

static int start(void **state)
{
    static struct tls_world world;
    tls_world_start(&world, false);
    *state = &world;
    return 0;
}

static int start_echo(void **state)
{
    static struct tls_world world;
    tls_world_start(&world, true);
    *state = &world;
    return 0;
}

static int finish(void **state)
{
    tls_world_finish(*state);
    return 0;
}

static unsigned char pattern(size_t i)
{
    return (unsigned char)(i * 31 + i / 251);
}

/* Waits until TLS has so many connections. */
static struct tls_counts wait_for(struct tls_world *world, size_t n_connections)
{
    struct tls_counts counts = { 0 };
    for (int ms = 0; ms < TLS_WORLD_WAIT_MS; ms += 5) {
        counts = tls_count(world->tls);
        if (counts.n_connections == n_connections)
            break;
        usleep(5000);
    }
    assert_int_equal(counts.n_connections, n_connections);
    return counts;
}

static void set_waits(int socket)
{
    assert_int_equal(fcntl(socket, F_SETFL, 0), 0);
}

static void what_a_client_says_comes_decrypted_and_what_it_is_told_goes_encrypted(void **state)
{
    struct tls_world *world = *state;
    char bytes[64] = "";
    SSL *client = tls_world_hello(world, tls_world_connect(world, "192.0.2.1"));
    assert_non_null(client);
    assert_int_equal(SSL_write(client, "GET /", 5), 5);
    int server = tls_world_take(world->taken);
    set_waits(server);
    assert_int_equal(recv(server, bytes, sizeof bytes, 0), 5);
    assert_memory_equal(bytes, "GET /", 5);
    assert_int_equal(send(server, "200", 3, 0), 3);
    assert_int_equal(SSL_read(client, bytes, sizeof bytes), 3);
    assert_memory_equal(bytes, "200", 3);
    close(server);
    tls_world_bye(client);
    wait_for(world, 0);
}

struct sender {
    int socket;
    bool ends;
};

static void *send_large(void *argument)
{
    const struct sender *sender = argument;
    unsigned char *bytes = malloc(N_LARGE);
    for (size_t i = 0; bytes && i < N_LARGE; i++)
        bytes[i] = pattern(i);
    for (ssize_t at = 0, n = 1; bytes && at < N_LARGE && n > 0; at += n)
        n = send(sender->socket, bytes + at, (size_t)(N_LARGE - at), MSG_NOSIGNAL);
    if (sender->ends)
        shutdown(sender->socket, SHUT_WR);
    free(bytes);
    return NULL;
}

/* The client begins to read late: all buffers are full. */
static void a_large_answer_comes_whole_to_a_slow_client_and_then_its_end(void **state)
{
    struct tls_world *world = *state;
    SSL *client = tls_world_hello(world, tls_world_connect(world, "192.0.2.1"));
    assert_non_null(client);
    assert_int_equal(SSL_write(client, "?", 1), 1);
    struct sender sender = { tls_world_take(world->taken), true };
    set_waits(sender.socket);
    pthread_t thread;
    assert_int_equal(pthread_create(&thread, NULL, send_large, &sender), 0);
    usleep(100000);
    size_t n = 0;
    for (;;) {
        unsigned char bytes[5000];
        int n_now = SSL_read(client, bytes, sizeof bytes);
        if (n_now <= 0) {
            assert_int_equal(SSL_get_error(client, n_now), SSL_ERROR_ZERO_RETURN); /* told in TLS: not cut off */
            break;
        }
        for (int i = 0; i < n_now; i++)
            if (bytes[i] != pattern(n + (size_t)i))
                fail_msg("byte %zu", n + (size_t)i);
        n += (size_t)n_now;
    }
    assert_int_equal(n, N_LARGE);
    pthread_join(thread, NULL);
    /* the server has ended its side alone: it still hears the client, as when it lingers after a refusal */
    char bytes[8];
    assert_int_equal(recv(sender.socket, bytes, 1, 0), 1);
    assert_int_equal(SSL_write(client, "more", 4), 4);
    assert_int_equal(recv(sender.socket, bytes, sizeof bytes, 0), 4);
    tls_world_bye(client);
    assert_int_equal(recv(sender.socket, bytes, sizeof bytes, 0), 0);
    close(sender.socket);
    wait_for(world, 0);
}

/* The server reads late, and the client has gone by then. */
static void a_large_request_comes_whole_also_when_its_client_has_gone(void **state)
{
    struct tls_world *world = *state;
    SSL *client = tls_world_hello(world, tls_world_connect(world, "192.0.2.1"));
    assert_non_null(client);
    size_t n_sent = 0, n = 0;
    unsigned char bytes[8192];
    while (n_sent < 600 * 1024) {
        for (size_t i = 0; i < sizeof bytes; i++)
            bytes[i] = pattern(n_sent + i);
        struct pollfd polled = { .fd = SSL_get_fd(client), .events = POLLOUT };
        if (poll(&polled, 1, 300) != 1) /* the server reads nothing */
            break;
        assert_int_equal(SSL_write(client, bytes, sizeof bytes), sizeof bytes);
        n_sent += sizeof bytes;
    }
    assert_true(n_sent > 100 * 1024);
    int server = tls_world_take(world->taken);
    tls_world_bye(client);
    set_waits(server);
    for (ssize_t n_now; (n_now = recv(server, bytes, sizeof bytes, 0)) > 0; n += (size_t)n_now)
        for (ssize_t i = 0; i < n_now; i++)
            assert_int_equal(bytes[i], pattern(n + (size_t)i));
    assert_int_equal(n, n_sent);
    close(server);
    wait_for(world, 0);
}

static void an_end_that_was_closed_by_the_server_is_told_to_the_client(void **state)
{
    struct tls_world *world = *state;
    char bytes[8];
    SSL *client = tls_world_hello(world, tls_world_connect(world, "192.0.2.1"));
    assert_non_null(client);
    assert_int_equal(SSL_write(client, "?", 1), 1);
    int server = tls_world_take(world->taken);
    assert_int_equal(send(server, "last", 4, 0), 4);
    close(server);
    assert_int_equal(SSL_read(client, bytes, sizeof bytes), 4);
    assert_int_equal(SSL_get_error(client, SSL_read(client, bytes, sizeof bytes)), SSL_ERROR_ZERO_RETURN);
    wait_for(world, 0); /* it does not wait for a client that does not end */
    tls_world_bye(client);
}

static void a_client_without_tls_is_handed_on_with_all_its_bytes(void **state)
{
    struct tls_world *world = *state;
    char bytes[8] = "";
    int client = tls_world_connect(world, "192.0.2.1");
    assert_int_equal(send(client, "GET /", 5, 0), 5);
    int server = tls_world_take(world->plain);
    assert_int_equal(recv(server, bytes, sizeof bytes, 0), 5);
    assert_memory_equal(bytes, "GET /", 5);
    close(server);
    close(client);
    wait_for(world, 0);
}

static void a_connection_waits_no_longer_than_its_time(void **state)
{
    struct tls_world *world = *state;
    char byte;
    int silent = tls_world_connect(world, "192.0.2.1"), half = tls_world_connect(world, "192.0.2.1");
    assert_int_equal(send(half, "\x16\x03\x01\x02", 4, 0), 4);
    assert_int_equal(recv(silent, &byte, 1, 0), 0);
    assert_true(recv(half, &byte, 1, 0) <= 0);
    wait_for(world, 0);
    close(silent);
    close(half);
}

static void of_one_address_so_many_wait_and_of_a_trusted_proxy_more(void **state)
{
    struct tls_world *world = *state;
    int all[TLS_MAX_WAITING + 1];
    char byte;
    for (int i = 0; i <= TLS_MAX_WAITING_PER_ADDRESS; i++)
        all[i] = tls_world_connect(world, "198.51.100.1");
    assert_int_equal(recv(all[TLS_MAX_WAITING_PER_ADDRESS], &byte, 1, 0), 0);
    assert_int_equal(wait_for(world, TLS_MAX_WAITING_PER_ADDRESS).n_waiting, TLS_MAX_WAITING_PER_ADDRESS);
    close(all[TLS_MAX_WAITING_PER_ADDRESS]);
    for (int i = TLS_MAX_WAITING_PER_ADDRESS; i <= TLS_MAX_WAITING; i++)
        all[i] = tls_world_connect(world, "192.0.2.1");
    assert_int_equal(recv(all[TLS_MAX_WAITING], &byte, 1, 0), 0);
    assert_int_equal(wait_for(world, TLS_MAX_WAITING).n_waiting, TLS_MAX_WAITING);
    for (int i = 0; i <= TLS_MAX_WAITING; i++)
        close(all[i]);
    wait_for(world, 0);
}

static void a_renewed_certificate_is_that_of_new_connections(void **state)
{
    struct tls_world *world = *state;
    struct error err = { 0 };
    char name[16] = "", bytes[8];
    SSL *standing = tls_world_hello(world, tls_world_connect(world, "192.0.2.1"));
    assert_non_null(standing);
    assert_int_equal(SSL_write(standing, "1", 1), 1);
    assert_int_equal(SSL_read(standing, bytes, sizeof bytes), 1);
    tls_world_use(world, 1);
    assert_true(tls_reload(world->tls, &err));
    for (int i = 0; i < TLS_WORLD_WAIT_MS / 10 && strcmp(name, "two") != 0; i++) {
        SSL *client = tls_world_hello(world, tls_world_connect(world, "192.0.2.1"));
        assert_non_null(client);
        tls_world_name(client, name, sizeof name);
        tls_world_bye(client);
        usleep(10000);
    }
    assert_string_equal(name, "two"); /* though the client would rather have ECDSA */
    tls_world_name(standing, name, sizeof name);
    assert_string_equal(name, "one");
    assert_int_equal(SSL_write(standing, "2", 1), 1);
    assert_int_equal(SSL_read(standing, bytes, sizeof bytes), 1);
    assert_int_equal(unlink(world->used_key), 0);
    assert_int_equal(link(world->key[0], world->used_key), 0);
    assert_false(tls_reload(world->tls, &err));
    assert_non_null(strstr(err.text, "is not the key of the certificate"));
    tls_world_bye(standing);
    wait_for(world, 0);
}

static void after_the_close_nothing_is_handed_on_and_what_stands_goes_on(void **state)
{
    struct tls_world *world = *state;
    char bytes[8];
    int waiting = tls_world_connect(world, "192.0.2.1");
    SSL *standing = tls_world_hello(world, tls_world_connect(world, "192.0.2.1"));
    assert_non_null(standing);
    assert_int_equal(SSL_write(standing, "1", 1), 1);
    assert_int_equal(SSL_read(standing, bytes, sizeof bytes), 1);
    tls_close(world->tls);
    assert_int_equal(recv(waiting, bytes, sizeof bytes, 0), 0);
    close(waiting);
    int late = tls_world_connect(world, "192.0.2.1");
    assert_int_equal(recv(late, bytes, sizeof bytes, 0), 0);
    close(late);
    assert_int_equal(SSL_write(standing, "2", 1), 1);
    assert_int_equal(SSL_read(standing, bytes, sizeof bytes), 1);
    tls_world_bye(standing);
}

/* The library has places for as many descriptors as were allowed when it was started. */
static void a_socket_that_the_library_does_not_take_is_closed(void **state)
{
    static struct tls_world world;
    struct rlimit before;
    (void)state;
    assert_int_equal(getrlimit(RLIMIT_NOFILE, &before), 0);
    const struct rlimit few = { 64, before.rlim_max };
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &few), 0);
    tls_world_start(&world, false);
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &before), 0);
    int ends[2];
    char byte;
    struct address address = { { 1 } };
    assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends), 0);
    int high = fcntl(ends[0], F_DUPFD_CLOEXEC, 200);
    assert_true(high >= 200);
    close(ends[0]);
    tls_accept(world.tls, high, &address);
    assert_int_equal(send(ends[1], "\x16\x03\x01", 3, 0), 3);
    wait_for(&world, 0);
    for (int ms = 0; ms < TLS_WORLD_WAIT_MS && fcntl(high, F_GETFD) != -1; ms += 5)
        usleep(5000);
    assert_int_equal(fcntl(high, F_GETFD), -1);
    assert_true(recv(ends[1], &byte, 1, MSG_DONTWAIT) <= 0);
    close(ends[1]);
    tls_world_finish(&world);
}

static void a_chain_is_read_and_one_without_end_is_not(void **state)
{
    struct tls_world *world = *state;
    struct error err = { 0 };
    char chain[300], pem[4096], text[CERTIFICATE_TEXT];
    FILE *file = fopen(world->cert[0], "r");
    assert_non_null(file);
    size_t n = fread(pem, 1, sizeof pem, file);
    fclose(file);
    snprintf(chain, sizeof chain, "%s/chain.pem", world->folder);
    for (int n_more = CERTIFICATE_MAX_CHAIN; n_more <= CERTIFICATE_MAX_CHAIN + 1; n_more++) {
        file = fopen(chain, "w");
        assert_non_null(file);
        for (int i = 0; i <= n_more; i++)
            assert_int_equal(fwrite(pem, 1, n, file), n);
        fclose(file);
        struct certificate *certificate = certificate_read(chain, world->key[0], &err);
        assert_int_equal(certificate != NULL, n_more == CERTIFICATE_MAX_CHAIN);
        if (certificate) {
            certificate_describe(certificate, text);
            assert_memory_equal(text, "one, valid until 20", 19);
            assert_false(certificate_is_out_of_date(certificate));
        }
        certificate_destroy(certificate);
    }
    assert_int_equal(err.code, ERROR_LIMIT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(what_a_client_says_comes_decrypted_and_what_it_is_told_goes_encrypted, start,
                                        finish),
        cmocka_unit_test_setup_teardown(a_large_answer_comes_whole_to_a_slow_client_and_then_its_end, start, finish),
        cmocka_unit_test_setup_teardown(a_large_request_comes_whole_also_when_its_client_has_gone, start, finish),
        cmocka_unit_test_setup_teardown(an_end_that_was_closed_by_the_server_is_told_to_the_client, start, finish),
        cmocka_unit_test_setup_teardown(a_client_without_tls_is_handed_on_with_all_its_bytes, start, finish),
        cmocka_unit_test_setup_teardown(a_connection_waits_no_longer_than_its_time, start, finish),
        cmocka_unit_test_setup_teardown(of_one_address_so_many_wait_and_of_a_trusted_proxy_more, start, finish),
        cmocka_unit_test_setup_teardown(a_renewed_certificate_is_that_of_new_connections, start_echo, finish),
        cmocka_unit_test_setup_teardown(after_the_close_nothing_is_handed_on_and_what_stands_goes_on, start_echo,
                                        finish),
        cmocka_unit_test(a_socket_that_the_library_does_not_take_is_closed),
        cmocka_unit_test_setup_teardown(a_chain_is_read_and_one_without_end_is_not, start, finish),
    };
    signal(SIGPIPE, SIG_IGN);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
