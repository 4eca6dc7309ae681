/* Records of decisions and signatures, which outlive their rooms and plans. */
#include <stdio.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/http/api_access.h"
#include "server/http/api_audit.h"
#include "server/http/api_handlers.h"
#include "server/http/api_records.h"

bool api_may_delete(struct call *call, size_t n_decided, const char *where)
{
    struct problem problem;
    const char *records = call_query(call, "records");
    if (records && strcmp(records, "keep") != 0) {
        problem_set(&problem, PROBLEM_VALIDATION, "/records", "enum", "records is \"%.20s\", expected keep", records);
        call_answer_problem(call, &problem);
        return false;
    }
    if (!n_decided || records)
        return true;
    if (n_decided == 1)
        problem_set(
            &problem, PROBLEM_CONFLICT, "/records", "records",
            "1 decision or signature was written in %s; its record stays when it is deleted, at /api/v1/records: say "
            "records=keep",
            where);
    else
        problem_set(&problem, PROBLEM_CONFLICT, "/records", "records",
                    "%zu decisions and signatures were written in %s; their records stay when it is deleted, at "
                    "/api/v1/records: say records=keep",
                    n_decided, where);
    call_answer_problem(call, &problem);
    return false;
}

static cJSON *describe(const struct net_record *record)
{
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "id", record->id);
    cJSON_AddStringToObject(json, "kind", record->kind);
    cJSON_AddStringToObject(json, "room", record->room);
    cJSON_AddStringToObject(json, "plan", record->plan);
    cJSON_AddStringToObject(json, "author", record->author);
    cJSON_AddStringToObject(json, "author_name", record->author_name);
    cJSON_AddNumberToObject(json, "time_ms", (double)record->time_ms);
    cJSON_AddStringToObject(json, "sha256", record->hash);
    return json;
}

cJSON *api_record_row(const struct net_record *record)
{
    static const char *const names[] = { "decision", "plan_name", "patient", "label", "approval" };
    cJSON *json = describe(record),
          *facts = record->facts ? json_read(record->facts, strlen(record->facts), NULL) : NULL;
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        const char *text = json_text(facts, names[i]);
        cJSON_AddStringToObject(json, names[i], text ? text : "");
    }
    cJSON_Delete(facts);
    return json;
}

static void list_was_read(void *context, const struct net_record *records, size_t n, const struct problem *problem)
{
    if (problem) {
        call_answer_problem(context, problem);
        return;
    }
    struct call *call = context;
    cJSON *answer = cJSON_CreateObject(), *list = cJSON_AddArrayToObject(answer, "records");
    for (size_t i = 0; i < n; i++)
        if (api_access_to_plan(call->api, call, ACCESS_LOOK, records[i].plan))
            json_append(list, api_record_row(&records[i]));
    call_answer_json(call, 200, answer);
}

/* Goes on before the record of this id; one that the caller may not see is as one that is not there. */
static void cursor_was_read(void *context, const struct net_record *records, size_t n, const struct problem *problem)
{
    struct call *call = context;
    const struct api *api = call->api;
    struct problem busy;
    if (problem && problem->type != PROBLEM_NOT_FOUND)
        call_answer_problem(call, problem);
    else if (problem || n == 0 || !api_access_to_plan(api, call, ACCESS_LOOK, records[0].plan))
        list_was_read(call, NULL, 0, NULL);
    else if (!net_read_records(api->net, "", records[0].id, list_was_read, call, &busy))
        call_answer_problem(call, &busy);
}

/* False: the call was answered. One that the caller may not see is as one that is not there. */
bool api_record_may_be_seen(struct call *call, const struct net_record *records, size_t n,
                            const struct problem *problem)
{
    struct problem missing;
    char text[100];
    if (problem || n == 0) {
        call_answer_problem(call, problem);
        return false;
    }
    if (api_access_to_plan(call->api, call, ACCESS_LOOK, records[0].plan))
        return true;
    (void)snprintf(text, sizeof text, "there is no record \"%.63s\"", call->ids[0]);
    problem_set(&missing, PROBLEM_NOT_FOUND, "", "", "%s", text);
    call_answer_problem(call, &missing);
    return false;
}

static void one_was_read(void *context, const struct net_record *records, size_t n, const struct problem *problem)
{
    struct call *call = context;
    if (!api_record_may_be_seen(call, records, n, problem))
        return;
    cJSON *answer = describe(&records[0]);
    json_add(answer, "item", cJSON_CreateRaw(records[0].item));
    json_add(answer, "signatures", cJSON_CreateRaw(records[0].signatures ? records[0].signatures : "[]"));
    json_add(answer, "later_decisions", cJSON_CreateRaw(records[0].decisions ? records[0].decisions : "[]"));
    json_add(answer, "body", cJSON_CreateRaw(records[0].body));
    call_answer_json(call, 200, answer);
}

void api_records(struct api *api, struct call *call)
{
    struct problem problem = { 0 };
    const char *before = call_query(call, "before");
    const bool asks_first = before && call->identity.source != IDENTITY_MACHINE;
    if (before && !id_is_valid(before))
        problem_set(&problem, PROBLEM_VALIDATION, "/before", "pattern", "before must be the id of a record");
    if (problem.type != PROBLEM_NONE ||
        !net_read_records(api->net, asks_first ? before : "", before && !asks_first ? before : "",
                          asks_first ? cursor_was_read : list_was_read, call, &problem))
        call_answer_problem(call, &problem);
}

void api_record(struct api *api, struct call *call)
{
    struct problem problem;
    if (api_audit_export(api, call, "record") &&
        !net_read_records(api->net, call->ids[0], "", one_was_read, call, &problem))
        call_answer_problem(call, &problem);
}

static void figure_was_read(void *context, const struct net_record *records, size_t n, const struct problem *problem)
{
    struct call *call = context;
    if (!api_record_may_be_seen(call, records, n, problem))
        return;
    const char *word = call->ids[1];
    const int place = word[0] >= '1' && word[0] <= '0' + STORE_FIGURES && !word[1] ? word[0] - '1' : -1;
    const struct store_figure *figure = place >= 0 ? &records[0].figures[place] : NULL;
    uint8_t *copy = figure && figure->bytes ? mem_array(figure->n_bytes, 1, STORE_MAX_FIGURE_BYTES, NULL) : NULL;
    struct problem missing;
    if (copy) {
        memcpy(copy, figure->bytes, figure->n_bytes);
        call_answer_bytes(call, 200, "image/jpeg", copy, figure->n_bytes);
        return;
    }
    if (figure && figure->bytes)
        problem_set(&missing, PROBLEM_MEMORY, "", "", "there is no memory for the picture");
    else
        problem_set(&missing, PROBLEM_NOT_FOUND, "", "", "this record has no picture \"%.20s\"", word);
    call_answer_problem(call, &missing);
}

void api_record_figure(struct api *api, struct call *call)
{
    struct problem problem;
    if (api_audit_export(api, call, "record") &&
        !net_read_records(api->net, call->ids[0], "", figure_was_read, call, &problem))
        call_answer_problem(call, &problem);
}
