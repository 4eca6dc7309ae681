/* POST /records/search: kept decisions and signatures by what a list says of them, page by page. What is looked for may
 * name a patient, so it stands in the body and in no address. */
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "core/base/mem.h"
#include "server/http/api_access.h"
#include "server/http/api_handlers.h"
#include "server/http/api_records.h"

enum {
    MAX_TEXT = 200,
    LIMIT_BY_DEFAULT = 50,
    LIMIT_AT_MOST = 200,
    MAX_SEARCHES = 4 /* at once: each may read all records */
};

struct search { /* while rows are read */
    char text[MAX_TEXT + 1], before[64], kind[16];
    int limit, n_found;
    bool is_cursor; /* before is being looked up: whether the caller may see it */
    bool has_more;
    cJSON *answer, *list;
};

static void search_destroy(struct search *search)
{
    cJSON_Delete(search->answer);
    free(search);
}

static void end(struct call *call, struct search *search, const struct problem *problem)
{
    struct api *api = call->api;
    api->n_searches--;
    call->context = NULL;
    if (problem) {
        call_answer_problem(call, problem);
    } else {
        cJSON_AddBoolToObject(search->answer, "more", search->has_more);
        call_answer_json(call, 200, search->answer);
        search->answer = NULL;
    }
    search_destroy(search);
}

/* ---- what is found ------------------------------------------------------------------------------------------------ */

/* Without regard to the case of letters of ASCII. */
static bool has_text(const char *in, const char *text)
{
    const size_t n = strlen(text);
    const char first[] = { (char)tolower((unsigned char)text[0]), (char)toupper((unsigned char)text[0]), 0 };
    if (n == 0)
        return true;
    for (in = in ? strpbrk(in, first) : NULL; in; in = strpbrk(in + 1, first))
        if (strncasecmp(in, text, n) == 0)
            return true;
    return false;
}

/* False: is_found would not hold, which is known without a document for the row. Facts are JSON: a text stands in them
 * as it is unless something there is written with a backslash. */
static bool may_be_found(const struct search *search, const struct net_record *record)
{
    const char *const texts[] = { record->id, record->room, record->plan, record->author_name, record->facts };
    if (search->kind[0] && strcmp(search->kind, record->kind) != 0)
        return false;
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
        if (has_text(texts[i], search->text))
            return true;
    return record->facts && strchr(record->facts, '\\');
}

static bool is_found(const struct search *search, const cJSON *row)
{
    static const char *const fields[] = { "id",        "room",    "plan",  "author_name",
                                          "plan_name", "patient", "label", "decision" };
    const char *kind = json_text(row, "kind"); /* NULL: there was no memory for the row */
    if (!kind || (search->kind[0] && strcmp(search->kind, kind) != 0))
        return false;
    for (size_t i = 0; i < sizeof fields / sizeof fields[0]; i++)
        if (has_text(json_text(row, fields[i]), search->text))
            return true;
    return false;
}

/* Takes what is found of these rows. False: the page is full. */
static bool take_rows(const struct call *call, struct search *search, const struct net_record *records, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        if (!may_be_found(search, &records[i]) || !api_access_to_plan(call->api, call, ACCESS_LOOK, records[i].plan))
            continue;
        cJSON *row = api_record_row(&records[i]);
        const bool is_wanted = is_found(search, row);
        if (is_wanted && search->n_found == search->limit)
            search->has_more = true;
        else if (is_wanted && ++search->n_found)
            json_append(search->list, row);
        if (!is_wanted || search->has_more)
            cJSON_Delete(row);
        if (search->has_more)
            return false;
    }
    return true;
}

/* ---- rows --------------------------------------------------------------------------------------------------------- */

