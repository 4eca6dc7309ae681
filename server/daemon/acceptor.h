#pragma once
/* The public port: peeks at the first head of each connection, then hands the untouched socket to the WebSocket side or
 * to the HTTP side, or answers why it is refused. Counts WebSockets by address; the HTTP side counts its own
 * connections. */
#include <stdatomic.h>
#include <stdint.h>

#include "core/base/error.h"
#include "server/front/address.h"

enum {
    ACCEPTOR_MAX_PENDING = 256, /* connections without a whole first head, in all ... */
    ACCEPTOR_MAX_PENDING_PER_ADDRESS =
        64,                     /* ... and from one address, trusted proxies excepted; the next one is answered 429 */
    ACCEPTOR_MAX_REFUSED = 256, /* refused connections given time to take their answer; others are closed at once */
    ACCEPTOR_MAX_WEBSOCKETS = 1500, /* less than WS_MAX_CONNECTIONS, the limit of server/ws */
    ACCEPTOR_MAX_WEBSOCKETS_PER_ADDRESS = 200,
    ACCEPTOR_HEAD_MS = 5000,        /* from accepting a connection to its whole first head */
    ACCEPTOR_LINGER_MS = 1000,      /* for a refused connection to take its answer ... */
    ACCEPTOR_MAX_DROPPED = 1 << 20, /* ... and bytes of it that are read and dropped meanwhile */
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
    const struct hosts *hosts;           /* outlives the acceptor, like all pointers here */
    const struct address_range *trusted; /* proxies whose X-Forwarded-For is believed */
    size_t n_trusted;
};

/* Starts to listen, and starts the thread. errors ERROR_FORMAT, ERROR_RANGE, ERROR_IO */
NODISCARD struct acceptor *acceptor_create(const struct acceptor_options *options, struct error *err);
void acceptor_stop(struct acceptor *acceptor); /* stops listening, drops connections without a head; NULL is allowed */
void acceptor_destroy(
    struct acceptor *acceptor); /* after net and http are destroyed: until then ends of WebSockets are reported to it */
/* "http://127.0.0.1:8080", with the port that the system chose. */
const char *acceptor_url(const struct acceptor *acceptor);
/* Has the acceptor's thread set *beat. Any thread; one call at a time. */
void acceptor_ping(struct acceptor *acceptor, atomic_bool *beat);
void acceptor_hang(struct acceptor *acceptor); /* for tests: the thread hangs */
