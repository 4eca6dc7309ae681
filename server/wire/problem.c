/* Problems to JSON and back, and from errors of core: problem.h. */
#include "server/wire/problem.h"

#include <stdio.h>
#include <string.h>

#include "server/wire/sentence_json.h"

bool problem_set(struct problem *problem, enum problem_type type, const char *pointer, const char *code,
                 const char *format, ...)
{
    if (!problem)
        return false;
    memset(problem, 0, sizeof *problem);
    problem->type = type;
    (void)snprintf(problem->pointer, sizeof problem->pointer, "%s", pointer ? pointer : "");
    (void)snprintf(problem->code, sizeof problem->code, "%s", code ? code : "");
    va_list args;
    va_start(args, format);
    (void)vsnprintf(problem->detail, sizeof problem->detail, format, args);
    va_end(args);
    va_start(args, format);
    sentence_describe(&problem->facts, format, args);
    va_end(args);
    return false;
}

void problem_below(struct problem *problem, const char *prefix)
{
    char pointer[sizeof problem->pointer];
    memcpy(pointer, problem->pointer, sizeof pointer);
    (void)snprintf(problem->pointer, sizeof problem->pointer, "%s%.*s", prefix,
                   (int)(sizeof pointer - strlen(prefix) - 1), pointer);
}

bool problem_from_error(struct problem *problem, const struct error *err)
{
    enum problem_type type = PROBLEM_INTERNAL;
    switch (err->code) {
    case ERROR_NOT_FOUND: type = PROBLEM_NOT_FOUND; break;
    case ERROR_RANGE:
    case ERROR_FORMAT:
    case ERROR_UNSUPPORTED: type = PROBLEM_VALIDATION; break;
    case ERROR_LIMIT: type = PROBLEM_LIMIT; break;
    case ERROR_CANCELLED: type = PROBLEM_CANCELLED; break;
    case ERROR_GL: type = PROBLEM_GL_UNAVAILABLE; break;
    case ERROR_STATE: type = PROBLEM_BUSY; break;
    case ERROR_MEMORY: type = PROBLEM_MEMORY; break;
    case ERROR_NONE:
    case ERROR_IO: break;
    }
    return problem_set(problem, type, "", type == PROBLEM_VALIDATION ? error_word(err->code) : "", "%s", err->text);
}

int problem_status(enum problem_type type)
{
    return (unsigned)type < PROBLEM_N_TYPES ? problem_types[type].status : 500;
}

const char *problem_word(enum problem_type type)
{
    return (unsigned)type < PROBLEM_N_TYPES ? problem_types[type].word : "internal";
}

cJSON *problem_to_json(const struct problem *problem)
{
    enum problem_type type = (unsigned)problem->type < PROBLEM_N_TYPES ? problem->type : PROBLEM_INTERNAL;
    char uri[64];
    (void)snprintf(uri, sizeof uri, "/problems/%s", problem_types[type].word);
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "type", uri);
    cJSON_AddStringToObject(json, "title", problem_types[type].title);
    cJSON_AddNumberToObject(json, "status", problem_types[type].status);
    cJSON_AddStringToObject(json, "detail", problem->detail);
    sentence_add_json(json, "detail", &problem->facts);
    if (problem->pointer[0])
        cJSON_AddStringToObject(json, "pointer", problem->pointer);
    if (problem->code[0])
        cJSON_AddStringToObject(json, "code", problem->code);
    if (problem->retry_after_ms > 0)
        cJSON_AddNumberToObject(json, "retry_after_ms", problem->retry_after_ms);
    return json;
}

static const char *text_of(const cJSON *json, const char *name)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(json, name);
    return cJSON_IsString(item) ? item->valuestring : "";
}

bool problem_from_json(const cJSON *json, struct problem *problem)
{
    static const char prefix[] = "/problems/";
    const char *uri = text_of(json, "type");
    enum problem_type type = PROBLEM_NONE;
    if (strncmp(uri, prefix, sizeof prefix - 1) == 0)
        for (int i = PROBLEM_NONE + 1; i < PROBLEM_N_TYPES; i++)
            if (strcmp(uri + sizeof prefix - 1, problem_types[i].word) == 0)
                type = (enum problem_type)i;
    if (type == PROBLEM_NONE)
        return problem_set(problem, PROBLEM_INTERNAL, "", "", "an answer that is not a problem description");
    (void)problem_set(problem, type, text_of(json, "pointer"), text_of(json, "code"), "%s", text_of(json, "detail"));
    sentence_read_json(json, "detail", &problem->facts);
    const cJSON *retry = cJSON_GetObjectItemCaseSensitive(json, "retry_after_ms");
    if (cJSON_IsNumber(retry) && retry->valuedouble > 0 && retry->valuedouble < 3600000)
        problem->retry_after_ms = (int)retry->valuedouble;
    return true;
}
