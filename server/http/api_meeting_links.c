/* Links of a meeting: making, listing and ending them; where one leads to. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "server/http/api_handlers.h"
#include "server/http/api_meetings.h"
#include "server/room/state/body_check.h"

enum { MAX_LINK_NAME = 40 };

static const char *const media_types[] = { "application/json", NULL };

/* People who are in a room of the meeting by this link. */
static size_t n_came(const struct api *api, const struct meeting *meeting, const char *digits)
{
    size_t n = 0;
    for (size_t i = 0; i < meeting->n_cases; i++) {
        const struct room *room = net_room_find(api->net, meeting->cases[i]->room);
        struct room_present present;
        for (size_t k = 0; room && room_present_at(room, k, &present); k++)
            n += present.connection && strcmp(present.link, digits) == 0;
    }
    return n;
}

static cJSON *describe(const struct api *api, const struct meeting *meeting, const struct meeting_link *link)
{
    char digits[9];
    const int64_t left_ms = link->expires_ms - clock_wall_ms();
    cJSON *json = cJSON_CreateObject();
    meeting_link_digits(link, digits);
    cJSON_AddStringToObject(json, "id", digits);
    cJSON_AddStringToObject(json, "role", wire_member_role_words.words[link->role]);
    cJSON_AddNumberToObject(json, "expires_s", (double)(left_ms > 0 ? (left_ms + 999) / 1000 : 0));
    cJSON_AddBoolToObject(json, "guests", link->allows_guests);
    cJSON_AddStringToObject(json, "name", link->name);
    cJSON_AddStringToObject(json, "by", link->maker);
    cJSON_AddNumberToObject(json, "came", (double)n_came(api, meeting, digits));
    return json;
}

void api_meeting_links(struct api *api, struct call *call)
{
    const struct meeting *meeting = api_find_meeting(api, call);
    if (!meeting)
        return;
    cJSON *answer = cJSON_CreateObject(), *list = cJSON_AddArrayToObject(answer, "links");
    for (size_t i = 0; i < meeting->n_links; i++)
        if (!meeting->links[i].is_ended && meeting->links[i].expires_ms > clock_wall_ms())
            json_append(list, describe(api, meeting, &meeting->links[i]));
    call_answer_json(call, 200, answer);
}

/* ---- making one ------------------------------------------------------------------------------------------------- */

static bool read_role(const cJSON *json, enum wire_member_role *role, struct problem *problem)
{
    for (size_t i = 0; cJSON_IsString(json) && i < wire_member_role_words.n; i++)
        if (strcmp(json->valuestring, wire_member_role_words.words[i]) == 0) {
            *role = (enum wire_member_role)i;
            return true;
        }
    return problem_set(problem, PROBLEM_VALIDATION, "/role", json ? "enum" : "required",
                       "role must be observer, reviewer, presenter, planner or wall");
}

static bool read_wanted(const cJSON *body, struct meeting_link *wanted, struct problem *problem)
{
    static const char *const names[] = { "role", "expires_s", "guests", "name", NULL };
    const cJSON *expires = cJSON_GetObjectItemCaseSensitive(body, "expires_s"),
                *guests = cJSON_GetObjectItemCaseSensitive(body, "guests"),
                *name = cJSON_GetObjectItemCaseSensitive(body, "name");
    double expires_s = 24 * 3600;
    *wanted = (struct meeting_link){ .is_ended = false };
    if (!body_names_are(body, names, "", problem) ||
        !read_role(cJSON_GetObjectItemCaseSensitive(body, "role"), &wanted->role, problem))
        return false;
    const int most_s = wanted->role == WIRE_MEMBER_ROLE_WALL ? ROOM_LINK_WALL_MAX_S : ROOM_LINK_MAX_S;
    if (expires)
        expires_s = cJSON_IsNumber(expires) ? expires->valuedouble : -1;
    if (!(expires_s >= ROOM_LINK_MIN_S && expires_s <= most_s) || floor(expires_s) != expires_s)
        return problem_set(problem, PROBLEM_VALIDATION, "/expires_s", "range",
                           "expires_s must be a whole number, %d to %d", ROOM_LINK_MIN_S, most_s);
    if (guests && !cJSON_IsBool(guests))
        return problem_set(problem, PROBLEM_VALIDATION, "/guests", "type", "guests must be true or false");
    if (name && !body_check_text(name, "/name", MAX_LINK_NAME, problem))
        return false;
    wanted->expires_ms = clock_wall_ms() + (int64_t)expires_s * 1000;
    wanted->allows_guests = cJSON_IsTrue(guests);
    if (name)
        (void)snprintf(wanted->name, sizeof wanted->name, "%s", name->valuestring);
    return true;
}

/* A link gives at most the role of who makes it. */
static bool may_give(const struct api *api, const struct call *call, const struct meeting *meeting,
                     enum wire_member_role role, struct problem *problem)
{
    enum wire_member_role own;
    if (role == WIRE_MEMBER_ROLE_WALL)
        return true;
    if (api_meeting_role(api, call, meeting, &own) && role <= own)
        return true;
    return problem_set(problem, PROBLEM_FORBIDDEN, "/role", "role", "a %s gives no role above it, and %s is",
                       wire_member_role_words.words[own], wire_member_role_words.words[role]);
}

