// The basis of doses in the report to print: it has the weights, whatever could not be asked.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../../page.mjs';
import { drawn } from '../../template.mjs';

const { basisTable } = await load('features/dose/plots/chart_basis.js');
const is = (value) => ({ value, peek: () => value });

const weights = { boron_ratio: 1, cbe: 3.8, nitrogen: 3.2, fast: 3.2, gamma: 1, other: 1 };
const plan = {
  name: 'Made up',
  doses: [{ id: 'd', name: 'Doses', components: [] }],
  regions: [{ id: 'tumour', name: 'Tumour' }],
  images: [],
  fits: [],
};
const scene = { dose: { id: 'd', quantity: 'weighted', factor: 1, weights: { tumour: weights }, weights_name: 'usual' } };
const answer = { id: 'd', quantity: 'weighted', unit: 'Gy(w)', reference: { value: 12, words: 'maximum' }, missing: [] };

function textOf(scale, isOfScene) {
  const room = { plan: is(plan), scene: is(scene), planId: is('made-up'), revision: is('r'), accepted: is({}) };
  const world = { room, doses: { scale: is(scale), isOfScene: () => isOfScene }, curves: { population: 'own' } };
  return drawn(basisTable(world)).text;
}

test('the weights of each region stand in the basis, also when 100 % could not be asked', () => {
  const known = textOf({ result: answer, error: '' }, true);
  assert.match(known, /3\.8/);
  assert.match(known, /100 %/);
  for (const text of [textOf({ result: null, error: 'the renderer is gone' }, false), textOf({ result: null, error: '' }, false)]) {
    assert.match(text, /3\.8/);
    assert.doesNotMatch(text, /100 %/);
  }
  assert.match(textOf({ result: null, error: 'the renderer is gone' }, false), /the renderer is gone/);
});
