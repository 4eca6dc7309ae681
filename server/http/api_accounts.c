/* Users and tokens, for administrators. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/http/api_handlers.h"
#include "server/http/api_passwords.h"
#include "server/http/call.h"

#define DAY_MS (INT64_C(24) * 60 * 60 * 1000)

static void record(struct api *api, const struct call *call, const char *action, const char *name, const char *value)
{
    cJSON *detail = cJSON_CreateObject();
    cJSON_AddStringToObject(detail, name, value);
    net_audit_by(api->net, &call->identity, call->client, "", "", action, detail);
}

static void add_time(cJSON *json, const char *name, int64_t ms)
{
    if (ms)
        cJSON_AddNumberToObject(json, name, (double)ms);
    else
        cJSON_AddNullToObject(json, name);
}

/* A list whose entries end with this character, the last one perhaps not. */
static cJSON *list_json(const char *text, char end)
{
    cJSON *list = cJSON_CreateArray();
    const char ends[] = { end, 0 };
    while (*text) {
        const size_t n = strcspn(text, ends);
        char entry[1025];
        (void)snprintf(entry, sizeof entry, "%.*s", (int)(n < sizeof entry ? n : sizeof entry - 1), text);
        if (n)
            cJSON_AddItemToArray(list, cJSON_CreateString(entry));
        text += n + (text[n] != 0);
    }
    return list;
}

/* The body's list of texts of a field, each ended by '\n'. */
static bool read_list(const cJSON *list, const char *pointer, char *text, size_t size, struct problem *problem)
{
    size_t used = 0;
    const cJSON *item;
    text[0] = 0;
    if (list && !cJSON_IsArray(list))
        return problem_set(problem, PROBLEM_VALIDATION, pointer, "type", "%s must be a list of texts", pointer + 1);
    cJSON_ArrayForEach(item, list)
    {
        if (!cJSON_IsString(item) || !item->valuestring[0] || strchr(item->valuestring, '\n'))
            return problem_set(problem, PROBLEM_VALIDATION, pointer, "type", "%s must be a list of texts", pointer + 1);
        const size_t n = strlen(item->valuestring);
        if (used + n + 2 > size)
            return problem_set(problem, PROBLEM_VALIDATION, pointer, "length", "%s has more than %zu bytes in all",
                               pointer + 1, size - 1);
        memcpy(text + used, item->valuestring, n);
        text[used + n] = '\n';
        text[used += n + 1] = 0;
    }
    return true;
}

static void no_memory(struct call *call, const char *what)
{
    struct problem problem;
    (void)json_no_memory(&problem, what);
    call_answer_problem(call, &problem);
}

/* ---- users ------------------------------------------------------------------------------------------------------ */

static cJSON *user_json(const struct store_user *user)
{
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "user", user->id);
    cJSON_AddStringToObject(json, "name", user->name);
    json_add(json, "groups", list_json(user->groups, '\n'));
    cJSON_AddBoolToObject(json, "is_disabled", user->is_disabled);
    cJSON_AddNumberToObject(json, "failed", (double)user->n_failed);
    add_time(json, "locked_until_ms", user->locked_until_ms);
    cJSON_AddNumberToObject(json, "created_ms", (double)user->created_ms);
    return json;
}

void api_users(struct api *api, struct call *call)
{
    size_t n;
    if (!api_may_sign_in(api, call, false))
        return;
    struct store_user *users = auth_users(api->auth, &n);
    if (!users) {
        no_memory(call, "the list of users");
        return;
    }
    cJSON *answer = cJSON_CreateObject(), *list = cJSON_CreateArray();
    for (size_t i = 0; i < n; i++)
        cJSON_AddItemToArray(list, user_json(&users[i]));
    free(users);
    json_add(answer, "users", list);
    call_answer_json(call, 200, answer);
}

static void answer_done(struct api_waiting *waiting, const char *action)
{
    if (waiting->answer.problem.type != PROBLEM_NONE) {
        call_answer_problem(waiting->call, &waiting->answer.problem);
        return;
    }
    record(waiting->api, waiting->call, action, "user", waiting->user);
    net_accounts_changed(waiting->api->net);
    call_answer_nothing(waiting->call, 204);
}

static void user_added(struct api_waiting *waiting)
{
    answer_done(waiting, "user-added");
}

static void password_set(struct api_waiting *waiting)
{
    answer_done(waiting, "user-password");
}

static bool ask_user_add(struct api_waiting *waiting, const struct api_text *texts, struct problem *problem)
{
    return auth_user_add(waiting->api->auth, texts[0].value, texts[1].value, texts[3].value, texts[2].value, api_waited,
                         waiting, problem);
}

void api_user_add(struct api *api, struct call *call)
{
    struct api_text texts[] = {
        { .name = "user" }, { .name = "name" }, { .name = "password" }, { .name = "groups", .is_optional = true }
    };
    api_ask_passwords(api, call, texts, 4, &(struct api_asking){ ask_user_add, user_added });
}

static bool ask_user_password(struct api_waiting *waiting, const struct api_text *texts, struct problem *problem)
{
    return auth_user_password(waiting->api->auth, texts[0].value, texts[1].value, api_waited, waiting, problem);
}

void api_user_password(struct api *api, struct call *call)
{
    struct api_text texts[] = { { .name = "user" }, { .name = "password" } };
    api_ask_passwords(api, call, texts, 2, &(struct api_asking){ ask_user_password, password_set });
}

