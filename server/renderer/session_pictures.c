#include "server/renderer/session_parts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/log.h"
#include "core/base/mem.h"
#include "core/render/visible/visible.h"
#include "server/wire/document.h"

enum { WARM_UP_PX = 64 };
#define WARM_UP_ID UINT64_MAX /* never the id of a request, so its picture is dropped */

/* ---- what pictures show: the rooms' scenes, a scene and a view of their own ------------------------------------- */

static struct room_scene *find_room(struct session *session, const char *id)
{
    for (size_t i = 0; id && i < session->n_rooms; i++)
        if (strcmp(session->rooms[i].id, id) == 0)
            return &session->rooms[i];
    return NULL;
}

/* NULL: there are SCENE_MAX_ROOMS already. */
static struct room_scene *add_room(struct session *session, const char *id)
{
    if (session->n_rooms == SCENE_MAX_ROOMS)
        return NULL;
    if (session->n_rooms == session->room_capacity) {
        size_t capacity = session->room_capacity ? 2 * session->room_capacity : 16;
        struct room_scene *rooms = mem_new(capacity * sizeof rooms[0]);
        if (session->n_rooms)
            memcpy(rooms, session->rooms, session->n_rooms * sizeof rooms[0]);
        free(session->rooms);
        session->rooms = rooms;
        session->room_capacity = capacity;
    }
    struct room_scene *room = &session->rooms[session->n_rooms++];
    *room = (struct room_scene){ .revision = 0 };
    (void)snprintf(room->id, sizeof room->id, "%s", id);
    return room;
}

void pictures_take_scene(struct session *session, cJSON *json)
{
    const char *id = json_text(json, "room");
    double revision = json_number(json, "revision", -1);
    struct room_scene *room = find_room(session, id);
    bool is_good = id && id_is_valid(id) && revision >= 0 && revision <= UINT32_MAX;
    if (is_good && !room)
        room = add_room(session, id);
    if (!is_good || !room) {
        log_error("a scene of a room that cannot be kept");
        return;
    }
    cJSON_Delete(room->scene);
    room->scene = cJSON_DetachItemFromObjectCaseSensitive(json, "scene");
    room->revision = (uint32_t)revision;
}

void pictures_forget_room(struct session *session, const char *id)
{
    struct room_scene *room = find_room(session, id);
    if (!room)
        return;
    cJSON_Delete(room->scene);
    *room = session->rooms[--session->n_rooms];
}

/* A problem with a part of what was asked: its pointer goes below the part's name. */
static void say_problem_in(struct session *session, uint64_t id, const char *part, const struct problem *problem)
{
    struct problem whole = *problem;
    (void)snprintf(whole.pointer, sizeof whole.pointer, "/%s%.140s", part, problem->pointer);
    session_say_problem(session, id, &whole);
}

struct snapshot *pictures_read_snapshot(struct session *session, uint64_t id, const cJSON *json, uint32_t *revision)
{
    const cJSON *document = cJSON_GetObjectItemCaseSensitive(json, "scene");
    const cJSON *view_document = cJSON_GetObjectItemCaseSensitive(json, "view");
    const char *room_id = json_text(json, "room");
    const struct room_scene *room = find_room(session, room_id);
    struct problem problem = { 0 };
    struct scene scene;
    struct view view;
    *revision = (uint32_t)fmax(0, fmin(UINT32_MAX, json_number(json, "scene_revision", room ? room->revision : 0)));
    if (!document && room_id && !room) {
        problem_set(&problem, PROBLEM_NOT_FOUND, "/room", "", "nothing is known of room \"%.64s\"", room_id);
        session_say_problem(session, id, &problem);
        return NULL;
    }
    if (!document)
        document = room ? room->scene : session->default_scene;
    if (!scene_read(document, &scene, &problem)) {
        say_problem_in(session, id, "scene", &problem);
        return NULL;
    }
    cJSON *nothing = view_document ? NULL : cJSON_CreateObject();
    bool is_read = view_read(view_document ? view_document : nothing, &view, &problem);
    cJSON_Delete(nothing);
    if (!is_read) {
        scene_finish(&scene);
        say_problem_in(session, id, "view", &problem);
        return NULL;
    }
    char field[128] = "";
    struct error err = { 0 };
    struct snapshot *snapshot = snapshot_create(session->derived, &scene, &view, *revision, field, &err);
    if (!snapshot) {
        problem_from_error(&problem, &err);
        if (problem.type == PROBLEM_NOT_FOUND)
            problem.type = PROBLEM_VALIDATION; /* it is a field that names what is not there */
        (void)snprintf(problem.pointer, sizeof problem.pointer, "%s", field);
        say_problem_in(session, id, strncmp(field, "/camera", 7) == 0 ? "view" : "scene", &problem);
    }
    return snapshot;
}

