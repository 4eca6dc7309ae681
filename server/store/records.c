/* The statements that write and read records. */
#include "server/store/records.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/store/audit.h"
#include "server/store/sql.h"
#include "server/store/store.h"

void store_record_finish(struct store_record *record)
{
    free(record->item);
    free(record->body);
    free(record->facts);
    free(record->signatures);
    free(record->decisions);
    for (size_t i = 0; i < STORE_FIGURES; i++)
        free(record->figures[i].bytes);
    *record = (struct store_record){ 0 };
}

static bool write_figures(sqlite3 *db, sqlite3_int64 n, const struct store_record *record, struct error *err)
{
    bool ok = true;
    for (int i = 0; ok && i < STORE_FIGURES; i++) {
        const struct store_figure *figure = &record->figures[i];
        char hash[STORE_AUDIT_HASH];
        if (!figure->bytes)
            continue;
        sqlite3_stmt *row =
            sql_prepare(db, "INSERT INTO record_figures(record, place, bytes, hash) VALUES(?1, ?2, ?3, ?4)", err);
        if (!row)
            return false;
        audit_digest_bytes(figure->bytes, figure->n_bytes, hash);
        (void)sqlite3_bind_int64(row, 1, n);
        (void)sqlite3_bind_int(row, 2, i);
        (void)sqlite3_bind_blob64(row, 3, figure->bytes, figure->n_bytes, SQLITE_STATIC);
        sql_bind_text(row, 4, hash);
        ok = sql_step(row, "writing a record", err);
        (void)sqlite3_finalize(row);
    }
    return ok;
}

/* Adds what lists say of record n. */
static bool write_facts(sqlite3 *db, sqlite3_int64 n, struct error *err)
{
    sqlite3_stmt *row =
        sql_prepare(db,
                    "INSERT OR REPLACE INTO record_facts(record, facts) SELECT n, " RECORD_FACTS " FROM records WHERE"
                    " n = ?1 AND json_valid(item) AND json_valid(body)",
                    err);
    if (row)
        (void)sqlite3_bind_int64(row, 1, n);
    const bool ok = row && sql_step(row, "writing a record", err);
    (void)sqlite3_finalize(row);
    return ok;
}

bool records_write(sqlite3 *db, const struct store_room *room, struct error *err)
{
    if (!room->n_records)
        return true;
    sqlite3_stmt *row =
        sql_prepare(db,
                    "INSERT INTO records(id, room, plan, kind, author, author_name, time_ms, item, body,"
                    " hash) VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10)",
                    err);
    bool ok = row != NULL;
    for (size_t i = 0; ok && i < room->n_records; i++) {
        const struct store_record *record = &room->records[i];
        char hash[STORE_AUDIT_HASH];
        audit_digest(record->body, hash);
        sql_bind_text(row, 1, record->id);
        sql_bind_text(row, 2, record->room);
        sql_bind_text(row, 3, record->plan);
        sql_bind_text(row, 4, record->kind);
        sql_bind_text(row, 5, record->author);
        sql_bind_text(row, 6, record->author_name);
        (void)sqlite3_bind_int64(row, 7, record->time_ms);
        sql_bind_text(row, 8, record->item);
        sql_bind_text(row, 9, record->body);
        sql_bind_text(row, 10, hash);
        ok = sql_step(row, "writing a record", err);
        const sqlite3_int64 n = sqlite3_last_insert_rowid(db);
        ok = ok && write_facts(db, n, err) && write_figures(db, n, record, err);
    }
    (void)sqlite3_finalize(row);
    return ok;
}

/* The pictures of the newest record of this id. */
static bool read_figures(sqlite3 *db, struct store_record *record, struct error *err)
{
    sqlite3_stmt *row = sql_prepare(db,
                                    "SELECT place, bytes FROM record_figures WHERE record = (SELECT max(n) FROM records"
                                    " WHERE id = ?1) AND place BETWEEN 0 AND ?2",
                                    err);
    bool ok = row != NULL;
    if (row) {
        sql_bind_text(row, 1, record->id);
        (void)sqlite3_bind_int(row, 2, STORE_FIGURES - 1);
    }
    for (int step; ok && (step = sqlite3_step(row)) != SQLITE_DONE;) {
        if (step != SQLITE_ROW)
            ok = sql_fail(db, "reading records", err);
        struct store_figure *figure = &record->figures[ok ? sqlite3_column_int(row, 0) : 0];
        const int n = ok ? sqlite3_column_bytes(row, 1) : 0;
        const void *bytes = n > 0 && n <= STORE_MAX_FIGURE_BYTES ? sqlite3_column_blob(row, 1) : NULL;
        if (!bytes || figure->bytes)
            continue;
        figure->bytes = mem_array((size_t)n, 1, STORE_MAX_FIGURE_BYTES, err);
        ok = figure->bytes != NULL;
        if (ok)
            memcpy(figure->bytes, bytes, figure->n_bytes = (size_t)n);
    }
    (void)sqlite3_finalize(row);
    return ok;
}

