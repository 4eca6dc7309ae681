/* Adds displays to the room's shared streams and removes them. */
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/room/streams/display.h"
#include "server/room/streams/stream.h"

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

static void show(struct room *room, struct room_display *display, struct stream *stream)
{
    if (!display_show(room, display, stream))
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
