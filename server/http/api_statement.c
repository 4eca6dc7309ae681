/* POST and DELETE /plans/{plan}/statement: what a person states of whom a plan is of. */
#include <stdio.h>
#include <string.h>

#include "core/base/clock.h"
#include "server/http/api_access.h"
#include "server/http/api_handlers.h"
#include "server/http/api_queries.h"
#include "server/net/statements.h"
#include "server/room/items/acceptance_body.h"
#include "server/room/state/body_check.h"

enum { MOST_NAME = 48, MOST_ID = 32 }; /* characters: a name and an ID of DICOM have up to 64 bytes */

/* ---- the body --------------------------------------------------------------------------------------------------- */

static bool is_one_line(const cJSON *json, const char *where, size_t most, struct problem *problem)
{
    if (!body_check_text(json, where, most, problem))
        return false;
    for (const char *at = json->valuestring; *at; at++)
        if ((unsigned char)*at < 32 || *at == 127)
            return problem_set(problem, PROBLEM_VALIDATION, where, "pattern",
                               "%s is one line, without control characters", where);
    return true;
}

/* YYYY-MM-DD of a day that there is, as YYYYMMDD. */
static bool read_date(const cJSON *json, char out[9], struct problem *problem)
{
    static const int days[] = { 31, 29, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31 };
    int year, month, day;
    char again[32] = "";
    const char *text = cJSON_IsString(json) ? json->valuestring : "";
    if (sscanf(text, "%4d-%2d-%2d", &year, &month, &day) == 3 && year >= 1850 && month >= 1 && month <= 12 &&
        day >= 1 && day <= days[month - 1])
        (void)snprintf(again, sizeof again, "%04d-%02d-%02d", year, month, day);
    if (!again[0] || strcmp(again, text) != 0)
        return problem_set(problem, PROBLEM_VALIDATION, "/birth_date", "pattern",
                           "/birth_date is not a day, expected YYYY-MM-DD from 1850 on, or left out");
    (void)snprintf(out, 9, "%.4s%.2s%.2s", again, again + 5, again + 8);
    return true;
}

static bool check_words(const cJSON *body, bool is_required, struct problem *problem)
{
    const cJSON *words = cJSON_GetObjectItemCaseSensitive(body, "words");
    return (!words && !is_required) || acceptance_words_check(words, "/words", problem);
}

/* The statement as it is kept; NULL with problem. */
static cJSON *read_statement(const cJSON *body, struct problem *problem)
{
    static const char *const one_names[] = { "kind", "words", NULL };
    static const char *const names[] = { "kind", "words", "name", "id", "birth_date", NULL };
    const char *kind = json_text(body, "kind"), *words = json_text(body, "words");
    const bool is_one = kind && strcmp(kind, "one-person") == 0;
    const cJSON *name = cJSON_GetObjectItemCaseSensitive(body, "name"),
                *id = cJSON_GetObjectItemCaseSensitive(body, "id"),
                *birth = cJSON_GetObjectItemCaseSensitive(body, "birth_date");
    char date[9] = "";
    if (!is_one && (!kind || strcmp(kind, "identity") != 0)) {
        problem_set(problem, PROBLEM_VALIDATION, "/kind", kind ? "enum" : "required",
                    "/kind is \"%.40s\", expected one-person or identity", kind ? kind : "");
        return NULL;
    }
    if (!body_names_are(body, is_one ? one_names : names, "", problem) || !check_words(body, is_one, problem) ||
        (!is_one && (!is_one_line(name, "/name", MOST_NAME, problem) || !is_one_line(id, "/id", MOST_ID, problem))) ||
        (birth && !read_date(birth, date, problem)))
        return NULL;
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "kind", kind);
    cJSON_AddStringToObject(json, "words", words ? words : "");
    if (!is_one) {
        cJSON_AddStringToObject(json, "name", name->valuestring);
        cJSON_AddStringToObject(json, "id", id->valuestring);
        cJSON_AddStringToObject(json, "birth_date", date);
    }
    return json;
}

/* ---- the plan --------------------------------------------------------------------------------------------------- */

static int n_patients(const struct fleet_plan *plan)
{
    const cJSON *statement = cJSON_GetObjectItemCaseSensitive(plan->document, "statement");
    const char *kind = json_text(statement, "kind"), *state = json_text(statement, "state");
    const bool is_stated = kind && state && strcmp(kind, "identity") == 0 && strcmp(state, "used") == 0;
    return cJSON_GetArraySize(cJSON_GetObjectItemCaseSensitive(plan->document, "patients")) - is_stated;
}

