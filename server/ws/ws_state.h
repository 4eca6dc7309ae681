#pragma once
/* The state of the WebSocket side and of its connections, shared by the files of server/ws. Internal to server/ws; net
 * thread. */
#include "server/ws/loop.h"
#include "server/ws/ws.h"

enum {
    WS_UNSENT_AT_MOST = 32 << 10, /* bytes left in the kernel's buffer when it takes more */
    WS_READ_AT_ONCE = 32 << 10
};

struct message_out { /* a message, ping, pong or close that waits to be sent */
    struct message_out *next;
    enum ws_opcode opcode;
    uint32_t key; /* of latest */
    size_t n;
    uint8_t bytes[];
};

struct queue_out {
    struct message_out *first, **last;
    size_t n, n_bytes;
};

struct frame_slot { /* the newest frame of a view, not begun to be sent */
    uint8_t header[FRAME_HEADER_BYTES];
    struct frame *frame; /* NULL: empty */
};

enum { OUT_AT_ONCE = 4 }; /* messages that one call sends */

struct sending_part {
    uint8_t head[10 + FRAME_HEADER_BYTES];
    size_t n_head;
    const uint8_t *body;
    size_t n_body;
    struct message_out *message; /* owner of the body, ... */
    struct frame *frame;         /* ... or this one */
    struct frame_slot *slot;     /* where the frame waited; NULL: it is a message */
    bool is_latest;              /* the message waited in latest */
};

struct sending { /* messages that are partly sent: nothing else may be sent before their rest */
    struct sending_part parts[OUT_AT_ONCE];
    int n;         /* 0: nothing is being sent */
    size_t n_done; /* bytes of heads and bodies that were sent */
};

enum state {
    STATE_NONE, /* not open yet, or reported as closed */
    STATE_OPEN,
    STATE_CLOSING,  /* received bytes are dropped; waiting messages are sent, then the close */
    STATE_LINGERING /* the close was sent; waits for the client to close */
};

struct ws_connection { /* lives as long as its socket */
    struct ws *ws;
    struct ws_connection *next, *previous;
    int fd;
    void *owner;
    char client[46]; /* as in struct handshake */
    struct ws_count count;
    enum state state;
    int64_t opened_us, heard_us, close_by_us;
    int64_t check_us; /* when it could be late next */
    struct ws_parser parser;
    struct rate messages, controls, bytes;
    size_t n_dropped;
    struct queue_out pongs, texts, latest; /* latest: at most one message of each key */
    struct message_out *close;             /* sent after pongs and texts, instead of latest */
    struct frame_slot slots[WS_SLOTS];
    int next_slot;
    struct sending sending;
    bool is_armed;  /* out_write is called when the socket takes more */
    bool is_marked; /* it is in the list of those that have something to send */
    struct ws_connection *next_marked;
};

struct ws {
    struct loop loop;
    struct ws_callbacks callbacks;
    struct ws_limits limits;
    char *allowed_origin;
    int64_t timer_us;                  /* when timer_fired is called; INT64_MAX: never */
    struct ws_connection *connections; /* all of them */
    int64_t check_us;                  /* not after the earliest check_us of a connection */
    struct ws_connection *marked;      /* out_flush sends what waits on these */
    int64_t logged_us;
    struct ws_counters counters;
    uint8_t received[WS_READ_AT_ONCE];
};

/* Has the connection looked at at this time, which replaces the last one. */
static inline void ws_check_at(struct ws_connection *connection, int64_t time_us)
{
    connection->check_us = time_us;
    if (time_us < connection->ws->check_us)
        connection->ws->check_us = time_us;
}
