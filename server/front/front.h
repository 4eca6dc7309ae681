#pragma once
/* The front door: accepts connections, checks the head of every request, and hands a WebSocket handshake with its
 * socket to the net thread and any other request to the HTTP library. The library parses requests leniently and fails
 * badly at its limits; so the front finds the end of each body, counts connections, and passes one request after the
 * other to the library through a pair of sockets. The answer is passed back as it comes. A refused request reaches
 * neither side. Runs on a thread of its own, on which the library runs, too. Knows nothing of libmicrohttpd, of files,
 * of the API and of rooms. */
#include <stdatomic.h>

#include "server/front/address.h"
#include "server/front/hosts.h"
#include "server/front/local_socket.h"
#include "server/wire/handshake.h"
#include "server/wire/identity.h"
#include "server/wire/problem.h"

enum {
    /* Connections whose first head is not whole, in all and from one address (trusted proxies excepted). One more is
     * refused, unless its head is there when it is accepted. */
    FRONT_MAX_WAITING = 256,
    FRONT_MAX_WAITING_PER_ADDRESS = 64,
    /* HTTP connections, in all and from one address; see address_counted. */
    FRONT_MAX_CONNECTIONS = 500,
    FRONT_MAX_PER_ADDRESS = 200,
    /* WebSockets, in all (less than WS_MAX_CONNECTIONS, the limit of server/ws) and from one address. */
    FRONT_MAX_WEBSOCKETS = 1500,
    FRONT_MAX_WEBSOCKETS_PER_ADDRESS = 200,
    FRONT_MAX_SOCKETS = 4, /* Unix sockets of proxies */
    FRONT_ALL_SOCKETS = FRONT_MAX_SOCKETS + 1,
    FRONT_MAX_TAKEN = 512, /* sockets given to front_take that the thread has not taken yet */
    FRONT_RETRY_MS = 5000, /* told to clients that are refused for a limit */

    FRONT_HEAD_MS = 5000,     /* to a whole head: from accepting the connection, later from the head's first byte */
    FRONT_IDLE_MS = 60000,    /* without a byte either way, unless a request waits for its answer */
    FRONT_ANSWER_MS = 120000, /* from a request's last byte to the first of its answer: requests to renderers time out
                                 after 30 s */
    /* Least bytes in each window, of a body that comes or of an answer that is taken: a kilobyte a second. */
    FRONT_WINDOW_MS = 60000,
    FRONT_WINDOW_BYTES = 64 << 10,

    /* A refused connection lingers: its bytes are read and dropped so that its sender comes to read the answer. */
    FRONT_MAX_LINGERING = 64, /* after a whole head; one more ends the oldest */
    FRONT_MAX_DROPPED = 64 << 20,
    FRONT_LINGER_SILENT_MS = 2000,   /* without a byte; then the connection is closed */
    FRONT_MAX_LINGERING_FIRST = 256, /* refused before their first head was whole; one more is closed at once */
    FRONT_MAX_DROPPED_FIRST = 1 << 20,
    FRONT_LINGER_FIRST_MS = 1000 /* in all */
};

struct front;
struct front_link; /* a client's connection */

struct front_options {
    /* "127.0.0.1:8080", "[::1]:0"; a numeric address, port 0 lets the system choose. NULL: only the sockets */
    const char *listen;
    struct local_socket *sockets; /* FRONT_ALL_SOCKETS at most; HTTP without TLS */
    size_t n_sockets;
    struct local_peers proxy; /* the only ones who are answered at the sockets; their X-Forwarded-For is believed */
    const char *const *identity_names; /* as in struct head_rules; NULL: head_identity_names */
    bool takes_identity;               /* the proxy says who makes a request */
    /* The port speaks TLS: takes each socket accepted there, of which nothing has been read, and gives decrypted
     * streams to front_take. Called on the front's thread, not after front_stop. NULL: it speaks HTTP. */
    void (*decrypt)(void *context, int socket, const struct address *peer);
    const struct hosts *hosts;           /* outlives the front, like all pointers here */
    const struct address_range *trusted; /* proxies whose X-Forwarded-For is believed */
    size_t n_trusted;
    /* Takes the socket of a WebSocket, which begins with this handshake: nothing of it has been read. Calls
     * ended(argument) once when the WebSocket is gone; any thread, at the latest before front_destroy. Called on the
     * front's thread, not after front_close. */
    void (*adopt)(void *context, int socket, const struct handshake *handshake, void (*ended)(void *argument),
                  void *argument);
    /* Finds out who makes a request, of whose body nothing has been read. False with problem: it is refused. Called on
     * the front's thread. NULL: everybody is nobody. */
    bool (*identify)(void *context, const struct credentials *credentials, struct identity *identity,
                     struct problem *problem);
    void *context; /* of decrypt, adopt and identify */
};

