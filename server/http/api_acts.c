/* Calls that do what members of a room do by messages: a call becomes the message, and the outcome its answer. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "server/http/api_acts.h"
#include "server/http/api_queries.h"
#include "server/room/state/body_check.h"
#include "server/wire/message.h"

enum { MAX_NAME = 40, MAX_KEY = 200 };

static const struct api_act acts[] = {
    { "POST", "/api/v1/rooms/{room}/notes", "item.put", "note" },
    { "PATCH", "/api/v1/rooms/{room}/notes/{note}", "item.put", "note" },
    { "DELETE", "/api/v1/rooms/{room}/notes/{note}", "item.delete", "note" },
    { "POST", "/api/v1/rooms/{room}/notes/{note}/hide", "item.hide", "note" },
    { "POST", "/api/v1/rooms/{room}/bookmarks", "item.put", "bookmark" },
    { "PATCH", "/api/v1/rooms/{room}/bookmarks/{bookmark}", "item.put", "bookmark" },
    { "DELETE", "/api/v1/rooms/{room}/bookmarks/{bookmark}", "item.delete", "bookmark" },
    { "POST", "/api/v1/rooms/{room}/checks", "item.put", "check" },
    { "PATCH", "/api/v1/rooms/{room}/checks/{check}", "item.put", "check" },
    { "DELETE", "/api/v1/rooms/{room}/checks/{check}", "item.delete", "check" },
    { "POST", "/api/v1/rooms/{room}/decisions", "item.put", "decision" },
    { "POST", "/api/v1/rooms/{room}/signatures", "item.put", "signature" },
    { "POST", "/api/v1/rooms/{room}/acceptances", "item.put", "acceptance" },
    { "DELETE", "/api/v1/rooms/{room}/acceptances/{acceptance}", "item.delete", "acceptance" },
    { "POST", "/api/v1/rooms/{room}/control/present", "present", NULL },
    { "POST", "/api/v1/rooms/{room}/control/request", "control.request", NULL },
    { "POST", "/api/v1/rooms/{room}/control/give", "control.give", NULL },
    { "POST", "/api/v1/rooms/{room}/control/refuse", "control.refuse", NULL },
    { "POST", "/api/v1/rooms/{room}/control/take", "control.take", NULL },
    { "POST", "/api/v1/rooms/{room}/control/lock", "control.lock", NULL },
    { "POST", "/api/v1/rooms/{room}/follow", "follow", NULL },
    { "POST", "/api/v1/rooms/{room}/follow/everyone", "show.everyone", NULL },
    { "POST", "/api/v1/rooms/{room}/look", "look.here", NULL },
    { "POST", "/api/v1/rooms/{room}/look/come", "look.come", NULL },
    { "POST", "/api/v1/rooms/{room}/pointer", "pointer", NULL },
    { "POST", "/api/v1/rooms/{room}/recording/start", "recording.start", NULL },
    { "POST", "/api/v1/rooms/{room}/recording/stop", "recording.stop", NULL },
    { "POST", "/api/v1/rooms/{room}/replay/play", "replay.play", NULL },
    { "POST", "/api/v1/rooms/{room}/replay/pause", "replay.pause", NULL },
    { "POST", "/api/v1/rooms/{room}/replay/seek", "replay.seek", NULL },
    { "POST", "/api/v1/rooms/{room}/replay/leave", "replay.leave", NULL },
};
const size_t api_n_acts = sizeof acts / sizeof acts[0];

bool api_act_route(size_t index, struct api_route *route)
{
    if (index >= api_n_acts)
        return false;
    *route = (struct api_route){ acts[index].method, acts[index].path, api_room_act, &acts[index] };
    return true;
}

static bool key_is_right(const char *key, struct problem *problem)
{
    const size_t n = key ? strlen(key) : 1;
    bool is_right = n >= 1 && n <= MAX_KEY;
    for (const char *at = key; at && *at; at++)
        is_right = is_right && *at > 32 && *at < 127;
    return is_right || problem_set(problem, PROBLEM_VALIDATION, "", "pattern",
                                   "Idempotency-Key must be 1 to %d characters of ASCII without spaces", MAX_KEY);
}

static bool name_is_right(const cJSON *name, struct problem *problem)
{
    bool is_right = true;
    if (name && !body_check_text(name, "/name", MAX_NAME, problem))
        return false;
    for (const char *at = name ? name->valuestring : ""; *at; at++)
        is_right = is_right && (unsigned char)*at >= 32;
    return is_right || problem_set(problem, PROBLEM_VALIDATION, "/name", "pattern",
                                   "a name is one line, without control characters");
}

/* The fields that the address gives do not stand in the body. */
static bool body_is_free(const cJSON *body, const struct api_act *act, bool is_change, struct problem *problem)
{
    static const char *const given[] = { "type", "input", "kind", "item", "version" };
    char pointer[16];
    const size_t n = act->kind ? (is_change ? 4 : 5) : 2;
    for (size_t i = 0; i < n; i++)
        if (cJSON_HasObjectItem(body, given[i])) {
            (void)snprintf(pointer, sizeof pointer, "/%s", given[i]);
            return problem_set(problem, PROBLEM_VALIDATION, pointer, "unknown-field", "%.60s is not a field of it",
                               given[i]);
        }
    return true;
}

