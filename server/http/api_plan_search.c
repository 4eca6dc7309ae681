/* POST /plans/search: plans by what they are called, page by page. What is looked for may name a patient, so it stands
 * in the body and in no address. */
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "server/http/api_access.h"
#include "server/http/api_handlers.h"

enum { MAX_TEXT = 200, MAX_FOLDER = 4096, LIMIT_BY_DEFAULT = 50, LIMIT_AT_MOST = 200 };

struct search {
    const char *text, *folder, *cursor;
    double limit;
};

static bool read_text(const cJSON *item, const char *pointer, size_t max_bytes, const char **text,
                      struct problem *problem)
{
    if (!item)
        return true;
    if (!cJSON_IsString(item) || strlen(item->valuestring) > max_bytes)
        return problem_set(problem, PROBLEM_VALIDATION, pointer, "type", "%s must be a text of at most %zu bytes",
                           pointer, max_bytes);
    *text = item->valuestring;
    return true;
}

/* The texts are borrowed from body. */
static bool read_search(const cJSON *body, struct search *search, struct problem *problem)
{
    static const char *const known[] = { "text", "folder", "cursor", "limit" };
    const cJSON *item;
    *search = (struct search){ .text = "", .folder = "", .cursor = "", .limit = LIMIT_BY_DEFAULT };
    cJSON_ArrayForEach(item, body)
    {
        char pointer[64];
        bool is_known = false;
        for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
            is_known = is_known || strcmp(item->string, known[i]) == 0;
        (void)snprintf(pointer, sizeof pointer, "/%.60s", item->string);
        if (!is_known)
            return problem_set(problem, PROBLEM_VALIDATION, pointer, "unknown-field", "%.60s is not a field of it",
                               item->string);
    }
    const cJSON *limit = cJSON_GetObjectItemCaseSensitive(body, "limit");
    if (limit && !(cJSON_IsNumber(limit) && limit->valuedouble >= 1 && limit->valuedouble <= LIMIT_AT_MOST))
        return problem_set(problem, PROBLEM_VALIDATION, "/limit", "range", "limit must be 1 to %d", LIMIT_AT_MOST);
    if (limit)
        search->limit = limit->valuedouble;
    return read_text(cJSON_GetObjectItemCaseSensitive(body, "text"), "/text", MAX_TEXT, &search->text, problem) &&
           read_text(cJSON_GetObjectItemCaseSensitive(body, "folder"), "/folder", MAX_FOLDER, &search->folder,
                     problem) &&
           read_text(cJSON_GetObjectItemCaseSensitive(body, "cursor"), "/cursor", 63, &search->cursor, problem);
}

/* Without regard to the case of letters of ASCII. */
static bool has_text(const char *in, const char *text)
{
    const size_t n = strlen(text);
    for (; n > 0 && in && *in && strncasecmp(in, text, n) != 0; in++)
        continue;
    return n == 0 || (in && *in);
}

/* Looks at the masked form of patients alone, which is known of a plan that was loaded. */
static bool is_found(const struct fleet_plan *plan, const struct search *search)
{
    const cJSON *patient;
    const size_t n = strlen(search->folder);
    const bool is_in_folder =
        n == 0 || (strcmp(search->folder, "uploads") == 0 && plan->is_uploaded) ||
        (strncmp(plan->folder, search->folder, n) == 0 && (plan->folder[n] == '/' || plan->folder[n] == 0));
    bool is_named =
        has_text(plan->name, search->text) || has_text(plan->note, search->text) || has_text(plan->id, search->text);
    cJSON_ArrayForEach(patient, cJSON_GetObjectItemCaseSensitive(plan->document, "patients"))
    {
        is_named = is_named || has_text(json_text(patient, "masked"), search->text);
    }
    return is_in_folder && is_named;
}

void api_plan_search(struct api *api, struct call *call)
{
    static const char *const media_types[] = { "application/json", NULL };
    struct fleet *fleet = net_fleet(api->net);
    struct problem problem;
    struct search search;
    struct fleet_plan plan;
    cJSON *body;
    if (!call_read_object(call, media_types, &body))
        return;
    if (!read_search(body, &search, &problem)) {
        cJSON_Delete(body);
        call_answer_problem(call, &problem);
        return;
    }
    cJSON *answer = cJSON_CreateObject(), *list = cJSON_AddArrayToObject(answer, "plans");
    bool is_behind = search.cursor[0] == 0, is_cut = false;
    char last[64] = "";
    int n = 0, n_found = 0;
    for (size_t i = 0; i < fleet_n_plans(fleet); i++) {
        if (!fleet_plan_at(fleet, i, &plan) || !api_access_to_found_plan(api, call, ACCESS_LOOK, &plan) ||
            !is_found(&plan, &search))
            continue;
        n_found++;
        if (is_behind && n < search.limit) {
            n++;
            (void)snprintf(last, sizeof last, "%s", plan.id);
            json_append(list, api_plan_head(&plan));
        } else if (is_behind) {
            is_cut = true;
        }
        is_behind = is_behind || strcmp(plan.id, search.cursor) == 0;
    }
    cJSON_Delete(body);
    cJSON_AddNumberToObject(answer, "total", n_found);
    json_add(answer, "next", is_cut ? cJSON_CreateString(last) : cJSON_CreateNull());
    call_answer_json(call, 200, answer);
}
