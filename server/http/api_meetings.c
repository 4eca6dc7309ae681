/* Meetings of many cases: their list, making, changing, ending and deleting one, going on to a case. */
#include "server/http/api_meetings.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "server/http/api_access.h"
#include "server/http/api_handlers.h"

static const char *const json_types[] = { "application/json", NULL };
static const char *const patch_types[] = { "application/merge-patch+json", "application/json", NULL };

/* ---- who -------------------------------------------------------------------------------------------------------- */

const struct meeting *api_find_meeting(struct api *api, struct call *call)
{
    struct problem problem;
    const struct meeting *meeting = net_meeting_find(api->net, call->ids[0]);
    if (meeting)
        return meeting;
    if (net_rooms_are_known(api->net, &problem))
        problem_set(&problem, PROBLEM_NOT_FOUND, "", "", "there is no meeting \"%.63s\"", call->ids[0]);
    call_answer_problem(call, &problem);
    return NULL;
}

static bool may_edit(const struct api *api, const struct call *call, const struct meeting *meeting)
{
    enum wire_member_role role;
    return net_meeting_role(api->net, meeting, &call->identity, &role) && role >= WIRE_MEMBER_ROLE_PRESENTER &&
           !meeting->ended_ms;
}

static bool may_advance(const struct api *api, const struct call *call, const struct meeting *meeting)
{
    enum wire_member_role role;
    return api_meeting_role(api, call, meeting, &role) && role >= WIRE_MEMBER_ROLE_PRESENTER &&
           role != WIRE_MEMBER_ROLE_WALL && !meeting->ended_ms;
}

/* ---- documents -------------------------------------------------------------------------------------------------- */

static void add_time(cJSON *json, const char *name, int64_t ms)
{
    json_add(json, name, ms ? cJSON_CreateNumber((double)ms) : cJSON_CreateNull());
}

static void add_text(cJSON *json, const char *name, const char *text)
{
    json_add(json, name, text[0] ? cJSON_CreateString(text) : cJSON_CreateNull());
}

/* People in the room of the case of now. */
static size_t n_in(const struct api *api, const struct meeting *meeting)
{
    const struct meeting_case *now = meeting_find(meeting, meeting->now);
    const struct room *room = now ? net_room_find(api->net, now->room) : NULL;
    struct room_present present;
    size_t n = 0;
    for (size_t i = 0; room && room_present_at(room, i, &present); i++)
        n += present.connection && present.role != WIRE_MEMBER_ROLE_WALL;
    return n;
}

static cJSON *head(const struct api *api, const struct meeting *meeting)
{
    const struct meeting_case *now = meeting_find(meeting, meeting->now);
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "id", meeting->id);
    cJSON_AddStringToObject(json, "name", meeting->name);
    add_time(json, "starts_ms", meeting->starts_ms);
    add_time(json, "ended_ms", meeting->ended_ms);
    cJSON_AddStringToObject(json, "state", meeting_state_word(meeting_state(meeting)));
    cJSON_AddNumberToObject(json, "n_cases", (double)meeting->n_cases);
    json_add(json, "case", now ? cJSON_CreateNumber((double)meeting_place(meeting, now) + 1) : cJSON_CreateNull());
    cJSON_AddNumberToObject(json, "n_in", (double)n_in(api, meeting));
    return json;
}

/* The worst reason why the first dose of the plan does not fit its image; NULL: it fits, or the plan is not loaded. */
static const char *reason_of_dose(const struct api *api, const char *plan_id)
{
    struct fleet_plan plan;
    const cJSON *dose;
    if (!fleet_plan_find(net_fleet(api->net), plan_id, &plan))
        return NULL;
    cJSON_ArrayForEach(dose, cJSON_GetObjectItemCaseSensitive(plan.document, "doses"))
    {
        const char *fit = json_text(dose, "fit");
        if (fit && strcmp(fit, "same") != 0 && strcmp(fit, "registered") != 0 && strcmp(fit, "unstated") != 0)
            return fit;
    }
    return NULL;
}

static const char *state_of(const struct meeting *meeting, const struct meeting_case *one, bool is_open)
{
    if (!is_open)
        return "closed";
    if (strcmp(meeting->now, one->id) == 0)
        return "now";
    if (one->decision[0])
        return "decided";
    return meeting_was_entered(meeting, one) ? "left" : "open";
}

