/* GET /plans/{plan}/regions/{region}/surface: a shape's figures, the time to draw it, or the shape as a file. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/http/api_audit.h"
#include "server/http/api_handlers.h"
#include "server/http/api_queries.h"
#include "server/http/api_questions.h"
#include "server/wire/document.h"
#include "server/wire/shape_query.h"

enum { TIMED_PX = 650 }; /* the window in which Sera3d's frame rates were taken */

/* A call for a shape that is not answered yet. */
struct shape_call {
    char plan_id[64], region[64];
    struct shape_query query;
    cJSON *body;         /* the figures, while pictures are timed */
    cJSON *scene, *view; /* what the timed pictures show */
    double draw_ms[SHAPE_QUERY_MAX_FRAMES];
    int n_drawn; /* -1: the first picture, which is not counted, is still to come */
};

static void shape_call_destroy(struct api *api, struct shape_call *request)
{
    api->n_files -= request->query.is_file;
    api->n_timings -= !request->query.is_file && request->query.n_frames > 0;
    cJSON_Delete(request->body);
    cJSON_Delete(request->scene);
    cJSON_Delete(request->view);
    free(request);
}

static void refuse(struct call *call, struct shape_call *request, const struct problem *problem)
{
    shape_call_destroy(call->api, request);
    call_answer_problem(call, problem);
}

static void file_came(struct call *call, struct shape_call *request, struct packet *answer)
{
    char name[192];
    (void)snprintf(name, sizeof name, "%.63s-%.63s", request->plan_id, request->region);
    enum mesh_format format = request->query.format;
    shape_call_destroy(call->api, request);
    api_mesh_answer(call, answer, name, format);
}

/* ---- frames per second ------------------------------------------------------------------------------------------ */

static int compare_numbers(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void picture_came(void *context, struct packet *answer, const struct problem *problem);

static void request_picture(struct call *call, const struct shape_call *request)
{
    const struct api *api = call->api;
    struct packet packet;
    packet_init(&packet, PACKET_RENDER);
    packet.render.shown.scene = request->scene;
    packet.render.shown.view = request->view;
    packet.render.quality = 50;
    (void)fleet_request(net_fleet(api->net), request->plan_id, &packet, picture_came, call);
}

static void picture_came(void *context, struct packet *answer, const struct problem *problem)
{
    struct call *call = context;
    struct shape_call *request = call->context;
    if (problem) {
        refuse(call, request, problem);
        return;
    }
    if (request->n_drawn >= 0)
        request->draw_ms[request->n_drawn] = (double)answer->frame.render_us / 1000;
    if (++request->n_drawn < request->query.n_frames) {
        request_picture(call, request);
        return;
    }
    qsort(request->draw_ms, (size_t)request->n_drawn, sizeof request->draw_ms[0], compare_numbers);
    double median_ms = request->draw_ms[request->n_drawn / 2];
    cJSON *body = request->body;
    request->body = NULL;
    cJSON_AddNumberToObject(body, "draw_ms", median_ms);
    if (median_ms > 0)
        cJSON_AddNumberToObject(body, "frames_per_second", 1000 / median_ms);
    shape_call_destroy(call->api, request);
    call_answer_json(call, 200, body);
}

/* Sets what the timed pictures show: the region alone, at full detail. False with problem. */
static bool set_timed_picture(const struct fleet_plan *plan, struct shape_call *request, struct problem *problem)
{
    cJSON *patch = shape_query_scene(&request->query, request->region, plan->default_scene);
    request->scene = scene_document_patch(plan->document, plan->default_scene, plan->default_scene, patch, problem);
    cJSON_Delete(patch);
    cJSON *size = cJSON_CreateObject();
    cJSON_AddItemToObject(size, "size_px", cJSON_CreateIntArray((const int[]){ TIMED_PX, TIMED_PX }, 2));
    request->view = request->scene ? view_document_patch(NULL, size, problem) : NULL;
    cJSON_Delete(size);
    return request->view != NULL;
}

static void shape_came(void *context, struct packet *answer, const struct problem *problem)
{
    struct call *call = context;
    const struct api *api = call->api;
    struct shape_call *request = call->context;
    struct fleet_plan plan;
    struct problem broken;
    if (problem) {
        refuse(call, request, problem);
        return;
    }
    if (request->query.is_file) {
        file_came(call, request, answer);
        return;
    }
    if (request->query.n_frames == 0) {
        shape_call_destroy(call->api, request);
        api_query_answer(call, answer, NULL);
        return;
    }
    request->body = packet_take_document(answer, answer->answer.body);
    bool is_found =
        fleet_plan_find(net_fleet(api->net), request->plan_id, &plan) && plan.document && plan.default_scene;
    if (!is_found)
        problem_set(&broken, PROBLEM_BUSY, "", "", "the plan was closed meanwhile");
    if (!is_found || !set_timed_picture(&plan, request, &broken)) {
        refuse(call, request, &broken);
        return;
    }
    request->n_drawn = -1;
    request_picture(call, request);
}

/* True if one more file or timing may begin: each keeps memory or a renderer busy for long. */
static bool is_free(struct api *api, const struct shape_query *query, struct problem *problem)
{
    if (query->is_file && api->n_files == API_MAX_FILES)
        problem_set(problem, PROBLEM_BUSY, "", "", "%zu surfaces are being written already", api->n_files);
    else if (query->n_frames > 0 && api->n_timings == API_MAX_TIMINGS)
        problem_set(problem, PROBLEM_BUSY, "", "", "%zu shapes are being timed already", api->n_timings);
    else
        return true;
    problem->retry_after_ms = 1000;
    return false;
}

void api_plan_surface(struct api *api, struct call *call)
{
    struct fleet_plan plan;
    struct problem problem;
    struct shape_query shape;
    if (!fleet_plan_find(net_fleet(api->net), call->ids[0], &plan)) {
        problem_set(&problem, PROBLEM_NOT_FOUND, "", "", "there is no plan \"%.63s\"", call->ids[0]);
        call_answer_problem(call, &problem);
        return;
    }
    cJSON *words = cJSON_CreateObject();
    for (const char *const *name = shape_query_names; *name; name++)
        if (call_query(call, *name))
            cJSON_AddStringToObject(words, *name, call_query(call, *name));
    bool is_good = shape_query_read(words, &shape, &problem) && is_free(api, &shape, &problem);
    cJSON_Delete(words);
    cJSON *path = cJSON_CreateObject();
    cJSON_AddStringToObject(path, "region", call->ids[1]);
    struct packet packet = { 0 };
    if (!is_good)
        cJSON_Delete(path);
    if (!is_good || !api_question_read(call, PACKET_SURFACE, path, &packet, &problem)) {
        call_answer_problem(call, &problem);
        return;
    }
    if (shape.is_file && !api_audit_export(api, call, "surface")) {
        packet_finish(&packet);
        return;
    }
    struct shape_call *request = mem_new(sizeof *request);
    (void)snprintf(request->plan_id, sizeof request->plan_id, "%s", call->ids[0]);
    (void)snprintf(request->region, sizeof request->region, "%s", call->ids[1]);
    request->query = shape;
    api->n_files += shape.is_file;
    api->n_timings += !shape.is_file && shape.n_frames > 0;
    call->context = request;
    api_query_send(api, call, request->plan_id, &packet, shape_came);
    packet_finish(&packet);
}
