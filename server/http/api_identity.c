/* GET /plans/{plan}/identity, and GET /rooms/{room}/identity for a wall on which somebody has it shown: the only
 * answers that name patients in full. As every answer of the API they are not stored (Cache-Control: no-store). */
#include <string.h>

#include "core/base/clock.h"
#include "server/http/api_access.h"
#include "server/http/api_audit.h"
#include "server/http/api_handlers.h"
#include "server/http/api_queries.h"

/* A person who has signed in has the right, which was asked for. Where nobody signs in, everybody who can reach the
 * server counts as the same person: names are given only where that is the person at this machine. */
static bool may_read(const struct api *api, const struct call *call, struct problem *problem)
{
    if (call->identity.source == IDENTITY_MACHINE && !api_is_of_this_machine(api, call))
        return problem_set(problem, PROBLEM_FORBIDDEN, "", "identity",
                           "who a patient is is told only to the person at the server's own machine (a listener on "
                           "127.0.0.1 or [::1], without --open-to-everybody), as nobody signs in here");
    /* a page of another site could not read the answer, but it could fill the audit with rows */
    if (call->fetch_site && strcmp(call->fetch_site, "same-origin") != 0 && strcmp(call->fetch_site, "none") != 0)
        return problem_set(problem, PROBLEM_FORBIDDEN, "", "identity",
                           "a page of another site (Sec-Fetch-Site: %.40s) may not ask who a patient is",
                           call->fetch_site);
    return api_audit_has_place(api, problem);
}

bool api_may_name(const struct api *api, const struct call *call, const char *plan_id, struct problem *problem)
{
    if (!may_read(api, call, problem))
        return false;
    return api_access_to_plan(api, call, ACCESS_IDENTITY, plan_id) ||
           problem_set(problem, PROBLEM_FORBIDDEN, "", "role",
                       "this needs the right \"%s\", which you do not have here", access_rights[ACCESS_IDENTITY].word);
}

static void audit_identity(struct call *call)
{
    struct net *net = ((struct api *)call->api)->net;
    const char *room_id = call_query(call, "room");
    struct room *room = room_id && api_access_sees_room(call->api, call, room_id) ? net_room_find(net, room_id) : NULL;
    if (call->status >= 300)
        return;
    if (room && strcmp(room_plan_id(room), call->ids[0]) == 0) {
        room_identity_read(room, call->member, clock_now_us());
        room_audit_call(room, &call->identity, call->member, call->client, "identity", cJSON_CreateObject(), false,
                        clock_now_us());
    } else {
        net_audit_by(net, &call->identity, call->client, "", call->ids[0], "identity", cJSON_CreateObject());
    }
}

void api_plan_identity(struct api *api, struct call *call)
{
    struct fleet_plan plan;
    struct problem problem;
    struct packet question;
    if (!may_read(api, call, &problem)) {
        call_answer_problem(call, &problem);
        return;
    }
    if (!api_find_plan(api, call, &plan))
        return;
    call->answering = audit_identity;
    packet_init(&question, PACKET_IDENTITY);
    api_query_send(api, call, call->ids[0], &question, api_query_answer);
}

/* ---- on the walls of a room ------------------------------------------------------------------------------------- */

static void audit_wall(struct call *call)
{
    struct room *room = net_room_find(((struct api *)call->api)->net, call->ids[0]);
    if (room && call->status < 300)
        room_audit_call(room, &call->identity, call->member, call->client, "identity", cJSON_CreateObject(), false,
                        clock_now_us());
}

void api_room_identity(struct api *api, struct call *call)
{
    const struct room *room = api_find_room(api, call);
    struct problem problem;
    struct packet question;
    if (!room)
        return;
    if (!room_wall_is_naming(room, call->member)) {
        problem_set(&problem, PROBLEM_FORBIDDEN, "", "identity",
                    "nobody has the patient named on this wall: send Beamroom-Member of a wall that names the patient");
        call_answer_problem(call, &problem);
        return;
    }
    if (!api_audit_has_place(api, &problem)) {
        call_answer_problem(call, &problem);
        return;
    }
    call->answering = audit_wall;
    packet_init(&question, PACKET_IDENTITY);
    api_query_send(api, call, room_plan_id(room), &question, api_query_answer);
}

static bool read_shown(struct call *call, bool *is_shown)
{
    static const char *const media_types[] = { "application/json", NULL };
    struct problem problem;
    cJSON *body;
    if (!call_read_object(call, media_types, &body))
        return false;
    const cJSON *shown = cJSON_GetObjectItemCaseSensitive(body, "shown");
    const bool is_right = cJSON_IsBool(shown) && cJSON_GetArraySize(body) == 1;
    *is_shown = cJSON_IsTrue(shown);
    cJSON_Delete(body);
    if (!is_right) {
        problem_set(&problem, PROBLEM_VALIDATION, "/shown", "type", "expected is one field, shown: true or false");
        call_answer_problem(call, &problem);
    }
    return is_right;
}

void api_room_wall_identity(struct api *api, struct call *call)
{
    struct room *room = api_find_room(api, call);
    struct problem problem;
    bool is_shown;
    if (!room)
        return;
    if (!may_read(api, call, &problem)) {
        call_answer_problem(call, &problem);
        return;
    }
    if (!read_shown(call, &is_shown))
        return;
    if (room_wall_name(room, call->ids[1], is_shown, &call->identity, call->member, call->client, clock_now_us(),
                       &problem))
        call_answer_nothing(call, 204);
    else
        call_answer_problem(call, &problem);
}
