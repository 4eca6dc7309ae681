-- A database of version 1, as the first program that kept rooms wrote it.
PRAGMA application_id = 1113940333;
PRAGMA user_version = 1;
CREATE TABLE rooms(id TEXT PRIMARY KEY, plan TEXT NOT NULL, created_ms INTEGER NOT NULL, revision INTEGER NOT NULL,
 n_named INTEGER NOT NULL, scene TEXT, views TEXT) STRICT;
CREATE TABLE members(room TEXT NOT NULL REFERENCES rooms(id) ON DELETE CASCADE, place INTEGER NOT NULL,
 id TEXT NOT NULL, name TEXT NOT NULL, secret_hash BLOB NOT NULL, PRIMARY KEY(room, id)) STRICT;
INSERT INTO rooms VALUES('7q4k-m2wz', 'head', 1767225600000, 42, 3, '{"image":{"id":"ct"}}', '[]');
INSERT INTO rooms VALUES('aaaa-bbbb', 'neck', 1767225700000, 1, 0, NULL, NULL);
INSERT INTO members VALUES('7q4k-m2wz', 0, 'm1', 'Ann', x'000102030405060708090a0b0c0d0e0f101112131415161718191a1b1c1d1e1f');
INSERT INTO members VALUES('7q4k-m2wz', 1, 'm3', 'Özlem Ünal', x'202122232425262728292a2b2c2d2e2f303132333435363738393a3b3c3d3e3f');
