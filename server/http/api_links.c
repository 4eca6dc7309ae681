/* Makes, lists and revokes links to a room. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/base/clock.h"
#include "server/http/api_handlers.h"
#include "server/http/api_queries.h"
#include "server/room/state/body_check.h"

enum { MAX_NAME = 40 };

static bool read_role(const cJSON *json, enum wire_member_role *role, struct problem *problem)
{
    for (size_t i = 0; cJSON_IsString(json) && i < wire_member_role_words.n; i++)
        if (strcmp(json->valuestring, wire_member_role_words.words[i]) == 0) {
            *role = (enum wire_member_role)i;
            return true;
        }
    if (!json)
        return problem_set(problem, PROBLEM_VALIDATION, "/role", "required", "which role? \"role\" is missing");
    return problem_set(problem, PROBLEM_VALIDATION, "/role", "enum",
                       "role must be observer, reviewer, presenter, planner or wall");
}

static bool read_expires(const cJSON *json, enum wire_member_role role, int64_t *expires_s, struct problem *problem)
{
    const int most_s = role == WIRE_MEMBER_ROLE_WALL ? ROOM_LINK_WALL_MAX_S : ROOM_LINK_MAX_S;
    if (!cJSON_IsNumber(json))
        return problem_set(problem, PROBLEM_VALIDATION, "/expires_s", "type", "expires_s must be a number");
    if (!(json->valuedouble >= ROOM_LINK_MIN_S && json->valuedouble <= most_s) ||
        floor(json->valuedouble) != json->valuedouble)
        return problem_set(problem, PROBLEM_VALIDATION, "/expires_s", "range",
                           "expires_s must be a whole number, %d to %d", ROOM_LINK_MIN_S, most_s);
    *expires_s = (int64_t)json->valuedouble;
    return true;
}

/* The name is borrowed from the body. */
static bool read_wanted(const cJSON *body, struct room_link *wanted, struct problem *problem)
{
    char pointer[64];
    *wanted = (struct room_link){ .expires_s = 24 * 3600, .maker = "", .name = "" };
    if (!read_role(cJSON_GetObjectItemCaseSensitive(body, "role"), &wanted->role, problem))
        return false;
    for (const cJSON *item = body->child; item; item = item->next) {
        if (strcmp(item->string, "expires_s") == 0) {
            if (!read_expires(item, wanted->role, &wanted->expires_s, problem))
                return false;
        } else if (strcmp(item->string, "one_use") == 0) {
            if (!cJSON_IsBool(item))
                return problem_set(problem, PROBLEM_VALIDATION, "/one_use", "type", "one_use must be true or false");
            wanted->is_one_use = cJSON_IsTrue(item);
        } else if (strcmp(item->string, "guests") == 0) {
            if (!cJSON_IsBool(item))
                return problem_set(problem, PROBLEM_VALIDATION, "/guests", "type", "guests must be true or false");
            wanted->allows_guests = cJSON_IsTrue(item);
        } else if (strcmp(item->string, "name") == 0) {
            if (!body_check_text(item, "/name", MAX_NAME, problem))
                return false;
            wanted->name = item->valuestring;
        } else if (strcmp(item->string, "role") != 0) {
            (void)snprintf(pointer, sizeof pointer, "/%.60s", item->string);
            return problem_set(problem, PROBLEM_VALIDATION, pointer, "unknown-field", "%.60s is not a field of a link",
                               item->string);
        }
    }
    return true;
}

void api_room_links(struct api *api, struct call *call)
{
    struct room *room = api_find_room(api, call);
    if (!room)
        return;
    cJSON *answer = cJSON_CreateObject();
    json_add(answer, "links", room_links(room, clock_now_us()));
    call_answer_json(call, 200, answer);
}

void api_room_link_revoke(struct api *api, struct call *call)
{
    struct problem problem;
    struct room *room = api_find_room(api, call);
    if (!room)
        return;
    if (!net_can_write(api->net, &problem)) {
        call_answer_problem(call, &problem);
        return;
    }
    const char *members = call_query(call, "members");
    if (members && strcmp(members, "remove") != 0 && strcmp(members, "keep") != 0) {
        problem_set(&problem, PROBLEM_VALIDATION, "/members", "enum", "members is \"%.20s\", expected keep or remove",
                    members);
        call_answer_problem(call, &problem);
        return;
    }
    const bool is_all = members && strcmp(members, "remove") == 0;
    if ((is_all ? room_link_revoke_all : room_link_revoke)(room, call->ids[1], call->member, call->client,
                                                           clock_now_us())) {
        call_answer_nothing(call, 204);
        return;
    }
    problem_set(&problem, PROBLEM_NOT_FOUND, "", "", "the room has no link \"%.63s\"", call->ids[1]);
    call_answer_problem(call, &problem);
}

/* A link gives at most the role of who makes it. */
static bool role_may_be_given(const struct room *room, const struct call *call, enum wire_member_role role,
                              struct problem *problem)
{
    const struct room_caller caller = room_caller_of(room, &call->identity, call->member);
    return room_caller_gives(&caller, role) ||
           problem_set(problem, PROBLEM_FORBIDDEN, "/role", "role", "a %s gives no role above it, and %s is",
                       wire_member_role_words.words[caller.role], wire_member_role_words.words[role]);
}

void api_room_link_new(struct api *api, struct call *call)
{
    static const char *const media_types[] = { "application/json", NULL };
    struct problem problem = { 0 };
    struct room_link wanted;
    cJSON *body;
    char token[33], digits[9], url[160];
    struct room *room = api_find_room(api, call);
    if (!room)
        return;
    if (!call_read_object(call, media_types, &body))
        return;
    bool ok = read_wanted(body, &wanted, &problem) && role_may_be_given(room, call, wanted.role, &problem) &&
              net_can_write(api->net, &problem);
    wanted.maker = call->identity.user;
    ok = ok && room_link_make(room, &wanted, clock_now_us(), token, &problem);
    if (!ok) {
        cJSON_Delete(body);
        call_answer_problem(call, &problem);
        return;
    }
    (void)snprintf(url, sizeof url, "/rooms/%s#link=%s", room_id(room), token);
    cJSON *answer = cJSON_CreateObject();
    room_link_digits(token, digits);
    cJSON_AddStringToObject(answer, "id", digits);
    cJSON_AddStringToObject(answer, "token", token);
    cJSON_AddStringToObject(answer, "url", url);
    cJSON_AddStringToObject(answer, "role", wire_member_role_words.words[wanted.role]);
    cJSON_AddNumberToObject(answer, "expires_s", (double)wanted.expires_s);
    cJSON_AddBoolToObject(answer, "one_use", wanted.is_one_use);
    cJSON_AddBoolToObject(answer, "guests", wanted.allows_guests);
    cJSON_AddStringToObject(answer, "name", wanted.name);
    cJSON *made = cJSON_CreateObject();
    cJSON_AddStringToObject(made, "link", digits);
    cJSON_AddStringToObject(made, "role", wire_member_role_words.words[wanted.role]);
    cJSON_AddNumberToObject(made, "expires_s", (double)wanted.expires_s);
    cJSON_AddBoolToObject(made, "one_use", wanted.is_one_use);
    if (wanted.allows_guests)
        cJSON_AddTrueToObject(made, "guests");
    cJSON_Delete(body);
    room_audit_call(room, &call->identity, call->member, call->client, "link-made", made, false, clock_now_us());
    call_answer_json(call, 201, answer);
}
