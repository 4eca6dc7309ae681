/* The table of routes, and the search in it for each call. */
#include "server/http/api.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "server/http/api_access.h"
#include "server/http/api_acts.h"
#include "server/http/api_films.h"
#include "server/http/api_handlers.h"
#include "server/http/api_jobs.h"
#include "server/http/api_questions.h"
#include "server/http/api_rates.h"

static const struct {
    const char *method, *path;
    void (*handle)(struct api *api, struct call *call);
} api_routes[] = {
    { "GET", "/healthz", api_healthz },
    { "GET", "/readyz", api_readyz },
    { "GET", "/metrics", api_metrics },
    { "GET", "/api/v1/version", api_version },
    { "GET", "/api/v1/openapi.json", api_openapi },
    { "GET", "/api/v1/session", api_session },
    { "POST", "/api/v1/session", api_session_begin },
    { "DELETE", "/api/v1/session", api_session_end },
    { "POST", "/api/v1/session/confirm", api_session_confirm },
    { "POST", "/api/v1/session/input", api_session_input },
    { "POST", "/api/v1/session/first", api_session_first },
    { "GET", "/signin/proxy", api_signin_proxy },
    { "GET", "/api/v1/users", api_users },
    { "POST", "/api/v1/users", api_user_add },
    { "POST", "/api/v1/users/disable", api_user_disable },
    { "POST", "/api/v1/users/password", api_user_password },
    { "GET", "/api/v1/tokens", api_tokens },
    { "POST", "/api/v1/tokens", api_token_make },
    { "DELETE", "/api/v1/tokens/{token}", api_token_revoke },
    { "GET", "/api/v1/plans", api_plans },
    { "POST", "/api/v1/plans", api_plan_upload },
    { "POST", "/api/v1/plans/search", api_plan_search },
    { "GET", "/api/v1/plans/{plan}", api_plan },
    { "DELETE", "/api/v1/plans/{plan}", api_plan_delete },
    { "GET", "/api/v1/plans/{plan}/revision", api_plan_revision },
    { "GET", "/api/v1/plans/{plan}/identity", api_plan_identity },
    { "POST", "/api/v1/plans/{plan}/statement", api_plan_statement },
    { "DELETE", "/api/v1/plans/{plan}/statement", api_plan_statement_withdraw },
    { "POST", "/api/v1/plans/{plan}/erase", api_plan_erase },
    { "POST", "/api/v1/plans/{plan}/open", api_plan_open },
    { "POST", "/api/v1/plans/{plan}/close", api_plan_close },
    { "GET", "/api/v1/jobs/{job}", api_job },
    { "DELETE", "/api/v1/jobs/{job}", api_job_cancel },
    { "GET", "/api/v1/jobs/{job}/video", api_job_film },
    { "POST", "/api/v1/plans/{plan}/video", api_plan_film },
    { "POST", "/api/v1/plans/{plan}/render", api_plan_render },
    { "GET", "/api/v1/plans/{plan}/regions/{region}/surface", api_plan_surface },
    { "GET", "/api/v1/rooms", api_rooms },
    { "POST", "/api/v1/rooms", api_room_new },
    { "GET", "/api/v1/rooms/{room}", api_room },
    { "PATCH", "/api/v1/rooms/{room}", api_room_patch },
    { "DELETE", "/api/v1/rooms/{room}", api_room_delete },
    { "GET", "/api/v1/rooms/{room}/scene", api_room_scene },
    { "PATCH", "/api/v1/rooms/{room}/scene", api_room_scene_patch },
    { "GET", "/api/v1/rooms/{room}/members", api_room_members },
    { "DELETE", "/api/v1/rooms/{room}/members/{member}", api_room_member_remove },
    { "GET", "/api/v1/rooms/{room}/identity", api_room_identity },
    { "POST", "/api/v1/rooms/{room}/members/{member}/identity", api_room_wall_identity },
    { "GET", "/api/v1/rooms/{room}/people", api_room_people },
    { "PATCH", "/api/v1/rooms/{room}/people", api_room_people_patch },
    { "GET", "/api/v1/rooms/{room}/notes", api_room_notes },
    { "GET", "/api/v1/rooms/{room}/record", api_room_record },
    { "GET", "/api/v1/rooms/{room}/bookmarks", api_room_bookmarks },
    { "GET", "/api/v1/rooms/{room}/bookmarks/{bookmark}", api_room_bookmark },
    { "GET", "/api/v1/rooms/{room}/bookmarks/{bookmark}/picture", api_room_bookmark_picture },
    { "GET", "/api/v1/rooms/{room}/recordings", api_room_recordings },
    { "DELETE", "/api/v1/rooms/{room}/recordings/{recording}", api_room_recording_delete },
    { "GET", "/api/v1/rooms/{room}/recordings/{recording}/state", api_room_recording_state },
    { "POST", "/api/v1/rooms/{room}/recordings/{recording}/video", api_room_recording_film },
    { "GET", "/api/v1/rooms/{room}/snapshot", api_room_snapshot },
    { "POST", "/api/v1/rooms/{room}/video", api_room_film },
    { "POST", "/api/v1/rooms/{room}/exports", api_room_export },
    { "GET", "/api/v1/rooms/{room}/links", api_room_links },
    { "POST", "/api/v1/rooms/{room}/links", api_room_link_new },
    { "DELETE", "/api/v1/rooms/{room}/links/{link}", api_room_link_revoke },
    { "GET", "/api/v1/rooms/{room}/acceptances", api_room_acceptances },
    { "GET", "/api/v1/rooms/{room}/control", api_room_control },
    { "GET", "/api/v1/rooms/{room}/stream", api_room_stream },
    { "GET", "/api/v1/rooms/{room}/events", api_room_events },
    { "GET", "/api/v1/rooms/{room}/ws", api_room_ws },
    { "GET", "/api/v1/meetings", api_meetings },
    { "POST", "/api/v1/meetings", api_meeting_new },
    { "GET", "/api/v1/meetings/{meeting}", api_meeting },
    { "PATCH", "/api/v1/meetings/{meeting}", api_meeting_patch },
    { "DELETE", "/api/v1/meetings/{meeting}", api_meeting_delete },
    { "POST", "/api/v1/meetings/{meeting}/cases", api_meeting_case_new },
    { "PATCH", "/api/v1/meetings/{meeting}/cases/{case}", api_meeting_case_patch },
    { "DELETE", "/api/v1/meetings/{meeting}/cases/{case}", api_meeting_case_delete },
    { "POST", "/api/v1/meetings/{meeting}/cases/{case}/room", api_meeting_prepare },
    { "POST", "/api/v1/meetings/{meeting}/case", api_meeting_go },
    { "POST", "/api/v1/meetings/{meeting}/end", api_meeting_end },
    { "POST", "/api/v1/meetings/{meeting}/enter", api_meeting_enter },
    { "GET", "/api/v1/meetings/{meeting}/minutes", api_meeting_minutes },
    { "GET", "/api/v1/meetings/{meeting}/links", api_meeting_links },
    { "POST", "/api/v1/meetings/{meeting}/links", api_meeting_link_new },
    { "DELETE", "/api/v1/meetings/{meeting}/links/{link}", api_meeting_link_end },
    { "GET", "/api/v1/audit", api_audit },
    { "GET", "/api/v1/records", api_records },
    { "POST", "/api/v1/records/search", api_record_search },
    { "GET", "/api/v1/records/{record}", api_record },
    { "GET", "/api/v1/records/{record}/figures/{figure}", api_record_figure },
    { "GET", "/api/v1/records/{record}/paper", api_record_paper },
    { "GET", "/api/v1/records/{record}/record.pdf", api_record_paper },
    { "GET", "/p/{saved}", api_permalink },
};
static const char in_room[] = "/api/v1/rooms/{room}";
static const size_t api_n_routes = sizeof api_routes / sizeof api_routes[0];

