#pragma once
/* The HTTP thread, between the clients' sockets and the HTTP library. The library parses requests leniently and fails
 * badly at its limits; so the front checks the head of every request, finds the end of its body, counts connections,
 * and passes one request after the other to the library through a pair of sockets. The answer is passed back as it
 * comes. A refused request never reaches the library. Knows nothing of libmicrohttpd, of files and of the API. */
#include <stdatomic.h>

#include "server/front/address.h"
#include "server/front/hosts.h"
#include "server/wire/problem.h"

enum {
    FRONT_MAX_CONNECTIONS = 500,
    FRONT_MAX_PER_ADDRESS = 200, /* of these; see address_counted */
    FRONT_RETRY_MS = 5000,
    FRONT_IDLE_MS = 60000,    /* without a byte either way, unless a request waits for its answer */
    FRONT_ANSWER_MS = 120000, /* from a request's last byte to the first of its answer: requests to renderers time out
                                 after 30 s */
    FRONT_WINDOW_MS = 60000,  /* in each window ... */
    FRONT_WINDOW_BYTES = 64 << 10, /* ... bytes of a body must come, or of an answer be taken: a kilobyte a second */
    FRONT_HEAD_MS = 5000,          /* from the first byte of a head to its last */
    FRONT_MAX_QUEUED = 512,        /* connections from the acceptor that the thread has not taken yet */
    FRONT_MAX_LINGERING =
        64, /* refused connections whose last bytes are read: they count no longer; one more ends the oldest */
    FRONT_LINGER_SILENT_MS = 2000, /* a lingering connection without a byte for this long is closed */
    FRONT_MAX_DROPPED =
        64 << 20 /* bytes of a refused request that are read, so that its sender comes to read the answer */
};

struct front;
struct front_link; /* a client's connection */

/* The HTTP library. Called on the front's thread. */
struct front_server {
    bool (*add)(
        void *context,
        int socket); /* Takes a connection, whose first request follows. false: it cannot, and has closed socket. */
    bool (*run)(void *context); /* handles received bytes, never waits; true: there is more to do at once */
    int poll_fd;                /* readable when run has something to do */
    void *context;
};

struct front_options {
    const struct hosts *hosts;           /* outlives the front */
    const struct address_range *trusted; /* proxies; outlives the front */
    size_t n_trusted;
};

/* front_serve starts the thread, with the library to serve. errors ERROR_IO */
NODISCARD struct front *front_create(const struct front_options *options, struct error *err);
NODISCARD bool front_serve(struct front *front, const struct front_server *server, struct error *err);
/* Ends the thread, after answers that are there were passed on as far as clients take them at once, and closes every
 * connection. The library may report the end of its connections until front_destroy. NULL is allowed. */
void front_stop(struct front *front);
void front_destroy(struct front *front);

/* Takes an accepted socket whose first head has come and was not refused; refuses it when there are too many. client:
 * the address that the first request is counted for. The acceptor's thread. */
void front_add(struct front *front, int socket, const struct address *peer, const struct address *client);
void front_wake(struct front *front); /* any thread: has run called soon */
/* Has the front's thread set *beat. Any thread; one call at a time. */
void front_ping(struct front *front, atomic_bool *beat);
void front_hang(struct front *front); /* for tests: the thread hangs */

/* For the library's side, on the front's thread: */
/* The connection that was added with this socket; NULL: none. Valid until front_link_closed, which the library must
 * then call. */
struct front_link *front_find(struct front *front, int socket);
/* The address of the client of the present request, behind trusted proxies; "": not known. */
void front_client(const struct front_link *link, char text[ADDRESS_TEXT]);
void front_link_closed(struct front_link *link); /* the library closed its end */
/* Whether all bytes of the answer so far are on their way to the client. False: some wait for the client to take them.
 */
bool front_link_is_free(const struct front_link *link);
bool front_link_is_gone(const struct front_link *link); /* the client's side has ended */
void front_request_ended(struct front_link *link);      /* the answer was written completely */
/* Answers the request that is being received with a problem and ends the connection, which no longer counts. Up to
 * max_dropped bytes more are read from it. */
void front_refuse(struct front_link *link, const struct problem *problem, uint64_t max_dropped);
