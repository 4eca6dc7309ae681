/* Finding accounts, and writing those that changed. */
#include "server/auth/auth_state.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/auth/words.h"

enum { MAX_UNWRITTEN = 4096 };

int64_t auth_now_ms(const struct auth *auth)
{
    return auth->options.now_ms ? auth->options.now_ms() : clock_wall_ms();
}

/* FNV-1a */
size_t auth_bucket(const char *id)
{
    uint32_t hash = 2166136261U;
    for (; *id; id++)
        hash = (hash ^ (unsigned char)*id) * 16777619U;
    return hash % AUTH_BUCKETS;
}

struct user *auth_find_user(struct auth *auth, const char *id)
{
    struct user *user = auth->users[auth_bucket(id)];
    while (user && strcmp(user->row.id, id) != 0)
        user = user->next;
    return user;
}

bool auth_user_is_disabled(struct auth *auth, const char *id)
{
    const struct user *user = auth_find_user(auth, id);
    return user && user->row.is_disabled;
}

bool auth_user_is_admin(struct auth *auth, const char *id)
{
    const struct user *user = auth_find_user(auth, id);
    return user && !user->row.is_disabled && words_has(user->row.groups, AUTH_ADMIN_GROUP);
}

void auth_user_put(struct auth *auth, const struct store_user *row)
{
    struct user *user = mem_new(sizeof *user);
    const size_t bucket = auth_bucket(row->id);
    *user = (struct user){ .next = auth->users[bucket], .row = *row };
    auth->users[bucket] = user;
    auth->n_users++;
}

void auth_owner_put(struct auth *auth, const struct store_owner *row)
{
    struct owner *owner = mem_new(sizeof *owner);
    const size_t bucket = auth_bucket(row->plan);
    *owner = (struct owner){ .next = auth->owners[bucket], .row = *row };
    auth->owners[bucket] = owner;
}

/* ---- to the store ----------------------------------------------------------------------------------------------- */

void auth_flush(struct auth *auth)
{
    while (auth->store && auth->unwritten && store_write_accounts(auth->store, auth->unwritten->accounts, 0)) {
        struct unwritten *written = auth->unwritten;
        auth->unwritten = written->next;
        auth->n_unwritten--;
        free(written);
    }
    if (!auth->unwritten)
        auth->last_unwritten = &auth->unwritten;
}

/* Takes accounts. */
static void write_accounts(struct auth *auth, struct store_accounts *accounts)
{
    auth_flush(auth);
    if (auth->store && !auth->unwritten && store_write_accounts(auth->store, accounts, 0))
        return;
    if (!auth->store || auth->n_unwritten >= MAX_UNWRITTEN) {
        if (auth->store)
            log_error("a change of accounts is lost at the next start: the disk has too much to do");
        store_accounts_free(accounts);
        return;
    }
    struct unwritten *waiting = mem_new(sizeof *waiting);
    *waiting = (struct unwritten){ .accounts = accounts };
    *auth->last_unwritten = waiting;
    auth->last_unwritten = &waiting->next;
    auth->n_unwritten++;
}

void auth_write_user(struct auth *auth, const struct user *user)
{
    struct store_accounts *accounts = mem_new(sizeof *accounts);
    accounts->users = mem_new(sizeof *accounts->users);
    accounts->users[accounts->n_users++] = user->row;
    write_accounts(auth, accounts);
}

void auth_write_token(struct auth *auth, const struct store_token *row)
{
    struct store_accounts *accounts = mem_new(sizeof *accounts);
    accounts->tokens = mem_new(sizeof *accounts->tokens);
    accounts->tokens[accounts->n_tokens++] = *row;
    write_accounts(auth, accounts);
}

void auth_write_session(struct auth *auth, const struct store_session *row)
{
    struct store_accounts *accounts = mem_new(sizeof *accounts);
    accounts->sessions = mem_new(sizeof *accounts->sessions);
    accounts->sessions[accounts->n_sessions++] = *row;
    write_accounts(auth, accounts);
}

void auth_write_owner(struct auth *auth, const struct store_owner *row)
{
    struct store_accounts *accounts = mem_new(sizeof *accounts);
    accounts->owners = mem_new(sizeof *accounts->owners);
    accounts->owners[accounts->n_owners++] = *row;
    write_accounts(auth, accounts);
}

bool auth_can_keep(const struct auth *auth, struct problem *problem)
{
    if (auth->is_loaded && !auth->store_fails)
        return true;
    problem_set(problem, PROBLEM_STORAGE, "", "write", "the server cannot write to its disk, its log says why");
    problem->retry_after_ms = 10000;
    return false;
}
