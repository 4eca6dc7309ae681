/* Gives pictures to displays. */
#include "server/room/streams/display.h"

#include <stdlib.h>

/* A member who takes pictures acknowledges within this time; beyond it, all who look have stalled. */
static const int64_t DISPLAY_ALONE_US = 2000000;

int64_t display_alone_us(const struct stream *stream)
{
    int64_t alone_us = INT64_MIN;
    for (const struct member_view *view = stream->viewers; view; view = view->next_viewer) {
        const int64_t stalled_us = view->sent[view->sent_sequence % ROOM_MAX_UNSHOWN].sent_us + DISPLAY_ALONE_US;
        if (!view_is_watch(view) && stalled_us > alone_us)
            alone_us = stalled_us;
    }
    return alone_us;
}

bool displays_have_credit(const struct stream *stream, uint32_t n_coming, int64_t now_us)
{
    if (n_coming >= ROOM_MAX_UNSHOWN || now_us < display_alone_us(stream))
        return false;
    for (const struct room_display *display = stream->displays; display; display = display->next)
        if (display->callbacks.has_room(display->callbacks.context))
            return true;
    return false;
}

/* True if pictures of the stream are of a draft: as server/renderer/pictures.c has it, whose pictures then are marked.
 */
static bool shows_draft(const struct room *room, const struct stream *stream)
{
    const cJSON *scene = stream->scene ? stream->scene : room->shared.scene,
                *beam = cJSON_GetObjectItemCaseSensitive(scene, "beam"),
                *draft = cJSON_GetObjectItemCaseSensitive(beam, "draft");
    const bool has_planned = cJSON_GetArraySize(cJSON_GetObjectItemCaseSensitive(room->shared.plan, "beams")) > 0;
    return json_flag(draft, "enabled", false) && !(has_planned && json_flag(draft, "shows_planned", false));
}

/* The stream's latest picture as screens are given it; NULL: there is none yet, or it shows a draft without saying so.
 */
static struct frame *picture_for_displays(const struct room *room, const struct stream *stream)
{
    if (stream->latest && stream->latest->marked)
        return stream->latest->marked;
    return shows_draft(room, stream) ? NULL : stream->latest;
}

static void give(const struct room_display *display, struct frame *picture)
{
    display->callbacks.picture(display->callbacks.context, picture, scene_kind_words.words[display->stream->kind]);
}

void displays_send(const struct room *room, const struct stream *stream)
{
    struct frame *picture = stream->displays ? picture_for_displays(room, stream) : NULL;
    for (const struct room_display *display = stream->displays; picture && display; display = display->next)
        give(display, picture);
}

bool display_show(const struct room *room, struct room_display *display, struct stream *stream)
{
    display->next = stream->displays;
    display->stream = stream;
    stream->displays = display;
    struct frame *picture = picture_for_displays(room, stream);
    if (picture)
        give(display, picture);
    return picture || !shows_draft(room, stream);
}

static void tell_late(const struct stream *stream, bool is_late)
{
    for (struct room_display *display = stream->displays; display; display = display->next)
        if (display->is_late != is_late) {
            display->is_late = is_late;
            display->callbacks.late(display->callbacks.context, is_late);
        }
}

int64_t displays_settle(struct room *room)
{
    int64_t due_us = INT64_MAX;
    for (const struct stream *stream = room->streams.first; stream; stream = stream->next) {
        if (!stream->displays)
            continue;
        int64_t late_us = stream->behind_us ? stream->behind_us + DISPLAY_LATE_US : INT64_MAX;
        if (!stream->behind_us && stream->latest && !picture_for_displays(room, stream))
            late_us = room->now_us; /* the words could not be painted */
        tell_late(stream, late_us <= room->now_us);
        if (late_us > room->now_us && late_us < due_us)
            due_us = late_us;
    }
    return due_us;
}

void displays_end(struct stream *stream)
{
    while (stream->displays) {
        struct room_display *display = stream->displays;
        stream->displays = display->next;
        display->callbacks.ended(display->callbacks.context);
        free(display);
    }
}
