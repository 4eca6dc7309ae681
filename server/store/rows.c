/* The statements that write and read rooms. */
#include "server/store/rows.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/store/recordings.h"
#include "server/store/records.h"
#include "server/store/sql.h"

void store_room_free(struct store_room *room)
{
    if (!room)
        return;
    for (size_t i = 0; i < room->n_items; i++)
        free(room->items[i].body);
    for (size_t i = 0; i < room->n_recordings; i++)
        store_recording_finish(&room->recordings[i]);
    free(room->recordings);
    for (size_t i = 0; i < room->n_records; i++)
        store_record_finish(&room->records[i]);
    free(room->records);
    for (size_t i = 0; i < room->n_audit; i++)
        free(room->audit[i]);
    free(room->audit);
    store_meeting_free(room->meeting);
    store_statement_free(room->statement);
    free(room->items);
    free(room->members);
    free(room->links);
    free(room->scene);
    free(room->views);
    free(room->presence);
    free(room->people);
    free(room);
}

/* ---- writing ---------------------------------------------------------------------------------------------------- */

static bool write_row(sqlite3 *db, const struct store_room *room, struct error *err)
{
    sqlite3_stmt *row = sql_prepare(
        db,
        "INSERT INTO rooms(id, plan, created_ms, used_ms, revision, n_named, presenter, scene, views, has_links,"
        " presence, owner, people, is_open, name, is_changed)"
        " VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16)"
        " ON CONFLICT(id) DO UPDATE SET used_ms = ?4, revision = ?5, n_named = ?6, presenter = ?7,"
        " scene = coalesce(?8, scene), views = coalesce(?9, views), has_links = ?10,"
        " presence = coalesce(?11, presence), owner = ?12, people = coalesce(?13, people), is_open = ?14,"
        " name = ?15, is_changed = ?16",
        err);
    if (!row)
        return false;
    sql_bind_text(row, 1, room->id);
    sql_bind_text(row, 2, room->plan);
    (void)sqlite3_bind_int64(row, 3, room->created_ms);
    (void)sqlite3_bind_int64(row, 4, room->used_ms);
    (void)sqlite3_bind_int64(row, 5, room->revision);
    (void)sqlite3_bind_int64(row, 6, room->n_named);
    sql_bind_text(row, 7, room->presenter);
    sql_bind_text(row, 8, room->scene);
    sql_bind_text(row, 9, room->views);
    (void)sqlite3_bind_int(row, 10, room->has_links);
    sql_bind_text(row, 11, room->presence);
    sql_bind_text(row, 12, room->owner);
    sql_bind_text(row, 13, room->people);
    (void)sqlite3_bind_int(row, 14, room->is_open);
    sql_bind_text(row, 15, room->name);
    (void)sqlite3_bind_int(row, 16, room->is_changed);
    bool ok = sql_step(row, "writing a room", err);
    (void)sqlite3_finalize(row);
    return ok;
}

static bool run_for(sqlite3 *db, const char *sql, const char *room, const char *id, const char *what, struct error *err)
{
    sqlite3_stmt *row = sql_prepare(db, sql, err);
    if (!row)
        return false;
    sql_bind_text(row, 1, room);
    if (id)
        sql_bind_text(row, 2, id);
    bool ok = sql_step(row, what, err);
    (void)sqlite3_finalize(row);
    return ok;
}