static cJSON *describe_case(const struct api *api, const struct call *call, const struct meeting *meeting,
                            const struct meeting_case *one)
{
    const bool is_open = net_meeting_case_is_open(api->net, one, &call->identity, call->member);
    const bool has_room =
        is_open && one->room[0] && (net_room_find(api->net, one->room) || net_room_is_asleep(api->net, one->room));
    const char *reason = is_open ? reason_of_dose(api, one->plan) : NULL;
    struct fleet_plan scanned; /* of a plan that was not loaded since it is a case, the scan of its folder tells */
    const bool is_scanned =
        is_open && !one->patient[0] && fleet_plan_find(net_fleet(api->net), one->plan, &scanned) && scanned.patient[0];
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "id", one->id);
    add_text(json, "plan", is_open ? one->plan : "");
    add_text(json, "label", !is_open ? "" : is_scanned && scanned.label[0] ? scanned.label : one->label);
    add_text(json, "patient", !is_open ? "" : is_scanned ? scanned.patient : one->patient);
    add_text(json, "approval", !is_open ? "" : is_scanned ? scanned.approval : one->approval);
    add_text(json, "room", has_room ? one->room : "");
    cJSON_AddStringToObject(json, "state", state_of(meeting, one, is_open));
    add_time(json, "since_ms", strcmp(meeting->now, one->id) == 0 ? meeting->since_ms : 0);
    cJSON_AddNumberToObject(json, "spent_ms", (double)meeting_spent_ms(meeting, one, clock_wall_ms()));
    add_time(json, "decided_ms", is_open ? one->decided_ms : 0);
    add_text(json, "decision", is_open ? one->decision : "");
    add_text(json, "does_not_fit", reason ? reason : "");
    return json;
}

cJSON *api_meeting_document(struct api *api, const struct call *call, const struct meeting *meeting)
{
    cJSON *json = head(api, meeting), *may = cJSON_CreateObject(), *cases = cJSON_CreateArray();
    cJSON_AddStringToObject(json, "owner", meeting->owner);
    cJSON_AddBoolToObject(may, "edit", may_edit(api, call, meeting));
    cJSON_AddBoolToObject(may, "advance", may_advance(api, call, meeting));
    json_add(json, "may", may);
    for (size_t i = 0; i < meeting->n_cases; i++)
        json_append(cases, describe_case(api, call, meeting, meeting->cases[i]));
    json_add(json, "cases", cases);
    if (may_edit(api, call, meeting))
        json_add(json, "people", meeting_people(meeting));
    return json;
}

void api_meetings(struct api *api, struct call *call)
{
    struct problem problem;
    if (!net_rooms_are_known(api->net, &problem)) {
        call_answer_problem(call, &problem);
        return;
    }
    cJSON *answer = cJSON_CreateObject(), *list = cJSON_AddArrayToObject(answer, "meetings");
    enum wire_member_role role;
    for (size_t i = 0; i < net_n_meetings(api->net); i++) {
        const struct meeting *meeting = net_meeting_at(api->net, i);
        if (meeting && net_meeting_role(api->net, meeting, &call->identity, &role))
            json_append(list, head(api, meeting));
    }
    call_answer_json(call, 200, answer);
}

void api_meeting(struct api *api, struct call *call)
{
    const struct meeting *meeting = api_find_meeting(api, call);
    if (meeting)
        call_answer_json(call, 200, api_meeting_document(api, call, meeting));
}

/* ---- changes ---------------------------------------------------------------------------------------------------- */

void api_meeting_changed(void *context, const struct meeting *meeting, const struct problem *problem)
{
    struct call *call = context;
    struct api *api = call->api;
    const bool is_new = call->method == CALL_POST && strcmp(call->route, "/api/v1/meetings") == 0;
    if (problem) {
        call_answer_problem(call, problem);
    } else if (!meeting) {
        call_answer_nothing(call, 204);
    } else {
        char location[96];
        (void)snprintf(location, sizeof location, "/api/v1/meetings/%s", meeting->id);
        if (is_new)
            call_add_header(call, "Location", location);
        meeting = net_meeting_find(api->net, meeting->id);
        net_meeting_tell(api->net, meeting); /* its people see the agenda change */
        call_answer_json(call, is_new ? 201 : 200, api_meeting_document(api, call, meeting));
    }
}

void api_meeting_commit(struct api *api, struct call *call, struct meeting *changed, const char *what,
                        const char *case_id)
{
    struct problem problem;
    char id[MEETING_ID];
    (void)snprintf(id, sizeof id, "%s", case_id); /* may be the copy's own */
    const struct net_meeting_act act = { .who = &call->identity, .address = call->client, .what = what, .case_id = id };
    if (!net_meeting_commit(api->net, changed, &act, api_meeting_changed, call, &problem))
        call_answer_problem(call, &problem);
}

