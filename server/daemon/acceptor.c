#define _GNU_SOURCE
#include "server/daemon/acceptor.h"

#include <arpa/inet.h>
#include <errno.h>
#include <netdb.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/net/net.h"
#include "server/http/head.h"
#include "server/http/http.h"
#include "server/wire/refusal.h"

struct pending {
    int socket; /* -1: free */
    struct sockaddr_storage address;
    socklen_t n_address;
    int64_t until_us;
    bool is_refused;  /* has been told; what it still sends is dropped, or its system would take the answer back */
    size_t n_dropped;
};

struct acceptor {
    struct net *net;
    struct http *http;
    const struct hosts *hosts;
    char bytes[HEAD_MAX_BYTES]; /* of the head that is looked at */
    int listener, epoll, stop;
    pthread_t thread;
    bool has_thread;
    char url[100];
    struct pending pending[ACCEPTOR_MAX_PENDING];
    size_t n_pending;
};

static const uint64_t listener_tag = UINT64_MAX, stop_tag = UINT64_MAX - 1;

static bool same_address(const struct sockaddr_storage *a, const struct sockaddr_storage *b)
{
    if (a->ss_family != b->ss_family)
        return false;
    if (a->ss_family == AF_INET)
        return ((const struct sockaddr_in *)a)->sin_addr.s_addr == ((const struct sockaddr_in *)b)->sin_addr.s_addr;
    return memcmp(&((const struct sockaddr_in6 *)a)->sin6_addr, &((const struct sockaddr_in6 *)b)->sin6_addr, sizeof(struct in6_addr)) == 0;
}

static void free_slot(struct acceptor *acceptor, struct pending *slot)
{
    slot->socket = -1;
    acceptor->n_pending--;
}

static void accept_one(struct acceptor *acceptor, int socket, const struct sockaddr_storage *address, socklen_t n_address)
{
    size_t n_same = 0;
    struct pending *slot = NULL;
    for (size_t i = 0; i < ACCEPTOR_MAX_PENDING; i++) {
        if (acceptor->pending[i].socket < 0)
            slot = slot ? slot : &acceptor->pending[i];
        else
            n_same += same_address(&acceptor->pending[i].address, address);
    }
    if (!slot || n_same >= ACCEPTOR_MAX_PENDING_PER_ADDRESS) {
        struct problem problem; /* the oldest ones run into their time limit soon */
        problem_set(&problem, PROBLEM_LIMIT, "", "", "too many connections that have not said what they want: at most %d in all, %d from one address",
                    ACCEPTOR_MAX_PENDING, ACCEPTOR_MAX_PENDING_PER_ADDRESS);
        problem.retry_after_ms = ACCEPTOR_HEAD_MS;
        refusal_send(socket, &problem);
        (void)refusal_drain(socket, HEAD_MAX_BYTES);
        close(socket);
        return;
    }
    *slot = (struct pending){ .socket = socket, .address = *address, .n_address = n_address, .until_us = clock_now_us() + ACCEPTOR_HEAD_MS * 1000LL };
    acceptor->n_pending++;
    /* edge-triggered: a peek leaves the bytes there, and only new ones may wake us */
    struct epoll_event event = { .events = EPOLLIN | EPOLLRDHUP | EPOLLET, .data.u64 = (uint64_t)(slot - acceptor->pending) };
    if (epoll_ctl(acceptor->epoll, EPOLL_CTL_ADD, socket, &event) != 0) {
        close(socket);
        free_slot(acceptor, slot);
    }
}

static void accept_all(struct acceptor *acceptor)
{
    for (;;) {
        struct sockaddr_storage address = { 0 };
        socklen_t n_address = sizeof address;
        int socket = accept4(acceptor->listener, (struct sockaddr *)&address, &n_address, SOCK_NONBLOCK | SOCK_CLOEXEC);
        if (socket >= 0) {
            accept_one(acceptor, socket, &address, n_address);
        } else if (errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM) {
            log_warn("acceptor: %s", strerror(errno));
            usleep(50000); /* nothing helps but waiting for others to close */
            return;
        } else if (errno != EINTR && errno != ECONNABORTED) {
            return;
        }
    }
}

static void refuse(struct pending *slot, const struct problem *problem)
{
    refusal_send(slot->socket, problem);
    slot->is_refused = true;
    slot->until_us = clock_now_us() + ACCEPTOR_LINGER_MS * 1000LL;
}