static void rows_were_read(void *context, const struct net_record *records, size_t n, const struct problem *problem)
{
    struct call *call = context;
    struct search *search = call->context;
    struct problem busy;
    const struct api *api = call->api;
    const bool is_cursor = search->is_cursor;
    search->is_cursor = false;
    if (problem && (problem->type != PROBLEM_NOT_FOUND || !is_cursor)) {
        end(call, search, problem);
        return;
    }
    /* behind a row that the caller may not see there is nothing, as behind one that is not there */
    if (is_cursor && (problem || n == 0 || !api_access_to_plan(api, call, ACCESS_LOOK, records[0].plan))) {
        end(call, search, NULL);
        return;
    }
    if (!is_cursor) {
        if (!take_rows(call, search, records, n) || n < STORE_RECORDS_AT_ONCE) {
            end(call, search, NULL);
            return;
        }
        (void)snprintf(search->before, sizeof search->before, "%.63s", records[n - 1].id);
    }
    if (!net_read_records(api->net, "", search->before, rows_were_read, call, &busy))
        end(call, search, &busy);
}

/* ---- the call ----------------------------------------------------------------------------------------------------- */

static bool read_field(const cJSON *item, struct search *search, struct problem *problem)
{
    const char *name = item->string, *text = cJSON_GetStringValue(item);
    char pointer[64];
    (void)snprintf(pointer, sizeof pointer, "/%.60s", name);
    if (strcmp(name, "limit") == 0) {
        if (!cJSON_IsNumber(item) || !(item->valuedouble >= 1 && item->valuedouble <= LIMIT_AT_MOST))
            return problem_set(problem, PROBLEM_VALIDATION, pointer, "range", "limit must be 1 to %d", LIMIT_AT_MOST);
        search->limit = (int)item->valuedouble;
        return true;
    }
    char *to = strcmp(name, "text") == 0     ? search->text
               : strcmp(name, "before") == 0 ? search->before
               : strcmp(name, "kind") == 0   ? search->kind
                                             : NULL;
    if (!to)
        return problem_set(problem, PROBLEM_VALIDATION, pointer, "unknown-field", "%.60s is not a field of it", name);
    const size_t size = to == search->text     ? sizeof search->text
                        : to == search->before ? sizeof search->before
                                               : sizeof search->kind;
    if (!text || strlen(text) >= size)
        return problem_set(problem, PROBLEM_VALIDATION, pointer, "type", "%s must be a text of at most %zu bytes",
                           pointer, size - 1);
    (void)snprintf(to, size, "%s", text);
    return true;
}

static bool read_search(const cJSON *body, struct search *search, struct problem *problem)
{
    const cJSON *item;
    cJSON_ArrayForEach(item, body)
    {
        if (!read_field(item, search, problem))
            return false;
    }
    if (search->before[0] && !id_is_valid(search->before))
        return problem_set(problem, PROBLEM_VALIDATION, "/before", "pattern", "before must be the id of a record");
    return !search->kind[0] || strcmp(search->kind, "decision") == 0 || strcmp(search->kind, "signature") == 0 ||
           problem_set(problem, PROBLEM_VALIDATION, "/kind", "enum",
                       "kind is \"%.20s\", expected decision or signature", search->kind);
}

void api_record_search(struct api *api, struct call *call)
{
    static const char *const types[] = { "application/json", NULL };
    struct problem problem = { 0 };
    cJSON *body;
    if (!call_read_object(call, types, &body))
        return;
    if (api->n_searches == MAX_SEARCHES) {
        cJSON_Delete(body);
        problem_set(&problem, PROBLEM_BUSY, "", "", "the disk has too much to do to read records now");
        problem.retry_after_ms = 1000;
        call_answer_problem(call, &problem);
        return;
    }
    api->n_searches++;
    struct search *search = mem_new(sizeof *search);
    *search = (struct search){ .limit = LIMIT_BY_DEFAULT, .answer = cJSON_CreateObject() };
    search->list = cJSON_AddArrayToObject(search->answer, "records");
    const bool is_read = read_search(body, search, &problem);
    cJSON_Delete(body);
    call->context = search;
    search->is_cursor = search->before[0] && call->identity.source != IDENTITY_MACHINE;
    if (!is_read || !net_read_records(api->net, search->is_cursor ? search->before : "",
                                      search->is_cursor ? "" : search->before, rows_were_read, call, &problem))
        end(call, search, &problem);
}