static bool write_members(sqlite3 *db, const struct store_room *room, struct error *err)
{
    if (!run_for(db, "DELETE FROM members WHERE room = ?1", room->id, NULL, "writing members", err))
        return false;
    sqlite3_stmt *row = sql_prepare(db,
                                    "INSERT INTO members(room, place, id, name, color, role, secret_hash, has_left,"
                                    " user, is_guest, link, waits_outside)"
                                    " VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12)",
                                    err);
    bool ok = row != NULL;
    for (size_t i = 0; ok && i < room->n_members; i++) {
        const struct store_member *member = &room->members[i];
        sql_bind_text(row, 1, room->id);
        (void)sqlite3_bind_int64(row, 2, (sqlite3_int64)i);
        sql_bind_text(row, 3, member->id);
        sql_bind_text(row, 4, member->name);
        sql_bind_text(row, 5, member->color);
        sql_bind_text(row, 6, member->role);
        (void)sqlite3_bind_blob(row, 7, member->secret_hash, STORE_HASH_BYTES, SQLITE_TRANSIENT);
        (void)sqlite3_bind_int(row, 8, member->has_left);
        sql_bind_text(row, 9, member->user);
        (void)sqlite3_bind_int(row, 10, member->is_guest);
        sql_bind_text(row, 11, member->link);
        (void)sqlite3_bind_int(row, 12, member->waits_outside);
        ok = sql_step(row, "writing members", err);
    }
    (void)sqlite3_finalize(row);
    return ok;
}

static bool write_links(sqlite3 *db, const struct store_room *room, struct error *err)
{
    if (!run_for(db, "DELETE FROM links WHERE room = ?1", room->id, NULL, "writing links", err))
        return false;
    sqlite3_stmt *row =
        sql_prepare(db,
                    "INSERT INTO links(room, place, token_hash, role, expires_ms, is_one_use, is_used, person,"
                    " maker, name, allows_guests) VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11)",
                    err);
    bool ok = row != NULL;
    for (size_t i = 0; ok && i < room->n_links; i++) {
        const struct store_link *link = &room->links[i];
        sql_bind_text(row, 1, room->id);
        (void)sqlite3_bind_int64(row, 2, (sqlite3_int64)i);
        (void)sqlite3_bind_blob(row, 3, link->token_hash, STORE_HASH_BYTES, SQLITE_TRANSIENT);
        sql_bind_text(row, 4, link->role);
        (void)sqlite3_bind_int64(row, 5, link->expires_ms);
        (void)sqlite3_bind_int(row, 6, link->is_one_use);
        (void)sqlite3_bind_int(row, 7, link->is_used);
        sql_bind_text(row, 8, link->person);
        sql_bind_text(row, 9, link->maker);
        sql_bind_text(row, 10, link->name);
        (void)sqlite3_bind_int(row, 11, link->allows_guests);
        ok = sql_step(row, "writing links", err);
    }
    (void)sqlite3_finalize(row);
    return ok;
}

static bool write_item(sqlite3 *db, const char *room, const struct store_item *item, struct error *err)
{
    if (!item->body)
        return run_for(db, "DELETE FROM items WHERE room = ?1 AND id = ?2", room, item->id, "deleting an item", err);
    sqlite3_stmt *row =
        sql_prepare(db,
                    "INSERT INTO items(room, id, kind, version, author, author_name, created_ms, changed_ms, body)"
                    " VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9) ON CONFLICT(room, id) DO UPDATE SET kind = ?3,"
                    " version = ?4, author = ?5, author_name = ?6, created_ms = ?7, changed_ms = ?8, body = ?9",
                    err);
    if (!row)
        return false;
    sql_bind_text(row, 1, room);
    sql_bind_text(row, 2, item->id);
    sql_bind_text(row, 3, item->kind);
    (void)sqlite3_bind_int64(row, 4, item->version);
    sql_bind_text(row, 5, item->author);
    sql_bind_text(row, 6, item->author_name);
    (void)sqlite3_bind_int64(row, 7, item->created_ms);
    (void)sqlite3_bind_int64(row, 8, item->changed_ms);
    sql_bind_text(row, 9, item->body);
    bool ok = sql_step(row, "writing an item", err);
    (void)sqlite3_finalize(row);
    return ok;
}

bool rows_write_room(sqlite3 *db, const struct store_room *room, struct error *err)
{
    if (!write_row(db, room, err) || (room->members && !write_members(db, room, err)) ||
        (room->links && !write_links(db, room, err)))
        return false;
    for (size_t i = 0; i < room->n_items; i++)
        if (!write_item(db, room->id, &room->items[i], err))
            return false;
    return recordings_write(db, room, err);
}

