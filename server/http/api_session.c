/* Signing in and out, and the state of a sign-in. */
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "core/base/clock.h"
#include "server/http/api_handlers.h"
#include "server/http/api_passwords.h"
#include "server/http/call.h"

static const char *const source_words[] = { "nobody", "machine", "password", "proxy", "token" };

static void add_time(cJSON *json, const char *name, int64_t ms)
{
    if (ms)
        cJSON_AddNumberToObject(json, name, (double)ms);
    else
        cJSON_AddNullToObject(json, name);
}

static cJSON *identity_json(const struct identity *identity)
{
    cJSON *json = cJSON_CreateObject(), *groups = cJSON_CreateArray();
    cJSON_AddStringToObject(json, "user", identity->user);
    cJSON_AddStringToObject(json, "name", identity->name);
    for (size_t i = 0; i < identity->n_groups; i++)
        cJSON_AddItemToArray(groups, cJSON_CreateString(identity->groups[i]));
    json_add(json, "groups", groups);
    cJSON_AddStringToObject(json, "source", source_words[identity->source]);
    add_time(json, "proved_ms", identity->proved_ms);
    return json;
}

/* The state of this sign-in, as every call about it answers. */
static cJSON *session_json(struct api *api, const struct identity *identity)
{
    cJSON *json = cJSON_CreateObject(), *ways = cJSON_CreateArray();
    struct auth_times times = { 0 };
    const bool is_local = auth_is_local(api->auth), is_proxied = auth_is_proxied(api->auth);
    const bool is_somebody = identity->source != IDENTITY_NOBODY && identity->source != IDENTITY_MACHINE;
    if (is_local)
        cJSON_AddItemToArray(ways, cJSON_CreateString("local"));
    if (is_proxied)
        cJSON_AddItemToArray(ways, cJSON_CreateString("proxy"));
    json_add(json, "sign_in", ways);
    cJSON_AddBoolToObject(json, "open_to_everybody", api->doors.is_open);
    json_add(json, "identity", is_somebody ? identity_json(identity) : cJSON_CreateNull());
    if (is_somebody)
        auth_session_times(api->auth, identity, &times);
    add_time(json, "idle_ends_ms", times.idle_ends_ms);
    add_time(json, "ends_ms", identity->source == IDENTITY_PROXY ? 0 : times.ends_ms); /* a proxy does not say */
    cJSON_AddBoolToObject(json, "guest_links", net_admits_guests(api->net));
    return json;
}

void api_session(struct api *api, struct call *call)
{
    call_answer_json(call, 200, session_json(api, &call->identity));
}

/* ---- with a password -------------------------------------------------------------------------------------------- */

static void record(struct api *api, const struct call *call, const char *action, const char *user)
{
    cJSON *detail = cJSON_CreateObject();
    cJSON_AddStringToObject(detail, "user", user);
    struct identity who = call->identity;
    if (!who.user[0])
        (void)snprintf(who.user, sizeof who.user, "%s", user);
    net_audit_by(api->net, &who, call->client, "", "", action, detail);
}

/* Records a password that was refused: anybody may send many, so equal ones are one row a minute. user: "" where it is
 * no user's name, so all such of an address are equal. */
static void record_refused(const struct api_waiting *waiting, const char *action, const char *user)
{
    const char *code = waiting->answer.problem.code;
    struct identity who = waiting->call->identity;
    if (!who.user[0])
        (void)snprintf(who.user, sizeof who.user, "%s", user);
    net_audit_often(waiting->api->net, &who, waiting->call->client, "", "", action, code[0] ? code : "not-now", true);
}

static void signed_in(struct api_waiting *waiting)
{
    char cookie[AUTH_MAX_COOKIE];
    struct call *call = waiting->call;
    if (waiting->answer.problem.type != PROBLEM_NONE) {
        /* a name that is no user's may be a password in the wrong field */
        const char *user = auth_has_user(waiting->api->auth, waiting->user) ? waiting->user : "";
        record_refused(waiting, "sign-in-refused", user);
        call_answer_problem(call, &waiting->answer.problem);
        return;
    }
    record(waiting->api, call, "sign-in", waiting->user);
    auth_cookie(waiting->answer.secret, waiting->is_secure_cookie, cookie);
    call_add_header(call, "Set-Cookie", cookie);
    auth_wipe(cookie, sizeof cookie);
    call_answer_json(call, 201, session_json(waiting->api, &waiting->answer.identity));
}

