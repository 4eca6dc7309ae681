// The keys of pointing, before the code of pointing is there.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../../page.mjs';

const { pointers } = await load('features/pointers/feature.js');
document.querySelector = () => ({ sheet: {} }); // its style sheet is there
const is = (value) => ({ value, peek: () => value });

test('"Look here" that is pressed while its code is being loaded is asked as soon as it is there', async () => {
  const asked = [];
  const room = {
    scene: is({ image: { slices: { sagittal: { position_mm: 1 }, coronal: { position_mm: 2 }, axial: { position_mm: 3 } } } }),
    pointers: { others: is([{}]), mayPoint: is(true), isPointing: is(false), own: is(null), ask: (point) => asked.push(point) },
  };
  await pointers.keys.askToLook({ room, ui: { notify: assert.fail } });
  assert.deepEqual(asked, [[1, 2, 3]]);
});
