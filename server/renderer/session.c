#include "server/renderer/session.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "core/render/visible.h"
#include "server/renderer/answers.h"
#include "server/renderer/link.h"
#include "server/renderer/loader.h"
#include "server/wire/document.h"
#include "server/wire/plan_document.h"

enum { MAX_DRAWINGS = 2 * PIPELINE_MAX_WAITING, LAST_WORDS_MS = 1000, WARM_UP_PX = 64 };
#define WARM_UP_ID UINT64_MAX /* never asked for, so its picture is dropped */

struct room_scene {
    char id[64];
    uint32_t revision;
    cJSON *scene;
};

#define NO_DRAWING (UINT64_MAX - 1) /* never asked for either */
struct drawing { /* a picture asked for and not yet delivered */
    _Atomic uint64_t id; /* NO_DRAWING: free. Written by the main thread alone; whoever builds its shapes looks whether it is still wanted */
    uint32_t revision;
    struct snapshot *snapshot; /* a reference */
    enum surface_detail detail;
};

struct session {
    const struct session_options *options;
    struct link *link;
    struct desk *desk;
    struct loader *loader;
    struct pipeline *pipeline;
    struct plan *plan;
    struct room_scene *rooms;
    size_t n_rooms, room_capacity; /* at most SCENE_MAX_ROOMS */
    cJSON *default_scene;
    struct drawing drawings[MAX_DRAWINGS];
    struct prepared *prepared;
    bool is_built, has_gl, is_ready;
    struct problem gl_problem; /* when GL did not start */
    int64_t began_us;
    int status; /* -1: go on */
};

/* ---- out ---- */

static cJSON *packet(const char *type)
{
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "type", type);
    return json;
}

static void say(struct session *session, cJSON *json, const uint8_t *blob, size_t n_blob)
{
    link_say(session->link, json, blob, n_blob);
    cJSON_Delete(json);
}

static void say_problem(struct session *session, uint64_t id, const struct problem *problem)
{
    cJSON *json = packet("problem");
    cJSON_AddNumberToObject(json, "id", (double)id);
    cJSON_AddItemToObject(json, "problem", problem_to_json(problem));
    say(session, json, NULL, 0);
}

/* A problem with a part of what was asked: its pointer goes below the part's name. */
static void say_problem_in(struct session *session, uint64_t id, const char *part, const struct problem *problem)
{
    struct problem whole = *problem;
    (void)snprintf(whole.pointer, sizeof whole.pointer, "/%s%.140s", part, problem->pointer);
    say_problem(session, id, &whole);
}

static void say_failed(struct session *session, const struct error *err)
{
    struct problem problem;
    problem_from_error(&problem, err);
    cJSON *json = packet("failed");
    cJSON_AddItemToObject(json, "problem", problem_to_json(&problem));
    say(session, json, NULL, 0);
    log_warn("the plan cannot be read: %s", err->text);
    session->status = SESSION_UNREADABLE;
}

static double resident_bytes(void)
{
    unsigned long long all = 0, resident = 0;
    FILE *file = fopen("/proc/self/statm", "re");
    if (!file)
        return 0;
    char text[128];
    if (!fgets(text, sizeof text, file) || sscanf(text, "%llu %llu", &all, &resident) != 2)
        resident = 0;
    fclose(file);
    return (double)resident * 4096;
}

/* A tiny picture nobody sees, so that shaders are compiled and light surfaces on the device before the first one is asked for. */
static void warm_up(struct session *session)
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
        .snapshot = snapshot_create(session->plan, &scene, &view, 0, field, &err),
        .render = { WARM_UP_PX, WARM_UP_PX, SURFACE_LIGHT, false },
        .encode = { ENCODE_JPEG, 50, false },
    };
    if (request.snapshot && !pipeline_submit(session->pipeline, &request, &err))
        log_warn("nothing could be drawn ahead: %s", err.text);
}

static void say_ready_when_it_is(struct session *session)
{
    if (session->is_ready || !session->plan || !session->is_built || !session->has_gl)
        return;
    session->is_ready = true;
    cJSON *json = packet("ready");
    cJSON_AddItemToObject(json, "plan", plan_document(session->plan));
    cJSON_AddItemToObject(json, "scene", cJSON_Duplicate(session->default_scene, true));
    cJSON_AddStringToObject(json, "confined", session->options->confined);
    cJSON_AddNumberToObject(json, "memory_bytes", resident_bytes());
    cJSON_AddNumberToObject(json, "load_ms", (double)((clock_now_us() - session->began_us) / 1000));
    say(session, json, NULL, 0);
    warm_up(session);
}

