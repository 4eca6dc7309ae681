/* Records exports. */
#include "server/http/api_audit.h"

#include <stdio.h>
#include <string.h>

#include "core/base/clock.h"
#include "server/front/address.h"
#include "server/http/api_access.h"
#include "server/http/api_jobs.h"

bool api_is_of_this_machine(const struct api *api, const struct call *call)
{
    struct address client;
    return api->doors.is_alone && address_read(call->client, strlen(call->client), &client) &&
           address_is_loopback(&client);
}

/* The room on the call's plan in which it is made, as its address says; NULL: none that the caller sees. */
static struct room *room_named(const struct call *call)
{
    const struct api *api = call->api;
    const char *id = call_query(call, "room");
    struct room *room = id && api_access_sees_room(api, call, id) ? net_room_find(api->net, id) : NULL;
    return room && strcmp(room_plan_id(room), call->ids[0]) == 0 ? room : NULL;
}

static void audit_export(struct call *call)
{
    struct api *api = call->api;
    struct net *net = api->net;
    static const char rooms[] = "/api/v1/rooms/", plans[] = "/api/v1/plans/", jobs[] = "/api/v1/jobs/";
    if (call->status >= 300)
        return;
    const bool is_of_room = strncmp(call->path, rooms, sizeof rooms - 1) == 0;
    const bool is_of_plan = strncmp(call->path, plans, sizeof plans - 1) == 0;
    const bool is_of_job = strncmp(call->path, jobs, sizeof jobs - 1) == 0;
    const struct api_job *job = is_of_job ? api_job_find(api, call->ids[0]) : NULL;
    const char *plan_id = is_of_plan ? call->ids[0] : job ? job->plan_id : "";
    struct room *room = is_of_room ? net_room_find(net, call->ids[0]) : is_of_plan ? room_named(call) : NULL;
    if (strcmp(call->exported, "picture") == 0 && !room) { /* as fast as a script asks */
        net_audit_often(net, &call->identity, call->client, "", plan_id, "export", call->exported, false);
        return;
    }
    cJSON *detail = cJSON_CreateObject();
    cJSON_AddStringToObject(detail, "what", call->exported);
    cJSON_AddStringToObject(detail, "media_type", call->media_type);
    cJSON_AddNumberToObject(detail, "bytes", (double)call->n_bytes);
    if (room)
        room_audit_call(room, &call->identity, call->member, call->client, "export", detail, false, clock_now_us());
    else
        net_audit_by(net, &call->identity, call->client, "", plan_id, "export", detail);
}

bool api_audit_has_place(const struct api *api, struct problem *problem)
{
    if (net_audit_has_place(api->net))
        return true;
    problem_set(problem, PROBLEM_STORAGE, "", "audit",
                "what is given away is recorded, and the server's disk takes no more records now");
    problem->retry_after_ms = 10000;
    return false;
}

void api_audit_add_head(const struct api *api, struct call *call)
{
    const struct net_audit_head head = net_audit_head(api->net);
    char text[96];
    if (!head.hash[0])
        return;
    (void)snprintf(text, sizeof text, "%lld %s", (long long)head.n, head.hash);
    call_add_header(call, "Audit-Head", text);
}

/* Guests of a room take no files away; pictures of its plan they see there. */
static bool may_take_away(const struct api *api, const struct call *call, const char *what, struct problem *problem)
{
    const struct room *room = call->ids[0] ? net_room_find(api->net, call->ids[0]) : NULL;
    const bool is_guest = call->identity.source == IDENTITY_NOBODY ||
                          (room && call->member && room_caller_of(room, &call->identity, call->member).is_guest);
    return !is_guest || strcmp(what, "picture") == 0 ||
           problem_set(problem, PROBLEM_FORBIDDEN, "", "role", "a guest takes no files away");
}

bool api_audit_export(struct api *api, struct call *call, const char *what)
{
    struct problem problem;
    if (!may_take_away(api, call, what, &problem) || !api_audit_has_place(api, &problem)) {
        call_answer_problem(call, &problem);
        return false;
    }
    if (!call->exported)
        api_audit_add_head(api, call);
    call->exported = what;
    call->answering = audit_export;
    return true;
}
