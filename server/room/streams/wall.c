/* Makes the views of walls follow the shared ones, and tells what walls show. */
#include "server/room/streams/wall.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "server/room/out/send.h"
#include "server/room/state/event.h"
#include "server/room/state/member_list.h"
#include "server/room/streams/stream.h"
#include "server/wire/json_merge.h"

static const double least_height_mm = 0.1, largest_height_mm = 10000; /* of camera.height_mm in proto/scene.json */
static const double least_fov_deg = 5, largest_fov_deg = 120;
static const double rad_per_deg = 0.017453292519943295;

bool member_is_wall(const struct member *member)
{
    return member->role == WIRE_MEMBER_ROLE_WALL;
}

/* ---- documents -------------------------------------------------------------------------------------------------- */

static void read_size(const cJSON *view, double size[2])
{
    const cJSON *list = cJSON_GetObjectItemCaseSensitive(view, "size_px");
    for (int i = 0; i < 2; i++)
        size[i] = cJSON_GetArrayItem(list, i)->valuedouble;
}

/* Extent and field of view of a camera are those of a picture's smaller side: by how much they grow, so that all of
 * the shared picture is in one of another shape. 1 where the shape is the same. */
static double growth(const cJSON *shared, const cJSON *own)
{
    double from[2], to[2];
    read_size(shared, from);
    read_size(own, to);
    return fmin(to[0], to[1]) / fmin(from[0], from[1]) / fmin(to[0] / from[0], to[1] / from[1]);
}

static void grow_camera(cJSON *view, double factor)
{
    cJSON *camera = cJSON_GetObjectItemCaseSensitive(view, "camera"),
          *height = cJSON_GetObjectItemCaseSensitive(camera, "height_mm"),
          *fov = cJSON_GetObjectItemCaseSensitive(camera, "fov_deg");
    if (cJSON_IsNumber(height))
        cJSON_SetNumberValue(height, fmin(fmax(height->valuedouble * factor, least_height_mm), largest_height_mm));
    if (cJSON_IsNumber(fov)) {
        const double own_deg = 2 * atan(tan(fov->valuedouble / 2 * rad_per_deg) * factor) / rad_per_deg;
        cJSON_SetNumberValue(fov, fmin(fmax(own_deg, least_fov_deg), largest_fov_deg));
    }
}

/* The shared document in the size and with the pixel_ratio and foot_px of the wall's; NULL: no memory. */
static cJSON *document_for(const cJSON *shared, const cJSON *own)
{
    static const char *const fields[] = { "size_px", "pixel_ratio", "foot_px" };
    cJSON *view = cJSON_Duplicate(shared, true);
    for (size_t i = 0; view && i < sizeof fields / sizeof fields[0]; i++) {
        cJSON *copy = cJSON_Duplicate(cJSON_GetObjectItemCaseSensitive(own, fields[i]), true);
        if (!copy || !cJSON_ReplaceItemInObjectCaseSensitive(view, fields[i], copy)) {
            cJSON_Delete(copy);
            cJSON_Delete(view);
            return NULL;
        }
    }
    const double factor = growth(shared, own);
    if (view && factor > 1 + 1e-9)
        grow_camera(view, factor);
    return view;
}

/* ---- following -------------------------------------------------------------------------------------------------- */

/* False: no memory, and the stream shows what it showed. */
static bool follow(struct room *room, struct stream *stream)
{
    const struct stream *shared = stream_shared(room, stream->view);
    if (!shared || stream->followed == shared->n_document)
        return true;
    cJSON *view = document_for(shared->view, stream->view);
    if (!view)
        return false;
    stream->followed = shared->n_document;
    (void)snprintf(stream->mover, sizeof stream->mover, "%s", shared->mover);
    if (!stream_set_view(room, stream, view))
        return true;
    for (struct member_view *viewer = stream->viewers; viewer; viewer = viewer->next_viewer) {
        viewer->has_moved = true;
        memcpy(viewer->moved_by, stream->mover, sizeof viewer->moved_by);
    }
    return true;
}

static bool is_same_size(const cJSON *a, const cJSON *b)
{
    static const char *const fields[] = { "size_px", "pixel_ratio", "foot_px" };
    for (size_t i = 0; i < sizeof fields / sizeof fields[0]; i++)
        if (!json_equal(cJSON_GetObjectItemCaseSensitive(a, fields[i]), cJSON_GetObjectItemCaseSensitive(b, fields[i])))
            return false;
    return true;
}

/* The document with which a view begins that nobody has shown: of the wall's, kind, number, plane, size, ratio and
 * foot. */
