#include "server/ws/ws.h"

#include <fcntl.h>
#include <libwebsockets.h>
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
#include "server/wire/message.h"
#include "server/wire/refusal.h"

enum {
    LARGEST_SEND = 1 << 20,    /* in one call; less than a frame makes it several times slower */
    SEND_BUFFER = 128 << 10,   /* of the kernel: what waits there cannot be replaced by a newer frame */
    UNSENT_AT_MOST = 32 << 10, /* in it before it takes more */
    TIMER_US = 1000000,
};

struct text {
    struct text *next;
    size_t n;
    unsigned char bytes[]; /* LWS_PRE, then n */
};

struct box { /* the newest frame of a view */
    uint8_t header[FRAME_HEADER_BYTES];
    struct room_picture *picture; /* NULL: empty */
};

struct ws_connection { /* zeroed by the library, lives with its socket */
    struct ws *ws;
    struct lws *wsi;
    void *owner;
    bool is_open, is_closing, wants_ping;
    int64_t opened_us, heard_us, close_by_us;
    char *message; /* being put together from fragments */
    size_t n_message;
    struct text *first, **last;
    size_t n_texts, n_text_bytes;
    struct box boxes[ROOM_MAX_VIEWS];
    int next_box;
};

struct ws {
    struct lws_context *context;
    struct lws_vhost *vhost;
    struct lws_protocols protocols[2];
    struct ws_callbacks callbacks;
    char *allowed_origin;
    lws_sorted_usec_list_t timer;
    unsigned char *out; /* LWS_PRE, header, picture */
    size_t out_size;
    struct ws_counters counters;
};

/* ---- who may come in ------------------------------------------------------------------------------------------------ */

/* The id in /api/v1/rooms/{id}/ws. */
static bool read_path(struct lws *wsi, char id[64])
{
    static const char before[] = "/api/v1/rooms/", after[] = "/ws";
    char path[160];
    int n = lws_hdr_copy(wsi, path, sizeof path, WSI_TOKEN_GET_URI);
    size_t n_before = sizeof before - 1, n_after = sizeof after - 1;
    if (n < 0 || (size_t)n <= n_before + n_after || strncmp(path, before, n_before) != 0)
        return false;
    size_t n_id = (size_t)n - n_before - n_after;
    if (n_id > 63 || strcmp(path + n_before + n_id, after) != 0)
        return false;
    memcpy(id, path + n_before, n_id);
    id[n_id] = 0;
    return id_is_valid(id);
}

/* A page of another site must not open a connection with this browser's standing. Programs send no Origin. */
static bool origin_is_allowed(const struct ws *ws, struct lws *wsi)
{
    char origin[300], host[260];
    if (lws_hdr_total_length(wsi, WSI_TOKEN_ORIGIN) == 0)
        return true;
    if (lws_hdr_copy(wsi, origin, sizeof origin, WSI_TOKEN_ORIGIN) <= 0 || lws_hdr_copy(wsi, host, sizeof host, WSI_TOKEN_HOST) <= 0)
        return false;
    if (ws->allowed_origin && strcasecmp(origin, ws->allowed_origin) == 0)
        return true;
    const char *authority = strncasecmp(origin, "http://", 7) == 0 ? origin + 7 : strncasecmp(origin, "https://", 8) == 0 ? origin + 8 : NULL;
    return authority && strcasecmp(authority, host) == 0;
}

/* The library's own refusals are pages of HTML; this one is a problem like all others. */
static int refuse(struct ws *ws, struct lws *wsi, const struct problem *problem)
{
    size_t n;
    char *text = refusal_write(problem, &n);
    unsigned char *bytes = mem_new(LWS_PRE + n);
    memcpy(bytes + LWS_PRE, text, n);
    ws->counters.refused++;
    (void)lws_write(wsi, bytes + LWS_PRE, n, LWS_WRITE_HTTP_FINAL);
    free(bytes);
    free(text);
    return -1;
}

