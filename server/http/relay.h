#pragma once
/* The HTTP thread. It stands between the clients' sockets and the HTTP library, which reads requests strictly only in
 * part and has no limit that can be met without harm. The relay reads the head of every request and where its body
 * ends, counts connections, and passes one request after the other to the library through a pair of sockets; the answer
 * goes back as it comes. A request that is refused never reaches the library. Knows nothing of libmicrohttpd, of files,
 * and of the API. */
#include <stdatomic.h>

#include "server/http/address.h"
#include "server/http/hosts.h"
#include "server/wire/problem.h"

enum {
    RELAY_MAX_CONNECTIONS = 500,
    RELAY_MAX_PER_ADDRESS = 200, /* of them; see address_counted */
    RELAY_RETRY_MS = 5000,
    RELAY_IDLE_MS = 60000,    /* without a byte either way, but for a request that waits for its answer */
    RELAY_ANSWER_MS = 120000, /* for an answer to begin, from the request's last byte on: no question to a renderer
                                 waits longer than 30 s */
    RELAY_WINDOW_MS = 60000,  /* in which ... */
    RELAY_WINDOW_BYTES =
        64 << 10,           /* ... of a body have to come, and of an answer have to be taken: a kilobyte a second */
    RELAY_HEAD_MS = 5000,   /* for a whole head, from its first byte on */
    RELAY_MAX_QUEUED = 512, /* connections handed over that the thread has not taken yet */
    RELAY_MAX_LINGERING =
        64, /* refused ones whose last bytes are read; they count no longer, and one more ends the oldest */
    RELAY_LINGER_SILENT_MS = 2000, /* then it is closed */
    RELAY_MAX_DROPPED =
        64 << 20 /* bytes of a refused request that are read, so that its sender comes to read the answer */
};

struct relay;
struct relay_link; /* a client's connection */

/* The library behind. All of it is called on the relay's thread. */
struct relay_server {
    bool (*add)(void *context,
                int socket);    /* takes a connection, its first request follows; false: it cannot, socket is closed */
    bool (*run)(void *context); /* handles what has come and never waits; true: there is more to do at once */
    int poll_fd;                /* readable when run has something to do */
    void *context;
};

struct relay_options {
    const struct hosts *hosts;           /* outlives the relay */
    const struct address_range *trusted; /* proxies; outlives the relay */
    size_t n_trusted;
};

/* Starts the thread; it serves once relay_serve has told what is behind. errors ERROR_IO */
NODISCARD struct relay *relay_create(const struct relay_options *options, struct error *err);
NODISCARD bool relay_serve(struct relay *relay, const struct relay_server *server, struct error *err);
/* Ends the thread, after the answers that are there have been passed on as far as clients take them at once, and closes
 * every connection. The library behind may still tell the end of its connections until relay_destroy. NULL: nothing. */
void relay_stop(struct relay *relay);
void relay_destroy(struct relay *relay);

/* Takes an accepted socket whose first head has come and was not refused; refuses it when there are too many. client:
 * whom the first request is counted for. The acceptor's thread. */
void relay_add(struct relay *relay, int socket, const struct address *peer, const struct address *client);
void relay_wake(struct relay *relay); /* any thread: run is called soon */
/* Any thread: *beat is set soon, by the relay's thread. One at a time. */
void relay_ping(struct relay *relay, atomic_bool *beat);
void relay_hang(struct relay *relay); /* for tests: its thread does nothing more */

/* For the library's side, on the relay's thread: */
/* The connection that was added with this socket; NULL: none. It stays valid until relay_link_closed, which then has to
 * come. */
struct relay_link *relay_find(struct relay *relay, int socket);
void relay_link_closed(struct relay_link *link);   /* the library has closed its end */
void relay_request_ended(struct relay_link *link); /* its answer has been written as a whole */
/* Answers the request that is being received with a problem and ends the connection. It no longer counts from now on;
 * up to max_dropped bytes more are read from it. */
void relay_refuse(struct relay_link *link, const struct problem *problem, uint64_t max_dropped);
