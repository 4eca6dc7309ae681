#define _GNU_SOURCE
/* The front's thread: accepts connections, passes epoll's events to the links, runs the library, ends links that are
 * late, and frees a link when both of its sides have ended. */
#include "server/front/front.h"

#include <errno.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>

#include "core/base/clock.h"
#include "core/base/gate.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "core/base/queue.h"
#include "server/front/front_count.h"
#include "server/front/front_link.h"
#include "server/front/head.h"
#include "server/front/listener.h"
#include "server/wire/refusal.h"

enum {
    TICK_MS = 500,
    MAX_AT_ONCE = 256,     /* connections accepted before other events are handled, among them the heartbeat */
    NO_DESCRIPTORS_MS = 50 /* without descriptors nothing is accepted for so long, while other connections close */
};

struct arrival { /* a connection before it has a link */
    int socket;
    struct address peer;
    bool is_plain;                            /* of front_take_plain */
    bool is_local, is_from_proxy, is_control; /* as in struct front_link */
    struct local_process runs_as;             /* is_local: the process at the other end */
};

static char wake_tag, library_tag,
    listener_tags[1 + FRONT_ALL_SOCKETS]; /* their addresses mark events of descriptors */

/* ---- the set of links ------------------------------------------------------------------------------------------- */

void front_client(const struct front_link *link, char text[ADDRESS_TEXT])
{
    address_write(&link->asked_by, text);
}

const struct identity *front_identity(const struct front_link *link)
{
    return &link->identity;
}

struct front_link *front_find(struct front *front, int socket)
{
    struct front_link *link = front->links;
    while (link && (link->server != socket || link->is_started))
        link = link->next;
    if (link)
        link->is_started = true;
    return link;
}

/* ---- the thread ------------------------------------------------------------------------------------------------- */

static struct front_link *create_link(struct front *front, const struct arrival *arrival)
{
    struct front_link *link = mem_new(sizeof *link);
    *link = (struct front_link){ .next = front->links,
                                 .front = front,
                                 .state = LINK_DEAD,
                                 .client = arrival->socket,
                                 .inner = -1,
                                 .server = -1,
                                 .peer = arrival->peer,
                                 .is_local = arrival->is_local,
                                 .is_from_proxy = arrival->is_from_proxy,
                                 .is_control = arrival->is_control,
                                 .is_first = true,
                                 .client_readable = true };
    link->head_us = link->moved_us = clock_now_us();
    body_begin(&link->body, false, 0);
    if (front->links)
        front->links->previous = link;
    front->links = link;
    front_set_state(link, LINK_HEAD);
    return link;
}

static void refuse_waiting(struct front_link *link)
{
    struct problem problem; /* the oldest waiting ones reach their time limit soon */
    problem_set(&problem, PROBLEM_LIMIT, "", "",
                "too many connections that have not said what they want: at most %d in all, %d from one address",
                FRONT_MAX_WAITING, FRONT_MAX_WAITING_PER_ADDRESS);
    problem.retry_after_ms = FRONT_HEAD_MS;
    front_link_refuse(link, &problem, FRONT_MAX_DROPPED_FIRST);
}

static void refuse_plain(struct front_link *link)
{
    struct problem problem;
    problem_set(
        &problem, PROBLEM_REQUEST, "", "",
        "the request came without encryption, and this port speaks TLS; use an address that begins with https:");
    front_link_refuse(link, &problem, FRONT_MAX_DROPPED_FIRST);
}

static void refuse_stranger(struct front_link *link, const struct local_process *runs_as)
{
    struct problem problem;
    problem_set(&problem, PROBLEM_FORBIDDEN, "", "",
                "this socket answers the proxy of --proxy-user alone; this process runs as user %u and group %u",
                (unsigned)runs_as->user, (unsigned)runs_as->group);
    front_link_refuse(link, &problem, FRONT_MAX_DROPPED_FIRST);
}

/* A connection whose head is whole already waits for nothing: in a burst the places of those that wait are for slow
 * ones. */