void api_user_disable(struct api *api, struct call *call)
{
    static const char *const media_types[] = { "application/json", NULL };
    struct problem problem = { 0 };
    cJSON *body;
    if (!api_may_sign_in(api, call, false) || !call_read_object(call, media_types, &body))
        return;
    const char *user = json_text(body, "user");
    const cJSON *is_disabled = cJSON_GetObjectItemCaseSensitive(body, "is_disabled");
    bool ok = true;
    if (!user)
        ok = problem_set(&problem, PROBLEM_VALIDATION, "/user", "required", "\"%.60s\" is missing", "user");
    else if (!cJSON_IsBool(is_disabled))
        ok = problem_set(&problem, PROBLEM_VALIDATION, "/is_disabled", "type", "is_disabled must be true or false");
    ok = ok && auth_user_disable(api->auth, user, cJSON_IsTrue(is_disabled), &problem);
    if (ok)
        record(api, call, cJSON_IsTrue(is_disabled) ? "user-disabled" : "user-enabled", "user", user);
    cJSON_Delete(body);
    net_accounts_changed(api->net);
    if (ok)
        call_answer_nothing(call, 204);
    else
        call_answer_problem(call, &problem);
}

/* ---- tokens ----------------------------------------------------------------------------------------------------- */

static cJSON *token_json(const struct store_token *token)
{
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "id", token->id);
    cJSON_AddStringToObject(json, "user", token->user);
    cJSON_AddStringToObject(json, "name", token->name);
    json_add(json, "scope", list_json(token->scope, ' '));
    json_add(json, "folders", list_json(token->folders, '\n'));
    cJSON_AddNumberToObject(json, "created_ms", (double)token->created_ms);
    cJSON_AddNumberToObject(json, "expires_ms", (double)token->expires_ms);
    add_time(json, "used_ms", token->used_ms);
    add_time(json, "revoked_ms", token->revoked_ms);
    return json;
}

void api_tokens(struct api *api, struct call *call)
{
    size_t n;
    if (!api_may_sign_in(api, call, false))
        return;
    struct store_token *tokens = auth_tokens(api->auth, &n);
    if (!tokens) {
        no_memory(call, "the list of tokens");
        return;
    }
    cJSON *answer = cJSON_CreateObject(), *list = cJSON_CreateArray();
    for (size_t i = 0; i < n; i++)
        cJSON_AddItemToArray(list, token_json(&tokens[i]));
    free(tokens);
    json_add(answer, "tokens", list);
    call_answer_json(call, 200, answer);
}

struct wanted_texts {
    char user[IDENTITY_MAX_USER + 2], name[IDENTITY_MAX_NAME + 2], scope[80], folders[1024];
};

static bool read_token(const cJSON *body, struct wanted_texts *texts, struct auth_token_wanted *wanted,
                       struct problem *problem)
{
    static const char *const known[] = { "user", "name", "scope", "folders", "days" };
    char pointer[64];
    for (const cJSON *item = body->child; item; item = item->next) {
        size_t i = 0;
        while (i < sizeof known / sizeof known[0] && strcmp(known[i], item->string) != 0)
            i++;
        (void)snprintf(pointer, sizeof pointer, "/%.60s", item->string);
        if (i == sizeof known / sizeof known[0])
            return problem_set(problem, PROBLEM_VALIDATION, pointer, "unknown-field", "%.60s is not a field of it",
                               item->string);
    }
    const double days = json_number(body, "days", 0);
    json_put_text(texts->user, sizeof texts->user, body, "user");
    json_put_text(texts->name, sizeof texts->name, body, "name");
    if (!read_list(cJSON_GetObjectItemCaseSensitive(body, "scope"), "/scope", texts->scope, sizeof texts->scope,
                   problem) ||
        !read_list(cJSON_GetObjectItemCaseSensitive(body, "folders"), "/folders", texts->folders, sizeof texts->folders,
                   problem))
        return false;
    for (char *at = texts->scope; *at; at++)
        if (*at == '\n')
            *at = ' ';
    *wanted = (struct auth_token_wanted){ .user = texts->user, .name = texts->name, .folders = texts->folders };
    if (!auth_scopes_read(texts->scope, &wanted->scopes))
        wanted->scopes = 0; /* refused with the others' sentence */
    wanted->lasts_ms = days >= 1 && days <= 366 && days == floor(days) ? (int64_t)days * DAY_MS : 0;
    return true;
}

void api_token_make(struct api *api, struct call *call)
{
    static const char *const media_types[] = { "application/json", NULL };
    struct problem problem = { 0 };
    struct wanted_texts texts;
    struct auth_token_wanted wanted;
    struct store_token made;
    char token[AUTH_TOKEN_TEXT];
    cJSON *body;
    if (!api_may_sign_in(api, call, true) || !call_read_object(call, media_types, &body))
        return;
    const bool is_made =
        read_token(body, &texts, &wanted, &problem) && auth_token_create(api->auth, &wanted, token, &made, &problem);
    cJSON_Delete(body);
    if (!is_made) {
        call_answer_problem(call, &problem);
        return;
    }
    record(api, call, "token-made", "token", made.id);
    cJSON *answer = token_json(&made);
    cJSON_AddStringToObject(answer, "token", token);
    auth_wipe(token, sizeof token);
    call_answer_json(call, 201, answer);
}

void api_token_revoke(struct api *api, struct call *call)
{
    struct problem problem = { 0 };
    if (!api_may_sign_in(api, call, false))
        return;
    if (!auth_token_revoke(api->auth, call->ids[0], &problem)) {
        call_answer_problem(call, &problem);
        return;
    }
    record(api, call, "token-revoked", "token", call->ids[0]);
    net_accounts_changed(api->net);
    call_answer_nothing(call, 204);
}
