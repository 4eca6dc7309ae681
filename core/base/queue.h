#pragma once
/* A bounded first-in first-out queue of pointers between threads. Every function: any thread. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct queue;

/* capacity >= 1. drop frees the items that are left when the queue is destroyed; NULL: they are not freed. */
struct queue *queue_create(size_t capacity, void (*drop)(void *item));
void queue_destroy(struct queue *queue);

/* True: the queue has taken item. False: it is full or closed, and item stays the caller's. Never blocks. */
bool queue_try_put(struct queue *queue, void *item);

/* The oldest item, or NULL when empty. Never blocks. */
void *queue_try_take(struct queue *queue);

/* Waits up to timeout_ms for an item (negative: without limit). NULL: timed out, or closed and empty. */
void *queue_take(struct queue *queue, int64_t timeout_ms);

/* Further puts fail. Waiting takers wake; the remaining items can still be taken. */
void queue_close(struct queue *queue);
size_t queue_length(struct queue *queue);