static void begin_link(struct front *front, const struct arrival *arrival)
{
    const int socket = arrival->socket;
    const bool may_wait = front_may_wait(front, &arrival->peer, arrival->is_from_proxy);
    struct front_link *link = create_link(front, arrival);
    int on = 1;
    (void)setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on); /* answers are written in few large pieces */
    if (arrival->is_plain)
        refuse_plain(link);
    else if (arrival->is_local && !arrival->is_from_proxy && !arrival->is_control)
        refuse_stranger(link, &arrival->runs_as);
    front_link_advance(link);
    if (link->state == LINK_HEAD && link->is_first && !may_wait)
        refuse_waiting(link);
    /* Edge-triggered: bytes that are peeked at stay in the socket, and only new ones may raise an event. Bytes that
     * came since the first look raise one at once. */
    struct epoll_event event = { .events = EPOLLIN | EPOLLOUT | EPOLLRDHUP | EPOLLET,
                                 .data.u64 = (uint64_t)(uintptr_t)link };
    if (link->state != LINK_DEAD && epoll_ctl(front->epoll, EPOLL_CTL_ADD, socket, &event) != 0)
        front_link_die(link);
}

static bool watch(struct front *front, int fd, void *tag)
{
    struct epoll_event event = { .events = EPOLLIN, .data.u64 = (uint64_t)(uintptr_t)tag };
    return fd >= 0 && epoll_ctl(front->epoll, EPOLL_CTL_ADD, fd, &event) == 0;
}

static void accepted(struct front *front, size_t which, int socket, const struct sockaddr_storage *address)
{
    const bool is_local = which > 0;
    struct arrival arrival = { .socket = socket, .peer = address_of_peer(address), .is_local = is_local };
    if (is_local && front->options.sockets[which - 1].is_control)
        arrival.is_control = local_peers_are_own(socket, &arrival.runs_as);
    else if (is_local)
        arrival.is_from_proxy = local_peers_have(&front->options.proxy, socket, &arrival.runs_as);
    if (front->options.decrypt && !is_local)
        front->options.decrypt(front->options.context, socket, &arrival.peer);
    else
        begin_link(front, &arrival);
}

static void watch_listeners(struct front *front, bool is_watched)
{
    for (size_t i = 0; i <= FRONT_ALL_SOCKETS; i++) {
        if (front->listeners[i] < 0)
            continue;
        (void)epoll_ctl(front->epoll, EPOLL_CTL_DEL, front->listeners[i], NULL);
        if (is_watched && !watch(front, front->listeners[i], &listener_tags[i]))
            front->accept_us = clock_now_us() + NO_DESCRIPTORS_MS * INT64_C(1000);
    }
}

/* A listener is level-triggered: connections left in the system's queue raise another event. */
static void accept_some(struct front *front, size_t which)
{
    for (int i = 0; i < MAX_AT_ONCE && !atomic_load(&front->is_closed); i++) {
        struct sockaddr_storage address = { 0 };
        socklen_t n_address = sizeof address;
        int socket =
            accept4(front->listeners[which], (struct sockaddr *)&address, &n_address, SOCK_NONBLOCK | SOCK_CLOEXEC);
        if (socket >= 0) {
            accepted(front, which, socket, &address);
        } else if (errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM) {
            log_warn("front: %s", strerror(errno));
            watch_listeners(front, false);
            front->accept_us = clock_now_us() + NO_DESCRIPTORS_MS * INT64_C(1000);
            return;
        } else if (errno != EINTR && errno != ECONNABORTED) {
            return;
        }
    }
}

/* Accepts again after descriptors ran out. */
static void accept_again(struct front *front, int64_t now_us)
{
    if (front->accept_us && now_us >= front->accept_us) {
        front->accept_us = 0;
        watch_listeners(front, true);
    }
}

static void take_queued(struct front *front)
{
    for (struct arrival *taken; (taken = queue_try_take(front->taken)); free(taken)) {
        if (atomic_load(&front->is_closed))
            (void)close(taken->socket);
        else
            begin_link(front, taken);
    }
}

static void close_listeners(struct front *front)
{
    for (size_t i = 0; i <= FRONT_ALL_SOCKETS; i++) {
        if (front->listeners[i] < 0)
            continue;
        if (i > 0) /* while it listens, so that it is not the file of another daemon, started meanwhile */
            local_socket_remove(&front->options.sockets[i - 1]);
        front_unwatch_and_close(front, &front->listeners[i]);
    }
}

