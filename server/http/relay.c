#define _GNU_SOURCE
#include "server/http/relay.h"

#include <errno.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "core/base/queue.h"
#include "server/http/body.h"
#include "server/http/head.h"
#include "server/wire/refusal.h"

enum {
    IN_SIZE = 64 << 10, /* of a client's bytes at once: at least a head */
    OUT_SIZE = 256 << 10, /* of an answer at once */
    DROP_SIZE = 1 << 20, /* of a refused body at once */
    TICK_MS = 500,
    N_CONTINUE = 25, /* bytes of "HTTP/1.1 100 Continue" with its empty line, the one answer that may come before the answer */
};

enum link_state {
    LINK_HEAD,   /* a head is read; the library has nothing of it */
    LINK_BODY,   /* head and body are passed on */
    LINK_ANSWER, /* the request is there as a whole; nothing is read from the client */
    LINK_LINGER, /* the last answer is out; what still comes is dropped */
    LINK_DEAD    /* to be freed */
};

struct relay_link {
    struct relay_link *next, *previous;
    struct relay_link *next_touched;
    struct relay *relay;
    enum link_state state;
    int client, inner, server; /* sockets: the client's, and the pair's ends, ours and the library's; -1: closed */
    struct address peer, counted;
    bool is_counted, is_touched;
    bool is_started;          /* the library knows the connection: it will tell its end */
    bool inner_wants_room;    /* epoll tells when the library has taken bytes */
    bool client_readable, client_ended, inner_readable, inner_hung_up, inner_ended;
    bool is_request_ended, is_refused;
    struct problem problem; /* is_refused */
    uint64_t max_dropped, n_dropped;
    char *in; /* NULL: nothing is there */
    size_t n_in, n_forward; /* bytes there; of them those that the library is to have */
    struct body body;
    char *out; /* of an answer, what the client does not take yet; NULL: nothing */
    size_t n_out, out_at;
    uint64_t n_answered;             /* bytes of the answer to this request */
    int64_t head_us, moved_us;       /* the head's first byte; the last byte either way */
};

struct handed { /* a connection on its way from the acceptor */
    int socket;
    struct address peer, client;
};

struct relay {
    struct relay_options options;
    struct relay_server server;
    struct queue *queue;
    int epoll, wake;
    pthread_t thread;
    bool has_thread;
    atomic_bool is_stopping, is_to_hang;
    _Atomic(atomic_bool *) pinged;
    struct relay_link *links, *touched;
    size_t n_counted, n_lingering;
    bool has_dead; /* links may be freed */
    size_t n_refused; /* connections, since the log said so last */
    int64_t logged_us;
    char bytes[OUT_SIZE];
};

static char wake_tag, server_tag; /* their addresses mark events that are no link's */

/* ---- counting ------------------------------------------------------------------------------------------------------------ */

static size_t count_address(const struct relay *relay, const struct address *counted)
{
    size_t n = 0;
    for (const struct relay_link *link = relay->links; link; link = link->next)
        n += link->is_counted && address_is_equal(&link->counted, counted);
    return n;
}

static void uncount(struct relay_link *link)
{
    link->relay->n_counted -= link->is_counted;
    link->is_counted = false;
}

/* Counts the connection for a client from now on, and no longer for another. */
static bool count_for(struct relay_link *link, const struct address *client, struct problem *problem)
{
    struct relay *relay = link->relay;
    struct address counted = address_counted(client);
    if (link->is_counted && address_is_equal(&link->counted, &counted))
        return true;
    size_t n_before = count_address(relay, &counted), n_all = relay->n_counted - link->is_counted;
    if (n_all >= RELAY_MAX_CONNECTIONS || n_before >= RELAY_MAX_PER_ADDRESS) {
        problem_set(problem, PROBLEM_LIMIT, "", "", "too many connections: at most %d in all, %d from one address", RELAY_MAX_CONNECTIONS,
                    RELAY_MAX_PER_ADDRESS);
        problem->retry_after_ms = RELAY_RETRY_MS;
        return false;
    }
    relay->n_counted += !link->is_counted;
    link->is_counted = true;
    link->counted = counted;
    return true;
}

