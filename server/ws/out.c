/* Queues messages and frames of a connection, sends them in order, and closes. */
#include "server/ws/out.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/uio.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/wire/message.h"

enum {
    LOG_EVERY_US = 10000000,
    MOST_AT_ONCE = 16 << 10, /* bytes of texts that are begun to be sent together */
    LAST_SLOT = WS_SLOTS - 1
};

/* ---- queues ----------------------------------------------------------------------------------------------------- */

struct message_out *out_message(enum ws_opcode opcode, const void *bytes, size_t n)
{
    struct message_out *message =
        n <= OUT_SMALL_BYTES ? mem_new(sizeof *message + n) : mem_array(sizeof *message + n, 1, UINT64_MAX, NULL);
    if (!message)
        return NULL;
    message->opcode = opcode;
    message->n = n;
    if (n)
        memcpy(message->bytes, bytes, n);
    return message;
}

void out_queue_add(struct queue_out *queue, struct message_out *message)
{
    *queue->last = message;
    queue->last = &message->next;
    queue->n++;
    queue->n_bytes += message->n;
}

static struct message_out *queue_take_first(struct queue_out *queue)
{
    struct message_out *message = queue->first;
    if (!message)
        return NULL;
    queue->first = message->next;
    if (!queue->first)
        queue->last = &queue->first;
    queue->n--;
    queue->n_bytes -= message->n;
    return message;
}

void out_queue_clear(struct queue_out *queue)
{
    for (struct message_out *message; (message = queue_take_first(queue));)
        free(message);
}

void out_drop_frames(struct ws_connection *connection)
{
    for (int i = 0; connection->filled; i++) {
        if (connection->filled & 1u << i)
            frame_unref(connection->slots[i].frame);
        connection->filled &= ~(1u << i);
    }
}

void out_log_cut(struct ws *ws, const char *reason)
{
    int64_t now_us = clock_now_us();
    if (ws->logged_us && now_us - ws->logged_us < LOG_EVERY_US)
        return;
    ws->logged_us = now_us;
    log_warn("a WebSocket was closed: %s (others are not logged for %d s)", reason, LOG_EVERY_US / 1000000);
}

/* Cuts the connection after within_us; 0: as soon as the caller has returned to the loop. */
static void end_within(struct ws_connection *connection, int64_t within_us)
{
    connection->close_by_us = clock_now_us() + within_us;
    ws_check_at(connection, connection->close_by_us);
}

/* Something waits: out_flush sends it once the caller has returned to the loop. */
static void mark(struct ws_connection *connection)
{
    if (connection->is_marked)
        return;
    connection->is_marked = true;
    connection->next_marked = connection->ws->marked;
    connection->ws->marked = connection;
}

void out_unmark(struct ws_connection *connection)
{
    struct ws_connection **at = &connection->ws->marked;
    while (connection->is_marked && *at != connection)
        at = &(*at)->next_marked;
    if (connection->is_marked)
        *at = connection->next_marked;
    connection->is_marked = false;
}

void out_begin_close(struct ws_connection *connection, uint16_t code, const char *reason)
{
    uint8_t bytes[2 + WS_MAX_REASON] = { (uint8_t)(code >> 8), (uint8_t)code };
    size_t n_reason = reason ? strlen(reason) : 0;
    if (connection->state != STATE_OPEN)
        return;
    if (n_reason > WS_MAX_REASON)
        n_reason = 0;
    if (n_reason)
        memcpy(bytes + 2, reason, n_reason);
    connection->state = STATE_CLOSING;
    connection->close = out_message(WS_CLOSE, bytes, code == WS_CLOSE_NO_CODE ? 0 : 2 + n_reason);
    out_drop_frames(connection);
    end_within(connection, WS_CLOSE_WITHIN_S * INT64_C(1000000));
    mark(connection);
}

void out_add_pong(struct ws_connection *connection, const void *bytes, size_t n)
{
    if (connection->pongs.n >= WS_MAX_PONGS)
        free(queue_take_first(&connection->pongs));
    out_queue_add(&connection->pongs, out_message(WS_PONG, bytes, n));
    mark(connection);
}