/* After front_close: stops listening, ends the connections whose first head is not whole. */
static void close_door(struct front *front)
{
    close_listeners(front);
    front->is_door_closed = true;
    front->accept_us = 0;
    for (struct front_link *link = front->links; link; link = link->next)
        if (link->state == LINK_HEAD && link->is_first)
            front_link_die(link);
}

static void handle_wake(struct front *front)
{
    uint64_t n;
    if (read(front->wake_fd, &n, sizeof n) == sizeof n)
        take_queued(front);
    atomic_bool *pinged = atomic_exchange(&front->pinged, NULL);
    if (pinged)
        atomic_store(pinged, true);
    if (atomic_load(&front->is_closed) && !front->is_door_closed)
        close_door(front);
}

/* One event of epoll. Its link may have died by an earlier event of the same round; links are freed after the round. */
static void handle_event(struct front *front, const struct epoll_event *event)
{
    const uint64_t tag = event->data.u64;
    if (tag == (uint64_t)(uintptr_t)&wake_tag) {
        handle_wake(front);
        return;
    }
    if (tag - (uint64_t)(uintptr_t)listener_tags < sizeof listener_tags) {
        accept_some(front, tag - (uint64_t)(uintptr_t)listener_tags);
        return;
    }
    if (tag == (uint64_t)(uintptr_t)&library_tag)
        return; /* run is called after the events */
    struct front_link *link = (struct front_link *)(uintptr_t)(event->data.u64 & ~UINT64_C(1));
    if (link->state == LINK_DEAD)
        return;
    if (event->data.u64 & 1) {
        link->inner_readable = link->inner_readable || (event->events & (EPOLLIN | EPOLLRDHUP | EPOLLHUP | EPOLLERR));
        link->inner_hung_up = link->inner_hung_up || (event->events & (EPOLLRDHUP | EPOLLHUP | EPOLLERR));
    } else {
        if (event->events & (EPOLLHUP | EPOLLERR)) {
            front_link_die(link); /* both directions are closed */
            return;
        }
        link->client_readable = link->client_readable || (event->events & (EPOLLIN | EPOLLRDHUP));
        link->client_hung_up = link->client_hung_up || (event->events & EPOLLRDHUP);
    }
    front_link_advance(link);
}

static void handle_touched(struct front *front)
{
    struct front_link *link = front->touched, *next;
    front->touched = NULL; /* links touched from here on are advanced in the next round */
    for (; link; link = next) {
        next = link->next_touched;
        link->is_touched = false;
        front_link_advance(link);
    }
}

/* True when a window has ended with too few bytes. Begins the next one. */
static bool is_window_missed(struct front_link *link, int64_t now_us)
{
    if (now_us - link->window_us < FRONT_WINDOW_MS * INT64_C(1000))
        return false;
    bool is_missed = link->window_bytes < FRONT_WINDOW_BYTES;
    front_link_begin_window(link);
    return is_missed;
}

static void check_answer(struct front_link *link, int64_t now_us)
{
    int64_t still_us = now_us - link->moved_us;
    struct problem problem;
    if (link->n_out == 0) { /* the client has taken all bytes and waits for the library */
        front_link_begin_window(link);
        if (still_us > FRONT_ANSWER_MS * INT64_C(1000)) {
            problem_set(&problem, PROBLEM_TIMEOUT, "", "", "no answer within %d s", FRONT_ANSWER_MS / 1000);
            front_link_refuse(link, &problem, FRONT_MAX_DROPPED);
        }
    } else if (still_us > FRONT_IDLE_MS * INT64_C(1000) || is_window_missed(link, now_us)) {
        front_link_die(link);
    } else {
        front_touch(
            link); /* epoll reports room only when much was taken: sending again shows a slow client's progress */
    }
}