/* A flood of connections must not become one of lines. */
static void log_refusal(struct relay *relay)
{
    int64_t now_us = clock_now_us();
    relay->n_refused++;
    if (relay->logged_us && now_us - relay->logged_us < 10000000)
        return;
    log_warn("http: too many connections: %zu refused", relay->n_refused);
    relay->logged_us = now_us;
    relay->n_refused = 0;
}

/* ---- ends ---------------------------------------------------------------------------------------------------------------- */

static void close_end(int *end)
{
    if (*end >= 0)
        (void)close(*end);
    *end = -1;
}

static void touch(struct relay_link *link)
{
    if (link->is_touched)
        return;
    link->is_touched = true;
    link->next_touched = link->relay->touched;
    link->relay->touched = link;
}

static void drop_bytes(struct relay_link *link)
{
    free(link->in);
    free(link->out);
    link->in = link->out = NULL;
    link->n_in = link->n_forward = link->n_out = link->out_at = 0;
}

/* The client's side is over. What the library still has of it meets a closed end. */
static void die(struct relay_link *link)
{
    if (link->state == LINK_LINGER)
        link->relay->n_lingering--;
    link->state = LINK_DEAD;
    link->moved_us = clock_now_us();
    link->relay->has_dead = true;
    uncount(link);
    drop_bytes(link);
    close_end(&link->client);
    close_end(&link->inner);
}

static void end_oldest_lingering(struct relay *relay)
{
    struct relay_link *oldest = NULL;
    for (struct relay_link *link = relay->links; link; link = link->next)
        if (link->state == LINK_LINGER)
            oldest = link; /* new links stand in front */
    if (oldest)
        die(oldest);
}

/* The answer is out: a socket that is closed with bytes unread takes the answer back, so what still comes is read for a while. */
static void linger(struct relay_link *link, uint64_t max_dropped)
{
    uncount(link);
    drop_bytes(link);
    close_end(&link->inner);
    if (shutdown(link->client, SHUT_WR) != 0 || link->client_ended) {
        die(link);
        return;
    }
    if (link->relay->n_lingering >= RELAY_MAX_LINGERING)
        end_oldest_lingering(link->relay);
    link->relay->n_lingering++;
    link->state = LINK_LINGER;
    link->max_dropped = max_dropped;
    link->n_dropped = 0;
    link->moved_us = clock_now_us();
    touch(link);
}

static void refuse(struct relay_link *link, const struct problem *problem, uint64_t max_dropped)
{
    bool has_answer = link->n_out > 0 || (link->n_answered > 0 && link->n_answered != N_CONTINUE);
    if (!has_answer)
        refusal_send(link->client, problem);
    linger(link, max_dropped);
}

/* ---- the answer ---------------------------------------------------------------------------------------------------------- */

static bool is_for_later(void) { return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR; }

/* Passes on what the library has written, as far as the client takes it. */
static void pump_answer(struct relay_link *link)
{
    struct relay *relay = link->relay;
    for (;;) {
        if (link->n_out > 0) {
            ssize_t n = send(link->client, link->out + link->out_at, link->n_out, MSG_NOSIGNAL | MSG_DONTWAIT);
            if (n < 0 && is_for_later())
                return;
            if (n < 0) {
                die(link);
                return;
            }
            link->moved_us = clock_now_us();
            link->out_at += (size_t)n;
            link->n_out -= (size_t)n;
            if (link->n_out > 0)
                return;
            free(link->out);
            link->out = NULL;
            link->out_at = 0;
        }
        if (!link->inner_readable || link->inner < 0)
            return;
        ssize_t n = recv(link->inner, relay->bytes, sizeof relay->bytes, MSG_DONTWAIT);
        if (n < 0 && is_for_later()) {
            link->inner_readable = false;
            return;
        }
        if (n <= 0) {
            link->inner_ended = true;
            link->inner_readable = false;
            return;
        }
        link->inner_readable = (size_t)n == sizeof relay->bytes || link->inner_hung_up;
        link->n_answered += (uint64_t)n;
        link->moved_us = clock_now_us();
        ssize_t n_sent = send(link->client, relay->bytes, (size_t)n, MSG_NOSIGNAL | MSG_DONTWAIT);
        if (n_sent < 0 && !is_for_later()) {
            die(link);
            return;
        }
        n_sent = n_sent < 0 ? 0 : n_sent;
        if (n_sent < n) {
            link->n_out = (size_t)(n - n_sent);
            link->out = malloc(link->n_out);
            if (!link->out) {
                die(link);
                return;
            }
            memcpy(link->out, relay->bytes + n_sent, link->n_out);
        }
    }
}