static int confirm_upgrade(struct ws *ws, struct lws *wsi, const char *to)
{
    char id[64], origin[101] = "";
    struct problem problem;
    if (strcasecmp(to, "websocket") != 0) {
        problem_set(&problem, PROBLEM_UPGRADE, "", "", "Upgrade is \"%.40s\"; expected is websocket", to);
        return refuse(ws, wsi, &problem);
    }
    if (!read_path(wsi, id) || !ws->callbacks.has_room(ws->callbacks.context, id)) {
        problem_set(&problem, PROBLEM_NOT_FOUND, "", "", "there is no such room; expected is the id of one that is open");
        return refuse(ws, wsi, &problem);
    }
    if (!origin_is_allowed(ws, wsi)) {
        (void)lws_hdr_copy(wsi, origin, sizeof origin, WSI_TOKEN_ORIGIN);
        problem_set(&problem, PROBLEM_FORBIDDEN, "", "", "the origin \"%.100s\" may not open a WebSocket; expected is the server's own, or that of --allow-origin",
                    origin);
        return refuse(ws, wsi, &problem);
    }
    return 0;
}

/* The acceptor lets nothing else through. */
static int refuse_plain(struct ws *ws, struct lws *wsi)
{
    struct problem problem;
    problem_set(&problem, PROBLEM_UPGRADE, "", "", "no handshake of a WebSocket; expected is one (RFC 6455)");
    return refuse(ws, wsi, &problem);
}

static void set_option(int socket, int level, int name, int value)
{
    if (setsockopt(socket, level, name, &value, sizeof value) < 0) {
        /* a socket that is no TCP one (tests, proxies on Unix sockets) works as well, only later */
    }
}

void ws_adopt(struct ws *ws, int socket)
{
    int flags = fcntl(socket, F_GETFL);
    if (flags >= 0)
        (void)fcntl(socket, F_SETFL, flags | O_NONBLOCK);
    set_option(socket, IPPROTO_TCP, TCP_NODELAY, 1);
    set_option(socket, IPPROTO_TCP, TCP_NOTSENT_LOWAT, UNSENT_AT_MOST);
    set_option(socket, SOL_SOCKET, SO_SNDBUF, SEND_BUFFER);
    int second = fcntl(socket, F_DUPFD_CLOEXEC, 3); /* the library closes what it does not take, without a word */
    if (!lws_adopt_socket_vhost(ws->vhost, socket)) {
        struct problem problem;
        problem_set(&problem, PROBLEM_LIMIT, "", "", "too many WebSockets are open; at most %d are", WS_MAX_CONNECTIONS);
        problem.retry_after_ms = WS_RETRY_MS;
        if (second >= 0) {
            (void)refusal_drain(second, WS_MAX_HEAD);
            refusal_send(second, &problem);
        }
        ws->counters.refused++;
        log_warn("a connection could not be taken over: too many, or no memory");
    }
    if (second >= 0)
        (void)close(second);
}

/* ---- what goes out -------------------------------------------------------------------------------------------------- */

static void drop_frames(struct ws_connection *connection)
{
    for (int i = 0; i < ROOM_MAX_VIEWS; i++) {
        room_picture_drop(connection->boxes[i].picture);
        connection->boxes[i].picture = NULL;
    }
}

static void kill_later(struct ws_connection *connection)
{
    lws_set_timeout(connection->wsi, PENDING_TIMEOUT_CLOSE_SEND, LWS_TO_KILL_ASYNC);
}

void ws_send_text(struct ws_connection *connection, const char *text)
{
    size_t n = strlen(text);
    if (connection->is_closing)
        return;
    if (connection->n_texts >= WS_MAX_TEXTS || connection->n_text_bytes + n > WS_MAX_TEXT_BYTES) {
        log_warn("a connection takes its messages too slowly (%zu wait, %zu bytes): closed", connection->n_texts, connection->n_text_bytes);
        connection->is_closing = true;
        drop_frames(connection);
        kill_later(connection);
        return;
    }
    struct text *item = mem_new(sizeof *item + LWS_PRE + n);
    item->n = n;
    memcpy(item->bytes + LWS_PRE, text, n);
    *connection->last = item;
    connection->last = &item->next;
    connection->n_texts++;
    connection->n_text_bytes += n;
    lws_callback_on_writable(connection->wsi);
}

