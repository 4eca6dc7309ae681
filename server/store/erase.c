/* The file that says what is being erased, the statements, and the trees of files. */
#include "server/store/erase.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <fts.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/store/database.h"
#include "server/store/heads.h"
#include "server/store/records.h"
#include "server/store/sql.h"

enum { MAX_NOTE_BYTES = 64 << 10 };
static const char note_head[] = "beamroom erase 2\n", note_mark[] = "-erase-";
static const char old_head[] = "beamroom erase 1\n"; /* of notes without the other id */

/* ---- the file beside the database --------------------------------------------------------------------------------- */

static void note_path(char path[DATABASE_PATH_SIZE + 64], const char *database, const char *id, const char *end)
{
    (void)snprintf(path, DATABASE_PATH_SIZE + 64, "%s%s%s%s", database, note_mark, id, end);
}

static bool flush_folder(const char *database)
{
    char folder[DATABASE_PATH_SIZE];
    (void)snprintf(folder, sizeof folder, "%s", database);
    char *slash = strrchr(folder, '/');
    if (slash)
        *slash = 0;
    const int fd = open(slash ? folder : ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    const bool ok = fd >= 0 && fsync(fd) == 0;
    if (fd >= 0)
        (void)close(fd);
    return ok;
}

static bool write_note(const char *database, const struct store_erase *what, struct error *err)
{
    char path[DATABASE_PATH_SIZE + 64], part[DATABASE_PATH_SIZE + 64], text[MAX_NOTE_BYTES];
    const int n = snprintf(text, sizeof text, "%s%s\n%s\n%s\n%s\n%s\n%s\n", note_head, what->plan, what->row,
                           what->folder, what->cache, what->other, what->other_cache);
    note_path(path, database, what->id, "");
    note_path(part, database, what->id, ".part");
    if (n < 0 || (size_t)n >= sizeof text)
        return error_set(err, ERROR_LIMIT, "what is to be erased has too many bytes");
    const int fd = open(part, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600);
    const bool ok = fd >= 0 && write(fd, text, (size_t)n) == n && fsync(fd) == 0 && rename(part, path) == 0 &&
                    flush_folder(database);
    const int reason = errno;
    if (fd >= 0)
        (void)close(fd);
    if (ok)
        return true;
    (void)unlink(part);
    if (unlink(path) == 0) /* or the next start would erase, though the caller is told that nothing is erased */
        (void)flush_folder(database);
    return error_set(err, reason == ENOSPC || reason == EDQUOT ? ERROR_LIMIT : ERROR_IO,
                     "what is to be erased cannot be noted: %s", strerror(reason));
}

/* Copies a line, and goes on behind it; false: there is none, or it is too long. */
static bool take_line(const char **at, char *line, size_t size)
{
    const size_t n = strcspn(*at, "\n");
    if ((*at)[n] != '\n' || n >= size)
        return false;
    memcpy(line, *at, n);
    line[n] = 0;
    *at += n + 1;
    return true;
}

/* A path below the data folder, or "". */
static bool is_below(const char *path)
{
    return path[0] != '/' && !strstr(path, "..");
}

static bool read_note(const char *path, struct store_erase *what)
{
    char *text = mem_new(MAX_NOTE_BYTES);
    const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
    const ssize_t n = fd >= 0 ? read(fd, text, MAX_NOTE_BYTES - 1) : -1;
    if (fd >= 0)
        (void)close(fd);
    const char *at = text + sizeof note_head - 1;
    const bool is_old = strncmp(text, old_head, sizeof old_head - 1) == 0;
    const bool ok = n > 0 && (is_old || strncmp(text, note_head, sizeof note_head - 1) == 0) &&
                    take_line(&at, what->plan, sizeof what->plan) && take_line(&at, what->row, sizeof what->row) &&
                    take_line(&at, what->folder, sizeof what->folder) &&
                    take_line(&at, what->cache, sizeof what->cache) &&
                    (is_old || (take_line(&at, what->other, sizeof what->other) &&
                                take_line(&at, what->other_cache, sizeof what->other_cache))) &&
                    what->plan[0] && is_below(what->folder) && is_below(what->cache) && is_below(what->other_cache);
    free(text);
    return ok;
}

/* ---- files -------------------------------------------------------------------------------------------------------- */

static bool remove_tree(const char *database, const char *below, struct error *err)
{
    char path[2 * DATABASE_PATH_SIZE], *roots[] = { path, NULL };
    const char *slash = strrchr(database, '/');
    int failed = 0;
    if (!below[0])
        return true;
    (void)snprintf(path, sizeof path, "%.*s%s", slash ? (int)(slash + 1 - database) : 0, database, below);
    FTS *tree = fts_open(roots, FTS_PHYSICAL | FTS_NOCHDIR, NULL);
    for (const FTSENT *entry; tree && (entry = fts_read(tree));)
        if (entry->fts_info != FTS_D && entry->fts_info != FTS_NS && remove(entry->fts_accpath) != 0 && errno != ENOENT)
            failed = errno;
    if (!tree || (failed = failed ? failed : access(path, F_OK) == 0 ? ENOTEMPTY : 0))
        error_set(err, ERROR_IO, "files of the plan cannot be removed: %s", strerror(tree ? failed : errno));
    const bool ok = tree && !failed;
    if (tree)
        (void)fts_close(tree);
    return ok;
}

/* ---- rows --------------------------------------------------------------------------------------------------------- */

/* Statements of one transaction. */
struct erasing {
    sqlite3 *db;
    const struct store_erase *what;
    struct store_erased *done;
    struct error *err;
};

static bool append(const struct erasing *erasing, const char *room, const char *action, const char *detail)
{
    char row[1200], *rows[] = { row };
    (void)snprintf(row, sizeof row,
                   "{\"time_ms\":%lld,\"room\":\"%.63s\",\"plan\":\"\",\"member\":\"\",\"name\":\"\",\"role\":\"\","
                   "\"address\":\"\",\"user\":\"\",\"source\":\"\",\"session\":\"\",\"action\":\"%s\",\"detail\":%s,"
                   "\"revision_before\":null,\"revision_after\":null,\"result\":\"done\"}",
                   (long long)clock_wall_ms(), room, action, detail);
    return audit_append(erasing->db, rows, 1, erasing->err);
}

/* The first column of the first row, for free(); NULL: there is none, or it cannot be read, with erasing->err.
 * Finalizes the statement. */
static char *read_first(const struct erasing *erasing, sqlite3_stmt *row)
{
    const int step = row ? sqlite3_step(row) : SQLITE_DONE;
    char *text = step == SQLITE_ROW ? sql_copy_text(row, 0) : NULL;
    if (step != SQLITE_ROW && step != SQLITE_DONE)
        (void)sql_fail(erasing->db, "reading what is to be erased", erasing->err);
    (void)sqlite3_finalize(row);
    return text;
}

/* read_first, with a word or, where that is NULL, a number. */
static char *read_text(const struct erasing *erasing, const char *sql, const char *word, int64_t n)
{
    sqlite3_stmt *row = sql_prepare(erasing->db, sql, erasing->err);
    if (row && word)
        sql_bind_text(row, 1, word);
    else if (row)
        (void)sqlite3_bind_int64(row, 1, n);
    return read_first(erasing, row);
}

/* A statement with both ids of the plan; never with "", which struck records have. NULL with erasing->err. */
static sqlite3_stmt *prepare_of_plan(const struct erasing *erasing, const char *sql)
{
    const struct store_erase *what = erasing->what;
    sqlite3_stmt *row = sql_prepare(erasing->db, sql, erasing->err);
    if (row) {
        sql_bind_text(row, 1, what->plan);
        sql_bind_text(row, 2, what->other[0] ? what->other : what->plan);
    }
    return row;
}

static bool was_done(const struct erasing *erasing)
{
    char *found =
        read_text(erasing,
                  "SELECT 'x' FROM audit WHERE json_valid(row) AND json_extract(row, '$.action') = 'erase' AND"
                  " json_extract(row, '$.detail.erase') = ?1 LIMIT 1",
                  erasing->what->id, 0);
    free(found);
    return found != NULL;
}

static bool delete_rooms(const struct erasing *erasing)
{
    static const char next[] = "SELECT id FROM rooms WHERE plan IN (?1, ?2) LIMIT 1";
    bool ok = true;
    for (char *room; ok && (room = read_first(erasing, prepare_of_plan(erasing, next)));) {
        sqlite3_stmt *row = sql_prepare(erasing->db, "DELETE FROM rooms WHERE id = ?1", erasing->err);
        if (row)
            sql_bind_text(row, 1, room);
        ok = row && sql_step(row, "erasing a room", erasing->err) &&
             append(erasing, room, "deleted", "{\"why\":\"its plan was erased\"}");
        (void)sqlite3_finalize(row);
        erasing->done->n_rooms++;
        free(room);
    }
    return ok;
}

/* The verdict, its author and the files that it was about stay; words, scene and all that was shown do not. */
static const char struck[] =
    "SELECT json_object('id', id, 'kind', kind, 'author', author, 'author_name', author_name, 'created_ms', time_ms,"
    " 'erased', json('true'), 'body', json_object('decision', CASE WHEN json_valid(item) THEN"
    " json_extract(item, '$.body.decision') END, 'plan_revision', CASE WHEN json_valid(item) THEN"
    " json_extract(item, '$.body.plan_revision') END)) FROM records WHERE n = ?1";

/* The verdict is all that a list says of it then. */
static const char renewed[] = "INSERT OR REPLACE INTO record_facts(record, facts) SELECT n, " RECORD_FACTS
                              " FROM records WHERE n = ?1 AND json_valid(item) AND json_valid(body)";

/* Runs a statement with the number of a record. */
static bool run_of(const struct erasing *erasing, int64_t n, const char *statement)
{
    sqlite3_stmt *row = sql_prepare(erasing->db, statement, erasing->err);
    if (row)
        (void)sqlite3_bind_int64(row, 1, n);
    const bool ok = row && sql_step(row, "erasing a record", erasing->err);
    (void)sqlite3_finalize(row);
    return ok;
}

static bool strike(const struct erasing *erasing, int64_t n)
{
    char body[128], detail[300], item_hash[STORE_AUDIT_HASH], body_hash[STORE_AUDIT_HASH];
    char *item = read_text(erasing, struck, NULL, n),
         *hash = read_text(erasing, "SELECT hash FROM records WHERE n = ?1", NULL, n),
         *id = read_text(erasing, "SELECT id FROM records WHERE n = ?1", NULL, n),
         *room = read_text(erasing, "SELECT room FROM records WHERE n = ?1", NULL, n);
    sqlite3_stmt *row =
        sql_prepare(erasing->db, "UPDATE records SET plan = '', item = ?2, body = ?3, hash = ?4 WHERE n = ?1",
                    erasing->err);
    bool ok = item && hash && id && room && row;
    if (ok) {
        (void)snprintf(body, sizeof body, "{\"erased\":true,\"sha256\":\"%.64s\"}", hash);
        audit_digest(item, item_hash);
        audit_digest(body, body_hash);
        (void)sqlite3_bind_int64(row, 1, n);
        sql_bind_text(row, 2, item);
        sql_bind_text(row, 3, body);
        sql_bind_text(row, 4, body_hash);
        (void)snprintf(detail, sizeof detail, "{\"item\":\"%.63s\",\"sha256\":\"%s\",\"record_sha256\":\"%s\"}", id,
                       item_hash, body_hash);
        ok = sql_step(row, "erasing a record", erasing->err) &&
             run_of(erasing, n, "DELETE FROM record_figures WHERE record = ?1") && run_of(erasing, n, renewed) &&
             append(erasing, room, "record-erased", detail);
        erasing->done->n_records++;
    } else {
        error_set(erasing->err, ERROR_IO, "a record cannot be read to be erased");
    }
    (void)sqlite3_finalize(row);
    free(item);
    free(hash);
    free(id);
    free(room);
    return ok;
}

/* The triggers that refuse changes are lifted inside the transaction, and made again as they were. */
static bool strike_records(const struct erasing *erasing)
{
    static const char next[] = "SELECT min(n) FROM records WHERE plan IN (?1, ?2)";
    static const char by_name[] = "SELECT sql FROM sqlite_schema WHERE name = ?1";
    char *trigger = read_text(erasing, by_name, "records_update", 0),
         *of_figures = read_text(erasing, by_name, "record_figures_delete", 0);
    bool ok = trigger && of_figures && sql_run(erasing->db, "DROP TRIGGER records_update", erasing->err) &&
              sql_run(erasing->db, "DROP TRIGGER record_figures_delete", erasing->err);
    for (char *n; ok && (n = read_first(erasing, prepare_of_plan(erasing, next))); free(n))
        ok = strike(erasing, strtoll(n, NULL, 10));
    ok = ok && sql_run(erasing->db, trigger, erasing->err) && sql_run(erasing->db, of_figures, erasing->err);
    free(trigger);
    free(of_figures);
    return ok;
}

/* The one row that says who erased what. */
static bool append_row(const struct erasing *erasing)
{
    sqlite3_stmt *row =
        sql_prepare(erasing->db, "SELECT json_set(?1, '$.detail.rooms', ?2, '$.detail.records', ?3)", erasing->err);
    if (!row)
        return false;
    sql_bind_text(row, 1, erasing->what->row);
    (void)sqlite3_bind_int64(row, 2, erasing->what->n_rooms + erasing->done->n_rooms);
    (void)sqlite3_bind_int64(row, 3, erasing->done->n_records);
    char *rows[] = { sqlite3_step(row) == SQLITE_ROW ? sql_copy_text(row, 0) : NULL };
    (void)sqlite3_finalize(row);
    const bool ok = rows[0] ? audit_append(erasing->db, rows, 1, erasing->err)
                            : error_set(erasing->err, ERROR_IO, "the row of the audit cannot be made");
    free(rows[0]);
    return ok;
}

static bool delete_owner(const struct erasing *erasing)
{
    sqlite3_stmt *row = prepare_of_plan(erasing, "DELETE FROM owners WHERE plan IN (?1, ?2)");
    const bool ok = row && sql_step(row, "erasing an owner", erasing->err);
    (void)sqlite3_finalize(row);
    return ok;
}

/* Meetings keep their cases: that there was one, how long it took and who was there, not of whom. */
static bool strike_cases(const struct erasing *erasing)
{
    sqlite3_stmt *row =
        prepare_of_plan(erasing, "UPDATE meeting_cases SET plan = '', room = '' WHERE plan IN (?1, ?2)");
    const bool ok = row && sql_step(row, "erasing a case of a meeting", erasing->err);
    (void)sqlite3_finalize(row);
    return ok;
}

static bool delete_statement(const struct erasing *erasing)
{
    sqlite3_stmt *row = prepare_of_plan(erasing, "DELETE FROM statements WHERE plan IN (?1, ?2)");
    const bool ok = row && sql_step(row, "erasing a statement on a plan", erasing->err);
    (void)sqlite3_finalize(row);
    return ok;
}

static bool erase_rows(const struct erasing *erasing)
{
    if (!sql_run(erasing->db, "PRAGMA secure_delete = ON", erasing->err) ||
        !sql_run(erasing->db, "BEGIN IMMEDIATE", erasing->err))
        return false;
    if (was_done(erasing))
        return sql_run(erasing->db, "COMMIT", erasing->err);
    const bool ok = delete_rooms(erasing) && strike_records(erasing) && delete_owner(erasing) &&
                    delete_statement(erasing) && strike_cases(erasing) && append_row(erasing) &&
                    erasing->err->code == ERROR_NONE && /* else rows that cannot be read would stay unseen */
                    sql_run(erasing->db, "COMMIT", erasing->err);
    if (!ok && !sqlite3_get_autocommit(erasing->db))
        (void)sqlite3_exec(erasing->db, "ROLLBACK", NULL, NULL, NULL);
    return ok;
}

/* ---- what SQLite leaves behind -------------------------------------------------------------------------------------- */

/* Earlier versions of rows stand in free places of the file and in its log. */
static bool clean(sqlite3 *db, struct error *err)
{
    if (!sql_run(db, "VACUUM", err))
        return false;
    sqlite3_stmt *row = sql_prepare(db, "PRAGMA wal_checkpoint(TRUNCATE)", err);
    const bool is_empty = row && sqlite3_step(row) == SQLITE_ROW && sqlite3_column_int(row, 0) == 0;
    (void)sqlite3_finalize(row);
    return is_empty || error_set(err, ERROR_IO, "the log of the database is in use, as by a backup");
}

static bool finish(sqlite3 *db, const char *database, const struct store_erase *what, struct store_erased *done,
                   struct error *err)
{
    char path[DATABASE_PATH_SIZE + 64];
    const struct erasing erasing = { db, what, done, err };
    *done = (struct store_erased){ 0 };
    note_path(path, database, what->id, "");
    if (!remove_tree(database, what->folder, err) || !remove_tree(database, what->cache, err) ||
        !remove_tree(database, what->other_cache, err) || !erase_rows(&erasing) || !clean(db, err))
        return false;
    return (unlink(path) == 0 && flush_folder(database)) ||
           error_set(err, ERROR_IO, "the note of what is erased cannot be removed: %s", strerror(errno));
}

void erase_plan(sqlite3 *db, const char *database, const struct store_erase *what, bool is_begin,
                struct store_answer *said)
{
    struct audit_head head;
    struct error err = { 0 };
    if (is_begin) {
        if (!write_note(database, what, &said->error))
            log_error("%s", said->error.text);
        return;
    }
    if (finish(db, database, what, &said->erased, &said->error))
        log_info("a plan was erased: %lld rooms, %lld records", (long long)said->erased.n_rooms,
                 (long long)said->erased.n_records);
    else
        log_error("a plan is not wholly erased; it is tried again at the next start: %s", said->error.text);
    if (audit_read_head(db, &head, &err) && head.n)
        heads_write(database, &head);
}

/* ---- at the start --------------------------------------------------------------------------------------------------- */

static void resume(const char *database, const char *id)
{
    char path[DATABASE_PATH_SIZE + 64], moved[DATABASE_PATH_SIZE];
    struct store_erase what = { 0 };
    struct store_answer said = { 0 };
    struct error err = { 0 };
    note_path(path, database, id, "");
    (void)snprintf(what.id, sizeof what.id, "%s", id);
    if (!read_note(path, &what)) {
        log_error("%s is not readable: what it names is not erased", path);
        return;
    }
    sqlite3 *db = database_open(database, moved, &err);
    if (db)
        erase_plan(db, database, &what, false, &said);
    else
        log_error("a plan that is to be erased is not: %s", err.text);
    database_close(db);
}

void store_erase_resume(const char *database)
{
    char folder[DATABASE_PATH_SIZE], begin[300];
    const char *slash = strrchr(database, '/');
    (void)snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - database) : 1, slash ? database : ".");
    (void)snprintf(begin, sizeof begin, "%.255s%s", slash ? slash + 1 : database, note_mark);
    DIR *entries = opendir(folder);
    for (const struct dirent *entry; entries && (entry = readdir(entries));) {
        if (strncmp(entry->d_name, begin, strlen(begin)) != 0)
            continue;
        char id[STORE_ERASE_ID], path[DATABASE_PATH_SIZE + 64];
        const char *rest = entry->d_name + strlen(begin);
        (void)snprintf(id, sizeof id, "%.*s", (int)strspn(rest, "0123456789abcdef"), rest);
        note_path(path, database, rest, "");
        if (strcmp(id, rest) == 0)
            resume(database, id);
        else
            (void)unlink(path); /* was never whole, so nothing was erased */
    }
    if (entries)
        (void)closedir(entries);
}
