#pragma once
/* The messages that wait to be sent on a connection, their order, and how a connection is closed. Internal to
 * server/ws; net thread. */
#include "server/ws/ws_state.h"

/* A copy of the bytes as a message; the queue or the connection frees it. Without memory, messages up to
 * OUT_SMALL_BYTES abort, like mem_new; larger ones are NULL. */
enum { OUT_SMALL_BYTES = 4096 };
struct message_out *out_message(enum ws_opcode opcode, const void *bytes, size_t n);
void out_queue_add(struct queue_out *queue, struct message_out *message); /* takes message */
void out_queue_clear(struct queue_out *queue);
/* Queues a pong; the oldest is dropped when WS_MAX_PONGS wait. */
void out_add_pong(struct ws_connection *connection, const void *bytes, size_t n);
/* Sends what waits on the connections that were given something since the last call, all of one in one go. */
void out_flush(struct ws *ws);
void out_unmark(struct ws_connection *connection); /* before it is freed */
void out_drop_sending(struct ws_connection *connection);
/* Adds a ping. */
void out_add_ping(struct ws_connection *connection);
/* Sends what the socket takes; called again when it takes more. Returns non-zero when the connection is to be cut. */
int out_write(struct ws_connection *connection);
/* Sends pongs and a close at once: a client may close its direction right after sending. Returns non-zero when the
 * connection is to be cut. */
int out_answer_now(struct ws_connection *connection);
/* Begins to close: waiting messages are still sent, then a close with this code and reason (NULL: none). Bytes received
 * from now on are dropped. */
void out_begin_close(struct ws_connection *connection, uint16_t code, const char *reason);
void out_drop_frames(struct ws_connection *connection);
/* Logs that a connection was cut, at most every 10 s: clients that reconnect again and again must not fill the log. */
void out_log_cut(struct ws *ws, const char *reason);
