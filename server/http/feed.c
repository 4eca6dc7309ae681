/* Passes pictures and texts from the net thread to the HTTP thread, and makes parts of pictures. */
#include "server/http/feed.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mailbox.h"
#include "core/base/mem.h"
#include "server/http/feed_texts.h"
#include "server/wire/missing.h"

#define BOUNDARY "--beamroom\r\n"
const char feed_media_type[] = "multipart/x-mixed-replace; boundary=beamroom";
/* The boundary stands behind each part, too, as browsers show a part when they have read the next boundary. */
static const char part_end[] = "\r\n" BOUNDARY;

struct feed {
    void (*wake)(void *context);
    void *context;
    struct mailbox *box;
    atomic_bool is_full, is_late, is_ended;
    atomic_int sides;         /* that have not left */
    struct feed_texts *texts; /* NULL: a feed of pictures, which alone has what follows */
    /* the reader's */
    struct letter *letter; /* of the part; NULL: none came yet */
    int64_t begun_us;      /* the part */
    unsigned long n_pictures;
    bool said_late; /* in the part */
    char head[1024 + MISSING_MAX_REGIONS * 66];
    size_t n_head, at, n_part; /* at: of n_part bytes read */
};

struct letter {
    struct frame *picture;
    const char *kind; /* of its view */
};

static void drop(void *letter)
{
    if (letter)
        frame_unref(((struct letter *)letter)->picture);
    free(letter);
}

struct feed *feed_create(void (*wake)(void *context), void *context)
{
    struct feed *feed = mem_new(sizeof *feed);
    feed->wake = wake;
    feed->context = context;
    feed->box = mailbox_create(drop);
    atomic_init(&feed->is_full, false);
    atomic_init(&feed->is_late, false);
    atomic_init(&feed->is_ended, false);
    atomic_init(&feed->sides, 2);
    memcpy(feed->head, BOUNDARY, strlen(BOUNDARY));
    feed->n_head = feed->n_part = strlen(BOUNDARY);
    return feed;
}

struct feed *feed_create_of_texts(void (*wake)(void *context), void *context)
{
    struct feed *feed = feed_create(wake, context);
    feed->texts = feed_texts_create();
    return feed;
}

static void side_left(struct feed *feed)
{
    if (atomic_fetch_sub(&feed->sides, 1) > 1)
        return;
    feed_texts_destroy(feed->texts);
    mailbox_destroy(feed->box);
    drop(feed->letter);
    free(feed);
}

/* ---- the writer ------------------------------------------------------------------------------------------------- */

void feed_put(struct feed *feed, struct frame *picture, const char *kind)
{
    struct letter *letter = mem_new(sizeof *letter);
    *letter = (struct letter){ frame_ref(picture), kind };
    atomic_store(&feed->is_full, true); /* before the letter: the reader clears it when it has taken one */
    mailbox_put(feed->box, letter);
    feed->wake(feed->context);
}

bool feed_put_text(struct feed *feed, const char *text)
{
    const bool is_taken = feed_texts_put(feed->texts, text);
    feed->wake(feed->context);
    return is_taken;
}

void feed_close_texts(struct feed *feed)
{
    feed_texts_close(feed->texts);
    feed->wake(feed->context);
}

bool feed_has_room(const struct feed *feed)
{
    return !atomic_load(&feed->is_full);
}

void feed_late(struct feed *feed, bool is_late)
{
    atomic_store(&feed->is_late, is_late);
    feed->wake(feed->context);
}

void feed_end(struct feed *feed)
{
    atomic_store(&feed->is_ended, true);
    feed->wake(feed->context);
    side_left(feed);
}

/* ---- the reader ------------------------------------------------------------------------------------------------- */

static int write_matrix(char *text, size_t size, const float matrix[16])
{
    int n = 0;
    for (int i = 0; i < 16; i++)
        n += snprintf(text + n, size - (size_t)n, "%s%.9g", i ? " " : "", (double)matrix[i]);
    return n;
}