/* ---- what the daemon asks ---- */

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

static void take_scene(struct session *session, cJSON *json)
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

static void forget_room(struct session *session, const char *id)
{
    struct room_scene *room = find_room(session, id);
    if (!room)
        return;
    cJSON_Delete(room->scene);
    *room = session->rooms[--session->n_rooms];
}

/* What is asked to be seen, from {room | scene, view}; NULL after the problem was said. */
static struct snapshot *read_snapshot(struct session *session, uint64_t id, const cJSON *json, uint32_t *revision)
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
        say_problem(session, id, &problem);
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
    struct snapshot *snapshot = snapshot_create(session->plan, &scene, &view, *revision, field, &err);
    if (!snapshot) {
        problem_from_error(&problem, &err);
        if (problem.type == PROBLEM_NOT_FOUND)
            problem.type = PROBLEM_VALIDATION; /* it is a field that names what is not there */
        (void)snprintf(problem.pointer, sizeof problem.pointer, "%s", field);
        say_problem_in(session, id, strncmp(field, "/camera", 7) == 0 ? "view" : "scene", &problem);
    }
    return snapshot;
}

static bool is_one_of(struct session *session, uint64_t id, const cJSON *json, const char *name, const char *first, const char *second,
                      bool *is_second)
{
    const char *word = json_text(json, name);
    *is_second = word && strcmp(word, second) == 0;
    if (!word || *is_second || strcmp(word, first) == 0)
        return true;
    struct problem problem;
    char pointer[32];
    (void)snprintf(pointer, sizeof pointer, "/%s", name);
    problem_set(&problem, PROBLEM_VALIDATION, pointer, "enum", "%s is \"%.40s\", expected \"%s\" or \"%s\"", name, word, first, second);
    say_problem(session, id, &problem);
    return false;
}

static bool is_within(struct session *session, uint64_t id, const cJSON *json, const char *name, double low, double high, double *value)
{
    *value = json_number(json, name, *value);
    if (*value >= low && *value <= high)
        return true;
    struct problem problem;
    char pointer[32];
    (void)snprintf(pointer, sizeof pointer, "/%s", name);
    problem_set(&problem, PROBLEM_VALIDATION, pointer, "range", "%s is %g, expected %g to %g", name, *value, low, high);
    say_problem(session, id, &problem);
    return false;
}

