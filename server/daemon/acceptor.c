/* Listens, peeks at each first head, and hands the socket on or refuses it; on a thread of its own. */
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
#include "server/front/head.h"
#include "server/http/http.h"
#include "server/net/net.h"
#include "server/wire/refusal.h"

struct pending { /* a connection whose first head is not whole, or that was refused */
    int socket;  /* -1: free */
    struct address peer;
    int64_t until_us;
    bool is_refused; /* answered; further bytes are read and dropped, because closing a socket with unread bytes takes
                        the answer back */
    size_t n_dropped;
};

struct websocket {       /* a connection of the net thread, until its end */
    atomic_bool is_used; /* set by the acceptor's thread, cleared by the net thread */
    struct address counted;
};

enum {
    N_SLOTS = ACCEPTOR_MAX_PENDING + ACCEPTOR_MAX_REFUSED,
    MAX_AT_ONCE = 256, /* connections accepted before other events are handled, among them the heartbeat */
    BACKLOG = 4096     /* of listen(2): a connection that does not fit is retried by its client a second later */
};

struct acceptor {
    struct acceptor_options options;
    char bytes[HEAD_MAX_BYTES]; /* of the head that is being peeked at */
    int listener, epoll, wake_fd;
    atomic_bool is_stopping, is_to_hang;
    _Atomic(atomic_bool *) pinged;
    pthread_t thread;
    bool has_thread;
    char url[100];
    struct pending pending[N_SLOTS];
    size_t n_pending, n_refused;
    struct websocket websockets[ACCEPTOR_MAX_WEBSOCKETS];
};

static const uint64_t listener_tag = UINT64_MAX, wake_tag = UINT64_MAX - 1;

static void free_slot(struct acceptor *acceptor, struct pending *slot)
{
    if (slot->is_refused)
        acceptor->n_refused--;
    else
        acceptor->n_pending--;
    slot->socket = -1;
}

/* Ends epoll's watch before closing: a child process that is being started holds a copy of every descriptor for a
 * moment, so a descriptor that was only closed would go on raising events, for a slot that another connection has by
 * then. */
static void close_pending(const struct acceptor *acceptor, int socket)
{
    (void)epoll_ctl(acceptor->epoll, EPOLL_CTL_DEL, socket, NULL); /* fails for a socket that is not watched yet */
    (void)close(socket);
}

static struct pending *find_slot(struct acceptor *acceptor)
{
    for (size_t i = 0; i < N_SLOTS; i++)
        if (acceptor->pending[i].socket < 0)
            return &acceptor->pending[i];
    return NULL;
}

static bool may_wait(const struct acceptor *acceptor, const struct address *peer)
{
    struct address counted = address_counted(peer);
    size_t n_same = 0;
    if (acceptor->n_pending >= ACCEPTOR_MAX_PENDING)
        return false;
    if (address_is_in(peer, acceptor->options.trusted, acceptor->options.n_trusted))
        return true;
    for (size_t i = 0; i < N_SLOTS; i++) {
        const struct pending *slot = &acceptor->pending[i];
        if (slot->socket < 0 || slot->is_refused)
            continue;
        struct address other = address_counted(&slot->peer);
        n_same += address_is_equal(&other, &counted);
    }
    return n_same < ACCEPTOR_MAX_PENDING_PER_ADDRESS;
}

static void refuse(struct acceptor *acceptor, struct pending *slot, const struct problem *problem)
{
    refusal_send(slot->socket, problem);
    if (!slot->is_refused) {
        acceptor->n_pending--;
        acceptor->n_refused++;
    }
    slot->is_refused = true;
    slot->until_us = clock_now_us() + ACCEPTOR_LINGER_MS * 1000LL;
}

/* Reads and drops bytes of a refused connection. Returns true when the slot can be freed. */
static bool linger(const struct acceptor *acceptor, struct pending *slot)
{
    enum { AT_ONCE = 64 << 10 };
    slot->n_dropped += AT_ONCE; /* an upper bound */
    if (refusal_drain(slot->socket, AT_ONCE) && slot->n_dropped < ACCEPTOR_MAX_DROPPED &&
        acceptor->n_refused <= ACCEPTOR_MAX_REFUSED)
        return false;
    close_pending(acceptor, slot->socket);
    return true;
}

