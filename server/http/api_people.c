/* The people of a room: who may come in without a link; removing a member. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "server/http/api_handlers.h"
#include "server/http/api_queries.h"
#include "server/wire/message.h"

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

static void removed(void *context, const char *row, bool was_sent_before, const struct problem *problem)
{
    struct call *call = context;
    (void)row;
    (void)was_sent_before;
    if (problem)
        call_answer_problem(call, problem);
    else
        call_answer_nothing(call, 204);
}

void api_room_member_remove(struct api *api, struct call *call)
{
    struct problem problem = { 0 };
    struct message message;
    const char *reason = call_query(call, "reason");
    struct room *room = api_find_room(api, call);
    if (!room)
        return;
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "type", "member.remove");
    cJSON_AddStringToObject(json, "member", call->ids[1]);
    if (reason)
        cJSON_AddStringToObject(json, "reason", reason);
    char *text = json_print(json);
    cJSON_Delete(json);
    const bool is_read =
        text ? message_read(text, strlen(text), true, &message, &problem) : json_no_memory(&problem, "a message");
    free(text);
    if (!is_read) {
        call_answer_problem(call, &problem);
        return;
    }
    const struct room_act act = { .member = call->member,
                                  .identity = &call->identity,
                                  .address = call->client,
                                  .message = &message,
                                  .done = removed,
                                  .context = call };
    room_act(room, &act, clock_now_us());
    message_finish(&message);
}
