/* The handshake of a connection, and incoming messages with their limits. */
#include "server/ws/ws.h"

#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/socket.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/wire/origin.h"
#include "server/wire/refusal.h"
#include "server/ws/accept.h"
#include "server/ws/out.h"
#include "wire_gen.h"

enum {
    SEND_BUFFER = 128 << 10, /* the kernel's: a frame in it can no longer be replaced by a newer one */
    CHECK_EVERY_US = 1000000,
};

const struct ws_limits ws_limits_default = {
    .max_message_bytes = WIRE_MAX_CLIENT_BYTES,
    .messages = { .per_s = 1000, .burst = 2000 },
    .controls = { .per_s = 50, .burst = 200 },
    .bytes = { .per_s = 4 << 20, .burst = 8 << 20 },
    .max_waiting = 256,
    .max_waiting_bytes = 4 << 20,
};

/* ---- the handshake ---------------------------------------------------------------------------------------------- */

/* False for a page of another site, which would use this browser's access to the server. Programs send no Origin. */
static bool origin_is_allowed(const struct ws *ws, const struct handshake *handshake)
{
    const char *origin = handshake->origin;
    if (!origin[0] || (ws->allowed_origin && strcasecmp(origin, ws->allowed_origin) == 0))
        return true;
    return handshake->host[0] && origin_is_of_host(origin, handshake->host, handshake->is_secure);
}

/* Answers with the problem. Takes the socket. */
static void refuse(struct ws *ws, int socket, const struct problem *problem)
{
    (void)refusal_drain(socket, WS_MAX_HEAD);
    refusal_send(socket, problem);
    (void)close(socket);
    ws->counters.refused++;
}

static bool may_open(const struct ws *ws, const struct handshake *handshake, struct problem *problem)
{
    if (!handshake->room_id[0] || !ws->callbacks.has_room(ws->callbacks.context, handshake))
        return problem_set(problem, PROBLEM_NOT_FOUND, "", "",
                           "there is no such room; expected is the id of one that is open");
    if (!origin_is_allowed(ws, handshake))
        return problem_set(
            problem, PROBLEM_FORBIDDEN, "", "",
            "the origin \"%.100s\" may not open a WebSocket; expected is the server's own, or that of --allow-origin",
            handshake->origin);
    if (ws->counters.n_connections >= WS_MAX_CONNECTIONS) {
        (void)problem_set(problem, PROBLEM_LIMIT, "", "", "too many WebSockets are open; at most %d are",
                          WS_MAX_CONNECTIONS);
        problem->retry_after_ms = WS_RETRY_MS;
        return false;
    }
    return true;
}

/* Sends the answer of RFC 6455 4.2.2. It is the first thing sent on this socket, so it fits into its buffer. */
static bool answer_handshake(int socket, const char *key)
{
    char accept[WS_ACCEPT_SIZE], answer[256];
    if (strlen(key) != WS_KEY_CHARACTERS)
        return false;
    ws_accept_of(key, accept);
    int n = snprintf(
        answer, sizeof answer,
        "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: %s\r\n\r\n",
        accept);
    return send(socket, answer, (size_t)n, MSG_NOSIGNAL | MSG_DONTWAIT) == n;
}

/* Reads the head away: the front has only peeked at it. */
static bool skip_head(int socket, size_t n)
{
    char bytes[WS_MAX_HEAD];
    return n <= sizeof bytes && recv(socket, bytes, n, MSG_DONTWAIT) == (ssize_t)n;
}

static void set_option(int socket, int level, int name, int value)
{
    if (setsockopt(socket, level, name, &value, sizeof value) < 0) {
        /* on other sockets than TCP (tests, proxies on Unix sockets) these options are not needed */
    }
}

/* The next whole second: the thread wakes up once for all connections that are checked in it. */
static int64_t whole_second_after(int64_t time_us)
{
    return time_us / CHECK_EVERY_US * CHECK_EVERY_US + CHECK_EVERY_US;
}

