/* Joins items and records with the rows of the audit that name them. */
#include "server/store/verify_items.h"

#include <string.h>

#include "server/store/audit.h"
#include "server/store/sql.h"

/* Rows of the audit that name an item or delete a room. Rows without sha256 are of versions that had none. */
static const char collect[] =
    "CREATE TEMP TABLE said AS SELECT n, json_extract(row, '$.room') AS room, json_extract(row, '$.action') AS action,"
    " json_extract(row, '$.detail.item') AS item, json_extract(row, '$.detail.sha256') AS sha,"
    " json_extract(row, '$.detail.record_sha256') AS record, json_extract(row, '$.action') = 'withdrawal' OR"
    " coalesce(json_extract(row, '$.detail.deleted'), 0) AS is_deleted FROM audit WHERE json_valid(row) AND"
    " json_extract(row, '$.result') = 'done' AND (json_extract(row, '$.detail.item') IS NOT NULL OR"
    " json_extract(row, '$.action') = 'deleted');"
    "CREATE INDEX temp.said_item ON said(room, item, n)";

/* When rows began to name every item. */
static const char since[] =
    "SELECT coalesce(min(json_extract(row, '$.time_ms')), 9e15) FROM audit WHERE json_valid(row)"
    " AND json_type(row, '$.address') IS NOT NULL";

struct found { /* a row of one of the queries */
    char kind[24], id[64], room[64], sha[STORE_AUDIT_HASH], record_sha[STORE_AUDIT_HASH];
    long long n; /* of the audit; 0: none */
};

static void read_found(sqlite3_stmt *row, struct found *found)
{
    sql_text(row, 0, found->kind, sizeof found->kind);
    sql_text(row, 1, found->id, sizeof found->id);
    sql_text(row, 2, found->room, sizeof found->room);
    found->n = sqlite3_column_int64(row, 3);
    sql_text(row, 4, found->sha, sizeof found->sha);
}

/* Whether the text in this column has the hash; "": any. */
static bool is_text(sqlite3_stmt *row, int column, const char *hash)
{
    char computed[STORE_AUDIT_HASH];
    const char *text = (const char *)sqlite3_column_text(row, column);
    audit_digest(text ? text : "", computed);
    return !hash[0] || strcmp(computed, hash) == 0;
}

static bool check_item(sqlite3_stmt *row, struct error *err)
{
    struct found found;
    read_found(row, &found);
    const bool is_exempt = sqlite3_column_int(row, 7) != 0; /* older than rows for its kind */
    if (!found.n)
        return is_exempt ||
               error_set(err, ERROR_FORMAT, "%s %s of room %s stands in no row", found.kind, found.id, found.room);
    if (sqlite3_column_int(row, 6))
        return error_set(err, ERROR_FORMAT, "%s %s of room %s is there, and row %lld deleted it", found.kind, found.id,
                         found.room, found.n);
    return is_text(row, 5, found.sha) ||
           error_set(err, ERROR_FORMAT, "%s %s of room %s is not what row %lld says: it was changed in the database",
                     found.kind, found.id, found.room, found.n);
}

static bool check_record(sqlite3_stmt *row, struct error *err)
{
    struct found found;
    char hash[STORE_AUDIT_HASH];
    read_found(row, &found);
    sql_text(row, 6, found.record_sha, sizeof found.record_sha);
    sql_text(row, 8, hash, sizeof hash);
    if (!found.n)
        return error_set(err, ERROR_FORMAT, "the record of %s %s of room %s stands in no row", found.kind, found.id,
                         found.room);
    return (is_text(row, 5, found.sha) && is_text(row, 7, found.record_sha) && is_text(row, 7, hash)) ||
           error_set(err, ERROR_FORMAT,
                     "the record of %s %s of room %s is not what row %lld says: it was changed in the database",
                     found.kind, found.id, found.room, found.n);
}

/* A picture beside its record, which names it by its hash. */
static bool check_figure(sqlite3_stmt *row, struct error *err)
{
    struct found found;
    char hash[STORE_AUDIT_HASH], computed[STORE_AUDIT_HASH];
    read_found(row, &found);
    sql_text(row, 6, hash, sizeof hash);
    const int n = sqlite3_column_bytes(row, 5);
    const void *bytes = sqlite3_column_blob(row, 5);
    audit_digest_bytes(bytes ? bytes : "", bytes ? (size_t)n : 0, computed);
    return (strcmp(found.sha, computed) == 0 && strcmp(hash, computed) == 0) ||
           error_set(err, ERROR_FORMAT,
                     "picture %lld of the record of %s %s of room %s is not the one that the record names: it was "
                     "changed in the database",
                     found.n + 1, found.kind, found.id, found.room);
}

static bool refuse_missing(sqlite3_stmt *row, struct error *err)
{
    struct found found;
    read_found(row, &found);
    return error_set(err, ERROR_FORMAT, "%s %s of room %s, which row %lld put, is not in the database any more",
                     found.kind, found.id, found.room, found.n);
}

static bool refuse_missing_figure(sqlite3_stmt *row, struct error *err)
{
    struct found found;
    read_found(row, &found);
    return error_set(err, ERROR_FORMAT,
                     "a picture of the record of decision %s of room %s is not in the database any more", found.id,
                     found.room);
}

static bool refuse_cut(sqlite3_stmt *row, struct error *err)
{
    struct found found;
    read_found(row, &found);
    return error_set(err, ERROR_FORMAT, "recording %s of room %s has %lld of its %lld parts: the others were removed",
                     found.id, found.room, (long long)sqlite3_column_int64(row, 5), found.n);
}

