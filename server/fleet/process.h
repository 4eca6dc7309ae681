#pragma once
/* One child process as the watch sees it: its channel, what waits to be sent, and its times. Only for watch.c's thread;
 * now_us is of the watch's run_clock everywhere. */
#include <poll.h>

#include "server/fleet/spawn.h"
#include "server/fleet/watch.h"

struct process;

struct process_news {                                        /* how a process gives its events away */
    void (*event)(void *context, struct watch_event *event); /* takes it */
    void *context;
};

/* Starts it; never NULL: one that could not be started has ended already. argv is borrowed. limit_ms: a program's; 0
 * for renderers. is_teller: a program whose lines are told one by one; each gives it limit_ms more. */
struct process *process_create(uint64_t number, char *const argv[], int limit_ms, bool is_teller,
                               const struct process_news *news, int64_t now_us);
void process_destroy(struct process *process); /* kills and reaps when still there */
uint64_t process_number(const struct process *process);
/* Appends to what is to be sent; takes bytes. A process that leaves too much unread is ended. */
void process_send(struct process *process, uint8_t *bytes, size_t n_bytes, int64_t now_us);
void process_stop(struct process *process, bool at_once, const char *reason, int64_t now_us);
void process_await(struct process *process, bool is_awaited);
bool process_is_awaited(const struct process *process);

size_t process_poll(const struct process *process, struct pollfd polled[2]); /* how many it wants to be woken by */
/* Reads, writes, looks whether it ended, keeps its times. True: over, its WATCH_ENDED is given, destroy it. */
bool process_step(struct process *process, const struct watch_options *options, int64_t now_us);
bool process_is_throttled(const struct process *process);
