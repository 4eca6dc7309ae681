/* Makes, keeps and ends streams, and notes when what they show has changed. */
#include "server/room/streams/stream.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/room/out/send.h"
#include "server/room/state/event.h"
#include "server/room/state/reach.h"
#include "server/room/streams/display.h"
#include "server/wire/json_merge.h"

struct stream *stream_shared(const struct room *room, const cJSON *view)
{
    for (struct stream *stream = room->streams.first; stream; stream = stream->next)
        if (stream->is_shared && views_are_alike(stream->view, view))
            return stream;
    return NULL;
}

static void start_pace(struct room *room, struct stream *stream)
{
    pace_start(&stream->pace, room->renderer.is_software);
}

static void stream_changed(struct room *room, struct stream *stream)
{
    stream->version++;
    stream->changed_us = room->now_us;
    if (!stream->behind_us)
        stream->behind_us = room->now_us;
}

/* Like stream_changed, for a change of the scene. */
static void stream_reached(struct room *room, struct stream *stream)
{
    stream_changed(room, stream);
    stream->scene_version = stream->version;
}

void stream_again(struct room *room, struct stream *stream)
{
    stream_changed(room, stream);
}

static void destroy_unseen_obliques(struct room *room)
{
    for (struct stream *stream = room->streams.first, *next; stream; stream = next) {
        next = stream->next;
        if (stream->is_shared && stream->kind == SCENE_KIND_OBLIQUE && !stream->viewers && !stream->displays)
            stream_destroy(room, stream);
    }
}

struct stream *stream_create(struct room *room, cJSON *view, bool is_shared)
{
    struct stream *stream = mem_new(sizeof *stream);
    if (is_shared)
        destroy_unseen_obliques(room);
    stream->view = view;
    stream->number = ++room->streams.n_made;
    stream->n_document = ++room->streams.n_documents;
    stream->kind = view_kind(view);
    stream->is_shared = is_shared;
    stream->scene_is_stale = true;
    stream->next = room->streams.first;
    room->streams.first = stream;
    start_pace(room, stream);
    stream_reached(room, stream);
    if (is_shared)
        room_event(room, ROOM_VIEWS, NULL);
    return stream;
}

static bool forget_requests(struct room *room, struct stream *stream)
{
    bool has_some = false;
    for (int i = 0; i < 2; i++)
        if (stream->requests[i].number) {
            room->callbacks.forget(room->callbacks.context, room, stream->requests[i].number);
            stream->requests[i].number = 0;
            has_some = true;
        }
    return has_some;
}

/* The requests of a shared stream without viewers are forgotten; the next viewer needs them requested again. */
static void forget_unseen(struct room *room, struct stream *stream)
{
    if (!forget_requests(room, stream))
        return;
    stream->requested_version = stream->latest_version;
    stream->still_requested_version = stream->latest_is_still ? stream->latest_version : 0;
}

void stream_add_viewer(struct stream *stream, struct member_view *view)
{
    view->stream = stream;
    view->previous_viewer = NULL;
    view->next_viewer = stream->viewers;
    if (view->next_viewer)
        view->next_viewer->previous_viewer = view;
    stream->viewers = view;
}

void stream_remove_viewer(struct room *room, struct member_view *view)
{
    struct stream *stream = view->stream;
    if (stream->least_lagging == view)
        stream->least_lagging = NULL;
    if (view->previous_viewer)
        view->previous_viewer->next_viewer = view->next_viewer;
    else
        stream->viewers = view->next_viewer;
    if (view->next_viewer)
        view->next_viewer->previous_viewer = view->previous_viewer;
    view->stream = NULL;
    view->next_viewer = view->previous_viewer = NULL;
    stream_left(room, stream);
}

void stream_left(struct room *room, struct stream *stream)
{
    if (stream->viewers || stream->displays)
        return;
    if (!stream->is_shared || stream->is_of_display)
        stream_destroy(room, stream);
    else
        forget_unseen(room, stream);
}

static void end_displays(struct stream *stream)
{
    while (stream->displays) {
        struct room_display *display = stream->displays;
        stream->displays = display->next;
        display->callbacks.ended(display->callbacks.context);
        free(display);
    }
}

void stream_destroy(struct room *room, struct stream *stream)
{
    end_displays(stream);
    (void)forget_requests(room, stream);
    struct stream **at = &room->streams.first;
    while (*at != stream)
        at = &(*at)->next;
    *at = stream->next;
    if (room->streams.main == stream)
        room->streams.main = NULL;
    frame_unref(stream->latest);
    send_view_forget(stream);
    cJSON_Delete(stream->view);
    cJSON_Delete(stream->scene);
    free(stream);
}

