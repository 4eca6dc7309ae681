/* Sends queries of calls to renderers and answers the calls. */
#include "server/http/api_queries.h"

bool api_find_plan(struct api *api, struct call *call, struct fleet_plan *plan)
{
    if (fleet_plan_find(net_fleet(api->net), call->ids[0], plan))
        return true;
    struct problem problem;
    fleet_no_plan(net_fleet(api->net), call->ids[0], &problem);
    call_answer_problem(call, &problem);
    return false;
}

cJSON *api_query_create(const char *what)
{
    cJSON *query = cJSON_CreateObject();
    cJSON_AddStringToObject(query, "type", "query");
    cJSON_AddStringToObject(query, "what", what);
    return query;
}

void api_query_send(struct api *api, struct call *call, const char *plan_id, cJSON *query, fleet_reply reply)
{
    struct problem problem;
    if (fleet_open(net_fleet(api->net), plan_id, &problem))
        (void)fleet_request(net_fleet(api->net), plan_id, query, reply, call);
    else
        reply(call, NULL, &problem);
    cJSON_Delete(query);
}

void api_query_answer(void *context, struct packet *answer, const struct problem *problem)
{
    struct call *call = context;
    if (problem) {
        call_answer_problem(call, problem);
        return;
    }
    cJSON *body = cJSON_DetachItemFromObjectCaseSensitive(answer->json, "body");
    struct problem broken;
    if (!body) {
        problem_set(&broken, PROBLEM_RENDERER, "", "", "the renderer's answer has no body");
        call_answer_problem(call, &broken);
        return;
    }
    call_answer_json(call, 200, body);
}

void api_when_ready(struct api *api, struct call *call, const char *plan_id, fleet_reply reply)
{
    api_query_send(api, call, plan_id, api_query_create("ready"), reply);
}
