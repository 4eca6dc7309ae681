/* Events from other threads to the main thread: a bounded queue and an eventfd. */
#include "server/renderer/inbox.h"

#include <poll.h>
#include <stdlib.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "core/base/mem.h"
#include "core/base/queue.h"

enum { CAPACITY = 2048, BUSY = 64 };

struct inbox {
    struct queue *events;
    int wake_fd;
};

void inbox_event_destroy(struct inbox_event *event)
{
    if (!event)
        return;
    derive_destroy(event->derived);
    plan_destroy(event->plan);
    free(event->frame.picture.bytes);
    for (int i = 0; i < IMAGE_N_REDUCED; i++)
        free(event->frame.reduced[i].bytes);
    free(event->frame.marked.bytes);
    cJSON_Delete(event->body);
    free(event->blob);
    waiting_request_destroy(event->waiting);
    free(event);
}

static void drop_event(void *event)
{
    inbox_event_destroy(event);
}

struct inbox *inbox_create(void)
{
    struct inbox *inbox = mem_new(sizeof *inbox);
    inbox->wake_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (inbox->wake_fd < 0) {
        free(inbox);
        return NULL;
    }
    inbox->events = queue_create(CAPACITY, drop_event);
    return inbox;
}

void inbox_destroy(struct inbox *inbox)
{
    if (!inbox)
        return;
    queue_destroy(inbox->events);
    close(inbox->wake_fd);
    free(inbox);
}

int inbox_wake_fd(const struct inbox *inbox)
{
    return inbox->wake_fd;
}

static void wake(struct inbox *inbox)
{
    uint64_t one = 1;
    if (write(inbox->wake_fd, &one, sizeof one) < 0)
        return; /* the counter is full: it is readable */
}

void inbox_put(struct inbox *inbox, const struct inbox_event *event)
{
    struct inbox_event *copy = mem_new(sizeof *copy);
    *copy = *event;
    while (!queue_try_put(inbox->events, copy)) {
        wake(inbox);
        poll(NULL, 0, 1);
    }
    wake(inbox);
}

void inbox_offer(struct inbox *inbox, const struct inbox_event *event)
{
    if (queue_length(inbox->events) < BUSY)
        inbox_put(inbox, event);
}

struct inbox_event *inbox_take(struct inbox *inbox)
{
    struct inbox_event *event = queue_try_take(inbox->events);
    uint64_t n_wakes;
    if (!event && read(inbox->wake_fd, &n_wakes, sizeof n_wakes) > 0)
        event = queue_try_take(inbox->events); /* put in between taking and clearing */
    return event;
}
