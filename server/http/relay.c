#define _GNU_SOURCE
/* The HTTP thread and its set of links. The thread takes connections over from the acceptor, counts them, tells each
 * link what epoll reports of its sockets, lets the library run, ends the links whose time is over, and frees a link
 * once both of its sides have ended. */
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
#include "server/http/head.h"
#include "server/http/relay_inner.h"
#include "server/wire/refusal.h"

enum { TICK_MS = 500 };

struct handed { /* a connection on its way from the acceptor */
    int socket;
    struct address peer, client;
};

static char wake_tag, server_tag; /* their addresses mark events that are no link's */

/* ---- counting --------------------------------------------------------------------------------------------------- */

static size_t count_address(const struct relay *relay, const struct address *counted)
{
    size_t n = 0;
    for (const struct relay_link *link = relay->links; link; link = link->next)
        n += link->is_counted && address_is_equal(&link->counted, counted);
    return n;
}

void relay_uncount(struct relay_link *link)
{
    link->relay->n_counted -= link->is_counted;
    link->is_counted = false;
}

/* One whose request waits inside the library keeps its place there, and a descriptor: it counts, or one client could
 * ask and go for ever. */
void relay_uncount_ended(struct relay_link *link)
{
    if (link->server < 0)
        relay_uncount(link);
}

bool relay_count(struct relay_link *link, const struct address *client, struct problem *problem)
{
    struct relay *relay = link->relay;
    struct address counted = address_counted(client);
    if (link->is_counted && address_is_equal(&link->counted, &counted))
        return true;
    size_t n_before = count_address(relay, &counted), n_all = relay->n_counted - link->is_counted;
    if (n_all >= RELAY_MAX_CONNECTIONS || n_before >= RELAY_MAX_PER_ADDRESS) {
        problem_set(problem, PROBLEM_LIMIT, "", "", "too many connections: at most %d in all, %d from one address",
                    RELAY_MAX_CONNECTIONS, RELAY_MAX_PER_ADDRESS);
        problem->retry_after_ms = RELAY_RETRY_MS;
        return false;
    }
    relay->n_counted += !link->is_counted;
    link->is_counted = true;
    link->counted = counted;
    return true;
}

/* A flood of connections must not become one of lines. */
void relay_log_refusal(struct relay *relay)
{
    int64_t now_us = clock_now_us();
    relay->n_refused++;
    if (relay->logged_us && now_us - relay->logged_us < 10000000)
        return;
    log_warn("http: too many connections: %zu refused", relay->n_refused);
    relay->logged_us = now_us;
    relay->n_refused = 0;
}

/* ---- the set of links ------------------------------------------------------------------------------------------- */

void relay_touch(struct relay_link *link)
{
    if (link->is_touched)
        return;
    link->is_touched = true;
    link->next_touched = link->relay->touched;
    link->relay->touched = link;
}

void relay_end_oldest_lingering(struct relay *relay)
{
    struct relay_link *oldest = NULL;
    for (struct relay_link *link = relay->links; link; link = link->next)
        if (link->state == LINK_LINGER)
            oldest = link; /* new links stand in front */
    if (oldest)
        relay_link_die(oldest);
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

static void take_over(struct relay *relay, const struct handed *handed)
{
    struct problem problem;
    struct relay_link *link = mem_new(sizeof *link);
    int on = 1;
    *link = (struct relay_link){ .next = relay->links,
                                 .relay = relay,
                                 .client = handed->socket,
                                 .inner = -1,
                                 .server = -1,
                                 .peer = handed->peer,
                                 .client_readable = true };
    link->head_us = link->moved_us = clock_now_us();
    body_begin(&link->body, false, 0);
    if (relay->links)
        relay->links->previous = link;
    relay->links = link;
    (void)setsockopt(handed->socket, IPPROTO_TCP, TCP_NODELAY, &on,
                     sizeof on); /* answers come in as few pieces as we can */
    struct epoll_event event = { .events = EPOLLIN | EPOLLOUT | EPOLLRDHUP | EPOLLET,
                                 .data.u64 = (uint64_t)(uintptr_t)link };
    if (epoll_ctl(relay->epoll, EPOLL_CTL_ADD, handed->socket, &event) != 0) {
        relay_link_die(link);
    } else if (!relay_count(link, &handed->client, &problem)) {
        (void)refusal_drain(link->client, HEAD_MAX_BYTES);
        relay_log_refusal(relay);
        relay_link_refuse(link, &problem, RELAY_MAX_DROPPED);
    } else {
        relay_link_advance(link);
    }
}

static void take_queued(struct relay *relay)
{
    for (struct handed *handed; (handed = queue_try_take(relay->queue)); free(handed))
        take_over(relay, handed);
}

/* Once for each event of epoll: the link of an event may have died by an event before it, and is freed after all of
 * them. */
static void handle_event(struct relay *relay, const struct epoll_event *event)
{
    if (event->data.u64 == (uint64_t)(uintptr_t)&wake_tag) {
        uint64_t n;
        if (read(relay->wake, &n, sizeof n) == sizeof n)
            take_queued(relay);
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
            relay_link_die(link); /* both ways are closed: nobody takes an answer */
            return;
        }
        link->client_readable = link->client_readable || (event->events & (EPOLLIN | EPOLLRDHUP));
    }
    relay_link_advance(link);
}

