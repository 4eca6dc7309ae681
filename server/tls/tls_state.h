#pragma once
/* The state of TLS and of its links (one link per client connection). Internal to server/tls; its thread, or after it
 * has ended. */
#include <ev.h>
#include <libwebsockets.h>
#include <pthread.h>
#include <stdatomic.h>

#include "server/tls/certificate.h"
#include "server/tls/tls.h"

enum {
    TLS_READ_AT_ONCE = 32 << 10, /* at least a record, so that the library keeps none back */
    TLS_SEND_AT_ONCE = 64 << 10,
};

enum tls_stage {
    TLS_SILENT,    /* the client has sent nothing; the library does not have the socket */
    TLS_HANDSHAKE, /* until the first decrypted byte */
    TLS_OPEN,      /* bytes are passed on both ways */
    TLS_ENDING,    /* the server has ended its stream: last bytes are passed on */
    TLS_LEFT       /* the client has ended: its last bytes are passed on; the library has closed the socket */
};

struct tls_link {
    struct tls_link *next, *previous;
    struct tls *tls;
    enum tls_stage stage;
    struct address peer;
    int client;                /* the client's socket; the library owns it when it has it */
    int pair;                  /* our end of the pair; -1: there is none yet */
    struct lws *lws;           /* the library's; NULL: it does not have the socket */
    struct ev_io down, up;     /* pair: bytes for the client; room for bytes of the client */
    char *to_client, *to_pair; /* bytes that were not taken; NULL: none */
    size_t n_to_client, n_to_pair;
    bool is_pair_gone; /* the other end takes no bytes any more */
    bool is_told;      /* the client was told of the end */
    int64_t late_us;   /* TLS_SILENT, TLS_HANDSHAKE, TLS_ENDING, TLS_LEFT: when the link is ended at the latest */
};

struct tls {
    struct tls_options options;
    struct lws_protocols protocols[2];
    struct ev_loop *loop;
    struct lws_context *context;
    struct lws_vhost *vhost;
    int n_places;                          /* descriptors below have one in the library's table */
    struct ssl_ctx_st *ssl_ctx;            /* the vhost's */
    struct certificate *certificate;       /* of connections that begin */
    _Atomic(struct certificate *) renewed; /* by tls_reload, for the thread */
    struct queue *accepted;                /* from tls_accept */
    struct gate *taking;                   /* passed by each call of take and take_plain; closed by tls_close */
    struct ev_async woken;
    /* An epoll of its own watches the sockets of links in TLS_SILENT, and libev this epoll: libev goes on watching a
     * socket that it was told to leave, until it is closed, while others may own this one by then. */
    int silent;
    struct ev_io heard;
    struct ev_timer tick; /* runs while links may be late */
    pthread_t thread;
    bool has_thread;
    atomic_bool is_closed, is_stopping;
    _Atomic(atomic_bool *) pinged;
    atomic_size_t n_links, n_waiting, n_ending; /* written by the thread */
    struct tls_link *links;
    int64_t stop_us; /* is_stopping: when the thread ends at the latest; 0: not seen yet */
    char bytes[TLS_SEND_AT_ONCE];
};
