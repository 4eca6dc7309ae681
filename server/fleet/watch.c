/* The thread that carries out orders, polls all child processes and puts their events into the queue. */
#include "server/fleet/watch.h"

#include <assert.h>
#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "core/base/mem.h"
#include "core/base/queue.h"
#include "server/fleet/process.h"
#include "server/fleet/run_clock.h"

enum {
    MAX_PROCESSES = 256,
    ORDER_CAPACITY = 8192,
    EVENT_CAPACITY = 8192,
    BUSY_POLL_MS = 20,     /* while an event or a throttled process waits for the net thread */
    AWAITED_POLL_MS = 100, /* while an answer is awaited */
    CALM_POLL_MS = 250,    /* while there are processes: pings, memory, limits */
    LONGEST_STEP_MS = 500, /* beyond what it meant to wait; the rest does not count, the thread did not run */
    BLIND_POLL_MS = 50,    /* where the kernel has no pidfd to poll */
    STOP_ALL_US = 2000000
};

enum order_type { ORDER_START, ORDER_SEND, ORDER_STOP, ORDER_AWAIT, ORDER_QUIT };

struct order {
    enum order_type type;
    uint64_t number;
    char **argv;
    int limit_ms;
    bool has_progress;
    uint8_t *bytes;
    size_t n_bytes;
    bool at_once, is_awaited;
    char reason[240];
};

struct held_event { /* put while the event queue was full */
    struct held_event *next;
    struct watch_event *event;
};

struct watch {
    struct watch_options options;
    pthread_t thread;
    struct queue *orders, *events;
    int wake_fd; /* eventfd: written after each order */
    /* only for the thread */
    struct process *processes[MAX_PROCESSES];
    size_t n_processes, next; /* next: index of the process that is stepped next */
    struct held_event *held, **last_held;
    bool is_quitting;
    int64_t quit_at_us;
    struct run_clock clock;
    int64_t planned_us; /* how long it meant to wait at most */
};

static void free_texts(char **texts)
{
    for (size_t i = 0; texts && texts[i]; i++)
        free(texts[i]);
    free(texts);
}

static void order_destroy(void *item)
{
    struct order *order = item;
    if (!order)
        return;
    free_texts(order->argv);
    free(order->bytes);
    free(order);
}

static void event_drop(void *event)
{
    watch_event_destroy(event);
}

static bool put_order(struct watch *watch, struct order *order)
{
    if (!queue_try_put(watch->orders, order)) {
        order_destroy(order);
        return false;
    }
    uint64_t one = 1;
    ssize_t n = write(watch->wake_fd, &one, sizeof one);
    assert(n == sizeof one || errno == EAGAIN);
    return true;
}

static struct order *order_new(enum order_type type, uint64_t number)
{
    struct order *order = mem_new(sizeof *order);
    order->type = type;
    order->number = number;
    return order;
}

bool watch_start_renderer(struct watch *watch, uint64_t number, char **argv)
{
    struct order *order = order_new(ORDER_START, number);
    order->argv = argv;
    return put_order(watch, order);
}

bool watch_start_program(struct watch *watch, uint64_t number, char **argv, int limit_ms)
{
    struct order *order = order_new(ORDER_START, number);
    order->argv = argv;
    order->limit_ms = limit_ms > 0 ? limit_ms : 1;
    return put_order(watch, order);
}

bool watch_start_with_progress(struct watch *watch, uint64_t number, char **argv, int silent_ms)
{
    struct order *order = order_new(ORDER_START, number);
    order->argv = argv;
    order->limit_ms = silent_ms > 0 ? silent_ms : 1;
    order->has_progress = true;
    return put_order(watch, order);
}

bool watch_send(struct watch *watch, uint64_t number, uint8_t *bytes, size_t n_bytes)
{
    struct order *order = order_new(ORDER_SEND, number);
    order->bytes = bytes;
    order->n_bytes = n_bytes;
    return put_order(watch, order);
}

