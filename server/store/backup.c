/* The online backup. */
#include "server/store/backup.h"

#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "server/store/database.h"
#include "server/store/sql.h"

enum { BACKUP_PAGES = 256, BACKUP_PAUSE_MS = 20, BACKUP_MAX_PAUSES = 3000 };

static bool copy(sqlite3 *from, sqlite3 *to, struct error *err)
{
    sqlite3_backup *backup = sqlite3_backup_init(to, "main", from, "main");
    if (!backup)
        return sql_fail(to, "beginning the copy", err);
    int code, n_pauses = 0;
    while ((code = sqlite3_backup_step(backup, BACKUP_PAGES)) != SQLITE_DONE) {
        if (code != SQLITE_OK && code != SQLITE_BUSY && code != SQLITE_LOCKED)
            break;
        if (code != SQLITE_OK && ++n_pauses < BACKUP_MAX_PAUSES)
            (void)sqlite3_sleep(BACKUP_PAUSE_MS);
        else if (code != SQLITE_OK)
            break;
    }
    (void)sqlite3_backup_finish(backup); /* leaves its code in `to` */
    return code == SQLITE_DONE || sql_fail(to, "copying", err);
}

static bool is_whole(sqlite3 *db, struct error *err)
{
    sqlite3_stmt *statement = sql_prepare(db, "PRAGMA integrity_check(1)", err);
    char found[120] = "";
    bool ok = statement && (sqlite3_step(statement) == SQLITE_ROW || sql_fail(db, "checking the copy", err));
    if (ok)
        sql_text(statement, 0, found, sizeof found);
    (void)sqlite3_finalize(statement);
    return ok && (strcmp(found, "ok") == 0 || error_set(err, ERROR_FORMAT, "the copy is damaged: %s", found));
}

static bool flush(const char *path, int flags, struct error *err)
{
    int fd = open(path, flags | O_CLOEXEC);
    bool ok = fd >= 0 && fsync(fd) == 0;
    if (!ok)
        error_set(err, ERROR_IO, "%.150s: %s", path, strerror(errno));
    if (fd >= 0)
        (void)close(fd);
    return ok;
}

static bool rename_flushed(const char *partial, const char *file, struct error *err)
{
    char folder[DATABASE_PATH_SIZE];
    (void)snprintf(folder, sizeof folder, "%s", file);
    if (!flush(partial, O_RDONLY, err))
        return false;
    if (rename(partial, file) != 0)
        return error_set(err, ERROR_IO, "%.150s: %s", file, strerror(errno));
    return flush(dirname(folder), O_RDONLY | O_DIRECTORY, err);
}

bool store_backup(const char *path, const char *file, struct error *err)
{
    char partial[DATABASE_PATH_SIZE];
    if (snprintf(partial, sizeof partial, "%s.partial-%ld", file, (long)getpid()) >= (int)sizeof partial)
        return error_set(err, ERROR_LIMIT, "the path is too long");
    if (access(path, F_OK) != 0)
        return error_set(err, ERROR_NOT_FOUND, "%.150s: %s", path, strerror(errno));
    sqlite3 *from = database_open_to_read(path, err), *to = NULL;
    bool ok = from != NULL;
    if (ok && sqlite3_open_v2(partial, &to, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX, NULL) !=
                  SQLITE_OK)
        ok = sql_fail(to, partial, err);
    /* one file, that opens anywhere: without a log beside it */
    ok = ok && copy(from, to, err) && sql_run(to, "PRAGMA journal_mode = DELETE", err) && is_whole(to, err);
    database_close(to);
    database_close(from);
    ok = ok && rename_flushed(partial, file, err);
    if (!ok)
        (void)unlink(partial);
    return ok;
}
