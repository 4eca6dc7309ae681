// Why an answer does not come: every wait has an end, or its reason.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../page.mjs';

const { doseWaitReason, waitReason } = await load('room/waits.js');
const { listed } = await load('parts/format.js');
const room = ({ link = {}, renderer = {}, plan = { doses: [{}] } } = {}) => ({
  link: { value: { state: 'open', reason: '', ...link } },
  renderer: { value: { state: 'ready', problem: null, ...renderer } },
  plan: { value: plan },
});

test('while answers come, nothing but the work itself is waited for', () => {
  assert.equal(waitReason(room()), '');
  assert.equal(doseWaitReason(room()), '');
});

for (const [what, of, expected] of [
  ['a lost connection', { link: { state: 'lost' } }, /connection to the server is lost/],
  ['a room that has ended', { link: { state: 'ended', reason: 'the plan was deleted' } }, /the room has ended, the plan was deleted\.$/],
  [
    'a plan that cannot be loaded',
    { renderer: { state: 'failed', problem: { detail: 'ct.nii.gz: cut after 12 bytes' } } },
    /^Not known: ct\.nii\.gz: cut after 12 bytes\.$/,
  ],
  ['a closed plan without a reason', { renderer: { state: 'closed' } }, /the plan cannot be shown/],
  ['a renderer that restarts', { renderer: { state: 'restarting' } }, /started again/],
  ['a plan that is loading', { renderer: { state: 'loading' }, plan: null }, /being opened/],
  ['a plan without dose', { plan: { doses: [] } }, /no dose/],
])
  test(`it says ${what}`, () => assert.match(doseWaitReason(room(of)), expected));

test('a quantity without unit has no comma', () => {
  assert.deepEqual(
    [listed('Physical total', 'Gy'), listed('Physical total', ''), listed('', 'Boron')],
    ['Physical total, Gy', 'Physical total', 'Boron'],
  );
});