void watch_stop(struct watch *watch, uint64_t number, bool at_once, const char *reason)
{
    struct order *order = order_new(ORDER_STOP, number);
    order->at_once = at_once;
    (void)snprintf(order->reason, sizeof order->reason, "%s", reason);
    while (!put_order(watch, order)) { /* must not be lost; the thread empties the queue within milliseconds */
        poll(NULL, 0, 1);
        order = order_new(ORDER_STOP, number);
        order->at_once = at_once;
        (void)snprintf(order->reason, sizeof order->reason, "%s", reason);
    }
}

bool watch_await(struct watch *watch, uint64_t number, bool is_awaited)
{
    struct order *order = order_new(ORDER_AWAIT, number);
    order->is_awaited = is_awaited;
    return put_order(watch, order);
}

struct watch_event *watch_take(struct watch *watch)
{
    return queue_try_take(watch->events);
}

/* ---- on the thread ---------------------------------------------------------------------------------------------- */

static void flush_held(struct watch *watch)
{
    bool gave = false;
    while (watch->held && queue_try_put(watch->events, watch->held->event)) {
        struct held_event *next = watch->held->next;
        free(watch->held);
        watch->held = next;
        gave = true;
    }
    if (!watch->held)
        watch->last_held = &watch->held;
    if (gave)
        watch->options.wake(watch->options.context);
}

static void put_event(void *context, struct watch_event *event)
{
    struct watch *watch = context;
    if (!watch->held && queue_try_put(watch->events, event)) {
        watch->options.wake(watch->options.context);
        return;
    }
    struct held_event *held = mem_new(sizeof *held);
    held->event = event;
    *watch->last_held = held;
    watch->last_held = &held->next;
}

static struct process *find(struct watch *watch, uint64_t number)
{
    for (size_t i = 0; i < watch->n_processes; i++)
        if (process_number(watch->processes[i]) == number)
            return watch->processes[i];
    return NULL;
}

static void start(struct watch *watch, const struct order *order, int64_t now_us)
{
    const struct process_events events = { put_event, watch };
    if (watch->n_processes == MAX_PROCESSES || watch->is_quitting) {
        struct watch_event *event = watch_event_create(WATCH_ENDED, order->number);
        (void)snprintf(event->reason, sizeof event->reason, "too many processes");
        put_event(watch, event);
        return;
    }
    watch->processes[watch->n_processes++] =
        process_create(order->number, order->argv, order->limit_ms, order->has_progress, &events, now_us);
}

static void carry_out(struct watch *watch, struct order *order, int64_t now_us)
{
    struct process *process = find(watch, order->number);
    switch (order->type) {
    case ORDER_START: start(watch, order, now_us); break;
    case ORDER_SEND:
        if (process) {
            process_send(process, order->bytes, order->n_bytes, now_us);
            order->bytes = NULL;
        }
        break;
    case ORDER_STOP:
        if (process)
            process_stop(process, order->at_once, order->reason, now_us);
        break;
    case ORDER_AWAIT:
        if (process)
            process_await(process, order->is_awaited);
        break;
    case ORDER_QUIT:
        watch->is_quitting = true;
        watch->quit_at_us = now_us + STOP_ALL_US;
        for (size_t i = 0; i < watch->n_processes; i++)
            process_stop(watch->processes[i], false, "the server is stopping", now_us);
        break;
    }
    order_destroy(order);
}

/* While all renderers rest: until one of them is to be looked at; else CALM_POLL_MS. */
static int calm_ms(const struct watch *watch)
{
    const int64_t now_us = run_clock_us(&watch->clock);
    int64_t until_us = INT64_MAX;
    for (size_t i = 0; i < watch->n_processes; i++) {
        int64_t rests_us = process_rests_until_us(watch->processes[i], now_us);
        until_us = rests_us < until_us ? rests_us : until_us;
    }
    int64_t ms = (until_us - now_us) / 1000;
    return ms <= CALM_POLL_MS ? CALM_POLL_MS : ms < PROCESS_REST_MS ? (int)ms : PROCESS_REST_MS;
}

