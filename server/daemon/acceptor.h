#pragma once
/* The one public port: looks at the head of each connection's first request without reading it, then hands the untouched socket to the
 * WebSocket side or to the HTTP side, or says why neither has it. */
#include <stdint.h>

#include "core/base/error.h"

enum {
    ACCEPTOR_MAX_PENDING = 256,            /* connections that have not sent their first head yet, in all */
    ACCEPTOR_MAX_PENDING_PER_ADDRESS = 64, /* and from one address; the next is told 429 at once */
    ACCEPTOR_HEAD_MS = 5000,               /* how long it may take */
    ACCEPTOR_LINGER_MS = 1000,             /* for one that was refused to take its answer */
    ACCEPTOR_MAX_DROPPED = 1 << 20         /* bytes of its that are read meanwhile */
};

struct net;
struct http;
struct hosts;
struct acceptor;

/* listen: "127.0.0.1:8080", "[::1]:0"; a numeric address, port 0 lets the system choose. Starts listening and the thread.
 * hosts: outlives it.
 *   errors ERROR_FORMAT, ERROR_IO */
NODISCARD struct acceptor *acceptor_create(const char *listen, struct net *net, struct http *http, const struct hosts *hosts, struct error *err);
void acceptor_destroy(struct acceptor *acceptor); /* stops listening, drops those that wait */
/* "http://127.0.0.1:8080" with the port the system gave. */
const char *acceptor_url(const struct acceptor *acceptor);
