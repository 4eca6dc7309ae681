/* GET /audit: rows of the audit, as pages of JSON, and as lines that beamroomd --verify-audit checks. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/http/api_audit.h"
#include "server/http/api_handlers.h"
#include "server/http/call.h"

enum { ROWS_BY_DEFAULT = 100, ROWS_AT_MOST = 1000, MAX_LINES_BYTES = 64 << 20 };
static const double LARGEST_WHOLE = 4e15; /* 15 digits: printed and read without loss */

static bool read_whole(const struct call *call, const char *name, double least, double most, double *value,
                       struct problem *problem)
{
    char pointer[24];
    (void)snprintf(pointer, sizeof pointer, "/%s", name);
    if (!call_query_number(call, name, false, value, problem))
        return false;
    return (*value >= least && *value <= most && *value == floor(*value)) ||
           problem_set(problem, PROBLEM_VALIDATION, pointer, "range",
                       "the parameter %s is %g, expected a whole number from %.0f to %.0f", name, *value, least, most);
}

static bool read_word(const struct call *call, const char *name, char *word, size_t size, struct problem *problem)
{
    char pointer[24];
    const char *given = call_query(call, name);
    (void)snprintf(pointer, sizeof pointer, "/%s", name);
    if (given && strlen(given) >= size)
        return problem_set(problem, PROBLEM_VALIDATION, pointer, "length",
                           "the parameter %s has %zu bytes, at most %zu are read", name, strlen(given), size - 1);
    (void)snprintf(word, size, "%s", given ? given : "");
    return true;
}

/* Reads a plan: its id, or the key that rows have. */
static bool read_plan(const struct call *call, struct store_audit_query *query, struct problem *problem)
{
    char id[64], key[NET_AUDIT_PLAN_KEY];
    if (!read_word(call, "plan", id, sizeof id, problem))
        return false;
    net_audit_plan_key(id, key);
    const bool is_key = strncmp(id, "plan-", 5) == 0 && strlen(id) == NET_AUDIT_PLAN_KEY - 3 &&
                        strspn(id + 5, "0123456789abcdef") == strlen(id) - 5;
    (void)snprintf(query->plan, sizeof query->plan, "%s", is_key ? id : key);
    return true;
}

static bool read_query(const struct call *call, struct store_audit_query *query, struct problem *problem)
{
    double from = 0, to = LARGEST_WHOLE, limit = ROWS_BY_DEFAULT, cursor = LARGEST_WHOLE;
    *query = (struct store_audit_query){ 0 };
    if (!read_whole(call, "from", 0, LARGEST_WHOLE, &from, problem) ||
        !read_whole(call, "to", 0, LARGEST_WHOLE, &to, problem) ||
        !read_whole(call, "limit", 1, ROWS_AT_MOST, &limit, problem) ||
        !read_whole(call, "cursor", 2, LARGEST_WHOLE, &cursor, problem))
        return false;
    query->from_ms = (int64_t)from;
    query->to_ms = (int64_t)to;
    query->limit = (size_t)limit;
    query->before_n = (int64_t)cursor;
    return read_word(call, "user", query->user, sizeof query->user, problem) && read_plan(call, query, problem) &&
           read_word(call, "room", query->room, sizeof query->room, problem) &&
           read_word(call, "action", query->action, sizeof query->action, problem);
}

static bool wants_lines(const struct call *call, struct problem *problem)
{
    const char *format = call_query(call, "format");
    if (format && strcmp(format, "json") != 0 && strcmp(format, "ndjson") != 0)
        problem_set(problem, PROBLEM_VALIDATION, "/format", "enum", "format is \"%.20s\", expected json or ndjson",
                    format);
    return format && strcmp(format, "ndjson") == 0;
}

