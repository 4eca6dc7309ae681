/* Fills in, answers and frees one call. */
#include "server/http/call.h"

#include <assert.h>
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "server/wire/origin.h"

struct call_bytes {
    atomic_int references;
    uint8_t *bytes;
    size_t n;
};

struct call_bytes *call_bytes_create(uint8_t *bytes, size_t n)
{
    struct call_bytes *shared = mem_new(sizeof *shared);
    atomic_init(&shared->references, 1);
    shared->bytes = bytes;
    shared->n = n;
    return shared;
}

struct call_bytes *call_bytes_ref(struct call_bytes *shared)
{
    atomic_fetch_add(&shared->references, 1);
    return shared;
}

void call_bytes_unref(void *shared)
{
    struct call_bytes *one = shared;
    if (!one || atomic_fetch_sub(&one->references, 1) > 1)
        return;
    free(one->bytes);
    free(one);
}

size_t call_bytes_size(const struct call_bytes *shared)
{
    return shared->n;
}

struct call *call_create(void)
{
    struct call *call = mem_new(sizeof *call);
    call->started_us = clock_now_us();
    return call;
}

void call_destroy(struct call *call)
{
    if (!call)
        return;
    for (size_t i = 0; i < call->n_segments; i++)
        free(call->segments[i]);
    for (size_t i = 0; i < call->n_query; i++) {
        free(call->query[i].name);
        free(call->query[i].value);
    }
    for (size_t i = 0; i < call->n_headers; i++) {
        free(call->headers[i].name);
        free(call->headers[i].value);
    }
    free(call->if_match);
    free(call->member);
    free(call->key);
    free(call->last_event);
    free(call->if_none_match);
    free(call->content_type);
    free(call->origin);
    free(call->host);
    free(call->fetch_site);
    free(call->body);
    if (call->upload_path)
        (void)unlink(call->upload_path); /* no handler has kept the file */
    free(call->upload_path);
    if (!call->shared)
        free(call->bytes);
    call_bytes_unref(call->shared);
    free(call);
}

void call_set_path(struct call *call, const char *path)
{
    size_t n = strlen(path);
    if (n >= sizeof call->path) {
        problem_set(&call->early, PROBLEM_NOT_FOUND, "", "", "an address of %zu bytes, at most %d are read", n,
                    CALL_MAX_PATH - 1);
        return;
    }
    memcpy(call->path, path, n + 1);
    for (const char *at = path; *at;) {
        at += *at == '/';
        size_t length = strcspn(at, "/");
        if (length == 0 && !at[length])
            break; /* a trailing slash */
        if (call->n_segments == CALL_MAX_SEGMENTS) {
            problem_set(&call->early, PROBLEM_NOT_FOUND, "", "", "an address of more than %d parts", CALL_MAX_SEGMENTS);
            return;
        }
        char *segment = mem_new(length + 1);
        memcpy(segment, at, length);
        call->segments[call->n_segments++] = segment;
        at += length;
    }
}

const char *call_query(const struct call *call, const char *name)
{
    for (size_t i = 0; i < call->n_query; i++)
        if (strcmp(call->query[i].name, name) == 0)
            return call->query[i].value;
    return NULL;
}

static void finish(struct call *call, int status, const char *media_type)
{
    call->status = status;
    (void)snprintf(call->media_type, sizeof call->media_type, "%s", media_type);
    if (call->answering)
        call->answering(call);
    call->finished(call);
}

void call_add_header(struct call *call, const char *name, const char *value)
{
    assert(call->n_headers < CALL_MAX_HEADERS);
    call->headers[call->n_headers++] = (struct call_pair){ mem_copy_text(name), mem_copy_text(value) };
}

static const char no_memory[] = "{\"type\":\"/problems/internal\",\"title\":\"A mistake in the server\",\"status\":500,"
                                "\"detail\":\"no memory for the answer\"}";

void call_answer_json(struct call *call, int status, cJSON *json)
{
    char *text = json_print(json);
    cJSON_Delete(json);
    if (!text) {
        call_answer_bytes(call, 500, "application/problem+json", (uint8_t *)mem_copy_text(no_memory),
                          sizeof no_memory - 1);
        return;
    }
    call->bytes = (uint8_t *)text;
    call->n_bytes = strlen(text);
    finish(call, status, "application/json");
}

