// Items of a room in the page: the server's rows, own commands, what happens to them when the connection is lost; notes as threads.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { roomWorld } from '../fake_room.mjs';
import { load } from '../page.mjs';

const { authorsOf, completion, filtered, mentionsIn, noFilter, partsOf, pinStrength, pointOf, threadsOf, whenWords } =
  await load('features/notes/threads.js');
const { notesText } = await load('features/notes/notes_file.js');

const body = (text, more = {}) => ({ text, anchor: null, resolved: false, mentions: [], parent: '', ...more });
const row = (id, text, more = {}, of = {}) => ({
  id,
  kind: 'note',
  version: 1,
  author: 'm1',
  author_name: 'Ann',
  author_color: '#4a90d9',
  changed_name: 'Ann',
  created_ms: 1000,
  changed_ms: 1000,
  body: body(text, of),
  ...more,
});
const sentItems = (connection) => connection.sent.filter(({ type }) => type.startsWith('item.'));

test('a note is there once the server has it, and the promise has its row', async () => {
  const { room, connection } = roomWorld();
  const made = room.items.put('note', body('Edge?'));
  const [{ input, ...message }] = sentItems(connection);
  assert.deepEqual(message, { type: 'item.put', item: '', version: 0, kind: 'note', body: body('Edge?') });
  assert.equal(room.items.notes.value.length, 0);
  connection.receive({ type: 'item', id: 'i-1', item: row('i-1', 'Edge?'), by: 'm1', input });
  assert.equal((await made).id, 'i-1');
  assert.equal(room.items.nOpen.value, 1);
  assert.equal(room.items.nPending.value, 0);
});

test('a refusal goes to who gave the command, and nowhere else', async () => {
  const { room, connection, told } = roomWorld();
  connection.receive({ type: 'item', id: 'i-1', item: row('i-1', 'Edge?', { version: 4 }), by: 'm2', input: 0 });
  const made = room.items.put('note', body('Rim?'), { id: 'i-1', version: 3 });
  connection.receive({
    type: 'problem',
    to: 'item.put',
    view: 0,
    input: sentItems(connection)[0].input,
    problem: { type: '/problems/conflict', detail: 'changed' },
  });
  await assert.rejects(made, { type: '/problems/conflict' });
  assert.equal(told.length, 0);
  assert.equal(room.items.rows.value.get('i-1').body.text, 'Edge?');
});

test('what was written without a connection is sent after it, what the server had taken is not sent twice', async () => {
  const { room, connection, lose, back } = roomWorld();
  const taken = room.items.put('note', body('taken'));
  lose();
  const kept = room.items.put('note', body('kept'));
  connection.sent.length = 0;
  back(undefined, { items: [row('i-1', 'taken')] });
  assert.equal((await taken).id, 'i-1');
  assert.deepEqual(
    sentItems(connection).map((message) => message.body.text),
    ['kept'],
  );
  connection.receive({ type: 'item', id: 'i-2', item: row('i-2', 'kept'), by: 'm1', input: sentItems(connection)[0].input });
  assert.equal((await kept).id, 'i-2');
});

test('what a person wrote without a connection is not sent when another one comes back, but once that person is back', async () => {
  const list = (user, id = 'm1') => ({
    type: 'members',
    members: [{ id, name: user, connected: true, following: false, presenting: true, user }],
  });
  const { room, connection, flush, lose, back } = roomWorld(list('ann'));
  lose();
  const kept = room.items.put('note', body('of Ann'));
  room.patchScene({ regions: { brain: { opacity: 0.3 } } });
  const sent = () => connection.sent.filter(({ type }) => type.startsWith('item.') || type === 'scene.patch');
  back(list('ben', 'm2'), { member: 'm2', secret: 'of Ben', name: 'Ben' });
  assert.deepEqual([sent(), room.link.value.state, room.items.nPending.value], [[], 'paused', 1]);
  const { member, secret, name } = connection.pausedAs;
  assert.deepEqual([member, secret, name, room.member.value], ['m1', 's', 'Reviewer 1', 'm1'], 'the seat is the first one again');
  flush();
  assert.deepEqual(sent(), []);
  back(list('ann'));
  assert.deepEqual(
    sent().map(({ type }) => type),
    ['scene.patch', 'item.put'],
  );
  connection.receive({ type: 'item', id: 'i-2', item: row('i-2', 'of Ann'), by: 'm1', input: sentItems(connection)[0].input });
  assert.equal((await kept).id, 'i-2');
});

test('a deleted item is gone; of what others write, what came before somebody listens is told too', () => {
  const { room, connection } = roomWorld();
  connection.receive({ type: 'item', id: 'i-1', item: row('i-1', 'one', { author: 'm2' }), by: 'm2', input: 0 });
  connection.receive({ type: 'item', id: 'i-1', item: row('i-1', 'changed', { author: 'm2', version: 2 }), by: 'm2', input: 0 });
  const heard = [];
  room.items.listen((item) => heard.push(item.body.text));
  connection.receive({ type: 'item', id: 'i-2', item: row('i-2', 'mine'), by: 'm1', input: 0 });
  connection.receive({ type: 'item', id: 'i-3', item: row('i-3', 'three', { author: 'm2' }), by: 'm2', input: 0 });
  connection.receive({ type: 'item', id: 'i-1', item: null, by: 'm2', input: 0 });
  assert.deepEqual(heard, ['one', 'three']);
  assert.deepEqual(
    room.items.notes.value.map(({ id }) => id),
    ['i-2', 'i-3'],
  );
});