/* When the connection could next be late: with its hello, or silent for so long that a ping is due. */
static void check_later(struct ws_connection *connection, bool is_greeted)
{
    const int64_t now_us = clock_now_us(), ping_us = WS_PING_AFTER_S * INT64_C(1000000);
    const int64_t n_pings = (now_us - connection->heard_us) / ping_us;
    int64_t due_us = connection->heard_us + (n_pings + 1) * ping_us;
    if (!is_greeted && due_us > connection->opened_us + WS_HELLO_WITHIN_S * INT64_C(1000000))
        due_us = connection->opened_us + WS_HELLO_WITHIN_S * INT64_C(1000000);
    ws_check_at(connection, whole_second_after(due_us > now_us ? due_us : now_us));
}

static void start(struct ws_connection *connection, const struct handshake *handshake, const struct ws_count *count)
{
    struct ws *ws = connection->ws;
    connection->count = *count;
    connection->state = STATE_OPEN;
    connection->pongs.last = &connection->pongs.first;
    connection->texts.last = &connection->texts.first;
    connection->latest.last = &connection->latest.first;
    connection->opened_us = connection->heard_us = clock_now_us();
    ws_parser_init(&connection->parser, ws->limits.max_message_bytes, ws->limits.takes_binary);
    connection->next = ws->connections;
    if (ws->connections)
        ws->connections->previous = connection;
    ws->connections = connection;
    ws->counters.opened++;
    ws->counters.n_connections++;
    check_later(connection, false);
    ws->callbacks.opened(ws->callbacks.context, connection, handshake);
}

/* Answers the handshake. False: the socket cannot be served, and is closed. */
static bool open_socket(struct ws *ws, int socket, const struct handshake *handshake)
{
    struct problem problem;
    int flags = fcntl(socket, F_GETFL);
    if (flags >= 0)
        (void)fcntl(socket, F_SETFL, flags | O_NONBLOCK);
    if (!may_open(ws, handshake, &problem)) {
        refuse(ws, socket, &problem);
        return false;
    }
    set_option(socket, IPPROTO_TCP, TCP_NODELAY, 1);
    set_option(socket, IPPROTO_TCP, TCP_NOTSENT_LOWAT, WS_UNSENT_AT_MOST);
    set_option(socket, SOL_SOCKET, SO_SNDBUF, SEND_BUFFER);
    if (skip_head(socket, handshake->n_head) && answer_handshake(socket, handshake->key))
        return true;
    (void)close(socket); /* the client has gone */
    return false;
}

static void end_count(const struct ws_count *count)
{
    if (count->ended)
        count->ended(count->context);
}

void ws_adopt(struct ws *ws, int socket, const struct handshake *handshake, const struct ws_count *count)
{
    if (!open_socket(ws, socket, handshake)) {
        end_count(count);
        return;
    }
    struct ws_connection *connection = calloc(1, sizeof *connection);
    if (!connection)
        (void)close(socket);
    if (!connection || !sockets_add(ws->sockets, &connection->socket, socket)) {
        log_warn("a connection could not be taken over: no memory");
        free(connection);
        end_count(count);
        return;
    }
    connection->ws = ws;
    memcpy(connection->client, handshake->client, sizeof connection->client);
    start(connection, handshake, count);
}

void ws_refuse_as_stopping(struct ws *ws, int socket)
{
    struct problem problem;
    (void)problem_set(&problem, PROBLEM_BUSY, "", "", "the server is being stopped");
    problem.retry_after_ms = WS_RETRY_MS;
    refuse(ws, socket, &problem);
}

/* ---- what comes in ---------------------------------------------------------------------------------------------- */

static void refuse_rate(struct ws_connection *connection, const struct rate_limit *limit, const char *what)
{
    char reason[100];
    (void)snprintf(reason, sizeof reason, "more than %lld %s a second, or %lld at once", (long long)limit->per_s, what,
                   (long long)limit->burst);
    out_log_cut(connection->ws, reason);
    ws_bye(connection, WS_CLOSE_POLICY, reason, WS_RETRY_MS);
}

