#define _GNU_SOURCE
/* Advances one link: receives and checks a request, hands a WebSocket on, passes another request to the library and the
 * answer back, and ends the link. A refused client may still be sending: its bytes are read for a while after the
 * answer, because closing a socket with unread bytes takes the answer back. */
#include "server/front/front_link.h"

#include <errno.h>
#include <linux/sockios.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include "core/base/clock.h"
#include "core/base/gate.h"
#include "server/front/front_count.h"
#include "server/front/front_identify.h"
#include "server/front/head.h"
#include "server/wire/refusal.h"

enum {
    IN_SIZE = 64 << 10,  /* bytes from a client held at once: at least a whole head */
    DROP_SIZE = 1 << 20, /* bytes of a refused request dropped before other links have their turn */
    N_CONTINUE = 25,     /* bytes of "HTTP/1.1 100 Continue" and its empty line, which may precede the answer */
};

/* ---- ends ------------------------------------------------------------------------------------------------------- */

static void drop_bytes(struct front_link *link)
{
    free(link->in);
    free(link->out);
    link->in = link->out = NULL;
    link->n_in = link->n_forward = link->n_out = link->out_at = 0;
}

/* Closes the client's side. A request still in the library meets a closed socket. */
void front_link_die(struct front_link *link)
{
    front_set_state(link, LINK_DEAD);
    link->moved_us = clock_now_us();
    link->front->has_dead = true;
    front_uncount_ended(link);
    drop_bytes(link);
    front_unwatch_and_close(link->front, &link->client);
    front_unwatch_and_close(link->front, &link->inner);
}

static void end_oldest_lingering(struct front *front)
{
    struct front_link *oldest = NULL;
    for (struct front_link *link = front->links; link; link = link->next)
        if (link->state == LINK_LINGER && !link->is_first)
            oldest = link; /* new links are put in front */
    if (oldest)
        front_link_die(oldest);
}

/* The answer was sent: closes our direction and drops what the client still sends. */
static void linger(struct front_link *link, uint64_t max_dropped)
{
    struct front *front = link->front;
    bool goes_on = refusal_drain(link->client, HEAD_MAX_BYTES); /* the link may be ended before its turn comes */
    front_uncount_ended(link);
    drop_bytes(link);
    front_unwatch_and_close(front, &link->inner);
    if (shutdown(link->client, SHUT_WR) != 0 || link->client_ended || !goes_on ||
        (link->is_first && front->n_lingering_first >= FRONT_MAX_LINGERING_FIRST)) {
        front_link_die(link);
        return;
    }
    if (!link->is_first && front->n_lingering >= FRONT_MAX_LINGERING)
        end_oldest_lingering(front);
    front_set_state(link, LINK_LINGER);
    link->max_dropped = link->is_first ? FRONT_MAX_DROPPED_FIRST : max_dropped;
    link->n_dropped = 0;
    link->moved_us = clock_now_us();
    link->linger_us = link->is_first ? link->moved_us + FRONT_LINGER_FIRST_MS * INT64_C(1000) : INT64_MAX;
    link->client_readable = true;
    front_touch(link);
}

void front_link_refuse(struct front_link *link, const struct problem *problem, uint64_t max_dropped)
{
    bool has_answer = link->n_out > 0 || (link->n_answered > 0 && link->n_answered != N_CONTINUE);
    if (!has_answer)
        refusal_send(link->client, problem);
    linger(link, max_dropped);
}

void front_link_begin_window(struct front_link *link)
{
    link->window_us = clock_now_us();
    link->window_bytes = 0;
}

/* ---- the answer ------------------------------------------------------------------------------------------------- */

static bool would_block(void)
{
    return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
}

