/* The identity behind a request: of a token, a proxy's headers or a cookie. */
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/auth/auth_state.h"
#include "server/auth/secret.h"
#include "server/auth/words.h"

enum { AUTH_TIME_SLACK_MS = 60000 };

/* Seconds since 1970, as the claim auth_time of OpenID Connect has them; 0: not told, or not yet. */
static int64_t read_auth_time(const char *text, int64_t now_ms)
{
    const size_t n = text ? strspn(text, "0123456789") : 0;
    if (n == 0 || n > 12 || text[n])
        return 0;
    const int64_t ms = strtoll(text, NULL, 10) * 1000;
    return ms <= now_ms + AUTH_TIME_SLACK_MS ? ms : 0;
}

/* Names the sign-in at the proxy: the same for all its requests, where the proxy tells when it was. */
static void name_proxy_session(struct identity *identity)
{
    char text[IDENTITY_MAX_USER + 32];
    unsigned char hash[SECRET_HASH_BYTES];
    (void)snprintf(text, sizeof text, "%s %lld", identity->user, (long long)identity->proved_ms);
    secret_hash(text, hash);
    (void)sodium_bin2hex(identity->session, sizeof identity->session, hash, 8);
}

static bool is_of(const struct proof *proof, const char *user, const char *address)
{
    return strcmp(proof->user, user) == 0 && strcmp(proof->address, address) == 0;
}

/* A WebSocket keeps the headers of its handshake, so a later sign-in shows in other requests alone. */
static void note_proof(struct auth *auth, const struct identity *identity, const char *address)
{
    struct proof *proof = &auth->proofs[auth_bucket(identity->user)];
    if (!identity->proved_ms || (is_of(proof, identity->user, address) && proof->proved_ms >= identity->proved_ms))
        return;
    *proof = (struct proof){ .proved_ms = identity->proved_ms };
    (void)snprintf(proof->user, sizeof proof->user, "%s", identity->user);
    (void)snprintf(proof->address, sizeof proof->address, "%s", address);
}

static bool identify_proxied(struct auth *auth, const struct credentials *credentials, struct identity *identity,
                             struct problem *problem)
{
    const int64_t now_ms = auth_now_ms(auth);
    if (!words_are_id(credentials->user))
        return problem_set(problem, PROBLEM_VALIDATION, "/user", "pattern",
                           "the proxy's name of the user must have 1 to %d bytes of UTF-8, without spaces",
                           IDENTITY_MAX_USER);
    (void)snprintf(identity->user, sizeof identity->user, "%s", credentials->user);
    if (credentials->name && credentials->name[0]) {
        words_cut(identity->name, credentials->name, IDENTITY_MAX_NAME);
        if (!words_are_printable(identity->name, IDENTITY_MAX_NAME))
            return problem_set(problem, PROBLEM_VALIDATION, "/name", "pattern",
                               "the proxy's name of the person must be UTF-8 without control characters");
    }
    if (!words_read_groups(credentials->groups ? credentials->groups : "", identity, problem))
        return false;
    if (auth_user_is_disabled(auth, identity->user)) {
        *identity = (struct identity){ .source = IDENTITY_NOBODY };
        return true;
    }
    identity->source = IDENTITY_PROXY;
    identity->scopes = IDENTITY_SCOPE_ALL;
    identity->proved_ms = read_auth_time(credentials->auth_time, now_ms);
    identity->ends_ms = now_ms + auth->options.total_ms;
    name_proxy_session(identity);
    note_proof(auth, identity, credentials->address ? credentials->address : "");
    return true;
}

static bool identify(struct auth *auth, const struct credentials *credentials, struct identity *identity,
                     struct problem *problem)
{
    if (credentials->is_control || (!auth->options.is_local && !auth->options.is_proxied)) {
        identity->source = IDENTITY_MACHINE;
        identity->scopes = IDENTITY_SCOPE_ALL;
        return true;
    }
    const int found =
        credentials->authorization ? auth_token_of_header(auth, credentials->authorization, identity, problem) : 0;
    if (found != 0)
        return found > 0;
    if (auth->options.is_proxied && credentials->is_from_proxy && credentials->user && credentials->user[0])
        return identify_proxied(auth, credentials, identity, problem);
    struct session *session = auth->options.is_local && credentials->cookie
                                  ? auth_session_of_cookie(auth, credentials->cookie, credentials->is_https)
                                  : NULL;
    if (session)
        auth_session_identity(auth, session, identity);
    return true;
}

bool auth_identify(struct auth *auth, const struct credentials *credentials, struct identity *identity,
                   struct problem *problem)
{
    *identity = (struct identity){ .source = IDENTITY_NOBODY };
    lock_hold(auth->lock);
    const bool is_known = identify(auth, credentials, identity, problem);
    lock_release(auth->lock);
    identity->is_private = credentials->is_secure;
    (void)snprintf(identity->address, sizeof identity->address, "%s", credentials->address ? credentials->address : "");
    return is_known;
}

/* True if the user's groups are those that the identity was given. */
static bool has_same_groups(const struct user *user, const struct identity *identity)
{
    struct identity now = { .n_groups = 0 };
    words_copy_groups(user->row.groups, &now);
    if (now.n_groups != identity->n_groups)
        return false;
    for (size_t i = 0; i < now.n_groups; i++)
        if (strcmp(now.groups[i], identity->groups[i]) != 0)
            return false;
    return true;
}

static bool is_still(struct auth *auth, struct identity *identity, int64_t now_ms)
{
    if (identity->source == IDENTITY_NOBODY || identity->source == IDENTITY_MACHINE)
        return true;
    if (identity->source == IDENTITY_PROXY) {
        const struct proof *proof = &auth->proofs[auth_bucket(identity->user)];
        if (is_of(proof, identity->user, identity->address) && proof->proved_ms > identity->proved_ms)
            identity->proved_ms = proof->proved_ms;
        return now_ms < identity->ends_ms && !auth_user_is_disabled(auth, identity->user);
    }
    if (identity->source == IDENTITY_TOKEN) {
        const struct token *token = auth_find_token(auth, identity->session);
        return token && auth_token_is_alive(auth, token, now_ms);
    }
    const struct session *session = auth_find_session(auth, identity->session);
    const struct user *user = auth_find_user(auth, identity->user);
    if (session)
        identity->proved_ms = session->row.proved_ms;
    return session && user && auth_session_is_alive(auth, session, now_ms) && has_same_groups(user, identity);
}

bool auth_is_still(struct auth *auth, struct identity *identity)
{
    lock_hold(auth->lock);
    const bool is_good = is_still(auth, identity, auth_now_ms(auth));
    lock_release(auth->lock);
    return is_good;
}

bool auth_return_is_own(const char *path)
{
    if (path[0] != '/' || path[1] == '/')
        return false;
    for (const char *at = path; *at; at++)
        if ((unsigned char)*at < 32 || *at == 127 || *at == '\\')
            return false;
    return true;
}
