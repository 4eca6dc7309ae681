#pragma once
/* Shared by the two files of the relay; no other file includes it.
 *   relay.c       the thread and the set of links: takes connections over, counts them, waits for events, ends those
 * that are late, frees relay_link.c  one link, which is one client's connection: its requests, its answers, and how it
 * ends relay.c tells a link which of its sockets is readable and lets it advance; a link reaches the other links only
 * through the functions of relay.c declared below. The functions declared here run on the relay's thread, or after that
 * thread has ended. */
#include <pthread.h>
#include <stdatomic.h>
#include <sys/epoll.h>
#include <unistd.h>

#include "server/http/body.h"
#include "server/http/relay.h"

enum { RELAY_OUT_SIZE = 256 << 10 }; /* of an answer at once */

enum link_state {
    LINK_HEAD,   /* a head is read; the library has nothing of it */
    LINK_BODY,   /* head and body are passed on */
    LINK_ANSWER, /* the request is there as a whole; nothing is read from the client */
    LINK_LINGER, /* the last answer is out; what still comes is dropped */
    LINK_DEAD    /* to be freed */
};

struct relay_link {
    struct relay_link *next, *previous;
    struct relay_link *next_touched;
    struct relay *relay;
    enum link_state state;
    int client, inner, server; /* sockets: the client's, and the pair's ends, ours and the library's; -1: closed */
    struct address peer, counted;
    bool is_counted, is_touched;
    bool is_started;       /* the library knows the connection: it will tell its end */
    bool inner_wants_room; /* epoll tells when the library has taken bytes */
    bool client_readable, client_ended, inner_readable, inner_hung_up, inner_ended;
    bool is_request_ended, is_refused;
    struct problem problem; /* is_refused */
    uint64_t max_dropped, n_dropped;
    char *in;               /* NULL: nothing is there */
    size_t n_in, n_forward; /* bytes there; of them those that the library is to have */
    struct body body;
    char *out; /* of an answer, what the client does not take yet; NULL: nothing */
    size_t n_out, out_at;
    uint64_t n_answered;       /* bytes of the answer to this request */
    int64_t head_us, moved_us; /* the head's first byte; the last byte either way */
    int64_t window_us;         /* since then window_bytes have been passed on, of the body or of its answer */
    uint64_t window_bytes;
};

struct relay {
    struct relay_options options;
    struct relay_server server;
    struct queue *queue;
    int epoll, wake;
    pthread_t thread;
    bool has_thread;
    atomic_bool is_stopping, is_to_hang;
    _Atomic(atomic_bool *) pinged;
    struct relay_link *links, *touched;
    size_t n_counted, n_lingering;
    bool has_dead;    /* links may be freed */
    size_t n_refused; /* connections, since the log said so last */
    int64_t logged_us;
    char bytes[RELAY_OUT_SIZE];
};

/* relay.c */
/* Counts the connection for a client from now on, and no longer for another. */
bool relay_count(struct relay_link *link, const struct address *client, struct problem *problem);
void relay_uncount(struct relay_link *link);
void relay_uncount_ended(struct relay_link *link); /* unless the library still has its end: then once that is closed */
void relay_log_refusal(struct relay *relay);       /* a connection was refused because there are too many */
void relay_touch(struct relay_link *link);         /* the thread advances it in its next round */
void relay_end_oldest_lingering(struct relay *relay);

/* relay_link.c */
void relay_link_advance(struct relay_link *link); /* does all that can be done now */
void relay_link_pump(
    struct relay_link *link); /* passes on what the library has written, as far as the client takes it */
void relay_link_refuse(struct relay_link *link, const struct problem *problem,
                       uint64_t max_dropped); /* with an answer, if none began */
void relay_link_die(struct relay_link *link); /* at once; the thread frees it once the library has ended, too */
void relay_link_begin_window(struct relay_link *link);

/* A process that is being started has copies of all descriptors for a moment: what is only closed would stay watched
 * that long, and its events would name a link that is freed. */
static inline void relay_unwatch_and_close(const struct relay *relay, int *fd)
{
    if (*fd >= 0) {
        (void)epoll_ctl(relay->epoll, EPOLL_CTL_DEL, *fd, NULL); /* fails for one that was never watched */
        (void)close(*fd);
    }
    *fd = -1;
}

static inline void relay_close_fd(int *fd)
{
    if (*fd >= 0)
        (void)close(*fd);
    *fd = -1;
}