void out_add_ping(struct ws_connection *connection)
{
    out_queue_add(&connection->pongs, out_message(WS_PING, NULL, 0));
    mark(connection);
}

/* The message, if it may wait on the connection beside what waits already; NULL: the connection is cut. */
static struct message_out *admit(struct ws_connection *connection, enum ws_opcode kind, const void *bytes, size_t n)
{
    const struct ws_limits *limits = &connection->ws->limits;
    const struct queue_out *texts = &connection->texts, *latest = &connection->latest;
    bool is_too_slow =
        texts->n + latest->n >= limits->max_waiting || texts->n_bytes + latest->n_bytes + n > limits->max_waiting_bytes;
    struct message_out *message = is_too_slow ? NULL : out_message(kind, bytes, n);
    if (!message) {
        out_log_cut(connection->ws, is_too_slow ? "it takes its messages too slowly" : "no memory for a message to it");
        connection->state = STATE_CLOSING; /* without a close: it would not read that either */
        out_drop_frames(connection);
        end_within(connection, 0);
    }
    return message;
}

void ws_send_message(struct ws_connection *connection, enum ws_opcode kind, const void *bytes, size_t n)
{
    struct message_out *message = connection->state == STATE_OPEN ? admit(connection, kind, bytes, n) : NULL;
    if (!message)
        return;
    out_queue_add(&connection->texts, message);
    mark(connection);
}

void ws_send_latest(struct ws_connection *connection, uint32_t key, const char *text)
{
    struct queue_out *queue = &connection->latest;
    struct message_out *message =
        connection->state == STATE_OPEN ? admit(connection, WS_TEXT, text, strlen(text)) : NULL;
    if (!message)
        return;
    message->key = key;
    struct message_out **at = &queue->first;
    while (*at && (*at)->key != key)
        at = &(*at)->next;
    if (*at) { /* the newer one takes the turn of the older one */
        struct message_out *old = *at;
        message->next = old->next;
        *at = message;
        if (queue->last == &old->next)
            queue->last = &message->next;
        queue->n_bytes += message->n - old->n;
        free(old);
    } else {
        out_queue_add(queue, message);
    }
    mark(connection);
}

void ws_send_text(struct ws_connection *connection, const char *text)
{
    ws_send_message(connection, WS_TEXT, text, strlen(text));
}

void ws_close(struct ws_connection *connection, enum ws_close_code code)
{
    out_begin_close(connection, (uint16_t)code, NULL);
}

void ws_bye(struct ws_connection *connection, enum ws_close_code code, const char *reason, int retry_ms)
{
    ws_bye_code(connection, code, "", reason, retry_ms);
}

void ws_bye_code(struct ws_connection *connection, enum ws_close_code code, const char *word, const char *reason,
                 int retry_ms)
{
    struct message message = { .type = MESSAGE_BYE, .bye = { .has_retry_ms = retry_ms >= 0, .retry_ms = retry_ms } };
    (void)snprintf(message.bye.reason, sizeof message.bye.reason, "%s", reason);
    (void)snprintf(message.bye.code, sizeof message.bye.code, "%s", word);
    char *text = message_write(&message);
    if (text) /* without memory for it the close alone is sent */
        ws_send_text(connection, text);
    free(text);
    out_begin_close(connection, (uint16_t)code, reason);
}

/* ---- sending ---------------------------------------------------------------------------------------------------- */

void ws_send_frame(struct ws_connection *connection, const struct frame_header *header, struct frame *frame)
{
    if (connection->state != STATE_OPEN || header->view < 1 || header->view > WS_SLOTS)
        return;
    struct frame_slot *slot = &connection->slots[header->view - 1];
    if (connection->filled & 1u << (header->view - 1))
        frame_unref(slot->frame);
    slot->frame = frame_ref(frame);
    connection->filled |= 1u << (header->view - 1);
    slot->n_head = ws_write_head(slot->head, WS_BINARY, FRAME_HEADER_BYTES + frame->n_bytes);
    frame_header_write(header, slot->head + slot->n_head);
    slot->n_head += FRAME_HEADER_BYTES;
    mark(connection);
}