/* Of one that was refused. true: the slot is done with. */
static bool linger(struct pending *slot)
{
    enum { AT_ONCE = 64 << 10 };
    slot->n_dropped += AT_ONCE; /* at most */
    if (refusal_drain(slot->socket, AT_ONCE) && slot->n_dropped < ACCEPTOR_MAX_DROPPED)
        return false;
    close(slot->socket);
    return true;
}

/* Looks at what has come. has_ended: nothing more will. true: the slot is done with. */
static bool look(struct acceptor *acceptor, struct pending *slot, bool has_ended)
{
    struct problem problem;
    if (slot->is_refused)
        return linger(slot);
    ssize_t n = recv(slot->socket, acceptor->bytes, sizeof acceptor->bytes, MSG_PEEK | MSG_DONTWAIT);
    if (n < 0 && (errno == EAGAIN || errno == EINTR))
        return false;
    if (n <= 0) {
        close(slot->socket);
        return true;
    }
    enum head_kind kind = head_look(acceptor->bytes, (size_t)n, acceptor->hosts, &problem);
    if (kind == HEAD_INCOMPLETE && !has_ended)
        return false;
    if (kind == HEAD_INCOMPLETE)
        head_refuse_incomplete(acceptor->bytes, (size_t)n, true, 0, &problem);
    if (kind == HEAD_INCOMPLETE || kind == HEAD_REFUSED) {
        refuse(slot, &problem);
        return linger(slot);
    }
    epoll_ctl(acceptor->epoll, EPOLL_CTL_DEL, slot->socket, NULL);
    if (kind == HEAD_WEBSOCKET) {
        struct handshake handshake;
        head_read_handshake(acceptor->bytes, (size_t)n, &handshake);
        net_adopt(acceptor->net, slot->socket, &handshake);
    } else {
        http_add_connection(acceptor->http, slot->socket, (const struct sockaddr *)&slot->address, slot->n_address);
    }
    return true;
}

/* Its time is over. true: the slot is done with. */
static bool end_late(struct acceptor *acceptor, struct pending *slot)
{
    struct problem problem;
    ssize_t n = slot->is_refused ? 0 : recv(slot->socket, acceptor->bytes, sizeof acceptor->bytes, MSG_PEEK | MSG_DONTWAIT);
    if (n <= 0) { /* one that said nothing expects no answer: browsers open connections before they need them */
        close(slot->socket);
        return true;
    }
    head_refuse_incomplete(acceptor->bytes, (size_t)n, false, ACCEPTOR_HEAD_MS, &problem);
    refuse(slot, &problem);
    return linger(slot);
}

static int drop_late(struct acceptor *acceptor)
{
    int64_t now_us = clock_now_us(), next_us = INT64_MAX;
    for (size_t i = 0; i < ACCEPTOR_MAX_PENDING && acceptor->n_pending; i++) {
        struct pending *slot = &acceptor->pending[i];
        if (slot->socket < 0)
            continue;
        if (now_us >= slot->until_us && end_late(acceptor, slot))
            free_slot(acceptor, slot);
        else if (slot->until_us < next_us)
            next_us = slot->until_us;
    }
    return next_us == INT64_MAX ? -1 : (int)((next_us - now_us) / 1000) + 1;
}

static void *run(void *argument)
{
    struct acceptor *acceptor = argument;
    for (;;) {
        struct epoll_event events[64];
        int n = epoll_wait(acceptor->epoll, events, 64, drop_late(acceptor));
        for (int i = 0; i < n; i++) {
            uint64_t tag = events[i].data.u64;
            if (tag == stop_tag)
                return NULL;
            if (tag == listener_tag) {
                accept_all(acceptor);
                continue;
            }
            struct pending *slot = &acceptor->pending[tag];
            if (slot->socket >= 0 && look(acceptor, slot, events[i].events & (EPOLLRDHUP | EPOLLHUP | EPOLLERR)))
                free_slot(acceptor, slot);
        }
    }
}

