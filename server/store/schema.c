/* The steps of the schema. */
#include "server/store/schema.h"

#include <stdio.h>

#include "server/store/records.h"
#include "server/store/sql.h"

static const char *const steps[] = {
    /* 1: rooms and who was in them */
    "CREATE TABLE rooms(id TEXT PRIMARY KEY, plan TEXT NOT NULL, created_ms INTEGER NOT NULL, revision INTEGER NOT NULL,"
    " n_named INTEGER NOT NULL, scene TEXT, views TEXT) STRICT;"
    "CREATE TABLE members(room TEXT NOT NULL REFERENCES rooms(id) ON DELETE CASCADE, place INTEGER NOT NULL,"
    " id TEXT NOT NULL, name TEXT NOT NULL, secret_hash BLOB NOT NULL, PRIMARY KEY(room, id)) STRICT;",
    /* 2: notes and bookmarks; roles and colours of members; when a room was last used and who presented */
    "ALTER TABLE rooms ADD COLUMN used_ms INTEGER NOT NULL DEFAULT 0;"
    "UPDATE rooms SET used_ms = created_ms;"
    "ALTER TABLE rooms ADD COLUMN presenter TEXT NOT NULL DEFAULT '';"
    "ALTER TABLE members ADD COLUMN color TEXT NOT NULL DEFAULT '';"
    "ALTER TABLE members ADD COLUMN role TEXT NOT NULL DEFAULT '';"
    "ALTER TABLE members ADD COLUMN has_left INTEGER NOT NULL DEFAULT 0;"
    "CREATE TABLE items(room TEXT NOT NULL REFERENCES rooms(id) ON DELETE CASCADE, id TEXT NOT NULL,"
    " kind TEXT NOT NULL, version INTEGER NOT NULL, author TEXT NOT NULL, author_name TEXT NOT NULL,"
    " created_ms INTEGER NOT NULL, changed_ms INTEGER NOT NULL, body TEXT NOT NULL, PRIMARY KEY(room, id)) STRICT;",
    /* 3: links of rooms */
    "ALTER TABLE rooms ADD COLUMN has_links INTEGER NOT NULL DEFAULT 0;"
    "CREATE TABLE links(room TEXT NOT NULL REFERENCES rooms(id) ON DELETE CASCADE, place INTEGER NOT NULL,"
    " token_hash BLOB NOT NULL, role TEXT NOT NULL, expires_ms INTEGER NOT NULL, is_one_use INTEGER NOT NULL,"
    " is_used INTEGER NOT NULL, person TEXT NOT NULL, PRIMARY KEY(room, place)) STRICT;",
    /* 4: the audit, to which rows are only added, in their order; who was in a room and when */
    "CREATE TABLE audit(n INTEGER PRIMARY KEY, row TEXT NOT NULL, hash TEXT NOT NULL) STRICT;"
    "CREATE TRIGGER audit_order BEFORE INSERT ON audit WHEN NEW.n IS NOT (SELECT coalesce(max(n), 0) + 1 FROM audit)"
    " BEGIN SELECT RAISE(ABORT, 'rows of the audit are added at its end'); END;"
    "CREATE TRIGGER audit_update BEFORE UPDATE ON audit BEGIN SELECT RAISE(ABORT, 'the audit is never changed'); END;"
    "CREATE TRIGGER audit_delete BEFORE DELETE ON audit BEGIN SELECT RAISE(ABORT, 'the audit is never deleted'); END;"
    "ALTER TABLE rooms ADD COLUMN presence TEXT;",
    /* 5: recordings of meetings */
    "CREATE TABLE recordings(room TEXT NOT NULL REFERENCES rooms(id) ON DELETE CASCADE, id TEXT NOT NULL,"
    " facts TEXT NOT NULL, PRIMARY KEY(room, id)) STRICT;"
    "CREATE TABLE recording_batches(room TEXT NOT NULL, recording TEXT NOT NULL, place INTEGER NOT NULL,"
    " t_ms INTEGER NOT NULL, is_state INTEGER NOT NULL, body TEXT NOT NULL, PRIMARY KEY(room, recording, place),"
    " FOREIGN KEY(room, recording) REFERENCES recordings(room, id) ON DELETE CASCADE) STRICT;",
    /* 6: the newest row of the audit beside it, so that a removed end is seen; records of decisions and signatures,
     * which outlive their rooms. Of earlier ones there is the item alone; the hash is that of {} */
    "CREATE TABLE audit_head(id INTEGER PRIMARY KEY CHECK(id = 1), n INTEGER NOT NULL, hash TEXT NOT NULL) STRICT;"
    "INSERT INTO audit_head(id, n, hash) SELECT 1, coalesce(max(n), 0), coalesce((SELECT hash FROM audit ORDER BY n DESC"
    " LIMIT 1), '0000000000000000000000000000000000000000000000000000000000000000') FROM audit;"
    "CREATE TRIGGER audit_head_order BEFORE UPDATE ON audit_head WHEN NEW.n <= OLD.n"
    " BEGIN SELECT RAISE(ABORT, 'the audit only grows'); END;"
    "CREATE TRIGGER audit_head_delete BEFORE DELETE ON audit_head"
    " BEGIN SELECT RAISE(ABORT, 'the audit is never deleted'); END;"
    "CREATE TABLE records(n INTEGER PRIMARY KEY, id TEXT NOT NULL, room TEXT NOT NULL, plan TEXT NOT NULL,"
    " kind TEXT NOT NULL, author TEXT NOT NULL, author_name TEXT NOT NULL, time_ms INTEGER NOT NULL, item TEXT NOT NULL,"
    " body TEXT NOT NULL, hash TEXT NOT NULL, UNIQUE(room, id)) STRICT;"
    "CREATE INDEX records_id ON records(id);"
    "INSERT INTO records(id, room, plan, kind, author, author_name, time_ms, item, body, hash) SELECT items.id,"
    " items.room, rooms.plan, kind, author, author_name, items.created_ms, body, '{}',"
    " '44136fa355b3678a1146ad16f7e8649e94fb4fc21fe77e8310c060f61caaff8a' FROM items JOIN rooms ON rooms.id = items.room"
    " WHERE kind IN ('decision', 'signature') ORDER BY items.created_ms, items.rowid;"
    "CREATE TRIGGER records_update BEFORE UPDATE ON records BEGIN SELECT RAISE(ABORT, 'a record is never changed'); END;"
    "CREATE TRIGGER records_delete BEFORE DELETE ON records BEGIN SELECT RAISE(ABORT, 'a record is never deleted'); END;",
    /* 7: who signs in and how; who owns what; who may come into a room */
    "CREATE TABLE users(id TEXT PRIMARY KEY, name TEXT NOT NULL, password TEXT NOT NULL, is_disabled INTEGER NOT NULL,"
    " failed INTEGER NOT NULL, locked_until_ms INTEGER NOT NULL, created_ms INTEGER NOT NULL) STRICT;"
    "CREATE TABLE user_groups(user TEXT NOT NULL REFERENCES users(id) ON DELETE CASCADE, name TEXT NOT NULL,"
    " PRIMARY KEY(user, name)) STRICT;"
    "CREATE TABLE tokens(id TEXT PRIMARY KEY, hash BLOB NOT NULL, user TEXT NOT NULL, name TEXT NOT NULL,"
    " scope TEXT NOT NULL, folders TEXT NOT NULL, created_ms INTEGER NOT NULL, expires_ms INTEGER NOT NULL,"
    " used_ms INTEGER NOT NULL, revoked_ms INTEGER NOT NULL) STRICT;"
    "CREATE TABLE sessions(hash BLOB PRIMARY KEY, user TEXT NOT NULL, name TEXT NOT NULL, \"groups\" TEXT NOT NULL,"
    " source TEXT NOT NULL, address TEXT NOT NULL, created_ms INTEGER NOT NULL, seen_ms INTEGER NOT NULL,"
    " proved_ms INTEGER NOT NULL) STRICT;"
    "CREATE TABLE owners(plan TEXT PRIMARY KEY, user TEXT NOT NULL) STRICT;"
    "ALTER TABLE rooms ADD COLUMN owner TEXT NOT NULL DEFAULT '';"
    "ALTER TABLE rooms ADD COLUMN people TEXT;"
    "ALTER TABLE rooms ADD COLUMN is_open INTEGER NOT NULL DEFAULT 0;"
    "ALTER TABLE members ADD COLUMN user TEXT NOT NULL DEFAULT '';"
    "ALTER TABLE members ADD COLUMN link TEXT NOT NULL DEFAULT '';"
    "ALTER TABLE members ADD COLUMN is_guest INTEGER NOT NULL DEFAULT 0;"
    "ALTER TABLE links ADD COLUMN maker TEXT NOT NULL DEFAULT '';"
    "ALTER TABLE links ADD COLUMN name TEXT NOT NULL DEFAULT '';"
    "ALTER TABLE links ADD COLUMN allows_guests INTEGER NOT NULL DEFAULT 0;",
    /* 8: the pictures that are kept with the record of a decision */
    "CREATE TABLE record_figures(record INTEGER NOT NULL, place INTEGER NOT NULL, bytes BLOB NOT NULL,"
    " hash TEXT NOT NULL, PRIMARY KEY(record, place)) STRICT;"
    "CREATE TRIGGER record_figures_update BEFORE UPDATE ON record_figures"
    " BEGIN SELECT RAISE(ABORT, 'a record is never changed'); END;"
    "CREATE TRIGGER record_figures_delete BEFORE DELETE ON record_figures"
    " BEGIN SELECT RAISE(ABORT, 'a record is never deleted'); END;",
    /* 9: names of rooms; whether a person changed something in them: of earlier ones it is not known, and they stay */
    "ALTER TABLE rooms ADD COLUMN name TEXT NOT NULL DEFAULT '';"
    "ALTER TABLE rooms ADD COLUMN is_changed INTEGER NOT NULL DEFAULT 1;",
    /* 10: meetings of many cases */
    "CREATE TABLE meetings(id TEXT PRIMARY KEY, owner TEXT NOT NULL, body TEXT NOT NULL) STRICT;"
    "CREATE TABLE meeting_cases(meeting TEXT NOT NULL REFERENCES meetings(id) ON DELETE CASCADE, place INTEGER NOT NULL,"
    " id TEXT NOT NULL, plan TEXT NOT NULL, room TEXT NOT NULL, body TEXT NOT NULL, PRIMARY KEY(meeting, place)) STRICT;",
    /* 11: who waits outside of a case of a meeting that is not open to them */
    "ALTER TABLE members ADD COLUMN waits_outside INTEGER NOT NULL DEFAULT 0;",
    /* 12: what people have stated of whom plans are of */
    "CREATE TABLE statements(plan TEXT PRIMARY KEY, body TEXT NOT NULL) STRICT;",
    /* 13: what a list of records says of each: the verdict, plan and masked patient. Erased with the record */
    "CREATE TABLE record_facts(record INTEGER PRIMARY KEY, facts TEXT NOT NULL) STRICT;"
    "INSERT INTO record_facts(record, facts) SELECT n, " RECORD_FACTS " FROM records WHERE json_valid(item) AND"
    " json_valid(body);",
};
const int schema_version = (int)(sizeof steps / sizeof steps[0]);

