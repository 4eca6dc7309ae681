/* Opens and checks the database; its failures as sentences. */
#include "server/store/database.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "server/store/schema.h"
#include "server/store/sql.h"
#include "server/store/store_rows.h"

enum { APPLICATION_ID = 0x4265616d }; /* "Beam", in the file's header */

void database_close(sqlite3 *db)
{
    (void)sqlite3_close_v2(db);
}

static sqlite3 *open_file(const char *path, int flags, struct error *err)
{
    sqlite3 *db = NULL;
    if (sqlite3_open_v2(path, &db, flags | SQLITE_OPEN_NOMUTEX, NULL) != SQLITE_OK) {
        (void)sql_fail(db, "opening", err);
        database_close(db);
        return NULL;
    }
    (void)sqlite3_busy_timeout(db, DATABASE_BUSY_MS);
    (void)sqlite3_limit(db, SQLITE_LIMIT_LENGTH, STORE_MAX_TEXT_BYTES);
    (void)sqlite3_db_config(db, SQLITE_DBCONFIG_DEFENSIVE, 1, NULL); /* no statement can damage the file itself */
    (void)sqlite3_db_config(db, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, NULL);
    return db;
}

static bool is_whole(sqlite3 *db, struct error *err)
{
    sqlite3_stmt *statement = sql_prepare(db, "PRAGMA integrity_check(1)", err);
    char found[120] = "";
    bool ok = statement && (sqlite3_step(statement) == SQLITE_ROW || sql_fail(db, "checking", err));
    if (ok)
        sql_text(statement, 0, found, sizeof found);
    (void)sqlite3_finalize(statement);
    if (ok && strcmp(found, "ok") != 0)
        return error_set(err, ERROR_FORMAT, "%s", found);
    return ok;
}

static bool is_ours(sqlite3 *db, struct error *err)
{
    sqlite3_stmt *statement = sql_prepare(db, "PRAGMA application_id", err);
    bool ok = statement && (sqlite3_step(statement) == SQLITE_ROW || sql_fail(db, "reading its header", err));
    int id = ok ? sqlite3_column_int(statement, 0) : 0;
    (void)sqlite3_finalize(statement);
    if (ok && id != 0 && id != APPLICATION_ID)
        return error_set(err, ERROR_FORMAT, "it is a database of another program");
    return ok;
}

static sqlite3 *open_and_check(const char *path, struct error *err)
{
    char set_id[64];
    (void)snprintf(set_id, sizeof set_id, "PRAGMA application_id = %d", APPLICATION_ID);
    sqlite3 *db = open_file(path, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, err);
    if (db && is_ours(db, err) && is_whole(db, err) && sql_run(db, "PRAGMA journal_mode = WAL", err) &&
        sql_run(db, "PRAGMA synchronous = FULL", err) && sql_run(db, "PRAGMA foreign_keys = ON", err) &&
        sql_run(db, "PRAGMA journal_size_limit = 8388608", err) && schema_update(db, err) && sql_run(db, set_id, err))
        return db;
    database_close(db);
    return NULL;
}

/* Renames the file and what SQLite keeps beside it. */
static bool move_aside(const char *path, char moved[DATABASE_PATH_SIZE], struct error *err)
{
    static const char *const endings[] = { "-wal", "-shm", "" };
    char from[DATABASE_PATH_SIZE], to[DATABASE_PATH_SIZE + 8], stamp[40];
    struct tm utc;
    time_t now = time(NULL);
    gmtime_r(&now, &utc);
    (void)strftime(stamp, sizeof stamp, "%Y%m%d-%H%M%S", &utc);
    if (snprintf(moved, DATABASE_PATH_SIZE, "%.3900s.damaged-%s", path, stamp) >= DATABASE_PATH_SIZE)
        return error_set(err, ERROR_LIMIT, "its path is too long");
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++) {
        (void)snprintf(from, sizeof from, "%.3900s%s", path, endings[i]);
        (void)snprintf(to, sizeof to, "%s%s", moved, endings[i]);
        if (rename(from, to) != 0 && errno != ENOENT)
            return error_set(err, ERROR_IO, "renaming %.100s: %s", from, strerror(errno));
    }
    return true;
}

sqlite3 *database_open(const char *path, char moved[DATABASE_PATH_SIZE], struct error *err)
{
    struct error found = { 0 };
    moved[0] = 0;
    sqlite3 *db = open_and_check(path, &found);
    if (!db && (found.code == ERROR_FORMAT || found.code == ERROR_STATE) && move_aside(path, moved, &found))
        db = open_and_check(path, &found);
    if (!db) {
        error_set(err, found.code, "%s", found.text);
        error_prefix(err, "%.100s", path);
    }
    return db;
}

sqlite3 *database_open_to_read(const char *path, struct error *err)
{
    struct error found = { 0 };
    sqlite3 *db = open_file(path, SQLITE_OPEN_READWRITE, &found); /* a log left by a crash is read by writing */
    if (db && is_ours(db, &found))
        return db;
    database_close(db);
    error_set(err, found.code, "%s", found.text);
    error_prefix(err, "%.100s", path);
    return NULL;
}
