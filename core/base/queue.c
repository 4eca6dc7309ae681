/* A ring buffer with a mutex and a condition variable. */
#define _GNU_SOURCE
#include "core/base/queue.h"

#include <pthread.h>
#include <stdlib.h>
#include <time.h>

#include "core/base/mem.h"

struct queue {
    pthread_mutex_t mutex;
    pthread_cond_t filled;
    void (*drop)(void *item);
    size_t capacity, first, n_items;
    bool is_closed;
    void *items[];
};

struct queue *queue_create(size_t capacity, void (*drop)(void *item))
{
    struct queue *queue = mem_new(sizeof *queue + capacity * sizeof queue->items[0]);
    pthread_condattr_t attributes;
    pthread_mutex_init(&queue->mutex, NULL);
    pthread_condattr_init(&attributes);
    pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    pthread_cond_init(&queue->filled, &attributes);
    pthread_condattr_destroy(&attributes);
    queue->capacity = capacity;
    queue->drop = drop;
    return queue;
}

void queue_destroy(struct queue *queue)
{
    if (!queue)
        return;
    for (void *item; (item = queue_try_take(queue));)
        if (queue->drop)
            queue->drop(item);
    pthread_cond_destroy(&queue->filled);
    pthread_mutex_destroy(&queue->mutex);
    free(queue);
}

bool queue_try_put(struct queue *queue, void *item)
{
    pthread_mutex_lock(&queue->mutex);
    bool fits = !queue->is_closed && queue->n_items < queue->capacity;
    if (fits) {
        queue->items[(queue->first + queue->n_items) % queue->capacity] = item;
        queue->n_items++;
        pthread_cond_signal(&queue->filled);
    }
    pthread_mutex_unlock(&queue->mutex);
    return fits;
}

static void *take_locked(struct queue *queue)
{
    if (queue->n_items == 0)
        return NULL;
    void *item = queue->items[queue->first];
    queue->first = (queue->first + 1) % queue->capacity;
    queue->n_items--;
    return item;
}

void *queue_try_take(struct queue *queue)
{
    pthread_mutex_lock(&queue->mutex);
    void *item = take_locked(queue);
    pthread_mutex_unlock(&queue->mutex);
    return item;
}

void *queue_take(struct queue *queue, int64_t timeout_ms)
{
    struct timespec until;
    clock_gettime(CLOCK_MONOTONIC, &until);
    if (timeout_ms >= 0) {
        until.tv_sec += timeout_ms / 1000;
        until.tv_nsec += timeout_ms % 1000 * 1000000;
        if (until.tv_nsec >= 1000000000) {
            until.tv_sec++;
            until.tv_nsec -= 1000000000;
        }
    }
    pthread_mutex_lock(&queue->mutex);
    while (queue->n_items == 0 && !queue->is_closed) {
        int failed = timeout_ms < 0 ? pthread_cond_wait(&queue->filled, &queue->mutex)
                                    : pthread_cond_timedwait(&queue->filled, &queue->mutex, &until);
        if (failed)
            break;
    }
    void *item = take_locked(queue);
    pthread_mutex_unlock(&queue->mutex);
    return item;
}

void queue_close(struct queue *queue)
{
    pthread_mutex_lock(&queue->mutex);
    queue->is_closed = true;
    pthread_cond_broadcast(&queue->filled);
    pthread_mutex_unlock(&queue->mutex);
}

size_t queue_length(struct queue *queue)
{
    pthread_mutex_lock(&queue->mutex);
    size_t n = queue->n_items;
    pthread_mutex_unlock(&queue->mutex);
    return n;
}
