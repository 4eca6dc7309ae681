/* Life of the accounts in memory, and what is loaded. */
#include "server/auth/auth.h"

#include <sodium.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "server/auth/auth_state.h"

bool auth_is_local(const struct auth *auth)
{
    return auth->options.is_local;
}

bool auth_is_proxied(const struct auth *auth)
{
    return auth->options.is_proxied;
}

void auth_attach(struct auth *auth, struct store *store)
{
    lock_hold(auth->lock);
    auth->store = store;
    lock_release(auth->lock);
}

void auth_store_fails(struct auth *auth, bool fails)
{
    lock_hold(auth->lock);
    auth->store_fails = fails;
    lock_release(auth->lock);
}

/* ---- from the store --------------------------------------------------------------------------------------------- */

static void read_all(struct auth *auth, const struct store_accounts *accounts)
{
    for (size_t i = 0; i < accounts->n_users; i++)
        if (!auth_find_user(auth, accounts->users[i].id))
            auth_user_put(auth, &accounts->users[i]);
    for (size_t i = 0; i < accounts->n_tokens; i++) {
        struct token *token = mem_new(sizeof *token);
        token->row = accounts->tokens[i];
        auth_token_add(auth, token);
    }
    for (size_t i = 0; i < accounts->n_sessions; i++) {
        struct session *session = mem_new(sizeof *session);
        auth_session_fill(session, &accounts->sessions[i]);
        auth_session_add(auth, session);
    }
    for (size_t i = 0; i < accounts->n_owners; i++)
        auth_owner_put(auth, &accounts->owners[i]);
}

static void write_all(struct auth *auth)
{
    for (size_t i = 0; i < AUTH_BUCKETS; i++) {
        for (const struct user *user = auth->users[i]; user; user = user->next)
            auth_write_user(auth, user);
        for (const struct token *token = auth->tokens[i]; token; token = token->next)
            auth_write_token(auth, &token->row);
        for (const struct session *session = auth->sessions[i]; session; session = session->next)
            auth_write_session(auth, &session->row);
        for (const struct owner *owner = auth->owners[i]; owner; owner = owner->next)
            auth_write_owner(auth, &owner->row);
    }
}

void auth_load(struct auth *auth, const struct store_accounts *accounts, bool is_new)
{
    lock_hold(auth->lock);
    if (is_new)
        write_all(auth);
    else if (!auth->is_loaded && accounts)
        read_all(auth, accounts);
    auth->is_loaded = true;
    lock_release(auth->lock);
}

void auth_tick(struct auth *auth)
{
    lock_hold(auth->lock);
    const int64_t now_ms = auth_now_ms(auth);
    auth_sessions_tick(auth, now_ms);
    auth_tokens_tick(auth, now_ms);
    auth_flush(auth);
    lock_release(auth->lock);
}

void auth_wipe(void *secret, size_t n)
{
    sodium_memzero(secret, n);
}

/* ---- life ------------------------------------------------------------------------------------------------------- */

struct auth *auth_create(const struct auth_options *options, struct error *err)
{
    if (sodium_init() < 0) {
        error_set(err, ERROR_STATE, "libsodium does not start");
        return NULL;
    }
    struct auth *auth = mem_array(1, sizeof *auth, 1 << 20, err);
    if (!auth)
        return NULL;
    auth->options = *options;
    if (!auth->options.idle_ms)
        auth->options.idle_ms = AUTH_IDLE_MS;
    if (!auth->options.total_ms)
        auth->options.total_ms = AUTH_TOTAL_MS;
    auth->last_unwritten = &auth->unwritten;
    auth->lock = lock_create();
    auth->throttle = throttle_create();
    if (auth->throttle && auth_passwords_start(auth, err))
        return auth;
    if (!auth->throttle)
        error_set(err, ERROR_MEMORY, "no memory for the table of failed sign-ins");
    auth_destroy(auth);
    return NULL;
}

void auth_destroy(struct auth *auth)
{
    if (!auth)
        return;
    auth_close(auth);
    for (size_t i = 0; i < AUTH_BUCKETS; i++) {
        for (struct user *user; (user = auth->users[i]); free(user))
            auth->users[i] = user->next;
        for (struct token *token; (token = auth->tokens[i]); free(token))
            auth->tokens[i] = token->next;
        for (struct session *session; (session = auth->sessions[i]); free(session))
            auth->sessions[i] = session->next;
        for (struct owner *owner; (owner = auth->owners[i]); free(owner))
            auth->owners[i] = owner->next;
    }
    for (struct unwritten *waiting; (waiting = auth->unwritten); free(waiting)) {
        auth->unwritten = waiting->next;
        store_accounts_free(waiting->accounts);
    }
    queue_destroy(auth->jobs);
    throttle_destroy(auth->throttle);
    lock_destroy(auth->lock);
    free(auth);
}
