/* Finds out the subject of a call's right, asks access_check, and answers who does not have it. */
#include "server/http/api_access.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/base/clock.h"
#include "server/front/address.h"
#include "server/http/api_handlers.h"
#include "server/http/api_jobs.h"
#include "server/http/api_meetings.h"
#include "server/http/api_queries.h"
#include "server/http/api_rates.h"
#include "server/wire/json.h"

static bool needs_sign_in(struct problem *problem)
{
    return problem_set(problem, PROBLEM_SIGN_IN, "", "", "nobody has signed in: sign in first");
}

static bool refuse_nobody(struct call *call)
{
    struct problem problem;
    if (strcmp(call->route, "/p/{saved}") == 0 &&
        id_is_valid(call->ids[0])) { /* an address that people open: after signing in it goes on */
        char location[96];
        (void)snprintf(location, sizeof location, "/signin?return=/p/%.63s", call->ids[0]);
        call_add_header(call, "Location", location);
        call_answer_nothing(call, 303);
        return false;
    }
    needs_sign_in(&problem);
    call_add_header(call, "WWW-Authenticate", "Bearer realm=\"Beamroom\"");
    call_answer_problem(call, &problem);
    return false;
}

static bool lacks_right(enum access_right right, struct problem *problem)
{
    return problem_set(problem, PROBLEM_FORBIDDEN, "", "role",
                       "this needs the right \"%s\", which you do not have here", access_rights[right].word);
}

/* Records that somebody who has signed in asked for more than they have, of a plan or room that is there. */
static void record_refusal(const struct call *call, const struct access_route *need)
{
    static const char rooms[] = "/api/v1/rooms/";
    const struct api *api = call->api;
    const bool is_of_room = strncmp(call->path, rooms, sizeof rooms - 1) == 0;
    const char *id = call->ids[0] ? call->ids[0] : "";
    if (call->identity.user[0])
        net_audit_often(api->net, &call->identity, call->client, is_of_room ? id : "",
                        need->subject == ACCESS_SUBJECT_KIND_PLAN ? id : "", "refused", access_rights[need->right].word,
                        true);
}

/* The caller sees that the subject is there. */
static bool refuse_role(struct call *call, const struct access_route *need)
{
    struct problem problem;
    if (call->identity.source == IDENTITY_NOBODY)
        return refuse_nobody(call);
    record_refusal(call, need);
    lacks_right(need->right, &problem);
    call_answer_problem(call, &problem);
    return false;
}

/* ---- plans ------------------------------------------------------------------------------------------------------ */

bool api_access_to_plan(const struct api *api, const struct call *call, enum access_right right, const char *plan_id)
{
    return plan_rights_check(api->rights, net_fleet(api->net), &call->identity, right, plan_id);
}

bool api_access_to_found_plan(const struct api *api, const struct call *call, enum access_right right,
                              const struct fleet_plan *plan)
{
    return plan_rights_check_found(api->rights, plan, &call->identity, right);
}

static bool seat_allows(const struct api *api, const struct call *call, enum access_right right, const char *plan_id);

/* True for the place where the three slices of a room meet. A wall has its numbers from the scene, so it sends the same
 * ones. */
static bool is_crosshair(const struct call *call, const struct room *room)
{
    static const char *const parameters[3] = { "x", "y", "z" };
    static const char *const axes[3] = { "sagittal", "coronal", "axial" };
    static const double tolerance_mm = 1e-6;
    uint32_t revision;
    const cJSON *image = cJSON_GetObjectItemCaseSensitive(room_scene(room, &revision), "image"),
                *slices = cJSON_GetObjectItemCaseSensitive(image, "slices");
    for (int i = 0; i < 3; i++) {
        struct problem problem;
        double asked = 0;
        const double position_mm = json_number(cJSON_GetObjectItemCaseSensitive(slices, axes[i]), "position_mm", NAN);
        if (!call_query_number(call, parameters[i], true, &asked, &problem) ||
            !(fabs(asked - position_mm) <= tolerance_mm))
            return false;
    }
    return true;
}

