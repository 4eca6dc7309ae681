// Control of a room on the page: what is offered to whom, what is sent, what is said.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { members, roomWorld } from '../fake_room.mjs';

const roles = { m1: { role: 'reviewer' }, m2: { role: 'presenter' }, m3: { role: 'observer' } };
/** The page is m1, a reviewer, and m2 presents. */
const reviewer = (role = 'reviewer') => roomWorld(members('m2', ['m1', 'm3'], { ...roles, m1: { role } }));
const control = (more = {}) => ({
  type: 'control',
  presenter: 'm2',
  locked: false,
  requests: [],
  act: 'none',
  member: '',
  by: '',
  ...more,
});
const offers = ({ control: { canTake, canRequest } }) => [canTake.value && 'take', canRequest.value && 'request'].filter(Boolean);

test('who may take control and who may request it', () => {
  const offered = (role, list, locked = false) => {
    const { room, connection } = roomWorld(list(role));
    connection.receive(control({ locked }));
    return offers(room);
  };
  const follows = (role) => members('m2', ['m1'], { ...roles, m1: { role } });
  const nobody = (role) => members(null, ['m1', 'm2'], { ...roles, m1: { role } });
  const presents = (role) => members('m1', ['m2'], { ...roles, m1: { role } });
  assert.deepEqual(offered('observer', follows), []);
  assert.deepEqual(offered('reviewer', follows), ['request']);
  assert.deepEqual(offered('presenter', follows), ['take']);
  assert.deepEqual(offered('presenter', follows, true), ['request']);
  assert.deepEqual(offered('observer', nobody), []);
  assert.deepEqual(offered('reviewer', nobody), ['take']);
  assert.deepEqual(offered('presenter', presents), []);
});

test('a guest is offered no control, and cannot be given it, whatever the role', () => {
  for (const role of ['reviewer', 'presenter', 'planner']) {
    const guest = { role, is_guest: true };
    const { room, connection } = roomWorld(members(null, ['m1', 'm2'], { ...roles, m1: guest }));
    connection.receive(control());
    assert.deepEqual(offers(room), []);
    for (const right of ['look', 'point', 'note']) assert.equal(room.control.may(right), true, right);
    for (const right of ['scene', 'control']) assert.equal(room.control.may(right, room.control.member('m1')), false, right);
    assert.equal(room.control.may('scene', room.control.member('m2')), true);
  }
});

test('a request is sent, withdrawn and refused in words', () => {
  const { room, connection, told } = reviewer();
  room.control.request();
  assert.deepEqual(connection.sent.at(-1), { type: 'control.request' });
  assert.equal(told.at(-1)[1], 'You have asked Dr A for control.');
  connection.receive(control({ requests: ['m1'], act: 'requested', member: 'm1', by: 'm1' }));
  assert.equal(room.control.isRequesting.value, true);
  told.at(-1)[3].act();
  assert.deepEqual(connection.sent.at(-1), { type: 'control.request', wanted: false });
  connection.receive(control({ act: 'refused', member: 'm1', by: 'm2' }));
  assert.equal(room.control.isRequesting.value, false);
  assert.equal(told.at(-1)[1], 'Dr A keeps control for now.');
  connection.receive({
    type: 'problem',
    to: 'control.request',
    view: 0,
    input: 0,
    problem: { type: '/problems/limit', status: 429, detail: 'm2 refused control', retry_after_ms: 8100 },
  });
  assert.equal(told.at(-1)[1], 'Dr A keeps control for now. Ask again in 9 s.');
});

test('without a connection an act is said to be lost', () => {
  const { room, connection, told } = reviewer();
  connection.isOpen = false;
  room.control.request();
  assert.match(told.at(-1)[1], /^Not sent/);
});

test('who is given control while on their own follows the room first', () => {
  const { room, connection } = reviewer();
  room.following.leave();
  assert.equal(room.following.isFollowing.value, false);
  connection.receive(control({ presenter: 'm1', act: 'given', member: 'm1', by: 'm2' }));
  assert.equal(room.following.isFollowing.value, true);
  connection.sent.length = 0;
  connection.receive(members('m1', ['m2', 'm3'], roles));
  assert.equal(room.following.isPresenting.value, true);
  assert.deepEqual(
    connection.sent.filter(({ type }) => type === 'present'),
    [],
    "the own views do not become the room's",
  );
});

test('who loses control is told, and that a change did not arrive', () => {
  const { room, connection, flush, told } = roomWorld(members('m1', ['m2'], roles));
  room.showView(1, [400, 300]);
  room.patchView(1, { camera: { fov_deg: 40 } });
  flush();
  const { input } = connection.sent.at(-1);
  connection.receive(control({ presenter: 'm2', act: 'taken', member: 'm2', by: 'm2' }));
  connection.receive(members('m2', ['m1'], roles));
  assert.equal(told.at(-1)[1], 'Dr A presents now. You follow.');
  connection.receive({
    type: 'problem',
    to: 'view.patch',
    view: 1,
    input,
    problem: { type: '/problems/not-presenter', status: 403, detail: '' },
  });
  assert.equal(told.at(-1)[1], 'Dr A presents now: your last change was not made.');
});

test('sentences of the server have names in place of ids', () => {
  const { room, connection, told } = reviewer('presenter');
  connection.receive({
    type: 'problem',
    to: 'control.take',
    view: 0,
    input: 0,
    problem: { type: '/problems/not-presenter', status: 403, code: 'locked', detail: 'm2 has locked control: request it' },
  });
  assert.equal(told.at(-1)[1], 'Dr A has locked control: request it');
  assert.equal(room.control.named('m99 and m3'), 'm99 and Dr B');
});

test('the connection takes link and person into hello', async () => {
  const { load } = await import('../page.mjs');
  const { Connection } = await load('net/connection.js');
  const sent = [];
  class Socket extends EventTarget {
    send(text) {
      sent.push(JSON.parse(text));
    }
    close() {}
  }
  const socket = new Socket();
  const clock = { now: () => 0, setTimeout: () => 0, clearTimeout: () => {} };
  new Connection('ws://x', { makeSocket: () => socket, clock }, { name: 'Ann', link: 'abc', person: 'def' }).open();
  socket.dispatchEvent(new Event('open'));
  assert.deepEqual(sent, [{ type: 'hello', protocol: 2, name: 'Ann', link: 'abc', person: 'def' }]);
});
