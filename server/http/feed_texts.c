/* Queues texts for the HTTP thread. */
#include "server/http/feed_texts.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/base/queue.h"

static const char heartbeat[] = ": still here\n\n";
static const char left_behind[] = "event: behind\ndata: {\"reason\":\"the events were taken too slowly\"}\n\n";

struct text {
    size_t n;
    char bytes[];
};

struct feed_texts {
    struct queue *waiting;
    atomic_size_t n_bytes; /* of those waiting */
    atomic_bool is_behind; /* none is taken any more */
    atomic_bool is_closed;
    struct text *now; /* is being read; the reader's, as what follows */
    size_t at;
    bool has_begun, has_said; /* anything was read; that the reader is behind */
    int64_t said_us;
};

struct feed_texts *feed_texts_create(void)
{
    struct feed_texts *texts = mem_new(sizeof *texts);
    texts->waiting = queue_create(FEED_TEXTS, free);
    atomic_init(&texts->n_bytes, 0);
    atomic_init(&texts->is_behind, false);
    atomic_init(&texts->is_closed, false);
    return texts;
}

void feed_texts_destroy(struct feed_texts *texts)
{
    if (!texts)
        return;
    queue_destroy(texts->waiting);
    free(texts->now);
    free(texts);
}

static struct text *copy_of(const char *bytes)
{
    const size_t n = strlen(bytes);
    struct text *text = malloc(sizeof *text + n);
    if (!text)
        return NULL;
    text->n = n;
    memcpy(text->bytes, bytes, n);
    return text;
}

bool feed_texts_put(struct feed_texts *texts, const char *bytes)
{
    if (atomic_load(&texts->is_behind))
        return false;
    const size_t n_before = atomic_load(&texts->n_bytes);
    struct text *text = n_before == 0 || n_before + strlen(bytes) <= FEED_TEXTS_BYTES ? copy_of(bytes) : NULL;
    if (text)
        atomic_fetch_add(&texts->n_bytes, text->n);
    if (text && queue_try_put(texts->waiting, text))
        return true;
    if (text)
        atomic_fetch_sub(&texts->n_bytes, text->n);
    free(text);
    atomic_store(&texts->is_behind, true);
    return false;
}

void feed_texts_close(struct feed_texts *texts)
{
    atomic_store(&texts->is_closed, true);
}

bool feed_texts_are_left(const struct feed_texts *texts)
{
    return texts->now || atomic_load(&texts->n_bytes) > 0 || (atomic_load(&texts->is_behind) && !texts->has_said);
}

bool feed_texts_are_due(const struct feed_texts *texts, int64_t now_us)
{
    return feed_texts_are_left(texts) ||
           (texts->has_begun && now_us - texts->said_us >= FEED_HEARTBEAT_MS * INT64_C(1000));
}

bool feed_texts_are_over(const struct feed_texts *texts)
{
    return (atomic_load(&texts->is_closed) || atomic_load(&texts->is_behind)) && !feed_texts_are_left(texts);
}

/* The next text; NULL: none. */
static struct text *next(struct feed_texts *texts, int64_t now_us)
{
    struct text *text = queue_try_take(texts->waiting);
    if (text) {
        atomic_fetch_sub(&texts->n_bytes, text->n);
        return text;
    }
    if (atomic_load(&texts->is_behind) && !texts->has_said) {
        texts->has_said = true;
        text = copy_of(left_behind);
    } else if (feed_texts_are_due(texts, now_us)) {
        text = copy_of(heartbeat);
    }
    return text;
}

size_t feed_texts_read(struct feed_texts *texts, char *bytes, size_t size, int64_t now_us)
{
    if (!texts->now) {
        texts->now = next(texts, now_us);
        texts->at = 0;
    }
    if (!texts->now)
        return 0;
    const size_t left = texts->now->n - texts->at, n = left < size ? left : size;
    memcpy(bytes, texts->now->bytes + texts->at, n);
    texts->at += n;
    texts->said_us = now_us;
    texts->has_begun = true;
    if (texts->at == texts->now->n) {
        free(texts->now);
        texts->now = NULL;
    }
    return n;
}
