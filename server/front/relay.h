#pragma once
/* The HTTP thread, between the clients' sockets and the HTTP library. The library parses requests leniently and fails
 * badly at its limits; so the relay checks the head of every request, finds the end of its body, counts connections,
 * and passes one request after the other to the library through a pair of sockets. The answer is passed back as it
 * comes. A refused request never reaches the library. Knows nothing of libmicrohttpd, of files and of the API. */
#include <stdatomic.h>

#include "server/front/address.h"
#include "server/front/hosts.h"
#include "server/wire/problem.h"

enum {
    RELAY_MAX_CONNECTIONS = 500,
    RELAY_MAX_PER_ADDRESS = 200, /* of these; see address_counted */
    RELAY_RETRY_MS = 5000,
    RELAY_IDLE_MS = 60000,    /* without a byte either way, unless a request waits for its answer */
    RELAY_ANSWER_MS = 120000, /* from a request's last byte to the first of its answer: requests to renderers time out
                                 after 30 s */
    RELAY_WINDOW_MS = 60000,  /* in each window ... */
    RELAY_WINDOW_BYTES = 64 << 10, /* ... bytes of a body must come, or of an answer be taken: a kilobyte a second */
    RELAY_HEAD_MS = 5000,          /* from the first byte of a head to its last */
    RELAY_MAX_QUEUED = 512,        /* connections from the acceptor that the thread has not taken yet */
    RELAY_MAX_LINGERING =
        64, /* refused connections whose last bytes are read: they count no longer; one more ends the oldest */
    RELAY_LINGER_SILENT_MS = 2000, /* a lingering connection without a byte for this long is closed */
    RELAY_MAX_DROPPED =
        64 << 20 /* bytes of a refused request that are read, so that its sender comes to read the answer */
};

struct relay;
struct relay_link; /* a client's connection */

/* The HTTP library. Called on the relay's thread. */
struct relay_server {
    bool (*add)(
        void *context,
        int socket); /* Takes a connection, whose first request follows. false: it cannot, and has closed socket. */
    bool (*run)(void *context); /* handles received bytes, never waits; true: there is more to do at once */
    int poll_fd;                /* readable when run has something to do */
    void *context;
};

struct relay_options {
    const struct hosts *hosts;           /* outlives the relay */
    const struct address_range *trusted; /* proxies; outlives the relay */
    size_t n_trusted;
};

/* relay_serve starts the thread, with the library to serve. errors ERROR_IO */
NODISCARD struct relay *relay_create(const struct relay_options *options, struct error *err);
NODISCARD bool relay_serve(struct relay *relay, const struct relay_server *server, struct error *err);
/* Ends the thread, after answers that are there were passed on as far as clients take them at once, and closes every
 * connection. The library may report the end of its connections until relay_destroy. NULL is allowed. */
void relay_stop(struct relay *relay);
void relay_destroy(struct relay *relay);

/* Takes an accepted socket whose first head has come and was not refused; refuses it when there are too many. client:
 * the address that the first request is counted for. The acceptor's thread. */
void relay_add(struct relay *relay, int socket, const struct address *peer, const struct address *client);
void relay_wake(struct relay *relay); /* any thread: has run called soon */
/* Has the relay's thread set *beat. Any thread; one call at a time. */
void relay_ping(struct relay *relay, atomic_bool *beat);
void relay_hang(struct relay *relay); /* for tests: the thread hangs */

/* For the library's side, on the relay's thread: */
/* The connection that was added with this socket; NULL: none. Valid until relay_link_closed, which the library must
 * then call. */
struct relay_link *relay_find(struct relay *relay, int socket);
/* The address of the client of the present request, behind trusted proxies; "": not known. */
void relay_client(const struct relay_link *link, char text[ADDRESS_TEXT]);
void relay_link_closed(struct relay_link *link); /* the library closed its end */
/* Whether all bytes of the answer so far are on their way to the client. False: some wait for the client to take them.
 */
bool relay_link_is_free(const struct relay_link *link);
bool relay_link_is_gone(const struct relay_link *link); /* the client's side has ended */
void relay_request_ended(struct relay_link *link);      /* the answer was written completely */
/* Answers the request that is being received with a problem and ends the connection, which no longer counts. Up to
 * max_dropped bytes more are read from it. */
void relay_refuse(struct relay_link *link, const struct problem *problem, uint64_t max_dropped);