static void handle_event(struct ws_connection *connection, const struct ws_event *event, int64_t now_us)
{
    const struct ws_limits *limits = &connection->ws->limits;
    const struct ws_callbacks *callbacks = &connection->ws->callbacks;
    switch (event->type) {
    case WS_EVENT_NONE: break;
    case WS_EVENT_MESSAGE:
        if (rate_allows(&connection->messages, &limits->messages, 1, now_us))
            callbacks->message_received(callbacks->context, connection, event->kind, (const char *)event->bytes,
                                        event->n);
        else
            refuse_rate(connection, &limits->messages, "messages");
        break;
    case WS_EVENT_PING:
    case WS_EVENT_PONG:
        if (!rate_allows(&connection->controls, &limits->controls, 1, now_us))
            refuse_rate(connection, &limits->controls, "pings and pongs");
        else if (event->type == WS_EVENT_PING)
            out_add_pong(connection, event->bytes, event->n);
        break;
    case WS_EVENT_CLOSE: out_begin_close(connection, event->code, NULL); break;
    case WS_EVENT_BROKEN: out_begin_close(connection, event->code, event->reason); break;
    }
}

static struct ws_connection *connection_of(struct socket *socket)
{
    return (struct ws_connection *)socket;
}

static int receive(struct socket *socket, const uint8_t *bytes, size_t n)
{
    struct ws_connection *connection = connection_of(socket);
    struct ws *ws = connection->ws;
    struct ws_event event;
    const int64_t now_us = ws->turn_us ? ws->turn_us : clock_now_us();
    ws->turn_us = now_us;
    if (connection->state != STATE_OPEN) {
        connection->n_dropped += n;
        return connection->n_dropped > WS_MAX_DROPPED ? -1 : 0;
    }
    connection->heard_us = now_us;
    if (!rate_allows(&connection->bytes, &ws->limits.bytes, (int64_t)n, now_us)) {
        refuse_rate(connection, &ws->limits.bytes, "bytes");
        return out_answer_now(connection);
    }
    do {
        size_t n_taken = ws_parser_take(&connection->parser, bytes, n, &event);
        bytes += n_taken;
        n -= n_taken;
        handle_event(connection, &event, now_us);
    } while (event.type != WS_EVENT_NONE && connection->state == STATE_OPEN);
    return out_answer_now(connection);
}

/* Pings a connection that is silent for half of the time to its next ping, when the thread is awake for another one's:
 * so all members that keep still are pinged in one wake-up. */
static void ping_early(struct ws_connection *connection, int64_t now_us)
{
    struct ws *ws = connection->ws;
    const int64_t ping_us = WS_PING_AFTER_S * INT64_C(1000000), silent_us = now_us - connection->heard_us;
    if (connection->state != STATE_OPEN || connection->pongs.first || silent_us < ping_us / 2 || silent_us >= ping_us ||
        !ws->callbacks.is_greeted(ws->callbacks.context, connection))
        return;
    out_add_ping(connection);
    connection->check_us = whole_second_after(connection->heard_us + 2 * ping_us);
}

static int check_connection(struct ws_connection *connection)
{
    struct ws *ws = connection->ws;
    int64_t now_us = clock_now_us(), silent_us = now_us - connection->heard_us;
    if (connection->state != STATE_OPEN) {
        ws_check_at(connection, connection->close_by_us);
        return now_us < connection->close_by_us ? 0 : -1;
    }
    const bool is_greeted = ws->callbacks.is_greeted(ws->callbacks.context, connection);
    check_later(connection, is_greeted);
    if (now_us - connection->opened_us >= WS_HELLO_WITHIN_S * INT64_C(1000000) && !is_greeted) {
        ws_bye(connection, WS_CLOSE_NORMAL, "no hello within 5 s", 1000);
    } else if (silent_us >= WS_SILENT_AT_MOST_S * INT64_C(1000000)) {
        ws_bye(connection, WS_CLOSE_NORMAL, "nothing was heard for 15 s", 0);
    } else if (silent_us >= WS_PING_AFTER_S * INT64_C(1000000) && !connection->pongs.first) {
        out_add_ping(connection);
    }
    return 0;
}