static bool for_each(sqlite3 *db, const char *sql, double number, bool (*check)(sqlite3_stmt *row, struct error *err),
                     int64_t *n, struct error *err)
{
    sqlite3_stmt *row = sql_prepare(db, sql, err);
    bool ok = row != NULL;
    if (ok && sqlite3_bind_parameter_count(row))
        (void)sqlite3_bind_double(row, 1, number);
    for (int step; ok && (step = sqlite3_step(row)) != SQLITE_DONE; ++*n)
        ok = step == SQLITE_ROW ? check(row, err) : sql_fail(db, "comparing items with the audit", err);
    (void)sqlite3_finalize(row);
    return ok;
}

static bool check_figures(sqlite3 *db, struct error *err)
{
    static const char has_figures[] = "SELECT 1 FROM sqlite_schema WHERE name = 'record_figures'";
    static const char figures[] =
        "SELECT coalesce(records.kind, ''), coalesce(records.id, ''), coalesce(records.room, ''), place,"
        " coalesce((SELECT json_extract(value, '$.sha256') FROM json_each(CASE WHEN json_valid(records.body) THEN"
        " records.body ELSE '{}' END, '$.kept.figures') WHERE json_extract(value, '$.place') = place), ''), bytes,"
        " record_figures.hash FROM record_figures LEFT JOIN records ON records.n = record_figures.record";
    /* pictures that a record names and that are not there; in a database without their table: all */
#define NAMED_FIGURES \
    "SELECT records.kind, records.id, records.room, 0, '' FROM records, json_each(CASE WHEN json_valid(records.body)" \
    " THEN records.body ELSE '{}' END, '$.kept.figures') AS f"
    static const char named_figures[] = NAMED_FIGURES;
    static const char missing_figures[] =
        NAMED_FIGURES " WHERE NOT EXISTS(SELECT 1 FROM record_figures AS g WHERE g.record = records.n AND g.place ="
                      " json_extract(f.value, '$.place'))";
    int64_t n = 0;
    sqlite3_stmt *row = sql_prepare(db, has_figures, err);
    if (!row)
        return false;
    const bool is_there = sqlite3_step(row) == SQLITE_ROW;
    (void)sqlite3_finalize(row);
    return (!is_there || for_each(db, figures, 0, check_figure, &n, err)) &&
           for_each(db, is_there ? missing_figures : named_figures, 0, refuse_missing_figure, &n, err);
}

bool verify_items(sqlite3 *db, int64_t *n, struct error *err)
{
    static const char items[] =
        "SELECT items.kind, items.id, items.room, said.n, said.sha, items.body, said.is_deleted,"
        " items.kind NOT IN ('decision', 'signature', 'acceptance') AND items.changed_ms < ?1 FROM items LEFT JOIN said ON"
        " said.n = (SELECT max(n) FROM said WHERE said.room = items.room AND said.item = items.id)";
    static const char records[] =
        "SELECT records.kind, records.id, records.room, said.n, said.sha, records.item, said.record, records.body,"
        " records.hash FROM records LEFT JOIN said ON said.n = coalesce((SELECT max(n) FROM said WHERE said.room = records.room"
        " AND said.item = records.id AND said.action = 'record-erased'), (SELECT min(n) FROM said WHERE said.room ="
        " records.room AND said.item = records.id AND said.action = records.kind))";
    /* the newest row of each item, whose room was not deleted afterwards */
    static const char missing_items[] =
        "SELECT action, item, room, n FROM said AS a WHERE item IS NOT NULL AND NOT is_deleted AND action <> 'record-erased'"
        " AND n = (SELECT max(n) FROM said WHERE room = a.room AND item = a.item AND action <> 'record-erased') AND NOT EXISTS(SELECT 1 FROM items WHERE items.room = a.room AND"
        " items.id = a.item) AND NOT EXISTS(SELECT 1 FROM said AS d WHERE d.room = a.room AND d.action = 'deleted' AND"
        " d.n > a.n)";
    static const char missing_records[] =
        "SELECT action, item, room, n FROM said AS a WHERE action IN ('decision', 'signature') AND record IS NOT NULL AND"
        " NOT EXISTS(SELECT 1 FROM records WHERE records.room = a.room AND records.id = a.item)";
    static const char cut_recordings[] =
        "SELECT 'recording', id, room, json_extract(facts, '$.n_batches'), '', (SELECT count(*) FROM recording_batches AS"
        " b WHERE b.room = r.room AND b.recording = r.id) FROM recordings AS r WHERE json_valid(facts) AND (SELECT"
        " count(*) FROM recording_batches AS b WHERE b.room = r.room AND b.recording = r.id) <"
        " json_extract(facts, '$.n_batches')";
    int64_t n_missing = 0;
    *n = 0;
    sqlite3_stmt *row = sql_run(db, collect, err) ? sql_prepare(db, since, err) : NULL;
    bool ok = row && (sqlite3_step(row) == SQLITE_ROW || sql_fail(db, "comparing items with the audit", err));
    const double since_ms = ok ? sqlite3_column_double(row, 0) : 0;
    (void)sqlite3_finalize(row);
    return ok && for_each(db, items, since_ms, check_item, n, err) && for_each(db, records, 0, check_record, n, err) &&
           for_each(db, missing_items, 0, refuse_missing, &n_missing, err) &&
           for_each(db, missing_records, 0, refuse_missing, &n_missing, err) && check_figures(db, err) &&
           for_each(db, cut_recordings, 0, refuse_cut, &n_missing, err);
}
