/* The statements that write and read meetings. */
#include "server/store/meetings.h"

#include <stdlib.h>

#include "core/base/mem.h"
#include "server/store/sql.h"

enum { MAX_CASES = 1000 }; /* of one meeting, that are read */

void store_meeting_free(struct store_meeting *meeting)
{
    if (!meeting)
        return;
    for (size_t i = 0; i < meeting->n_cases; i++)
        free(meeting->cases[i].body);
    free(meeting->cases);
    free(meeting->body);
    free(meeting);
}

void meetings_free(struct store_meeting **meetings, size_t n)
{
    for (size_t i = 0; meetings && i < n; i++)
        store_meeting_free(meetings[i]);
    free(meetings);
}

/* ---- writing ---------------------------------------------------------------------------------------------------- */

static bool run_with_id(sqlite3 *db, const char *sql, const char *id, const char *what, struct error *err)
{
    sqlite3_stmt *row = sql_prepare(db, sql, err);
    if (row)
        sql_bind_text(row, 1, id);
    const bool ok = row && sql_step(row, what, err);
    (void)sqlite3_finalize(row);
    return ok;
}

static bool write_cases(sqlite3 *db, const struct store_meeting *meeting, struct error *err)
{
    sqlite3_stmt *row =
        sql_prepare(db,
                    "INSERT INTO meeting_cases(meeting, place, id, plan, room, body) VALUES(?1, ?2, ?3, ?4, ?5, ?6)",
                    err);
    bool ok = row != NULL;
    for (size_t i = 0; ok && i < meeting->n_cases; i++) {
        const struct store_meeting_case *one = &meeting->cases[i];
        sql_bind_text(row, 1, meeting->id);
        (void)sqlite3_bind_int64(row, 2, (int64_t)i);
        sql_bind_text(row, 3, one->id);
        sql_bind_text(row, 4, one->plan);
        sql_bind_text(row, 5, one->room);
        sql_bind_text(row, 6, one->body);
        ok = sql_step(row, "writing a case of a meeting", err);
    }
    (void)sqlite3_finalize(row);
    return ok;
}

bool meetings_write(sqlite3 *db, const struct store_meeting *meeting, struct error *err)
{
    if (!run_with_id(db, "DELETE FROM meetings WHERE id = ?1", meeting->id, "deleting a meeting", err))
        return false;
    if (!meeting->body)
        return true;
    sqlite3_stmt *row = sql_prepare(db, "INSERT INTO meetings(id, owner, body) VALUES(?1, ?2, ?3)", err);
    if (row) {
        sql_bind_text(row, 1, meeting->id);
        sql_bind_text(row, 2, meeting->owner);
        sql_bind_text(row, 3, meeting->body);
    }
    const bool ok = row && sql_step(row, "writing a meeting", err);
    (void)sqlite3_finalize(row);
    return ok && write_cases(db, meeting, err);
}

/* ---- reading ---------------------------------------------------------------------------------------------------- */

static bool read_case(sqlite3_stmt *row, struct store_meeting_case *one)
{
    *one = (struct store_meeting_case){ .body = sql_copy_text(row, 3) };
    sql_text(row, 0, one->id, sizeof one->id);
    sql_text(row, 1, one->plan, sizeof one->plan);
    sql_text(row, 2, one->room, sizeof one->room);
    return one->body != NULL;
}

static bool read_cases(sqlite3 *db, struct store_meeting *meeting, struct error *err)
{
    sqlite3_stmt *row =
        sql_prepare(db, "SELECT id, plan, room, body FROM meeting_cases WHERE meeting = ?1 ORDER BY place", err);
    bool ok = row != NULL;
    if (ok)
        sql_bind_text(row, 1, meeting->id);
    for (int step; ok && meeting->n_cases < MAX_CASES && (step = sqlite3_step(row)) != SQLITE_DONE;) {
        struct store_meeting_case *more =
            step == SQLITE_ROW ? realloc(meeting->cases, (meeting->n_cases + 1) * sizeof *more) : NULL;
        if (step != SQLITE_ROW) {
            ok = sql_fail(db, "reading the cases of a meeting", err);
        } else if (!more) {
            ok = error_set(err, ERROR_MEMORY, "no memory for a meeting");
        } else {
            meeting->cases = more;
            ok = read_case(row, &more[meeting->n_cases++]) || error_set(err, ERROR_MEMORY, "no memory for a meeting");
        }
    }
    (void)sqlite3_finalize(row);
    return ok;
}

struct store_meeting **meetings_read(sqlite3 *db, size_t *n, struct error *err)
{
    struct store_meeting **list = mem_array(STORE_MAX_MEETINGS, sizeof list[0], 1 << 20, err);
    sqlite3_stmt *row = list ? sql_prepare(db, "SELECT id, owner, body FROM meetings ORDER BY rowid", err) : NULL;
    bool ok = row != NULL;
    *n = 0;
    for (int step; ok && *n < STORE_MAX_MEETINGS && (step = sqlite3_step(row)) != SQLITE_DONE;) {
        if (step != SQLITE_ROW) {
            ok = sql_fail(db, "reading meetings", err);
            continue;
        }
        struct store_meeting *meeting = mem_new(sizeof *meeting);
        list[(*n)++] = meeting;
        sql_text(row, 0, meeting->id, sizeof meeting->id);
        sql_text(row, 1, meeting->owner, sizeof meeting->owner);
        meeting->body = sql_copy_text(row, 2);
        ok = meeting->body ? read_cases(db, meeting, err) : error_set(err, ERROR_MEMORY, "no memory for a meeting");
    }
    (void)sqlite3_finalize(row);
    if (ok)
        return list;
    meetings_free(list, *n);
    *n = 0;
    return NULL;
}
