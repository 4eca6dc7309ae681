#pragma once
/* The loop of the net thread: waits for sockets, for a time, and for a wake-up from another thread. Knows nothing of
 * what the sockets carry. Net thread, but for loop_wake. Internal to server/ws. */
#include <stdbool.h>
#include <stdint.h>

#include "core/base/error.h"

enum { LOOP_AT_ONCE = 64 /* sockets that one wait reports */ };

struct loop {
    int epoll, wake_fd, timer_fd;
    int64_t armed_us; /* when timer_fd fires; INT64_MAX: never */
};

struct loop_event {
    void *owner;
    bool is_readable, takes_more, has_ended; /* ended: nothing more can be sent or received */
};

struct loop_events {
    struct loop_event of[LOOP_AT_ONCE];
    int n;
    bool is_woken;
};

/* errors ERROR_IO */
NODISCARD bool loop_init(struct loop *loop, struct error *err);
void loop_finish(struct loop *loop); /* also after a loop_init that failed */
/* Reports when bytes or the end can be read. False: no memory. */
NODISCARD bool loop_add(struct loop *loop, int fd, void *owner);
/* Whether it is also reported that the socket takes more. */
void loop_set_wants_room(struct loop *loop, int fd, void *owner, bool wants_room);
void loop_remove(struct loop *loop, int fd); /* before it is closed */
void loop_wake(struct loop *loop);           /* any thread: ends the wait */
/* Waits until something is to be reported, at most until until_us; it may return earlier, with nothing. */
void loop_wait(struct loop *loop, int64_t until_us, struct loop_events *events);
