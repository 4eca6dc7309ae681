/* Files and printouts that the page makes by itself: it tells them before it does, so that they are in the audit. */
#include <stdio.h>
#include <string.h>

#include "core/base/clock.h"
#include "server/auth/digest.h"
#include "server/http/api_audit.h"
#include "server/http/api_handlers.h"

enum { MAX_NAME_BYTES = 200 };

/* Which export can still be told when the room was deleted: its members save what they wrote. */
static const char of_gone_room[] = "notes";

static bool read_what(const cJSON *json, const char **what, struct problem *problem)
{
    static const char *const words[] = { "dvh",  "profile",   "limits", "probes",         "methods",
                                         "beam", "beam-card", "notes",  "printed-report", "printed-record" };
    const char *text = cJSON_GetStringValue(json);
    for (size_t i = 0; text && i < sizeof words / sizeof words[0]; i++)
        if (strcmp(text, words[i]) == 0) {
            *what = words[i];
            return true;
        }
    return problem_set(problem, PROBLEM_VALIDATION, "/what", json ? "enum" : "required",
                       "what must be dvh, profile, limits, probes, methods, beam, beam-card, notes, printed-report or "
                       "printed-record");
}

static bool read_name(const cJSON *json, const char **name, struct problem *problem)
{
    *name = cJSON_GetStringValue(json);
    if (!*name || !**name || strlen(*name) > MAX_NAME_BYTES)
        return problem_set(problem, PROBLEM_VALIDATION, "/name", json ? "range" : "required",
                           "name must be the name of what is exported, a text of 1 to %d bytes", MAX_NAME_BYTES);
    for (const char *c = *name; *c; c++)
        if ((unsigned char)*c < ' ' || *c == 127)
            return problem_set(problem, PROBLEM_VALIDATION, "/name", "pattern", "name has a control character");
    return true;
}

static bool read_told(const cJSON *body, const char **what, const char **name, struct problem *problem)
{
    const cJSON *item;
    char pointer[64];
    cJSON_ArrayForEach(item, body) if (strcmp(item->string, "what") != 0 && strcmp(item->string, "name") != 0)
    {
        (void)snprintf(pointer, sizeof pointer, "/%.60s", item->string);
        return problem_set(problem, PROBLEM_VALIDATION, pointer, "unknown-field", "%.60s is not a field of an export",
                           item->string);
    }
    return read_what(cJSON_GetObjectItemCaseSensitive(body, "what"), what, problem) &&
           read_name(cJSON_GetObjectItemCaseSensitive(body, "name"), name, problem);
}

/* The revision of the room's plan becomes known to the room. False: it is being found out. Of a plan whose files
 * cannot be read any more it stays what the room knew. */
static bool plan_revision_is_settled(struct api *api, struct room *room, struct problem *problem)
{
    struct fleet_revision revision;
    if (api_plan_revision_known(api, room_plan_id(room), &revision, problem))
        room_plan_revision(room, revision.digest);
    else if (problem->type == PROBLEM_BUSY)
        return false;
    return true;
}

static bool audit_told(struct api *api, const struct call *call, const cJSON *body, struct problem *problem)
{
    const char *what = "", *name = "";
    char hex[DIGEST_TEXT];
    struct room *room = net_room_find(api->net, call->ids[0]);
    if (!read_told(body, &what, &name, problem))
        return false;
    if (!room && (strcmp(what, of_gone_room) != 0 || !id_is_valid(call->ids[0])))
        return problem_set(problem, PROBLEM_NOT_FOUND, "", "", "there is no room \"%.63s\"", call->ids[0]);
    if ((room && !plan_revision_is_settled(api, room, problem)) || !api_audit_has_place(api, problem))
        return false;
    cJSON *detail = cJSON_CreateObject();
    cJSON_AddStringToObject(detail, "what", what);
    digest_text(name, hex); /* names of files are made of the plan's */
    cJSON_AddStringToObject(detail, "name_sha256", hex);
    if (room)
        room_audit_call(room, &call->identity, call->member, call->client, "export", detail, false, clock_now_us());
    else
        net_audit_by(api->net, &call->identity, call->client, call->ids[0], "", "export", detail);
    return true;
}

void api_room_export(struct api *api, struct call *call)
{
    static const char *const media_types[] = { "application/json", NULL };
    struct problem problem = { 0 };
    cJSON *body;
    if (!call_read_object(call, media_types, &body))
        return;
    const bool ok = audit_told(api, call, body, &problem);
    cJSON_Delete(body);
    if (ok)
        api_audit_add_head(api, call);
    if (ok)
        call_answer_nothing(call, 204);
    else
        call_answer_problem(call, &problem);
}
