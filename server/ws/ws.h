#pragma once
/* WebSocket connections on sockets from the front: the answer to the handshake, Origin, limits, the order of what is
 * sent, and how a connection ends. RFC 6455 is implemented here (parser.h); the sockets are libwebsockets' (sockets.h).
 * Knows messages, frames and the ids of rooms, but neither rooms nor the messages' contents. Net thread, but for
 * ws_wake. */
#include <stdint.h>

#include "server/wire/frame.h"
#include "server/wire/handshake.h"
#include "server/ws/parser.h"
#include "server/ws/rate.h"

enum {
    WS_HELLO_WITHIN_S = 5,
    WS_PING_AFTER_S = 5,      /* of silence; a browser answers pings by itself, also for a tab in the background */
    WS_SILENT_AT_MOST_S = 15, /* of silence, then closed: a laptop that was shut says nothing */
    WS_CLOSE_WITHIN_S = 2,    /* for waiting messages and the close to be sent */
    WS_LINGER_MS = 1000,      /* after the close, for the client to close its direction */
    WS_MAX_DROPPED = 1 << 20, /* bytes read and dropped meanwhile */
    WS_MAX_PONGS = 32,        /* waiting on one connection; beyond, the oldest is dropped, as RFC 6455 5.5.3 allows */
    WS_MAX_CONNECTIONS = 2000,
    WS_MAX_HEAD = 16 << 10, /* bytes of a handshake; the limit of server/front is lower */
    WS_RETRY_MS = 5000,     /* told to clients that are refused for a limit */
    WS_SLOTS = 9,           /* views of one connection that frames are sent of */
};

/* Limits of one connection. A page sends at most two messages for each picture of each of its views: 8 views at 60
 * pictures a second make 960. */
struct ws_limits {
    size_t max_message_bytes;
    bool takes_binary;                     /* false: a binary message closes with 1003 */
    struct rate_limit messages,            /* whole messages */
        controls,                          /* pings, pongs */
        bytes;                             /* all bytes received */
    size_t max_waiting, max_waiting_bytes; /* waiting to be sent; beyond, closed as too slow */
};
extern const struct ws_limits ws_limits_default;

struct ws;
struct ws_connection;

struct ws_callbacks {
    bool (*has_room)(void *context, const struct handshake *handshake); /* false: 404 */
    void (*opened)(void *context, struct ws_connection *connection, const struct handshake *handshake);
    /* A whole message of at most limits.max_message_bytes; a text is UTF-8. Borrowed for the call. */
    void (*message_received)(void *context, struct ws_connection *connection, enum ws_opcode kind, const char *bytes,
                             size_t n);
    bool (*is_greeted)(void *context, struct ws_connection *connection); /* true: it has said hello */
    void (*closed)(void *context,
                   struct ws_connection *connection); /* once for each opened; the connection is invalid afterwards */
    void (*woken)(void *context);                     /* after ws_wake */
    void (*timer_fired)(void *context);               /* after ws_wake_at */
    void *context;
};

/* For a caller that counts connections: ended is called once when the connection is gone, also when it never became a
 * WebSocket. ended NULL: not called. */
struct ws_count {
    void (*ended)(void *context);
    void *context;
};

struct ws_counters {
    uint64_t opened, refused; /* refused: no such room, another Origin, too many, stopping */
    size_t n_connections;
};

/* allowed_origin: a further Origin besides the request's own Host; may be NULL. errors ERROR_IO */
NODISCARD struct ws *ws_create(const struct ws_callbacks *callbacks, const struct ws_limits *limits,
                               const char *allowed_origin, struct error *err);
void ws_destroy(struct ws *ws);                  /* cuts every connection without a close */
void ws_serve(struct ws *ws);                    /* waits for events and handles them */
void ws_wake(struct ws *ws);                     /* any thread: ends ws_serve's wait */
void ws_wake_at(struct ws *ws, int64_t time_us); /* on clock_now_us; replaces the last time; INT64_MAX: never */
/* Takes the socket, of which nothing was read; handshake: the head it begins with. */
void ws_adopt(struct ws *ws, int socket, const struct handshake *handshake, const struct ws_count *count);
void ws_refuse_as_stopping(struct ws *ws, int socket); /* takes the socket */
void ws_count(const struct ws *ws, struct ws_counters *counters);

void ws_set_owner(struct ws_connection *connection, void *owner); /* a pointer of the caller's */
void *ws_owner(const struct ws_connection *connection);
const char *ws_client(const struct ws_connection *connection); /* its address; "": not known */
int64_t ws_heard_us(const struct ws_connection *connection);   /* when bytes came from the client, at last */
void ws_send_text(struct ws_connection *connection, const char *text);
/* Replaces a waiting text with the same key of which nothing was sent. Texts of ws_send_text go first. */
void ws_send_latest(struct ws_connection *connection, uint32_t key, const char *text);
void ws_send_message(struct ws_connection *connection, enum ws_opcode kind, const void *bytes, size_t n);
/* Replaces a waiting frame of the same view (1 to WS_SLOTS) of which nothing was sent. Views take turns, but for the
 * last one, whose frame goes only when no other waits. header goes before the frame's bytes, in place of its own. */
void ws_send_frame(struct ws_connection *connection, const struct frame_header *header, struct frame *frame);
void ws_close(struct ws_connection *connection, enum ws_close_code code); /* sends waiting messages first */
/* Sends a bye with the reason, and closes; retry_ms < 0: the page is not to come back. */
void ws_bye(struct ws_connection *connection, enum ws_close_code code, const char *reason, int retry_ms);
/* Likewise; word: code of the message bye. */
void ws_bye_code(struct ws_connection *connection, enum ws_close_code code, const char *word, const char *reason,
                 int retry_ms);
