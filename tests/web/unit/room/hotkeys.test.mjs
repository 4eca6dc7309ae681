// Keys and commands: what is pressed on keyboards of several languages, own keys, conflicts, what the browser keeps.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../page.mjs';

const { comboOf, commands, isSingle } = await load('room/commands.js');
const { Hotkeys, keyText } = await load('room/hotkeys.js');
const { given, refusalOf, resetAll, resetOne, userOf } = await load('shell/help_keys.js');
const { commandWords } = await load('shell/help.js');
const { features } = await load('features/index.js');
const { PaneActions } = await load('pane/pane_actions.js');

const press = (key, code, how = {}) => ({ key, code, getModifierState: (name) => Boolean(how[name]), ...how });
const kept = (text) => {
  const items = new Map(text === undefined ? [] : [['beamroom keys', text]]);
  return { getItem: (key) => items.get(key) ?? null, setItem: (key, value) => items.set(key, value) };
};

test('the same key has the same name on keyboards of other languages', () => {
  const cases = [
    ['W', press('w', 'KeyW')],
    ['W', press('W', 'KeyW')], // caps lock
    ['Shift+W', press('W', 'KeyW', { shiftKey: true })],
    ['W', press('ц', 'KeyW')], // Russian
    ['Z', press('z', 'KeyY')], // German: the letter that is written on it
    ['1', press('&', 'Digit1')], // French
    ['Shift+1', press('!', 'Digit1', { shiftKey: true })],
    ['?', press('?', 'Slash', { shiftKey: true })],
    ['?', press('?', 'Minus', { shiftKey: true })], // German
    ['[', press('[', 'Digit8', { ctrlKey: true, altKey: true, AltGraph: true })], // German on Windows
    ['Ctrl+Z', press('z', 'KeyZ', { ctrlKey: true })],
    ['Ctrl+Z', press('z', 'KeyZ', { metaKey: true })],
    ['Ctrl+Shift+Z', press('Z', 'KeyZ', { ctrlKey: true, shiftKey: true })],
    ['Space', press(' ', 'Space')],
    ['F8', press('F8', 'F8')],
    ['', press('Shift', 'ShiftLeft', { shiftKey: true })],
    ['', press('Dead', 'BracketRight')],
  ];
  for (const [name, event] of cases) assert.equal(comboOf(event), name, JSON.stringify(event));
});

test('each command has a row in the list, an action on the page, and keys that no other has', () => {
  const ids = Object.keys(commands);
  assert.deepEqual(Object.keys(commandWords), ids);
  for (const words of Object.values(commandWords)) assert.ok(words, 'has words');
  const all = Object.values(commands).flat();
  assert.equal(new Set(all).size, all.length);
  const text = PaneActions.toString();
  const ofPage = ['undo', 'redo', 'help'];
  const acting = (id) => ofPage.includes(id) || features.some(({ keys }) => keys?.[id]) || new RegExp(`\\b${id}: \\(\\) =>`).test(text);
  assert.deepEqual(
    ids.filter((id) => !acting(id)),
    [],
  );
  for (const id of features.flatMap(({ keys = {} }) => Object.keys(keys)))
    assert.ok(ids.includes(id), `${id} of a feature is in the table`);
});

test('own keys are kept by the browser, tooltips show them, and what it kept wrongly is left out', () => {
  const storage = kept();
  const keys = new Hotkeys(storage);
  assert.equal(keys.tip('Wash of dose', 'wash'), 'Wash of dose (D)');
  given(keys, 'wash', 'Shift+D');
  assert.equal(keys.commandOf(press('d', 'KeyD')), '');
  assert.equal(keys.commandOf(press('D', 'KeyD', { shiftKey: true })), 'wash');
  assert.equal(keys.tip('Wash of dose', 'wash'), 'Wash of dose (Shift+D)');
  const again = new Hotkeys(storage);
  assert.equal(again.text('wash'), 'Shift+D');
  resetAll(again);
  assert.equal(again.text('wash'), 'D');
  for (const wrong of ['', 'null', '[]', '{"own":3}', '{"own":{"nothing":"X","wash":7,"lines":"J"}}', '{']) {
    const read = new Hotkeys(kept(wrong));
    assert.equal(read.text('wash'), 'D', wrong);
    assert.equal(read.areSinglesOff.value, false);
  }
  assert.equal(new Hotkeys(kept('{"own":{"nothing":"X","wash":7,"lines":"J"}}')).text('lines'), 'J');
});

test('a key that another command has is told, moved, and given back', () => {
  const keys = new Hotkeys();
  assert.equal(userOf(keys, 'M', 'wash'), 'measure');
  given(keys, 'wash', 'M');
  assert.deepEqual([keys.text('wash'), keys.text('measure')], ['M', '']);
  assert.equal(keys.commandOf(press('m', 'KeyM')), 'wash');
  assert.equal(keys.tip('Measure', 'measure'), 'Measure');
  resetOne(keys, 'measure'); // takes M back, and so the wash has its own again
  assert.deepEqual([keys.text('wash'), keys.text('measure'), keys.own.value], ['D', 'M', {}]);
  given(keys, 'wash', 'R'); // reset keeps its second key
  assert.deepEqual(keys.keysOf('reset'), ['Space']);
  given(keys, 'wash', 'D');
  assert.equal(keys.own.value.wash, undefined, 'the standard key is no change');
});

test('fixed keys and those of the browser are refused, with the reason', () => {
  for (const [key, code, how] of [
    ['ArrowUp', 'ArrowUp'],
    ['1', 'Digit1'],
    ['!', 'Digit1', { shiftKey: true }],
    ['Enter', 'Enter'],
    ['[', 'BracketLeft'],
    ['w', 'KeyW', { ctrlKey: true }],
    ['F5', 'F5'],
  ])
    assert.ok(refusalOf(press(key, code, how)).problem, key);
  for (const [key, code, how] of [
    ['x', 'KeyX'],
    ['F8', 'F8'],
    ['#', 'Backslash'],
    ['d', 'KeyD', { altKey: true }],
  ])
    assert.equal(refusalOf(press(key, code, how)).problem, '', key);
});

test('single keys can be switched off; keys with Ctrl, Space and those of a place stay (WCAG 2.1.4)', () => {
  const storage = kept();
  const keys = new Hotkeys(storage);
  keys.areSinglesOff.value = true;
  for (const [key, code, how] of [
    ['d', 'KeyD'],
    ['P', 'KeyP', { shiftKey: true }],
    ['?', 'Slash', { shiftKey: true }],
    ['+', 'Equal'],
  ])
    assert.ok(!keys.commandOf(press(key, code, how)), key);
  assert.equal(keys.commandOf(press('z', 'KeyZ', { ctrlKey: true })), 'undo');
  assert.equal(keys.commandOf(press(' ', 'Space')), 'reset');
  assert.deepEqual([keys.tip('Wash', 'wash'), keys.orEscape('follow'), keys.text('reset')], ['Wash', 'Esc', 'Space']);
  assert.equal(new Hotkeys(storage).areSinglesOff.value, true);
  assert.deepEqual(['D', 'Shift+D', '+', 'Ctrl+D', 'F8', 'Space', 'Enter'].map(isSingle), [true, true, true, false, false, false, false]);
  assert.equal(keyText('Ctrl+Shift+Z'), 'Ctrl+Shift+Z');
});
