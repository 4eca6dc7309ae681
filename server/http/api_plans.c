/* Plans, jobs, pictures and numbers of a plan. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/http/api_inner.h"

static cJSON *plan_head(const struct fleet_plan *plan)
{
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "id", plan->id);
    cJSON_AddStringToObject(json, "name", plan->name);
    cJSON_AddStringToObject(json, "note", plan->note);
    cJSON_AddBoolToObject(json, "is_phantom", plan->is_phantom);
    cJSON_AddBoolToObject(json, "uploaded", plan->is_uploaded);
    cJSON_AddStringToObject(json, "state", fleet_state_word(plan->state));
    cJSON_AddItemToObject(json, "parts", plan->parts ? cJSON_Duplicate(plan->parts, true) : cJSON_CreateArray());
    cJSON_AddNumberToObject(json, "n_bytes", (double)plan->n_bytes);
    if (plan->state == FLEET_STARTING || plan->state == FLEET_LOADING || plan->state == FLEET_RESTARTING) {
        cJSON_AddStringToObject(json, "phase", plan->phase);
        cJSON_AddNumberToObject(json, "percent", plan->percent);
    }
    if (plan->problem) { /* unreadable, failed, or why the renderer is restarted after a pause */
        cJSON_AddStringToObject(json, "reason", plan->problem->detail);
        cJSON_AddItemToObject(json, "problem", problem_to_json(plan->problem));
    } else {
        cJSON_AddNullToObject(json, "reason");
    }
    const cJSON *line;
    int n_warnings = 0;
    cJSON_ArrayForEach(line,
                       cJSON_GetObjectItemCaseSensitive(cJSON_GetObjectItemCaseSensitive(plan->document, "report"),
                                                        "lines"))
    {
        const char *severity = json_text(line, "severity");
        n_warnings += severity && strcmp(severity, "note") != 0;
    }
    if (plan->document)
        cJSON_AddNumberToObject(json, "n_warnings", n_warnings);
    return json;
}

void api_plans(struct api *api, struct call *call)
{
    struct fleet *fleet = net_fleet(api->net);
    fleet_rescan(fleet);
    cJSON *answer = cJSON_CreateObject(), *list = cJSON_AddArrayToObject(answer, "plans");
    struct fleet_plan plan;
    for (size_t i = 0; i < fleet_n_plans(fleet); i++)
        if (fleet_plan_at(fleet, i, &plan))
            cJSON_AddItemToArray(list, plan_head(&plan));
    call_answer_json(call, 200, answer);
}

/* The call's first id as a plan; false: answered with not-found. */
static bool find_plan(struct api *api, struct call *call, struct fleet_plan *plan)
{
    if (fleet_plan_find(net_fleet(api->net), call->ids[0], plan))
        return true;
    struct problem problem;
    fleet_no_plan(net_fleet(api->net), call->ids[0], &problem);
    call_answer_problem(call, &problem);
    return false;
}

void api_plan(struct api *api, struct call *call)
{
    struct fleet_plan plan;
    if (!find_plan(api, call, &plan))
        return;
    cJSON *answer = plan_head(&plan);
    const cJSON *part;
    cJSON_ArrayForEach(part, plan.document) /* images, regions, ...: all that only a loaded plan can tell */
    {
        if (!cJSON_GetObjectItemCaseSensitive(answer, part->string))
            cJSON_AddItemToObject(answer, part->string, cJSON_Duplicate(part, true));
    }
    if (plan.memory_bytes)
        cJSON_AddNumberToObject(answer, "memory_bytes", (double)plan.memory_bytes);
    call_answer_json(call, 200, answer);
}

static cJSON *job_document(const struct api_job *job)
{
    static const char *const words[] = { "queued", "running", "done", "failed", "cancelled" };
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "id", job->id);
    cJSON_AddStringToObject(json, "kind", job->kind);
    cJSON_AddItemToObject(json, "plan", job->plan_id[0] ? cJSON_CreateString(job->plan_id) : cJSON_CreateNull());
    cJSON_AddStringToObject(json, "state", words[job->state]);
    cJSON_AddStringToObject(json, "phase", job->phase);
    cJSON_AddNumberToObject(json, "percent", job->percent);
    if (job->state == JOB_FAILED)
        cJSON_AddItemToObject(json, "problem", problem_to_json(&job->problem));
    else
        cJSON_AddNullToObject(json, "problem");
    return json;
}

