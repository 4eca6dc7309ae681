#pragma once
/* The head of a request, before a library reads it: who is to have the connection, where the request ends, or why it is
 * refused. What the libraries behind would refuse in words of their own is refused here, as a problem. Knows no
 * sockets. */
#include <stdint.h>

#include "server/http/hosts.h"
#include "server/wire/handshake.h"
#include "server/wire/problem.h"

enum {
    HEAD_MAX_BYTES = 32 << 10,     /* request line, headers and the empty line */
    HEAD_MAX_LINE = 24 << 10,      /* of them the request line */
    HEAD_MAX_WEBSOCKET = 12 << 10, /* all of a WebSocket's */
    HEAD_MAX_FIELDS = 100,
    HEAD_MAX_PARAMETERS = 100, /* of the address's query */
    HEAD_MAX_EMPTY = 8         /* lines before it, which are passed over */
};

enum head_kind {
    HEAD_INCOMPLETE, /* more has to come */
    HEAD_HTTP,
    HEAD_WEBSOCKET, /* a whole handshake for /api/v1/rooms/{id}/ws; head_read_handshake reads it */
    HEAD_REFUSED    /* problem says why */
};

/* A whole head. */
struct head_request {
    size_t n_bytes;        /* of the head, with empty lines before it */
    bool is_chunked;       /* the body */
    uint64_t length;       /* of a body that is not; 0: there is none */
    const char *forwarded; /* value of the last X-Forwarded-For, in the bytes read; NULL: there is none */
    size_t n_forwarded;
};

/* bytes: all that has come by now. hosts: who we are; a request to somebody else is refused. */
NODISCARD enum head_kind head_look(const char *bytes, size_t n, const struct hosts *hosts, struct problem *problem);
/* The same, and what is in it when it is whole and not refused. */
NODISCARD enum head_kind head_read(const char *bytes, size_t n, const struct hosts *hosts, struct head_request *request,
                                   struct problem *problem);
/* What head_look called HEAD_WEBSOCKET, from the same bytes. */
void head_read_handshake(const char *bytes, size_t n, struct handshake *handshake);
/* The same for a peer that ended, or whose time is over: what is missing. */
void head_refuse_incomplete(const char *bytes, size_t n, bool has_ended, int waited_ms, struct problem *problem);
