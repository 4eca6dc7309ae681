// Ending a wall from the list of members: the second press must follow the first, in the same list.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../page.mjs';
import { drawn } from '../template.mjs';

const { signal } = await load('../lib/signals-core.js');
const { wallButton } = await load('shell/roster.js');

function listOfMembers() {
  const sent = [];
  let timer = null;
  const clock = {
    setTimeout(run) {
      timer = run;
      return 1;
    },
    clearTimeout() {
      timer = null;
    },
  };
  const ui = { popover: signal('members') };
  const world = { room: { control: { may: () => true } }, ui, clock, connection: { send: (message) => sent.push(message) } };
  const button = (id) => drawn(wallButton({ id, name: `Wall ${id}` }, world));
  return { sent, ui, pass: () => timer(), press: (id) => button(id).functions[0](), isSure: (id) => button(id).text.includes('now') };
}

test('a wall is ended by two presses', () => {
  const { sent, press, isSure } = listOfMembers();
  press('a');
  assert.deepEqual([isSure('a'), isSure('b'), sent.length], [true, false, 0]);
  press('a');
  assert.deepEqual(sent, [{ type: 'member.remove', member: 'a', reason: '' }]);
  assert.equal(isSure('a'), false);
});

test('the first press does not hold when the list was closed, another wall was pressed, or some time went by', () => {
  const { sent, ui, press, pass, isSure } = listOfMembers();
  press('a');
  ui.popover.value = '';
  ui.popover.value = 'members';
  assert.equal(isSure('a'), false);
  press('a');
  press('b');
  assert.deepEqual([isSure('a'), isSure('b')], [false, true]);
  pass();
  assert.equal(isSure('b'), false);
  press('b');
  assert.deepEqual(sent, []);
  press('b');
});