struct api *api_create(struct net *net, struct auth *auth, uint64_t max_upload_bytes, const struct api_doors *doors)
{
    struct api *api = mem_new(sizeof *api);
    api->net = net;
    api->auth = auth;
    api->max_upload_bytes = max_upload_bytes;
    api->doors = *doors;
    api->rights = net_plan_rights(net);
    api->rates = api_rates_create();
    api->started_us = clock_now_us();
    return api;
}

void api_destroy(struct api *api)
{
    api_films_destroy(api);
    api_rates_destroy(api->rates);
    free(api);
}

void api_count(struct api *api, int status, int64_t took_us)
{
    if (status >= 100 && status < 600)
        api->n_calls[status / 100]++;
    if (took_us > 0)
        api->n_calls_us += (uint64_t)took_us;
}

/* True if the call's path matches the route; fills call->ids with the segments that stand for {...}. */
static bool path_matches(struct call *call, const char *route)
{
    size_t at = 0, n_ids = 0;
    while (*route == '/') {
        const char *part = ++route;
        size_t n = strcspn(part, "/");
        route += n;
        if (at == call->n_segments)
            return false;
        const char *segment = call->segments[at++];
        if (part[0] == '{')
            call->ids[n_ids++] = segment;
        else if (strlen(segment) != n || strncmp(segment, part, n) != 0)
            return false;
    }
    return at == call->n_segments;
}

