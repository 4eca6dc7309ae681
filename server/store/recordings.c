/* The statements that write and read recordings. */
#include "server/store/recordings.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/store/sql.h"

void store_part_free(struct store_part *part)
{
    if (!part)
        return;
    for (size_t i = 0; i < part->n; i++)
        free(part->texts[i]);
    free(part->texts);
    free(part);
}

void store_recording_finish(struct store_recording *recording)
{
    for (size_t i = 0; i < recording->n_batches; i++)
        free(recording->batches[i].text);
    free(recording->batches);
    free(recording->facts);
    *recording = (struct store_recording){ 0 };
}

/* ---- writing ---------------------------------------------------------------------------------------------------- */

static bool write_facts(sqlite3 *db, const char *room, const struct store_recording *recording, struct error *err)
{
    sqlite3_stmt *row = sql_prepare(db,
                                    recording->facts ? "INSERT INTO recordings(room, id, facts) VALUES(?1, ?2, ?3)"
                                                       " ON CONFLICT(room, id) DO UPDATE SET facts = ?3"
                                                     : "DELETE FROM recordings WHERE room = ?1 AND id = ?2",
                                    err);
    if (!row)
        return false;
    sql_bind_text(row, 1, room);
    sql_bind_text(row, 2, recording->id);
    if (recording->facts)
        sql_bind_text(row, 3, recording->facts);
    bool ok = sql_step(row, "writing a recording", err);
    (void)sqlite3_finalize(row);
    return ok;
}

static bool write_batches(sqlite3 *db, const char *room, const struct store_recording *recording, struct error *err)
{
    sqlite3_stmt *row = sql_prepare(db,
                                    "INSERT OR REPLACE INTO recording_batches(room, recording, place, t_ms, is_state,"
                                    " body) VALUES(?1, ?2, ?3, ?4, ?5, ?6)",
                                    err);
    bool ok = row != NULL;
    for (size_t i = 0; ok && i < recording->n_batches; i++) {
        const struct store_batch *batch = &recording->batches[i];
        sql_bind_text(row, 1, room);
        sql_bind_text(row, 2, recording->id);
        (void)sqlite3_bind_int64(row, 3, batch->place);
        (void)sqlite3_bind_int64(row, 4, batch->t_ms);
        (void)sqlite3_bind_int(row, 5, batch->is_state);
        sql_bind_text(row, 6, batch->text);
        ok = sql_step(row, "writing a recording", err);
    }
    (void)sqlite3_finalize(row);
    return ok;
}

bool recordings_write(sqlite3 *db, const struct store_room *room, struct error *err)
{
    for (size_t i = 0; i < room->n_recordings; i++) {
        const struct store_recording *recording = &room->recordings[i];
        if (!write_facts(db, room->id, recording, err) ||
            (recording->facts && recording->n_batches && !write_batches(db, room->id, recording, err)))
            return false;
    }
    return true;
}

/* ---- reading ---------------------------------------------------------------------------------------------------- */

/* The place of the batch that the part begins with; false: there is none. */
static bool find_first(sqlite3 *db, const char *room, const char *recording, int64_t t_ms, int64_t *place,
                       struct error *err)
{
    sqlite3_stmt *row = sql_prepare(db,
                                    "SELECT coalesce(max(CASE WHEN t_ms <= ?3 THEN place END), min(place)) FROM"
                                    " recording_batches WHERE room = ?1 AND recording = ?2 AND is_state",
                                    err);
    if (!row)
        return false;
    sql_bind_text(row, 1, room);
    sql_bind_text(row, 2, recording);
    (void)sqlite3_bind_int64(row, 3, t_ms);
    bool ok = sqlite3_step(row) == SQLITE_ROW || sql_fail(db, "reading a recording", err);
    if (ok && sqlite3_column_type(row, 0) == SQLITE_NULL)
        ok = error_set(err, ERROR_NOT_FOUND, "nothing of this recording is on the disk");
    if (ok)
        *place = sqlite3_column_int64(row, 0);
    (void)sqlite3_finalize(row);
    return ok;
}

