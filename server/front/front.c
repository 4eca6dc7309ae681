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
#include "server/front/front_count.h"
#include "server/front/front_link.h"
#include "server/front/head.h"
#include "server/wire/refusal.h"

enum { TICK_MS = 500 };

struct new_connection { /* a connection from the acceptor that the thread has not taken yet */
    int socket;
    struct address peer, client;
};

static char wake_tag, server_tag; /* their addresses mark the events of wake_fd and of the library */

/* ---- the set of links ------------------------------------------------------------------------------------------- */

void front_client(const struct front_link *link, char text[ADDRESS_TEXT])
{
    address_write(&link->asked_by, text);
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

static void add_link(struct front *front, const struct new_connection *connection)
{
    struct problem problem;
    struct front_link *link = mem_new(sizeof *link);
    int on = 1;
    *link = (struct front_link){ .next = front->links,
                                 .front = front,
                                 .client = connection->socket,
                                 .inner = -1,
                                 .server = -1,
                                 .peer = connection->peer,
                                 .client_readable = true };
    link->head_us = link->moved_us = clock_now_us();
    body_begin(&link->body, false, 0);
    if (front->links)
        front->links->previous = link;
    front->links = link;
    (void)setsockopt(connection->socket, IPPROTO_TCP, TCP_NODELAY, &on,
                     sizeof on); /* answers are written in few large pieces */
    struct epoll_event event = { .events = EPOLLIN | EPOLLOUT | EPOLLRDHUP | EPOLLET,
                                 .data.u64 = (uint64_t)(uintptr_t)link };
    if (epoll_ctl(front->epoll, EPOLL_CTL_ADD, connection->socket, &event) != 0) {
        front_link_die(link);
    } else if (!front_count(link, &connection->client, &problem)) {
        (void)refusal_drain(link->client, HEAD_MAX_BYTES);
        front_log_refusal(front);
        front_link_refuse(link, &problem, FRONT_MAX_DROPPED);
    } else {
        front_link_advance(link);
    }
}

static void add_queued(struct front *front)
{
    for (struct new_connection *connection; (connection = queue_try_take(front->queue)); free(connection))
        add_link(front, connection);
}

/* One event of epoll. Its link may have died by an earlier event of the same round; links are freed after the round. */
static void handle_event(struct front *front, const struct epoll_event *event)
{
    if (event->data.u64 == (uint64_t)(uintptr_t)&wake_tag) {
        uint64_t n;
        if (read(front->wake_fd, &n, sizeof n) == sizeof n)
            add_queued(front);
        while (atomic_load(&front->is_to_hang))
            (void)pause();
        atomic_bool *pinged = atomic_exchange(&front->pinged, NULL);
        if (pinged)
            atomic_store(pinged, true);
        return;
    }
    if (event->data.u64 == (uint64_t)(uintptr_t)&server_tag)
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

static void check_times(struct front *front, int64_t now_us)
{
    struct problem problem;
    for (struct front_link *link = front->links; link; link = link->next) {
        int64_t still_ms = (now_us - link->moved_us) / 1000;
        bool is_late = false;
        switch (link->state) {
        case LINK_HEAD:
            if (link->n_in > 0 && now_us - link->head_us > FRONT_HEAD_MS * INT64_C(1000)) {
                head_refuse_incomplete(link->in, link->n_in, false, FRONT_HEAD_MS, &problem);
                link->n_answered = 0;
                front_link_refuse(link, &problem, FRONT_MAX_DROPPED);
            } else {
                is_late = still_ms > FRONT_IDLE_MS;
            }
            break;
        case LINK_BODY:
            if (still_ms > FRONT_IDLE_MS || is_window_missed(link, now_us)) {
                problem_set(&problem, PROBLEM_TOO_SLOW, "", "",
                            "too little of the request's body came; expected are %d bytes in every %d s",
                            FRONT_WINDOW_BYTES, FRONT_WINDOW_MS / 1000);
                front_link_refuse(link, &problem, FRONT_MAX_DROPPED);
            }
            break;
        case LINK_ANSWER: check_answer(link, now_us); break;
        case LINK_LINGER: is_late = still_ms > FRONT_LINGER_SILENT_MS; break;
        case LINK_DEAD:
            if (!link->is_started) { /* the library had no memory for the connection and closed its end without a report
                                      */
                link->server = -1;
                front_uncount(link);
                front->has_dead = true;
            }
            break;
        }
        if (is_late)
            front_link_die(link);
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

static void *work(void *argument)
{
    struct front *front = argument;
    int64_t tick_us = clock_now_us();
    bool has_more = false;
    while (!atomic_load(&front->is_stopping)) {
        struct epoll_event events[128];
        int n = epoll_wait(front->epoll, events, 128, has_more || front->touched ? 0 : front->links ? TICK_MS : -1);
        for (int i = 0; i < n; i++)
            handle_event(front, &events[i]);
        has_more = front->server.run(front->server.context);
        handle_touched(front);
        int64_t now_us = clock_now_us();
        if (now_us - tick_us >= TICK_MS * INT64_C(1000)) {
            tick_us = now_us;
            check_times(front, now_us);
        }
        free_dead(front);
    }
    (void)front->server.run(front->server.context); /* answers that came meanwhile */
    for (struct front_link *link = front->links; link; link = link->next)
        if (link->state == LINK_ANSWER) {
            link->inner_readable = true;
            front_link_pass_answer(link);
        }
    return NULL;
}

static void connection_drop(void *item)
{
    struct new_connection *connection = item;
    (void)close(connection->socket);
    free(connection);
}

static bool watch(struct front *front, int fd, void *tag)
{
    struct epoll_event event = { .events = EPOLLIN, .data.u64 = (uint64_t)(uintptr_t)tag };
    return fd >= 0 && epoll_ctl(front->epoll, EPOLL_CTL_ADD, fd, &event) == 0;
}

struct front *front_create(const struct front_options *options, struct error *err)
{
    struct front *front = mem_new(sizeof *front);
    front->options = *options;
    atomic_init(&front->is_stopping, false);
    atomic_init(&front->is_to_hang, false);
    atomic_init(&front->pinged, NULL);
    front->queue = queue_create(FRONT_MAX_QUEUED, connection_drop);
    front->epoll = epoll_create1(EPOLL_CLOEXEC);
    front->wake_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (front->epoll < 0 || !watch(front, front->wake_fd, &wake_tag)) {
        error_set(err, ERROR_IO, "the HTTP thread has no descriptors: %s", strerror(errno));
        front_destroy(front);
        return NULL;
    }
    return front;
}

bool front_serve(struct front *front, const struct front_server *server, struct error *err)
{
    front->server = *server;
    if (!watch(front, server->poll_fd, &server_tag) || pthread_create(&front->thread, NULL, work, front) != 0)
        return error_set(err, ERROR_IO, "the HTTP thread did not start: %s", strerror(errno));
    front->has_thread = true;
    return true;
}

void front_wake(struct front *front)
{
    uint64_t one = 1;
    if (write(front->wake_fd, &one, sizeof one) != sizeof one)
        log_debug("http: the thread is woken already"); /* the counter is full: the thread is about to run */
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
    queue_destroy(front->queue);
    for (struct front_link *link = front->links, *next; link; link = next) {
        next = link->next;
        free(link);
    }
    free(front);
}

void front_add(struct front *front, int socket, const struct address *peer, const struct address *client)
{
    struct new_connection *connection = mem_new(sizeof *connection);
    *connection = (struct new_connection){ socket, *peer, *client };
    if (queue_try_put(front->queue, connection)) {
        front_wake(front);
        return;
    }
    struct problem problem;
    problem_set(&problem, PROBLEM_LIMIT, "", "", "%d connections wait to be taken over already; at most so many do",
                FRONT_MAX_QUEUED);
    problem.retry_after_ms = FRONT_RETRY_MS;
    (void)refusal_drain(socket, HEAD_MAX_BYTES);
    refusal_send(socket, &problem);
    connection_drop(connection);
}

void front_ping(struct front *front, atomic_bool *beat)
{
    atomic_store(&front->pinged, beat);
    front_wake(front);
}

void front_hang(struct front *front)
{
    atomic_store(&front->is_to_hang, true);
    front_wake(front);
}