static void update_job(struct api *api, struct api_job *job)
{
    struct fleet_plan plan;
    if (job->state != JOB_RUNNING && job->state != JOB_QUEUED)
        return;
    if (job->upload) {
        api_update_upload(api, job);
        return;
    }
    if (!fleet_plan_find(net_fleet(api->net), job->plan_id, &plan)) {
        job->state = JOB_FAILED;
        problem_set(&job->problem, PROBLEM_NOT_FOUND, "", "", "the plan is gone");
        return;
    }
    if (plan.ready_opening == job->opening) { /* also when it has been closed since */
        job->state = JOB_DONE;
        job->phase[0] = 0;
        job->percent = 100;
        return;
    }
    if (plan.failed_opening == job->opening) { /* also when it has been opened again since */
        job->state = job->is_cancel_asked ? JOB_CANCELLED : JOB_FAILED;
        job->problem = *plan.failure;
        return;
    }
    if (plan.opening != job->opening) { /* closed before it was ready, and opened again since */
        job->state = JOB_CANCELLED;
        return;
    }
    switch (plan.state) {
    case FLEET_STARTING:
    case FLEET_LOADING:
    case FLEET_RESTARTING:
        (void)snprintf(job->phase, sizeof job->phase, "%s", plan.phase ? plan.phase : "");
        job->percent = plan.percent;
        break;
    case FLEET_READY: break; /* done, above */
    case FLEET_CLOSED: job->state = JOB_CANCELLED; break;
    case FLEET_UNREADABLE:
    case FLEET_FAILED:
        job->state = job->is_cancel_asked ? JOB_CANCELLED : JOB_FAILED;
        if (plan.problem)
            job->problem = *plan.problem;
        break;
    }
}

void api_update_jobs(struct api *api)
{
    size_t first = api->n_jobs > API_MAX_JOBS ? api->n_jobs - API_MAX_JOBS : 0;
    for (size_t n = first; n < api->n_jobs; n++)
        update_job(api, &api->jobs[n % API_MAX_JOBS]);
}

struct api_job *api_job_new(struct api *api, const char *kind)
{
    struct api_job *job = &api->jobs[api->n_jobs % API_MAX_JOBS];
    memset(job, 0, sizeof *job);
    api->n_jobs++;
    (void)snprintf(job->id, sizeof job->id, "%s-%zu", kind, api->n_jobs);
    job->kind = kind;
    job->state = JOB_RUNNING;
    return job;
}

void api_job_answer(struct api *api, struct call *call, struct api_job *job)
{
    char location[80];
    update_job(api, job);
    (void)snprintf(location, sizeof location, "/api/v1/jobs/%s", job->id);
    call_add_header(call, "Location", location);
    call_answer_json(call, 202, job_document(job));
}

void api_plan_open(struct api *api, struct call *call)
{
    struct fleet_plan plan;
    struct problem problem;
    if (!find_plan(api, call, &plan))
        return;
    if (!fleet_open(net_fleet(api->net), call->ids[0], &problem)) {
        call_answer_problem(call, &problem);
        return;
    }
    struct api_job *job = api_job_new(api, "open");
    (void)snprintf(job->plan_id, sizeof job->plan_id, "%s", call->ids[0]);
    if (fleet_plan_find(net_fleet(api->net), call->ids[0], &plan))
        job->opening = plan.opening;
    api_job_answer(api, call, job);
}

void api_plan_close(struct api *api, struct call *call)
{
    struct fleet_plan plan;
    if (!find_plan(api, call, &plan))
        return;
    fleet_close(net_fleet(api->net), call->ids[0]);
    call_answer_nothing(call, 204);
}

static struct api_job *find_job(struct api *api, struct call *call)
{
    size_t first = api->n_jobs > API_MAX_JOBS ? api->n_jobs - API_MAX_JOBS : 0;
    for (size_t n = first; n < api->n_jobs; n++)
        if (strcmp(api->jobs[n % API_MAX_JOBS].id, call->ids[0]) == 0)
            return &api->jobs[n % API_MAX_JOBS];
    struct problem problem;
    problem_set(&problem, PROBLEM_NOT_FOUND, "", "", "there is no job \"%.63s\"; the last %d are kept", call->ids[0],
                API_MAX_JOBS);
    call_answer_problem(call, &problem);
    return NULL;
}

