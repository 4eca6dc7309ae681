/* The statements that write and read accounts. */
#include "server/store/accounts.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/store/rows.h"
#include "server/store/sql.h"

void store_accounts_free(struct store_accounts *accounts)
{
    if (!accounts)
        return;
    free(accounts->users);
    free(accounts->tokens);
    free(accounts->sessions);
    free(accounts->owners);
    free(accounts);
}

/* ---- writing ---------------------------------------------------------------------------------------------------- */

static bool finish(sqlite3_stmt *row, const char *what, struct error *err)
{
    bool ok = sql_step(row, what, err);
    (void)sqlite3_finalize(row);
    return ok;
}

static bool delete_row(sqlite3 *db, const char *sql, const char *id, struct error *err)
{
    sqlite3_stmt *row = sql_prepare(db, sql, err);
    if (!row)
        return false;
    sql_bind_text(row, 1, id);
    return finish(row, "deleting an account", err);
}

static bool write_groups(sqlite3 *db, const struct store_user *user, struct error *err)
{
    if (!delete_row(db, "DELETE FROM user_groups WHERE user = ?1", user->id, err))
        return false;
    sqlite3_stmt *row = sql_prepare(db, "INSERT OR IGNORE INTO user_groups(user, name) VALUES(?1, ?2)", err);
    bool ok = row != NULL;
    const char *end;
    for (const char *at = user->groups; ok && (end = strchr(at, '\n')); at = end + 1) {
        sql_bind_text(row, 1, user->id);
        (void)sqlite3_bind_text(row, 2, at, (int)(end - at), SQLITE_TRANSIENT);
        ok = sql_step(row, "writing groups", err);
    }
    (void)sqlite3_finalize(row);
    return ok;
}

static bool write_user(sqlite3 *db, const struct store_user *user, struct error *err)
{
    sqlite3_stmt *row =
        sql_prepare(db,
                    "INSERT INTO users(id, name, password, is_disabled, failed, locked_until_ms, created_ms)"
                    " VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7) ON CONFLICT(id) DO UPDATE SET name = ?2, password = ?3,"
                    " is_disabled = ?4, failed = ?5, locked_until_ms = ?6",
                    err);
    if (!row)
        return false;
    sql_bind_text(row, 1, user->id);
    sql_bind_text(row, 2, user->name);
    sql_bind_text(row, 3, user->password);
    (void)sqlite3_bind_int(row, 4, user->is_disabled);
    (void)sqlite3_bind_int64(row, 5, user->n_failed);
    (void)sqlite3_bind_int64(row, 6, user->locked_until_ms);
    (void)sqlite3_bind_int64(row, 7, user->created_ms);
    return finish(row, "writing a user", err) && write_groups(db, user, err);
}

static bool write_token(sqlite3 *db, const struct store_token *token, struct error *err)
{
    if (token->is_deleted)
        return delete_row(db, "DELETE FROM tokens WHERE id = ?1", token->id, err);
    sqlite3_stmt *row = sql_prepare(db,
                                    "INSERT INTO tokens(id, hash, user, name, scope, folders, created_ms, expires_ms,"
                                    " used_ms, revoked_ms) VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10)"
                                    " ON CONFLICT(id) DO UPDATE SET used_ms = ?9, revoked_ms = ?10",
                                    err);
    if (!row)
        return false;
    sql_bind_text(row, 1, token->id);
    (void)sqlite3_bind_blob(row, 2, token->hash, STORE_HASH_BYTES, SQLITE_TRANSIENT);
    sql_bind_text(row, 3, token->user);
    sql_bind_text(row, 4, token->name);
    sql_bind_text(row, 5, token->scope);
    sql_bind_text(row, 6, token->folders);
    (void)sqlite3_bind_int64(row, 7, token->created_ms);
    (void)sqlite3_bind_int64(row, 8, token->expires_ms);
    (void)sqlite3_bind_int64(row, 9, token->used_ms);
    (void)sqlite3_bind_int64(row, 10, token->revoked_ms);
    return finish(row, "writing a token", err);
}

static bool write_session(sqlite3 *db, const struct store_session *session, struct error *err)
{
    sqlite3_stmt *row = sql_prepare(
        db,
        session->is_deleted
            ? "DELETE FROM sessions WHERE hash = ?1"
            : "INSERT INTO sessions(hash, user, name, \"groups\", source, address, created_ms, seen_ms, proved_ms)"
              " VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9) ON CONFLICT(hash) DO UPDATE SET seen_ms = ?8,"
              " proved_ms = ?9",
        err);
    if (!row)
        return false;
    (void)sqlite3_bind_blob(row, 1, session->hash, STORE_HASH_BYTES, SQLITE_TRANSIENT);
    if (!session->is_deleted) {
        sql_bind_text(row, 2, session->user);
        sql_bind_text(row, 3, session->name);
        sql_bind_text(row, 4, session->groups);
        sql_bind_text(row, 5, session->source);
        sql_bind_text(row, 6, session->address);
        (void)sqlite3_bind_int64(row, 7, session->created_ms);
        (void)sqlite3_bind_int64(row, 8, session->seen_ms);
        (void)sqlite3_bind_int64(row, 9, session->proved_ms);
    }
    return finish(row, "writing a session", err);
}

