#pragma once
/* One child process on the watch's thread: the packets and lines it sends, the packets that wait to be sent to it, its
 * time limits and its end. Each becomes a watch_event. Only for watch.c; now_us is always of the watch's run_clock. */
#include <poll.h>

#include "server/fleet/spawn.h"
#include "server/fleet/watch_event.h"

enum {
    PROCESS_MAX_OUTPUT = 256 << 10,   /* bytes a program may print; with progress: in one line */
    PROCESS_MAX_OUTGOING = 64 << 20,  /* bytes one renderer may leave unread before it counts as hung */
    PROCESS_MAX_BACKLOG = 256 << 20,  /* memory of one renderer's packets not yet handled; then it is not read from */
    PROCESS_MAX_PROGRESS = 128 << 10, /* the same of a program's lines: some hundred */
    PROCESS_RESTS_AFTER_MS = 5000, /* without a packet either way but pings; from then on a renderer is looked at ... */
    PROCESS_REST_MS = 60000        /* ... so rarely: nobody waits for it, and its end is reported by itself */
};

/* A renderer's silence counts from the first ping that is not answered, and only while the watch itself runs. */
struct silence_limits {
    int ping_ms;   /* a renderer that sends nothing for this long is sent a ping */
    int silent_ms; /* a process that does not answer a ping for this long is ended */
    /* Limits while an answer is awaited (process_await). The renderer is ended this early only when its main thread is
     * stopped, or asleep without reading; a main thread that waits for a processor or a disk keeps silent_ms. */
    int awaited_ping_ms, awaited_silent_ms;
};

struct process;

struct process_events {                                    /* where a process puts its events */
    void (*put)(void *context, struct watch_event *event); /* takes event */
    void *context;
};

/* Starts it; never NULL: one that could not be started has ended already. argv is borrowed.
 *
 *   limit_ms      time limit of a program; 0: a renderer, with a socket and no limit
 *   has_progress  a program whose lines are reported one by one; each line extends its time to limit_ms from then */
struct process *process_create(uint64_t number, char *const argv[], int limit_ms, bool has_progress,
                               const struct process_events *events, int64_t now_us);
void process_destroy(struct process *process); /* kills and reaps it when it still runs */
uint64_t process_number(const struct process *process);
/* Queues bytes for its socket; takes them. A process that leaves PROCESS_MAX_OUTGOING unread is ended. */
void process_send(struct process *process, uint8_t *bytes, size_t n_bytes, int64_t now_us);
/* Closes its socket and gives it 1 s to end; at_once, or a program: kills it. */
void process_stop(struct process *process, bool at_once, const char *reason, int64_t now_us);
void process_await(struct process *process, bool is_awaited);
bool process_is_awaited(const struct process *process);
/* When it is to be stepped at the latest if nothing happens to it, and it rests; 0: it does not rest. */
int64_t process_rests_until_us(const struct process *process, int64_t now_us);
/* True while its backlog is full: it is not read from. */
bool process_is_throttled(const struct process *process);

/* Fills in the files to poll for it; returns how many. */
size_t process_poll(const struct process *process, struct pollfd polled[2]);
/* Reads, writes, and checks its end and its limits. Returns true when it is over: WATCH_ENDED has been put and the
 * process is to be destroyed. */
bool process_step(struct process *process, const struct silence_limits *limits, int64_t now_us);
