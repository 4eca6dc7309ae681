#pragma once
/* The state of the front and of its links (one link per client connection). Internal to server/front; the front's
 * thread, or after it has ended. */
#include <pthread.h>
#include <stdatomic.h>
#include <sys/epoll.h>
#include <unistd.h>

#include "server/front/body.h"
#include "server/front/front.h"
#include "server/front/websocket_count.h"

enum { FRONT_OUT_SIZE = 256 << 10 }; /* bytes of an answer passed on at once */

enum link_state {
    LINK_HEAD,   /* the head is being received; none of it was passed to the library */
    LINK_BODY,   /* head and body are being passed on */
    LINK_ANSWER, /* the whole request was passed on; the client is not read from */
    LINK_LINGER, /* the last answer was sent; bytes that still come are dropped */
    LINK_DEAD    /* freed when the library has closed its end */
};

struct front_link {
    struct front_link *next, *previous;
    struct front_link *next_touched;
    struct front *front;
    enum link_state state;
    int client, inner, server; /* sockets: the client's, our end and the library's end of the pair; -1: closed */
    struct address peer, counted, asked_by; /* asked_by: of the present request, behind trusted proxies */
    struct identity identity;               /* of who makes the present request */
    bool is_local, is_from_proxy;           /* it came by a Unix socket; of the proxy's user or group */
    bool is_control;                        /* by the control socket, of the daemon's user or root */
    bool is_first;                          /* no head of this connection has been whole yet */
    bool is_counted, is_touched;
    bool is_started;                                    /* the library took the connection: it will report its end */
    bool inner_wants_room;                              /* epoll reports when the library has read bytes */
    bool client_readable, client_hung_up, client_ended; /* hung up: the end comes after the bytes in the socket */
    bool inner_readable, inner_hung_up, inner_ended;
    bool is_request_ended, is_refused;
    struct problem problem; /* is_refused */
    uint64_t max_dropped, n_dropped;
    size_t n_head;          /* bytes of the present head that have come; they are in `in`, or still in the socket */
    char *in;               /* bytes from the client, not passed on; NULL: none */
    size_t n_in, n_forward; /* bytes in `in`; of them those that are checked and to be passed on */
    struct body body;
    char *out; /* bytes of an answer that the client has not taken; NULL: none */
    size_t n_out, out_at;
    uint64_t n_answered; /* bytes of the answer to the present request */
    int64_t head_us;     /* is_first: when the connection was accepted; else when the head's first byte came */
    int64_t moved_us;    /* when the last byte moved either way */
    int64_t linger_us;   /* when lingering ends at the latest */
    int64_t window_us;   /* begin of the window in which window_bytes of body or answer were passed on */
    uint64_t window_bytes;
};

struct front {
    struct front_options options;
    struct front_library library;
    struct queue *taken;                  /* from front_take */
    struct gate *adopting;                /* passed by each call of options.adopt; closed by front_close */
    int listeners[1 + FRONT_ALL_SOCKETS]; /* TCP, then the Unix sockets; -1: none */
    int epoll, wake_fd;                   /* wake_fd: eventfd, written to wake the thread */
    int64_t accept_us; /* descriptors ran out: nothing is accepted before; 0: listeners are watched */
    pthread_t thread;
    bool has_thread, is_door_closed;
    atomic_bool is_closed, is_stopping;
    _Atomic(atomic_bool *) pinged;
    char url[LOCAL_SOCKET_MAX_PATH + 8];
    struct front_link *links, *touched;
    size_t n_waiting, n_counted;           /* links: is_first in LINK_HEAD; is_counted */
    size_t n_lingering, n_lingering_first; /* links in LINK_LINGER: with a whole head; is_first */
    bool has_dead;                         /* some link may be freed */
    size_t n_refused;                      /* refused connections since the last line in the log */
    int64_t logged_us;
    struct websocket_count websockets;
    char bytes[FRONT_OUT_SIZE];
};

/* Ends epoll's watch before closing: a child process that is being started holds a copy of every descriptor for a
 * moment, so a descriptor that was only closed would go on raising events, with the address of a freed link. */
static inline void front_unwatch_and_close(const struct front *front, int *fd)
{
    if (*fd >= 0) {
        (void)epoll_ctl(front->epoll, EPOLL_CTL_DEL, *fd, NULL); /* fails for a descriptor that was never watched */
        (void)close(*fd);
    }
    *fd = -1;
}

static inline void front_close_fd(int *fd)
{
    if (*fd >= 0)
        (void)close(*fd);
    *fd = -1;
}