static bool write_owner(sqlite3 *db, const struct store_owner *owner, struct error *err)
{
    if (owner->is_deleted)
        return delete_row(db, "DELETE FROM owners WHERE plan = ?1", owner->plan, err);
    sqlite3_stmt *row =
        sql_prepare(db, "INSERT INTO owners(plan, user) VALUES(?1, ?2) ON CONFLICT(plan) DO UPDATE SET user = ?2", err);
    if (!row)
        return false;
    sql_bind_text(row, 1, owner->plan);
    sql_bind_text(row, 2, owner->user);
    return finish(row, "writing an owner", err);
}

bool accounts_write(sqlite3 *db, const struct store_accounts *accounts, struct error *err)
{
    bool ok = true;
    for (size_t i = 0; ok && i < accounts->n_users; i++)
        ok = write_user(db, &accounts->users[i], err);
    for (size_t i = 0; ok && i < accounts->n_tokens; i++)
        ok = write_token(db, &accounts->tokens[i], err);
    for (size_t i = 0; ok && i < accounts->n_sessions; i++)
        ok = write_session(db, &accounts->sessions[i], err);
    for (size_t i = 0; ok && i < accounts->n_owners; i++)
        ok = write_owner(db, &accounts->owners[i], err);
    return ok;
}

/* ---- reading ---------------------------------------------------------------------------------------------------- */

static void read_hash(sqlite3_stmt *row, int column, unsigned char hash[STORE_HASH_BYTES])
{
    if (sqlite3_column_bytes(row, column) == STORE_HASH_BYTES)
        memcpy(hash, sqlite3_column_blob(row, column), STORE_HASH_BYTES);
}

static bool read_user(sqlite3_stmt *row, void *to)
{
    struct store_user *user = to;
    sql_text(row, 0, user->id, sizeof user->id);
    sql_text(row, 1, user->name, sizeof user->name);
    sql_text(row, 2, user->password, sizeof user->password);
    user->is_disabled = sqlite3_column_int(row, 3) != 0;
    user->n_failed = sqlite3_column_int64(row, 4);
    user->locked_until_ms = sqlite3_column_int64(row, 5);
    user->created_ms = sqlite3_column_int64(row, 6);
    sql_text(row, 7, user->groups, sizeof user->groups);
    return true;
}

static bool read_token(sqlite3_stmt *row, void *to)
{
    struct store_token *token = to;
    sql_text(row, 0, token->id, sizeof token->id);
    read_hash(row, 1, token->hash);
    sql_text(row, 2, token->user, sizeof token->user);
    sql_text(row, 3, token->name, sizeof token->name);
    sql_text(row, 4, token->scope, sizeof token->scope);
    sql_text(row, 5, token->folders, sizeof token->folders);
    token->created_ms = sqlite3_column_int64(row, 6);
    token->expires_ms = sqlite3_column_int64(row, 7);
    token->used_ms = sqlite3_column_int64(row, 8);
    token->revoked_ms = sqlite3_column_int64(row, 9);
    return true;
}

static bool read_session(sqlite3_stmt *row, void *to)
{
    struct store_session *session = to;
    read_hash(row, 0, session->hash);
    sql_text(row, 1, session->user, sizeof session->user);
    sql_text(row, 2, session->name, sizeof session->name);
    sql_text(row, 3, session->groups, sizeof session->groups);
    sql_text(row, 4, session->source, sizeof session->source);
    sql_text(row, 5, session->address, sizeof session->address);
    session->created_ms = sqlite3_column_int64(row, 6);
    session->seen_ms = sqlite3_column_int64(row, 7);
    session->proved_ms = sqlite3_column_int64(row, 8);
    return true;
}

static bool read_owner(sqlite3_stmt *row, void *to)
{
    struct store_owner *owner = to;
    sql_text(row, 0, owner->plan, sizeof owner->plan);
    sql_text(row, 1, owner->user, sizeof owner->user);
    return true;
}

struct store_accounts *accounts_read(sqlite3 *db, struct error *err)
{
    struct store_accounts *all = mem_new(sizeof *all);
    void *users = NULL, *tokens = NULL, *sessions = NULL, *owners = NULL;
    bool ok =
        rows_read_list(db,
                       "SELECT id, name, password, is_disabled, failed, locked_until_ms, created_ms,"
                       " (SELECT group_concat(name || char(10), '') FROM (SELECT name FROM user_groups"
                       " WHERE user = users.id ORDER BY name)) FROM users ORDER BY id",
                       NULL, sizeof(struct store_user), STORE_MAX_ACCOUNTS, read_user, &users, &all->n_users, err) &&
        rows_read_list(db,
                       "SELECT id, hash, user, name, scope, folders, created_ms, expires_ms, used_ms, revoked_ms"
                       " FROM tokens ORDER BY created_ms DESC, id",
                       NULL, sizeof(struct store_token), STORE_MAX_ACCOUNTS, read_token, &tokens, &all->n_tokens,
                       err) &&
        rows_read_list(db,
                       "SELECT hash, user, name, \"groups\", source, address, created_ms, seen_ms, proved_ms"
                       " FROM sessions ORDER BY seen_ms DESC",
                       NULL, sizeof(struct store_session), STORE_MAX_ACCOUNTS, read_session, &sessions,
                       &all->n_sessions, err) &&
        rows_read_list(db, "SELECT plan, user FROM owners ORDER BY plan", NULL, sizeof(struct store_owner),
                       STORE_MAX_ACCOUNTS, read_owner, &owners, &all->n_owners, err);
    all->users = users;
    all->tokens = tokens;
    all->sessions = sessions;
    all->owners = owners;
    if (ok)
        return all;
    store_accounts_free(all);
    return NULL;
}
