#include "server/renderer/session.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/renderer/answers.h"
#include "server/renderer/session_parts.h"
#include "server/wire/document.h"
#include "server/wire/plan_document.h"

enum { LAST_WORDS_MS = 1000 };
#define MAX_ID 9e15 /* ids of requests are exact as a double */

/* ---- out -------------------------------------------------------------------------------------------------------- */

cJSON *session_packet(const char *type)
{
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "type", type);
    return json;
}

void session_say(struct session *session, cJSON *json, const uint8_t *blob, size_t n_blob)
{
    link_say(session->link, json, blob, n_blob);
    cJSON_Delete(json);
}

void session_say_problem(struct session *session, uint64_t id, const struct problem *problem)
{
    cJSON *json = session_packet("problem");
    cJSON_AddNumberToObject(json, "id", (double)id);
    cJSON_AddItemToObject(json, "problem", problem_to_json(problem));
    session_say(session, json, NULL, 0);
}

bool session_read_number(struct session *session, uint64_t id, const cJSON *json, const char *name, double low,
                         double high, double *value)
{
    *value = json_number(json, name, *value);
    if (*value >= low && *value <= high)
        return true;
    struct problem problem;
    char pointer[32];
    (void)snprintf(pointer, sizeof pointer, "/%s", name);
    problem_set(&problem, PROBLEM_VALIDATION, pointer, "range", "%s is %g, expected %g to %g", name, *value, low, high);
    session_say_problem(session, id, &problem);
    return false;
}

void session_add_limit(const struct session *session, struct problem *problem)
{
    char detail[sizeof problem->detail];
    if (problem->type != PROBLEM_MEMORY || session->options->max_bytes == 0)
        return;
    memcpy(detail, problem->detail, sizeof detail);
    (void)snprintf(problem->detail, sizeof problem->detail,
                   "%.*s; the renderer of a plan may take %llu MiB (max-renderer-mib)", (int)sizeof detail - 80, detail,
                   (unsigned long long)(session->options->max_bytes >> 20));
}

static void say_failed(struct session *session, const struct error *err)
{
    struct problem problem;
    problem_from_error(&problem, err);
    cJSON *json = session_packet("failed");
    cJSON_AddItemToObject(json, "problem", problem_to_json(&problem));
    session_say(session, json, NULL, 0);
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

static void say_ready_when_it_is(struct session *session)
{
    if (session->is_ready || !session->plan || !session->is_built || !session->has_gl)
        return;
    session->is_ready = true;
    cJSON *json = session_packet("ready");
    cJSON_AddItemToObject(json, "plan", plan_document(session->plan));
    cJSON_AddItemToObject(json, "scene", cJSON_Duplicate(session->default_scene, true));
    cJSON_AddStringToObject(json, "confined", session->options->confined);
    cJSON_AddNumberToObject(json, "memory_bytes", resident_bytes());
    cJSON_AddNumberToObject(json, "load_ms", (double)((clock_now_us() - session->began_us) / 1000));
    session_say(session, json, NULL, 0);
    pictures_warm_up(session);
}

/* ---- what the daemon asks --------------------------------------------------------------------------------------- */

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
            problem_set(&problem, PROBLEM_NOT_FOUND, "/region", "", "the plan has no region \"%.64s\"",
                        name ? name : "");
        else if (shape_query_read(json, &question->shape, &problem)) {
            question->subject = subject_region((size_t)(region - session->plan->regions.regions));
            return true;
        }
    } else if (what && strcmp(what, "probe") == 0) {
        question->what = QUESTION_PROBE;
        if (read_point(json, &question->point_lps_mm))
            return true;
        problem_set(&problem, PROBLEM_VALIDATION, "/point_lps_mm", "type",
                    "a point is three numbers in mm, each -100000 to 100000");
    } else if (what && strcmp(what, "pick") == 0) {
        uint32_t revision;
        question->what = QUESTION_PICK;
        question->px = question->py = NAN;
        if (!session_read_number(session, id, json, "px", 0, 4096, &question->px) ||
            !session_read_number(session, id, json, "py", 0, 4096, &question->py))
            return false;
        question->snapshot = pictures_read_snapshot(session, id, json, &revision);
        return question->snapshot != NULL;
    } else {
        problem_set(&problem, PROBLEM_VALIDATION, "/what", "enum", "\"%.40s\" is no question", what ? what : "");
    }
    session_say_problem(session, id, &problem);
    return false;
}

static void answer(struct session *session, uint64_t id, const cJSON *json)
{
    struct question question;
    const char *what = json_text(json, "what");
    if (what && strcmp(what, "ready") == 0) { /* only whether: this is not asked before ready was said */
        cJSON *yes = session_packet("answer");
        cJSON_AddNumberToObject(yes, "id", (double)id);
        (void)cJSON_AddObjectToObject(yes, "body");
        session_say(session, yes, NULL, 0);
        return;
    }
    if (!read_question(session, id, json, &question) || loader_ask(session->loader, &question))
        return;
    struct problem problem;
    problem_set(&problem, PROBLEM_BUSY, "", "", "too many questions wait for an answer");
    problem.retry_after_ms = 500;
    session_say_problem(session, id, &problem);
}

