#pragma once
/* What the files of this folder share; nobody else includes it.
 *   parser.c   bytes of a client to messages
 *   ws.c       the loop; handshakes; what comes in, and its limits
 *   out.c      what goes out in which order, and how a connection ends */
#include <libwebsockets.h>

#include "server/ws/ws.h"

struct message_out { /* a message, ping, pong or close that waits to go out */
    struct message_out *next;
    enum ws_opcode opcode;
    size_t n;
    uint8_t bytes[];
};

struct queue_out {
    struct message_out *first, **last;
    size_t n, n_bytes;
};

struct box { /* the newest frame of a view */
    uint8_t header[FRAME_HEADER_BYTES];
    struct room_picture *picture; /* NULL: empty */
};

struct sending { /* what is partly in the kernel: nothing else may go before its rest */
    uint8_t head[10 + FRAME_HEADER_BYTES];
    size_t n_head, n_done; /* n_done: bytes of head and body that are sent */
    const uint8_t *body;
    size_t n_body;
    struct message_out *message;  /* whose body it is, */
    struct room_picture *picture; /* or whose; both NULL: nothing is being sent */
};

enum state {
    STATE_NONE, /* not open yet, or closed() has been told */
    STATE_OPEN,
    STATE_CLOSING,  /* what comes is dropped; what waits, then the close, goes out */
    STATE_LINGERING /* the close is out; the client's end is waited for */
};

struct ws_connection { /* zeroed by the library, lives with its socket */
    struct ws *ws;
    struct lws *wsi;
    void *owner;
    struct ws_count count;
    enum state state;
    int64_t opened_us, heard_us, close_by_us;
    struct ws_parser parser;
    struct rate messages, controls, bytes;
    size_t n_dropped;
    struct queue_out pongs, texts;
    struct message_out *close; /* goes after them */
    struct box boxes[ROOM_MAX_VIEWS];
    int next_box;
    struct sending sending;
};

struct ws {
    struct lws_context *context;
    struct lws_vhost *vhost;
    struct lws_protocols protocols[2];
    struct ws_callbacks callbacks;
    struct ws_limits limits;
    char *allowed_origin;
    lws_sorted_usec_list_t timer;
    int64_t logged_us;
    struct ws_counters counters;
};

/* out.c */
/* Small ones abort without memory, as mem_new; larger than OUT_SMALL_BYTES: NULL. */
enum { OUT_SMALL_BYTES = 4096 };
struct message_out *out_message(enum ws_opcode opcode, const void *bytes, size_t n);
void out_queue_add(struct queue_out *queue, struct message_out *message);
void out_queue_clear(struct queue_out *queue);
void out_add_pong(struct ws_connection *connection, const void *bytes,
                  size_t n); /* the oldest is left out where too many wait */
/* One thing, as the kernel takes it; the loop calls it again when it takes more. Not 0: the connection is to be cut. */
int out_write(struct ws_connection *connection);
/* Pongs and closes go out before more is read: a client may end its side right after asking. Not 0: the connection is
 * to be cut. */
int out_answer_now(struct ws_connection *connection);
/* What waits is still sent, and then a close with this code and reason (NULL: none); what comes from here on is
 * dropped. */
void out_begin_close(struct ws_connection *connection, uint16_t code, const char *reason);
void out_drop_frames(struct ws_connection *connection);
void out_log_cut(struct ws *ws,
                 const char *reason); /* a line at times: who connects again and again does not fill the log */
