/* Recordings of meetings: their list, what a room was at a time, deleting them; rooms that play one. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "server/http/api_access.h"
#include "server/http/api_handlers.h"
#include "server/http/api_queries.h"
#include "server/http/api_recordings.h"

void api_recording_is_missing(const struct call *call, struct problem *problem)
{
    (void)problem_set(problem, PROBLEM_NOT_FOUND, "", "", "the room has no recording \"%.63s\"", call->ids[1]);
}

bool api_may_replay(const struct api *api, const struct call *call, const char *plan_id, struct problem *problem)
{
    return call->identity.source == IDENTITY_MACHINE || api_access_to_plan(api, call, ACCESS_MEET, plan_id) ||
           problem_set(problem, PROBLEM_FORBIDDEN, "", "", "you may not play recordings of this plan");
}

static void answer_missing(struct call *call)
{
    struct problem problem;
    api_recording_is_missing(call, &problem);
    call_answer_problem(call, &problem);
}

void api_room_recordings(struct api *api, struct call *call)
{
    struct room *room = api_find_room(api, call);
    if (!room)
        return;
    cJSON *answer = cJSON_CreateObject();
    json_add(answer, "recordings", room_recordings(room, clock_now_us()));
    call_answer_json(call, 200, answer);
}

void api_room_recording_delete(struct api *api, struct call *call)
{
    struct room *room = api_find_room(api, call);
    if (!room)
        return;
    if (!room_recording_delete(room, call->ids[1], clock_now_us())) {
        answer_missing(call);
        return;
    }
    cJSON *detail = cJSON_CreateObject();
    cJSON_AddStringToObject(detail, "id", call->ids[1]);
    cJSON_AddStringToObject(detail, "state", wire_recording_state_words.words[WIRE_RECORDING_STATE_DELETED]);
    room_audit_call(room, &call->identity, call->member, call->client, "recording", detail, false, clock_now_us());
    call_answer_nothing(call, 204);
}

struct asked_state {
    struct call *call;
    int64_t t_ms;
};

static void part_was_read(void *context, const char *const *texts, size_t n, int64_t next_ms,
                          const struct problem *problem)
{
    struct asked_state *asked = context;
    struct problem found = problem ? *problem : (struct problem){ 0 };
    (void)next_ms;
    cJSON *state = n ? room_recorded_state(texts, n, asked->t_ms, &found) : NULL;
    if (state)
        call_answer_json(asked->call, 200, state);
    else
        call_answer_problem(asked->call, &found);
    free(asked);
}

void api_room_recording_state(struct api *api, struct call *call)
{
    struct problem problem;
    struct room *room = api_find_room(api, call);
    double t_ms = 0;
    if (!room)
        return;
    const struct room_recording *recording = room_recording(room, call->ids[1]);
    if (!recording) {
        answer_missing(call);
        return;
    }
    if (!call_query_number(call, "t_ms", true, &t_ms, &problem)) {
        call_answer_problem(call, &problem);
        return;
    }
    if (!(t_ms >= 0 && t_ms <= ROOM_MAX_RECORDING_S * 1000.0)) {
        problem_set(&problem, PROBLEM_VALIDATION, "/t_ms", "range", "t_ms is %g, expected 0 to %g", t_ms,
                    ROOM_MAX_RECORDING_S * 1000.0);
        call_answer_problem(call, &problem);
        return;
    }
    struct asked_state *asked = mem_new(sizeof *asked);
    *asked = (struct asked_state){ call, (int64_t)t_ms };
    if (net_recording_read(api->net, room_id(room), recording->id, asked->t_ms, part_was_read, asked, &problem))
        return;
    free(asked);
    call_answer_problem(call, &problem);
}

/* ---- rooms that play -------------------------------------------------------------------------------------------- */

struct sleeping {
    struct call *call;
    void (*again)(struct api *api, struct call *call);
};

static void room_awoke(void *context, const char *room_id, const struct problem *problem)
{
    (void)room_id;
    const struct sleeping sleeping = *(struct sleeping *)context;
    free(context);
    if (problem)
        call_answer_problem(sleeping.call, problem);
    else
        sleeping.again(sleeping.call->api, sleeping.call);
}

bool api_recording_sleeps(struct api *api, struct call *call, const cJSON *asked,
                          void (*again)(struct api *api, struct call *call))
{
    const char *id = json_text(asked, "room");
    if (!id || !net_room_is_asleep(api->net, id) || !api_access_sees_room(api, call, id))
        return false;
    struct sleeping *sleeping = mem_new(sizeof *sleeping);
    *sleeping = (struct sleeping){ call, again };
    net_room_wake(api->net, id, room_awoke, sleeping);
    return true;
}

struct room *api_replay_new(struct api *api, const struct call *call, const cJSON *asked, const char *plan_id,
                            struct problem *problem)
{
    const char *id = json_text(asked, "room"), *recording = json_text(asked, "id");
    const cJSON *item;
    cJSON_ArrayForEach(item, asked) if (strcmp(item->string, "room") != 0 && strcmp(item->string, "id") != 0)
    {
        problem_set(problem, PROBLEM_VALIDATION, "/recording", "unknown-field", "%.60s is not a field of it",
                    item->string);
        return NULL;
    }
    if (!id || !recording || !id_is_valid(id) || !id_is_valid(recording)) {
        problem_set(problem, PROBLEM_VALIDATION, "/recording", "type", "\"recording\" must be {room, id}");
        return NULL;
    }
    const struct room *room = net_room_find(api->net, id);
    if (!room || !api_access_sees_room(api, call, id) ||
        !api_access_to_plan(api, call, ACCESS_MEET, room_plan_id(room))) {
        problem_set(problem, PROBLEM_NOT_FOUND, "/recording/room", "", "there is no room \"%.63s\"", id);
        return NULL;
    }
    if (!room_may(room, &call->identity, call->member, WIRE_RIGHT_LOOK, false, problem))
        return NULL;
    if (plan_id && strcmp(plan_id, room_plan_id(room)) != 0) {
        problem_set(problem, PROBLEM_VALIDATION, "/plan", "enum", "the meeting was on the plan \"%.63s\"",
                    room_plan_id(room));
        return NULL;
    }
    return net_replay_create(api->net, room, recording, problem);
}