static void check_head(struct front_link *link, int64_t now_us)
{
    const bool is_late = (link->is_first || link->n_head > 0) && now_us - link->head_us > FRONT_HEAD_MS * INT64_C(1000);
    if (is_late && link->n_head > 0)
        front_link_refuse_late(link);
    else if (is_late || now_us - link->moved_us > FRONT_IDLE_MS * INT64_C(1000))
        front_link_die(link); /* without a byte no answer is expected: browsers open connections in advance */
}

static void check_body(struct front_link *link, int64_t now_us)
{
    struct problem problem;
    if (now_us - link->moved_us <= FRONT_IDLE_MS * INT64_C(1000) && !is_window_missed(link, now_us))
        return;
    problem_set(&problem, PROBLEM_TOO_SLOW, "", "",
                "too little of the request's body came; expected are %d bytes in every %d s", FRONT_WINDOW_BYTES,
                FRONT_WINDOW_MS / 1000);
    front_link_refuse(link, &problem, FRONT_MAX_DROPPED);
}

static void check_times(struct front *front, int64_t now_us)
{
    for (struct front_link *link = front->links; link; link = link->next) {
        switch (link->state) {
        case LINK_HEAD: check_head(link, now_us); break;
        case LINK_BODY: check_body(link, now_us); break;
        case LINK_ANSWER: check_answer(link, now_us); break;
        case LINK_LINGER:
            if (now_us >= link->linger_us || now_us - link->moved_us > FRONT_LINGER_SILENT_MS * INT64_C(1000))
                front_link_die(link);
            break;
        case LINK_DEAD:
            if (!link->is_started) { /* the library had no memory for the connection and closed its end without a report
                                      */
                link->server = -1;
                front_uncount(link);
                front->has_dead = true;
            }
            break;
        }
    }
}

/* Frees the links whose both sides have ended. */
static void free_dead(struct front *front)
{
    struct front_link *next;
    if (!front->has_dead)
        return;
    front->has_dead = false;
    for (struct front_link *link = front->links; link; link = next) {
        next = link->next;
        if (link->state == LINK_DEAD && link->is_touched)
            front->has_dead = true;
        if (link->state != LINK_DEAD || link->server >= 0 || link->is_touched)
            continue;
        if (link->previous)
            link->previous->next = next;
        else
            front->links = next;
        if (next)
            next->previous = link->previous;
        free(link);
    }
}

static int wait_ms(const struct front *front, bool has_more)
{
    if (has_more || front->touched)
        return 0;
    if (front->accept_us)
        return NO_DESCRIPTORS_MS;
    return front->links ? TICK_MS : -1;
}

static void *work(void *argument)
{
    struct front *front = argument;
    int64_t tick_us = clock_now_us();
    bool has_more = false;
    (void)pthread_setname_np(pthread_self(), "front");
    while (!atomic_load(&front->is_stopping)) {
        struct epoll_event events[128];
        int n = epoll_wait(front->epoll, events, 128, wait_ms(front, has_more));
        for (int i = 0; i < n; i++)
            handle_event(front, &events[i]);
        has_more = front->library.run(front->library.context);
        handle_touched(front);
        int64_t now_us = clock_now_us();
        accept_again(front, now_us);
        if (now_us - tick_us >= TICK_MS * INT64_C(1000)) {
            tick_us = now_us;
            check_times(front, now_us);
        }
        free_dead(front);
    }
    (void)front->library.run(front->library.context); /* answers that came meanwhile */
    for (struct front_link *link = front->links; link; link = link->next)
        if (link->state == LINK_ANSWER) {
            link->inner_readable = true;
            front_link_pass_answer(link);
        }
    return NULL;
}

/* ---- start and stop --------------------------------------------------------------------------------------------- */

static void taken_drop(void *item)
{
    struct arrival *taken = item;
    (void)close(taken->socket);
    free(taken);
}

struct front *front_create(const struct front_options *options, struct error *err)
{
    struct front *front = mem_new(sizeof *front);
    front->options = *options;
    atomic_init(&front->is_closed, false);
    atomic_init(&front->is_stopping, false);
    atomic_init(&front->pinged, NULL);
    websocket_count_init(&front->websockets);
    front->taken = queue_create(FRONT_MAX_TAKEN, taken_drop);
    front->adopting = gate_create();
    for (size_t i = 0; i <= FRONT_ALL_SOCKETS; i++)
        front->listeners[i] = -1;
    front->epoll = epoll_create1(EPOLL_CLOEXEC);
    front->wake_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (front->epoll < 0 || !watch(front, front->wake_fd, &wake_tag)) {
        error_set(err, ERROR_IO, "the front's thread has no descriptors: %s", strerror(errno));
        front_destroy(front);
        return NULL;
    }
    return front;
}