/* ---- the request --------------------------------------------------------------------------------------------------------- */

/* More of the client's bytes. False: there are none now. */
static bool read_client(struct relay_link *link)
{
    if (!link->client_readable || link->n_in == IN_SIZE)
        return false;
    if (!link->in && !(link->in = malloc(IN_SIZE))) {
        die(link);
        return false;
    }
    size_t n_free = IN_SIZE - link->n_in;
    ssize_t n = recv(link->client, link->in + link->n_in, n_free, MSG_DONTWAIT);
    if (n <= 0) {
        link->client_readable = false;
        if (link->n_in == 0) {
            free(link->in);
            link->in = NULL;
        }
        if (n < 0 && is_for_later())
            return false;
        if (n < 0)
            die(link);
        else
            link->client_ended = true;
        return n == 0;
    }
    link->moved_us = clock_now_us();
    if (link->n_in == 0)
        link->head_us = link->moved_us;
    link->n_in += (size_t)n;
    return true;
}

static bool watch_inner(struct relay_link *link, int how)
{
    struct epoll_event event = { .events = EPOLLIN | EPOLLRDHUP | EPOLLET | (link->inner_wants_room ? (uint32_t)EPOLLOUT : 0),
                                 .data.u64 = (uint64_t)(uintptr_t)link | 1 };
    return epoll_ctl(link->relay->epoll, how, link->inner, &event) == 0;
}

/* Opens the way to the library, for the first request. */
static bool open_server(struct relay_link *link)
{
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends) != 0)
        return false;
    link->inner = ends[0];
    if (!watch_inner(link, EPOLL_CTL_ADD)) {
        close_end(&link->inner);
        (void)close(ends[1]);
        return false;
    }
    link->server = ends[1];
    if (link->relay->server.add(link->relay->server.context, ends[1]))
        return true;
    link->server = -1;
    close_end(&link->inner);
    return false;
}

/* True when the state has changed. */
static bool step_head(struct relay_link *link)
{
    struct relay *relay = link->relay;
    struct head_request request;
    struct problem problem;
    enum head_kind kind = HEAD_INCOMPLETE;
    do {
        if (link->n_in > 0)
            kind = head_read(link->in, link->n_in < HEAD_MAX_BYTES ? link->n_in : HEAD_MAX_BYTES, relay->options.hosts, &request, &problem);
    } while (kind == HEAD_INCOMPLETE && !link->client_ended && read_client(link));
    if (link->state == LINK_DEAD)
        return true;
    if (kind == HEAD_INCOMPLETE && !link->client_ended)
        return false;
    if (kind == HEAD_INCOMPLETE && link->n_in == 0) {
        die(link); /* ended between two requests */
        return true;
    }
    link->n_answered = 0;
    link->is_request_ended = false;
    if (kind == HEAD_INCOMPLETE)
        head_refuse_incomplete(link->in, link->n_in, true, 0, &problem);
    if (kind == HEAD_INCOMPLETE || kind == HEAD_REFUSED) {
        refuse(link, &problem, RELAY_MAX_DROPPED);
        return true;
    }
    struct address client = address_of_client(&link->peer, relay->options.trusted, relay->options.n_trusted, request.forwarded, request.n_forwarded);
    if (!count_for(link, &client, &problem)) {
        log_refusal(relay);
        refuse(link, &problem, RELAY_MAX_DROPPED);
        return true;
    }
    if (link->inner < 0 && !open_server(link)) {
        problem_set(&problem, PROBLEM_BUSY, "", "", "the server has no descriptors left for this connection");
        problem.retry_after_ms = RELAY_RETRY_MS;
        refuse(link, &problem, RELAY_MAX_DROPPED);
        return true;
    }
    link->n_forward = request.n_bytes;
    body_begin(&link->body, request.is_chunked, request.length);
    link->state = LINK_BODY;
    return true;
}

