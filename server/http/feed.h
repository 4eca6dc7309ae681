#pragma once
/* Feed: an answer that goes on for as long as its reader stays. Its writer is the net thread, its reader the HTTP
 * thread; either may leave first. A feed of pictures has a mailbox of one, from which a picture is taken when the
 * screen has taken all of the one before: a slow screen skips pictures, and nothing queues. It makes the parts of
 * multipart/x-mixed-replace (proto/http.json). A feed of texts loses none: a slow reader is left behind and told so.
 * Knows nothing of libmicrohttpd and of rooms. */
#include <stddef.h>

#include "server/room/room.h"

enum { FEED_REPEAT_MS = 2000 }; /* the same picture is sent again, so that a screen can tell that the link is there */

struct feed;
extern const char feed_media_type[];

/* wake(context): there is something for the reader; called on the writer's thread, not after feed_end. */
struct feed *feed_create(void (*wake)(void *context), void *context);
struct feed *feed_create_of_texts(void (*wake)(void *context), void *context);

/* The writer's: */
/* Holds picture; kind: that of its view, a constant word. */
void feed_put(struct feed *feed, struct frame *picture, const char *kind);
/* Queues a text of a feed of texts. False: the reader is too slow, or there was no memory; the feed takes no more, and
 * the reader is told so behind what it has. */
bool feed_put_text(struct feed *feed, const char *text);
void feed_close_texts(struct feed *feed);        /* the reader's end comes when it has taken all; feed_end follows */
bool feed_has_room(const struct feed *feed);     /* the last picture was taken */
void feed_late(struct feed *feed, bool is_late); /* what is shown is not the newest state */
void feed_end(struct feed *feed);                /* the writer leaves: there will be nothing more */

/* The reader's: */
/* Copies at most size bytes. 0: nothing now. At the end of a part the next one is begun only if is_free: the screen has
 * taken all so far. */
size_t feed_read(struct feed *feed, char *bytes, size_t size, bool is_free, int64_t now_us);
bool feed_is_inside(const struct feed *feed); /* a part has been begun and not been read to its end */
/* feed_read would give bytes to a screen that is free. */
bool feed_is_due(const struct feed *feed, int64_t now_us);
/* Goes out whatever the reader has not taken yet, as nothing of it may be skipped. */
bool feed_is_eager(const struct feed *feed);
bool feed_is_ended(const struct feed *feed); /* the writer has left */
void feed_leave(struct feed *feed);          /* the reader leaves. NULL is allowed */
