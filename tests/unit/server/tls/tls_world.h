#pragma once
/* TLS between clients of OpenSSL and a server that sends back each byte. */
#include <fcntl.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>
#include <pthread.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <unistd.h>

#include "core/base/mem.h"
#include "core/base/queue.h"
#include "server/tls/tls.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"

struct tls_world {
    char folder[256];
    char cert[2][300], key[2][300]; /* files of PEM: of the names "one" (ECDSA) and "two" (RSA) */
    char used_cert[300], used_key[300];
    struct address_range trusted; /* 192.0.2.0/24 */
    struct tls *tls;
    struct queue *taken, *plain; /* sockets: int *; what the server has not taken yet, without echo */
    bool has_echo;
    pthread_t echo;
    int echo_epoll;
    SSL_CTX *client;
};

enum { TLS_WORLD_WAIT_MS = 20000 };

static inline void tls_world_write_pair(EVP_PKEY *key, const char *name, const char *cert_file, const char *key_file)
{
    X509 *cert = X509_new();
    assert_non_null(key);
    assert_non_null(cert);
    X509_set_version(cert, 2);
    ASN1_INTEGER_set(X509_get_serialNumber(cert), 1);
    X509_gmtime_adj(X509_getm_notBefore(cert), -3600);
    X509_gmtime_adj(X509_getm_notAfter(cert), 86400);
    X509_set_pubkey(cert, key);
    X509_NAME_add_entry_by_txt(X509_get_subject_name(cert), "CN", MBSTRING_ASC, (const unsigned char *)name, -1, -1, 0);
    X509_set_issuer_name(cert, X509_get_subject_name(cert));
    assert_true(X509_sign(cert, key, EVP_sha256()) > 0);
    FILE *file = fopen(cert_file, "w");
    assert_non_null(file);
    assert_int_equal(PEM_write_X509(file, cert), 1);
    fclose(file);
    file = fopen(key_file, "w");
    assert_non_null(file);
    assert_int_equal(PEM_write_PrivateKey(file, key, NULL, NULL, 0, NULL, NULL), 1);
    fclose(file);
    assert_int_equal(chmod(key_file, 0600), 0);
    X509_free(cert);
    EVP_PKEY_free(key);
}

static inline void tls_world_keep(struct queue *sockets, int socket)
{
    int *kept = mem_new(sizeof *kept);
    *kept = socket;
    assert_true(queue_try_put(sockets, kept));
}

static inline void tls_world_handed(void *context, int socket, const struct address *peer)
{
    struct tls_world *world = context;
    struct epoll_event event = { .events = EPOLLIN, .data.fd = socket };
    (void)peer;
    if (world->has_echo)
        assert_int_equal(epoll_ctl(world->echo_epoll, EPOLL_CTL_ADD, socket, &event), 0);
    else
        tls_world_keep(world->taken, socket);
}

static inline void tls_world_handed_plain(void *context, int socket, const struct address *peer)
{
    struct tls_world *world = context;
    (void)peer;
    if (world->has_echo)
        close(socket);
    else
        tls_world_keep(world->plain, socket);
}

/* Sends back; ends with the last copy of a pipe's end, which is watched with the sockets. */
static inline void *tls_world_echo(void *argument)
{
    struct tls_world *world = argument;
    for (;;) {
        struct epoll_event event;
        char bytes[16384];
        if (epoll_wait(world->echo_epoll, &event, 1, -1) != 1)
            continue;
        ssize_t n = recv(event.data.fd, bytes, sizeof bytes, 0);
        if (n == 4 && memcmp(bytes, "stop", 4) == 0) {
            close(event.data.fd);
            return NULL;
        }
        if (n > 0 && send(event.data.fd, bytes, (size_t)n, MSG_NOSIGNAL) == n)
            continue;
        close(event.data.fd);
    }
}

static inline void tls_world_drop(void *kept)
{
    close(*(int *)kept);
    free(kept);
}

/* The files that TLS reads are those of this certificate. */
static inline void tls_world_use(struct tls_world *world, int i)
{
    const char *from[] = { world->cert[i], world->key[i] }, *to[] = { world->used_cert, world->used_key };
    for (int k = 0; k < 2; k++) {
        unlink(to[k]);
        assert_int_equal(link(from[k], to[k]), 0);
    }
}

