/* Orders for films of a turn, of a plan or of a room, and the films that were made of them. */
#include "server/http/api_films.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/base/mem.h"
#include "server/http/api_access.h"
#include "server/http/api_audit.h"
#include "server/http/api_handlers.h"
#include "server/http/api_jobs.h"
#include "server/http/api_queries.h"
#include "server/http/api_recordings.h"
#include "server/http/film_meeting.h"

bool film_read_number(const cJSON *body, const char *name, const double range[2], bool is_whole, double *value,
                      struct problem *problem)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(body, name);
    char where[32];
    (void)snprintf(where, sizeof where, "/%s", name);
    if (!item)
        return true;
    if (!cJSON_IsNumber(item))
        return problem_set(problem, PROBLEM_VALIDATION, where, "type", "%.60s has the wrong type", name);
    *value = item->valuedouble;
    if (*value >= range[0] && *value <= range[1] && (!is_whole || *value == floor(*value)))
        return true;
    if (is_whole)
        return problem_set(problem, PROBLEM_VALIDATION, where, "range",
                           "the parameter %s is %g, expected a whole number from %.0f to %.0f", name, *value, range[0],
                           range[1]);
    return problem_set(problem, PROBLEM_VALIDATION, where, "range", "%s is %g, expected %g to %g", name, *value,
                       range[0], range[1]);
}

bool film_check_fields(const cJSON *body, const char *const *known, struct problem *problem)
{
    const cJSON *item;
    cJSON_ArrayForEach(item, body)
    {
        bool is_known = false;
        char pointer[64];
        for (size_t i = 0; known[i]; i++)
            is_known = is_known || strcmp(item->string, known[i]) == 0;
        (void)snprintf(pointer, sizeof pointer, "/%.60s", item->string);
        if (!is_known)
            return problem_set(problem, PROBLEM_VALIDATION, pointer, "unknown-field", "%.60s is not a field of a film",
                               item->string);
        const bool is_flag = strcmp(item->string, "identity") == 0,
                   is_document = strcmp(item->string, "view") == 0 || strcmp(item->string, "scene") == 0;
        if ((is_flag && !cJSON_IsBool(item)) || (is_document && !cJSON_IsObject(item)))
            return problem_set(problem, PROBLEM_VALIDATION, pointer, "type", "%.60s has the wrong type", item->string);
    }
    return true;
}

static bool read_order(const cJSON *body, bool has_scene, struct film_order *order, struct problem *problem)
{
    static const char *const known[] = { "view", "degrees", "seconds", "fps", "quality", "identity", "scene", NULL },
                             *const of_room[] = { "view", "degrees", "seconds", "fps", "quality", "identity", NULL };
    if (!film_check_fields(body, has_scene ? known : of_room, problem))
        return false;
    *order =
        (struct film_order){ .degrees = 360, .fps = 24, .quality = 80, .is_named = json_flag(body, "identity", false) };
    if (!cJSON_GetObjectItemCaseSensitive(body, "seconds"))
        return problem_set(problem, PROBLEM_VALIDATION, "/seconds", "required", "\"seconds\" is missing: 1 to %d",
                           API_MAX_FILM_S);
    if (!film_read_number(body, "degrees", (const double[]){ -360, 360 }, false, &order->degrees, problem) ||
        !film_read_number(body, "seconds", (const double[]){ 1, API_MAX_FILM_S }, false, &order->seconds, problem) ||
        !film_read_number(body, "fps", (const double[]){ 1, API_MAX_FILM_FPS }, true, &order->fps, problem) ||
        !film_read_number(body, "quality", (const double[]){ 1, 100 }, true, &order->quality, problem))
        return false;
    return order->degrees != 0 ||
           problem_set(problem, PROBLEM_VALIDATION, "/degrees", "range", "degrees is 0: nothing turns");
}

bool film_check_size(double width, double height, const char *pointer, struct problem *problem)
{
    return (width >= API_MIN_FILM_SIDE_PX && height >= API_MIN_FILM_SIDE_PX && width <= API_MAX_FILM_SIDE_PX &&
            height <= API_MAX_FILM_SIDE_PX && width * height <= API_MAX_FILM_PIXELS) ||
           problem_set(problem, PROBLEM_VALIDATION, pointer, "range",
                       "a film of %g x %g: expected sides of %d to %d px and at most %d pixels", width, height,
                       API_MIN_FILM_SIDE_PX, API_MAX_FILM_SIDE_PX, API_MAX_FILM_PIXELS);
}