struct meeting *api_meeting_copy(struct api *api, struct call *call)
{
    struct problem problem = { 0 };
    const struct meeting *meeting = api_find_meeting(api, call);
    struct meeting *copy = meeting ? meeting_copy(meeting) : NULL;
    if (meeting && !copy) {
        (void)json_no_memory(&problem, "the meeting");
        call_answer_problem(call, &problem);
    }
    return copy;
}

static bool read_starts(struct meeting *meeting, const cJSON *json, struct problem *problem)
{
    if (!json || cJSON_IsNull(json)) {
        meeting->starts_ms = 0;
        return true;
    }
    if (!cJSON_IsNumber(json) || !(json->valuedouble >= 0 && json->valuedouble < 9e15))
        return problem_set(problem, PROBLEM_VALIDATION, "/starts_ms", "range",
                           "starts_ms must be milliseconds since 1970, or null");
    meeting->starts_ms = (int64_t)json->valuedouble;
    return true;
}

static bool only_has(const cJSON *body, const char *const *names, struct problem *problem)
{
    const cJSON *item;
    cJSON_ArrayForEach(item, body)
    {
        char pointer[64];
        bool is_known = false;
        for (size_t i = 0; names[i]; i++)
            is_known = is_known || strcmp(item->string, names[i]) == 0;
        (void)snprintf(pointer, sizeof pointer, "/%.60s", item->string);
        if (!is_known)
            return problem_set(problem, PROBLEM_VALIDATION, pointer, "unknown-field", "%.60s is not a field of it",
                               item->string);
    }
    return true;
}

/* Reads what stands in the body; all of it is checked before the copy is written. */
static bool read_facts(struct meeting *copy, const cJSON *body, struct problem *problem)
{
    const cJSON *name = cJSON_GetObjectItemCaseSensitive(body, "name"),
                *starts = cJSON_GetObjectItemCaseSensitive(body, "starts_ms"),
                *people = cJSON_GetObjectItemCaseSensitive(body, "people");
    return (!name || meeting_set_name(copy, name, problem)) && (!starts || read_starts(copy, starts, problem)) &&
           (!people || meeting_set_people(copy, people, problem));
}

/* Whether the caller may put this plan on an agenda, with their role on it. False with problem. */
static bool may_add(const struct api *api, const struct call *call, const char *plan, enum wire_member_role *cap,
                    struct problem *problem)
{
    *cap = WIRE_MEMBER_ROLE_PLANNER;
    if (!plan || !id_is_valid(plan))
        return problem_set(problem, PROBLEM_VALIDATION, "/plan", "pattern", "\"plan\" must be the id of a plan");
    if (call->identity.source != IDENTITY_MACHINE)
        return api_access_makes_room(api, call, plan, problem) &&
               plan_rights_role(api->rights, net_fleet(api->net), &call->identity, plan, cap);
    struct fleet_plan found;
    return fleet_plan_find(net_fleet(api->net), plan, &found) || fleet_no_plan(net_fleet(api->net), plan, problem);
}

/* A room that is given is one of the plan that the caller sees. */
static bool room_is_right(struct api *api, const struct call *call, const char *room, const char *plan,
                          struct problem *problem)
{
    const struct room *found = room[0] ? net_room_find(api->net, room) : NULL;
    if (!room[0] || (found && api_access_sees_room(api, call, room) && strcmp(room_plan_id(found), plan) == 0))
        return true;
    return problem_set(problem, PROBLEM_NOT_FOUND, "/room", "", "there is no room \"%.63s\" on this plan", room);
}

static bool add_case(struct api *api, const struct call *call, struct meeting *copy, const cJSON *json,
                     const char **added, struct problem *problem)
{
    static const char *const names[] = { "plan", "room", "before", NULL };
    enum wire_member_role cap;
    struct fleet_plan found;
    const char *plan = json_text(json, "plan"), *room = json_text(json, "room");
    if (!cJSON_IsObject(json))
        return problem_set(problem, PROBLEM_VALIDATION, "/cases", "type", "a case must be an object with a plan");
    if (!only_has(json, names, problem) || !may_add(api, call, plan, &cap, problem) ||
        !room_is_right(api, call, room ? room : "", plan, problem))
        return false;
    if (fleet_plan_find(net_fleet(api->net), plan, &found))
        plan = found.id;
    struct meeting_case *one = meeting_add(copy, plan, room ? room : "", json_text(json, "before"), problem);
    if (!one)
        return false;
    one->cap = cap;
    *added = one->id;
    return true;
}