/* ---- pictures asked for ----------------------------------------------------------------------------------------- */

static void say_busy(struct session *session, uint64_t id)
{
    struct problem problem;
    problem_set(&problem, PROBLEM_BUSY, "", "", "too many pictures wait to be drawn");
    problem.retry_after_ms = 200;
    session_say_problem(session, id, &problem);
}

static void drawing_end(struct drawing *drawing)
{
    atomic_store(&drawing->id, NO_DRAWING);
    snapshot_unref(drawing->snapshot);
    drawing->snapshot = NULL;
}

static struct drawing *find_drawing(struct session *session, uint64_t id)
{
    for (size_t i = 0; i < MAX_DRAWINGS; i++)
        if (atomic_load(&session->drawings[i].id) == id)
            return &session->drawings[i];
    return NULL;
}

void pictures_drop(struct session *session, uint64_t id)
{
    struct drawing *drawing = find_drawing(session, id);
    if (!drawing)
        return;
    drawing_end(drawing);
    pipeline_drop(session->pipeline, id);
}

void pictures_submit(struct session *session, struct waiting_request *waiting)
{
    struct error err = { 0 };
    struct pipeline_request request = waiting->request;
    struct drawing *drawing = find_drawing(session, request.id);
    if (drawing)
        snapshot_ref(request.snapshot);
    waiting_request_destroy(waiting);
    if (!drawing || pipeline_submit(session->pipeline, &request, &err)) /* none: dropped meanwhile */
        return;
    drawing_end(drawing);
    say_busy(session, request.id);
}

/* Whose turn a picture takes. Two sources with the same number would share one: nothing worse. FNV-1a, 64 bits. */
static uint64_t source_number(const char *source)
{
    uint64_t number = UINT64_C(14695981039346656037);
    for (; source && *source; source++)
        number = (number ^ (uint8_t)*source) * UINT64_C(1099511628211);
    return number;
}

static bool is_one_of(struct session *session, uint64_t id, const cJSON *json, const char *name, const char *first,
                      const char *second, bool *is_second)
{
    const char *word = json_text(json, name);
    *is_second = word && strcmp(word, second) == 0;
    if (!word || *is_second || strcmp(word, first) == 0)
        return true;
    struct problem problem;
    char pointer[32];
    (void)snprintf(pointer, sizeof pointer, "/%s", name);
    problem_set(&problem, PROBLEM_VALIDATION, pointer, "enum", "%s is \"%.40s\", expected \"%s\" or \"%s\"", name, word,
                first, second);
    session_say_problem(session, id, &problem);
    return false;
}

void pictures_draw(struct session *session, uint64_t id, const cJSON *json)
{
    double scale = 100, quality = 85;
    bool is_png, is_light;
    if (session->gl_problem.type != PROBLEM_NONE) {
        session_say_problem(session, id, &session->gl_problem);
        return;
    }
    if (!session_read_number(session, id, json, "scale_percent", 10, 100, &scale) ||
        !session_read_number(session, id, json, "quality", 1, 100, &quality) ||
        !is_one_of(session, id, json, "codec", "jpeg", "png", &is_png) ||
        !is_one_of(session, id, json, "detail", "full", "light", &is_light))
        return;
    uint32_t revision;
    struct snapshot *snapshot = pictures_read_snapshot(session, id, json, &revision);
    if (!snapshot)
        return;
    int width = (int)lround(snapshot->view.size_px[0] * scale / 100),
        height = (int)lround(snapshot->view.size_px[1] * scale / 100);
    struct pipeline_request request = {
        .id = id,
        .source = source_number(json_text(json, "source")),
        .snapshot = snapshot,
        .render = { width > 1 ? width : 1, height > 1 ? height : 1, is_light ? SURFACE_COARSE : SURFACE_FULL,
                    json_flag(json, "still", false) },
        .encode = { is_png ? ENCODE_PNG : ENCODE_JPEG, (int)quality, json_flag(json, "full_color", false) },
    };
    struct drawing *drawing = session->drawings;
    while (drawing < session->drawings + MAX_DRAWINGS && atomic_load(&drawing->id) != NO_DRAWING)
        drawing++;
    if (drawing == session->drawings + MAX_DRAWINGS) {
        snapshot_unref(snapshot);
        say_busy(session, id);
        return;
    }
    drawing->revision = revision;
    drawing->snapshot = snapshot_ref(snapshot);
    drawing->detail = request.render.detail;
    atomic_store(&drawing->id, id);
    struct waiting_request *waiting = waiting_request_create(&request);
    waiting->wanted = &drawing->id;
    if (built_shapes_has_all(session->built_shapes, waiting) || !loader_build_shapes(session->loader, waiting))
        pictures_submit(session, waiting);
}

