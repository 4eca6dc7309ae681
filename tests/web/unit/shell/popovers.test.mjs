// Where a popover goes that would not be whole in the window. Boxes worked out by hand.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../page.mjs';

const { movedInside } = await load('shell/popovers.js');
const window = { width: 400, height: 800 };
const box = (left, top, width, height) => ({ left, top, right: left + width, bottom: top + height, width, height });

test('a popover goes to the side, above its button, or as far as the window goes', () => {
  assert.deepEqual(movedInside(box(20, 60, 300, 200), { top: 20 }, window), { x: 0, y: 0 });
  assert.deepEqual(movedInside(box(-10, 60, 300, 200), { top: 20 }, window), { x: 16, y: 0 });
  assert.deepEqual(movedInside(box(200, 60, 300, 200), { top: 20 }, window), { x: -106, y: 0 });
  assert.deepEqual(movedInside(box(20, 700, 300, 200), { top: 660 }, window), { x: 0, y: 454 - 700 }, '6 px above 660');
  assert.deepEqual(movedInside(box(20, 500, 300, 500), { top: 400 }, window), { x: 0, y: 294 - 500 }, 'no room above: up to the foot');
  assert.deepEqual(movedInside(box(20, -40, 300, 300), { top: 300 }, window), { x: 0, y: 46 }, 'one that opens upwards');
  assert.deepEqual(movedInside(box(-10, 60, 500, 200), { top: 20 }, window), { x: 16, y: 0 }, 'too wide: its beginning');
});