/* A wall shows the values at the crosshair of its room, so it may ask for them, and for no other place. */
static bool wall_may_probe(const struct api *api, struct call *call, const struct access_route *need)
{
    const bool is_probe = need->right == ACCESS_MEASURE && (strcmp(need->path, "/api/v1/plans/{plan}/probe") == 0 ||
                                                            strcmp(need->path, "/api/v1/plans/{plan}/dose/probe") == 0);
    const char *room_id = call_query(call, "room");
    const struct room *room = is_probe && room_id && call->member ? net_room_find(api->net, room_id) : NULL;
    if (!room || strcmp(room_plan_id(room), call->ids[0]) != 0)
        return false;
    const struct room_caller caller = room_caller_of(room, &call->identity, call->member);
    call->is_of_wall =
        caller.is_here && caller.is_member && caller.role == WIRE_MEMBER_ROLE_WALL && is_crosshair(call, room);
    return call->is_of_wall;
}

static bool check_plan(struct api *api, struct call *call, const struct access_route *need, api_again *again)
{
    const char *id = call->ids[0];
    struct fleet_plan found;
    struct problem problem;
    const bool is_there = fleet_plan_find(net_fleet(api->net), id, &found);
    if (is_there && (api_access_to_plan(api, call, need->right, id) || seat_allows(api, call, need->right, id)))
        return true;
    if (is_there && wall_may_probe(api, call, need))
        return true;
    if (!is_there && need->right == ACCESS_SERVE && api_access_to_plan(api, call, need->right, id))
        return true; /* erasing reaches what is kept of a plan that is gone */
    if (is_there && (api_access_to_plan(api, call, ACCESS_LOOK, id) || seat_allows(api, call, ACCESS_LOOK, id)))
        return refuse_role(call, need);
    if (call->identity.source == IDENTITY_NOBODY)
        return refuse_nobody(call);
    if (is_there)
        record_refusal(call, need);
    if (api_lists_first(api, call, again)) /* as long as it takes for a plan that is not there */
        return false;
    fleet_no_plan(net_fleet(api->net), id, &problem);
    call_answer_problem(call, &problem);
    return false;
}

bool api_access_makes_room(const struct api *api, const struct call *call, const char *plan_id, struct problem *problem)
{
    struct fleet_plan found;
    const bool is_there = fleet_plan_find(net_fleet(api->net), plan_id, &found);
    if (is_there && api_access_to_plan(api, call, ACCESS_MEET, plan_id))
        return true;
    return is_there && api_access_to_plan(api, call, ACCESS_LOOK, plan_id)
               ? lacks_right(ACCESS_MEET, problem)
               : fleet_no_plan(net_fleet(api->net), plan_id, problem);
}

/* ---- rooms ------------------------------------------------------------------------------------------------------ */

bool api_access_sees_room(const struct api *api, const struct call *call, const char *room_id)
{
    const struct room *room = net_room_find(api->net, room_id);
    if (call->identity.source == IDENTITY_MACHINE)
        return true;
    return room ? room_caller_of(room, &call->identity, call->member).is_here
                : net_asleep_is_seen_by(api->net, room_id, &call->identity);
}

/* The role of the caller as a member of the room; of the role wall it is the lowest. */
static enum access_role role_in(const struct room *room, const struct call *call)
{
    static const enum access_role roles[] = {
        [WIRE_MEMBER_ROLE_WALL] = ACCESS_ROLE_OBSERVER,     [WIRE_MEMBER_ROLE_OBSERVER] = ACCESS_ROLE_OBSERVER,
        [WIRE_MEMBER_ROLE_REVIEWER] = ACCESS_ROLE_REVIEWER, [WIRE_MEMBER_ROLE_PRESENTER] = ACCESS_ROLE_PRESENTER,
        [WIRE_MEMBER_ROLE_PLANNER] = ACCESS_ROLE_PLANNER,
    };
    const struct room_caller caller = room_caller_of(room, &call->identity, call->member);
    return caller.is_here ? roles[caller.role] : ACCESS_ROLE_NONE;
}

/* The rights that a seat in a room on this plan gives on the plan. */
static bool seat_allows(const struct api *api, const struct call *call, enum access_right right, const char *plan_id)
{
    struct access_subject subject = { .kind = ACCESS_SUBJECT_KIND_PLAN };
    for (size_t i = 0; call->member && i < net_n_rooms(api->net); i++) {
        const struct room *room = net_room_at(api->net, i);
        if (strcmp(room_plan_id(room), plan_id) != 0)
            continue;
        const enum access_role role = role_in(room, call);
        subject.room_role = role > subject.room_role ? role : subject.room_role;
    }
    return subject.room_role > ACCESS_ROLE_NONE && access_check(NULL, &call->identity, right, &subject);
}