void call_answer_problem(struct call *call, const struct problem *problem)
{
    cJSON *json = problem_to_json(problem);
    cJSON_AddStringToObject(json, "instance", call->path);
    char *text = json_print(json);
    cJSON_Delete(json);
    if (!text)
        text = mem_copy_text(no_memory);
    if (problem->retry_after_ms > 0) {
        char seconds[16];
        (void)snprintf(seconds, sizeof seconds, "%d", (problem->retry_after_ms + 999) / 1000);
        call_add_header(call, "Retry-After", seconds);
    }
    if (problem->type == PROBLEM_SIGN_IN)
        call_add_header(call, "WWW-Authenticate", "Bearer realm=\"beamroom\""); /* RFC 9110 15.5.2 */
    call->bytes = (uint8_t *)text;
    call->n_bytes = strlen(text);
    finish(call, problem_status(problem->type), "application/problem+json");
}

void call_answer_bytes(struct call *call, int status, const char *media_type, uint8_t *bytes, size_t n)
{
    call->bytes = bytes;
    call->n_bytes = n;
    finish(call, status, media_type);
}

void call_answer_shared(struct call *call, int status, const char *media_type, struct call_bytes *shared)
{
    call->shared = shared;
    call_answer_bytes(call, status, media_type, shared->bytes, shared->n);
}

void call_answer_text(struct call *call, int status, const char *media_type, const char *text)
{
    call->bytes = (uint8_t *)mem_copy_text(text);
    call->n_bytes = strlen(text);
    finish(call, status, media_type);
}

void call_answer_feed(struct call *call, const char *media_type, struct feed *feed)
{
    call->feed = feed;
    finish(call, 200, media_type);
}

void call_answer_nothing(struct call *call, int status)
{
    finish(call, status, "");
}

bool call_media_type_is(const struct call *call, const char *media_type)
{
    const char *given = call->content_type;
    size_t n = strlen(media_type);
    return given && strncasecmp(given, media_type, n) == 0 && (given[n] == 0 || given[n] == ';' || given[n] == ' ');
}

bool call_origin_is_own(const struct call *call, struct problem *problem)
{
    if (call->method == CALL_GET || call->method == CALL_HEAD)
        return true;
    if (call->origin)
        return origin_is_of_host(call->origin, call->host, call->is_secure) ||
               problem_set(problem, PROBLEM_FORBIDDEN, "", "", "the origin %.100s may not change anything here",
                           call->origin);
    /* browsers that send no Origin send Sec-Fetch-Site; programs send neither */
    return !call->fetch_site || strcmp(call->fetch_site, "same-origin") == 0 || strcmp(call->fetch_site, "none") == 0 ||
           problem_set(problem, PROBLEM_FORBIDDEN, "", "",
                       "a page of another site (Sec-Fetch-Site: %.40s) may not change anything here", call->fetch_site);
}

bool call_read_object(struct call *call, const char *const *media_types, cJSON **object)
{
    struct problem problem;
    const char *const *type = media_types;
    while (*type && !call_media_type_is(call, *type))
        type++;
    if (!*type) {
        problem_set(&problem, PROBLEM_MEDIA_TYPE, "", "", "Content-Type is \"%.60s\", expected %s",
                    call->content_type ? call->content_type : "", media_types[0]);
        call_answer_problem(call, &problem);
        return false;
    }
    *object = json_read(call->body ? call->body : "", call->n_body, &problem);
    if (*object && !cJSON_IsObject(*object)) {
        problem_set(&problem, PROBLEM_VALIDATION, "", "type", "the body must be a JSON object");
        cJSON_Delete(*object);
        *object = NULL;
    }
    if (!*object) {
        call_answer_problem(call, &problem);
        return false;
    }
    return true;
}

bool call_query_number(const struct call *call, const char *name, bool is_required, double *value,
                       struct problem *problem)
{
    char pointer[64];
    (void)snprintf(pointer, sizeof pointer, "/%s", name);
    const char *text = call_query(call, name);
    if (!text)
        return !is_required ||
               problem_set(problem, PROBLEM_VALIDATION, pointer, "required", "the parameter %s is missing", name);
    char *end;
    double number = strtod(text, &end);
    if (end == text || *end || !isfinite(number) || strpbrk(text, "xXnN")) /* no hexadecimal, no "inf" */
        return problem_set(problem, PROBLEM_VALIDATION, pointer, "type",
                           "the parameter %s is \"%.40s\", expected a number", name, text);
    *value = number;
    return true;
}