void api_job(struct api *api, struct call *call)
{
    struct api_job *job = find_job(api, call);
    if (job)
        call_answer_json(call, 200, job_document(job));
}

void api_job_cancel(struct api *api, struct call *call)
{
    struct api_job *job = find_job(api, call);
    if (!job)
        return;
    if (job->upload) {
        fleet_upload_cancel(net_fleet(api->net), job->upload);
        update_job(api, job);
    } else if (job->state == JOB_RUNNING) {
        job->is_cancel_asked = true;
        fleet_close(net_fleet(api->net), job->plan_id);
        update_job(api, job);
    }
    call_answer_json(call, 200, job_document(job));
}

/* ---- a picture without a room: the plan's own scene is known only once it is loaded, so the renderer is asked fir */

struct render_wish {
    char plan_id[64];
    cJSON *body; /* checked: only known members */
};

static void wish_destroy(struct render_wish *wish)
{
    cJSON_Delete(wish->body);
    free(wish);
}

static bool check_wish(const cJSON *body, struct problem *problem)
{
    static const char *const known[] = { "scene", "view", "format", "quality" };
    const cJSON *item;
    cJSON_ArrayForEach(item, body)
    {
        bool is_known = false;
        for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
            is_known = is_known || strcmp(item->string, known[i]) == 0;
        char pointer[64];
        (void)snprintf(pointer, sizeof pointer, "/%.60s", item->string);
        if (!is_known)
            return problem_set(problem, PROBLEM_VALIDATION, pointer, "unknown-field",
                               "%.60s is not a field of a render request", item->string);
        bool right = strcmp(item->string, "format") == 0    ? cJSON_IsString(item)
                     : strcmp(item->string, "quality") == 0 ? cJSON_IsNumber(item)
                                                            : cJSON_IsObject(item);
        if (!right)
            return problem_set(problem, PROBLEM_VALIDATION, pointer, "type", "%.60s has the wrong type", item->string);
    }
    return true;
}

static void render_when_ready(void *context, struct packet *answer, const struct problem *not_ready)
{
    struct call *call = context;
    struct api *api = call->api;
    struct render_wish *wish = call->context;
    struct problem problem;
    struct fleet_plan plan;
    (void)answer;
    if (not_ready) {
        wish_destroy(wish);
        call_answer_problem(call, not_ready);
        return;
    }
    cJSON *scene = NULL, *view = NULL, *shown = NULL, *nothing = cJSON_CreateObject();
    if (!fleet_plan_find(net_fleet(api->net), wish->plan_id, &plan) || !plan.document || !plan.default_scene) {
        problem_set(&problem, PROBLEM_BUSY, "", "", "the plan was closed meanwhile");
        goto refuse;
    }
    const cJSON *scene_patch = cJSON_GetObjectItemCaseSensitive(wish->body, "scene");
    const cJSON *view_patch = cJSON_GetObjectItemCaseSensitive(wish->body, "view");
    scene = scene_document_patch(plan.document, plan.default_scene, plan.default_scene,
                                 scene_patch ? scene_patch : nothing, &problem);
    if (!scene) {
        problem_below(&problem, "/scene");
        goto refuse;
    }
    view = view_document_patch(NULL, view_patch ? view_patch : nothing, &problem);
    shown = view ? scene_document_for_view(plan.document, plan.default_scene, scene, view, &problem) : NULL;
    if (!shown) {
        problem_below(&problem, "/view");
        goto refuse;
    }
    api_render(api, call, wish->plan_id, shown, NULL, view, json_text(wish->body, "format"),
               json_number(wish->body, "quality", 92));
    goto done;
refuse:
    call_answer_problem(call, &problem);
done:
    cJSON_Delete(nothing);
    cJSON_Delete(scene);
    cJSON_Delete(view);
    cJSON_Delete(shown);
    wish_destroy(wish);
}

/* Opens the plan and calls reply with the call once it is ready (or cannot be). */
static void when_ready(struct api *api, struct call *call, fleet_reply reply)
{
    struct problem problem;
    if (!fleet_open(net_fleet(api->net), call->ids[0], &problem)) {
        reply(call, NULL, &problem);
        return;
    }
    cJSON *query = api_new_query("ready");
    (void)fleet_request(net_fleet(api->net), call->ids[0], query, reply, call);
    cJSON_Delete(query);
}

