-- A database of version 4, as the program that first kept an audit wrote it.
PRAGMA application_id = 1113940333;
PRAGMA user_version = 4;
CREATE TABLE rooms(id TEXT PRIMARY KEY, plan TEXT NOT NULL, created_ms INTEGER NOT NULL, revision INTEGER NOT NULL,
 n_named INTEGER NOT NULL, scene TEXT, views TEXT, used_ms INTEGER NOT NULL DEFAULT 0,
 presenter TEXT NOT NULL DEFAULT '', has_links INTEGER NOT NULL DEFAULT 0, presence TEXT) STRICT;
CREATE TABLE members(room TEXT NOT NULL REFERENCES rooms(id) ON DELETE CASCADE, place INTEGER NOT NULL,
 id TEXT NOT NULL, name TEXT NOT NULL, secret_hash BLOB NOT NULL, color TEXT NOT NULL DEFAULT '',
 role TEXT NOT NULL DEFAULT '', has_left INTEGER NOT NULL DEFAULT 0, PRIMARY KEY(room, id)) STRICT;
CREATE TABLE items(room TEXT NOT NULL REFERENCES rooms(id) ON DELETE CASCADE, id TEXT NOT NULL, kind TEXT NOT NULL,
 version INTEGER NOT NULL, author TEXT NOT NULL, author_name TEXT NOT NULL, created_ms INTEGER NOT NULL,
 changed_ms INTEGER NOT NULL, body TEXT NOT NULL, PRIMARY KEY(room, id)) STRICT;
CREATE TABLE links(room TEXT NOT NULL REFERENCES rooms(id) ON DELETE CASCADE, place INTEGER NOT NULL,
 token_hash BLOB NOT NULL, role TEXT NOT NULL, expires_ms INTEGER NOT NULL, is_one_use INTEGER NOT NULL,
 is_used INTEGER NOT NULL, person TEXT NOT NULL, PRIMARY KEY(room, place)) STRICT;
CREATE TABLE audit(n INTEGER PRIMARY KEY, row TEXT NOT NULL, hash TEXT NOT NULL) STRICT;
CREATE TRIGGER audit_order BEFORE INSERT ON audit WHEN NEW.n IS NOT (SELECT coalesce(max(n), 0) + 1 FROM audit)
 BEGIN SELECT RAISE(ABORT, 'rows of the audit are added at its end'); END;
CREATE TRIGGER audit_update BEFORE UPDATE ON audit BEGIN SELECT RAISE(ABORT, 'the audit is never changed'); END;
CREATE TRIGGER audit_delete BEFORE DELETE ON audit BEGIN SELECT RAISE(ABORT, 'the audit is never deleted'); END;
INSERT INTO rooms VALUES('7q4k-m2wz', 'head', 1767225600000, 42, 3, '{"image":{"id":"ct"}}', '[]', 1767225800000, 'm1', 1, NULL);
INSERT INTO rooms VALUES('aaaa-bbbb', 'neck', 1767225700000, 1, 0, NULL, NULL, 1767225700000, '', 0, NULL);
INSERT INTO members VALUES('7q4k-m2wz', 0, 'm1', 'Ann', x'000102030405060708090a0b0c0d0e0f101112131415161718191a1b1c1d1e1f', '#56b4e9', 'presenter', 0);
INSERT INTO items VALUES('7q4k-m2wz', 'i-0000000001', 'note', 2, 'm1', 'Ann', 1767225650000, 1767225660000,
 '{"id":"i-0000000001","kind":"note","version":2,"body":{"text":"Edge?"}}');
INSERT INTO links VALUES('7q4k-m2wz', 0, x'000102030405060708090a0b0c0d0e0f101112131415161718191a1b1c1d1e1f', 'observer', 1767312000000, 0, 0, '');