struct waiting { /* for a room that is being woken */
    struct call *call;
    void (*handle)(struct api *api, struct call *call);
};

static void has_woken(void *context, const char *room_id, const struct problem *problem)
{
    const struct waiting waiting = *(struct waiting *)context;
    (void)room_id;
    free(context);
    if (problem && problem->type != PROBLEM_NOT_FOUND)
        call_answer_problem(waiting.call, problem);
    else
        waiting.handle(waiting.call->api, waiting.call);
}

/* A room that sleeps and stands in the body is woken first. True: the call waits for it. */
static bool waits_for_room(struct api *api, struct call *call, const cJSON *json,
                           void (*handle)(struct api *api, struct call *call))
{
    const char *room = json_text(json, "room");
    if (!room || !id_is_valid(room) || !net_room_is_asleep(api->net, room) || !api_access_sees_room(api, call, room))
        return false;
    struct waiting *waiting = mem_new(sizeof *waiting);
    *waiting = (struct waiting){ call, handle };
    net_room_wake(api->net, room, has_woken, waiting);
    return true;
}

static bool makes_meetings(const struct api *api, const struct call *call, struct problem *problem)
{
    struct fleet_plan plan;
    if (call->identity.source == IDENTITY_MACHINE)
        return true;
    for (size_t i = 0; i < fleet_n_plans(net_fleet(api->net)); i++)
        if (fleet_plan_at(net_fleet(api->net), i, &plan) && api_access_to_found_plan(api, call, ACCESS_CONTROL, &plan))
            return true;
    return problem_set(problem, PROBLEM_FORBIDDEN, "", "role",
                       "a meeting is made by who has the role presenter or planner on a plan");
}

void api_meeting_new(struct api *api, struct call *call)
{
    static const char *const names[] = { "name", "starts_ms", "people", "cases", NULL };
    struct problem problem = { 0 };
    const cJSON *one;
    const char *added;
    cJSON *body;
    if (!call_read_object(call, json_types, &body))
        return;
    const cJSON *cases = cJSON_GetObjectItemCaseSensitive(body, "cases");
    cJSON_ArrayForEach(one, cases)
    {
        if (waits_for_room(api, call, one, api_meeting_new)) {
            cJSON_Delete(body);
            return;
        }
    }
    bool ok = only_has(body, names, &problem);
    if (ok && !cJSON_GetObjectItemCaseSensitive(body, "name"))
        ok =
            problem_set(&problem, PROBLEM_VALIDATION, "/name", "required", "what is the meeting called? give \"name\"");
    ok = ok && net_rooms_are_known(api->net, &problem) && makes_meetings(api, call, &problem);
    struct meeting *meeting = ok ? net_meeting_new(api->net, call->identity.user, &problem) : NULL;
    ok = meeting && read_facts(meeting, body, &problem);
    if (ok && cases && !cJSON_IsArray(cases))
        ok = problem_set(&problem, PROBLEM_VALIDATION, "/cases", "type", "cases must be a list");
    cJSON_ArrayForEach(one, cases) ok = ok && add_case(api, call, meeting, one, &added, &problem);
    cJSON_Delete(body);
    if (ok) {
        api_meeting_commit(api, call, meeting, "made", "");
        return;
    }
    meeting_free(meeting);
    call_answer_problem(call, &problem);
}

void api_meeting_patch(struct api *api, struct call *call)
{
    static const char *const names[] = { "name", "starts_ms", "people", NULL };
    struct problem problem = { 0 };
    cJSON *body;
    if (!call_read_object(call, patch_types, &body))
        return;
    struct meeting *copy = api_meeting_copy(api, call);
    if (!copy) {
        cJSON_Delete(body);
        return;
    }
    const bool ok = only_has(body, names, &problem) && read_facts(copy, body, &problem);
    cJSON_Delete(body);
    if (ok) {
        api_meeting_commit(api, call, copy, "changed", "");
        return;
    }
    meeting_free(copy);
    call_answer_problem(call, &problem);
}

void api_meeting_delete(struct api *api, struct call *call)
{
    struct problem problem = { 0 };
    struct meeting *copy = api_meeting_copy(api, call);
    if (!copy)
        return;
    const struct net_meeting_act act = {
        .who = &call->identity, .address = call->client, .what = "deleted", .case_id = "", .deletes = true
    };
    if (meeting_state(copy) == MEETING_RUNNING) {
        problem_set(&problem, PROBLEM_CONFLICT, "", "running", "the meeting runs: end it first");
        meeting_free(copy);
        call_answer_problem(call, &problem);
    } else if (!net_meeting_commit(api->net, copy, &act, api_meeting_changed, call, &problem)) {
        call_answer_problem(call, &problem);
    }
}