/* A room that was never written begins with what is known; the write that follows has the rest. */
static bool write_begun(sqlite3 *db, const struct store_room *room, struct error *err)
{
    sqlite3_stmt *row = sql_prepare(db,
                                    "INSERT INTO rooms(id, plan, created_ms, used_ms, revision, n_named, has_links,"
                                    " owner, is_open) VALUES(?1, ?2, ?3, ?4, 0, ?5, ?6, ?7, ?8)"
                                    " ON CONFLICT(id) DO NOTHING",
                                    err);
    if (!row)
        return false;
    sql_bind_text(row, 1, room->id);
    sql_bind_text(row, 2, room->plan);
    (void)sqlite3_bind_int64(row, 3, room->created_ms);
    (void)sqlite3_bind_int64(row, 4, room->used_ms);
    (void)sqlite3_bind_int64(row, 5, room->n_named);
    (void)sqlite3_bind_int(row, 6, room->has_links);
    sql_bind_text(row, 7, room->owner);
    (void)sqlite3_bind_int(row, 8, room->is_open);
    bool ok = sql_step(row, "writing a room", err);
    (void)sqlite3_finalize(row);
    return ok;
}

bool rows_write_prompt(sqlite3 *db, const struct store_room *room, struct error *err)
{
    if (!write_begun(db, room, err))
        return false;
    for (size_t i = 0; i < room->n_items; i++)
        if (!write_item(db, room->id, &room->items[i], err))
            return false;
    return records_write(db, room, err);
}

bool rows_delete_room(sqlite3 *db, const char *id, struct error *err)
{
    return run_for(db, "DELETE FROM rooms WHERE id = ?1", id, NULL, "deleting a room", err);
}

/* ---- reading ---------------------------------------------------------------------------------------------------- */

static bool read_row(sqlite3 *db, const char *id, struct store_room *room, struct error *err)
{
    sqlite3_stmt *row = sql_prepare(db,
                                    "SELECT id, plan, created_ms, used_ms, revision, n_named, presenter, scene,"
                                    " views, has_links, presence, owner, people, is_open, name, is_changed FROM rooms"
                                    " WHERE id = ?1",
                                    err);
    if (!row)
        return false;
    sql_bind_text(row, 1, id);
    int step = sqlite3_step(row);
    bool ok = step == SQLITE_ROW;
    if (ok) {
        sql_text(row, 0, room->id, sizeof room->id);
        sql_text(row, 1, room->plan, sizeof room->plan);
        room->created_ms = sqlite3_column_int64(row, 2);
        room->used_ms = sqlite3_column_int64(row, 3);
        room->revision = (uint32_t)sqlite3_column_int64(row, 4);
        room->n_named = (uint32_t)sqlite3_column_int64(row, 5);
        sql_text(row, 6, room->presenter, sizeof room->presenter);
        room->scene = sql_copy_text(row, 7);
        room->views = sql_copy_text(row, 8);
        room->has_links = sqlite3_column_int(row, 9) != 0;
        room->presence = sql_copy_text(row, 10);
        sql_text(row, 11, room->owner, sizeof room->owner);
        room->people = sql_copy_text(row, 12);
        room->is_open = sqlite3_column_int(row, 13) != 0;
        sql_text(row, 14, room->name, sizeof room->name);
        room->is_changed = sqlite3_column_int(row, 15) != 0;
    } else if (step == SQLITE_DONE) {
        error_set(err, ERROR_NOT_FOUND, "there is no room \"%.63s\"", id);
    } else {
        sql_fail(db, "reading a room", err);
    }
    (void)sqlite3_finalize(row);
    return ok;
}