/* Where the way does not say it, as behind a proxy on loopback, the browser says by which scheme the page came. */
static bool is_by_https(const struct call *call)
{
    return call->is_https || (call->origin && strncasecmp(call->origin, "https://", 8) == 0);
}

static bool ask_sign_in(struct api_waiting *waiting, const struct api_text *texts, struct problem *problem)
{
    waiting->is_secure_cookie = is_by_https(waiting->call);
    return auth_sign_in(waiting->api->auth, texts[0].value, texts[1].value, waiting->call->client,
                        waiting->is_secure_cookie, api_waited, waiting, problem);
}

void api_session_begin(struct api *api, struct call *call)
{
    struct api_text texts[] = { { .name = "user" }, { .name = "password" } };
    api_ask_passwords(api, call, texts, 2, &(struct api_asking){ ask_sign_in, signed_in });
}

static void confirmed(struct api_waiting *waiting)
{
    if (waiting->answer.problem.type != PROBLEM_NONE) {
        record_refused(waiting, "confirm-refused", waiting->user);
        call_answer_problem(waiting->call, &waiting->answer.problem);
        return;
    }
    call_answer_json(waiting->call, 200, session_json(waiting->api, &waiting->answer.identity));
}

static bool ask_confirm(struct api_waiting *waiting, const struct api_text *texts, struct problem *problem)
{
    return auth_confirm(waiting->api->auth, &waiting->call->identity, texts[0].value, api_waited, waiting, problem);
}

void api_session_confirm(struct api *api, struct call *call)
{
    struct api_text texts[] = { { .name = "password" } };
    api_ask_passwords(api, call, texts, 1, &(struct api_asking){ ask_confirm, confirmed });
}

static void first_made(struct api_waiting *waiting)
{
    if (waiting->answer.problem.type != PROBLEM_NONE) {
        call_answer_problem(waiting->call, &waiting->answer.problem);
        return;
    }
    record(waiting->api, waiting->call, "user-first", waiting->user);
    call_answer_nothing(waiting->call, 204);
}

static bool ask_first(struct api_waiting *waiting, const struct api_text *texts, struct problem *problem)
{
    return auth_user_first(waiting->api->auth, texts[0].value, texts[1].value, texts[2].value, texts[3].value,
                           api_waited, waiting, problem);
}

void api_session_first(struct api *api, struct call *call)
{
    struct api_text texts[] = { { .name = "token" }, { .name = "user" }, { .name = "name" }, { .name = "password" } };
    api_ask_passwords(api, call, texts, 4, &(struct api_asking){ ask_first, first_made });
}

/* ---- without ---------------------------------------------------------------------------------------------------- */

void api_session_input(struct api *api, struct call *call)
{
    if (call->identity.source == IDENTITY_PASSWORD)
        auth_session_used(api->auth, call->identity.session);
    call_answer_json(call, 200, session_json(api, &call->identity));
}

void api_session_end(struct api *api, struct call *call)
{
    char cookie[AUTH_MAX_COOKIE];
    if (call->identity.source == IDENTITY_PASSWORD) {
        record(api, call, "sign-out", call->identity.user);
        auth_session_end(api->auth, call->identity.session);
        net_session_over(api->net, call->identity.session);
    }
    for (int is_secure = 0; is_secure < 2; is_secure++) {
        auth_cookie("", is_secure, cookie);
        call_add_header(call, "Set-Cookie", cookie);
    }
    call_add_header(call, "Clear-Site-Data", "\"cache\", \"cookies\", \"storage\"");
    call_answer_nothing(call, 204);
}

/* The proxy has signed the person in before it passed this on. */
void api_signin_proxy(struct api *api, struct call *call)
{
    struct problem problem;
    const char *path = call_query(call, "return");
    if (!auth_is_proxied(api->auth)) {
        problem_set(&problem, PROBLEM_NOT_FOUND, "", "", "nobody signs in by a proxy here");
        call_answer_problem(call, &problem);
        return;
    }
    if (path && !auth_return_is_own(path)) {
        problem_set(&problem, PROBLEM_VALIDATION, "/return", "pattern",
                    "the address to return to must be a path of this server");
        call_answer_problem(call, &problem);
        return;
    }
    if (call->identity.source != IDENTITY_PROXY) {
        problem_set(&problem, PROBLEM_SIGN_IN, "", "proxy",
                    "the proxy in front named nobody: it must protect this "
                    "address and say who signed in");
        call_answer_problem(call, &problem);
        return;
    }
    record(api, call, "sign-in", call->identity.user);
    call_add_header(call, "Location", path ? path : "/signin/done");
    call_answer_nothing(call, 303);
}
