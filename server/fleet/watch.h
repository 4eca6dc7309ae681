#pragma once
/* The fleet's own thread: it starts child processes, moves their packets, notices silence, memory and ends. Orders come
 * in and events go out by queues; nothing here knows what a plan's state is. It touches no disk: what a disk holds up
 * would hold up every renderer. */
#include <stdint.h>

#include "server/wire/packet.h"

enum {
    WATCH_MAX_OUTPUT = 256 << 10,   /* bytes a program may print; of a teller: in one line */
    WATCH_MAX_OUTGOING = 64 << 20,  /* bytes one renderer may leave unread before it counts as hung */
    WATCH_MAX_UNHANDLED = 256 << 20 /* weight of one renderer's packets not yet handled; then it is not read from */
};

enum watch_event_type {
    WATCH_STARTED, /* pid */
    WATCH_PACKET,  /* packet */
    WATCH_MEMORY,  /* memory_bytes, own_bytes */
    WATCH_LINE,    /* output: one line a teller printed, without its end */
    WATCH_ENDED    /* the last of its number: how, and for a program what it printed */
};

struct watch_event {
    enum watch_event_type type;
    uint64_t number;
    int pid;
    uint64_t memory_bytes;
    uint64_t own_bytes; /* of these, what no file on disk stands behind: its own memory and shared memory */
    struct packet packet;
    /* WATCH_ENDED */
    bool is_exit; /* it ended by itself, with status; else by signal, or it never started */
    int status, signal;
    char reason[240]; /* why we ended it, or why it could not be started; "" when it ended by itself */
    char *output; /* n_output bytes and a final zero; NULL for renderers; of a teller: what followed its last line */
    size_t n_output;
    struct watch_lane *lane; /* the watch's own accounting */
};
void watch_event_destroy(struct watch_event *event);

struct watch_options {
    /* Silence counts from the first ping that is not answered, and only while the watch itself runs. */
    int ping_ms;   /* a renderer that says nothing for this long is sent a ping */
    int silent_ms; /* one that does not answer it for this long is ended */
    /* The same for a renderer whose answer is awaited (watch_await). It is ended this early only when its main thread
     * stands still (stopped, or asleep without reading): one that waits for a processor or a disk keeps silent_ms. */
    int awaited_ping_ms, awaited_silent_ms;
    int max_orders;              /* that may wait; 0: the default */
    void (*wake)(void *context); /* any thread: an event is waiting */
    void *context;
};

struct watch;
NODISCARD struct watch *watch_create(const struct watch_options *options, struct error *err);
/* Ends every process (their sockets close, 2 s later they are killed) and the thread. Events left are dropped. */
void watch_destroy(struct watch *watch);

/* Orders. false: the queue is full, nothing was done. argv is taken (each string and the array free()d), on failure
 * too. */
NODISCARD bool watch_start_renderer(struct watch *watch, uint64_t number, char **argv);
NODISCARD bool watch_start_program(struct watch *watch, uint64_t number, char **argv, int limit_ms);
/* A program that tells line by line how far it is (WATCH_LINE); it may be silent for silent_ms. */
NODISCARD bool watch_start_teller(struct watch *watch, uint64_t number, char **argv, int silent_ms);
NODISCARD bool watch_send(struct watch *watch, uint64_t number, uint8_t *bytes, size_t n_bytes); /* takes bytes */
/* Ends a process: is_hung kills at once, else its socket closes and it has 1 s. reason goes into its WATCH_ENDED. */
void watch_stop(struct watch *watch, uint64_t number, bool is_hung, const char *reason);
/* Whether a picture or an answer of this renderer is due: its silence is noticed sooner. Not awaited from the start. */
NODISCARD bool watch_await(struct watch *watch, uint64_t number, bool is_awaited);

struct watch_event *watch_take(struct watch *watch); /* NULL when there is none */
