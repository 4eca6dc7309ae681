#pragma once
/* Events that the watch reports about a child process (started, packet, memory, output, end), and the count of the
 * packets that the net thread has not handled yet. Events are made on the watch's thread and destroyed on the net
 * thread. */
#include <stdint.h>

#include "server/wire/packet.h"

enum watch_event_type {
    WATCH_STARTED, /* pid */
    WATCH_PACKET,  /* packet */
    WATCH_MEMORY,  /* memory_bytes, own_bytes */
    WATCH_LINE,    /* output: one line that a program with progress printed, without its line end */
    WATCH_ENDED    /* the last event of its number: how the process ended, and what a program printed */
};

struct event_backlog; /* of one process */

struct watch_event {
    enum watch_event_type type;
    uint64_t number; /* of the process, as it was ordered */
    int pid;
    uint64_t memory_bytes; /* resident, the pages of mapped files included */
    uint64_t own_bytes;    /* resident, anonymous and shared memory only */
    struct packet packet;
    /* WATCH_ENDED */
    bool is_exit; /* it ended by itself, with status; else by signal, or it never started */
    int status, signal;
    char reason[240]; /* why we ended it, or why it could not be started; "" when it ended by itself */
    char *output; /* n_output bytes and a final zero; NULL for renderers; with progress: what followed the last line */
    size_t n_output;
    struct event_backlog *backlog; /* that counts this event; NULL: none */
    uint64_t backlog_bytes;
};

struct watch_event *watch_event_create(enum watch_event_type type, uint64_t number);
void watch_event_destroy(struct watch_event *event);
/* How the process ended, after "the renderer ...": why we ended it, "stopped (signal 11)", or "ended with status 1". */
void watch_event_describe_end(const struct watch_event *event, char *text, size_t n);

/* Reference-counted: the process and each of its events hold it. Any thread. */
struct event_backlog *event_backlog_create(void);
void event_backlog_unref(struct event_backlog *backlog);
/* Memory of the process's events that exist, in bytes, estimated. */
uint64_t event_backlog_bytes(const struct event_backlog *backlog);
/* Counts the event with this many bytes until it is destroyed. */
void event_backlog_add(struct event_backlog *backlog, struct watch_event *event, uint64_t bytes);
