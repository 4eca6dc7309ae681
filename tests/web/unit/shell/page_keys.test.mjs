// Keys of the page: from where they reach the active pane, and from where not.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../page.mjs';

const { listenKeys } = await load('shell/page_keys.js');
const { Hotkeys } = await load('room/hotkeys.js');

/** An element that is inside these selectors' elements. */
const place = (...inside) => ({
  closest: (selector) => selector.split(', ').some((one) => inside.includes(one.replace(/:not\(.*\)$/, ''))),
});
const page = place();
const places = {
  page,
  button: place('button'),
  tree: place('[tabindex]'),
  text: place('input', '[tabindex]'),
  area: place('textarea'),
  select: place('select'),
  dialog: place('[role="dialog"]', 'button'),
  menu: place('[role="menu"]', 'button'),
};

function world() {
  const log = [];
  const keys = new Hotkeys();
  const ui = { keys, active: { peek: () => 2 }, toggle: (name) => log.push(name), escape: () => log.push('escape') };
  const pane = (n) => ({ actions: { key: ({ key }, isHere) => log.push([n, key, isHere]) } });
  const undo = { undo: () => log.push('undo'), redo: () => log.push('redo') };
  let isCovered = false;
  const target = new EventTarget();
  const stop = listenKeys(target, { ui, room: {}, undo, panes: () => [pane(1), pane(2)] }, () => isCovered);
  return {
    stop,
    cover: (is) => {
      isCovered = is;
    },
    press(at, key, how = {}) {
      const event = Object.assign(new Event('keydown', { cancelable: true }), { key, code: '', ...how });
      Object.defineProperty(event, 'target', { value: at });
      target.dispatchEvent(event);
      return [log.splice(0), event.defaultPrevented];
    },
  };
}

test('keys reach the last active pane from the page, a tool and the tree; arrows only where nothing else has them', () => {
  const { press } = world();
  assert.deepEqual(press(places.page, 'd'), [[[2, 'd', true]], true]);
  assert.deepEqual(press(places.button, 'd'), [[[2, 'd', false]], true]);
  assert.deepEqual(press(places.tree, 'd'), [[[2, 'd', false]], true]);
});

test('keys stay in text fields, selects, dialogs and menus, and under a dialog', () => {
  const { press, cover, stop } = world();
  for (const name of ['text', 'area', 'select', 'dialog', 'menu']) assert.deepEqual(press(places[name], 'd'), [[], false], name);
  cover(true);
  assert.deepEqual(press(places.page, 'd'), [[], false]);
  stop();
  cover(false);
  assert.deepEqual(press(places.page, 'd'), [[], false]);
});

test('undo and redo by keys, but a text field has its own; ? opens the list', () => {
  const { press } = world();
  const ctrl = { ctrlKey: true };
  assert.deepEqual(press(places.text, 'z', ctrl), [[], false]);
  assert.deepEqual(press(places.page, 'z', ctrl), [['undo'], true]);
  assert.deepEqual(press(places.button, 'Z', { ...ctrl, shiftKey: true }), [['redo'], true]);
  assert.deepEqual(press(places.page, 'y', ctrl), [['redo'], true]);
  assert.deepEqual(press(places.page, '?'), [['help'], true]);
  assert.deepEqual(press(places.text, '?'), [[], false]);
  assert.deepEqual(press(places.text, 'Escape')[0], ['escape']);
});