/* One text for the record with its id; NULL with err. */
static char *read_later(sqlite3 *db, const struct store_record *record, const char *sql, struct error *err)
{
    sqlite3_stmt *row = sql_prepare(db, sql, err);
    char *text = NULL;
    if (row) {
        sql_bind_text(row, 1, record->id);
        sql_bind_text(row, 2, record->room);
    }
    if (row && sqlite3_step(row) == SQLITE_ROW)
        text = sql_copy_text(row, 0);
    if (row && !text)
        (void)sql_fail(db, "reading records", err);
    (void)sqlite3_finalize(row);
    return text;
}

/* Reads what was signed and decided in the room after a decision. */
static bool read_since(sqlite3 *db, struct store_record *record, struct error *err)
{
    static const char signatures[] =
        "WITH this(n) AS (SELECT max(n) FROM records WHERE id = ?1) SELECT json_group_array(json(item)) FROM (SELECT item"
        " FROM records, this WHERE room = ?2 AND kind = 'signature' AND json_valid(item) AND records.n > this.n AND"
        " records.n < coalesce((SELECT min(d.n) FROM records AS d WHERE d.room = ?2 AND d.kind = 'decision' AND d.n >"
        " this.n), 9e18) ORDER BY records.n LIMIT 1000)";
    static const char decisions[] =
        "SELECT json_group_array(json(item)) FROM (SELECT item FROM records WHERE room = ?2 AND kind = 'decision' AND"
        " json_valid(item) AND n > (SELECT max(n) FROM records WHERE id = ?1) ORDER BY n LIMIT 1000)";
    if (strcmp(record->kind, "decision") != 0)
        return true;
    record->signatures = read_later(db, record, signatures, err);
    record->decisions = record->signatures ? read_later(db, record, decisions, err) : NULL;
    return record->decisions != NULL;
}

static bool read_record(sqlite3_stmt *row, bool is_whole, struct store_record *record)
{
    *record = (struct store_record){ .time_ms = sqlite3_column_int64(row, 6) };
    sql_text(row, 0, record->id, sizeof record->id);
    sql_text(row, 1, record->room, sizeof record->room);
    sql_text(row, 2, record->plan, sizeof record->plan);
    sql_text(row, 3, record->kind, sizeof record->kind);
    sql_text(row, 4, record->author, sizeof record->author);
    sql_text(row, 5, record->author_name, sizeof record->author_name);
    sql_text(row, 7, record->hash, sizeof record->hash);
    record->item = is_whole ? sql_copy_text(row, 8) : NULL;
    record->body = is_whole ? sql_copy_text(row, 9) : NULL;
    record->facts = is_whole ? NULL : sql_copy_text(row, 8);
    return is_whole ? record->item && record->body : record->facts != NULL;
}

struct store_record *records_read(sqlite3 *db, const char *id, const char *before, size_t *n, struct error *err)
{
    const bool is_whole = id[0] != 0;
    const size_t most = is_whole ? 1 : STORE_RECORDS_AT_ONCE;
    struct store_record *records = mem_array(most, sizeof *records, STORE_RECORDS_AT_ONCE * sizeof *records, err);
    sqlite3_stmt *row =
        records
            ? sql_prepare(db,
                          is_whole ? "SELECT id, room, plan, kind, author, author_name, time_ms, hash, item, body FROM"
                                     " records WHERE id = ?1 ORDER BY n DESC"
                                   : "SELECT id, room, plan, kind, author, author_name, time_ms, hash,"
                                     " coalesce(facts, '{}') FROM records LEFT JOIN record_facts ON record = n WHERE"
                                     " n < CASE ?2 WHEN '' THEN 9223372036854775807 ELSE"
                                     " (SELECT max(n) FROM records WHERE id = ?2) END ORDER BY n DESC",
                          err)
            : NULL;
    bool ok = row != NULL;
    *n = 0;
    if (ok) {
        sql_bind_text(row, 1, id);
        if (!is_whole)
            sql_bind_text(row, 2, before);
    }
    for (int step; ok && *n < most && (step = sqlite3_step(row)) != SQLITE_DONE;) {
        if (step != SQLITE_ROW)
            ok = sql_fail(db, "reading records", err);
        else
            ok = read_record(row, is_whole, &records[(*n)++]) || error_set(err, ERROR_MEMORY, "no memory for a record");
    }
    (void)sqlite3_finalize(row);
    if (ok && is_whole && *n == 1)
        ok = read_figures(db, &records[0], err) && read_since(db, &records[0], err);
    if (ok && is_whole && *n == 0)
        ok = error_set(err, ERROR_NOT_FOUND, "there is no record \"%.63s\"", id);
    if (ok)
        return records;
    for (size_t i = 0; records && i < *n; i++)
        store_record_finish(&records[i]);
    free(records);
    *n = 0;
    return NULL;
}