static int poll_ms(const struct watch *watch)
{
    bool is_busy = watch->held || watch->is_quitting;
    bool is_blind = false, is_awaited = false;
    for (size_t i = 0; i < watch->n_processes; i++) {
        struct pollfd polled[2];
        size_t n = process_poll(watch->processes[i], polled);
        is_busy |= process_is_throttled(watch->processes[i]);
        is_blind |= n == 0;
        is_awaited |= process_is_awaited(watch->processes[i]);
    }
    if (watch->n_processes == 0 && !is_busy)
        return -1;
    return is_busy ? BUSY_POLL_MS : is_blind ? BLIND_POLL_MS : is_awaited ? AWAITED_POLL_MS : calm_ms(watch);
}

static void wait_for_something(struct watch *watch)
{
    struct pollfd polled[1 + 2 * MAX_PROCESSES];
    polled[0] = (struct pollfd){ .fd = watch->wake_fd, .events = POLLIN };
    size_t n = 1;
    for (size_t i = 0; i < watch->n_processes && !watch->held; i++)
        n += process_poll(watch->processes[i], polled + n);
    const int ms = poll_ms(watch);
    watch->planned_us = ms > 0 ? ms * 1000LL : 0;
    (void)poll(polled, (nfds_t)n, ms);
    uint64_t count;
    if (read(watch->wake_fd, &count, sizeof count) < 0)
        return; /* nothing was ordered */
}

/* Round robin that goes on where the last round stopped: a process that fills the event queue, which ends the round,
 * must not starve the others. */
static void step_next(struct watch *watch, int64_t now_us)
{
    watch->next = watch->next < watch->n_processes ? watch->next : 0;
    struct process *process = watch->processes[watch->next];
    if (watch->is_quitting && now_us >= watch->quit_at_us)
        process_stop(process, true, "", now_us);
    if (process_step(process, &watch->options.silence, now_us)) {
        process_destroy(process);
        watch->processes[watch->next] = watch->processes[--watch->n_processes];
    } else {
        watch->next++;
    }
}

static void *watch_main(void *argument)
{
    struct watch *watch = argument;
    while (!watch->is_quitting || watch->n_processes > 0) {
        wait_for_something(watch);
        run_clock_step(&watch->clock, watch->planned_us + LONGEST_STEP_MS * 1000LL);
        int64_t now_us = run_clock_us(&watch->clock);
        for (struct order *order; (order = queue_try_take(watch->orders));)
            carry_out(watch, order, now_us);
        flush_held(watch);
        for (size_t n = watch->n_processes; n > 0 && (!watch->held || watch->is_quitting); n--)
            step_next(watch, now_us);
    }
    return NULL;
}

struct watch *watch_create(const struct watch_options *options, struct error *err)
{
    struct watch *watch = mem_new(sizeof *watch);
    watch->options = *options;
    watch->last_held = &watch->held;
    watch->orders = queue_create(options->max_orders > 0 ? (size_t)options->max_orders : ORDER_CAPACITY, order_destroy);
    watch->events = queue_create(EVENT_CAPACITY, event_drop);
    watch->wake_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    int failed = watch->wake_fd < 0 ? errno : pthread_create(&watch->thread, NULL, watch_main, watch);
    if (failed) {
        error_set(err, ERROR_IO, "the thread that watches renderers cannot be started: %s", strerror(failed));
        if (watch->wake_fd >= 0)
            close(watch->wake_fd);
        queue_destroy(watch->orders);
        queue_destroy(watch->events);
        free(watch);
        return NULL;
    }
    return watch;
}

void watch_destroy(struct watch *watch)
{
    if (!watch)
        return;
    while (!put_order(watch, order_new(ORDER_QUIT, 0)))
        poll(NULL, 0, 1);
    pthread_join(watch->thread, NULL);
    while (watch->held) {
        struct held_event *next = watch->held->next;
        watch_event_destroy(watch->held->event);
        free(watch->held);
        watch->held = next;
    }
    queue_destroy(watch->orders);
    queue_destroy(watch->events);
    close(watch->wake_fd);
    free(watch);
}