static struct sending_part *add_part(struct sending *sending)
{
    struct sending_part *part = &sending->parts[sending->n++];
    part->message = NULL;
    part->frame = NULL;
    part->slot = NULL;
    part->is_latest = false;
    return part;
}

static void begin_message(struct sending *sending, struct message_out *message)
{
    struct sending_part *part = add_part(sending);
    part->message = message;
    part->body = message->bytes;
    part->n_body = message->n;
    part->head = part->own_head;
    part->n_head = ws_write_head(part->own_head, message->opcode, message->n);
}

static void begin_frame(struct ws_connection *connection, int at)
{
    struct frame_slot *slot = &connection->slots[at];
    struct sending_part *part = add_part(&connection->sending);
    part->frame = slot->frame;
    part->body = slot->frame->bytes;
    part->n_body = slot->frame->n_bytes;
    part->head = slot->head;
    part->n_head = slot->n_head;
    part->slot = slot;
    connection->filled &= ~(1u << at);
}

/* Pongs before messages, messages before the close. */
static struct message_out *take_message(struct ws_connection *connection)
{
    struct message_out *message = queue_take_first(&connection->pongs);
    if (!message)
        message = queue_take_first(&connection->texts);
    if (!message) {
        message = connection->close;
        connection->close = NULL;
    }
    return message;
}

/* Begins to send what is next: messages that go together, as long as they are short, and behind them one of the latest
 * texts or one frame, views in turn: more than one of those is not begun, as newer ones may replace them. The close
 * goes before these (closing drops them), and last. Returns false when nothing waits. */
static bool begin_next(struct ws_connection *connection)
{
    struct sending *sending = &connection->sending;
    size_t n_bytes = 0;
    while (sending->n < OUT_AT_ONCE && n_bytes < MOST_AT_ONCE) {
        struct message_out *message = take_message(connection);
        if (!message)
            break;
        n_bytes += message->n;
        begin_message(sending, message);
        if (message->opcode == WS_CLOSE)
            return true;
    }
    if (sending->n == OUT_AT_ONCE || n_bytes >= MOST_AT_ONCE)
        return true;
    struct message_out *latest = connection->state == STATE_OPEN ? queue_take_first(&connection->latest) : NULL;
    if (latest) {
        begin_message(sending, latest);
        sending->parts[sending->n - 1].is_latest = true;
        return true;
    }
    for (int i = 0; connection->filled && i < LAST_SLOT; i++) {
        int at = (connection->next_slot + i) % LAST_SLOT;
        if (!(connection->filled & 1u << at))
            continue;
        connection->next_slot = at + 1;
        begin_frame(connection, at);
        return true;
    }
    if (connection->filled)
        begin_frame(connection, LAST_SLOT);
    return sending->n > 0;
}

/* The socket takes nothing now: what newer ones may replace waits again. To be called before anything is queued. */
static void put_back(struct ws_connection *connection)
{
    struct sending *sending = &connection->sending;
    struct sending_part *last = &sending->parts[sending->n - 1];
    struct queue_out *latest = &connection->latest;
    if (last->slot) {
        last->slot->frame = last->frame;
        connection->next_slot = (int)(last->slot - connection->slots);
        connection->filled |= 1u << connection->next_slot;
        sending->n--;
    } else if (last->is_latest) {
        last->message->next = latest->first;
        if (!latest->first)
            latest->last = &last->message->next;
        latest->first = last->message;
        latest->n++;
        latest->n_bytes += last->message->n;
        sending->n--;
    }
}

static bool is_sending(const struct ws_connection *connection)
{
    return connection->sending.n > 0;
}

static bool has_more(const struct ws_connection *connection)
{
    return is_sending(connection) || connection->pongs.first || connection->texts.first || connection->close ||
           connection->filled || (connection->state == STATE_OPEN && connection->latest.first);
}