static int take_more(struct socket *socket)
{
    struct ws_connection *connection = connection_of(socket);
    connection->is_asking = false;
    return out_write(connection);
}

/* Frees the connection, whose socket is about to be closed. */
static void finish(struct socket *socket)
{
    struct ws_connection *connection = connection_of(socket);
    struct ws *ws = connection->ws;
    connection->state = STATE_NONE; /* from here on nothing is queued */
    ws->counters.n_connections--;
    ws->callbacks.closed(ws->callbacks.context, connection);
    out_drop_frames(connection);
    out_queue_clear(&connection->pongs);
    out_queue_clear(&connection->texts);
    out_queue_clear(&connection->latest);
    free(connection->close);
    out_drop_sending(connection);
    out_unmark(connection);
    ws_parser_finish(&connection->parser);
    if (connection->previous)
        connection->previous->next = connection->next;
    else
        ws->connections = connection->next;
    if (connection->next)
        connection->next->previous = connection->previous;
    const struct ws_count count = connection->count;
    free(connection);
    end_count(&count);
}

static void check_connections(struct ws *ws)
{
    const int64_t now_us = clock_now_us();
    if (now_us < ws->check_us)
        return;
    ws->check_us = INT64_MAX;
    for (struct ws_connection *connection = ws->connections, *next; connection; connection = next) {
        next = connection->next;
        if (now_us >= connection->check_us) {
            if (check_connection(connection) != 0)
                sockets_close(&connection->socket);
            continue;
        }
        ping_early(connection, now_us);
        ws_check_at(connection, connection->check_us);
    }
}

/* ---- life ------------------------------------------------------------------------------------------------------- */

struct ws *ws_create(const struct ws_callbacks *callbacks, const struct ws_limits *limits, const char *allowed_origin,
                     struct error *err)
{
    struct ws *ws = mem_new(sizeof *ws);
    ws->callbacks = *callbacks;
    ws->limits = *limits;
    ws->allowed_origin = allowed_origin ? mem_copy_text(allowed_origin) : NULL;
    ws->timer_us = ws->check_us = INT64_MAX;
    static const struct sockets_calls calls = { receive, take_more, finish };
    ws->sockets = sockets_create(&calls, err);
    if (ws->sockets)
        return ws;
    ws_destroy(ws);
    return NULL;
}

void ws_destroy(struct ws *ws)
{
    if (!ws)
        return;
    while (ws->connections)
        sockets_close(&ws->connections->socket);
    sockets_destroy(ws->sockets);
    free(ws->allowed_origin);
    free(ws);
}

void ws_serve(struct ws *ws)
{
    out_flush(ws);
    ws->turn_us = 0;
    const bool is_woken = sockets_wait(ws->sockets, ws->timer_us < ws->check_us ? ws->timer_us : ws->check_us);
    check_connections(ws);
    if (is_woken)
        ws->callbacks.woken(ws->callbacks.context);
    if (clock_now_us() >= ws->timer_us) {
        ws->timer_us = INT64_MAX;
        ws->callbacks.timer_fired(ws->callbacks.context);
    }
    out_flush(ws);
}

void ws_wake(struct ws *ws)
{
    sockets_wake(ws->sockets);
}

void ws_wake_at(struct ws *ws, int64_t time_us)
{
    ws->timer_us = time_us;
}

void ws_count(const struct ws *ws, struct ws_counters *counters)
{
    *counters = ws->counters;
}

void ws_set_owner(struct ws_connection *connection, void *owner)
{
    connection->owner = owner;
}

const char *ws_client(const struct ws_connection *connection)
{
    return connection->client;
}

int64_t ws_heard_us(const struct ws_connection *connection)
{
    return connection->heard_us;
}

void *ws_owner(const struct ws_connection *connection)
{
    return connection->owner;
}
