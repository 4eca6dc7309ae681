#define _GNU_SOURCE
/* Mutated handshakes: TLS must neither abort nor keep anything, and go on serving. TLS_HAMMER: how many, 10,000 when it
 * is not set; TLS_HAMMER_SEED. */
#include <dirent.h>
#include <openssl/err.h>
#include <poll.h>
#include <signal.h>
#include <time.h>

#include "tests/unit/server/tls/tls_world.h"

enum {
    N_KINDS = 5,       /* of clients */
    N_FLIGHTS = 3,     /* hello, the end of the handshake, a request */
    MAX_BYTES = 20000, /* of a flight */
    CHECK_EVERY = 1000
};

struct flight {
    unsigned char bytes[MAX_BYTES];
    size_t n;
};

struct hammer {
    struct tls_world *world;
    uint64_t random;
    SSL_CTX *clients[N_KINDS];
    struct flight hellos[N_KINDS];
    SSL_SESSION *session;
    size_t n_answered, n_made;
};

static uint64_t next(struct hammer *hammer)
{
    uint64_t x = hammer->random; /* xorshift64 */
    x ^= x << 13;
    x ^= x >> 7;
    x ^= x << 17;
    return hammer->random = x;
}

static size_t below(struct hammer *hammer, size_t n)
{
    return n ? (size_t)(next(hammer) % n) : 0;
}

/* ---- mutations -------------------------------------------------------------------------------------------------- */

static void insert(struct flight *flight, size_t at, const unsigned char *bytes, size_t n)
{
    unsigned char copy[MAX_BYTES];
    if (n > MAX_BYTES - flight->n)
        n = MAX_BYTES - flight->n;
    memcpy(copy, bytes, n);
    memmove(flight->bytes + at + n, flight->bytes + at, flight->n - at);
    memcpy(flight->bytes + at, copy, n);
    flight->n += n;
}

/* Cuts the handshake into records of a few bytes each. */
static void cut_into_records(struct hammer *hammer, struct flight *flight)
{
    struct flight cut = { .n = 0 };
    size_t n_each = 1 + below(hammer, 40);
    for (size_t at = 5; at < flight->n && cut.n + 5 + n_each <= MAX_BYTES; at += n_each) {
        size_t n = flight->n - at < n_each ? flight->n - at : n_each;
        const unsigned char head[5] = { flight->bytes[0], flight->bytes[1], flight->bytes[2], 0, (unsigned char)n };
        memcpy(cut.bytes + cut.n, head, 5);
        memcpy(cut.bytes + cut.n + 5, flight->bytes + at, n);
        cut.n += 5 + n;
    }
    *flight = cut;
}

static void mutate_once(struct hammer *hammer, struct flight *flight)
{
    static const unsigned char lengths[] = { 0, 1, 2, 0x7f, 0x80, 0xff };
    if (flight->n < 6)
        return;
    size_t at = below(hammer, flight->n), n = 1 + below(hammer, flight->n - at);
    const struct flight *other = &hammer->hellos[below(hammer, N_KINDS)];
    switch (next(hammer) % 10) {
    case 0:
    case 1: flight->bytes[at] ^= (unsigned char)(1u << below(hammer, 8)); break;
    case 2: flight->bytes[at] = (unsigned char)next(hammer); break;
    case 3: flight->n = at; break;
    case 4: insert(flight, at, flight->bytes + at, n); break;
    case 5:
        memmove(flight->bytes + at, flight->bytes + at + n, flight->n - at - n);
        flight->n -= n;
        break;
    case 6: /* a length, perhaps */
        flight->bytes[at] = lengths[below(hammer, sizeof lengths)];
        if (at + 1 < flight->n)
            flight->bytes[at + 1] = lengths[below(hammer, sizeof lengths)];
        break;
    case 7: insert(flight, at, other->bytes, 1 + below(hammer, other->n)); break;
    case 8: /* the length of the record is right again */
        flight->bytes[3] = (unsigned char)((flight->n - 5) >> 8);
        flight->bytes[4] = (unsigned char)(flight->n - 5);
        break;
    default: cut_into_records(hammer, flight); break;
    }
}