void ws_send_frame(struct ws_connection *connection, const struct frame_header *header, struct room_picture *picture)
{
    if (connection->is_closing || header->view < 1 || header->view > ROOM_MAX_VIEWS)
        return;
    struct box *box = &connection->boxes[header->view - 1];
    room_picture_drop(box->picture);
    box->picture = room_picture_hold(picture);
    frame_header_write(header, box->header);
    lws_callback_on_writable(connection->wsi);
}

void ws_close(struct ws_connection *connection)
{
    if (connection->is_closing)
        return;
    connection->is_closing = true;
    connection->close_by_us = clock_now_us() + WS_CLOSE_WITHIN_S * INT64_C(1000000);
    drop_frames(connection);
    lws_callback_on_writable(connection->wsi);
}

void ws_bye(struct ws_connection *connection, const char *reason, int retry_ms)
{
    struct message message = { .type = MESSAGE_BYE, .bye = { .has_retry_ms = retry_ms >= 0, .retry_ms = retry_ms } };
    (void)snprintf(message.bye.reason, sizeof message.bye.reason, "%s", reason);
    char *text = message_write(&message);
    ws_send_text(connection, text);
    free(text);
    ws_close(connection);
}

static bool write_text(struct ws_connection *connection)
{
    struct text *item = connection->first;
    connection->first = item->next;
    if (!connection->first)
        connection->last = &connection->first;
    connection->n_texts--;
    connection->n_text_bytes -= item->n;
    int n = lws_write(connection->wsi, item->bytes + LWS_PRE, item->n, LWS_WRITE_TEXT);
    bool ok = n >= 0 && (size_t)n >= item->n;
    free(item);
    return ok;
}

static bool write_frame(struct ws_connection *connection, struct box *box)
{
    struct ws *ws = connection->ws;
    size_t n = FRAME_HEADER_BYTES + box->picture->n_bytes;
    if (ws->out_size < LWS_PRE + n) {
        free(ws->out);
        ws->out_size = LWS_PRE + n + n / 4;
        ws->out = mem_new(ws->out_size);
    }
    memcpy(ws->out + LWS_PRE, box->header, FRAME_HEADER_BYTES);
    memcpy(ws->out + LWS_PRE + FRAME_HEADER_BYTES, box->picture->bytes, box->picture->n_bytes);
    room_picture_drop(box->picture);
    box->picture = NULL;
    int written = lws_write(connection->wsi, ws->out + LWS_PRE, n, LWS_WRITE_BINARY);
    return written >= 0 && (size_t)written >= n;
}

/* One thing a call: what the library could not hand to the kernel must go first. Texts before frames, views in turn. */
static int write_next(struct ws_connection *connection)
{
    bool ok = true;
    if (connection->wants_ping) {
        unsigned char ping[LWS_PRE + 1];
        connection->wants_ping = false;
        ok = lws_write(connection->wsi, ping + LWS_PRE, 0, LWS_WRITE_PING) >= 0;
    } else if (connection->first) {
        ok = write_text(connection);
    } else if (connection->is_closing) {
        lws_close_reason(connection->wsi, LWS_CLOSE_STATUS_NORMAL, NULL, 0);
        return -1;
    } else {
        for (int i = 0; i < ROOM_MAX_VIEWS; i++) {
            int at = (connection->next_box + i) % ROOM_MAX_VIEWS;
            if (!connection->boxes[at].picture)
                continue;
            connection->next_box = at + 1;
            ok = write_frame(connection, &connection->boxes[at]);
            break;
        }
    }
    if (!ok)
        return -1;
    bool has_more = connection->first || connection->is_closing;
    for (int i = 0; i < ROOM_MAX_VIEWS; i++)
        has_more = has_more || connection->boxes[i].picture;
    if (has_more)
        lws_callback_on_writable(connection->wsi);
    return 0;
}