static bool read_version(sqlite3 *db, int *version, struct error *err)
{
    sqlite3_stmt *statement = sql_prepare(db, "PRAGMA user_version", err);
    bool ok = statement && (sqlite3_step(statement) == SQLITE_ROW || sql_fail(db, "reading its version", err));
    *version = ok ? sqlite3_column_int(statement, 0) : 0;
    (void)sqlite3_finalize(statement);
    return ok;
}

bool schema_update(sqlite3 *db, struct error *err)
{
    int version;
    if (!read_version(db, &version, err))
        return false;
    if (version < 0 || version > schema_version)
        return error_set(err, ERROR_UNSUPPORTED,
                         "its version is %d, this program knows versions up to %d: run the program that made it",
                         version, schema_version);
    for (; version < schema_version; version++) {
        char mark[64];
        (void)snprintf(mark, sizeof mark, "PRAGMA user_version = %d", version + 1);
        if (!sql_run(db, "BEGIN IMMEDIATE", err))
            return false;
        if (!sql_run(db, steps[version], err) || !sql_run(db, mark, err) || !sql_run(db, "COMMIT", err)) {
            if (!sqlite3_get_autocommit(db))
                (void)sqlite3_exec(db, "ROLLBACK", NULL, NULL, NULL);
            return false;
        }
    }
    return true;
}
