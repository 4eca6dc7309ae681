#pragma once
/* The head of a connection's first request, before anybody reads it: who is to have the connection, or why nobody. What the libraries
 * behind would refuse in words of their own is refused here, as a problem. Knows no sockets. */
#include "server/http/hosts.h"
#include "server/wire/handshake.h"
#include "server/wire/problem.h"

enum {
    HEAD_MAX_BYTES = 32 << 10, /* request line, headers and the empty line */
    HEAD_MAX_LINE = 24 << 10,  /* of them the request line */
    HEAD_MAX_WEBSOCKET = 12 << 10, /* all of a WebSocket's */
    HEAD_MAX_FIELDS = 100,
    HEAD_MAX_EMPTY = 8         /* lines before it, which are passed over */
};

enum head_kind {
    HEAD_INCOMPLETE, /* more has to come */
    HEAD_HTTP,
    HEAD_WEBSOCKET,  /* a whole handshake for /api/v1/rooms/{id}/ws; head_read_handshake reads it */
    HEAD_REFUSED     /* problem says why */
};

/* bytes: all that has come by now. hosts: who we are; a request to somebody else is refused. */
NODISCARD enum head_kind head_look(const char *bytes, size_t n, const struct hosts *hosts, struct problem *problem);
/* What head_look called HEAD_WEBSOCKET, from the same bytes. */
void head_read_handshake(const char *bytes, size_t n, struct handshake *handshake);
/* The same for a peer that ended, or whose time is over: what is missing. */
void head_refuse_incomplete(const char *bytes, size_t n, bool has_ended, int waited_ms, struct problem *problem);
/* For requests after the first: problem when the Host header is not one of ours. NULL: there is none. */
bool head_host_is_ours(const struct hosts *hosts, const char *host, struct problem *problem);