/* A world whose server sends back, or only keeps the sockets in taken. */
static inline void tls_world_start(struct tls_world *world, bool has_echo)
{
    struct error err = { 0 };
    *world = (struct tls_world){ .has_echo = has_echo };
    folder_make(world->folder);
    static const char *const names[] = { "one", "two" };
    for (int i = 0; i < 2; i++) {
        snprintf(world->cert[i], sizeof world->cert[i], "%s/%s.pem", world->folder, names[i]);
        snprintf(world->key[i], sizeof world->key[i], "%s/%s.key", world->folder, names[i]);
        tls_world_write_pair(i ? EVP_RSA_gen(2048) : EVP_EC_gen("P-256"), names[i], world->cert[i], world->key[i]);
    }
    snprintf(world->used_cert, sizeof world->used_cert, "%s/used.pem", world->folder);
    snprintf(world->used_key, sizeof world->used_key, "%s/used.key", world->folder);
    tls_world_use(world, 0);
    assert_true(address_range_read("192.0.2.0/24", &world->trusted, &err));
    world->taken = queue_create(1000, tls_world_drop);
    world->plain = queue_create(1000, tls_world_drop);
    world->echo_epoll = epoll_create1(EPOLL_CLOEXEC);
    if (has_echo)
        assert_int_equal(pthread_create(&world->echo, NULL, tls_world_echo, world), 0);
    const struct tls_options options = { .cert_file = world->used_cert,
                                         .key_file = world->used_key,
                                         .trusted = &world->trusted,
                                         .n_trusted = 1,
                                         .take = tls_world_handed,
                                         .take_plain = tls_world_handed_plain,
                                         .context = world };
    world->tls = tls_create(&options, &err);
    assert_string_equal(err.text, "");
    assert_non_null(world->tls);
    world->client = SSL_CTX_new(TLS_client_method());
    assert_non_null(world->client);
}

void tls_world_finish(struct tls_world *world)
{
    tls_close(world->tls);
    if (world->has_echo) {
        int ends[2];
        assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends), 0);
        assert_int_equal(send(ends[0], "stop", 4, 0), 4);
        struct epoll_event event = { .events = EPOLLIN, .data.fd = ends[1] };
        assert_int_equal(epoll_ctl(world->echo_epoll, EPOLL_CTL_ADD, ends[1], &event), 0);
        pthread_join(world->echo, NULL);
        close(ends[0]);
    }
    queue_destroy(world->taken);
    queue_destroy(world->plain);
    tls_destroy(world->tls);
    close(world->echo_epoll);
    SSL_CTX_free(world->client);
    folder_remove(world->folder);
}

/* A socket whose other end is a client of this address for TLS. */
static inline int tls_world_connect(struct tls_world *world, const char *from)
{
    int ends[2];
    struct address address;
    struct timeval limit = { .tv_sec = TLS_WORLD_WAIT_MS / 1000 };
    assert_true(address_read(from, strlen(from), &address));
    assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends), 0);
    assert_int_equal(fcntl(ends[0], F_SETFL, O_NONBLOCK), 0);
    assert_int_equal(setsockopt(ends[1], SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit), 0);
    assert_int_equal(setsockopt(ends[1], SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit), 0);
    tls_accept(world->tls, ends[0], &address);
    return ends[1];
}

/* Closes its socket, too. */
static inline void tls_world_bye(SSL *ssl)
{
    int socket = SSL_get_fd(ssl);
    SSL_free(ssl);
    close(socket);
}

/* Shakes hands with the socket; takes it. NULL when that fails. */
static inline SSL *tls_world_hello(struct tls_world *world, int socket)
{
    SSL *ssl = SSL_new(world->client);
    assert_non_null(ssl);
    assert_int_equal(SSL_set_fd(ssl, socket), 1);
    if (SSL_connect(ssl) == 1)
        return ssl;
    tls_world_bye(ssl);
    return NULL;
}

/* The next one; fails the test when none comes. */
static inline int tls_world_take(struct queue *sockets)
{
    int *kept = queue_take(sockets, TLS_WORLD_WAIT_MS);
    assert_non_null(kept);
    int socket = *kept;
    free(kept);
    return socket;
}

/* The common name of its certificate. */
static inline void tls_world_name(SSL *ssl, char *name, size_t size)
{
    X509 *cert = SSL_get1_peer_certificate(ssl);
    assert_non_null(cert);
    X509_NAME_get_text_by_NID(X509_get_subject_name(cert), NID_commonName, name, (int)size);
    X509_free(cert);
}
