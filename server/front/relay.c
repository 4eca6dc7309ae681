#define _GNU_SOURCE
/* The HTTP thread: takes connections from the acceptor, passes epoll's events to the links, runs the library, ends
 * links that are late, and frees a link when both of its sides have ended. */
#include <errno.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "core/base/queue.h"
#include "server/front/head.h"
#include "server/front/relay_count.h"
#include "server/front/relay_link.h"
#include "server/wire/refusal.h"

enum { TICK_MS = 500 };

struct new_connection { /* a connection from the acceptor that the thread has not taken yet */
    int socket;
    struct address peer, client;
};

static char wake_tag, server_tag; /* their addresses mark the events of wake_fd and of the library */

/* ---- the set of links ------------------------------------------------------------------------------------------- */

void relay_client(const struct relay_link *link, char text[ADDRESS_TEXT])
{
    address_write(&link->asked_by, text);
}

struct relay_link *relay_find(struct relay *relay, int socket)
{
    struct relay_link *link = relay->links;
    while (link && (link->server != socket || link->is_started))
        link = link->next;
    if (link)
        link->is_started = true;
    return link;
}

/* ---- the thread ------------------------------------------------------------------------------------------------- */

static void add_link(struct relay *relay, const struct new_connection *connection)
{
    struct problem problem;
    struct relay_link *link = mem_new(sizeof *link);
    int on = 1;
    *link = (struct relay_link){ .next = relay->links,
                                 .relay = relay,
                                 .client = connection->socket,
                                 .inner = -1,
                                 .server = -1,
                                 .peer = connection->peer,
                                 .client_readable = true };
    link->head_us = link->moved_us = clock_now_us();
    body_begin(&link->body, false, 0);
    if (relay->links)
        relay->links->previous = link;
    relay->links = link;
    (void)setsockopt(connection->socket, IPPROTO_TCP, TCP_NODELAY, &on,
                     sizeof on); /* answers are written in few large pieces */
    struct epoll_event event = { .events = EPOLLIN | EPOLLOUT | EPOLLRDHUP | EPOLLET,
                                 .data.u64 = (uint64_t)(uintptr_t)link };
    if (epoll_ctl(relay->epoll, EPOLL_CTL_ADD, connection->socket, &event) != 0) {
        relay_link_die(link);
    } else if (!relay_count(link, &connection->client, &problem)) {
        (void)refusal_drain(link->client, HEAD_MAX_BYTES);
        relay_log_refusal(relay);
        relay_link_refuse(link, &problem, RELAY_MAX_DROPPED);
    } else {
        relay_link_advance(link);
    }
}

static void add_queued(struct relay *relay)
{
    for (struct new_connection *connection; (connection = queue_try_take(relay->queue)); free(connection))
        add_link(relay, connection);
}

/* One event of epoll. Its link may have died by an earlier event of the same round; links are freed after the round. */
static void handle_event(struct relay *relay, const struct epoll_event *event)
{
    if (event->data.u64 == (uint64_t)(uintptr_t)&wake_tag) {
        uint64_t n;
        if (read(relay->wake_fd, &n, sizeof n) == sizeof n)
            add_queued(relay);
        while (atomic_load(&relay->is_to_hang))
            (void)pause();
        atomic_bool *pinged = atomic_exchange(&relay->pinged, NULL);
        if (pinged)
            atomic_store(pinged, true);
        return;
    }
    if (event->data.u64 == (uint64_t)(uintptr_t)&server_tag)
        return; /* run is called after the events */
    struct relay_link *link = (struct relay_link *)(uintptr_t)(event->data.u64 & ~UINT64_C(1));
    if (link->state == LINK_DEAD)
        return;
    if (event->data.u64 & 1) {
        link->inner_readable = link->inner_readable || (event->events & (EPOLLIN | EPOLLRDHUP | EPOLLHUP | EPOLLERR));
        link->inner_hung_up = link->inner_hung_up || (event->events & (EPOLLRDHUP | EPOLLHUP | EPOLLERR));
    } else {
        if (event->events & (EPOLLHUP | EPOLLERR)) {
            relay_link_die(link); /* both directions are closed */
            return;
        }
        link->client_readable = link->client_readable || (event->events & (EPOLLIN | EPOLLRDHUP));
    }
    relay_link_advance(link);
}

