/* GET /meetings/{meeting}/minutes: what a meeting did, and who was there for which case. */
#include <string.h>

#include "core/base/clock.h"
#include "server/http/api_handlers.h"
#include "server/http/api_meetings.h"
#include "server/net/listed.h"

static void add_time(cJSON *json, const char *name, int64_t ms)
{
    json_add(json, name, ms ? cJSON_CreateNumber((double)ms) : cJSON_CreateNull());
}

static void add_text(cJSON *json, const char *name, const char *text)
{
    json_add(json, name, text[0] ? cJSON_CreateString(text) : cJSON_CreateNull());
}

static void add_span(cJSON *list, int64_t from_ms, int64_t to_ms)
{
    cJSON *span = cJSON_CreateObject();
    cJSON_AddNumberToObject(span, "from_ms", (double)from_ms);
    add_time(span, "to_ms", to_ms);
    json_append(list, span);
}

static cJSON *describe_case(const struct api *api, const struct call *call, const struct meeting *meeting,
                            const struct meeting_case *one)
{
    const bool is_open = net_meeting_case_is_open(api->net, one, &call->identity, call->member);
    const char *name = one->room[0] ? net_room_name(api->net, one->room) : NULL;
    cJSON *json = cJSON_CreateObject(), *visits = cJSON_CreateArray();
    cJSON_AddStringToObject(json, "id", one->id);
    cJSON_AddNumberToObject(json, "n", (double)meeting_place(meeting, one) + 1);
    cJSON_AddBoolToObject(json, "is_open", is_open);
    add_text(json, "plan", is_open ? one->plan : "");
    add_text(json, "label", is_open ? one->label : "");
    add_text(json, "patient", is_open ? one->patient : "");
    add_text(json, "approval", is_open ? one->approval : "");
    add_text(json, "room", is_open && name ? one->room : "");
    add_text(json, "room_name", is_open && name ? name : "");
    add_time(json, "began_ms", meeting_first_ms(meeting, one));
    cJSON_AddNumberToObject(json, "spent_ms", (double)meeting_spent_ms(meeting, one, clock_wall_ms()));
    for (size_t i = 0; i < one->n_visits; i++)
        add_span(visits, one->visits[i].from_ms, one->visits[i].to_ms);
    if (strcmp(meeting->now, one->id) == 0)
        add_span(visits, meeting->since_ms, 0);
    json_add(json, "visits", visits);
    add_text(json, "decision", is_open ? one->decision : "");
    add_time(json, "decided_ms", is_open ? one->decided_ms : 0);
    add_text(json, "decided_by", is_open ? one->decided_by : "");
    return json;
}

/* ---- attendance ------------------------------------------------------------------------------------------------- */

/* The row of the person of this stay in the list of people; a new one where there is none. */
static cJSON *person_of(cJSON *people, const cJSON *stay)
{
    const char *name = json_text(stay, "name"), *user = json_text(stay, "user"), *role = json_text(stay, "role");
    const bool is_guest = cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(stay, "is_guest"));
    cJSON *row;
    name = name ? name : "";
    user = user ? user : "";
    cJSON_ArrayForEach(row, people)
    {
        if (strcmp(json_text(row, "name"), name) == 0 && strcmp(json_text(row, "user"), user) == 0 &&
            cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(row, "is_guest")) == is_guest)
            return row;
    }
    row = cJSON_CreateObject();
    cJSON_AddStringToObject(row, "name", name);
    cJSON_AddStringToObject(row, "user", user);
    cJSON_AddStringToObject(row, "role", role ? role : "");
    cJSON_AddBoolToObject(row, "is_guest", is_guest);
    json_add(row, "cases", cJSON_CreateArray());
    json_append(people, row);
    return row;
}

static cJSON *stays_of(const cJSON *person, const struct meeting *meeting, const struct meeting_case *one)
{
    cJSON *cases = cJSON_GetObjectItemCaseSensitive(person, "cases"), *row;
    cJSON_ArrayForEach(row, cases)
    {
        if (strcmp(json_text(row, "id"), one->id) == 0)
            return cJSON_GetObjectItemCaseSensitive(row, "stays");
    }
    cJSON *stays = cJSON_CreateArray();
    row = cJSON_CreateObject();
    cJSON_AddStringToObject(row, "id", one->id);
    cJSON_AddNumberToObject(row, "n", (double)meeting_place(meeting, one) + 1);
    json_add(row, "stays", stays);
    json_append(cases, row);
    return stays;
}

/* The part of the stay in which the meeting ran: rooms may have been used before it and after. */
static bool clip(const struct meeting *meeting, int64_t began_ms, const cJSON *stay, int64_t *from_ms, int64_t *to_ms)
{
    const bool is_here = cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(stay, "here"));
    *from_ms = (int64_t)json_number(stay, "entered_ms", 0);
    *to_ms = (int64_t)json_number(stay, "left_ms", 0);
    if (*from_ms < began_ms)
        *from_ms = began_ms;
    if (meeting->ended_ms && (!*to_ms || *to_ms > meeting->ended_ms))
        *to_ms = meeting->ended_ms;
    return began_ms && (*to_ms ? *to_ms > *from_ms : is_here || !meeting->ended_ms);
}

static void add_stays(cJSON *people, const struct meeting *meeting, const struct meeting_case *one, int64_t began_ms)
{
    const cJSON *stay;
    cJSON_ArrayForEach(stay, one->stays)
    {
        int64_t from_ms, to_ms;
        if (clip(meeting, began_ms, stay, &from_ms, &to_ms))
            add_span(stays_of(person_of(people, stay), meeting, one), from_ms, to_ms);
    }
}

static int64_t began_at(const struct meeting *meeting)
{
    int64_t first_ms = 0;
    for (size_t i = 0; i < meeting->n_cases; i++) {
        const int64_t ms = meeting_first_ms(meeting, meeting->cases[i]);
        if (ms && (!first_ms || ms < first_ms))
            first_ms = ms;
    }
    return first_ms;
}

void api_meeting_minutes(struct api *api, struct call *call)
{
    const struct meeting *meeting = api_find_meeting(api, call);
    if (!meeting)
        return;
    const int64_t began_ms = began_at(meeting);
    cJSON *answer = cJSON_CreateObject(), *cases = cJSON_CreateArray(), *people = cJSON_CreateArray();
    cJSON_AddStringToObject(answer, "meeting", meeting->id);
    cJSON_AddStringToObject(answer, "name", meeting->name);
    add_time(answer, "starts_ms", meeting->starts_ms);
    add_time(answer, "began_ms", began_ms);
    add_time(answer, "ended_ms", meeting->ended_ms);
    cJSON_AddStringToObject(answer, "state", meeting_state_word(meeting_state(meeting)));
    cJSON_AddNumberToObject(answer, "made_ms", (double)clock_wall_ms());
    for (size_t i = 0; i < meeting->n_cases; i++) {
        json_append(cases, describe_case(api, call, meeting, meeting->cases[i]));
        add_stays(people, meeting, meeting->cases[i], began_ms);
    }
    json_add(answer, "cases", cases);
    json_add(answer, "people", people);
    call_answer_json(call, 200, answer);
}