/* A WebSocket has ended. Called on the net thread. */
static void websocket_ended(void *context)
{
    struct websocket *websocket = context;
    atomic_store(&websocket->is_used, false);
}

/* Hands a WebSocket to the net thread. Returns false with problem when there are too many. */
static bool hand_to_net(struct acceptor *acceptor, int socket, const struct handshake *handshake,
                        const struct address *client, struct problem *problem)
{
    struct address counted = address_counted(client);
    struct websocket *unused = NULL;
    size_t n_same = 0;
    for (size_t i = 0; i < ACCEPTOR_MAX_WEBSOCKETS; i++) {
        struct websocket *websocket = &acceptor->websockets[i];
        if (!atomic_load(&websocket->is_used))
            unused = websocket;
        else
            n_same += address_is_equal(&websocket->counted, &counted);
    }
    if (!unused || n_same >= ACCEPTOR_MAX_WEBSOCKETS_PER_ADDRESS) {
        problem_set(problem, PROBLEM_LIMIT, "", "",
                    "too many WebSockets are open: at most %d in all, %d from one address", ACCEPTOR_MAX_WEBSOCKETS,
                    ACCEPTOR_MAX_WEBSOCKETS_PER_ADDRESS);
        problem->retry_after_ms = ACCEPTOR_RETRY_MS;
        return false;
    }
    unused->counted = counted;
    atomic_store(&unused->is_used, true);
    net_adopt(acceptor->options.net, socket, handshake, websocket_ended, unused);
    return true;
}

/* Peeks at the received bytes. has_ended: no more will come. Returns true when the slot can be freed. */
static bool peek(struct acceptor *acceptor, struct pending *slot, bool has_ended)
{
    struct problem problem;
    struct head_request request;
    if (slot->is_refused)
        return linger(acceptor, slot);
    ssize_t n = recv(slot->socket, acceptor->bytes, sizeof acceptor->bytes, MSG_PEEK | MSG_DONTWAIT);
    if (n < 0 && (errno == EAGAIN || errno == EINTR))
        return false;
    if (n <= 0) {
        close_pending(acceptor, slot->socket);
        return true;
    }
    enum head_kind kind = head_read(acceptor->bytes, (size_t)n, acceptor->options.hosts, &request, &problem);
    if (kind == HEAD_INCOMPLETE && !has_ended)
        return false;
    if (kind == HEAD_INCOMPLETE)
        head_refuse_incomplete(acceptor->bytes, (size_t)n, true, 0, &problem);
    if (kind == HEAD_INCOMPLETE || kind == HEAD_REFUSED) {
        refuse(acceptor, slot, &problem);
        return linger(acceptor, slot);
    }
    epoll_ctl(acceptor->epoll, EPOLL_CTL_DEL, slot->socket, NULL); /* fails for a socket whose head was whole at once */
    struct address client = address_of_client(&slot->peer, acceptor->options.trusted, acceptor->options.n_trusted,
                                              request.forwarded, request.n_forwarded);
    if (kind == HEAD_HTTP) {
        http_add_connection(acceptor->options.http, slot->socket, &slot->peer, &client);
        return true;
    }
    struct handshake handshake;
    head_read_handshake(acceptor->bytes, (size_t)n, &handshake);
    address_write(&client, handshake.client);
    if (!hand_to_net(acceptor, slot->socket, &handshake, &client, &problem)) {
        refuse(acceptor, slot, &problem);
        (void)refusal_drain(slot->socket, HEAD_MAX_BYTES);
        close_pending(acceptor, slot->socket);
    }
    return true;
}

/* The connection's time is over. Returns true when the slot can be freed. */
static bool end_late(struct acceptor *acceptor, struct pending *slot)
{
    struct problem problem;
    ssize_t n =
        slot->is_refused ? 0 : recv(slot->socket, acceptor->bytes, sizeof acceptor->bytes, MSG_PEEK | MSG_DONTWAIT);
    if (n <= 0) { /* without a byte no answer is expected: browsers open connections in advance */
        close_pending(acceptor, slot->socket);
        return true;
    }
    head_refuse_incomplete(acceptor->bytes, (size_t)n, false, ACCEPTOR_HEAD_MS, &problem);
    refuse(acceptor, slot, &problem);
    return linger(acceptor, slot);
}