bool stream_set_view(struct room *room, struct stream *stream, cJSON *view)
{
    if (json_equal(stream->view, view)) {
        cJSON_Delete(view);
        return false;
    }
    assert(!stream->is_shared || views_are_alike(stream->view, view));
    send_view_forget(stream);
    cJSON_Delete(stream->view);
    stream->view = view;
    stream->n_document = ++room->streams.n_documents;
    stream->scene_is_stale = true;
    if (stream->is_shared)
        room_event(room, ROOM_VIEWS, NULL);
    if (stream->kind != view_kind(view)) {
        stream->kind = view_kind(view);
        start_pace(room, stream);
    }
    stream_changed(room, stream);
    return true;
}

void streams_changed(struct room *room, bool scene_is_new)
{
    for (struct stream *stream = room->streams.first; stream; stream = stream->next) {
        stream->scene_is_stale = stream->scene_is_stale || scene_is_new;
        stream_reached(room, stream);
    }
}

void streams_scene_changed(struct room *room, const cJSON *before, const cJSON *patch)
{
    for (struct stream *stream = room->streams.first; stream; stream = stream->next) {
        stream->is_reached =
            view_has_override(stream->view) || change_reaches(stream->view, before, room->shared.scene, patch);
        stream->scene_is_stale = true;
        if (stream->is_reached)
            stream_reached(room, stream);
    }
}

void streams_forget_requests(struct room *room)
{
    for (struct stream *stream = room->streams.first; stream; stream = stream->next) {
        memset(stream->requests, 0, sizeof stream->requests);
        stream->requested_version = stream->still_requested_version = 0;
        stream->refused_version = 0;
        stream->retry_us = 0;
        stream->n_failed = 0;
    }
}

static void report_removed_override(struct room *room, const struct stream *stream, const struct problem *problem)
{
    for (const struct member_view *view = stream->viewers; view; view = view->next_viewer) {
        struct member *member = view->member;
        int index = (int)(view - member->views);
        if (!member->connection || view_is_watch(view))
            continue;
        send_view(room, member, index, stream->mover);
        (void)send_problem(room, member->connection, message_descriptions[MESSAGE_VIEW_OPEN].name, index + 1, 0,
                           problem);
    }
}

void streams_remove_bad_overrides(struct room *room)
{
    for (struct stream *stream = room->streams.first; stream; stream = stream->next) {
        struct problem problem = { 0 };
        if (override_is_valid(room, stream->view, &problem) || problem.type == PROBLEM_INTERNAL)
            continue; /* without memory nothing is known of it; a request that finds it bad says so */
        cJSON_DeleteItemFromObjectCaseSensitive(stream->view, "override");
        send_view_forget(stream);
        stream->scene_is_stale = true;
        stream_changed(room, stream);
        report_removed_override(room, stream, &problem);
    }
}

void streams_restart_pace(struct room *room)
{
    for (struct stream *stream = room->streams.first; stream; stream = stream->next)
        start_pace(room, stream);
}

/* ---- kept views ------------------------------------------------------------------------------------------------- */

/* A layout that is none changes nothing. */
static void read_walls(struct room *room, const char *layout)
{
    for (size_t i = 0; i < wire_wall_layout_words.n; i++)
        if (strcmp(layout, wire_wall_layout_words.words[i]) == 0)
            room->walls.layout = (enum wire_wall_layout)i;
}

char *streams_write(const struct room *room)
{
    cJSON *list = cJSON_CreateArray();
    for (const struct stream *stream = room->streams.first; stream; stream = stream->next) {
        if (!stream->is_shared || stream->is_of_display)
            continue;
        cJSON *item = cJSON_CreateObject();
        json_add(item, "view", cJSON_Duplicate(stream->view, true));
        cJSON_AddStringToObject(item, "mover", stream->mover);
        json_append(list, item);
    }
    if (room->walls.layout != WIRE_WALL_LAYOUT_FOUR) {
        cJSON *item = cJSON_CreateObject();
        cJSON_AddStringToObject(item, "walls", wire_wall_layout_words.words[room->walls.layout]);
        json_append(list, item);
    }
    char *text = list ? json_print(list) : NULL;
    cJSON_Delete(list);
    return text;
}

void streams_read(struct room *room, const cJSON *list)
{
    const cJSON *item;
    int n = 0;
    cJSON_ArrayForEach(item, list)
    {
        struct problem problem = { 0 };
        const cJSON *kept = cJSON_GetObjectItemCaseSensitive(item, "view");
        if (!kept && json_text(item, "walls")) {
            read_walls(room, json_text(item, "walls"));
            continue;
        }
        cJSON *view = kept && n++ < 64 ? view_document_patch(NULL, kept, &problem) : NULL;
        if (!view) {
            log_error("room %s: a kept view is left out: %s", room->id, problem.detail);
            continue;
        }
        if (stream_shared(room, view)) {
            cJSON_Delete(view);
            continue;
        }
        const char *mover = json_text(item, "mover");
        struct stream *stream = stream_create(room, view, true);
        (void)snprintf(stream->mover, sizeof stream->mover, "%s", mover && id_is_valid(mover) ? mover : "");
    }
}
