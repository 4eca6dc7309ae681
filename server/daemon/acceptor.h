#pragma once
/* The one public port: looks at the head of each connection's first request without reading it, then hands the
 * untouched socket to the WebSocket side or to the HTTP side, or says why neither has it. Counts WebSockets by address;
 * the HTTP side counts its own. */
#include <stdatomic.h>
#include <stdint.h>

#include "core/base/error.h"
#include "server/http/address.h"

enum {
    ACCEPTOR_MAX_PENDING = 256, /* connections that have not sent their first head yet, in all */
    ACCEPTOR_MAX_PENDING_PER_ADDRESS =
        64,                     /* and from one address that is no trusted proxy's; the next is told 429 at once */
    ACCEPTOR_MAX_REFUSED = 256, /* refused ones that are given time to take their answer; others are closed at once */
    ACCEPTOR_MAX_WEBSOCKETS = 1500, /* less than WS_MAX_CONNECTIONS, the library's own limit */
    ACCEPTOR_MAX_WEBSOCKETS_PER_ADDRESS = 200,
    ACCEPTOR_HEAD_MS = 5000,        /* how long a head may take */
    ACCEPTOR_LINGER_MS = 1000,      /* for a refused connection to take its answer */
    ACCEPTOR_MAX_DROPPED = 1 << 20, /* bytes of a refused connection that are read meanwhile */
    ACCEPTOR_RETRY_MS = 5000
};

struct net;
struct http;
struct hosts;
struct acceptor;

struct acceptor_options {
    const char *listen; /* "127.0.0.1:8080", "[::1]:0"; a numeric address, port 0 lets the system choose */
    struct net *net;
    struct http *http;
    const struct hosts *hosts;           /* outlives the acceptor, as all here */
    const struct address_range *trusted; /* proxies whose X-Forwarded-For is believed */
    size_t n_trusted;
};

/* Starts listening and the thread. errors ERROR_FORMAT, ERROR_IO */
NODISCARD struct acceptor *acceptor_create(const struct acceptor_options *options, struct error *err);
void acceptor_stop(struct acceptor *acceptor); /* stops listening, drops connections without a head; NULL: nothing */
void acceptor_destroy(
    struct acceptor *acceptor); /* once net and http are gone: the ends of WebSockets are told to it until then */
/* "http://127.0.0.1:8080" with the port the system gave. */
const char *acceptor_url(const struct acceptor *acceptor);
/* Any thread: *beat is set soon, by the acceptor's thread. One at a time. */
void acceptor_ping(struct acceptor *acceptor, atomic_bool *beat);
void acceptor_hang(struct acceptor *acceptor); /* for tests: its thread does nothing more */
