/* Bodies with passwords, and their answers. */
#include "server/http/api_passwords.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/http/call.h"

static bool take_text(const cJSON *item, struct api_text *texts, size_t n, struct problem *problem)
{
    char pointer[64];
    size_t i = 0;
    (void)snprintf(pointer, sizeof pointer, "/%.60s", item->string);
    while (i < n && strcmp(texts[i].name, item->string) != 0)
        i++;
    if (i == n)
        return problem_set(problem, PROBLEM_VALIDATION, pointer, "unknown-field", "%.60s is not a field of it",
                           item->string);
    if (texts[i].value)
        return problem_set(problem, PROBLEM_VALIDATION, pointer, "duplicate", "%.60s is there twice", item->string);
    if (!cJSON_IsString(item))
        return problem_set(problem, PROBLEM_VALIDATION, pointer, "type", "%.60s must be a text", item->string);
    texts[i].value = item->valuestring;
    return true;
}

static void finish_texts(cJSON *body)
{
    for (cJSON *item = body->child; item; item = item->next)
        if (cJSON_IsString(item))
            auth_wipe(item->valuestring, strlen(item->valuestring));
    cJSON_Delete(body);
}

/* NULL: the call was answered. The call's own copy of the body is wiped. */
static cJSON *read_texts(struct call *call, struct api_text *texts, size_t n)
{
    static const char *const media_types[] = { "application/json", NULL };
    struct problem problem = { 0 };
    char pointer[64];
    cJSON *body;
    bool is_right = true;
    if (!call_read_object(call, media_types, &body))
        return NULL;
    if (call->body)
        auth_wipe(call->body, call->n_body);
    for (const cJSON *item = body->child; is_right && item; item = item->next)
        is_right = take_text(item, texts, n, &problem);
    for (size_t i = 0; i < n; i++) {
        (void)snprintf(pointer, sizeof pointer, "/%.60s", texts[i].name);
        if (is_right && !texts[i].value && !texts[i].is_optional)
            is_right =
                problem_set(&problem, PROBLEM_VALIDATION, pointer, "required", "\"%.60s\" is missing", texts[i].name);
        if (!texts[i].value)
            texts[i].value = "";
    }
    if (is_right)
        return body;
    finish_texts(body);
    call_answer_problem(call, &problem);
    return NULL;
}

bool api_may_sign_in(struct api *api, struct call *call, bool is_private)
{
    struct problem problem;
    if (!auth_is_local(api->auth) && !auth_is_proxied(api->auth))
        problem_set(&problem, PROBLEM_NOT_FOUND, "", "", "nobody signs in on this server");
    else if (is_private && !call->identity.is_private)
        problem_set(&problem, PROBLEM_FORBIDDEN, "", "private",
                    "a password is taken over TLS, a proxy's socket or loopback alone");
    else
        return true;
    call_answer_problem(call, &problem);
    return false;
}

static void waiting_free(struct api_waiting *waiting)
{
    auth_wipe(waiting, sizeof *waiting);
    free(waiting);
}

static void answer_waiting(struct net *net, void *argument)
{
    struct api_waiting *waiting = argument;
    (void)net;
    waiting->then(waiting);
    waiting_free(waiting);
}

void api_waited(void *context, const struct auth_answer *answer)
{
    struct api_waiting *waiting = context;
    waiting->answer = *answer;
    net_post(waiting->api->net, answer_waiting, waiting);
}

static const char *user_of(const struct call *call, const struct api_text *texts, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (strcmp(texts[i].name, "user") == 0)
            return texts[i].value;
    return call->identity.user;
}

void api_ask_passwords(struct api *api, struct call *call, struct api_text *texts, size_t n,
                       const struct api_asking *asking)
{
    struct problem problem = { 0 };
    if (!api_may_sign_in(api, call, true))
        return;
    cJSON *body = read_texts(call, texts, n);
    if (!body)
        return;
    struct api_waiting *waiting = mem_new(sizeof *waiting);
    waiting->api = api;
    waiting->call = call;
    waiting->then = asking->then;
    mem_put_text(waiting->user, sizeof waiting->user, user_of(call, texts, n));
    const bool was_taken = asking->ask(waiting, texts, &problem);
    finish_texts(body);
    if (was_taken)
        return;
    call_answer_problem(call, &problem);
    waiting_free(waiting);
}