/* The text of a row as an object that also has its hash; for free(). */
static char *row_with_hash(const struct store_audit_row *row)
{
    const size_t n = strlen(row->text), size = n + STORE_AUDIT_HASH + 64;
    char *text = mem_array(size, 1, MAX_LINES_BYTES, NULL);
    if (text && row->is_json && n > 2 && row->text[n - 1] == '}')
        (void)snprintf(text, size, "%.*s,\"sha256\":\"%s\"}", (int)n - 1, row->text, row->hash);
    else if (text)
        (void)snprintf(text, size, "{\"n\":%lld,\"damaged\":true,\"sha256\":\"%s\"}", (long long)row->n, row->hash);
    return text;
}

static void answer_page(struct call *call, const struct store_audit_row *rows, size_t n, int64_t next_n)
{
    cJSON *answer = cJSON_CreateObject(), *list = cJSON_AddArrayToObject(answer, "rows");
    char cursor[24];
    for (size_t i = 0; i < n; i++) {
        char *text = row_with_hash(&rows[i]);
        json_append(list, cJSON_CreateRaw(text));
        free(text);
    }
    (void)snprintf(cursor, sizeof cursor, "%lld", (long long)next_n);
    json_add(answer, "next", next_n ? cJSON_CreateString(cursor) : cJSON_CreateNull());
    call_answer_json(call, 200, answer);
}

/* One row a line, each with the hash before it: whatever rows are left out, each can be checked, and those that follow
 * each other as a chain. */
static void answer_lines(struct call *call, const struct store_audit_row *rows, size_t n, int64_t next_n)
{
    static const char form[] = "{\"before\":\"%s\",\"sha256\":\"%s\",\"row\":%s}\n";
    struct problem problem;
    char cursor[24];
    size_t size = 1, at = 0;
    for (size_t i = 0; i < n; i++)
        size += sizeof form + 2 * (size_t)STORE_AUDIT_HASH + strlen(rows[i].text);
    char *text = mem_array(size, 1, MAX_LINES_BYTES, NULL);
    if (!text) {
        problem_set(&problem, PROBLEM_MEMORY, "", "", "no memory for records");
        call_answer_problem(call, &problem);
        return;
    }
    for (size_t i = 0; i < n; i++)
        at += (size_t)snprintf(text + at, size - at, form, rows[i].before, rows[i].hash,
                               rows[i].is_json ? rows[i].text : "null");
    (void)snprintf(cursor, sizeof cursor, "%lld", (long long)next_n);
    if (next_n)
        call_add_header(call, "Audit-Next", cursor);
    call_answer_bytes(call, 200, "application/x-ndjson", (uint8_t *)text, at);
}

static void was_read(void *context, const struct store_audit_row *rows, size_t n, int64_t next_n,
                     const struct problem *problem)
{
    struct call *call = context;
    struct problem ignored;
    if (problem)
        call_answer_problem(call, problem);
    else if (wants_lines(call, &ignored))
        answer_lines(call, rows, n, next_n);
    else
        answer_page(call, rows, n, next_n);
}

/* Rights were asked of one who has signed in. Everybody who can reach a server where nobody signs in counts
 * as the same person. */
static bool may_read(const struct api *api, const struct call *call, struct problem *problem)
{
    return call->identity.source != IDENTITY_MACHINE || api_is_of_this_machine(api, call) ||
           problem_set(problem, PROBLEM_FORBIDDEN, "", "audit",
                       "the audit is given only to the person at the server's own machine (a listener on 127.0.0.1 or "
                       "[::1], without --open-to-everybody), as nobody signs in here");
}

void api_audit(struct api *api, struct call *call)
{
    struct store_audit_query query;
    struct problem problem = { 0 };
    const bool is_export = wants_lines(call, &problem);
    if (problem.type != PROBLEM_NONE || !may_read(api, call, &problem) || !read_query(call, &query, &problem)) {
        call_answer_problem(call, &problem);
        return;
    }
    if (is_export && !api_audit_export(api, call, "audit"))
        return;
    if (!net_read_audit(api->net, &query, was_read, call, &problem))
        call_answer_problem(call, &problem);
}