/* A connection whose head is whole already takes no slot for long: in a burst the slots are for slow ones. */
static void accept_one(struct acceptor *acceptor, int socket, const struct address *peer)
{
    struct pending *slot = find_slot(acceptor);
    if (!slot) {
        close(socket);
        return;
    }
    bool has_room = may_wait(acceptor, peer);
    *slot = (struct pending){ .socket = socket, .peer = *peer, .until_us = clock_now_us() + ACCEPTOR_HEAD_MS * 1000LL };
    acceptor->n_pending++;
    if (peek(acceptor, slot, false)) {
        free_slot(acceptor, slot);
        return;
    }
    if (!has_room && !slot->is_refused) {
        struct problem problem; /* the oldest pending ones reach their time limit soon */
        problem_set(&problem, PROBLEM_LIMIT, "", "",
                    "too many connections that have not said what they want: at most %d in all, %d from one address",
                    ACCEPTOR_MAX_PENDING, ACCEPTOR_MAX_PENDING_PER_ADDRESS);
        problem.retry_after_ms = ACCEPTOR_HEAD_MS;
        refuse(acceptor, slot, &problem);
        if (linger(acceptor, slot)) {
            free_slot(acceptor, slot);
            return;
        }
    }
    /* Edge-triggered: peeked bytes stay in the socket, and only new ones may raise an event. Bytes that came since the
     * first look raise one at once. */
    struct epoll_event event = { .events = EPOLLIN | EPOLLRDHUP | EPOLLET,
                                 .data.u64 = (uint64_t)(slot - acceptor->pending) };
    if (epoll_ctl(acceptor->epoll, EPOLL_CTL_ADD, socket, &event) != 0) {
        close(socket);
        free_slot(acceptor, slot);
    }
}

/* The listener is level-triggered: connections left in the system's queue raise another event. */
static void accept_some(struct acceptor *acceptor)
{
    for (int i = 0; i < MAX_AT_ONCE; i++) {
        struct sockaddr_storage address = { 0 };
        socklen_t n_address = sizeof address;
        int socket = accept4(acceptor->listener, (struct sockaddr *)&address, &n_address, SOCK_NONBLOCK | SOCK_CLOEXEC);
        if (socket >= 0) {
            struct address peer = address_of_peer(&address);
            accept_one(acceptor, socket, &peer);
        } else if (errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM) {
            log_warn("acceptor: %s", strerror(errno));
            usleep(50000); /* waits for other connections to close */
            return;
        } else if (errno != EINTR && errno != ECONNABORTED) {
            return;
        }
    }
}