static void mutate(struct hammer *hammer, struct flight *flight)
{
    for (size_t i = 1 + below(hammer, 4); i > 0; i--)
        mutate_once(hammer, flight);
    if (flight->n > 0 && below(hammer, 50))
        flight->bytes[0] = flight->bytes[0] < 20 || flight->bytes[0] > 24 ? 22 : flight->bytes[0];
}

/* ---- clients ---------------------------------------------------------------------------------------------------- */

static void take_flight(BIO *from, struct flight *flight)
{
    int n = BIO_read(from, flight->bytes, MAX_BYTES);
    flight->n = n > 0 ? (size_t)n : 0;
}

static SSL *client_of(struct hammer *hammer, size_t kind)
{
    SSL *ssl = SSL_new(hammer->clients[kind]);
    assert_non_null(ssl);
    SSL_set_bio(ssl, BIO_new(BIO_s_mem()), BIO_new(BIO_s_mem()));
    SSL_set_connect_state(ssl);
    if (kind % 2)
        assert_int_equal(SSL_set_tlsext_host_name(ssl, "one"), 1);
    if (kind == 4 && hammer->session)
        assert_int_equal(SSL_set_session(ssl, hammer->session), 1);
    return ssl;
}

static void set_up_clients(struct hammer *hammer)
{
    static const unsigned char protocols[] = "\x02h2\x08http/1.1";
    for (size_t kind = 0; kind < N_KINDS; kind++) {
        SSL_CTX *client = hammer->clients[kind] = SSL_CTX_new(TLS_client_method());
        assert_non_null(client);
        if (kind == 1 || kind == 3)
            assert_int_equal(SSL_CTX_set_max_proto_version(client, TLS1_2_VERSION), 1);
        if (kind >= 2)
            assert_int_equal(SSL_CTX_set_alpn_protos(client, protocols, sizeof protocols - 1), 0);
        if (kind == 2)
            assert_int_equal(SSL_CTX_set1_groups_list(client, "P-521:X25519"), 1); /* asked for another share */
        SSL *ssl = client_of(hammer, kind);
        (void)SSL_do_handshake(ssl);
        take_flight(SSL_get_wbio(ssl), &hammer->hellos[kind]);
        assert_true(hammer->hellos[kind].n > 100);
        SSL_free(ssl);
    }
}

/* Sends; takes what comes within some milliseconds, for the client. False: the connection has ended. */
static bool exchange(struct hammer *hammer, int socket, const struct flight *flight, BIO *for_client, int wait_ms)
{
    unsigned char bytes[MAX_BYTES];
    if (flight->n > 0 && send(socket, flight->bytes, flight->n, MSG_NOSIGNAL | MSG_DONTWAIT) < 0)
        return false;
    struct pollfd polled = { .fd = socket, .events = POLLIN };
    if (poll(&polled, 1, wait_ms) != 1)
        return true;
    ssize_t n = recv(socket, bytes, sizeof bytes, MSG_DONTWAIT);
    if (n <= 0)
        return false;
    hammer->n_answered++;
    if (for_client)
        assert_int_equal(BIO_write(for_client, bytes, (int)n), n);
    return true;
}

static int connect_from_anywhere(struct hammer *hammer)
{
    char from[32];
    snprintf(from, sizeof from, "10.%u.%u.1", (unsigned)below(hammer, 256), (unsigned)below(hammer, 256));
    while (tls_count(hammer->world->tls).n_connections > 100)
        usleep(200); /* more would be closed unseen */
    return tls_world_connect(hammer->world, from);
}

/* A mutated hello; half of them are not waited for. */
static void hammer_hello(struct hammer *hammer)
{
    struct flight flight = hammer->hellos[below(hammer, N_KINDS)];
    int socket = connect_from_anywhere(hammer);
    mutate(hammer, &flight);
    size_t n_first = below(hammer, 4) ? flight.n : below(hammer, flight.n + 1); /* or in two parts */
    struct flight rest = { .n = flight.n - n_first };
    memcpy(rest.bytes, flight.bytes + n_first, rest.n);
    flight.n = n_first;
    if (exchange(hammer, socket, &flight, NULL, 0))
        (void)exchange(hammer, socket, &rest, NULL, below(hammer, 2) ? 2 : 0);
    if (below(hammer, 2))
        shutdown(socket, SHUT_WR);
    close(socket);
}