static void handle_touched(struct relay *relay)
{
    struct relay_link *link = relay->touched, *next;
    relay->touched = NULL; /* what is touched from here on waits for the next round */
    for (; link; link = next) {
        next = link->next_touched;
        link->is_touched = false;
        relay_link_advance(link);
    }
}

/* True once in each window that is over with too few bytes; the next one has begun then. */
static bool is_window_missed(struct relay_link *link, int64_t now_us)
{
    if (now_us - link->window_us < RELAY_WINDOW_MS * INT64_C(1000))
        return false;
    bool is_missed = link->window_bytes < RELAY_WINDOW_BYTES;
    relay_link_begin_window(link);
    return is_missed;
}

static void look_at_answer(struct relay_link *link, int64_t now_us)
{
    int64_t still_us = now_us - link->moved_us;
    struct problem problem;
    if (link->n_out == 0) { /* the client has taken all there is: it waits for the library */
        relay_link_begin_window(link);
        if (still_us > RELAY_ANSWER_MS * INT64_C(1000)) {
            problem_set(&problem, PROBLEM_TIMEOUT, "", "", "no answer within %d s", RELAY_ANSWER_MS / 1000);
            relay_link_refuse(link, &problem, RELAY_MAX_DROPPED);
        }
    } else if (still_us > RELAY_IDLE_MS * INT64_C(1000) || is_window_missed(link, now_us)) {
        relay_link_die(link);
    } else {
        relay_touch(
            link); /* epoll tells of room only once much has been taken; a slow client's progress is looked for here */
    }
}

static void look_at_times(struct relay *relay, int64_t now_us)
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
        case LINK_ANSWER: look_at_answer(link, now_us); break;
        case LINK_LINGER: is_late = still_ms > RELAY_LINGER_SILENT_MS; break;
        case LINK_DEAD:
            if (!link->is_started) { /* the library had no memory for it and closed its end without a word */
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

/* Frees the links that are over on both sides. */
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
            look_at_times(relay, now_us);
        }
        free_dead(relay);
    }
    (void)relay->server.run(relay->server.context); /* answers that came while it was stopped */
    for (struct relay_link *link = relay->links; link; link = link->next)
        if (link->state == LINK_ANSWER) {
            link->inner_readable = true;
            relay_link_pump(link);
        }
    return NULL;
}

static void drop_handed(void *item)
{
    struct handed *handed = item;
    (void)close(handed->socket);
    free(handed);
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
    relay->queue = queue_create(RELAY_MAX_QUEUED, drop_handed);
    relay->epoll = epoll_create1(EPOLL_CLOEXEC);
    relay->wake = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (relay->epoll < 0 || !watch(relay, relay->wake, &wake_tag)) {
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
    if (write(relay->wake, &one, sizeof one) != sizeof one)
        log_debug("http: the thread is woken already"); /* the counter is full: it will see all there is */
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
    relay_close_fd(&relay->wake);
    queue_destroy(relay->queue);
    for (struct relay_link *link = relay->links, *next; link; link = next) {
        next = link->next;
        free(link);
    }
    free(relay);
}

void relay_add(struct relay *relay, int socket, const struct address *peer, const struct address *client)
{
    struct handed *handed = mem_new(sizeof *handed);
    *handed = (struct handed){ socket, *peer, *client };
    if (queue_try_put(relay->queue, handed)) {
        relay_wake(relay);
        return;
    }
    struct problem problem;
    problem_set(&problem, PROBLEM_LIMIT, "", "", "%d connections wait to be taken over already; at most so many do",
                RELAY_MAX_QUEUED);
    problem.retry_after_ms = RELAY_RETRY_MS;
    (void)refusal_drain(socket, HEAD_MAX_BYTES);
    refusal_send(socket, &problem);
    drop_handed(handed);
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