static void handle_touched(struct relay *relay)
{
    struct relay_link *link = relay->touched, *next;
    relay->touched = NULL; /* links touched from here on are advanced in the next round */
    for (; link; link = next) {
        next = link->next_touched;
        link->is_touched = false;
        relay_link_advance(link);
    }
}

/* True when a window has ended with too few bytes. Begins the next one. */
static bool is_window_missed(struct relay_link *link, int64_t now_us)
{
    if (now_us - link->window_us < RELAY_WINDOW_MS * INT64_C(1000))
        return false;
    bool is_missed = link->window_bytes < RELAY_WINDOW_BYTES;
    relay_link_begin_window(link);
    return is_missed;
}

static void check_answer(struct relay_link *link, int64_t now_us)
{
    int64_t still_us = now_us - link->moved_us;
    struct problem problem;
    if (link->n_out == 0) { /* the client has taken all bytes and waits for the library */
        relay_link_begin_window(link);
        if (still_us > RELAY_ANSWER_MS * INT64_C(1000)) {
            problem_set(&problem, PROBLEM_TIMEOUT, "", "", "no answer within %d s", RELAY_ANSWER_MS / 1000);
            relay_link_refuse(link, &problem, RELAY_MAX_DROPPED);
        }
    } else if (still_us > RELAY_IDLE_MS * INT64_C(1000) || is_window_missed(link, now_us)) {
        relay_link_die(link);
    } else {
        relay_touch(
            link); /* epoll reports room only when much was taken: sending again shows a slow client's progress */
    }
}

static void check_times(struct relay *relay, int64_t now_us)
{
    struct problem problem;
    for (struct relay_link *link = relay->links; link; link = link->next) {
        int64_t still_ms = (now_us - link->moved_us) / 1000;
        bool is_late = false;
        switch (link->state) {
        case LINK_HEAD:
            if (link->n_in > 0 && now_us - link->head_us > RELAY_HEAD_MS * INT64_C(1000)) {
                head_refuse_incomplete(link->in, link->n_in, false, RELAY_HEAD_MS, &problem);
                link->n_answered = 0;
                relay_link_refuse(link, &problem, RELAY_MAX_DROPPED);
            } else {
                is_late = still_ms > RELAY_IDLE_MS;
            }
            break;
        case LINK_BODY:
            if (still_ms > RELAY_IDLE_MS || is_window_missed(link, now_us)) {
                problem_set(&problem, PROBLEM_TOO_SLOW, "", "",
                            "too little of the request's body came; expected are %d bytes in every %d s",
                            RELAY_WINDOW_BYTES, RELAY_WINDOW_MS / 1000);
                relay_link_refuse(link, &problem, RELAY_MAX_DROPPED);
            }
            break;
        case LINK_ANSWER: check_answer(link, now_us); break;
        case LINK_LINGER: is_late = still_ms > RELAY_LINGER_SILENT_MS; break;
        case LINK_DEAD:
            if (!link->is_started) { /* the library had no memory for the connection and closed its end without a report
                                      */
                link->server = -1;
                relay_uncount(link);
                relay->has_dead = true;
            }
            break;
        }
        if (is_late)
            relay_link_die(link);
    }
}

/* Frees the links whose both sides have ended. */
static void free_dead(struct relay *relay)
{
    struct relay_link *next;
    if (!relay->has_dead)
        return;
    relay->has_dead = false;
    for (struct relay_link *link = relay->links; link; link = next) {
        next = link->next;
        if (link->state == LINK_DEAD && link->is_touched)
            relay->has_dead = true;
        if (link->state != LINK_DEAD || link->server >= 0 || link->is_touched)
            continue;
        if (link->previous)
            link->previous->next = next;
        else
            relay->links = next;
        if (next)
            next->previous = link->previous;
        free(link);
    }
}

