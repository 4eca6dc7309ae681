/* Creates and destroys the watch's events, and counts the memory of those not yet handled. */
#include "server/fleet/watch_event.h"

#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/base/mem.h"

struct event_backlog {
    _Atomic uint64_t bytes;
    atomic_int references;
};

struct event_backlog *event_backlog_create(void)
{
    struct event_backlog *backlog = mem_new(sizeof *backlog);
    atomic_init(&backlog->references, 1);
    return backlog;
}

void event_backlog_unref(struct event_backlog *backlog)
{
    if (atomic_fetch_sub(&backlog->references, 1) == 1)
        free(backlog);
}

uint64_t event_backlog_bytes(const struct event_backlog *backlog)
{
    return atomic_load(&backlog->bytes);
}

void event_backlog_add(struct event_backlog *backlog, struct watch_event *event, uint64_t bytes)
{
    event->backlog = backlog;
    event->backlog_bytes = bytes;
    atomic_fetch_add(&backlog->references, 1);
    atomic_fetch_add(&backlog->bytes, bytes);
}

struct watch_event *watch_event_create(enum watch_event_type type, uint64_t number)
{
    struct watch_event *event = mem_new(sizeof *event);
    event->type = type;
    event->number = number;
    return event;
}

void watch_event_destroy(struct watch_event *event)
{
    if (!event)
        return;
    if (event->backlog) {
        atomic_fetch_sub(&event->backlog->bytes, event->backlog_bytes);
        event_backlog_unref(event->backlog);
    }
    packet_finish(&event->packet);
    free(event->output);
    free(event);
}

void watch_event_describe_end(const struct watch_event *event, char *text, size_t n)
{
    if (event->reason[0])
        (void)snprintf(text, n, "%s", event->reason);
    else if (event->signal)
        (void)snprintf(text, n, "stopped (signal %d)", event->signal);
    else
        (void)snprintf(text, n, "ended with status %d", event->status);
}