static cJSON *first_document(const struct room *room, const cJSON *wanted)
{
    static const char *const fields[] = { "kind", "number", "plane", "size_px", "pixel_ratio", "foot_px" };
    cJSON *patch = cJSON_CreateObject();
    for (size_t i = 0; patch && i < sizeof fields / sizeof fields[0]; i++)
        json_add(patch, fields[i], cJSON_Duplicate(cJSON_GetObjectItemCaseSensitive(wanted, fields[i]), true));
    cJSON *view = patch ? view_document_patch(NULL, patch, NULL) : NULL;
    cJSON_Delete(patch);
    return view ? stream_first_view(room, view) : NULL;
}

struct stream *wall_stream(struct room *room, cJSON *document, struct problem *problem)
{
    for (struct stream *stream = room->streams.first; stream; stream = stream->next)
        if (stream->is_of_wall && views_are_alike(stream->view, document) && is_same_size(stream->view, document)) {
            cJSON_Delete(document);
            return stream;
        }
    cJSON *view = first_document(room, document);
    cJSON_Delete(document);
    if (!view) {
        (void)json_no_memory(problem, "a view");
        return NULL;
    }
    struct stream *stream = stream_create(room, view, false);
    stream->is_of_wall = true;
    (void)follow(room, stream); /* else tried again by walls_follow */
    return stream;
}

int64_t wall_due_us(const struct stream *stream)
{
    return stream->wall_requested_us + WALL_EVERY_US;
}

/* ---- what walls show -------------------------------------------------------------------------------------------- */

static const struct stream *worked_in(const struct room *room)
{
    const struct member *presenter = room->presenter;
    const struct stream *acted =
        presenter && presenter->worked > 0 ? presenter->views[presenter->worked - 1].stream : NULL;
    return acted && acted->is_shared ? acted : room->streams.main;
}

static cJSON *name_of(const cJSON *view)
{
    const char *kind = json_text(view, "kind"), *plane = json_text(view, "plane");
    cJSON *name = cJSON_CreateObject();
    cJSON_AddStringToObject(name, "kind", kind ? kind : "3d");
    cJSON_AddNumberToObject(name, "number", json_number(view, "number", 1));
    cJSON_AddStringToObject(name, "plane", plane ? plane : "");
    return name;
}

static void fill(const struct room *room, struct message *message)
{
    const struct stream *active = worked_in(room);
    *message = (struct message){ .type = MESSAGE_WALL };
    message->wall.layout = room->walls.layout;
    message->wall.active = active ? name_of(active->view) : NULL;
    message->wall.views = cJSON_CreateArray();
    for (int i = 0; room->presenter && i < ROOM_MAX_VIEWS; i++) {
        const struct member_view *view = &room->presenter->views[i];
        if (!view->stream || !view->stream->is_shared)
            continue;
        cJSON *entry = name_of(view->stream->view);
        json_add(entry, "size_px", cJSON_CreateIntArray(view->size_px, 2));
        json_append(message->wall.views, entry);
    }
}

void walls_show(struct room *room, struct member *member)
{
    struct message message;
    fill(room, &message);
    send_to_member(room, member, &message);
    message_finish(&message);
}

static void put(uint64_t *key, uint64_t value)
{
    *key = (*key ^ value) * UINT64_C(1099511628211); /* FNV-1a */
}

/* A number that is another one when the message wall says something else. */
static uint64_t key_of(const struct room *room)
{
    const struct stream *active = worked_in(room);
    uint64_t key = UINT64_C(14695981039346656037);
    put(&key, (uint64_t)room->walls.layout);
    put(&key, active ? active->number : 0);
    for (int i = 0; room->presenter && i < ROOM_MAX_VIEWS; i++) {
        const struct member_view *view = &room->presenter->views[i];
        put(&key, view->stream && view->stream->is_shared ? view->stream->number : 0);
        put(&key, (uint64_t)view->size_px[0] << 16 | (uint64_t)view->size_px[1]);
    }
    return key;
}

int64_t walls_follow(struct room *room)
{
    bool has_walls = false, is_done = true;
    for (struct stream *stream = room->streams.first; stream; stream = stream->next)
        if (stream->is_of_wall) {
            has_walls = true;
            is_done = follow(room, stream) && is_done;
        }
    const uint64_t key = has_walls ? key_of(room) : 0;
    if (has_walls && key != room->walls.told) {
        room->walls.told = key;
        for (int i = 0; i < room->members.n; i++)
            if (member_is_wall(room->members.list[i]))
                walls_show(room, room->members.list[i]);
    }
    return is_done ? INT64_MAX : room->now_us + RETRY_US;
}

bool wall_layout_set(struct room *room, struct member *member, const struct message *message, struct problem *problem)
{
    if (!member_presents(room, member))
        return refuse_not_presenter(room, problem, "choose what walls show");
    if (room->walls.layout == message->wall_layout.layout)
        return true;
    room->walls.layout = message->wall_layout.layout;
    room_event(room, ROOM_VIEWS, NULL);
    for (int i = 0; i < room->members.n; i++)
        if (!member_is_wall(room->members.list[i])) /* walls: walls_follow */
            walls_show(room, room->members.list[i]);
    return true;
}