/* ---- what comes in -------------------------------------------------------------------------------------------------- */

static int receive(struct ws_connection *connection, const char *bytes, size_t n)
{
    struct lws *wsi = connection->wsi;
    connection->heard_us = clock_now_us();
    if (connection->is_closing)
        return 0;
    if (lws_frame_is_binary(wsi)) {
        lws_close_reason(wsi, LWS_CLOSE_STATUS_UNACCEPTABLE_OPCODE, NULL, 0);
        return -1;
    }
    if (lws_is_first_fragment(wsi))
        connection->n_message = 0;
    if (n > WIRE_MAX_CLIENT_BYTES - connection->n_message) {
        lws_close_reason(wsi, LWS_CLOSE_STATUS_MESSAGE_TOO_LARGE, NULL, 0);
        return -1;
    }
    if (!connection->message)
        connection->message = mem_new(WIRE_MAX_CLIENT_BYTES);
    memcpy(connection->message + connection->n_message, bytes, n);
    connection->n_message += n;
    if (!lws_is_final_fragment(wsi) || lws_remaining_packet_payload(wsi) != 0)
        return 0;
    n = connection->n_message;
    connection->n_message = 0;
    connection->ws->callbacks.text_came(connection->ws->callbacks.context, connection, connection->message, n);
    return 0;
}

static int look_after(struct ws_connection *connection)
{
    struct ws *ws = connection->ws;
    int64_t now_us = clock_now_us(), silent_us = now_us - connection->heard_us;
    lws_set_timer_usecs(connection->wsi, TIMER_US);
    if (connection->is_closing)
        return now_us >= connection->close_by_us ? -1 : 0;
    if (now_us - connection->opened_us >= WS_HELLO_WITHIN_S * INT64_C(1000000) &&
        !ws->callbacks.is_greeted(ws->callbacks.context, connection)) {
        ws_bye(connection, "no hello within 5 s", 1000);
    } else if (silent_us >= WS_SILENT_AT_MOST_S * INT64_C(1000000)) {
        ws_bye(connection, "nothing was heard for 30 s", 0);
    } else if (silent_us >= WS_PING_AFTER_S * INT64_C(1000000)) {
        connection->wants_ping = true;
        lws_callback_on_writable(connection->wsi);
    }
    return 0;
}

static int opened(struct ws *ws, struct ws_connection *connection, struct lws *wsi)
{
    char id[64];
    *connection = (struct ws_connection){ .ws = ws, .wsi = wsi };
    connection->last = &connection->first;
    connection->opened_us = connection->heard_us = clock_now_us();
    if (!read_path(wsi, id))
        return -1;
    connection->is_open = true;
    ws->counters.opened++;
    ws->counters.n_connections++;
    lws_set_timer_usecs(wsi, TIMER_US);
    ws->callbacks.opened(ws->callbacks.context, connection, id);
    return 0;
}

static void closed(struct ws_connection *connection)
{
    if (!connection->is_open)
        return;
    connection->is_open = false;
    connection->is_closing = true; /* nothing is queued from here on */
    connection->ws->counters.n_connections--;
    connection->ws->callbacks.closed(connection->ws->callbacks.context, connection);
    drop_frames(connection);
    for (struct text *item = connection->first, *next; item; item = next) {
        next = item->next;
        free(item);
    }
    free(connection->message);
}

