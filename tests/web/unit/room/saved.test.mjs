// The page's words about the server's disk: never saved before the server has said so.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { roomWorld, welcome } from '../fake_room.mjs';

const saved = (more = {}) => ({ type: 'saved', state: 'saved', revision: 1, problem: null, ...more });
const full = { type: 'saved', state: 'failing', revision: 1, problem: { type: '/problems/storage', code: 'full' } };
const note = {
  type: 'item',
  id: 'i-1',
  item: {
    id: 'i-1',
    kind: 'note',
    version: 1,
    author: 'm2',
    author_name: 'Dr A',
    author_color: '#ffffff',
    changed_name: 'Dr A',
    created_ms: 1,
    changed_ms: 1,
    body: { text: 'x' },
  },
  by: 'm2',
  input: 0,
};

test('nothing is called saved before the server has said so', () => {
  const { room, connection } = roomWorld();
  assert.equal(room.saved.state.value, '');
  connection.receive(saved());
  assert.equal(room.saved.state.value, 'saved');
});

test("a change of the scene is being saved from this page's own act on, until the server says saved after it", () => {
  const { room, connection, flush } = roomWorld();
  connection.receive(saved());
  room.patchScene({ image: { window: { center: 50 } } });
  assert.equal(room.saved.state.value, 'saving', 'not even sent');
  flush();
  const { input } = connection.sent.find(({ type }) => type === 'scene.patch');
  connection.receive({ type: 'scene', revision: 2, patch: { image: { window: { center: 50 } } }, by: 'm1', input, unchanged: null });
  assert.equal(room.saved.state.value, 'saving', 'accepted, not on disk');
  connection.receive(saved({ state: 'saving' }));
  assert.equal(room.saved.state.value, 'saving');
  connection.receive(saved({ revision: 2 }));
  assert.equal(room.saved.state.value, 'saved');
});

test('an item of somebody else is being saved until the server says saved after it', () => {
  const { room, connection } = roomWorld();
  connection.receive(saved());
  connection.receive(note);
  assert.equal(room.saved.state.value, 'saving');
  connection.receive(saved());
  assert.equal(room.saved.state.value, 'saved');
});

test('a plan that is loaded anew with another scene is being saved, with the same one it is not', () => {
  const { room, connection } = roomWorld();
  connection.receive(saved());
  connection.receive({ ...welcome(), type: 'plan', revision: 1 });
  assert.equal(room.saved.state.value, 'saved');
  connection.receive({ ...welcome(), type: 'plan', revision: 2 });
  assert.equal(room.saved.state.value, 'saving');
});

test('a full disk is said until it is fine again, also over a reconnection', () => {
  const { room, connection, lose, back } = roomWorld();
  connection.receive(full);
  assert.equal(room.saved.problem.value, "The server's disk is full: what is changed now is not kept");
  connection.receive(note);
  assert.equal(room.saved.state.value, 'failing', 'a change makes it no better');
  lose();
  back();
  assert.equal(room.saved.problem.value, '', 'the server has not told it yet');
  connection.receive(full);
  assert.equal(room.saved.state.value, 'failing');
  connection.receive({ ...full, problem: { code: 'write' } });
  assert.match(room.saved.problem.value, /cannot write to its disk/);
  connection.receive(saved());
  assert.equal(room.saved.problem.value, '');
  assert.equal(room.saved.state.value, 'saved');
});
