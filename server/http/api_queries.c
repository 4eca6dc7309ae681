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

void api_query_send(struct api *api, struct call *call, const char *plan_id, struct packet *question, fleet_reply reply)
{
    struct problem problem;
    if (fleet_open(net_fleet(api->net), plan_id, &problem))
        (void)fleet_request(net_fleet(api->net), plan_id, question, reply, call);
    else
        reply(call, NULL, &problem);
}

void api_query_answer(void *context, struct packet *answer, const struct problem *problem)
{
    struct call *call = context;
    if (problem)
        call_answer_problem(call, problem);
    else
        call_answer_json(call, 200, packet_take_document(answer, answer->answer.body));
}

void api_when_ready(struct api *api, struct call *call, const char *plan_id, fleet_reply reply)
{
    struct packet packet;
    packet_init(&packet, PACKET_AWAIT_READY);
    api_query_send(api, call, plan_id, &packet, reply);
}