bool rows_read_list(sqlite3 *db, const char *sql, const char *id, size_t size, size_t most,
                    bool (*read)(sqlite3_stmt *row, void *to), void **list, size_t *n, struct error *err)
{
    sqlite3_stmt *row = sql_prepare(db, sql, err);
    size_t capacity = 0;
    bool ok = row != NULL;
    if (ok && id)
        sql_bind_text(row, 1, id);
    for (int step; ok && (step = sqlite3_step(row)) != SQLITE_DONE;) {
        if (step != SQLITE_ROW) {
            ok = sql_fail(db, "reading", err);
            break;
        }
        if (*n == most)
            break;
        if (*n == capacity) {
            capacity = capacity ? 2 * capacity : 16;
            void *larger = realloc(*list, capacity * size);
            if (!larger) {
                ok = error_set(err, ERROR_MEMORY, "no memory for %zu rows", capacity);
                break;
            }
            *list = larger;
        }
        char *to = (char *)*list + *n * size;
        memset(to, 0, size);
        ++*n; /* before it is read: what is read in part is freed with the list */
        ok = read(row, to) || error_set(err, ERROR_MEMORY, "no memory for a row");
    }
    (void)sqlite3_finalize(row);
    return ok;
}

static bool read_member(sqlite3_stmt *row, void *to)
{
    struct store_member *member = to;
    sql_text(row, 0, member->id, sizeof member->id);
    sql_text(row, 1, member->name, sizeof member->name);
    sql_text(row, 2, member->color, sizeof member->color);
    sql_text(row, 3, member->role, sizeof member->role);
    if (sqlite3_column_bytes(row, 4) == STORE_HASH_BYTES)
        memcpy(member->secret_hash, sqlite3_column_blob(row, 4), STORE_HASH_BYTES);
    member->has_left = sqlite3_column_int(row, 5) != 0;
    sql_text(row, 6, member->user, sizeof member->user);
    member->is_guest = sqlite3_column_int(row, 7) != 0;
    sql_text(row, 8, member->link, sizeof member->link);
    member->waits_outside = sqlite3_column_int(row, 9) != 0;
    return true;
}

static bool read_link(sqlite3_stmt *row, void *to)
{
    struct store_link *link = to;
    if (sqlite3_column_bytes(row, 0) == STORE_HASH_BYTES)
        memcpy(link->token_hash, sqlite3_column_blob(row, 0), STORE_HASH_BYTES);
    sql_text(row, 1, link->role, sizeof link->role);
    link->expires_ms = sqlite3_column_int64(row, 2);
    link->is_one_use = sqlite3_column_int(row, 3) != 0;
    link->is_used = sqlite3_column_int(row, 4) != 0;
    sql_text(row, 5, link->person, sizeof link->person);
    sql_text(row, 6, link->maker, sizeof link->maker);
    sql_text(row, 7, link->name, sizeof link->name);
    link->allows_guests = sqlite3_column_int(row, 8) != 0;
    return true;
}

static bool read_item(sqlite3_stmt *row, void *to)
{
    struct store_item *item = to;
    sql_text(row, 0, item->id, sizeof item->id);
    sql_text(row, 1, item->kind, sizeof item->kind);
    item->version = sqlite3_column_int64(row, 2);
    sql_text(row, 3, item->author, sizeof item->author);
    sql_text(row, 4, item->author_name, sizeof item->author_name);
    item->created_ms = sqlite3_column_int64(row, 5);
    item->changed_ms = sqlite3_column_int64(row, 6);
    item->body = sql_copy_text(row, 7);
    return item->body != NULL;
}

static bool read_recording(sqlite3_stmt *row, void *to)
{
    struct store_recording *recording = to;
    sql_text(row, 0, recording->id, sizeof recording->id);
    recording->facts = sql_copy_text(row, 1);
    return recording->facts != NULL;
}

static bool read_summary(sqlite3_stmt *row, void *to)
{
    struct store_summary *room = to;
    sql_text(row, 0, room->id, sizeof room->id);
    sql_text(row, 1, room->plan, sizeof room->plan);
    room->created_ms = sqlite3_column_int64(row, 2);
    room->used_ms = sqlite3_column_int64(row, 3);
    room->revision = (uint32_t)sqlite3_column_int64(row, 4);
    room->n_members = (uint32_t)sqlite3_column_int64(row, 5);
    room->n_decided = (uint32_t)sqlite3_column_int64(row, 6);
    sql_text(row, 7, room->owner, sizeof room->owner);
    room->is_open = sqlite3_column_int(row, 8) != 0;
    room->people = sql_copy_text(row, 9);
    sql_text(row, 10, room->name, sizeof room->name);
    room->is_changed = sqlite3_column_int(row, 11) != 0;
    room->n_notes = (uint32_t)sqlite3_column_int64(row, 12);
    room->names = sql_copy_text(row, 13);
    room->users = sql_copy_text(row, 14);
    return true;
}