/* The message as JSON; NULL: the call was answered. name gets who does it, "" where that is not told. */
static cJSON *read_message(struct call *call, char name[4 * MAX_NAME + 1])
{
    static const char *const media_types[] = { "application/json", NULL };
    struct problem problem = { 0 };
    const struct api_act *act = call->act;
    cJSON *json;
    double version = 0;
    bool is_right = key_is_right(call->key, &problem);
    if (call->method == CALL_DELETE) {
        json = cJSON_CreateObject();
        is_right = is_right && call_query_number(call, "version", false, &version, &problem);
        cJSON_AddNumberToObject(json, "version", version);
    } else if (!call_read_object(call, media_types, &json)) {
        return NULL;
    }
    cJSON *given = cJSON_DetachItemFromObjectCaseSensitive(json, "name");
    is_right = is_right &&
               (call->method == CALL_DELETE || body_is_free(json, act, call->method == CALL_PATCH, &problem)) &&
               name_is_right(given, &problem);
    (void)snprintf(name, 4 * MAX_NAME + 1, "%s", is_right && given ? given->valuestring : "");
    cJSON_Delete(given);
    cJSON_AddStringToObject(json, "type", act->message);
    if (act->kind && strcmp(act->message, "item.put") == 0)
        cJSON_AddStringToObject(json, "kind", act->kind);
    if (act->kind && call->ids[1])
        cJSON_AddStringToObject(json, "item", call->ids[1]);
    if (is_right)
        return json;
    cJSON_Delete(json);
    call_answer_problem(call, &problem);
    return NULL;
}

static enum wire_item_kind kind_of(const char *word)
{
    size_t kind = 0;
    while (kind < wire_item_kind_words.n && strcmp(wire_item_kind_words.words[kind], word) != 0)
        kind++;
    return (enum wire_item_kind)kind;
}

static void answer_item(struct call *call, const char *row, bool was_sent_before)
{
    struct problem problem;
    char *text = strdup(row);
    if (!text) {
        (void)json_no_memory(&problem, "the answer");
        call_answer_problem(call, &problem);
        return;
    }
    call_answer_bytes(call,
                      call->method == CALL_POST && !was_sent_before && strcmp(call->act->message, "item.hide") != 0
                          ? 201
                          : 200,
                      "application/json", (uint8_t *)text, strlen(text));
}

static void act_done(void *context, const char *row, bool was_sent_before, const struct problem *problem)
{
    struct call *call = context;
    if (problem)
        call_answer_problem(call, problem);
    else if (row)
        answer_item(call, row, was_sent_before);
    else
        call_answer_nothing(call, 204);
}

void api_act_in(struct room *room, struct call *call, cJSON *json, const char *name)
{
    struct problem problem = { 0 };
    struct message message;
    char *text = json_print(json);
    cJSON_Delete(json);
    const bool is_read =
        text ? message_read(text, strlen(text), true, &message, &problem) : json_no_memory(&problem, "a message");
    free(text);
    if (!is_read) {
        call_answer_problem(call, &problem);
        return;
    }
    const struct room_act act = { .member = call->member,
                                  .name = name,
                                  .identity = &call->identity,
                                  .address = call->client,
                                  .key = call->act ? call->key : NULL,
                                  .message = &message,
                                  .done = act_done,
                                  .context = call };
    room_act(room, &act, clock_now_us()); /* answers the call, now or later */
    message_finish(&message);
}

void api_room_act(struct api *api, struct call *call)
{
    struct problem problem = { 0 };
    char name[4 * MAX_NAME + 1];
    struct room *room = api_find_room(api, call);
    if (!room)
        return;
    if (call->act->kind && call->ids[1] && !room_item_is(room, call->ids[1], kind_of(call->act->kind))) {
        problem_set(&problem, PROBLEM_NOT_FOUND, "", "", "the room has no %s \"%.63s\"", call->act->kind, call->ids[1]);
        call_answer_problem(call, &problem);
        return;
    }
    cJSON *json = read_message(call, name);
    if (json)
        api_act_in(room, call, json, name);
}