const rows = [
  row('a', 'first', { author_name: 'Ann' }, { resolved: true }),
  row('b', 'second @Ben', { author: 'm2', author_name: 'Ben', changed_ms: 2000 }, { mentions: [{ member: 'm9', name: 'Cem' }] }),
  row('c', 'yes', { author: 'm3', author_name: 'Cem', changed_ms: 3000 }, { parent: 'b' }),
  row('d', 'third', { author: 'm3', author_name: 'Cem', changed_ms: 2500 }),
  row('e', 'no', { author: 'm1', changed_ms: 3000 }, { parent: 'gone' }),
];

test('notes are numbered as they came, with their replies; a reply to a deleted note stands alone', () => {
  assert.deepEqual(
    threadsOf(rows).map(({ note, number, replies }) => [note.id, number, replies.map(({ id }) => id)]),
    [
      ['a', 1, []],
      ['b', 2, ['c']],
      ['d', 3, []],
      ['e', 4, []],
    ],
  );
  assert.deepEqual(authorsOf(rows), ['Ann', 'Ben', 'Cem']);
});

test('open notes come first, the newest words before older ones, and each filter leaves what it says', () => {
  const me = { id: 'm3', name: 'Cem' };
  const shown = (part, who = me) =>
    filtered(threadsOf(rows), { ...noFilter, ...part }, who)
      .map(({ note }) => note.id)
      .join('');
  assert.equal(shown({}), 'ebd');
  assert.equal(shown({ hasResolved: true }), 'ebda');
  assert.equal(shown({ text: 'YES' }), 'b');
  assert.equal(shown({ author: 'Cem' }), 'bd');
  assert.equal(shown({ who: 'mine' }), 'bd');
  assert.equal(shown({ who: 'mentions' }), 'b');
  assert.equal(shown({ who: 'mentions' }, { id: 'm9', name: 'Other' }), 'b');
  assert.equal(shown({ who: 'mentions' }, { id: 'm1', name: 'Ann' }), '');
});

const members = [
  { id: 'm1', name: 'Ann' },
  { id: 'm2', name: 'Dr Ben' },
  { id: 'm3', name: 'Dr Bea' },
];

test('a name is completed from its "@", over spaces, and not in the middle of an address', () => {
  assert.deepEqual(completion('Ask @dr b', 9, members), { at: 4, names: ['Dr Ben', 'Dr Bea'] });
  assert.deepEqual(completion('@', 1, members).names, ['Ann', 'Dr Ben', 'Dr Bea']);
  assert.equal(completion('a@', 2, members), null);
  assert.equal(completion('@Ann', 4, members), null);
  assert.equal(completion('@x\ny', 4, members), null);
});

test('mentioned is whose "@name" is in the text, also who has left; a text is cut into names and the rest', () => {
  const found = mentionsIn('@Dr Ben and @Old: look', members, [{ member: 'm9', name: 'Old' }]);
  assert.deepEqual(found, [
    { member: 'm2', name: 'Dr Ben' },
    { member: 'm9', name: 'Old' },
  ]);
  assert.deepEqual(partsOf('@Dr Ben <b>', found), [
    { text: '@Dr Ben', isName: true },
    { text: ' <b>', isName: false },
  ]);
  assert.deepEqual(partsOf('none', found), [{ text: 'none', isName: false }]);
});

test('the point of a note is its own or the centre of its region', () => {
  const plan = { regions: [{ id: 'brain', center_mm: [1, 2, 3] }] };
  assert.deepEqual(pointOf(row('a', 'x', {}, { anchor: { point_mm: [4, 5, 6], region: 'brain' } }), plan), [4, 5, 6]);
  assert.deepEqual(pointOf(row('a', 'x', {}, { anchor: { region: 'brain' } }), plan), [1, 2, 3]);
  assert.equal(pointOf(row('a', 'x', {}, { anchor: { region: 'gone' } }), plan), null);
  assert.equal(pointOf(row('a', 'x'), plan), null);
});

test('a pin is whole in its slice, faint beside it, and gone 20 mm on', () => {
  assert.equal(pinStrength(0.4, 0.5), 1);
  assert.ok(pinStrength(5, 0.5) > pinStrength(15, 0.5) && pinStrength(15, 0.5) > 0);
  assert.equal(pinStrength(20.5, 0.5), 0);
});

test('notes as a file: numbered, with place, author, replies, and whether they are resolved', () => {
  const at = Date.UTC(2026, 10, 23, 9, 5);
  const rows = [
    {
      ...row('a', 'Edge?\nOr not', {}, { anchor: { point_mm: [1, -2.25, 3], region: 'r1' }, resolved: true }),
      author_name: 'Ann',
      created_ms: at,
    },
    { ...row('b', 'Yes', {}, { parent: 'a' }), author_name: 'Ben', created_ms: at + 60000 },
  ];
  assert.equal(
    notesText({ id: 'room-1', planId: 'p', plan: { name: 'Head', regions: [{ id: 'r1', name: 'brain' }] }, rows }),
    'Notes of the room room-1 on Head\n\n1. Ann, 2026-11-23 09:05 UTC, at brain, L 1.0  P -2.3  S 3.0 mm, resolved\n   Edge?\n   Or not\n   Ben, 2026-11-23 09:06 UTC\n      Yes\n',
  );
});

test('times are local: of today without the date, of another year with it', () => {
  const now = new Date(2026, 10, 23, 15, 0).getTime();
  assert.equal(whenWords(new Date(2026, 10, 23, 9, 5).getTime(), now, 'en-GB'), '09:05');
  assert.equal(whenWords(new Date(2026, 10, 22, 9, 5).getTime(), now, 'en-GB'), '22 Nov, 09:05');
  assert.equal(whenWords(new Date(2025, 10, 22, 9, 5).getTime(), now, 'en-GB'), '22 Nov 2025, 09:05');
});
