// The addresses of the page, as net/address.js reads and makes them.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../page.mjs';

const { placeOf, roomOf, roomPath } = await load('net/address.js');

const token = '0123456789abcdef0123456789abcdef';
const nothing = { place: '', id: '', plan: '', link: '' };
const at = (address) => {
  const { pathname, hash } = new URL(address, 'http://host');
  return placeOf({ pathname, hash });
};

test('a room has a path, and the token of a link stands behind "#", where no server sees it', () => {
  assert.equal(roomPath('kave-rimo'), '/rooms/kave-rimo');
  assert.deepEqual(at(roomPath('kave-rimo')), { place: 'rooms', id: 'kave-rimo', plan: '', link: '' });
  const url = new URL(roomPath('kave-rimo', token), 'http://host');
  assert.deepEqual([url.pathname + url.search, url.hash], ['/rooms/kave-rimo', `#link=${token}`]);
  assert.deepEqual(at(url.href), { place: 'rooms', id: 'kave-rimo', plan: '', link: token });
  assert.deepEqual(at('/rooms/kave-rimo#picture-1'), { place: 'rooms', id: 'kave-rimo', plan: '', link: '' });
});

test('addresses of the time when rooms were fragments lead to the same rooms', () => {
  assert.deepEqual(at('/#/rooms/kave-rimo'), { place: 'rooms', id: 'kave-rimo', plan: '', link: '' });
  assert.deepEqual(at('/#/rooms/kave-rimo/head-3'), { place: 'rooms', id: 'kave-rimo', plan: 'head-3', link: '' });
  assert.deepEqual(at(`/#/rooms/kave-rimo?link=${token}`), { place: 'rooms', id: 'kave-rimo', plan: '', link: token });
  assert.deepEqual(at(`/#/p/${token}`), { place: 'p', id: token, plan: '', link: '' });
});

test('kept records have an address each, and one for all', () => {
  assert.deepEqual(at('/records'), { ...nothing, place: 'records' });
  assert.deepEqual(at('/records/i-12345'), { ...nothing, place: 'records', id: 'i-12345' });
  assert.deepEqual(at('/#/records/i-12345'), nothing);
});

test('every other address shows the start page', () => {
  for (const other of [
    '/',
    '/#/',
    '/index.html',
    '/modules.html',
    '/rooms/',
    '/rooms/UP',
    '/#/rooms/a%20b',
    '/#picture-1',
    `/#link=${token}`,
  ])
    assert.deepEqual(at(other), nothing, other);
});

test('a room is found in what somebody types or pastes', () => {
  assert.equal(roomOf(' kave-rimo ').id, 'kave-rimo');
  assert.equal(roomOf('http://host:8080/rooms/kave-rimo').id, 'kave-rimo');
  assert.deepEqual(roomOf(`https://host/rooms/kave-rimo#link=${token}`), { place: 'rooms', id: 'kave-rimo', plan: '', link: token });
  assert.deepEqual(roomOf('https://host/#/rooms/kave-rimo/head-3'), { place: 'rooms', id: 'kave-rimo', plan: 'head-3', link: '' });
  for (const other of ['', 'a b', '//evil/rooms/kave', 'https://host/', 'https://host/p/kave'])
    assert.notEqual(roomOf(other).place, 'rooms', other);
});