void api_plan_render(struct api *api, struct call *call)
{
    static const char *const media_types[] = { "application/json", NULL };
    struct fleet_plan plan;
    struct problem problem;
    cJSON *body;
    if (!find_plan(api, call, &plan) || !call_read_object(call, media_types, &body))
        return;
    if (!check_wish(body, &problem)) {
        cJSON_Delete(body);
        call_answer_problem(call, &problem);
        return;
    }
    struct render_wish *wish = mem_new(sizeof *wish);
    (void)snprintf(wish->plan_id, sizeof wish->plan_id, "%s", call->ids[0]);
    wish->body = body;
    call->context = wish;
    when_ready(api, call, render_when_ready);
}

/* ---- numbers ---------------------------------------------------------------------------------------------------- */

void api_plan_probe(struct api *api, struct call *call)
{
    struct fleet_plan plan;
    struct problem problem;
    double point[3];
    if (!find_plan(api, call, &plan))
        return;
    if (!call_query_number(call, "x", true, &point[0], &problem) ||
        !call_query_number(call, "y", true, &point[1], &problem) ||
        !call_query_number(call, "z", true, &point[2], &problem)) {
        call_answer_problem(call, &problem);
        return;
    }
    cJSON *query = api_new_query("probe");
    cJSON_AddItemToObject(query, "point_lps_mm", cJSON_CreateDoubleArray(point, 3));
    api_query(api, call, call->ids[0], query);
}

struct pick_wish {
    char plan_id[64];
    cJSON *view;
    double px, py;
};

static void ask_pick(struct api *api, struct call *call, const struct pick_wish *wish, const struct fleet_plan *plan,
                     const cJSON *scene)
{
    struct problem problem;
    cJSON *shown = scene_document_for_view(plan->document, plan->default_scene, scene, wish->view, &problem);
    if (!shown) {
        problem_below(&problem, "/view");
        call_answer_problem(call, &problem);
        return;
    }
    cJSON *query = api_new_query("pick");
    cJSON_AddItemToObject(query, "scene", shown);
    cJSON_AddItemToObject(query, "view", cJSON_Duplicate(wish->view, true));
    cJSON_AddNumberToObject(query, "px", wish->px);
    cJSON_AddNumberToObject(query, "py", wish->py);
    api_query(api, call, wish->plan_id, query);
}

static void pick_when_ready(void *context, struct packet *answer, const struct problem *not_ready)
{
    struct call *call = context;
    struct api *api = call->api;
    struct pick_wish *wish = call->context;
    struct problem problem;
    struct fleet_plan plan;
    const char *room_id = call_query(call, "room");
    struct room *room = room_id ? net_room_find(api->net, room_id) : NULL;
    uint32_t revision;
    (void)answer;
    if (not_ready) {
        call_answer_problem(call, not_ready);
    } else if (!fleet_plan_find(net_fleet(api->net), wish->plan_id, &plan) || !plan.document || !plan.default_scene) {
        problem_set(&problem, PROBLEM_BUSY, "", "", "the plan was closed meanwhile");
        call_answer_problem(call, &problem);
    } else if (room_id && (!room || strcmp(room_plan_id(room), wish->plan_id) != 0)) {
        problem_set(&problem, PROBLEM_NOT_FOUND, "/room", "", "there is no room \"%.63s\" on this plan", room_id);
        call_answer_problem(call, &problem);
    } else {
        const cJSON *scene = room ? room_scene(room, &revision) : NULL;
        ask_pick(api, call, wish, &plan, scene ? scene : plan.default_scene);
    }
    cJSON_Delete(wish->view);
    free(wish);
}

void api_plan_pick(struct api *api, struct call *call)
{
    struct fleet_plan plan;
    struct problem problem;
    double px, py;
    if (!find_plan(api, call, &plan))
        return;
    if (!call_query_number(call, "px", true, &px, &problem) || !call_query_number(call, "py", true, &py, &problem)) {
        call_answer_problem(call, &problem);
        return;
    }
    cJSON *view = api_view_parameter(call);
    if (!view)
        return;
    struct pick_wish *wish = mem_new(sizeof *wish);
    *wish = (struct pick_wish){ .view = view, .px = px, .py = py };
    (void)snprintf(wish->plan_id, sizeof wish->plan_id, "%s", call->ids[0]);
    call->context = wish;
    when_ready(api, call, pick_when_ready);
}