/* Adds the batch of this row. False: ERROR_MEMORY or ERROR_LIMIT. */
static bool add(struct store_part *part, sqlite3_stmt *row, uint64_t *n_bytes, struct error *err)
{
    *n_bytes += (uint64_t)sqlite3_column_bytes(row, 2);
    if (*n_bytes > STORE_MAX_PART_BYTES)
        return error_set(err, ERROR_LIMIT, "a part of the recording has more than %d bytes", STORE_MAX_PART_BYTES);
    void *more = realloc(part->texts, (part->n + 1) * sizeof part->texts[0]);
    if (!more)
        return error_set(err, ERROR_MEMORY, "no memory for a recording");
    part->texts = more;
    part->texts[part->n] = sql_copy_text(row, 2);
    if (!part->texts[part->n])
        return error_set(err, ERROR_MEMORY, "no memory for a recording");
    part->n++;
    return true;
}

/* A batch is missing behind those of the part, the last of which begins at last_ms: the part ends there. False: t_ms
 * lies in what is missing. */
static bool end_at_gap(struct store_part *part, int64_t last_ms, int64_t t_ms, struct error *err)
{
    if (t_ms > last_ms)
        return error_set(err, ERROR_FORMAT, "what was recorded after %lld ms is missing, up to the next whole state",
                         (long long)last_ms);
    part->next_ms = last_ms + 1;
    return true;
}

/* How many batches the recording has by its facts, which are written with each of them; 0: not known. */
static int64_t read_n_batches(sqlite3 *db, const char *room, const char *recording)
{
    sqlite3_stmt *row = sql_prepare(db,
                                    "SELECT json_extract(facts, '$.n_batches') FROM recordings WHERE room = ?1 AND id ="
                                    " ?2 AND json_valid(facts)",
                                    NULL);
    if (!row)
        return 0;
    sql_bind_text(row, 1, room);
    sql_bind_text(row, 2, recording);
    const int64_t n = sqlite3_step(row) == SQLITE_ROW ? sqlite3_column_int64(row, 0) : 0;
    (void)sqlite3_finalize(row);
    return n;
}

struct store_part *recordings_read_part(sqlite3 *db, const char *room, const char *recording, int64_t t_ms,
                                        struct error *err)
{
    int64_t first = 0;
    uint64_t n_bytes = 0;
    if (!find_first(db, room, recording, t_ms, &first, err))
        return NULL;
    sqlite3_stmt *row = sql_prepare(db,
                                    "SELECT t_ms, is_state, body, place FROM recording_batches WHERE room = ?1 AND"
                                    " recording = ?2 AND place >= ?3 ORDER BY place",
                                    err);
    if (!row)
        return NULL;
    struct store_part *part = mem_new(sizeof *part);
    part->next_ms = INT64_MAX;
    sql_bind_text(row, 1, room);
    sql_bind_text(row, 2, recording);
    (void)sqlite3_bind_int64(row, 3, first);
    bool ok = true;
    int64_t last_ms = 0;
    for (int step; ok && (step = sqlite3_step(row)) != SQLITE_DONE;) {
        if (step != SQLITE_ROW) {
            ok = sql_fail(db, "reading a recording", err);
        } else if (sqlite3_column_int64(row, 3) - first != (int64_t)part->n) {
            ok = end_at_gap(part, last_ms, t_ms, err);
            break;
        } else if (part->n && sqlite3_column_int(row, 1)) {
            part->next_ms = sqlite3_column_int64(row, 0);
            break;
        } else {
            last_ms = sqlite3_column_int64(row, 0);
            ok = add(part, row, &n_bytes, err);
        }
    }
    (void)sqlite3_finalize(row);
    if (ok && part->next_ms == INT64_MAX && first + (int64_t)part->n < read_n_batches(db, room, recording))
        ok = end_at_gap(part, last_ms, t_ms, err); /* its end is missing */
    if (ok)
        return part;
    store_part_free(part);
    return NULL;
}