static void begin_part(struct feed *feed, int64_t now_us)
{
    const struct frame *picture = feed->letter->picture;
    const struct frame_header *header = &picture->header;
    char matrix[16 * 24], missing[MISSING_MAX_REGIONS * 66 + 32];
    (void)write_matrix(matrix, sizeof matrix, header->clip_from_lps_mm);
    missing_words(picture->missing, missing, sizeof missing);
    feed->said_late = atomic_load(&feed->is_late);
    int n =
        snprintf(feed->head, sizeof feed->head,
                 "Content-Type: image/jpeg\r\nContent-Length: %zu\r\nBeamroom-Picture: %lu\r\n"
                 "Beamroom-View: %s\r\nBeamroom-Revision: %u\r\nBeamroom-Size: %ux%u\r\nBeamroom-Clip-From-Lps: %s\r\n"
                 "%s%s%s%s\r\n",
                 picture->n_bytes, feed->n_pictures, feed->letter->kind, header->scene_revision, header->width_px,
                 header->height_px, matrix, picture->missing ? "Beamroom-Missing: " : "",
                 picture->missing ? missing : "", picture->missing ? "\r\n" : "",
                 feed->said_late ? "Beamroom-Late: true\r\n" : "");
    feed->n_head = (size_t)n; /* the buffer holds the longest numbers and all of missing */
    feed->at = 0;
    feed->n_part = feed->n_head + picture->n_bytes + strlen(part_end);
    feed->begun_us = now_us;
}

static void copy(const struct feed *feed, char *bytes, size_t n)
{
    const struct frame *picture = feed->letter ? feed->letter->picture : NULL;
    const struct {
        const void *bytes;
        size_t n;
    } pieces[] = { { feed->head, feed->n_head },
                   { picture ? picture->bytes : NULL, picture ? picture->n_bytes : 0 },
                   { part_end, strlen(part_end) } };
    size_t start = 0;
    for (size_t i = 0; i < sizeof pieces / sizeof pieces[0] && n > 0; start += pieces[i++].n) {
        size_t from = feed->at > start ? feed->at - start : 0;
        if (from >= pieces[i].n)
            continue;
        size_t most = pieces[i].n - from, taken = n < most ? n : most;
        memcpy(bytes, (const char *)pieces[i].bytes + from, taken);
        bytes += taken;
        n -= taken;
    }
}

bool feed_is_inside(const struct feed *feed)
{
    return feed->texts ? feed_texts_are_left(feed->texts) : feed->at < feed->n_part;
}

bool feed_is_due(const struct feed *feed, int64_t now_us)
{
    if (feed->texts)
        return feed_texts_are_due(feed->texts, now_us);
    return feed_is_inside(feed) || atomic_load(&feed->is_full) ||
           (feed->letter && (now_us - feed->begun_us >= FEED_REPEAT_MS * INT64_C(1000) ||
                             feed->said_late != atomic_load(&feed->is_late)));
}

bool feed_is_eager(const struct feed *feed)
{
    return feed->texts != NULL;
}

bool feed_is_ended(const struct feed *feed)
{
    return atomic_load(&feed->is_ended) || (feed->texts && feed_texts_are_over(feed->texts));
}

size_t feed_read(struct feed *feed, char *bytes, size_t size, bool is_free, int64_t now_us)
{
    if (feed->texts)
        return feed_texts_read(feed->texts, bytes, size, now_us);
    if (!feed_is_inside(feed)) {
        if (!is_free || !feed_is_due(feed, now_us))
            return 0;
        struct letter *newer = mailbox_take(feed->box);
        atomic_store(&feed->is_full, false);
        if (newer) {
            drop(feed->letter);
            feed->letter = newer;
            feed->n_pictures++;
        }
        if (!feed->letter)
            return 0;
        begin_part(feed, now_us);
    }
    size_t left = feed->n_part - feed->at, n = size < left ? size : left;
    copy(feed, bytes, n);
    feed->at += n;
    return n;
}

void feed_leave(struct feed *feed)
{
    if (feed)
        side_left(feed);
}