static const char *method_word(enum call_method method)
{
    static const char *const words[] = {
        "GET", "GET", "POST", "PATCH", "DELETE", ""
    }; /* HEAD is GET without the body */
    return words[method];
}

/* Whether the caller may use this route of a room. */
static bool has_right(struct api *api, const struct call *call, const struct api_route *route, struct problem *problem)
{
    for (const struct wire_room_route *row = wire_room_routes; row->method; row++) {
        if (strcmp(row->method, route->method) != 0 || strcmp(row->path, route->path) != 0)
            continue;
        struct room *room = net_room_find(api->net, call->ids[0]);
        if (!room || room_may(room, &call->identity, call->member, row->right,
                              route->act || route->handle == api_room_member_remove, problem))
            return true; /* no room: the handler says so */
        if (problem->type == PROBLEM_NOT_FOUND)
            return false;
        cJSON *detail = cJSON_CreateObject();
        char what[96];
        (void)snprintf(what, sizeof what, "%s %s", route->method, route->path);
        cJSON_AddStringToObject(detail, "what", what);
        cJSON_AddStringToObject(detail, "why", problem->detail);
        room_audit_call(room, &call->identity, call->member, call->client, "refused", detail, true, clock_now_us());
        return false;
    }
    return true;
}

bool api_route_at(size_t index, struct api_route *route)
{
    if (index < api_n_routes) {
        *route = (struct api_route){ api_routes[index].method, api_routes[index].path, api_routes[index].handle, NULL };
        return true;
    }
    if (api_act_route(index - api_n_routes, route))
        return true;
    *route = (struct api_route){ .method = "GET", .handle = api_question };
    return api_question_route(index - api_n_routes - api_n_acts, &route->path);
}

/* Handles the call once more: the room that it needs is awake. */
static void room_awoke(void *context, const char *room_id, const struct problem *problem)
{
    (void)room_id;
    struct call *call = context;
    if (problem)
        call_answer_problem(call, problem);
    else
        api_handle(call->api, call);
}

/* True: the call needs a room that sleeps, and waits for it. */
static bool wakes_room(struct api *api, struct call *call, const struct api_route *route)
{
    const char *room = call_query(call, "room");
    if (room && !api_access_sees_room(api, call, room))
        room = NULL;
    /* whose right has to be looked at has it looked at in the room */
    const bool may_be_deleted_asleep = call->method == CALL_DELETE && call->identity.source == IDENTITY_MACHINE;
    bool is_for_awake = (may_be_deleted_asleep && !route->act && route->handle != api_room_link_revoke &&
                         route->handle != api_room_member_remove) ||
                        route->handle == api_room_ws || route->handle == api_room_stream ||
                        route->handle == api_room_events;
    if (strncmp(route->path, in_room, strlen(in_room)) == 0)
        room = is_for_awake ? NULL : call->ids[0];
    if (!room || !net_room_is_asleep(api->net, room))
        return false;
    net_room_wake(api->net, room, room_awoke, call);
    return true;
}