void out_drop_sending(struct ws_connection *connection)
{
    struct sending *sending = &connection->sending;
    for (int i = 0; i < sending->n; i++) {
        free(sending->parts[i].message);
        frame_unref(sending->parts[i].frame);
    }
    sending->n = 0;
    sending->n_done = 0;
}

static void finish_sending(struct ws_connection *connection)
{
    const struct message_out *last = connection->sending.parts[connection->sending.n - 1].message;
    if (last && last->opcode == WS_CLOSE) { /* RFC 6455 7.1.1: nothing more is sent; the client closes its direction */
        connection->state = STATE_LINGERING;
        (void)shutdown(connection->socket.fd, SHUT_WR);
        end_within(connection, WS_LINGER_MS * INT64_C(1000));
    }
    out_drop_sending(connection);
}

/* The frame is partly sent, and a newer one may come into its slot. */
static void keep_head(struct sending_part *part)
{
    if (part->head == part->own_head)
        return;
    memcpy(part->own_head, part->head, part->n_head);
    part->head = part->own_head;
}

enum sent { SENT_ALL, SENT_PART, SENT_FAILED };

static enum sent send_some(struct ws_connection *connection)
{
    struct sending *sending = &connection->sending;
    struct iovec pieces[2 * OUT_AT_ONCE];
    size_t n_left = 0, n_skipped = sending->n_done;
    int n_pieces = 0;
    for (int i = 0; i < 2 * sending->n; i++) {
        struct sending_part *part = &sending->parts[i / 2];
        const uint8_t *bytes = i % 2 ? part->body : part->head;
        size_t n = i % 2 ? part->n_body : part->n_head, n_skip = n_skipped < n ? n_skipped : n;
        n_skipped -= n_skip;
        if (n > n_skip)
            pieces[n_pieces++] = (struct iovec){ (uint8_t *)(uintptr_t)bytes + n_skip, n - n_skip };
        n_left += n - n_skip;
    }
    struct msghdr header = { .msg_iov = pieces, .msg_iovlen = (size_t)n_pieces };
    ssize_t n = sendmsg(connection->socket.fd, &header, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (n < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR && errno != ENOBUFS)
        return SENT_FAILED;
    if (n < 0) {
        if (sending->n_done == 0)
            put_back(connection);
        return SENT_PART;
    }
    sending->n_done += (size_t)n;
    if ((size_t)n < n_left) {
        keep_head(&sending->parts[sending->n - 1]);
        return SENT_PART;
    }
    finish_sending(connection);
    return SENT_ALL;
}

static void ask_room(struct ws_connection *connection)
{
    if (!connection->is_asking)
        sockets_ask_room(&connection->socket);
    connection->is_asking = true;
}

int out_write(struct ws_connection *connection)
{
    const bool may_send = connection->state == STATE_OPEN || connection->state == STATE_CLOSING;
    if (may_send && (is_sending(connection) || begin_next(connection)) && send_some(connection) == SENT_FAILED)
        return -1;
    if (may_send && has_more(connection))
        ask_room(connection);
    return 0;
}

static void flush(struct ws_connection *connection)
{
    if (connection->is_asking || connection->state == STATE_NONE || connection->state == STATE_LINGERING ||
        !has_more(connection))
        return;
    if (out_write(connection) == 0)
        return;
    connection->state = STATE_CLOSING; /* the client has gone: its timer ends it */
    out_drop_frames(connection);
    out_drop_sending(connection);
    end_within(connection, 0);
}

void out_flush(struct ws *ws)
{
    while (ws->marked) {
        struct ws_connection *connection = ws->marked;
        ws->marked = connection->next_marked;
        connection->is_marked = false;
        flush(connection);
    }
}

int out_answer_now(struct ws_connection *connection)
{
    while ((connection->state == STATE_OPEN && connection->pongs.first) || connection->state == STATE_CLOSING) {
        if (!is_sending(connection) && !begin_next(connection))
            return 0; /* cut as too slow: its timer ends it */
        enum sent sent = send_some(connection);
        if (sent == SENT_FAILED)
            return -1;
        if (sent == SENT_PART)
            break;
    }
    return 0;
}
