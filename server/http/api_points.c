/* Numbers at a point: GET /plans/{plan}/probe at a patient point, and /pick under a pixel. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/http/api_handlers.h"
#include "server/http/api_pictures.h"
#include "server/http/api_queries.h"

void api_plan_probe(struct api *api, struct call *call)
{
    struct fleet_plan plan;
    struct problem problem;
    double point[3];
    if (!api_find_plan(api, call, &plan))
        return;
    if (!call_query_number(call, "x", true, &point[0], &problem) ||
        !call_query_number(call, "y", true, &point[1], &problem) ||
        !call_query_number(call, "z", true, &point[2], &problem)) {
        call_answer_problem(call, &problem);
        return;
    }
    cJSON *query = api_query_create("probe");
    cJSON_AddItemToObject(query, "point_lps_mm", cJSON_CreateDoubleArray(point, 3));
    api_query_send(api, call, call->ids[0], query, api_query_answer);
}

struct pick_call {
    char plan_id[64];
    cJSON *view;
    double px, py;
};

static void send_pick(struct api *api, struct call *call, const struct pick_call *request,
                      const struct fleet_plan *plan, const cJSON *scene)
{
    struct problem problem;
    cJSON *shown = scene_document_for_view(plan->document, plan->default_scene, scene, request->view, &problem);
    if (!shown) {
        problem_below(&problem, "/view");
        call_answer_problem(call, &problem);
        return;
    }
    cJSON *query = api_query_create("pick");
    cJSON_AddItemToObject(query, "scene", shown);
    cJSON_AddItemToObject(query, "view", cJSON_Duplicate(request->view, true));
    cJSON_AddNumberToObject(query, "px", request->px);
    cJSON_AddNumberToObject(query, "py", request->py);
    api_query_send(api, call, request->plan_id, query, api_query_answer);
}

static void pick_when_ready(void *context, struct packet *answer, const struct problem *not_ready)
{
    struct call *call = context;
    struct api *api = call->api;
    struct pick_call *request = call->context;
    struct problem problem;
    struct fleet_plan plan;
    const char *room_id = call_query(call, "room");
    struct room *room = room_id ? net_room_find(api->net, room_id) : NULL;
    uint32_t revision;
    (void)answer;
    if (not_ready) {
        call_answer_problem(call, not_ready);
    } else if (!fleet_plan_find(net_fleet(api->net), request->plan_id, &plan) || !plan.document ||
               !plan.default_scene) {
        problem_set(&problem, PROBLEM_BUSY, "", "", "the plan was closed meanwhile");
        call_answer_problem(call, &problem);
    } else if (room_id && (!room || strcmp(room_plan_id(room), request->plan_id) != 0)) {
        problem_set(&problem, PROBLEM_NOT_FOUND, "/room", "", "there is no room \"%.63s\" on this plan", room_id);
        call_answer_problem(call, &problem);
    } else {
        const cJSON *scene = room ? room_scene(room, &revision) : NULL;
        send_pick(api, call, request, &plan, scene ? scene : plan.default_scene);
    }
    cJSON_Delete(request->view);
    free(request);
}

void api_plan_pick(struct api *api, struct call *call)
{
    struct fleet_plan plan;
    struct problem problem;
    double px, py;
    if (!api_find_plan(api, call, &plan))
        return;
    if (!call_query_number(call, "px", true, &px, &problem) || !call_query_number(call, "py", true, &py, &problem)) {
        call_answer_problem(call, &problem);
        return;
    }
    cJSON *view = api_view_parameter(call);
    if (!view)
        return;
    struct pick_call *request = mem_new(sizeof *request);
    *request = (struct pick_call){ .view = view, .px = px, .py = py };
    (void)snprintf(request->plan_id, sizeof request->plan_id, "%s", call->ids[0]);
    call->context = request;
    api_when_ready(api, call, call->ids[0], pick_when_ready);
}