/* True: the call is about a plan that is not known, and waits until the folders are looked at. */
static bool looks_for_plan(struct api *api, struct call *call, const struct api_route *route)
{
    static const char of_plan[] = "/api/v1/plans/{plan}";
    struct fleet_plan plan;
    return strncmp(route->path, of_plan, strlen(of_plan)) == 0 &&
           !fleet_plan_find(net_fleet(api->net), call->ids[0], &plan) && api_lists_first(api, call, api_handle);
}

/* True: it is about a plan by an id that it does not have now, which rooms on the disk alone may have. Erasing goes by
 * either. */
static bool is_of_other_id(struct api *api, const struct call *call, const struct api_route *route)
{
    struct fleet_plan plan;
    return route->handle != api_plan_erase && strncmp(call->route, "/api/v1/plans/{plan}", 20) == 0 &&
           fleet_plan_find(net_fleet(api->net), call->ids[0], &plan) && strcmp(plan.id, call->ids[0]) != 0;
}

/* False with problem: the call is about a room or a bookmark that may be on the disk, which cannot be read yet. */
static bool room_can_be_looked_for(struct api *api, const struct call *call, const struct api_route *route,
                                   struct problem *problem)
{
    const bool is_of_room = strncmp(route->path, in_room, strlen(in_room)) == 0;
    if (is_of_room ? net_room_find(api->net, call->ids[0]) != NULL : route->handle != api_permalink)
        return true;
    return net_rooms_are_known(api->net, problem);
}

/* Looks after what goes on without a call. */
static void look(void *context)
{
    api_streams_look(context);
    api_films_go_on(context);
}

void api_handle(struct api *api, struct call *call)
{
    struct problem problem;
    char allowed[64] = "";
    bool is_known = false;
    net_on_identities(api->net, look, api); /* on this thread: api_create is not */
    call->api = api;
    api_jobs_update(api);
    if (call->early.type != PROBLEM_NONE) {
        call_answer_problem(call, &call->early);
        return;
    }
    if (!call_origin_is_own(call, &problem)) {
        call_answer_problem(call, &problem);
        return;
    }
    struct api_route route;
    for (size_t i = 0; api_route_at(i, &route); i++) {
        if (!path_matches(call, route.path))
            continue;
        if (strcmp(route.method, method_word(call->method)) == 0) {
            call->route = route.path;
            call->act = route.act;
            if (!api_access_allows(api, call, &route, api_handle))
                return;
            for (size_t k = 0; k < CALL_MAX_SEGMENTS && call->ids[k]; k++)
                if (!id_is_valid(call->ids[k])) {
                    problem_set(&problem, PROBLEM_NOT_FOUND, "", "", "\"%.60s\" is not an id", call->ids[k]);
                    call_answer_problem(call, &problem);
                    return;
                }
            if (wakes_room(api, call, &route) || looks_for_plan(api, call, &route))
                return;
            if ((is_of_other_id(api, call, &route) && !fleet_no_plan(net_fleet(api->net), call->ids[0], &problem)) ||
                !room_can_be_looked_for(api, call, &route, &problem) || !has_right(api, call, &route, &problem)) {
                call_answer_problem(call, &problem);
                return;
            }
            net_set_caller(api->net, &call->identity);
            route.handle(api, call);
            net_set_caller(api->net, NULL);
            return;
        }
        is_known = true;
        size_t used = strlen(allowed);
        (void)snprintf(allowed + used, sizeof allowed - used, "%s%s", used ? ", " : "", route.method);
    }
    if (is_known) {
        call_add_header(call, "Allow", allowed);
        problem_set(&problem, PROBLEM_METHOD, "", "", "this address takes %s", allowed);
    } else {
        problem_set(&problem, PROBLEM_NOT_FOUND, "", "", "nothing is at %.200s", call->path);
    }
    call_answer_problem(call, &problem);
}