void front_link_pass_answer(struct front_link *link)
{
    struct front *front = link->front;
    for (;;) {
        if (link->n_out > 0) {
            ssize_t n = send(link->client, link->out + link->out_at, link->n_out, MSG_NOSIGNAL | MSG_DONTWAIT);
            if (n < 0 && would_block())
                return;
            if (n < 0) {
                front_link_die(link);
                return;
            }
            link->moved_us = clock_now_us();
            link->window_bytes += (uint64_t)n;
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
        ssize_t n = recv(link->inner, front->bytes, sizeof front->bytes, MSG_DONTWAIT);
        if (n < 0 && would_block()) {
            link->inner_readable = false;
            return;
        }
        if (n <= 0) {
            link->inner_ended = true;
            link->inner_readable = false;
            return;
        }
        link->inner_readable = (size_t)n == sizeof front->bytes || link->inner_hung_up;
        link->n_answered += (uint64_t)n;
        link->moved_us = clock_now_us();
        ssize_t n_sent = send(link->client, front->bytes, (size_t)n, MSG_NOSIGNAL | MSG_DONTWAIT);
        if (n_sent < 0 && !would_block()) {
            front_link_die(link);
            return;
        }
        n_sent = n_sent < 0 ? 0 : n_sent;
        link->window_bytes += (uint64_t)n_sent;
        if (n_sent < n) {
            link->n_out = (size_t)(n - n_sent);
            link->out = malloc(link->n_out);
            if (!link->out) {
                front_link_die(link);
                return;
            }
            memcpy(link->out, front->bytes + n_sent, link->n_out);
        }
    }
}

/* ---- the request ------------------------------------------------------------------------------------------------ */

/* Receives more of the client's bytes. Returns false when there are none now. */
static bool read_client(struct front_link *link)
{
    if (!link->client_readable || link->n_in == IN_SIZE)
        return false;
    if (!link->in && !(link->in = malloc(IN_SIZE))) {
        front_link_die(link);
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
        if (n < 0 && would_block())
            return false;
        if (n < 0)
            front_link_die(link);
        else
            link->client_ended = true;
        return n == 0;
    }
    link->client_readable = (size_t)n == n_free || link->client_hung_up; /* else epoll reports what comes next */
    link->moved_us = clock_now_us();
    link->n_in += (size_t)n;
    return true;
}

static bool watch_inner(struct front_link *link, int how)
{
    struct epoll_event event = { .events =
                                     EPOLLIN | EPOLLRDHUP | EPOLLET | (link->inner_wants_room ? (uint32_t)EPOLLOUT : 0),
                                 .data.u64 = (uint64_t)(uintptr_t)link | 1 };
    return epoll_ctl(link->front->epoll, how, link->inner, &event) == 0;
}

/* Makes the pair of sockets to the library, before the first request. */
static bool open_server(struct front_link *link)
{
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends) != 0)
        return false;
    link->inner = ends[0];
    if (!watch_inner(link, EPOLL_CTL_ADD)) {
        front_close_fd(&link->inner);
        (void)close(ends[1]);
        return false;
    }
    link->server = ends[1];
    if (link->front->library.add(link->front->library.context, ends[1]))
        return true;
    link->server = -1;
    front_unwatch_and_close(link->front, &link->inner);
    return false;
}

/* n: bytes of the head that have come so far. */
static void note_head(struct front_link *link, size_t n)
{
    if (n <= link->n_head)
        return;
    link->moved_us = clock_now_us();
    if (link->n_head == 0 && !link->is_first)
        link->head_us = link->moved_us;
    link->n_head = n;
}

bool front_link_is_encrypted(const struct front_link *link)
{
    return link->front->options.decrypt && !link->is_local;
}

static struct head_rules rules_of(const struct front_link *link)
{
    const struct front_options *options = &link->front->options;
    return (struct head_rules){ .hosts = options->hosts,
                                .identity_names =
                                    options->identity_names ? options->identity_names : head_identity_names,
                                .takes_identity = options->takes_identity && link->is_from_proxy };
}

static struct address client_of(const struct front_link *link, const struct head_text *forwarded)
{
    const struct front_options *options = &link->front->options;
    return link->is_from_proxy
               ? address_behind_socket(options->trusted, options->n_trusted, forwarded->at, forwarded->n)
               : address_of_client(&link->peer, options->trusted, options->n_trusted, forwarded->at, forwarded->n);
}

/* Looks at a head in the socket, where its bytes stay: a WebSocket is handed on with all of them. */
static enum head_kind peek_head(struct front_link *link, struct head_request *request, struct problem *problem)
{
    struct front *front = link->front;
    if (!link->client_readable)
        return HEAD_INCOMPLETE;
    ssize_t n = recv(link->client, front->bytes, HEAD_MAX_BYTES, MSG_PEEK | MSG_DONTWAIT);
    if (n <= 0) {
        link->client_readable = false;
        link->client_ended = n == 0;
        if (n < 0 && !would_block())
            front_link_die(link);
        return HEAD_INCOMPLETE;
    }
    note_head(link, (size_t)n);
    const struct head_rules rules = rules_of(link);
    enum head_kind kind = head_read(front->bytes, (size_t)n, &rules, request, problem);
    if (kind == HEAD_INCOMPLETE) { /* epoll reports bytes that come after those */
        link->client_readable = false;
        link->client_ended = link->client_hung_up;
    }
    return kind;
}