/* True when the state has changed. */
static bool step_body(struct relay_link *link)
{
    struct problem problem;
    for (;;) {
        size_t n_taken = 0;
        if (!body_take(&link->body, link->in ? link->in + link->n_forward : "", link->n_in - link->n_forward, &n_taken, &problem)) {
            refuse(link, &problem, RELAY_MAX_DROPPED);
            return true;
        }
        link->n_forward += n_taken;
        if (link->n_forward > 0) {
            ssize_t n = send(link->inner, link->in, link->n_forward, MSG_NOSIGNAL | MSG_DONTWAIT);
            if (n < 0 && is_for_later()) {
                if (!link->inner_wants_room) {
                    link->inner_wants_room = true;
                    (void)watch_inner(link, EPOLL_CTL_MOD); /* tells at once when there is room by now */
                }
                return false;
            }
            if (n < 0) { /* the library has answered before the end, and wants no more */
                link->state = LINK_ANSWER;
                return true;
            }
            link->moved_us = clock_now_us();
            link->n_forward -= (size_t)n;
            link->n_in -= (size_t)n;
            if (link->n_in > 0)
                memmove(link->in, link->in + n, link->n_in);
        }
        if (link->n_forward == 0 && body_is_ended(&link->body)) {
            if (link->n_in == 0) {
                free(link->in);
                link->in = NULL;
            }
            link->state = LINK_ANSWER;
            return true;
        }
        if (link->n_forward > 0)
            continue;
        if (link->client_ended) { /* in the middle of a body: nobody is there for the answer */
            die(link);
            return true;
        }
        if (!read_client(link))
            return link->state == LINK_DEAD;
    }
}

/* The library has closed its end: this answer was the last. */
static void finish(struct relay_link *link)
{
    char byte;
    bool has_more = link->n_in > 0 || !body_is_ended(&link->body) || recv(link->client, &byte, 1, MSG_PEEK | MSG_DONTWAIT) > 0;
    if (has_more)
        linger(link, RELAY_MAX_DROPPED);
    else
        die(link);
}

/* True when the state has changed. */
static bool step_answer(struct relay_link *link)
{
    if (link->n_out > 0 || link->inner_readable)
        return false;
    if (link->inner_ended) {
        finish(link);
        return true;
    }
    if (!link->is_request_ended || !body_is_ended(&link->body))
        return false;
    link->is_request_ended = false;
    link->state = LINK_HEAD;
    link->head_us = link->moved_us = clock_now_us();
    return true;
}

static void step_linger(struct relay_link *link)
{
    size_t n_now = 0;
    while (link->client_readable) {
        ssize_t n = recv(link->client, link->relay->bytes, sizeof link->relay->bytes, MSG_DONTWAIT);
        if (n < 0 && is_for_later()) {
            link->client_readable = false;
            return;
        }
        if (n > 0) {
            link->moved_us = clock_now_us();
            link->n_dropped += (uint64_t)n;
            n_now += (size_t)n;
        }
        if (n <= 0 || link->n_dropped > link->max_dropped) {
            die(link);
            return;
        }
        if (n_now >= DROP_SIZE) { /* others wait */
            touch(link);
            return;
        }
    }
}

/* Does all that can be done now. */
static void advance(struct relay_link *link)
{
    bool has_changed = true;
    while (has_changed && link->state != LINK_DEAD) {
        has_changed = false;
        if (link->is_refused && link->state != LINK_LINGER) {
            refuse(link, &link->problem, link->max_dropped);
            continue;
        }
        if (link->state != LINK_LINGER)
            pump_answer(link);
        switch (link->state) {
        case LINK_HEAD:
            if (link->inner_ended) /* the library gave the connection up between two requests */
                finish(link);
            else
                has_changed = step_head(link);
            break;
        case LINK_BODY:
            if (link->inner_ended && link->n_out == 0)
                finish(link);
            else
                has_changed = step_body(link);
            break;
        case LINK_ANSWER: has_changed = step_answer(link); break;
        case LINK_LINGER: step_linger(link); break;
        case LINK_DEAD: break;
        }
    }
}