static void *work(void *argument)
{
    struct relay *relay = argument;
    int64_t tick_us = clock_now_us();
    bool has_more = false;
    while (!atomic_load(&relay->is_stopping)) {
        struct epoll_event events[128];
        int n = epoll_wait(relay->epoll, events, 128, has_more || relay->touched ? 0 : relay->links ? TICK_MS : -1);
        for (int i = 0; i < n; i++)
            handle_event(relay, &events[i]);
        has_more = relay->server.run(relay->server.context);
        handle_touched(relay);
        int64_t now_us = clock_now_us();
        if (now_us - tick_us >= TICK_MS * INT64_C(1000)) {
            tick_us = now_us;
            check_times(relay, now_us);
        }
        free_dead(relay);
    }
    (void)relay->server.run(relay->server.context); /* answers that came meanwhile */
    for (struct relay_link *link = relay->links; link; link = link->next)
        if (link->state == LINK_ANSWER) {
            link->inner_readable = true;
            relay_link_pass_answer(link);
        }
    return NULL;
}

static void connection_drop(void *item)
{
    struct new_connection *connection = item;
    (void)close(connection->socket);
    free(connection);
}

static bool watch(struct relay *relay, int fd, void *tag)
{
    struct epoll_event event = { .events = EPOLLIN, .data.u64 = (uint64_t)(uintptr_t)tag };
    return fd >= 0 && epoll_ctl(relay->epoll, EPOLL_CTL_ADD, fd, &event) == 0;
}

struct relay *relay_create(const struct relay_options *options, struct error *err)
{
    struct relay *relay = mem_new(sizeof *relay);
    relay->options = *options;
    atomic_init(&relay->is_stopping, false);
    atomic_init(&relay->is_to_hang, false);
    atomic_init(&relay->pinged, NULL);
    relay->queue = queue_create(RELAY_MAX_QUEUED, connection_drop);
    relay->epoll = epoll_create1(EPOLL_CLOEXEC);
    relay->wake_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (relay->epoll < 0 || !watch(relay, relay->wake_fd, &wake_tag)) {
        error_set(err, ERROR_IO, "the HTTP thread has no descriptors: %s", strerror(errno));
        relay_destroy(relay);
        return NULL;
    }
    return relay;
}

bool relay_serve(struct relay *relay, const struct relay_server *server, struct error *err)
{
    relay->server = *server;
    if (!watch(relay, server->poll_fd, &server_tag) || pthread_create(&relay->thread, NULL, work, relay) != 0)
        return error_set(err, ERROR_IO, "the HTTP thread did not start: %s", strerror(errno));
    relay->has_thread = true;
    return true;
}

void relay_wake(struct relay *relay)
{
    uint64_t one = 1;
    if (write(relay->wake_fd, &one, sizeof one) != sizeof one)
        log_debug("http: the thread is woken already"); /* the counter is full: the thread is about to run */
}

void relay_stop(struct relay *relay)
{
    if (!relay)
        return;
    if (relay->has_thread) {
        atomic_store(&relay->is_stopping, true);
        relay_wake(relay);
        (void)pthread_join(relay->thread, NULL);
        relay->has_thread = false;
    }
    for (struct relay_link *link = relay->links; link; link = link->next)
        if (link->state != LINK_DEAD)
            relay_link_die(link);
}

void relay_destroy(struct relay *relay)
{
    if (!relay)
        return;
    relay_stop(relay);
    relay_close_fd(&relay->epoll);
    relay_close_fd(&relay->wake_fd);
    queue_destroy(relay->queue);
    for (struct relay_link *link = relay->links, *next; link; link = next) {
        next = link->next;
        free(link);
    }
    free(relay);
}

void relay_add(struct relay *relay, int socket, const struct address *peer, const struct address *client)
{
    struct new_connection *connection = mem_new(sizeof *connection);
    *connection = (struct new_connection){ socket, *peer, *client };
    if (queue_try_put(relay->queue, connection)) {
        relay_wake(relay);
        return;
    }
    struct problem problem;
    problem_set(&problem, PROBLEM_LIMIT, "", "", "%d connections wait to be taken over already; at most so many do",
                RELAY_MAX_QUEUED);
    problem.retry_after_ms = RELAY_RETRY_MS;
    (void)refusal_drain(socket, HEAD_MAX_BYTES);
    refusal_send(socket, &problem);
    connection_drop(connection);
}

void relay_ping(struct relay *relay, atomic_bool *beat)
{
    atomic_store(&relay->pinged, beat);
    relay_wake(relay);
}

void relay_hang(struct relay *relay)
{
    atomic_store(&relay->is_to_hang, true);
    relay_wake(relay);
}