void api_meeting_end(struct api *api, struct call *call)
{
    struct meeting *copy = api_meeting_copy(api, call);
    if (!copy)
        return;
    meeting_end(copy, clock_wall_ms());
    api_meeting_commit(api, call, copy, "ended", "");
}

/* ---- cases ------------------------------------------------------------------------------------------------------ */

void api_meeting_case_new(struct api *api, struct call *call)
{
    struct problem problem = { 0 };
    const char *added = "";
    cJSON *body;
    if (!call_read_object(call, json_types, &body))
        return;
    if (waits_for_room(api, call, body, api_meeting_case_new)) {
        cJSON_Delete(body);
        return;
    }
    struct meeting *copy = api_meeting_copy(api, call);
    if (!copy) {
        cJSON_Delete(body);
        return;
    }
    const bool ok = add_case(api, call, copy, body, &added, &problem);
    cJSON_Delete(body);
    if (ok) {
        api_meeting_commit(api, call, copy, "case-added", added);
        return;
    }
    meeting_free(copy);
    call_answer_problem(call, &problem);
}

void api_meeting_case_patch(struct api *api, struct call *call)
{
    static const char *const names[] = { "before", NULL };
    struct problem problem = { 0 };
    cJSON *body;
    if (!call_read_object(call, patch_types, &body))
        return;
    struct meeting *copy = api_meeting_copy(api, call);
    const bool ok = copy && only_has(body, names, &problem) &&
                    meeting_order(copy, call->ids[1], json_text(body, "before"), &problem);
    cJSON_Delete(body);
    if (ok) {
        api_meeting_commit(api, call, copy, "case-moved", call->ids[1]);
    } else if (copy) {
        meeting_free(copy);
        call_answer_problem(call, &problem);
    }
}

void api_meeting_case_delete(struct api *api, struct call *call)
{
    struct problem problem = { 0 };
    struct meeting *copy = api_meeting_copy(api, call);
    if (!copy)
        return;
    if (meeting_remove(copy, call->ids[1], &problem)) {
        api_meeting_commit(api, call, copy, "case-removed", call->ids[1]);
        return;
    }
    meeting_free(copy);
    call_answer_problem(call, &problem);
}

static void go(struct api *api, struct call *call, const char *to, const char *from, bool only_prepares)
{
    struct problem problem = { 0 };
    const char *name = "";
    for (size_t i = 0; call->member && i < net_n_rooms(api->net) && !name[0]; i++)
        if (api_access_sees_room(api, call, room_id(net_room_at(api->net, i))))
            name = room_caller_name(net_room_at(api->net, i), call->member);
    const struct net_meeting_go wanted = { .meeting = call->ids[0],
                                           .to = to,
                                           .from = from,
                                           .who = &call->identity,
                                           .address = call->client,
                                           .name = name,
                                           .room = "",
                                           .member = "",
                                           .only_prepares = only_prepares };
    if (!net_meeting_go(api->net, &wanted, api_meeting_changed, call, &problem))
        call_answer_problem(call, &problem);
}

void api_meeting_go(struct api *api, struct call *call)
{
    static const char *const names[] = { "case", "from", NULL };
    struct problem problem = { 0 };
    cJSON *body;
    if (!call_read_object(call, json_types, &body))
        return;
    const cJSON *from = cJSON_GetObjectItemCaseSensitive(body, "from");
    const char *to = json_text(body, "case");
    bool ok = only_has(body, names, &problem);
    if (ok && (!to || (!id_is_valid(to))))
        ok = problem_set(&problem, PROBLEM_VALIDATION, "/case", "required", "which case? give its id, or \"next\"");
    if (ok && (!from || (!cJSON_IsNull(from) && !cJSON_IsString(from))))
        ok = problem_set(&problem, PROBLEM_VALIDATION, "/from", "required",
                         "give in \"from\" the case that you believe is now, or null");
    if (ok)
        go(api, call, to, cJSON_GetStringValue(from), false);
    else
        call_answer_problem(call, &problem);
    cJSON_Delete(body);
}

void api_meeting_prepare(struct api *api, struct call *call)
{
    go(api, call, call->ids[1], "", true);
}