/* The room is awake, and the caller sees it. */
static bool room_allows(const struct api *api, const struct call *call, const struct access_route *need,
                        const struct room *room)
{
    struct plan_subject plan;
    plan_subject_fill(api->rights, net_fleet(api->net), room_plan_id(room), &plan);
    plan.subject.kind = need->subject;
    plan.subject.is_closed = true; /* but for those whom it lets in */
    plan.subject.room_role = role_in(room, call);
    return access_check(api->rights->access, &call->identity, need->right, &plan.subject);
}

bool api_access_may_export(const struct api *api, const struct call *call, const char *plan_id, const char *room_id,
                           struct problem *problem)
{
    static const struct access_route need = { .right = ACCESS_EXPORT, .subject = ACCESS_SUBJECT_KIND_ROOM };
    const struct room *room = room_id[0] ? net_room_find(api->net, room_id) : NULL;
    const bool sees_room = room_id[0] && api_access_sees_room(api, call, room_id);
    if (call->identity.source == IDENTITY_MACHINE || api_access_to_plan(api, call, ACCESS_EXPORT, plan_id) ||
        (room && sees_room && room_allows(api, call, &need, room)))
        return true;
    if (sees_room || api_access_to_plan(api, call, ACCESS_LOOK, plan_id))
        return lacks_right(ACCESS_EXPORT, problem);
    problem->type = PROBLEM_NOT_FOUND;
    return false;
}

static bool check_room(struct api *api, struct call *call, const struct access_route *need)
{
    struct problem problem;
    const struct room *room = net_room_find(api->net, call->ids[0]);
    if (api_access_sees_room(api, call, call->ids[0])) {
        return !room || /* asked again when it is awake */
               room_allows(api, call, need, room) || refuse_role(call, need);
    }
    if (call->identity.source == IDENTITY_NOBODY)
        return refuse_nobody(call);
    if (room || net_room_is_asleep(api->net, call->ids[0]))
        record_refusal(call, need);
    if (net_rooms_are_known(api->net, &problem))
        problem_set(&problem, PROBLEM_NOT_FOUND, "", "", "there is no room \"%.63s\"", call->ids[0]);
    call_answer_problem(call, &problem);
    return false;
}

/* ---- meetings --------------------------------------------------------------------------------------------------- */

static bool check_meeting(struct api *api, struct call *call, const struct access_route *need)
{
    static const enum access_role roles[] = {
        [WIRE_MEMBER_ROLE_WALL] = ACCESS_ROLE_NONE,         [WIRE_MEMBER_ROLE_OBSERVER] = ACCESS_ROLE_OBSERVER,
        [WIRE_MEMBER_ROLE_REVIEWER] = ACCESS_ROLE_REVIEWER, [WIRE_MEMBER_ROLE_PRESENTER] = ACCESS_ROLE_PRESENTER,
        [WIRE_MEMBER_ROLE_PLANNER] = ACCESS_ROLE_PLANNER,
    };
    struct problem problem;
    struct access_subject subject = { .kind = ACCESS_SUBJECT_KIND_MEETING, .is_closed = true };
    const struct meeting *meeting = net_meeting_find(api->net, call->ids[0]);
    enum wire_member_role role;
    if (call->identity.source == IDENTITY_NOBODY)
        return refuse_nobody(call);
    if (meeting && api_meeting_role(api, call, meeting, &role))
        subject.room_role = roles[role];
    if (meeting && access_check(api->rights->access, &call->identity, need->right, &subject))
        return true;
    if (meeting && access_check(api->rights->access, &call->identity, ACCESS_LOOK, &subject))
        return refuse_role(call, need);
    if (net_rooms_are_known(api->net, &problem))
        problem_set(&problem, PROBLEM_NOT_FOUND, "", "", "there is no meeting \"%.63s\"", call->ids[0]);
    call_answer_problem(call, &problem);
    return false;
}

/* ---- other subjects --------------------------------------------------------------------------------------------- */

static bool check_job(struct api *api, struct call *call, const struct access_route *need)
{
    const struct api_job *job = api_job_find(api, call->ids[0]);
    struct plan_subject plan = { .subject = { 0 } };
    if (call->identity.source == IDENTITY_NOBODY)
        return refuse_nobody(call);
    if (job && job->plan_id[0])
        plan_subject_fill(api->rights, net_fleet(api->net), job->plan_id, &plan);
    plan.subject.is_upload = plan.subject.is_upload || (job && job->upload);
    plan.subject.kind = ACCESS_SUBJECT_KIND_ROOM;
    plan.subject.is_closed = true; /* but for its maker */
    if (job && job->user[0] && strcmp(job->user, call->identity.user) == 0)
        plan.subject.room_role = ACCESS_ROLE_PLANNER;
    if (job && access_check(api->rights->access, &call->identity, need->right, &plan.subject)) {
        const struct access_route ends_for_all = { .right = ACCESS_CLOSE };
        return call->method != CALL_DELETE || job->upload || job->film ||
               api_access_to_plan(api, call, ends_for_all.right, job->plan_id) || refuse_role(call, &ends_for_all);
    }
    api_job_answer_missing(call);
    return false;
}

