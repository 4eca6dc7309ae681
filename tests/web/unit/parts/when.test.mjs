// Times in lists, and the name of a room that was given none.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../page.mjs';

const { day, dicomDay, roomName, when } = await load('parts/when.js');

const now = new Date(2026, 10, 27, 18, 5).getTime();
const at = (...parts) => new Date(...parts).getTime();

test('a time is told as near as it is: of today, yesterday, this year, another', () => {
  assert.equal(when(at(2026, 10, 27, 9, 7), now), '09:07');
  assert.equal(when(at(2026, 10, 26, 16, 40), now), 'yesterday 16:40');
  assert.equal(when(at(2026, 10, 26, 0, 0), now), 'yesterday 00:00');
  assert.equal(when(at(2026, 10, 25, 23, 59), now), '25 Nov 23:59');
  assert.equal(when(at(2025, 10, 9, 16, 40), now), '9 Nov 2025');
  assert.equal(when(at(2026, 10, 28, 8, 30), now), '28 Nov 08:30', 'tomorrow, as of a meeting');
  assert.equal(day(at(2026, 10, 9), now), '9 Nov');
});

test('a day of a file is a day only if it is one', () => {
  assert.equal(dicomDay('20261109'), '9 Nov 2026');
  for (const none of ['', '2026', '2026.11.09']) assert.equal(dicomDay(none), '');
});

test('a room has its given name, else that of its plan and the day on which it was made', () => {
  const created_at = new Date(new Date().getFullYear(), 10, 27, 12).toISOString();
  assert.equal(roomName({ name: 'Second look', created_at }, 'BNCT-2'), 'Second look');
  assert.equal(roomName({ name: '', created_at }, 'BNCT-2'), 'BNCT-2, 27 Nov');
});
