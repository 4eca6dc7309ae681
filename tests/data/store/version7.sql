-- A database of version 7, as the program before meetings wrote it: rooms with an owner and people, a member, a note, a link, a user.
PRAGMA application_id = 1113940333;
PRAGMA user_version = 7;
BEGIN TRANSACTION;
CREATE TABLE audit(n INTEGER PRIMARY KEY, row TEXT NOT NULL, hash TEXT NOT NULL) STRICT;
CREATE TABLE audit_head(id INTEGER PRIMARY KEY CHECK(id = 1), n INTEGER NOT NULL, hash TEXT NOT NULL) STRICT;
INSERT INTO "audit_head" VALUES(1,0,'0000000000000000000000000000000000000000000000000000000000000000');
CREATE TABLE items(room TEXT NOT NULL REFERENCES rooms(id) ON DELETE CASCADE, id TEXT NOT NULL, kind TEXT NOT NULL,
 version INTEGER NOT NULL, author TEXT NOT NULL, author_name TEXT NOT NULL, created_ms INTEGER NOT NULL,
 changed_ms INTEGER NOT NULL, body TEXT NOT NULL, PRIMARY KEY(room, id)) STRICT;
INSERT INTO "items" VALUES('7q4k-m2wz','i-0000000001','note',2,'m1','Ann',1767225650000,1767225660000,'{"id":"i-0000000001","kind":"note","version":2,"body":{"text":"Edge?"}}');
CREATE TABLE links(room TEXT NOT NULL REFERENCES rooms(id) ON DELETE CASCADE, place INTEGER NOT NULL,
 token_hash BLOB NOT NULL, role TEXT NOT NULL, expires_ms INTEGER NOT NULL, is_one_use INTEGER NOT NULL,
 is_used INTEGER NOT NULL, person TEXT NOT NULL, maker TEXT NOT NULL DEFAULT '', name TEXT NOT NULL DEFAULT '', allows_guests INTEGER NOT NULL DEFAULT 0, PRIMARY KEY(room, place)) STRICT;
INSERT INTO "links" VALUES('7q4k-m2wz',0,X'000102030405060708090A0B0C0D0E0F101112131415161718191A1B1C1D1E1F','observer',1767312000000,0,0,'','ann','surgery',1);
CREATE TABLE members(room TEXT NOT NULL REFERENCES rooms(id) ON DELETE CASCADE, place INTEGER NOT NULL,
 id TEXT NOT NULL, name TEXT NOT NULL, secret_hash BLOB NOT NULL, color TEXT NOT NULL DEFAULT '',
 role TEXT NOT NULL DEFAULT '', has_left INTEGER NOT NULL DEFAULT 0, user TEXT NOT NULL DEFAULT '', link TEXT NOT NULL DEFAULT '', is_guest INTEGER NOT NULL DEFAULT 0, PRIMARY KEY(room, id)) STRICT;
INSERT INTO "members" VALUES('7q4k-m2wz',0,'m1','Ann',X'000102030405060708090A0B0C0D0E0F101112131415161718191A1B1C1D1E1F','#56b4e9','presenter',0,'ann','',0);
CREATE TABLE owners(plan TEXT PRIMARY KEY, user TEXT NOT NULL) STRICT;
INSERT INTO "owners" VALUES('head','ann');
CREATE TABLE recording_batches(room TEXT NOT NULL, recording TEXT NOT NULL, place INTEGER NOT NULL, t_ms INTEGER NOT NULL, is_state INTEGER NOT NULL, body TEXT NOT NULL, PRIMARY KEY(room, recording, place), FOREIGN KEY(room, recording) REFERENCES recordings(room, id) ON DELETE CASCADE) STRICT;
CREATE TABLE recordings(room TEXT NOT NULL REFERENCES rooms(id) ON DELETE CASCADE, id TEXT NOT NULL, facts TEXT NOT NULL, PRIMARY KEY(room, id)) STRICT;
CREATE TABLE records(n INTEGER PRIMARY KEY, id TEXT NOT NULL, room TEXT NOT NULL, plan TEXT NOT NULL, kind TEXT NOT NULL, author TEXT NOT NULL, author_name TEXT NOT NULL, time_ms INTEGER NOT NULL, item TEXT NOT NULL, body TEXT NOT NULL, hash TEXT NOT NULL, UNIQUE(room, id)) STRICT;
CREATE TABLE rooms(id TEXT PRIMARY KEY, plan TEXT NOT NULL, created_ms INTEGER NOT NULL, revision INTEGER NOT NULL,
 n_named INTEGER NOT NULL, scene TEXT, views TEXT, used_ms INTEGER NOT NULL DEFAULT 0,
 presenter TEXT NOT NULL DEFAULT '', has_links INTEGER NOT NULL DEFAULT 0, presence TEXT, owner TEXT NOT NULL DEFAULT '', people TEXT, is_open INTEGER NOT NULL DEFAULT 0) STRICT;
