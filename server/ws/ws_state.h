#pragma once
/* The state of the WebSocket side and of its connections, shared by the files of server/ws. Internal to server/ws; net
 * thread. */
#include "server/ws/sockets.h"
#include "server/ws/ws.h"

enum { WS_UNSENT_AT_MOST = 32 << 10 /* bytes left in the kernel's buffer when it takes more */ };

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

enum { OUT_MAX_HEAD = 10 + FRAME_HEADER_BYTES };

struct frame_slot {      /* the newest frame of a view, not begun to be sent */
    struct frame *frame; /* set where filled has its bit */
    size_t n_head;
    uint8_t head[OUT_MAX_HEAD]; /* what is sent before the frame's bytes */
};

enum { OUT_AT_ONCE = 4 }; /* messages that one call sends */

struct sending_part {
    const uint8_t *head, *body;
    size_t n_head, n_body;
    struct message_out *message;    /* owner of the body, ... */
    struct frame *frame;            /* ... or this one */
    struct frame_slot *slot;        /* where the frame waited; NULL: it is a message */
    bool is_latest;                 /* the message waited in latest */
    uint8_t own_head[OUT_MAX_HEAD]; /* of a message, or of a frame that is partly sent: its slot may be filled anew */
};

struct sending {   /* messages that are partly sent: nothing else may be sent before their rest */
    int n;         /* 0: nothing is being sent */
    size_t n_done; /* bytes of heads and bodies that were sent */
    struct sending_part parts[OUT_AT_ONCE];
};

enum state {
    STATE_NONE, /* not open yet, or reported as closed */
    STATE_OPEN,
    STATE_CLOSING,  /* received bytes are dropped; waiting messages are sent, then the close */
    STATE_LINGERING /* the close was sent; waits for the client to close */
};

struct ws_connection { /* lives as long as its socket */
    /* Fields that a frame and its acknowledgement touch stand together: with hundreds of connections, few of them are
     * in the processor's cache. */
    struct socket socket; /* the first member: sockets.h hands it back */
    struct ws *ws;
    void *owner;
    struct ws_connection *next_marked;
    enum state state;
    unsigned filled; /* a bit for each slot that has a frame */
    int next_slot;
    bool is_asking;                        /* out_write is called when the socket takes more */
    bool is_marked;                        /* it is in the list of those that have something to send */
    struct message_out *close;             /* sent after pongs and texts, instead of latest */
    struct queue_out pongs, texts, latest; /* latest: at most one message of each key */
    struct sending sending;
    struct rate messages, controls, bytes;
    int64_t heard_us;
    struct ws_parser parser;
    struct frame_slot slots[WS_SLOTS];

    struct ws_connection *next, *previous;
    char client[46]; /* as in struct handshake */
    struct ws_count count;
    int64_t opened_us, close_by_us;
    int64_t check_us; /* when it could be late next */
    size_t n_dropped;
};

struct ws {
    struct sockets *sockets;
    struct ws_callbacks callbacks;
    struct ws_limits limits;
    char *allowed_origin;
    int64_t turn_us;                   /* about now: when something was received first in this turn; 0: not yet */
    int64_t timer_us;                  /* when timer_fired is called; INT64_MAX: never */
    struct ws_connection *connections; /* all of them */
    int64_t check_us;                  /* not after the earliest check_us of a connection */
    struct ws_connection *marked;      /* out_flush sends what waits on these */
    int64_t logged_us;
    struct ws_counters counters;
};

/* Has the connection looked at at this time, which replaces the last one. */
static inline void ws_check_at(struct ws_connection *connection, int64_t time_us)
{
    connection->check_us = time_us;
    if (time_us < connection->ws->check_us)
        connection->ws->check_us = time_us;
}
