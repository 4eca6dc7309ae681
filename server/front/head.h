#pragma once
/* Parses the head of a request before a library does: whether it is HTTP or a WebSocket handshake, where its body ends,
 * or why it is refused. What the libraries would refuse in their own words is refused here, as a problem. Knows no
 * sockets. */
#include <stdint.h>

#include "server/front/hosts.h"
#include "server/wire/handshake.h"
#include "server/wire/problem.h"

enum {
    HEAD_MAX_BYTES = 32 << 10,     /* request line, headers and the empty line */
    HEAD_MAX_LINE = 24 << 10,      /* of these, the request line */
    HEAD_MAX_WEBSOCKET = 12 << 10, /* a whole WebSocket handshake */
    HEAD_MAX_FIELDS = 100,
    HEAD_MAX_PARAMETERS = 100, /* of the address's query */
    HEAD_MAX_EMPTY = 8,        /* empty lines before the request line, which are ignored */
    HEAD_MAX_GROUPS = 4 << 10, /* of the header with the groups that somebody is in */
    HEAD_MAX_SECRET = 16 << 10 /* of Cookie and of Authorization; a ticket of Kerberos takes some thousand */
};

enum head_kind {
    HEAD_INCOMPLETE, /* the head is not whole yet */
    HEAD_HTTP,
    HEAD_WEBSOCKET, /* a whole handshake for /api/v1/rooms/{id}/ws */
    HEAD_REFUSED    /* problem says why */
};

struct head_text { /* a piece of the head, borrowed from its bytes; at NULL: there is none */
    const char *at;
    size_t n;
};

/* Headers by which the proxy in front says who makes a request. */
enum head_identity { HEAD_USER, HEAD_NAME, HEAD_GROUPS, HEAD_AUTH_TIME, HEAD_N_IDENTITY };
extern const char *const head_identity_names[HEAD_N_IDENTITY]; /* unless a site has others */

/* True for a name that a site may have for one of them. */
bool head_may_be_identity(const char *name);

/* The daemon's rules for heads on one connection. */
struct head_rules {
    const struct hosts *hosts;         /* names of this server; a request to another host is refused */
    const char *const *identity_names; /* HEAD_N_IDENTITY of them */
    bool takes_identity; /* the connection is the proxy's, and people sign in there; else these headers are refused */
};

/* A whole head. */
struct head_request {
    size_t n_bytes;             /* bytes of the head, with the empty lines before it */
    bool is_chunked;            /* the body has chunks */
    uint64_t length;            /* of a body without chunks; 0: no body */
    struct head_text forwarded; /* value of the last X-Forwarded-For */
    struct head_text cookie, authorization, identity[HEAD_N_IDENTITY];
    struct handshake handshake; /* HEAD_WEBSOCKET; without the client's address and identity */
};

/* bytes: all that has come so far. */
NODISCARD enum head_kind head_look(const char *bytes, size_t n, const struct head_rules *rules,
                                   struct problem *problem);
/* Like head_look; fills in request when the head is whole and not refused. */
NODISCARD enum head_kind head_read(const char *bytes, size_t n, const struct head_rules *rules,
                                   struct head_request *request, struct problem *problem);
/* The problem of a head that is not whole: its sender has ended, or its time is over. */
void head_refuse_incomplete(const char *bytes, size_t n, bool has_ended, int waited_ms, struct problem *problem);