static bool check_view(const cJSON *view, struct problem *problem)
{
    const cJSON *size = cJSON_GetObjectItemCaseSensitive(view, "size_px");
    const double width = cJSON_GetNumberValue(cJSON_GetArrayItem(size, 0)),
                 height = cJSON_GetNumberValue(cJSON_GetArrayItem(size, 1));
    const char *kind = json_text(view, "kind");
    if (!kind || strcmp(kind, "3d") != 0)
        return problem_set(problem, PROBLEM_VALIDATION, "/view/kind", "enum",
                           "a film turns a view of the kind \"3d\", not one of the kind \"%.20s\"", kind ? kind : "");
    return film_check_size(width, height, "/view/size_px", problem);
}

void film_order(struct api *api, struct call *call, struct film_order *order)
{
    struct problem problem;
    order->user = call->identity.user;
    if (!api_films_have_place(api, order->user, &problem) ||
        (order->is_named && !api_may_name(api, call, order->plan_id, &problem))) {
        cJSON_Delete(order->scene);
        cJSON_Delete(order->view);
        film_meeting_destroy(order->meeting);
        call_answer_problem(call, &problem);
        return;
    }
    const uint64_t film = api_film_make(api, order);
    struct api_job *job = api_job_create(api, call, "film");
    mem_put_text(job->plan_id, sizeof job->plan_id, order->plan_id);
    job->film = film;
    api_job_answer(api, call, job);
}

/* ---- of a plan -------------------------------------------------------------------------------------------------- */

struct film_call {
    cJSON *body;
    struct film_order order;
};

static void film_call_destroy(struct film_call *asked)
{
    cJSON_Delete(asked->body);
    free(asked);
}

/* The view of the call as a complete document. NULL with problem. */
static cJSON *read_view(const cJSON *body, struct problem *problem)
{
    const cJSON *patch = cJSON_GetObjectItemCaseSensitive(body, "view");
    cJSON *nothing = cJSON_CreateObject(), *view = view_document_patch(NULL, patch ? patch : nothing, problem);
    cJSON_Delete(nothing);
    if (!view)
        problem_below(problem, "/view");
    else if (!check_view(view, problem)) {
        cJSON_Delete(view);
        view = NULL;
    }
    return view;
}

static void of_plan_when_ready(void *context, struct packet *answer, const struct problem *not_ready)
{
    struct call *call = context;
    struct api *api = call->api;
    struct film_call *asked = call->context;
    struct problem problem;
    struct fleet_plan plan;
    cJSON *scene = NULL, *view = NULL, *shown = NULL, *nothing = cJSON_CreateObject();
    (void)answer;
    if (not_ready) {
        problem = *not_ready;
    } else if (!fleet_plan_find(net_fleet(api->net), call->ids[0], &plan) || !plan.document || !plan.default_scene) {
        problem_set(&problem, PROBLEM_BUSY, "", "", "the plan was closed meanwhile");
    } else {
        const cJSON *patch = cJSON_GetObjectItemCaseSensitive(asked->body, "scene");
        scene = scene_document_patch(plan.document, plan.default_scene, plan.default_scene, patch ? patch : nothing,
                                     &problem);
        if (!scene)
            problem_below(&problem, "/scene");
        view = scene ? read_view(asked->body, &problem) : NULL;
        shown = view ? scene_document_for_view(plan.document, plan.default_scene, scene, view, &problem) : NULL;
        if (view && !shown)
            problem_below(&problem, "/view");
    }
    struct film_order order = asked->order;
    film_call_destroy(asked);
    cJSON_Delete(scene);
    cJSON_Delete(nothing);
    if (shown) {
        order.plan_id = call->ids[0];
        order.room_id = "";
        order.scene = shown;
        order.view = view;
        film_order(api, call, &order);
    } else {
        cJSON_Delete(view);
        call_answer_problem(call, &problem);
    }
}

/* The body's order; NULL: the call was answered. */
static struct film_call *read_call(struct call *call, bool has_scene)
{
    static const char *const media_types[] = { "application/json", NULL };
    struct problem problem;
    cJSON *body;
    if (!call_read_object(call, media_types, &body))
        return NULL;
    struct film_call *asked = mem_new(sizeof *asked);
    asked->body = body;
    if (read_order(body, has_scene, &asked->order, &problem))
        return asked;
    film_call_destroy(asked);
    call_answer_problem(call, &problem);
    return NULL;
}