INSERT INTO "rooms" VALUES('7q4k-m2wz','head',1767225600000,42,3,'{"image":{"id":"ct"}}','[]',1767225800000,'m1',1,NULL,'ann','{"people":[{"who":"bob"}],"removed":[],"users":[]}',0);
INSERT INTO "rooms" VALUES('aaaa-bbbb','neck',1767225700000,1,0,NULL,NULL,1767225700000,'',0,NULL,'',NULL,0);
CREATE TABLE sessions(hash BLOB PRIMARY KEY, user TEXT NOT NULL, name TEXT NOT NULL, "groups" TEXT NOT NULL, source TEXT NOT NULL, address TEXT NOT NULL, created_ms INTEGER NOT NULL, seen_ms INTEGER NOT NULL, proved_ms INTEGER NOT NULL) STRICT;
CREATE TABLE tokens(id TEXT PRIMARY KEY, hash BLOB NOT NULL, user TEXT NOT NULL, name TEXT NOT NULL, scope TEXT NOT NULL, folders TEXT NOT NULL, created_ms INTEGER NOT NULL, expires_ms INTEGER NOT NULL, used_ms INTEGER NOT NULL, revoked_ms INTEGER NOT NULL) STRICT;
CREATE TABLE user_groups(user TEXT NOT NULL REFERENCES users(id) ON DELETE CASCADE, name TEXT NOT NULL, PRIMARY KEY(user, name)) STRICT;
INSERT INTO "user_groups" VALUES('ann','physics');
CREATE TABLE users(id TEXT PRIMARY KEY, name TEXT NOT NULL, password TEXT NOT NULL, is_disabled INTEGER NOT NULL, failed INTEGER NOT NULL, locked_until_ms INTEGER NOT NULL, created_ms INTEGER NOT NULL) STRICT;
INSERT INTO "users" VALUES('ann','Ann Example','$argon2id$x',0,0,0,1767225600000);
CREATE TRIGGER audit_order BEFORE INSERT ON audit WHEN NEW.n IS NOT (SELECT coalesce(max(n), 0) + 1 FROM audit)
 BEGIN SELECT RAISE(ABORT, 'rows of the audit are added at its end'); END;
CREATE TRIGGER audit_update BEFORE UPDATE ON audit BEGIN SELECT RAISE(ABORT, 'the audit is never changed'); END;
CREATE TRIGGER audit_delete BEFORE DELETE ON audit BEGIN SELECT RAISE(ABORT, 'the audit is never deleted'); END;
CREATE TRIGGER audit_head_order BEFORE UPDATE ON audit_head WHEN NEW.n <= OLD.n BEGIN SELECT RAISE(ABORT, 'the audit only grows'); END;
CREATE TRIGGER audit_head_delete BEFORE DELETE ON audit_head BEGIN SELECT RAISE(ABORT, 'the audit is never deleted'); END;
CREATE INDEX records_id ON records(id);
CREATE TRIGGER records_update BEFORE UPDATE ON records BEGIN SELECT RAISE(ABORT, 'a record is never changed'); END;
CREATE TRIGGER records_delete BEFORE DELETE ON records BEGIN SELECT RAISE(ABORT, 'a record is never deleted'); END;
COMMIT;