static int handle(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t n)
{
    struct ws *ws = lws_context_user(lws_get_context(wsi));
    struct ws_connection *connection = user;
    switch (reason) {
    case LWS_CALLBACK_HTTP_CONFIRM_UPGRADE: return confirm_upgrade(ws, wsi, in);
    case LWS_CALLBACK_HTTP: return refuse_plain(ws, wsi);
    case LWS_CALLBACK_ESTABLISHED: return opened(ws, connection, wsi);
    case LWS_CALLBACK_RECEIVE: return receive(connection, in, n);
    case LWS_CALLBACK_RECEIVE_PONG: connection->heard_us = clock_now_us(); return 0;
    case LWS_CALLBACK_SERVER_WRITEABLE: return write_next(connection);
    case LWS_CALLBACK_TIMER: return connection && connection->is_open ? look_after(connection) : 0;
    case LWS_CALLBACK_CLOSED: closed(connection); return 0;
    case LWS_CALLBACK_EVENT_WAIT_CANCELLED: ws->callbacks.woken(ws->callbacks.context); return 0;
    default: return 0;
    }
}

/* ---- life ----------------------------------------------------------------------------------------------------------- */

static void log_library(int level, const char *line)
{
    log_line(level == LLL_ERR ? LOG_WARN : LOG_DEBUG, "libwebsockets: %s", line); /* its errors are about what clients do */
}

struct ws *ws_create(const struct ws_callbacks *callbacks, const char *allowed_origin, struct error *err)
{
    struct ws *ws = mem_new(sizeof *ws);
    ws->callbacks = *callbacks;
    ws->allowed_origin = allowed_origin ? mem_copy_text(allowed_origin) : NULL;
    ws->protocols[0] = (struct lws_protocols){ .name = "beamroom",
                                               .callback = handle,
                                               .per_session_data_size = sizeof(struct ws_connection),
                                               .rx_buffer_size = 4096,
                                               .tx_packet_size = LARGEST_SEND };
    lws_set_log_level(LLL_ERR | LLL_WARN, log_library);
    struct lws_context_creation_info info = { .port = CONTEXT_PORT_NO_LISTEN_SERVER,
                                              .protocols = ws->protocols,
                                              .vhost_name = "rooms",
                                              .options = LWS_SERVER_OPTION_EXPLICIT_VHOSTS | LWS_SERVER_OPTION_VALIDATE_UTF8,
                                              .timeout_secs = 5,
                                              .max_http_header_data = WS_MAX_HEAD,
                                              .fd_limit_per_thread = WS_MAX_CONNECTIONS,
                                              .count_threads = 1,
                                              .user = ws };
    ws->context = lws_create_context(&info);
    ws->vhost = ws->context ? lws_create_vhost(ws->context, &info) : NULL; /* no extensions: JPEG does not deflate */
    if (!ws->vhost) {
        error_set(err, ERROR_IO, "libwebsockets could not be started");
        ws_destroy(ws);
        return NULL;
    }
    return ws;
}

void ws_destroy(struct ws *ws)
{
    if (!ws)
        return;
    if (ws->context) {
        ws_wake_at(ws, INT64_MAX);
        lws_context_destroy(ws->context);
    }
    free(ws->allowed_origin);
    free(ws->out);
    free(ws);
}

void ws_serve(struct ws *ws)
{
    (void)lws_service(ws->context, 0);
}

void ws_wake(struct ws *ws)
{
    lws_cancel_service(ws->context);
}

static void time_came(lws_sorted_usec_list_t *timer)
{
    struct ws *ws = lws_container_of(timer, struct ws, timer);
    ws->callbacks.time_came(ws->callbacks.context);
}

void ws_wake_at(struct ws *ws, int64_t time_us)
{
    int64_t wait_us = time_us - clock_now_us();
    lws_sul_schedule(ws->context, 0, &ws->timer, time_came,
                     time_us == INT64_MAX ? LWS_SET_TIMER_USEC_CANCEL : wait_us > 0 ? wait_us : 1);
}

void ws_count(const struct ws *ws, struct ws_counters *counters)
{
    *counters = ws->counters;
}

void ws_set_owner(struct ws_connection *connection, void *owner)
{
    connection->owner = owner;
}

void *ws_owner(const struct ws_connection *connection)
{
    return connection->owner;
}
