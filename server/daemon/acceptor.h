#pragma once
/* The one public port: looks at the first line of each connection without reading it, then hands the untouched socket to the
 * WebSocket side or to the HTTP side. */
#include <stdint.h>

#include "core/base/error.h"

enum {
    ACCEPTOR_MAX_PENDING = 256,            /* connections that have not sent their first line yet, in all */
    ACCEPTOR_MAX_PENDING_PER_ADDRESS = 64, /* and from one address */
    ACCEPTOR_FIRST_LINE_MS = 5000,         /* how long it may take */
    ACCEPTOR_MAX_FIRST_LINE = 8192
};

struct net;
struct http;
struct acceptor;

/* listen: "127.0.0.1:8080", "[::1]:0"; a numeric address, port 0 lets the system choose. Starts listening and the thread.
 * errors ERROR_FORMAT, ERROR_IO */
NODISCARD struct acceptor *acceptor_create(const char *listen, struct net *net, struct http *http, struct error *err);
void acceptor_destroy(struct acceptor *acceptor); /* stops listening, drops those that wait */
/* "http://127.0.0.1:8080" with the port the system gave. */
const char *acceptor_url(const struct acceptor *acceptor);