/* Reads a head that was sent before the answer to the request in front of it: its first bytes came with that one. */
static enum head_kind read_head(struct front_link *link, struct head_request *request, struct problem *problem)
{
    enum head_kind kind;
    const struct head_rules rules = rules_of(link);
    do {
        note_head(link, link->n_in);
        kind = head_read(link->in, link->n_in < HEAD_MAX_BYTES ? link->n_in : HEAD_MAX_BYTES, &rules, request, problem);
    } while (kind == HEAD_INCOMPLETE && !link->client_ended && read_client(link));
    /* The WebSocket's side would miss the bytes that were read: the library refuses it. */
    return kind == HEAD_WEBSOCKET ? HEAD_HTTP : kind;
}

/* Hands a WebSocket to its side, or refuses it. */
static void hand_on(struct front_link *link, struct handshake *handshake, const struct address *client)
{
    struct front *front = link->front;
    struct problem problem;
    struct websocket_place *place = NULL;
    if (gate_enter(front->adopting)) {
        place = websocket_count_add(&front->websockets, client, &problem);
        if (place) {
            (void)epoll_ctl(front->epoll, EPOLL_CTL_DEL, link->client, NULL); /* fails where the head came at once */
            address_write(client, handshake->client);
            handshake->identity = link->identity;
            handshake->is_secure = front_link_is_encrypted(link);
            front->options.adopt(front->options.context, link->client, handshake, websocket_count_ended, place);
            link->client = -1;
        }
        gate_leave(front->adopting);
    } else {
        problem_set(&problem, PROBLEM_BUSY, "", "", "the server is being stopped");
        problem.retry_after_ms = FRONT_RETRY_MS;
    }
    if (place)
        front_link_die(link);
    else
        front_link_refuse(link, &problem, FRONT_MAX_DROPPED);
}

/* Begins to pass a request to the library. False with problem: it cannot be served. */
static bool begin_request(struct front_link *link, const struct head_request *request, const struct address *client,
                          struct problem *problem)
{
    if (!front_count(link, client, problem)) {
        front_log_refusal(link->front);
        return false;
    }
    if (link->inner < 0 && !open_server(link)) {
        problem_set(problem, PROBLEM_BUSY, "", "", "the server has no descriptors left for this connection");
        problem->retry_after_ms = FRONT_RETRY_MS;
        return false;
    }
    link->asked_by = *client;
    link->n_forward = request->n_bytes;
    body_begin(&link->body, request->is_chunked, request->length);
    front_set_state(link, LINK_BODY);
    front_link_begin_window(link);
    if (link->n_in == 0) /* only peeked at */
        (void)read_client(link);
    if (link->n_in < link->n_forward)
        front_link_die(link);
    return true;
}

/* Receives and checks a head. Returns true when the state has changed. */
static bool step_head(struct front_link *link)
{
    struct front *front = link->front;
    struct head_request request;
    struct problem problem;
    const bool is_behind = link->n_in > 0;
    enum head_kind kind = is_behind ? read_head(link, &request, &problem) : peek_head(link, &request, &problem);
    if (link->state == LINK_DEAD)
        return true;
    if (kind == HEAD_INCOMPLETE && !link->client_ended)
        return false;
    if (kind == HEAD_INCOMPLETE && link->n_head == 0) {
        front_link_die(link); /* closed before a request */
        return true;
    }
    link->n_answered = 0;
    link->is_request_ended = false;
    if (kind == HEAD_INCOMPLETE)
        head_refuse_incomplete(is_behind ? link->in : front->bytes, link->n_head, true, 0, &problem);
    if (kind == HEAD_INCOMPLETE || kind == HEAD_REFUSED) {
        front_link_refuse(link, &problem, FRONT_MAX_DROPPED);
        return true;
    }
    front_end_waiting(link);
    struct address client = client_of(link, &request.forwarded);
    if (!front_identify(link, &request, &client, &problem))
        front_link_refuse(link, &problem, FRONT_MAX_DROPPED);
    else if (kind == HEAD_WEBSOCKET)
        hand_on(link, &request.handshake, &client);
    else if (!begin_request(link, &request, &client, &problem))
        front_link_refuse(link, &problem, FRONT_MAX_DROPPED);
    return true;
}

