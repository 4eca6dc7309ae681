#pragma once
/* WebSocket connections on sockets handed over by the acceptor: answer to the handshake, Origin, limits, what goes out
 * in which order, and how a connection ends. RFC 6455 is spoken here (parser.h reads it); libwebsockets gives the loop,
 * its timers and the wake-up, and watches the sockets. The only folder with that library. Knows messages, frames and
 * the id of a room; nothing of what is said in one. One thread (the net thread) but for ws_wake. */
#include <stdint.h>

#include "server/room/room.h"
#include "server/wire/handshake.h"
#include "server/ws/parser.h"
#include "server/ws/rate.h"

enum {
    WS_HELLO_WITHIN_S = 5,
    WS_PING_AFTER_S = 10,     /* of silence: a browser answers by itself, also from a tab in the background */
    WS_SILENT_AT_MOST_S = 30, /* then closed */
    WS_CLOSE_WITHIN_S = 2,    /* for the last words and the close to get out */
    WS_LINGER_MS = 1000,      /* after the close: for the client to end its side */
    WS_MAX_DROPPED = 1 << 20, /* bytes that are read and dropped meanwhile */
    WS_MAX_PONGS = 32,        /* waiting for one connection; the oldest is then left out, as RFC 6455 5.5.3 allows */
    WS_MAX_CONNECTIONS = 2000,
    WS_MAX_HEAD = 16 << 10, /* of a handshake; the acceptor lets less through */
    WS_RETRY_MS = 5000,     /* when a client comes back that was over a limit, or met too many others */
};

/* Of one connection. A page sends at most two messages for each picture of each of its views: 8 views at 60 pictures a
 * second are 960. */
struct ws_limits {
    size_t max_message_bytes;
    bool takes_binary;                     /* false: a binary message closes with 1003 */
    struct rate_limit messages,            /* whole ones */
        controls,                          /* pings, pongs */
        bytes;                             /* all that comes */
    size_t max_waiting, max_waiting_bytes; /* messages that wait to go out; more: closed as too slow */
};
extern const struct ws_limits ws_limits_default;

struct ws;
struct ws_connection;

struct ws_callbacks {
    bool (*has_room)(void *context, const char *room_id); /* false: 404 */
    void (*opened)(void *context, struct ws_connection *connection, const char *room_id);
    /* Whole, at most limits.max_message_bytes; a text is UTF-8. Good for the length of the call. */
    void (*message_came)(void *context, struct ws_connection *connection, enum ws_opcode kind, const char *bytes,
                         size_t n);
    bool (*is_greeted)(void *context, struct ws_connection *connection); /* has said hello */
    void (*closed)(void *context, struct ws_connection *connection); /* once for each opened; not valid afterwards */
    void (*woken)(void *context);                                    /* after ws_wake */
    void (*time_came)(void *context);                                /* after ws_wake_at */
    void *context;
};

/* Of a connection that the caller counts: called once, when it is gone, also when it never became a WebSocket. ended
 * NULL: nobody counts. */
struct ws_count {
    void (*ended)(void *context);
    void *context;
};

struct ws_counters {
    uint64_t opened, refused; /* refused: no such room, foreign Origin, too many, stopping */
    size_t n_connections;
};

/* allowed_origin: a further Origin besides the request's own Host; may be NULL. errors ERROR_IO */
NODISCARD struct ws *ws_create(const struct ws_callbacks *callbacks, const struct ws_limits *limits,
                               const char *allowed_origin, struct error *err);
void ws_destroy(struct ws *ws);                  /* cuts every connection */
void ws_serve(struct ws *ws);                    /* waits for something to happen and handles it */
void ws_wake(struct ws *ws);                     /* any thread: ends the wait */
void ws_wake_at(struct ws *ws, int64_t time_us); /* on the clock of clock_now_us; replaces the last; INT64_MAX: never */
/* Takes the socket, from which nobody has read; handshake: what it begins with. */
void ws_adopt(struct ws *ws, int socket, const struct handshake *handshake, const struct ws_count *count);
void ws_refuse_as_stopping(struct ws *ws, int socket); /* takes it */
void ws_count(const struct ws *ws, struct ws_counters *counters);

void ws_set_owner(struct ws_connection *connection, void *owner); /* a pointer to find again */
void *ws_owner(const struct ws_connection *connection);
void ws_send_text(struct ws_connection *connection, const char *text);
void ws_send_message(struct ws_connection *connection, enum ws_opcode kind, const void *bytes, size_t n);
/* A frame that has not gone out yet is replaced by a newer one of the same view. */
void ws_send_frame(struct ws_connection *connection, const struct frame_header *header, struct room_picture *picture);
void ws_close(struct ws_connection *connection, enum ws_close_code code); /* after the messages that wait */
/* Says so in a bye and closes; retry_ms < 0: for good */
void ws_bye(struct ws_connection *connection, enum ws_close_code code, const char *reason, int retry_ms);