static bool start_listening(struct acceptor *acceptor, const char *listen_at, struct error *err)
{
    char host[80];
    const char *colon = strrchr(listen_at, ':');
    size_t n = colon ? (size_t)(colon - listen_at) : 0;
    bool is_bracketed = n >= 2 && listen_at[0] == '[' && listen_at[n - 1] == ']';
    if (!colon || n == 0 || n >= sizeof host)
        return error_set(err, ERROR_FORMAT, "--listen %.80s: expected ADDRESS:PORT, as in 127.0.0.1:8080 or [::1]:8080", listen_at);
    (void)snprintf(host, sizeof host, "%.*s", (int)(is_bracketed ? n - 2 : n), listen_at + is_bracketed);
    if (colon[1 + strspn(colon + 1, "0123456789")] || strlen(colon + 1) - 1 >= 5 || strtoul(colon + 1, NULL, 10) > 65535)
        return error_set(err, ERROR_RANGE, "--listen %.80s: expected a port from 0 to 65535", listen_at); /* the library takes 16 bits of it */
    struct addrinfo hints = { .ai_flags = AI_NUMERICHOST | AI_NUMERICSERV | AI_PASSIVE, .ai_socktype = SOCK_STREAM }, *found = NULL;
    int failed = getaddrinfo(host, colon + 1, &hints, &found);
    if (failed)
        return error_set(err, ERROR_FORMAT, "--listen %.80s: %s; expected a numeric address and port", listen_at, gai_strerror(failed));
    int on = 1;
    acceptor->listener = socket(found->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    bool ok = acceptor->listener >= 0 && setsockopt(acceptor->listener, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) == 0 &&
              bind(acceptor->listener, found->ai_addr, found->ai_addrlen) == 0 && listen(acceptor->listener, 512) == 0;
    freeaddrinfo(found);
    if (!ok)
        return error_set(err, ERROR_IO, "--listen %.80s: %s", listen_at, strerror(errno));
    struct sockaddr_storage bound;
    socklen_t n_bound = sizeof bound;
    if (getsockname(acceptor->listener, (struct sockaddr *)&bound, &n_bound) != 0)
        return error_set(err, ERROR_IO, "--listen %.80s: %s", listen_at, strerror(errno));
    unsigned port = ntohs(bound.ss_family == AF_INET ? ((struct sockaddr_in *)&bound)->sin_port : ((struct sockaddr_in6 *)&bound)->sin6_port);
    (void)snprintf(acceptor->url, sizeof acceptor->url, bound.ss_family == AF_INET6 ? "http://[%s]:%u" : "http://%s:%u", host, port);
    return true;
}

static bool watch(struct acceptor *acceptor, int fd, uint64_t tag)
{
    struct epoll_event event = { .events = EPOLLIN, .data.u64 = tag };
    return fd >= 0 && epoll_ctl(acceptor->epoll, EPOLL_CTL_ADD, fd, &event) == 0;
}

struct acceptor *acceptor_create(const char *listen_at, struct net *net, struct http *http, const struct hosts *hosts, struct error *err)
{
    struct acceptor *acceptor = mem_new(sizeof *acceptor);
    acceptor->hosts = hosts;
    acceptor->net = net;
    acceptor->http = http;
    acceptor->listener = -1;
    for (size_t i = 0; i < ACCEPTOR_MAX_PENDING; i++)
        acceptor->pending[i].socket = -1;
    acceptor->epoll = epoll_create1(EPOLL_CLOEXEC);
    acceptor->stop = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (!start_listening(acceptor, listen_at, err))
        goto fail;
    if (acceptor->epoll < 0 || !watch(acceptor, acceptor->stop, stop_tag) || !watch(acceptor, acceptor->listener, listener_tag) ||
        pthread_create(&acceptor->thread, NULL, run, acceptor) != 0) {
        error_set(err, ERROR_IO, "the acceptor did not start: %s", strerror(errno));
        goto fail;
    }
    acceptor->has_thread = true;
    return acceptor;
fail:
    acceptor_destroy(acceptor);
    return NULL;
}

void acceptor_destroy(struct acceptor *acceptor)
{
    if (!acceptor)
        return;
    if (acceptor->has_thread) {
        uint64_t one = 1;
        if (write(acceptor->stop, &one, sizeof one) != sizeof one)
            abort(); /* the thread could never be joined */
        pthread_join(acceptor->thread, NULL);
    }
    for (size_t i = 0; i < ACCEPTOR_MAX_PENDING; i++)
        if (acceptor->pending[i].socket >= 0)
            close(acceptor->pending[i].socket);
    const int fds[] = { acceptor->listener, acceptor->epoll, acceptor->stop };
    for (size_t i = 0; i < sizeof fds / sizeof fds[0]; i++)
        if (fds[i] >= 0)
            close(fds[i]);
    free(acceptor);
}

const char *acceptor_url(const struct acceptor *acceptor)
{
    return acceptor->url;
}