struct store_room *rows_read_room(sqlite3 *db, const char *id, struct error *err)
{
    struct store_room *room = mem_new(sizeof *room);
    void *members = NULL, *links = NULL, *items = NULL, *recordings = NULL;
    bool ok =
        read_row(db, id, room, err) &&
        rows_read_list(db,
                       "SELECT id, name, color, role, secret_hash, has_left, user, is_guest, link, waits_outside"
                       " FROM members WHERE room = ?1 ORDER BY place",
                       id, sizeof(struct store_member), STORE_MAX_MEMBERS, read_member, &members, &room->n_members,
                       err) &&
        rows_read_list(db,
                       "SELECT token_hash, role, expires_ms, is_one_use, is_used, person, maker, name, allows_guests"
                       " FROM links WHERE room = ?1 ORDER BY place",
                       id, sizeof(struct store_link), STORE_MAX_LINKS, read_link, &links, &room->n_links, err) &&
        rows_read_list(db,
                       "SELECT id, kind, version, author, author_name, created_ms, changed_ms, body FROM items"
                       " WHERE room = ?1 ORDER BY created_ms, rowid",
                       id, sizeof(struct store_item), STORE_MAX_ITEMS, read_item, &items, &room->n_items, err) &&
        rows_read_list(db, "SELECT id, facts FROM recordings WHERE room = ?1 ORDER BY rowid", id,
                       sizeof(struct store_recording), STORE_MAX_RECORDINGS, read_recording, &recordings,
                       &room->n_recordings, err);
    room->members = members;
    room->links = links;
    room->items = items;
    room->recordings = recordings;
    if (ok)
        return room;
    store_room_free(room);
    return NULL;
}

struct store_room *rows_read_saved(sqlite3 *db, const char *token, struct error *err)
{
    char id[64] = "";
    sqlite3_stmt *statement =
        sql_prepare(db, "SELECT room FROM items WHERE kind = 'bookmark' AND instr(body, '\"token\":\"' || ?1 || '\"')",
                    err);
    if (!statement)
        return NULL;
    sql_bind_text(statement, 1, token);
    if (sqlite3_step(statement) == SQLITE_ROW)
        sql_text(statement, 0, id, sizeof id);
    sqlite3_finalize(statement);
    return rows_read_room(db, id, err);
}

void store_summary_finish(struct store_summary *room)
{
    free(room->people);
    free(room->names);
    free(room->users);
}

void store_summaries_free(struct store_summary *rooms, size_t n)
{
    for (size_t i = 0; rooms && i < n; i++)
        store_summary_finish(&rooms[i]);
    free(rooms);
}

struct store_summary *rows_list_rooms(sqlite3 *db, size_t most, size_t *n, struct error *err)
{
    void *list = mem_new(1);
    *n = 0;
    if (rows_read_list(db,
                       "SELECT id, plan, created_ms, used_ms, revision,"
                       " (SELECT count(*) FROM members WHERE members.room = rooms.id),"
                       " (SELECT count(*) FROM records WHERE records.room = rooms.id), owner, is_open, people,"
                       " name, is_changed, (SELECT count(*) FROM items WHERE items.room = rooms.id AND kind = 'note'),"
                       " (SELECT group_concat(name || char(10), '') FROM (SELECT DISTINCT name FROM members"
                       "   WHERE members.room = rooms.id AND role <> 'wall' LIMIT 8)),"
                       " (SELECT group_concat(user || char(10), '') FROM (SELECT DISTINCT user FROM members"
                       "   WHERE members.room = rooms.id AND user <> '')) FROM rooms"
                       " ORDER BY used_ms DESC, id",
                       NULL, sizeof(struct store_summary), most, read_summary, &list, n, err))
        return list;
    store_summaries_free(list, *n);
    return NULL;
}
