#pragma once
/* Feed: an answer that goes on for as long as its screen looks. Its writer is the net thread, which puts pictures into
 * a mailbox of one; its reader the HTTP thread, which takes one when the screen has taken all of the one before: a slow
 * screen skips pictures, and nothing queues. Either side may leave first. Makes the parts of multipart/x-mixed-replace
 * (proto/http.json). Knows nothing of libmicrohttpd and of rooms. */
#include <stddef.h>

#include "server/room/room.h"

enum { FEED_REPEAT_MS = 2000 }; /* the same picture is sent again, so that a screen can tell that the link is there */

struct feed;
extern const char feed_media_type[];

/* wake(context): there is something for the reader; called on the writer's thread, not after feed_end. */
struct feed *feed_create(void (*wake)(void *context), void *context);

/* The writer's: */
/* Holds picture; kind: that of its view, a constant word. */
void feed_put(struct feed *feed, struct frame *picture, const char *kind);
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
bool feed_is_ended(const struct feed *feed); /* the writer has left */
void feed_leave(struct feed *feed);          /* the reader leaves. NULL is allowed */