/* Passes head and body on. Returns true when the state has changed. */
static bool step_body(struct front_link *link)
{
    struct problem problem;
    for (;;) {
        size_t n_taken = 0;
        if (!body_take(&link->body, link->in ? link->in + link->n_forward : "", link->n_in - link->n_forward, &n_taken,
                       &problem)) {
            front_link_refuse(link, &problem, FRONT_MAX_DROPPED);
            return true;
        }
        link->n_forward += n_taken;
        if (link->n_forward > 0) {
            ssize_t n = send(link->inner, link->in, link->n_forward, MSG_NOSIGNAL | MSG_DONTWAIT);
            if (n < 0 && would_block()) {
                if (!link->inner_wants_room) {
                    link->inner_wants_room = true;
                    (void)watch_inner(link, EPOLL_CTL_MOD); /* reports at once when there is room already */
                }
                return false;
            }
            if (n < 0) { /* the library answered early and reads no more */
                front_set_state(link, LINK_ANSWER);
                front_link_begin_window(link);
                return true;
            }
            link->moved_us = clock_now_us();
            link->window_bytes += (uint64_t)n;
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
            front_set_state(link, LINK_ANSWER);
            front_link_begin_window(link);
            return true;
        }
        if (link->n_forward > 0)
            continue;
        if (link->client_ended) { /* in the middle of a body: there is no one to answer */
            front_link_die(link);
            return true;
        }
        if (!read_client(link))
            return link->state == LINK_DEAD;
    }
}

/* The library closed its end: this answer was the last. */
static void finish(struct front_link *link)
{
    char byte;
    bool has_more =
        link->n_in > 0 || !body_is_ended(&link->body) || recv(link->client, &byte, 1, MSG_PEEK | MSG_DONTWAIT) > 0;
    if (has_more)
        linger(link, FRONT_MAX_DROPPED);
    else
        front_link_die(link);
}

/* Waits for the end of the answer. Returns true when the state has changed. */
static bool step_answer(struct front_link *link)
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
    front_set_state(link, LINK_HEAD);
    link->head_us = link->moved_us = clock_now_us();
    link->n_head = 0;
    return true;
}

static void step_linger(struct front_link *link)
{
    size_t n_now = 0;
    while (link->client_readable) {
        ssize_t n = recv(link->client, link->front->bytes, sizeof link->front->bytes, MSG_DONTWAIT);
        if (n < 0 && would_block()) {
            link->client_readable = false;
            return;
        }
        if (n > 0) {
            link->moved_us = clock_now_us();
            link->n_dropped += (uint64_t)n;
            n_now += (size_t)n;
        }
        if (n <= 0 || link->n_dropped > link->max_dropped) {
            front_link_die(link);
            return;
        }
        if (n_now >= DROP_SIZE) { /* other links have their turn */
            front_touch(link);
            return;
        }
    }
}

void front_link_refuse_late(struct front_link *link)
{
    struct front *front = link->front;
    struct problem problem;
    const char *bytes = link->in;
    if (link->n_in == 0) {
        ssize_t n = recv(link->client, front->bytes, HEAD_MAX_BYTES, MSG_PEEK | MSG_DONTWAIT);
        link->n_head = n > 0 ? (size_t)n : 0;
        bytes = front->bytes;
    }
    head_refuse_incomplete(bytes, link->n_head, false, FRONT_HEAD_MS, &problem);
    link->n_answered = 0;
    front_link_refuse(link, &problem, FRONT_MAX_DROPPED);
}

void front_link_advance(struct front_link *link)
{
    bool has_changed = true;
    while (has_changed && link->state != LINK_DEAD) {
        has_changed = false;
        if (link->is_refused && link->state != LINK_LINGER) {
            front_link_refuse(link, &link->problem, link->max_dropped);
            continue;
        }
        if (link->state != LINK_LINGER)
            front_link_pass_answer(link);
        switch (link->state) {
        case LINK_HEAD:
            if (link->inner_ended) /* the library closed the connection between two requests */
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

/* ---- the library's side ----------------------------------------------------------------------------------------- */

void front_link_closed(struct front_link *link)
{
    link->server = -1;
    link->front->has_dead = true;
    if (link->state == LINK_DEAD || link->state == LINK_LINGER)
        front_uncount(link);
}

bool front_link_is_free(const struct front_link *link)
{
    int n_inner = 0, n_unsent = 0;
    if (link->state == LINK_DEAD || link->n_out > 0)
        return false;
    (void)ioctl(link->inner, FIONREAD, &n_inner);
    if (ioctl(link->client, SIOCOUTQNSD, &n_unsent) != 0)
        (void)ioctl(link->client, SIOCOUTQ, &n_unsent); /* a pair of sockets, behind which TLS is decrypted */
    return n_inner == 0 && n_unsent == 0;
}

bool front_link_is_gone(const struct front_link *link)
{
    return link->state == LINK_DEAD;
}

void front_request_ended(struct front_link *link)
{
    link->is_request_ended = true;
    link->inner_readable = true;
    front_touch(link);
}

void front_refuse(struct front_link *link, const struct problem *problem, uint64_t max_dropped)
{
    if (link->state == LINK_DEAD || link->state == LINK_LINGER)
        return;
    link->is_refused = true;
    link->problem = *problem;
    link->max_dropped = max_dropped;
    front_uncount(link);
    front_touch(link);
}
