/* The people of a room: who may come in without a link; removing a member. */
#include "core/base/clock.h"
#include "server/http/api_acts.h"
#include "server/http/api_handlers.h"
#include "server/http/api_queries.h"

void api_room_people(struct api *api, struct call *call)
{
    const struct room *room = api_find_room(api, call);
    if (room)
        call_answer_json(call, 200, room_people(room));
}

void api_room_people_patch(struct api *api, struct call *call)
{
    static const char *const media_types[] = { "application/merge-patch+json", "application/json", NULL };
    struct problem problem = { 0 };
    cJSON *patch;
    struct room *room = api_find_room(api, call);
    if (!room || !call_read_object(call, media_types, &patch))
        return;
    const bool is_done =
        net_can_write(api->net, &problem) &&
        room_people_patch(room, patch, &call->identity, call->member, call->client, clock_now_us(), &problem);
    cJSON_Delete(patch);
    if (is_done)
        call_answer_json(call, 200, room_people(room));
    else
        call_answer_problem(call, &problem);
}

void api_room_member_remove(struct api *api, struct call *call)
{
    const char *reason = call_query(call, "reason");
    struct room *room = api_find_room(api, call);
    if (!room)
        return;
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "type", "member.remove");
    cJSON_AddStringToObject(json, "member", call->ids[1]);
    if (reason)
        cJSON_AddStringToObject(json, "reason", reason);
    api_act_in(room, call, json, NULL);
}
