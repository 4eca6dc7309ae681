#pragma once
/* The texts of a feed: a bounded queue of server-sent events (text/event-stream). Internal to feed.c. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    FEED_TEXTS = 1024,          /* that may wait */
    FEED_TEXTS_BYTES = 2 << 20, /* of these together; a single one, as a whole state, may have more */
    FEED_HEARTBEAT_MS = 15000   /* a comment, where nothing was said for so long */
};

struct feed_texts;
struct feed_texts *feed_texts_create(void);
void feed_texts_destroy(struct feed_texts *texts); /* NULL is allowed */
/* The writer's. False: too many wait or no memory; none is taken from then on. */
bool feed_texts_put(struct feed_texts *texts, const char *text);
void feed_texts_close(struct feed_texts *texts); /* there will be none any more */
/* The reader's. */
size_t feed_texts_read(struct feed_texts *texts, char *bytes, size_t size, int64_t now_us);
bool feed_texts_are_left(const struct feed_texts *texts);
bool feed_texts_are_due(const struct feed_texts *texts, int64_t now_us);
/* Closed, or the reader is behind, and all was read. */
bool feed_texts_are_over(const struct feed_texts *texts);