struct made { /* a link whose write is under way */
    struct call *call;
    char token[MEETING_TOKEN];
};

static void was_made(void *context, const struct meeting *meeting, const struct problem *problem)
{
    struct made *made = context;
    struct call *call = made->call;
    if (problem || !meeting) {
        call_answer_problem(call, problem);
    } else {
        const struct meeting_link *link = &meeting->links[meeting->n_links - 1];
        char url[160];
        (void)snprintf(url, sizeof url, "/meetings/%s#link=%s", meeting->id, made->token);
        cJSON *answer = describe(call->api, meeting, link);
        cJSON_AddStringToObject(answer, "token", made->token);
        cJSON_AddStringToObject(answer, "url", url);
        call_answer_json(call, 201, answer);
    }
    free(made);
}

void api_meeting_link_new(struct api *api, struct call *call)
{
    struct problem problem = { 0 };
    struct meeting_link wanted;
    cJSON *body;
    if (!call_read_object(call, media_types, &body))
        return;
    struct meeting *copy = api_meeting_copy(api, call);
    if (!copy) {
        cJSON_Delete(body);
        return;
    }
    struct made *made = mem_new(sizeof *made);
    made->call = call;
    bool ok = read_wanted(body, &wanted, &problem) && may_give(api, call, copy, wanted.role, &problem);
    (void)snprintf(wanted.maker, sizeof wanted.maker, "%s", call->identity.user);
    ok = ok && meeting_add_link(copy, &wanted, made->token, &problem);
    cJSON_Delete(body);
    const struct net_meeting_act act = {
        .who = &call->identity, .address = call->client, .what = "link-made", .case_id = ""
    };
    if (!ok)
        meeting_free(copy);
    if (ok && net_meeting_commit(api->net, copy, &act, was_made, made, &problem))
        return;
    free(made);
    call_answer_problem(call, &problem);
}

/* ---- ending one ------------------------------------------------------------------------------------------------- */

static void was_ended(void *context, const struct meeting *meeting, const struct problem *problem)
{
    struct call *call = context;
    const struct api *api = call->api;
    if (problem || !meeting) {
        call_answer_problem(call, problem);
        return;
    }
    (void)net_meeting_put_out(api->net, meeting, call->ids[1]);
    call_answer_nothing(call, 204);
}

void api_meeting_link_end(struct api *api, struct call *call)
{
    struct problem problem = { 0 };
    struct meeting *copy = api_meeting_copy(api, call);
    struct meeting_link *link = copy ? meeting_link_find(copy, call->ids[1]) : NULL;
    const struct net_meeting_act act = {
        .who = &call->identity, .address = call->client, .what = "link-ended", .case_id = ""
    };
    if (!copy)
        return;
    if (!link || link->is_ended) {
        meeting_free(copy);
        problem_set(&problem, PROBLEM_NOT_FOUND, "", "", "the meeting has no link \"%.63s\"", call->ids[1]);
        call_answer_problem(call, &problem);
        return;
    }
    link->is_ended = true;
    if (!net_meeting_commit(api->net, copy, &act, was_ended, call, &problem))
        call_answer_problem(call, &problem);
}

/* ---- where it leads --------------------------------------------------------------------------------------------- */

void api_meeting_enter(struct api *api, struct call *call)
{
    struct problem problem = { 0 };
    cJSON *body;
    if (!call_read_object(call, media_types, &body))
        return;
    const char *token = json_text(body, "link");
    const bool is_known = net_rooms_are_known(api->net, &problem);
    const struct meeting *meeting = is_known ? net_meeting_find(api->net, call->ids[0]) : NULL;
    const struct meeting_link *link = meeting && token ? meeting_link_of(meeting, token, clock_wall_ms()) : NULL;
    if (!token)
        problem_set(&problem, PROBLEM_VALIDATION, "/link", "required", "give in \"link\" the token of a link");
    else if (is_known && !link)
        problem_set(&problem, PROBLEM_NOT_FOUND, "", "", "there is no meeting \"%.63s\"", call->ids[0]);
    cJSON_Delete(body);
    if (problem.type != PROBLEM_NONE) {
        call_answer_problem(call, &problem);
        return;
    }
    const struct meeting_case *now = meeting_find(meeting, meeting->now);
    cJSON *answer = cJSON_CreateObject();
    cJSON_AddStringToObject(answer, "meeting", meeting->id);
    cJSON_AddStringToObject(answer, "name", meeting->name);
    cJSON_AddStringToObject(answer, "state", meeting_state_word(meeting_state(meeting)));
    json_add(answer, "starts_ms",
             meeting->starts_ms ? cJSON_CreateNumber((double)meeting->starts_ms) : cJSON_CreateNull());
    cJSON_AddStringToObject(answer, "role", wire_member_role_words.words[link->role]);
    json_add(answer, "room", now ? cJSON_CreateString(now->room) : cJSON_CreateNull());
    call_answer_json(call, 200, answer);
}