/* ---- the library's side -------------------------------------------------------------------------------------------------- */

struct relay_link *relay_find(struct relay *relay, int socket)
{
    struct relay_link *link = relay->links;
    while (link && (link->server != socket || link->is_started))
        link = link->next;
    if (link)
        link->is_started = true;
    return link;
}

void relay_link_closed(struct relay_link *link)
{
    link->server = -1;
    link->relay->has_dead = true;
}

void relay_request_ended(struct relay_link *link)
{
    link->is_request_ended = true;
    link->inner_readable = true;
    touch(link);
}

void relay_refuse(struct relay_link *link, const struct problem *problem, uint64_t max_dropped)
{
    if (link->state == LINK_DEAD || link->state == LINK_LINGER)
        return;
    link->is_refused = true;
    link->problem = *problem;
    link->max_dropped = max_dropped;
    uncount(link);
    touch(link);
}

/* ---- the thread ---------------------------------------------------------------------------------------------------------- */

static void take_over(struct relay *relay, const struct handed *handed)
{
    struct problem problem;
    struct relay_link *link = mem_new(sizeof *link);
    int on = 1;
    *link = (struct relay_link){ .next = relay->links, .relay = relay, .client = handed->socket, .inner = -1, .server = -1, .peer = handed->peer,
                                 .client_readable = true };
    link->head_us = link->moved_us = clock_now_us();
    body_begin(&link->body, false, 0);
    if (relay->links)
        relay->links->previous = link;
    relay->links = link;
    (void)setsockopt(handed->socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on); /* answers come in as few pieces as we can */
    struct epoll_event event = { .events = EPOLLIN | EPOLLOUT | EPOLLRDHUP | EPOLLET, .data.u64 = (uint64_t)(uintptr_t)link };
    if (epoll_ctl(relay->epoll, EPOLL_CTL_ADD, handed->socket, &event) != 0) {
        die(link);
    } else if (!count_for(link, &handed->client, &problem)) {
        (void)refusal_drain(link->client, HEAD_MAX_BYTES);
        log_refusal(relay);
        refuse(link, &problem, RELAY_MAX_DROPPED);
    } else {
        advance(link);
    }
}

static void take_queued(struct relay *relay)
{
    for (struct handed *handed; (handed = queue_try_take(relay->queue)); free(handed))
        take_over(relay, handed);
}

/* Once for each event of epoll: the link of an event may have died by an event before it, and is freed after all of them. */
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
            die(link); /* both ways are closed: nobody takes an answer */
            return;
        }
        link->client_readable = link->client_readable || (event->events & (EPOLLIN | EPOLLRDHUP));
    }
    advance(link);
}

static void handle_touched(struct relay *relay)
{
    struct relay_link *link = relay->touched, *next;
    relay->touched = NULL; /* what is touched from here on waits for the next round */
    for (; link; link = next) {
        next = link->next_touched;
        link->is_touched = false;
        advance(link);
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
                refuse(link, &problem, RELAY_MAX_DROPPED);
            } else {
                is_late = still_ms > RELAY_IDLE_MS;
            }
            break;
        case LINK_BODY: is_late = still_ms > RELAY_IDLE_MS; break;
        case LINK_ANSWER: is_late = link->n_out > 0 && still_ms > RELAY_IDLE_MS; break;
        case LINK_LINGER: is_late = still_ms > RELAY_LINGER_SILENT_MS; break;
        case LINK_DEAD:
            if (!link->is_started) { /* the library had no memory for it and closed its end without a word */
                link->server = -1;
                relay->has_dead = true;
            }
            break;
        }
        if (is_late)
            die(link);
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
            pump_answer(link);
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
            die(link);
}

void relay_destroy(struct relay *relay)
{
    if (!relay)
        return;
    relay_stop(relay);
    close_end(&relay->epoll);
    close_end(&relay->wake);
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
    problem_set(&problem, PROBLEM_LIMIT, "", "", "%d connections wait to be taken over already; at most so many do", RELAY_MAX_QUEUED);
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