static int drop_late(struct acceptor *acceptor)
{
    int64_t now_us = clock_now_us(), next_us = INT64_MAX;
    for (size_t i = 0; i < N_SLOTS && acceptor->n_pending + acceptor->n_refused > 0; i++) {
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
            if (tag == wake_tag) {
                uint64_t n_wakes;
                while (atomic_load(&acceptor->is_to_hang))
                    (void)pause();
                atomic_bool *pinged = atomic_exchange(&acceptor->pinged, NULL);
                if (read(acceptor->wake_fd, &n_wakes, sizeof n_wakes) == sizeof n_wakes && pinged)
                    atomic_store(pinged, true);
                if (atomic_load(&acceptor->is_stopping))
                    return NULL;
                continue;
            }
            if (tag == listener_tag) {
                accept_some(acceptor);
                continue;
            }
            struct pending *slot = &acceptor->pending[tag];
            if (slot->socket >= 0 && peek(acceptor, slot, events[i].events & (EPOLLRDHUP | EPOLLHUP | EPOLLERR)))
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
        return error_set(err, ERROR_FORMAT, "--listen %.80s: expected ADDRESS:PORT, as in 127.0.0.1:8080 or [::1]:8080",
                         listen_at);
    (void)snprintf(host, sizeof host, "%.*s", (int)(is_bracketed ? n - 2 : n), listen_at + is_bracketed);
    if (colon[1 + strspn(colon + 1, "0123456789")] || strlen(colon + 1) - 1 >= 5 ||
        strtoul(colon + 1, NULL, 10) > 65535)
        return error_set(err, ERROR_RANGE, "--listen %.80s: expected a port from 0 to 65535",
                         listen_at); /* getaddrinfo uses only its low 16 bits */
    struct addrinfo hints = { .ai_flags = AI_NUMERICHOST | AI_NUMERICSERV | AI_PASSIVE, .ai_socktype = SOCK_STREAM },
                    *found = NULL;
    int failed = getaddrinfo(host, colon + 1, &hints, &found);
    if (failed)
        return error_set(err, ERROR_FORMAT, "--listen %.80s: %s; expected a numeric address and port", listen_at,
                         gai_strerror(failed));
    int on = 1;
    acceptor->listener = socket(found->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    bool ok =
        acceptor->listener >= 0 && setsockopt(acceptor->listener, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) == 0 &&
        bind(acceptor->listener, found->ai_addr, found->ai_addrlen) == 0 && listen(acceptor->listener, BACKLOG) == 0;
    freeaddrinfo(found);
    if (!ok)
        return error_set(err, ERROR_IO, "--listen %.80s: %s", listen_at, strerror(errno));
    struct sockaddr_storage bound;
    socklen_t n_bound = sizeof bound;
    if (getsockname(acceptor->listener, (struct sockaddr *)&bound, &n_bound) != 0)
        return error_set(err, ERROR_IO, "--listen %.80s: %s", listen_at, strerror(errno));
    unsigned port = ntohs(bound.ss_family == AF_INET ? ((struct sockaddr_in *)&bound)->sin_port
                                                     : ((struct sockaddr_in6 *)&bound)->sin6_port);
    (void)snprintf(acceptor->url, sizeof acceptor->url, bound.ss_family == AF_INET6 ? "http://[%s]:%u" : "http://%s:%u",
                   host, port);
    return true;
}

static bool watch(struct acceptor *acceptor, int fd, uint64_t tag)
{
    struct epoll_event event = { .events = EPOLLIN, .data.u64 = tag };
    return fd >= 0 && epoll_ctl(acceptor->epoll, EPOLL_CTL_ADD, fd, &event) == 0;
}

struct acceptor *acceptor_create(const struct acceptor_options *options, struct error *err)
{
    struct acceptor *acceptor = mem_new(sizeof *acceptor);
    acceptor->options = *options;
    acceptor->listener = -1;
    atomic_init(&acceptor->is_stopping, false);
    atomic_init(&acceptor->is_to_hang, false);
    atomic_init(&acceptor->pinged, NULL);
    for (size_t i = 0; i < N_SLOTS; i++)
        acceptor->pending[i].socket = -1;
    for (size_t i = 0; i < ACCEPTOR_MAX_WEBSOCKETS; i++)
        atomic_init(&acceptor->websockets[i].is_used, false);
    acceptor->epoll = epoll_create1(EPOLL_CLOEXEC);
    acceptor->wake_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (!start_listening(acceptor, options->listen, err))
        goto fail;
    if (acceptor->epoll < 0 || !watch(acceptor, acceptor->wake_fd, wake_tag) ||
        !watch(acceptor, acceptor->listener, listener_tag) ||
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

static void wake(struct acceptor *acceptor)
{
    uint64_t one = 1;
    if (write(acceptor->wake_fd, &one, sizeof one) != sizeof one)
        abort(); /* else the thread could never be joined */
}

void acceptor_stop(struct acceptor *acceptor)
{
    if (!acceptor)
        return;
    if (acceptor->has_thread) {
        atomic_store(&acceptor->is_stopping, true);
        wake(acceptor);
        pthread_join(acceptor->thread, NULL);
        acceptor->has_thread = false;
    }
    for (size_t i = 0; i < N_SLOTS; i++)
        if (acceptor->pending[i].socket >= 0) {
            close(acceptor->pending[i].socket);
            acceptor->pending[i].socket = -1;
        }
    int *const fds[] = { &acceptor->listener, &acceptor->epoll, &acceptor->wake_fd };
    for (size_t i = 0; i < sizeof fds / sizeof fds[0]; i++) {
        if (*fds[i] >= 0)
            close(*fds[i]);
        *fds[i] = -1;
    }
}

void acceptor_destroy(struct acceptor *acceptor)
{
    acceptor_stop(acceptor);
    free(acceptor);
}

void acceptor_ping(struct acceptor *acceptor, atomic_bool *beat)
{
    atomic_store(&acceptor->pinged, beat);
    wake(acceptor);
}

const char *acceptor_url(const struct acceptor *acceptor)
{
    return acceptor->url;
}

void acceptor_hang(struct acceptor *acceptor)
{
    atomic_store(&acceptor->is_to_hang, true);
    wake(acceptor);
}
