#pragma once
/* The fleet's own thread: starts child processes, moves their packets, measures their memory, and notices silence and
 * ends. Orders come in and events go out by queues. Knows nothing of plans and their states. Touches no disk: a disk
 * that does not answer would hold up every renderer. */
#include "server/fleet/process.h"
#include "server/fleet/watch_event.h"

struct watch_options {
    struct silence_limits silence;
    int max_orders;              /* that may wait; 0: the default */
    void (*wake)(void *context); /* any thread: an event is waiting */
    void *context;
};

struct watch;
NODISCARD struct watch *watch_create(const struct watch_options *options, struct error *err);
/* Ends every process (their sockets close, 2 s later they are killed) and the thread. Events left are dropped. */
void watch_destroy(struct watch *watch);

/* Orders, from any thread. number: the caller's, never used twice. Returns false when the queue is full: nothing was
 * done. argv is taken (each string and the array are freed), on failure too. */
NODISCARD bool watch_start_renderer(struct watch *watch, uint64_t number, char **argv);
NODISCARD bool watch_start_program(struct watch *watch, uint64_t number, char **argv, int limit_ms);
/* A program that prints its progress line by line (WATCH_LINE); it may be silent for silent_ms. */
NODISCARD bool watch_start_with_progress(struct watch *watch, uint64_t number, char **argv, int silent_ms);
/* Takes bytes, on failure too. */
NODISCARD bool watch_send(struct watch *watch, uint64_t number, uint8_t *bytes, size_t n_bytes);
/* Ends a process: at_once kills it, else its socket closes and it has 1 s. reason goes into its WATCH_ENDED. Waits
 * while the queue is full. */
void watch_stop(struct watch *watch, uint64_t number, bool at_once, const char *reason);
/* While a picture or an answer of this renderer is awaited, its silence is noticed sooner. Not awaited at first. */
NODISCARD bool watch_await(struct watch *watch, uint64_t number, bool is_awaited);

struct watch_event *watch_take(struct watch *watch); /* the next event, the caller's; NULL: none */
