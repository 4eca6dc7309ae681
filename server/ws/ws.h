#pragma once
/* WebSocket connections on sockets handed over by the acceptor: handshake, Origin, fragments, limits, what goes out in which order.
 * The only folder with libwebsockets. Knows text, frames and the address of a room; nothing of what is said in one. One thread (the
 * net thread) but for ws_wake. */
#include <stdint.h>

#include "server/room/room.h"

enum {
    WS_HELLO_WITHIN_S = 5,
    WS_PING_AFTER_S = 10,      /* of silence: a browser answers by itself, also from a tab in the background */
    WS_SILENT_AT_MOST_S = 30,  /* then closed */
    WS_CLOSE_WITHIN_S = 2,     /* for the last words to get out */
    WS_MAX_TEXTS = 256,        /* waiting for one connection; more: closed as too slow */
    WS_MAX_TEXT_BYTES = 4 << 20,
    WS_MAX_CONNECTIONS = 2000,
    WS_MAX_HEAD = 16 << 10,    /* of a handshake; the acceptor lets less through */
    WS_RETRY_MS = 5000,
};

struct ws;
struct ws_connection;

struct ws_callbacks {
    bool (*has_room)(void *context, const char *room_id); /* false: 404 */
    void (*opened)(void *context, struct ws_connection *connection, const char *room_id);
    void (*text_came)(void *context, struct ws_connection *connection, const char *text, size_t n); /* whole, at most WIRE_MAX_CLIENT_BYTES */
    bool (*is_greeted)(void *context, struct ws_connection *connection); /* has said hello */
    void (*closed)(void *context, struct ws_connection *connection);     /* once for each opened; not valid afterwards */
    void (*woken)(void *context);                                        /* after ws_wake */
    void (*time_came)(void *context);                                    /* after ws_wake_at */
    void *context;
};

struct ws_counters {
    uint64_t opened, refused; /* refused: no such room, foreign Origin, not a WebSocket */
    size_t n_connections;
};

/* allowed_origin: a further Origin besides the request's own Host; may be NULL. errors ERROR_IO */
NODISCARD struct ws *ws_create(const struct ws_callbacks *callbacks, const char *allowed_origin, struct error *err);
void ws_destroy(struct ws *ws); /* closes every connection */
void ws_serve(struct ws *ws);   /* waits for something to happen and handles it */
void ws_wake(struct ws *ws);    /* any thread: ends the wait */
void ws_wake_at(struct ws *ws, int64_t time_us); /* on the clock of clock_now_us; replaces the last; INT64_MAX: never */
void ws_adopt(struct ws *ws, int socket);        /* takes it; it begins with an upgrade request that nobody read from */
void ws_count(const struct ws *ws, struct ws_counters *counters);

void ws_set_owner(struct ws_connection *connection, void *owner); /* a pointer to find again */
void *ws_owner(const struct ws_connection *connection);
void ws_send_text(struct ws_connection *connection, const char *text);
/* A frame that has not gone out yet is replaced by a newer one of the same view. */
void ws_send_frame(struct ws_connection *connection, const struct frame_header *header, struct room_picture *picture);
void ws_close(struct ws_connection *connection); /* after the texts that wait */
void ws_bye(struct ws_connection *connection, const char *reason, int retry_ms); /* says so and closes; retry_ms < 0: for good */