static void say_busy(struct session *session, uint64_t id)
{
    struct problem problem;
    problem_set(&problem, PROBLEM_BUSY, "", "", "too many pictures wait to be drawn");
    problem.retry_after_ms = 200;
    say_problem(session, id, &problem);
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

/* To the render thread. Takes preparation. */
static void submit(struct session *session, struct preparation *preparation)
{
    struct error err = { 0 };
    struct pipeline_request request = preparation->request;
    struct drawing *drawing = find_drawing(session, request.id);
    if (drawing)
        snapshot_ref(request.snapshot);
    preparation_destroy(preparation);
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

static void draw(struct session *session, uint64_t id, const cJSON *json)
{
    double scale = 100, quality = 85;
    bool is_png, is_light;
    if (session->gl_problem.type != PROBLEM_NONE) {
        say_problem(session, id, &session->gl_problem);
        return;
    }
    if (!is_within(session, id, json, "scale_percent", 10, 100, &scale) || !is_within(session, id, json, "quality", 1, 100, &quality) ||
        !is_one_of(session, id, json, "codec", "jpeg", "png", &is_png) || !is_one_of(session, id, json, "detail", "full", "light", &is_light))
        return;
    uint32_t revision;
    struct snapshot *snapshot = read_snapshot(session, id, json, &revision);
    if (!snapshot)
        return;
    int width = (int)lround(snapshot->view.size_px[0] * scale / 100), height = (int)lround(snapshot->view.size_px[1] * scale / 100);
    struct pipeline_request request = {
        .id = id,
        .source = source_number(json_text(json, "source")),
        .snapshot = snapshot,
        .render = { width > 1 ? width : 1, height > 1 ? height : 1, is_light ? SURFACE_LIGHT : SURFACE_FULL, json_flag(json, "still", false) },
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
    struct preparation *preparation = preparation_create(&request);
    preparation->wanted = &drawing->id;
    if (prepared_has_all(session->prepared, preparation) || !loader_prepare(session->loader, preparation))
        submit(session, preparation);
}

static bool read_point(const cJSON *json, struct vec3 *point)
{
    const cJSON *list = cJSON_GetObjectItemCaseSensitive(json, "point_lps_mm");
    double p[3];
    if (!cJSON_IsArray(list) || cJSON_GetArraySize(list) != 3)
        return false;
    for (int i = 0; i < 3; i++) {
        const cJSON *item = cJSON_GetArrayItem(list, i);
        if (!cJSON_IsNumber(item) || !(fabs(item->valuedouble) <= 1e5))
            return false;
        p[i] = item->valuedouble;
    }
    *point = vec3(p[0], p[1], p[2]);
    return true;
}

/* Fills question; false after the problem was said. */
static bool read_question(struct session *session, uint64_t id, const cJSON *json, struct question *question)
{
    const char *what = json_text(json, "what");
    struct problem problem;
    *question = (struct question){ .id = id };
    if (what && strcmp(what, "surface") == 0) {
        const char *name = json_text(json, "region");
        const struct region *region = region_find(&session->plan->regions, name ? name : "");
        question->what = QUESTION_SURFACE;
        if (!region)
            problem_set(&problem, PROBLEM_NOT_FOUND, "/region", "", "the plan has no region \"%.64s\"", name ? name : "");
        else if (shape_query_read(json, &question->shape, &problem)) {
            question->region = (size_t)(region - session->plan->regions.regions);
            return true;
        }
    } else if (what && strcmp(what, "probe") == 0) {
        question->what = QUESTION_PROBE;
        if (read_point(json, &question->point_lps_mm))
            return true;
        problem_set(&problem, PROBLEM_VALIDATION, "/point_lps_mm", "type", "a point is three numbers in mm, each -100000 to 100000");
    } else if (what && strcmp(what, "pick") == 0) {
        uint32_t revision;
        question->what = QUESTION_PICK;
        question->px = question->py = NAN;
        if (!is_within(session, id, json, "px", 0, 4096, &question->px) || !is_within(session, id, json, "py", 0, 4096, &question->py))
            return false;
        question->snapshot = read_snapshot(session, id, json, &revision);
        return question->snapshot != NULL;
    } else {
        problem_set(&problem, PROBLEM_VALIDATION, "/what", "enum", "\"%.40s\" is no question", what ? what : "");
    }
    say_problem(session, id, &problem);
    return false;
}

static void answer(struct session *session, uint64_t id, const cJSON *json)
{
    struct question question;
    const char *what = json_text(json, "what");
    if (what && strcmp(what, "ready") == 0) { /* only whether: this is not asked before ready was said */
        cJSON *yes = packet("answer");
        cJSON_AddNumberToObject(yes, "id", (double)id);
        (void)cJSON_AddObjectToObject(yes, "body");
        say(session, yes, NULL, 0);
        return;
    }
    if (!read_question(session, id, json, &question) || loader_ask(session->loader, &question))
        return;
    struct problem problem;
    problem_set(&problem, PROBLEM_BUSY, "", "", "too many questions wait for an answer");
    problem.retry_after_ms = 500;
    say_problem(session, id, &problem);
}

static void take_packet(struct session *session, cJSON *json)
{
    const char *type = json_text(json, "type");
    double id = json_number(json, "id", -1);
    bool is_request = type && (strcmp(type, "render") == 0 || strcmp(type, "query") == 0);
    if (!type || (is_request && !(id >= 0 && id < 9e15))) {
        log_error("a packet that cannot be understood");
    } else if (strcmp(type, "ping") == 0) {
        say(session, packet("pong"), NULL, 0);
    } else if (strcmp(type, "scene") == 0) {
        take_scene(session, json);
    } else if (strcmp(type, "forget") == 0) {
        forget_room(session, json_text(json, "room"));
    } else if (strcmp(type, "drop") == 0) {
        struct drawing *drawing = find_drawing(session, id >= 0 && id < 9e15 ? (uint64_t)id : 0);
        if (drawing) {
            drawing_end(drawing);
            pipeline_drop(session->pipeline, (uint64_t)id);
        }
    } else if (is_request && !session->is_ready) {
        struct problem problem;
        problem_set(&problem, PROBLEM_BUSY, "", "", "the plan is still being read");
        problem.retry_after_ms = 500;
        say_problem(session, (uint64_t)id, &problem);
    } else if (is_request) {
        if (type[0] == 'r')
            draw(session, (uint64_t)id, json);
        else
            answer(session, (uint64_t)id, json);
    } else {
        log_error("a packet of the unknown type \"%.40s\"", type);
    }
}

/* ---- what other threads tell ---- */

static void gl_started(void *context, const struct render_facts *facts, const struct error *err)
{
    struct note note = { .type = NOTE_GL };
    if (facts)
        note.facts = *facts;
    else
        note.error = *err;
    desk_put(context, &note);
}

static void deliver(void *context, struct pipeline_frame *frame)
{
    struct note note = { .type = NOTE_FRAME, .frame = *frame };
    frame->picture = (struct encoded){ 0 };
    desk_put(context, &note);
}

static void take_gl(struct session *session, const struct note *note)
{
    cJSON *json;
    session->has_gl = true;
    if (note->error.code == ERROR_NONE) {
        json = answer_gl(&note->facts, session->options->is_stub);
        cJSON_AddStringToObject(json, "type", "gl");
        cJSON_AddStringToObject(json, "confined", session->options->confined);
    } else {
        problem_set(&session->gl_problem, PROBLEM_GL_UNAVAILABLE, "", "", "%s", note->error.text);
        json = packet("gl");
        cJSON_AddItemToObject(json, "problem", problem_to_json(&session->gl_problem));
        log_warn("nothing can be drawn: %s", note->error.text);
    }
    say(session, json, NULL, 0);
}

static void take_loaded(struct session *session, struct note *note)
{
    struct scene scene;
    session->plan = note->plan;
    note->plan = NULL;
    scene_for_plan(session->plan, &scene);
    session->default_scene = scene_write(&scene);
    scene_finish(&scene);
}

/* {n, regions: [{region, reason}]}; NULL: nothing is missing. */
static cJSON *missing_of(const struct drawing *drawing)
{
    struct visible_missing missing[VISIBLE_MAX_MISSING];
    const struct region *regions = drawing->snapshot->plan->regions.regions;
    size_t n = visible_missing(drawing->snapshot, drawing->detail, missing);
    if (n == 0)
        return NULL;
    cJSON *json = cJSON_CreateObject(), *list = cJSON_AddArrayToObject(json, "regions");
    cJSON_AddNumberToObject(json, "n", (double)n);
    for (size_t i = 0; i < n && i < VISIBLE_MAX_MISSING; i++) {
        cJSON *region = cJSON_CreateObject();
        cJSON_AddStringToObject(region, "region", regions[missing[i].region].id);
        cJSON_AddStringToObject(region, "reason", missing[i].why.text);
        cJSON_AddItemToArray(list, region);
    }
    return json;
}

/* What did not fit, and into what. */
static void say_limit(const struct session *session, struct problem *problem)
{
    char detail[sizeof problem->detail];
    if (problem->type != PROBLEM_MEMORY || session->options->max_bytes == 0)
        return;
    memcpy(detail, problem->detail, sizeof detail);
    (void)snprintf(problem->detail, sizeof problem->detail, "%.*s; the renderer of a plan may take %llu MiB (max-renderer-mib)",
                   (int)sizeof detail - 80, detail, (unsigned long long)(session->options->max_bytes >> 20));
}

static void take_frame(struct session *session, const struct pipeline_frame *frame)
{
    struct drawing *drawing = find_drawing(session, frame->id);
    if (!drawing)
        return;
    if (frame->error.code != ERROR_NONE) {
        drawing_end(drawing);
        struct problem problem;
        problem_from_error(&problem, &frame->error);
        say_limit(session, &problem);
        say_problem(session, frame->id, &problem);
        return;
    }
    cJSON *json = packet("frame");
    cJSON_AddNumberToObject(json, "id", (double)frame->id);
    cJSON_AddNumberToObject(json, "width_px", frame->width_px);
    cJSON_AddNumberToObject(json, "height_px", frame->height_px);
    cJSON_AddNumberToObject(json, "scene_revision", drawing->revision);
    cJSON_AddNumberToObject(json, "render_us", (double)(frame->timing.draw_us + frame->timing.read_us));
    cJSON_AddNumberToObject(json, "encode_us", (double)frame->encode_us);
    cJSON_AddNumberToObject(json, "pixels_per_mm", frame->camera.pixels_per_mm);
    cJSON_AddItemToObject(json, "clip_from_lps_mm", cJSON_CreateDoubleArray(frame->camera.clip_from_lps_mm.m, 16));
    cJSON_AddBoolToObject(json, "is_light", frame->timing.is_light);
    cJSON_AddNumberToObject(json, "n_triangles", (double)frame->timing.n_triangles);
    cJSON *missing = missing_of(drawing);
    if (missing)
        cJSON_AddItemToObject(json, "missing", missing);
    drawing_end(drawing);
    say(session, json, frame->picture.bytes, frame->picture.n_bytes);
}

static void take_note(struct session *session, struct note *note)
{
    switch (note->type) {
    case NOTE_GL: take_gl(session, note); break;
    case NOTE_PROGRESS:
        if (!session->is_ready) {
            cJSON *json = packet("progress");
            cJSON_AddStringToObject(json, "phase", note->phase);
            cJSON_AddNumberToObject(json, "percent", fmax(0, fmin(100, note->percent)));
            say(session, json, NULL, 0);
        }
        break;
    case NOTE_LOADED: take_loaded(session, note); break;
    case NOTE_FAILED: say_failed(session, &note->error); break;
    case NOTE_BUILT: session->is_built = true; break;
    case NOTE_FRAME: take_frame(session, &note->frame); break;
    case NOTE_PREPARED:
        if (note->preparation->is_built)
            prepared_add(session->prepared, note->preparation);
        submit(session, note->preparation);
        note->preparation = NULL;
        break;
    case NOTE_ANSWER:
        if (note->body) {
            cJSON *json = packet("answer");
            cJSON_AddNumberToObject(json, "id", (double)note->id);
            cJSON_AddItemToObject(json, "body", note->body);
            note->body = NULL;
            say(session, json, note->blob, note->n_blob);
        } else {
            say_limit(session, &note->problem);
            say_problem(session, note->id, &note->problem);
        }
        break;
    }
    say_ready_when_it_is(session);
}

/* ---- the loop ---- */

static void loop(struct session *session)
{
    while (session->status < 0) {
        short wanted = (short)(POLLIN | (link_has_outgoing(session->link) ? POLLOUT : 0));
        struct pollfd polled[2] = { { .fd = link_file(session->link), .events = wanted },
                                    { .fd = desk_bell(session->desk), .events = POLLIN } };
        if (poll(polled, 2, -1) < 0 && errno != EINTR) {
            session->status = SESSION_BROKEN;
            return;
        }
        mem_keep_reserve();
        link_write(session->link);
        if ((polled[0].revents & ~POLLOUT) && !link_read(session->link))
            session->status = SESSION_DONE;
        struct packet packet_in;
        int got = 0;
        while (session->status < 0 && (got = link_take(session->link, &packet_in)) > 0) {
            take_packet(session, packet_in.json);
            packet_finish(&packet_in);
        }
        if (got < 0)
            session->status = SESSION_BROKEN;
        for (struct note *note; session->status < 0 && (note = desk_take(session->desk));) {
            take_note(session, note);
            note_destroy(note);
        }
    }
}

int session_run(const struct session_options *options)
{
    struct session session = { .options = options, .status = -1, .began_us = clock_now_us() };
    struct error err = { 0 };
    for (size_t i = 0; i < MAX_DRAWINGS; i++)
        atomic_init(&session.drawings[i].id, NO_DRAWING);
    session.link = link_create(options->socket);
    session.desk = desk_create();
    session.prepared = prepared_create();
    if (!session.desk) {
        error_set(&err, ERROR_IO, "no file for the bell: %s", strerror(errno));
    } else {
        struct pipeline_callbacks callbacks = { gl_started, deliver, session.desk };
        session.pipeline = pipeline_create(options->back_end, options->is_stub, &callbacks, &err);
        if (session.pipeline)
            session.loader = loader_create(&(struct loader_options){ options->plan_folder, options->plan_id, options->max_bytes,
                                                                              options->cache },
                                           session.desk, &err);
    }
    if (session.loader)
        loop(&session);
    else
        say_failed(&session, &err);
    link_flush(session.link, LAST_WORDS_MS);

    loader_destroy(session.loader);
    if (session.pipeline)
        pipeline_destroy(session.pipeline);
    desk_destroy(session.desk);
    prepared_destroy(session.prepared);
    for (size_t i = 0; i < MAX_DRAWINGS; i++)
        snapshot_unref(session.drawings[i].snapshot);
    for (size_t i = 0; i < session.n_rooms; i++)
        cJSON_Delete(session.rooms[i].scene);
    free(session.rooms);
    cJSON_Delete(session.default_scene);
    plan_destroy(session.plan);
    link_destroy(session.link);
    return session.status < 0 ? SESSION_BROKEN : session.status;
}