void pictures_warm_up(struct session *session)
{
    struct scene scene;
    struct view view = view_default;
    struct problem problem;
    struct error err = { 0 };
    char field[128];
    if (session->gl_problem.type != PROBLEM_NONE || !scene_read(session->default_scene, &scene, &problem))
        return;
    view.size_px[0] = view.size_px[1] = WARM_UP_PX;
    struct pipeline_request request = {
        .id = WARM_UP_ID,
        .snapshot = snapshot_create(session->derived, &scene, &view, 0, field, &err),
        .render = { WARM_UP_PX, WARM_UP_PX, SURFACE_COARSE, false },
        .encode = { ENCODE_JPEG, 50, false },
    };
    if (request.snapshot && !pipeline_submit(session->pipeline, &request, &err))
        log_warn("nothing could be drawn ahead: %s", err.text);
}

/* ---- pictures drawn --------------------------------------------------------------------------------------------- */

/* {n, regions: [{region, reason}]}; NULL: nothing is missing. */
static cJSON *missing_of(const struct drawing *drawing)
{
    struct visible_missing missing[VISIBLE_MAX_MISSING];
    size_t n = visible_missing(drawing->snapshot, drawing->detail, missing);
    if (n == 0)
        return NULL;
    cJSON *json = cJSON_CreateObject(), *list = cJSON_AddArrayToObject(json, "regions");
    cJSON_AddNumberToObject(json, "n", (double)n);
    for (size_t i = 0; i < n && i < VISIBLE_MAX_MISSING; i++) {
        cJSON *region = cJSON_CreateObject();
        cJSON_AddStringToObject(region, "region", subject_id(drawing->snapshot->plan, missing[i].subject));
        cJSON_AddStringToObject(region, "reason", missing[i].why.text);
        cJSON_AddItemToArray(list, region);
    }
    return json;
}

void pictures_take_frame(struct session *session, const struct pipeline_frame *frame)
{
    struct drawing *drawing = find_drawing(session, frame->id);
    if (!drawing)
        return;
    if (frame->error.code != ERROR_NONE) {
        drawing_end(drawing);
        struct problem problem;
        problem_from_error(&problem, &frame->error);
        session_add_limit(session, &problem);
        session_say_problem(session, frame->id, &problem);
        return;
    }
    cJSON *json = session_packet("frame");
    cJSON_AddNumberToObject(json, "id", (double)frame->id);
    cJSON_AddNumberToObject(json, "width_px", frame->width_px);
    cJSON_AddNumberToObject(json, "height_px", frame->height_px);
    cJSON_AddNumberToObject(json, "scene_revision", drawing->revision);
    cJSON_AddNumberToObject(json, "render_us", (double)(frame->timing.draw_us + frame->timing.read_us));
    cJSON_AddNumberToObject(json, "encode_us", (double)frame->encode_us);
    cJSON_AddNumberToObject(json, "pixels_per_mm", frame->camera.pixels_per_mm);
    cJSON_AddItemToObject(json, "clip_from_lps_mm", cJSON_CreateDoubleArray(frame->camera.clip_from_lps_mm.m, 16));
    cJSON_AddBoolToObject(json, "is_light", frame->timing.is_coarse);
    cJSON_AddNumberToObject(json, "n_triangles", (double)frame->timing.n_triangles);
    cJSON *missing = missing_of(drawing);
    if (missing)
        cJSON_AddItemToObject(json, "missing", missing);
    drawing_end(drawing);
    session_say(session, json, frame->picture.bytes, frame->picture.n_bytes);
}

/* ---- begin and end ---------------------------------------------------------------------------------------------- */

void pictures_begin(struct session *session)
{
    for (size_t i = 0; i < MAX_DRAWINGS; i++)
        atomic_init(&session->drawings[i].id, NO_DRAWING);
    session->built_shapes = built_shapes_create();
}

void pictures_end(struct session *session)
{
    built_shapes_destroy(session->built_shapes);
    for (size_t i = 0; i < MAX_DRAWINGS; i++)
        snapshot_unref(session->drawings[i].snapshot);
    for (size_t i = 0; i < session->n_rooms; i++)
        cJSON_Delete(session->rooms[i].scene);
    free(session->rooms);
}
