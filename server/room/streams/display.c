/* Adds displays to the room's shared streams, gives them pictures, and removes them. */
#include "server/room/streams/display.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/room/streams/stream.h"

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

/* ---- which view they show --------------------------------------------------------------------------------------- */

static bool is_of_kind(const struct stream *stream, int kind)
{
    return stream && stream->is_shared && stream->kind == kind;
}

/* The presenter's first view of this kind. */
static struct stream *presented(const struct room *room, int kind)
{
    for (int i = 0; room->presenter && i < ROOM_MAX_VIEWS; i++)
        if (is_of_kind(room->presenter->views[i].stream, kind))
            return room->presenter->views[i].stream;
    return NULL;
}

/* The shared view of this kind with the lowest number. */
static struct stream *shared_of_kind(const struct room *room, int kind)
{
    struct stream *first = NULL;
    for (struct stream *stream = room->streams.first; stream; stream = stream->next)
        if (is_of_kind(stream, kind) &&
            (!first || json_number(stream->view, "number", 1) < json_number(first->view, "number", 1)))
            first = stream;
    return first;
}

static struct room_display **find_main(struct stream *stream)
{
    struct room_display **at = &stream->displays;
    while (*at && !(*at)->is_main)
        at = &(*at)->next;
    return at;
}

/* The display shows this stream from now on. A picture that is there, or on its way, without the words for a draft is
 * requested again. */
static void show(struct room *room, struct room_display *display, struct stream *stream)
{
    display->next = stream->displays;
    display->stream = stream;
    stream->displays = display;
    struct frame *picture = picture_for_displays(room, stream);
    if (picture)
        give(display, picture);
    else if (shows_draft(room, stream))
        stream_again(room, stream);
}

int64_t displays_follow(struct room *room)
{
    struct stream *stream = room->streams.first;
    while (room->streams.main && stream) {
        struct room_display **at = stream == room->streams.main ? NULL : find_main(stream), *display = at ? *at : NULL;
        if (!display) {
            stream = stream->next;
            continue;
        }
        *at = display->next;
        show(room, display, room->streams.main);
        stream_left(room, stream);
        stream = room->streams.first; /* that one may be gone */
    }
    return INT64_MAX;
}

/* A stream that no member has shown: what the room began with, or the home camera. The first member to show the view
 * still decides about its camera and size (is_of_display), as if no display had looked. */
static struct stream *make_shared(struct room *room, int kind, struct problem *problem)
{
    static const int size_px[] = { 1280, 720 };
    if (kind == SCENE_KIND_OBLIQUE) { /* of which plane? */
        problem_set(problem, PROBLEM_NOT_FOUND, "/view", "", "nobody shows an oblique plane in this room");
        return NULL;
    }
    cJSON *patch = cJSON_CreateObject();
    cJSON_AddStringToObject(patch, "kind", scene_kind_words.words[kind]);
    json_add(patch, "size_px", cJSON_CreateIntArray(size_px, 2));
    cJSON *view = view_document_patch(NULL, patch, problem);
    cJSON_Delete(patch);
    if (!view)
        return NULL;
    struct stream *stream = stream_create(room, stream_first_view(room, view), true);
    stream->is_of_display = true;
    return stream;
}

static struct stream *choose(struct room *room, const char *word, struct problem *problem)
{
    int kind = SCENE_KIND_3D;
    if (!word && room->streams.main)
        return room->streams.main;
    for (size_t i = 0; word && i < scene_kind_words.n; i++)
        if (strcmp(word, scene_kind_words.words[i]) == 0) {
            kind = (int)i;
            word = NULL;
        }
    if (word) {
        problem_set(problem, PROBLEM_VALIDATION, "/view", "enum",
                    "view is \"%.20s\", expected 3d, axial, coronal, sagittal, oblique, beam or beam-slice", word);
        return NULL;
    }
    struct stream *stream = presented(room, kind);
    stream = stream ? stream : shared_of_kind(room, kind);
    return stream ? stream : make_shared(room, kind, problem);
}

struct room_display *display_add(struct room *room, const char *view, const struct room_display_callbacks *callbacks,
                                 struct problem *problem)
{
    int n = 0;
    for (const struct stream *stream = room->streams.first; stream; stream = stream->next)
        for (const struct room_display *display = stream->displays; display; display = display->next)
            n++;
    if (n >= ROOM_MAX_DISPLAYS) {
        problem_set(problem, PROBLEM_LIMIT, "", "", "%d displays show this room already, at most %d may", n,
                    ROOM_MAX_DISPLAYS);
        problem->retry_after_ms = ROOM_DISPLAY_RETRY_MS;
        return NULL;
    }
    struct stream *stream = choose(room, view, problem);
    if (!stream)
        return NULL;
    struct room_display *display = mem_new(sizeof *display);
    *display = (struct room_display){ .room = room, .callbacks = *callbacks, .is_main = !view };
    show(room, display, stream);
    return display;
}

const char *room_display_kind(const struct room_display *display)
{
    return scene_kind_words.words[display->stream->kind];
}

struct room *display_remove(struct room_display *display)
{
    struct room *room = display->room;
    struct stream *stream = display->stream;
    struct room_display **at = &stream->displays;
    while (*at != display)
        at = &(*at)->next;
    *at = display->next;
    stream_left(room, stream);
    free(display);
    return room;
}