/* Whether this can be stated of the plan as it was read. */
static bool suits_plan(const struct fleet_plan *plan, bool is_one, struct problem *problem)
{
    if (plan->state != FLEET_READY || !plan->document)
        return problem_set(problem, PROBLEM_CONFLICT, "", "not-loaded", "the plan is not open: open it first");
    if (plan->files_changed_ms)
        return problem_set(problem, PROBLEM_CONFLICT, "", "files",
                           "the plan's files have changed on the disk since they were read: have them read anew");
    if (is_one && n_patients(plan) < 2)
        return problem_set(problem, PROBLEM_CONFLICT, "/kind", "patients",
                           "the files name no two patients that could be one person");
    if (!is_one && plan->is_phantom)
        return problem_set(problem, PROBLEM_CONFLICT, "/kind", "patients", "the plan is of a phantom");
    return is_one || n_patients(plan) == 0 ||
           problem_set(problem, PROBLEM_CONFLICT, "/kind", "patients", "the files name the patient");
}

/* The name of the caller: that of the sign-in, else that of the member. */
static const char *name_of(const struct api *api, const struct call *call)
{
    const char *room_id = call_query(call, "room");
    const char *by = call->identity.name[0] ? call->identity.name : call->identity.user;
    const struct room *room =
        room_id && api_access_sees_room(api, call, room_id) ? net_room_find(api->net, room_id) : NULL;
    struct fleet_plan of_room, of_call;
    const struct fleet *fleet = net_fleet(api->net);
    if (room && (!fleet_plan_find(fleet, room_plan_id(room), &of_room) ||
                 !fleet_plan_find(fleet, call->ids[0], &of_call) || strcmp(of_room.id, of_call.id) != 0))
        room = NULL; /* a name in a room of another plan says nothing here */
    if (!by[0] && room)
        by = room_caller_name(room, call->member);
    return by && by[0] ? by : "the person at the server";
}

/* Adds who says it, when, of which files and of whom they were when they were read: what its author had seen. */
static bool sign(struct api *api, const struct call *call, const struct fleet_plan *plan, cJSON *statement,
                 struct problem *problem)
{
    struct fleet_revision revision;
    if (!api_plan_revision_known(api, call->ids[0], &revision, problem))
        return false;
    if (!revision.is_current) {
        problem_set(problem, PROBLEM_BUSY, "", "", "the revision of the plan's files is being found out");
        problem->retry_after_ms = 300;
        return false;
    }
    cJSON_AddStringToObject(statement, "revision", revision.digest);
    cJSON_AddStringToObject(statement, "key", revision.key);
    cJSON_AddStringToObject(statement, "patients", plan->patients_seen);
    cJSON_AddStringToObject(statement, "by", name_of(api, call));
    cJSON_AddStringToObject(statement, "user", call->identity.user);
    cJSON_AddNumberToObject(statement, "time_ms", (double)clock_wall_ms());
    return true;
}

static bool is_left(const struct api *api, const struct call *call, struct problem *problem)
{
    if (!net_is_erasing(api->net, call->ids[0]))
        return true;
    problem_set(problem, PROBLEM_BUSY, "", "", "the plan is being erased");
    problem->retry_after_ms = 2000;
    return false;
}

/* It is a planner's to state, who may read whom a plan is of. */
static bool may_state(struct api *api, const struct call *call, struct problem *problem)
{
    return api_may_name(api, call, call->ids[0], problem) &&
           (api_access_to_plan(api, call, ACCESS_CLOSE, call->ids[0]) ||
            problem_set(problem, PROBLEM_FORBIDDEN, "", "role",
                        "this needs the right \"%s\", which you do not have here", access_rights[ACCESS_CLOSE].word));
}

static void put(void *context, const struct problem *problem)
{
    if (problem)
        call_answer_problem(context, problem);
    else
        call_answer_nothing(context, 204);
}

void api_plan_statement(struct api *api, struct call *call)
{
    static const char *const media_types[] = { "application/json", NULL };
    struct fleet_plan plan;
    struct problem problem = { 0 };
    cJSON *body, *statement = NULL;
    if (!api_find_plan(api, call, &plan))
        return;
    if (!may_state(api, call, &problem) || !is_left(api, call, &problem)) {
        call_answer_problem(call, &problem);
        return;
    }
    if (!call_read_object(call, media_types, &body))
        return;
    const char *kind = json_text(body, "kind");
    const bool is_one = kind && strcmp(kind, "one-person") == 0;
    if ((statement = read_statement(body, &problem)) &&
        (!suits_plan(&plan, is_one, &problem) || !sign(api, call, &plan, statement, &problem))) {
        cJSON_Delete(statement);
        statement = NULL;
    }
    cJSON_Delete(body);
    if (!statement || !net_statement_put(api->net, call->ids[0], statement, &call->identity, name_of(api, call),
                                         call->client, put, call, &problem))
        call_answer_problem(call, &problem);
}

void api_plan_statement_withdraw(struct api *api, struct call *call)
{
    struct fleet_plan plan;
    struct problem problem = { 0 };
    if (!api_find_plan(api, call, &plan))
        return;
    if (may_state(api, call, &problem)) {
        if (!net_statement_on(api->net, call->ids[0]))
            problem_set(&problem, PROBLEM_NOT_FOUND, "", "", "nobody has stated anything of whom this plan is of");
        else if (net_statement_put(api->net, call->ids[0], NULL, &call->identity, name_of(api, call), call->client, put,
                                   call, &problem))
            return;
    }
    call_answer_problem(call, &problem);
}
