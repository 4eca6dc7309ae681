// Colours of regions: the choices, of one and of several, and what is said where it does not show.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../../page.mjs';

const { textureNote, textureOf, texturePatch, textures, withInner } = await load('features/regions/textures.js');
const regions = [
  { id: 'scalp', parent: '' },
  { id: 'skull', parent: 'scalp' },
  { id: 'brain', parent: 'skull' },
  { id: 'eye', parent: 'scalp' },
  { id: 'couch', parent: '' },
];
const plan = { regions, images: [{}], doses: [] };
const sceneOf = (styles, dose = {}) => ({ regions: styles, dose: { wash: { visible: false }, compare: { mode: 'none' }, ...dose } });
const styled = (texture, more = {}) => ({ texture, visible: true, representation: 'surface', ...more });

test('the choices are those that the plan has, and what is chosen now', () => {
  const names = (of, now) => textures(of, now).map(([texture]) => texture);
  assert.deepEqual(names(plan, 'none'), ['none', 'image']);
  assert.deepEqual(names({ ...plan, images: [], doses: [{}] }, 'none'), ['none', 'dose']);
  assert.deepEqual(names({ ...plan, images: [] }, 'dose'), ['none', 'dose']);
});

test('several regions have a common one or none, and a region has all inside it, at any depth', () => {
  assert.deepEqual(
    withInner(plan, regions[0]).map(({ id }) => id),
    ['scalp', 'skull', 'eye', 'brain'],
  );
  const scene = sceneOf({
    scalp: styled('dose'),
    skull: styled('dose'),
    brain: styled('dose'),
    eye: styled('dose'),
    couch: styled('none'),
  });
  assert.deepEqual([textureOf(scene, withInner(plan, regions[0])), textureOf(scene, regions)], ['dose', '']);
  assert.deepEqual(texturePatch([regions[1], regions[4]], 'image'), {
    regions: { skull: { texture: 'image' }, couch: { texture: 'image' } },
  });
});

test('where it does not show, the reason is said', () => {
  const note = (style, dose) => textureNote(sceneOf({ scalp: style }, dose), regions[0]);
  assert.match(note(styled('dose')), /wash is off/);
  assert.equal(note(styled('dose'), { wash: { visible: true } }), '');
  assert.equal(note(styled('dose'), { compare: { mode: 'gamma' } }), '', 'the wash of a comparison shows');
  assert.match(note(styled('image', { representation: 'points' })), /own colour/);
  assert.deepEqual([note(styled('image')), note(styled('none')), note(styled('dose', { visible: false }))], ['', '', '']);
});