static bool open_listeners(struct front *front, struct error *err)
{
    const struct front_options *options = &front->options;
    if (options->listen)
        front->listeners[0] = listener_open(options->listen, options->decrypt != NULL, front->url, err);
    else
        (void)snprintf(front->url, sizeof front->url, "unix:%s", options->sockets[0].path);
    bool ok = !options->listen || front->listeners[0] >= 0;
    for (size_t i = 0; ok && i < options->n_sockets; i++) {
        struct error found = { 0 };
        front->listeners[1 + i] = local_socket_open(&options->sockets[i], &found);
        if (front->listeners[1 + i] < 0 && options->sockets[i].is_control)
            log_warn("without %s, users and tokens are managed over HTTP alone: %s", options->sockets[i].path,
                     found.text);
        else if (front->listeners[1 + i] < 0)
            ok = error_set(err, found.code, "%s", found.text);
    }
    return ok;
}

bool front_serve(struct front *front, const struct front_library *library, struct error *err)
{
    front->library = *library;
    if (!open_listeners(front, err))
        return false;
    watch_listeners(front, true);
    if (!watch(front, library->poll_fd, &library_tag) || front->accept_us ||
        pthread_create(&front->thread, NULL, work, front) != 0)
        return error_set(err, ERROR_IO, "the front's thread did not start: %s", strerror(errno));
    front->has_thread = true;
    return true;
}

void front_wake(struct front *front)
{
    uint64_t one = 1;
    if (write(front->wake_fd, &one, sizeof one) != sizeof one)
        log_debug("front: the thread is woken already"); /* the counter is full: the thread is about to run */
}

void front_close(struct front *front)
{
    atomic_store(&front->is_closed, true);
    front_wake(front);
    gate_close(front->adopting);
}

void front_stop(struct front *front)
{
    if (!front)
        return;
    if (front->has_thread) {
        atomic_store(&front->is_stopping, true);
        front_wake(front);
        (void)pthread_join(front->thread, NULL);
        front->has_thread = false;
    }
    close_listeners(front);
    for (struct front_link *link = front->links; link; link = link->next)
        if (link->state != LINK_DEAD)
            front_link_die(link);
}

void front_destroy(struct front *front)
{
    if (!front)
        return;
    front_stop(front);
    front_close_fd(&front->epoll);
    front_close_fd(&front->wake_fd);
    queue_destroy(front->taken);
    gate_destroy(front->adopting);
    for (struct front_link *link = front->links, *next; link; link = next) {
        next = link->next;
        free(link);
    }
    free(front);
}

const char *front_url(const struct front *front)
{
    return front->url;
}

static void take(struct front *front, int socket, const struct address *peer, bool is_plain)
{
    struct arrival *taken = mem_new(sizeof *taken);
    *taken = (struct arrival){ .socket = socket, .peer = *peer, .is_plain = is_plain };
    if (queue_try_put(front->taken, taken)) {
        front_wake(front);
        return;
    }
    struct problem problem;
    problem_set(&problem, PROBLEM_LIMIT, "", "", "%d connections wait to be taken over already; at most so many do",
                FRONT_MAX_TAKEN);
    problem.retry_after_ms = FRONT_RETRY_MS;
    (void)refusal_drain(socket, HEAD_MAX_BYTES);
    refusal_send(socket, &problem);
    taken_drop(taken);
}

void front_take(struct front *front, int socket, const struct address *peer)
{
    take(front, socket, peer, false);
}

void front_take_plain(struct front *front, int socket, const struct address *peer)
{
    take(front, socket, peer, true);
}

void front_ping(struct front *front, atomic_bool *beat)
{
    atomic_store(&front->pinged, beat);
    front_wake(front);
}