static bool is_of_this_machine(const struct call *call)
{
    struct address client;
    return address_read(call->client, strlen(call->client), &client) && address_is_loopback(&client);
}

bool api_access_may_upload(const struct api *api, const struct call *call, struct problem *problem)
{
    const struct access_subject uploads = { .kind = ACCESS_SUBJECT_KIND_UPLOADS };
    if (access_check(api->rights->access, &call->identity, ACCESS_PLAN, &uploads))
        return true;
    return call->identity.source == IDENTITY_NOBODY ? needs_sign_in(problem) : lacks_right(ACCESS_PLAN, problem);
}

static bool check_server(struct api *api, struct call *call, const struct access_route *need)
{
    const struct access_subject subject = { .kind = need->subject };
    return access_check(api->rights->access, &call->identity, need->right, &subject) || refuse_role(call, need);
}

static bool check_subject(struct api *api, struct call *call, const struct access_route *need, api_again *again)
{
    switch (need->subject) {
    case ACCESS_SUBJECT_KIND_PLAN: return check_plan(api, call, need, again);
    case ACCESS_SUBJECT_KIND_ROOM: return check_room(api, call, need);
    case ACCESS_SUBJECT_KIND_MEETING: return check_meeting(api, call, need);
    case ACCESS_SUBJECT_KIND_JOB: return check_job(api, call, need);
    case ACCESS_SUBJECT_KIND_NONE:
    case ACCESS_SUBJECT_KIND_SERVER:
    case ACCESS_SUBJECT_KIND_UPLOADS: return check_server(api, call, need);
    case ACCESS_SUBJECT_KIND_RECORD:
    case ACCESS_SUBJECT_KIND_SAVED:
    case ACCESS_SUBJECT_KIND_NAMED: /* its handler asks for the plan, once that is found: api_access_to_plan */
        return call->identity.source != IDENTITY_NOBODY || refuse_nobody(call);
    case ACCESS_N_SUBJECT_KINDS: break;
    }
    return refuse_role(call, need);
}

/* Counts the call for its caller, once. False: it was answered, as there were too many. */
static bool check_rates(struct api *api, struct call *call, const struct api_route *route)
{
    const char *path = route->path, *last = strrchr(path, '/');
    const bool is_new = strcmp(route->method, "POST") == 0;
    const bool is_stream = strcmp(last, "/stream") == 0 || strcmp(last, "/events") == 0;
    const int64_t now_us = clock_now_us();
    struct problem problem;
    if (call->is_counted)
        return true;
    call->is_counted = true;
    if (api_rates_take(api->rates, call, API_RATE_CALLS, now_us, &problem) &&
        (!is_new || strcmp(path, "/api/v1/rooms") != 0 ||
         api_rates_take(api->rates, call, API_RATE_ROOMS, now_us, &problem)) &&
        (!is_new || strcmp(path, "/api/v1/plans") != 0 ||
         api_rates_take(api->rates, call, API_RATE_UPLOADS, now_us, &problem)) &&
        (!is_stream || api_rates_take(api->rates, call, API_RATE_STREAMS, now_us, &problem)))
        return true;
    call_answer_problem(call, &problem);
    return false;
}

bool api_access_allows(struct api *api, struct call *call, const struct api_route *route, api_again *again)
{
    const struct access_route *need = access_route_find(route->method, route->path);
    if (call->identity.source == IDENTITY_MACHINE)
        return true;
    if (!check_rates(api, call, route))
        return false;
    if (need && need->right == ACCESS_FREE)
        return true;
    if (!need)
        return refuse_nobody(call);
    if (need->right == ACCESS_SERVE && strcmp(need->path, "/metrics") == 0 && is_of_this_machine(call))
        return true;
    if (call->identity.source == IDENTITY_NOBODY && !call->member)
        return refuse_nobody(call);
    return check_subject(api, call, need, again);
}
