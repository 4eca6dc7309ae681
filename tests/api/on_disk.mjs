// Contents of a daemon's database, as another process sees them.
import { execFileSync } from 'node:child_process';
import { join } from 'node:path';

const script = `
import json, sqlite3, sys
db = sqlite3.connect('file:%s?mode=ro' % sys.argv[1], uri=True, timeout=30)
row = db.execute('SELECT revision, scene, views, name FROM rooms WHERE id = ?', (sys.argv[2],)).fetchone()
members = [{'id': id, 'hash': bytes(hash).hex()} for id, hash in db.execute('SELECT id, secret_hash FROM members WHERE room = ? ORDER BY place', (sys.argv[2],))]
links = [{'hash': bytes(hash).hex(), 'role': role, 'used': bool(used)} for hash, role, used in db.execute('SELECT token_hash, role, is_used FROM links WHERE room = ? ORDER BY place', (sys.argv[2],))]
items = [id for id, in db.execute('SELECT id FROM items WHERE room = ? ORDER BY created_ms, rowid', (sys.argv[2],))]
print(json.dumps(row and {'revision': row[0], 'scene': row[1] and json.loads(row[1]), 'views': row[2] and json.loads(row[2]), 'members': members, 'links': links, 'items': items, 'name': row[3]}))
`;

const caseScript = `
import json, sqlite3, sys
db = sqlite3.connect('file:%s?mode=ro' % sys.argv[1], uri=True, timeout=30)
print(json.dumps([json.loads(body) for body, in db.execute('SELECT body FROM meeting_cases WHERE meeting = ? ORDER BY place', (sys.argv[2],))]))
`;

/** The cases of a meeting as they are in the database: who was there, and when. */
export const casesOnDisk = (meeting, data) =>
  JSON.parse(execFileSync('python3', ['-c', caseScript, join(data, 'beamroom.db'), meeting], { encoding: 'utf8' }));

/** A room in the database of this state folder: {revision, scene, views, name, members: [{id, hash}], links: [{hash, role, used}], items: [id]}; null: it is not there. */
export const onDisk = (room, data) =>
  JSON.parse(execFileSync('python3', ['-c', script, join(data, 'beamroom.db'), room], { encoding: 'utf8' }));