/* A true handshake up to the flight that is mutated. */
static void hammer_later(struct hammer *hammer)
{
    SSL *ssl = client_of(hammer, below(hammer, N_KINDS));
    int socket = connect_from_anywhere(hammer);
    size_t target = 1 + below(hammer, N_FLIGHTS - 1);
    bool goes_on = true, was_mutated = false;
    for (size_t i = 0; goes_on && i < 6; i++) {
        struct flight flight;
        if (SSL_do_handshake(ssl) == 1)
            (void)SSL_write(ssl, "GET / HTTP/1.1\r\n\r\n", 18);
        take_flight(SSL_get_wbio(ssl), &flight);
        if (i == target || (was_mutated && below(hammer, 2)))
            mutate(hammer, &flight);
        was_mutated = was_mutated || i == target;
        goes_on = exchange(hammer, socket, &flight, SSL_get_rbio(ssl), was_mutated ? 2 : 200);
    }
    hammer->n_made += SSL_is_init_finished(ssl) != 0;
    close(socket);
    SSL_free(ssl);
    ERR_clear_error();
}

/* A true client is served; its session is resumed by later ones. */
static void check_service(struct hammer *hammer)
{
    char bytes[8];
    SSL *ssl = tls_world_hello(hammer->world, tls_world_connect(hammer->world, "192.0.2.1"));
    assert_non_null(ssl);
    assert_int_equal(SSL_write(ssl, "whole", 5), 5);
    assert_int_equal(SSL_read(ssl, bytes, sizeof bytes), 5);
    SSL_SESSION_free(hammer->session);
    hammer->session = SSL_get1_session(ssl);
    tls_world_bye(ssl);
}

static size_t n_descriptors(void)
{
    size_t n = 0;
    DIR *folder = opendir("/proc/self/fd");
    assert_non_null(folder);
    while (readdir(folder))
        n++;
    closedir(folder);
    return n;
}

static void wait_until_none(struct hammer *hammer)
{
    for (int ms = 0; ms < TLS_WORLD_WAIT_MS && tls_count(hammer->world->tls).n_connections > 0; ms += 5)
        usleep(5000);
    assert_int_equal(tls_count(hammer->world->tls).n_connections, 0);
    assert_int_equal(tls_count(hammer->world->tls).n_waiting, 0);
    assert_int_equal(tls_count(hammer->world->tls).n_ending, 0);
}

static void mutated_handshakes_end_and_leave_nothing(void **state)
{
    static struct tls_world world;
    static struct hammer hammer;
    const char *wished = getenv("TLS_HAMMER"), *seed = getenv("TLS_HAMMER_SEED");
    const long n = wished ? atol(wished) : CHECK_THREADED(10000) == 1 ? 500 : 10000;
    (void)state;
    tls_world_start(&world, true);
    hammer = (struct hammer){ .world = &world, .random = seed ? strtoull(seed, NULL, 10) * 2 + 1 : 88172645463325252 };
    set_up_clients(&hammer);
    check_service(&hammer);
    wait_until_none(&hammer);
    usleep(100000); /* the server's end is closed, too */
    const size_t n_before = n_descriptors();
    for (long i = 1; i <= n; i++) {
        if (below(&hammer, 5) == 0)
            hammer_later(&hammer);
        else
            hammer_hello(&hammer);
        if (i % CHECK_EVERY == 0)
            check_service(&hammer);
        if (i % 100000 == 0)
            print_message("%ld: %zu answered, %zu made\n", i, hammer.n_answered, hammer.n_made);
    }
    check_service(&hammer);
    wait_until_none(&hammer);
    for (int i = 0; i < 100 && n_descriptors() > n_before; i++)
        usleep(50000);
    assert_true(n_descriptors() <= n_before);
    print_message("%ld mutated handshakes: %zu answered, %zu made\n", n, hammer.n_answered, hammer.n_made);
    assert_true(hammer.n_answered > (size_t)n / 100);
    for (size_t kind = 0; kind < N_KINDS; kind++)
        SSL_CTX_free(hammer.clients[kind]);
    SSL_SESSION_free(hammer.session);
    tls_world_finish(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(mutated_handshakes_end_and_leave_nothing) };
    signal(SIGPIPE, SIG_IGN);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