/* The HTTP library. Called on the front's thread. */
struct front_library {
    /* Takes a connection, whose first request follows. false: it cannot, and has closed socket. */
    bool (*add)(void *context, int socket);
    bool (*run)(void *context); /* handles received bytes, never waits; true: there is more to do at once */
    int poll_fd;                /* readable when run has something to do */
    void *context;
};

/* Creates a front that does not listen yet. errors ERROR_IO */
NODISCARD struct front *front_create(const struct front_options *options, struct error *err);
/* Starts to listen, and starts the thread. errors ERROR_FORMAT, ERROR_RANGE, ERROR_IO */
NODISCARD bool front_serve(struct front *front, const struct front_library *library, struct error *err);
/* Stopping, in this order. front_close: no connection is accepted any more, and when it returns no WebSocket is handed
 * on; requests of connections that are open are served. front_stop: ends the thread, after answers that are there were
 * passed on as far as clients take them at once, and closes every connection; the library may report the end of its
 * connections until front_destroy. NULL is allowed. */
void front_close(struct front *front);
void front_stop(struct front *front);
void front_destroy(struct front *front);
/* "http://127.0.0.1:8080", or "https:" with decrypt, with the port that the system chose; "unix:/path" where it listens
 * at sockets alone; after front_serve. */
const char *front_url(const struct front *front);

/* Takes a connected stream socket that did not come by the listener, as if it were accepted from this address: one end
 * of a pair behind which TLS is decrypted. Nothing of the stream has been read. Refuses it with 429 when too many wait
 * to be taken; closes it after front_close. Any thread, from front_serve on. */
void front_take(struct front *front, int socket, const struct address *peer);
/* Takes likewise the socket of a client that speaks no TLS where it should: it is refused with 400. */
void front_take_plain(struct front *front, int socket, const struct address *peer);
void front_wake(struct front *front); /* any thread: has run called soon */
/* Has the thread set *beat. Any thread; one call at a time. */
void front_ping(struct front *front, atomic_bool *beat);

/* For the library's side, on the front's thread: */
/* The connection that was added with this socket; NULL: none. Valid until front_link_closed, which the library must
 * then call. */
struct front_link *front_find(struct front *front, int socket);
/* The address of the client of the present request, behind trusted proxies; "": not known. */
void front_client(const struct front_link *link, char text[ADDRESS_TEXT]);
/* True if its bytes came by TLS, which was decrypted here. */
bool front_link_is_encrypted(const struct front_link *link);
/* Likewise, or it came by a proxy at a Unix socket: browsers know this server by https. */
bool front_link_is_https(const struct front_link *link);
/* The identity of the present request. */
const struct identity *front_identity(const struct front_link *link);
void front_link_closed(struct front_link *link); /* the library closed its end */
/* True if all bytes of the answer so far are on their way to the client; false: some wait for the client. */
bool front_link_is_free(const struct front_link *link);
bool front_link_is_gone(const struct front_link *link); /* the client's side has ended */
void front_request_ended(struct front_link *link);      /* the answer was written completely */
/* Answers the request that is being received with a problem and ends the connection, which no longer counts. Up to
 * max_dropped bytes more are read from it. */
void front_refuse(struct front_link *link, const struct problem *problem, uint64_t max_dropped);
