// Facts of a room that a tab keeps are for the person who was in it.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../page.mjs';

const { isPersonal, keptFor } = await load('net/kept.js');

const seat = { member: 'm-1', secret: 's', plan: 'p', link: 'token' };

test('another person gets nothing of a seat, nor its link', () => {
  assert.deepEqual(keptFor({ ...seat, user: 'ann' }, 'ben'), {});
  assert.deepEqual(keptFor({ ...seat, user: '' }, 'ben'), {}, 'of a guest');
  assert.deepEqual(keptFor({ link: 'token', isGuest: true }, 'ben'), {}, 'of a guest who has not been in yet');
});

test('the same person, and whoever comes where nobody signs in, goes on', () => {
  for (const [kept, user] of [
    [{ ...seat, user: 'ann' }, 'ann'],
    [{ ...seat, user: 'ann' }, ''], // who has to sign in again
    [{ ...seat, user: '' }, ''],
    [{ link: 'token', isNew: true }, 'ann'],
    [{ link: 'token', isGuest: true }, ''],
    [{}, 'ann'],
  ])
    assert.deepEqual(keptFor(kept, user), kept);
});

test('a link that was opened after the other person left lets in', () => {
  assert.deepEqual(keptFor({ ...seat, user: 'ann', link: 'fresh', isNew: true }, 'ben'), { link: 'fresh', isNew: true });
});

test('it is asked first who this is, where something is kept for one person', () => {
  assert.deepEqual([{ user: 'ann' }, { isGuest: true }, { user: '', member: 'm-1' }, {}].map(isPersonal), [true, true, false, false]);
});
