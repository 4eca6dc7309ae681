/* Chooses the main view of a room. */
#include "server/room/streams/main_view.h"

#include <string.h>

#include "server/wire/json.h"

static void acted(struct member *member, int number)
{
    if (!member->has_told_active)
        member->active = number;
}

void main_view_patched(struct member *member, int number, const cJSON *patch)
{
    bool is_act = false;
    for (const cJSON *field = patch->child; field; field = field->next)
        is_act = is_act || strcmp(field->string, "size_px") != 0;
    if (!is_act)
        return;
    member->worked = number;
    acted(member, number);
}

void main_view_scene_patched(struct member *member, int number, const cJSON *patch)
{
    /* what a drag, a wheel, a slider or a tap in a pane changes: not what a click in a list does */
    static const char *const fields[] = { "image", "beam", "clip", "measures" };
    for (size_t i = 0; i < sizeof fields / sizeof fields[0]; i++)
        if (cJSON_GetObjectItemCaseSensitive(patch, fields[i]))
            member->worked = number;
    acted(member, number);
}

void main_view_active(struct member *member, int number)
{
    member->active = number;
    member->has_told_active = true;
}

static struct stream *shared_of(const struct member *member, int number)
{
    struct stream *stream = number > 0 ? member->views[number - 1].stream : NULL;
    return stream && stream->is_shared ? stream : NULL;
}

static struct stream *shown_by(const struct member *presenter)
{
    struct stream *stream = shared_of(presenter, presenter->active);
    for (int number = 1; !stream && number <= ROOM_MAX_VIEWS; number++)
        stream = shared_of(presenter, number);
    return stream;
}

/* The 3-D view with the lowest number, else any. */
static struct stream *any_shared(const struct room *room)
{
    struct stream *best = NULL;
    for (struct stream *stream = room->streams.first; stream; stream = stream->next) {
        if (!stream->is_shared || stream->is_of_display)
            continue;
        const bool is_space = stream->kind == SCENE_KIND_3D, best_is = best && best->kind == SCENE_KIND_3D;
        if (!best || (is_space && !best_is) ||
            (is_space == best_is && json_number(stream->view, "number", 1) < json_number(best->view, "number", 1)))
            best = stream;
    }
    return best;
}

int64_t main_view_settle(struct room *room)
{
    struct stream *shown = room->presenter ? shown_by(room->presenter) : NULL;
    if (shown)
        room->streams.main = shown;
    if (!room->streams.main)
        room->streams.main = any_shared(room);
    return INT64_MAX;
}
