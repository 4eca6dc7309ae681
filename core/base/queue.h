#pragma once
/* A bounded first-in first-out queue between threads. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct queue;

/* capacity >= 1; drop frees what is still inside at the end (NULL: nothing). */
struct queue *queue_create(size_t capacity, void (*drop)(void *item));
void queue_destroy(struct queue *queue);

/* Takes item when it returns true; false when full or closed, and the item stays the caller's. Any thread; never
 * blocks. */
bool queue_try_put(struct queue *queue, void *item);

/* The oldest item, or NULL when empty. Never blocks. */
void *queue_try_take(struct queue *queue);

/* Waits up to timeout_ms (negative: for ever) for an item; NULL on time out or when closed and empty. */
void *queue_take(struct queue *queue, int64_t timeout_ms);

/* No more puts; takers wake and drain what is left. */
void queue_close(struct queue *queue);
size_t queue_length(struct queue *queue);