void api_plan_film(struct api *api, struct call *call)
{
    struct fleet_plan plan;
    struct film_call *asked = api_find_plan(api, call, &plan) ? read_call(call, true) : NULL;
    if (!asked)
        return;
    if (!api_audit_export(api, call, asked->order.is_named ? "film-named" : "film")) {
        film_call_destroy(asked);
        return;
    }
    call->context = asked;
    api_when_ready(api, call, call->ids[0], of_plan_when_ready);
}

/* ---- of a room -------------------------------------------------------------------------------------------------- */

static void of_room_when_ready(void *context, struct packet *answer, const struct problem *not_ready)
{
    struct call *call = context;
    struct api *api = call->api;
    struct film_call *asked = call->context;
    struct problem problem;
    const struct room *room = net_room_find(api->net, call->ids[0]);
    cJSON *view = NULL, *shown = NULL;
    (void)answer;
    if (not_ready)
        problem = *not_ready;
    else if (!room || !room_scene(room, NULL))
        problem_set(&problem, PROBLEM_BUSY, "", "", "the plan was closed meanwhile");
    else if ((view = read_view(asked->body, &problem)) != NULL && !(shown = room_scene_for_view(room, view, &problem)))
        problem_below(&problem, "/view");
    struct film_order order = asked->order;
    film_call_destroy(asked);
    if (shown) {
        order.plan_id = room_plan_id(room);
        order.room_id = room_id(room);
        order.scene = shown;
        order.acceptances = room_acceptances(room);
        order.view = view;
        film_order(api, call, &order);
    } else {
        cJSON_Delete(view);
        call_answer_problem(call, &problem);
    }
}

void api_room_film(struct api *api, struct call *call)
{
    struct room *room = api_find_room(api, call);
    struct film_call *asked = room ? read_call(call, false) : NULL;
    if (!asked)
        return;
    if (!api_audit_export(api, call, asked->order.is_named ? "film-named" : "film")) {
        film_call_destroy(asked);
        return;
    }
    call->context = asked;
    api_when_ready(api, call, room_plan_id(room), of_room_when_ready);
}

/* ---- the film --------------------------------------------------------------------------------------------------- */

/* The film's maker may have lost the right since. */
static bool may_have(const struct api *api, const struct call *call, const struct api_film_state *film,
                     struct problem *problem)
{
    if (!api_access_may_export(api, call, film->plan_id, film->room_id, problem))
        return problem->type != PROBLEM_NOT_FOUND
                   ? false
                   : problem_set(problem, PROBLEM_NOT_FOUND, "", "",
                                 "the film of the job \"%.63s\" is not kept any more", call->ids[0]);
    if (film->is_of_meeting && !api_may_replay(api, call, film->plan_id, problem))
        return false;
    return !film->is_named || api_may_name(api, call, film->plan_id, problem);
}

/* Ids need no quoting; a name of a plan or a patient never stands in it. */
static void add_name(struct call *call, const struct api_job *job, bool is_of_meeting)
{
    const time_t seconds = (time_t)(job->created_ms / 1000);
    struct tm utc;
    char time[32], disposition[160];
    (void)gmtime_r(&seconds, &utc);
    (void)strftime(time, sizeof time, "%Y%m%dT%H%M%SZ", &utc);
    (void)snprintf(disposition, sizeof disposition, "attachment; filename=\"%.63s-%s-%s.webm\"", job->plan_id,
                   is_of_meeting ? "meeting" : "turn", time);
    call_add_header(call, "Content-Disposition", disposition);
}

void api_job_film(struct api *api, struct call *call)
{
    struct problem problem;
    const struct api_job *job = api_job_find(api, call->ids[0]);
    struct api_film_state film = { .n_done = 0 };
    const bool has_film = job && job->film && api_film_find(api, job->film, &film), is_made = film.state == JOB_DONE;
    if (!job) {
        api_job_answer_missing(call);
        return;
    }
    if (!has_film || !is_made || !film.bytes) {
        problem_set(&problem, has_film && !is_made ? PROBLEM_CONFLICT : PROBLEM_NOT_FOUND, "", "",
                    !job->film             ? "the job \"%.63s\" makes no film"
                    : has_film && !is_made ? "the film of the job \"%.63s\" is not made"
                                           : "the film of the job \"%.63s\" is not kept any more",
                    call->ids[0]);
        call_answer_problem(call, &problem);
        return;
    }
    if (!may_have(api, call, &film, &problem)) {
        call_answer_problem(call, &problem);
        return;
    }
    if (!api_audit_export(api, call, film.is_named ? "film-named" : "film"))
        return;
    add_name(call, job, film.is_of_meeting);
    call_answer_shared(call, 200, "video/webm", call_bytes_ref(film.bytes));
}