static void take_packet(struct session *session, cJSON *json)
{
    const char *type = json_text(json, "type");
    double id = json_number(json, "id", -1);
    bool is_request = type && (strcmp(type, "render") == 0 || strcmp(type, "query") == 0);
    if (!type || (is_request && !(id >= 0 && id < MAX_ID))) {
        log_error("a packet that cannot be understood");
    } else if (strcmp(type, "ping") == 0) {
        session_say(session, session_packet("pong"), NULL, 0);
    } else if (strcmp(type, "scene") == 0) {
        pictures_take_scene(session, json);
    } else if (strcmp(type, "forget") == 0) {
        pictures_forget_room(session, json_text(json, "room"));
    } else if (strcmp(type, "drop") == 0) {
        if (id >= 0 && id < MAX_ID)
            pictures_drop(session, (uint64_t)id);
    } else if (is_request && !session->is_ready) {
        struct problem problem;
        problem_set(&problem, PROBLEM_BUSY, "", "", "the plan is still being read");
        problem.retry_after_ms = 500;
        session_say_problem(session, (uint64_t)id, &problem);
    } else if (is_request) {
        if (type[0] == 'r')
            pictures_draw(session, (uint64_t)id, json);
        else
            answer(session, (uint64_t)id, json);
    } else {
        log_error("a packet of the unknown type \"%.40s\"", type);
    }
}

/* ---- what other threads tell ------------------------------------------------------------------------------------ */

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
        json = session_packet("gl");
        cJSON_AddItemToObject(json, "problem", problem_to_json(&session->gl_problem));
        log_warn("nothing can be drawn: %s", note->error.text);
    }
    session_say(session, json, NULL, 0);
}

static void take_loaded(struct session *session, struct note *note)
{
    struct scene scene;
    session->plan = note->plan;
    session->derived = note->derived;
    note->plan = NULL;
    note->derived = NULL;
    scene_for_plan(session->plan, &scene);
    session->default_scene = scene_write(&scene);
    scene_finish(&scene);
    if (!session->default_scene)
        say_failed(session, &(struct error){ ERROR_MEMORY, "no memory for the scene of the plan" });
}

static void take_note(struct session *session, struct note *note)
{
    switch (note->type) {
    case NOTE_GL: take_gl(session, note); break;
    case NOTE_PROGRESS:
        if (!session->is_ready) {
            cJSON *json = session_packet("progress");
            cJSON_AddStringToObject(json, "phase", note->phase);
            cJSON_AddNumberToObject(json, "percent", fmax(0, fmin(100, note->percent)));
            session_say(session, json, NULL, 0);
        }
        break;
    case NOTE_LOADED: take_loaded(session, note); break;
    case NOTE_FAILED: say_failed(session, &note->error); break;
    case NOTE_BUILT: session->is_built = true; break;
    case NOTE_FRAME: pictures_take_frame(session, &note->frame); break;
    case NOTE_SHAPES_BUILT:
        if (note->waiting->is_built)
            built_shapes_add(session->built_shapes, note->waiting);
        pictures_submit(session, note->waiting);
        note->waiting = NULL;
        break;
    case NOTE_ANSWER:
        if (note->body) {
            cJSON *json = session_packet("answer");
            cJSON_AddNumberToObject(json, "id", (double)note->id);
            cJSON_AddItemToObject(json, "body", note->body);
            note->body = NULL;
            session_say(session, json, note->blob, note->n_blob);
        } else {
            session_add_limit(session, &note->problem);
            session_say_problem(session, note->id, &note->problem);
        }
        break;
    }
    say_ready_when_it_is(session);
}

/* ---- the loop --------------------------------------------------------------------------------------------------- */

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
    pictures_begin(&session);
    session.link = link_create(options->socket);
    session.desk = desk_create();
    if (!session.desk) {
        error_set(&err, ERROR_IO, "no file for the bell: %s", strerror(errno));
    } else {
        struct pipeline_callbacks callbacks = { gl_started, deliver, session.desk };
        session.pipeline = pipeline_create(options->back_end, options->is_stub, &callbacks, &err);
        if (session.pipeline)
            session.loader = loader_create(&(struct loader_options){ options->plan_folder, options->plan_id,
                                                                     options->max_bytes, options->cache },
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
    pictures_end(&session);
    cJSON_Delete(session.default_scene);
    derive_destroy(session.derived);
    plan_destroy(session.plan);
    link_destroy(session.link);
    return session.status < 0 ? SESSION_BROKEN : session.status;
}
