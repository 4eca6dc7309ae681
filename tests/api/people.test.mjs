// Closed rooms of people who sign in: who gets in, as whom, what guests may, who is put out, and all of it after a kill. --stub: grey pictures.
import assert from 'node:assert/strict';
import { mkdtempSync, rmSync } from 'node:fs';
import { request } from 'node:http';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { call, startDaemon, until } from './daemon.mjs';
import { Client } from './ws_client.mjs';

const password = 'correct horse';
const args = ['--stub', '--sign-in', 'local', '--guest-links', '--grant', '* pat planner', '--grant', '* @physics reviewer'];

describe('People of a room', () => {
  let data, daemon, room, pat, rae, zoe;
  const api = (path, who = {}, method = 'GET', body) => call(`${daemon.url}/api/v1${path}`, method, body, who);
  const signIn = async (user) => {
    const { status, headers } = await api('/session', {}, 'POST', { user, password });
    assert.equal(status, 201);
    return { Cookie: headers.get('set-cookie').split(';')[0] };
  };
  /** Opens a WebSocket and says hello. @returns {Promise<Client>} with `first`, the welcome or the bye */
  const hello = async (who, fields = {}, id = room) => {
    const client = await Client.open(daemon.url, `/api/v1/rooms/${id}/ws`, who);
    client.send({ type: 'hello', protocol: 2, ...fields });
    client.first = await client.until(() => client.messages.find(({ type }) => type === 'welcome' || type === 'bye'), 'an answer');
    return client;
  };
  const seatOf = ({ first: { member, secret } }) => ({ member, secret });
  const headerOf = ({ first: { member, secret } }) => ({ 'Beamroom-Member': `${member} ${secret}` });

  before(async () => {
    data = mkdtempSync(join(tmpdir(), 'beamroom-people-'));
    daemon = await startDaemon({ args, data });
    const token = await until(
      () => /signin\/first#([0-9a-f]{64})/.exec(daemon.log())?.[1],
      (found) => found,
    );
    const first = await api('/session/first', {}, 'POST', { token, user: 'ada', name: 'Ada', password });
    assert.ok(first.status < 300, JSON.stringify(first.json));
    const admin = await signIn('ada');
    for (const [user, name, groups] of [
      ['pat', 'Pat Lee', ''],
      ['rae', 'Rae', 'physics'],
      ['zoe', 'Zoe', ''],
    ])
      assert.equal((await api('/users', admin, 'POST', { user, name, password, groups })).status, 204);
    [pat, rae, zoe] = [await signIn('pat'), await signIn('rae'), await signIn('zoe')];
    const { plans } = (await api('/plans', pat)).json;
    room = (await api('/rooms', pat, 'POST', { plan: plans[0].id })).json.id;
  });
  after(async () => {
    assert.equal(await daemon?.stop(), 0);
    rmSync(data, { recursive: true, force: true });
  });

  test('a room is closed, and tells those outside no more than one that is not there', async () => {
    for (const [who, code, closeCode] of [
      [rae, '', 1000],
      [zoe, '', 1000],
      [{}, 'sign-in', 1008],
    ]) {
      const [here, absent] = [await hello(who, { name: 'Pat Lee' }), await hello(who, {}, 'zzzz-zzzz')];
      assert.deepEqual(here.first, absent.first);
      assert.deepEqual([here.first.type, here.first.code, here.first.retry_ms], ['bye', code, null]);
      await here.until(() => here.closeCode && absent.closeCode, 'the end');
      assert.deepEqual([here.closeCode, absent.closeCode], [closeCode, closeCode]);
      assert.equal((await api('/rooms', who)).json.rooms?.length ?? 0, 0);
      assert.equal((await api(`/rooms/${room}/people`, who)).status, (await api('/rooms/zzzz-zzzz/people', who)).status);
    }
    assert.deepEqual(
      (await api('/rooms', pat)).json.rooms.map(({ id }) => id),
      [room],
    );
  });

  test('nor does a first message that is no good, or a link that nobody made', async () => {
    const first = async (who, text, id) => {
      const client = await Client.open(daemon.url, `/api/v1/rooms/${id}/ws`, who);
      client.send(text);
      await client.until(() => client.closeCode, 'the end');
      return [client.messages, client.closeCode];
    };
    const madeUp = { type: 'hello', protocol: 2, link: '0'.repeat(32) };
    for (const who of [zoe, {}])
      for (const text of [{ type: 'hello', protocol: 1 }, '{"type":"hello"', { type: 'present' }, madeUp, { ...madeUp, protocol: 1 }]) {
        const here = await first(who, text, room);
        assert.deepEqual(here, await first(who, text, 'zzzz-zzzz'));
        assert.equal(here[0].length, 1);
        assert.equal(here[0][0].code, who === zoe || typeof text.link === 'string' ? '' : 'sign-in');
      }
    assert.match((await first(pat, { type: 'hello', protocol: 1 }, room))[0][0].reason, /reload/);
  });

  test('who is asked in comes in under the name of the sign-in, a guest by a link that says so', async () => {
    const asked = await api(`/rooms/${room}/people`, pat, 'PATCH', { people: [{ who: '@physics' }] });
    assert.deepEqual(asked.json, { owner: 'pat', is_open: false, people: [{ who: '@physics' }], removed: [] });
    const link = (await api(`/rooms/${room}/links`, pat, 'POST', { role: 'reviewer', guests: true, name: 'Thursday' })).json;
    const [owner, reviewer] = [await hello(pat, { name: 'Somebody' }), await hello(rae, { name: 'Somebody' })];
    const guest = await hello({}, { link: link.token, name: 'Gus', person: 'g' });
    const members = (await api(`/rooms/${room}/members`, headerOf(guest))).json.members;
    assert.deepEqual(
      members.map(({ name, user, role, is_guest: isGuest }) => [name, user, role, isGuest]),
      [
        ['Pat Lee', 'pat', 'planner', undefined],
        ['Rae', 'rae', 'reviewer', undefined],
        ['Gus', undefined, 'reviewer', true],
      ],
    );
    assert.equal((await api(`/rooms/${room}/exports`, headerOf(guest), 'POST', { what: 'notes', name: 'x' })).status, 401);
    assert.equal((await api(`/rooms/${room}/links`, headerOf(guest))).status, 401);
    // a seat of another user is nobody's
    assert.equal((await api(`/rooms/${room}/members`, { ...zoe, ...headerOf(reviewer) })).status, 404);
    const other = await hello(zoe, seatOf(reviewer));
    assert.equal(other.first.type, 'bye');
    // notes are their writer's, and those of guests say so
    const note = (await api(`/rooms/${room}/notes`, headerOf(guest), 'POST', { body: { text: 'look' } })).json;
    assert.deepEqual([note.author_name, note.is_guest], ['Gus', true]);
    assert.equal((await api(`/rooms/${room}/notes/${note.id}`, { ...pat, ...headerOf(owner) }, 'DELETE')).status, 403);
    const hidden = await api(`/rooms/${room}/notes/${note.id}/hide`, { ...pat, ...headerOf(owner) }, 'POST', {});
    assert.deepEqual([hidden.status, hidden.json.hidden_by, hidden.json.body.text], [200, 'Pat Lee', 'look']);
    // the guest is removed, and its link lets nobody in
    const gone = await api(`/rooms/${room}/members/${guest.first.member}?reason=by%20mistake`, { ...pat, ...headerOf(owner) }, 'DELETE');
    assert.equal(gone.status, 204);
    assert.deepEqual(await guest.message('bye').then(({ code, reason }) => [code, reason]), [
      'removed',
      'Pat Lee removed you from this room: by mistake',
    ]);
    assert.equal((await hello({}, { link: link.token })).first.type, 'bye');
    for (const client of [owner, reviewer]) client.cut();
  });

  test('one person listens four times to a room, and leaves places to others', async () => {
    const link = (await api(`/rooms/${room}/links`, pat, 'POST', { role: 'reviewer', guests: true })).json;
    const guest = await hello({}, { link: link.token, name: 'Gia', person: 'h' });
    const streams = [];
    const listen = (headers) =>
      new Promise((done, failed) => {
        const stream = request(`${daemon.url}/api/v1/rooms/${room}/events`, { headers, agent: false }, (answer) => {
          done([answer.statusCode, Number(answer.headers['retry-after'] ?? 0) > 0]);
          answer.on('error', () => {}); // it is cut off below
        });
        stream.on('error', failed);
        stream.end();
        streams.push(stream);
      });
    for (const who of [pat, headerOf(guest)]) {
      for (let i = 0; i < 4; i++) assert.deepEqual(await listen(who), [200, false]);
      assert.deepEqual(await listen(who), [429, true]);
    }
    for (const stream of streams) stream.destroy();
    guest.cut();
  });

  test('a signature has the name of the sign-in and is of who has just proved it', async () => {
    const reviewer = await hello(rae);
    await until(
      () => api(`/rooms/${room}/record`, rae),
      ({ status }) => status === 200,
    );
    const signed = await api(`/rooms/${room}/signatures`, { ...rae, ...headerOf(reviewer) }, 'POST', { body: { meaning: 'reviewed' } });
    assert.equal(signed.status, 201, JSON.stringify(signed.json));
    assert.deepEqual([signed.json.body.name, signed.json.body.user, signed.json.body.signed_in], ['Rae', 'rae', true]);
    reviewer.cut();
  });

  test('the end of a sign-in is a bye of its own; after a kill and a new sign-in the seat is there, and people are as they were', async () => {
    const reviewer = await hello(rae);
    assert.equal((await api('/session', rae, 'DELETE')).status, 204);
    assert.equal((await reviewer.message('bye')).code, 'sign-in');
    await reviewer.until(() => reviewer.closeCode, 'the end');
    assert.equal(reviewer.closeCode, 1008);
    await until(
      () => api(`/rooms/${room}/record`, pat),
      ({ json }) => json.saved?.state === 'saved',
    );
    daemon.child.kill('SIGKILL');
    await daemon.stop();
    daemon = await startDaemon({ args, data });
    rae = await signIn('rae');
    assert.deepEqual(
      (await api('/rooms', rae)).json.rooms.map(({ id, asleep }) => [id, asleep]),
      [[room, true]],
    );
    assert.deepEqual((await api('/rooms', zoe)).json, { rooms: [], n_asleep: 0 });
    // strangers do not wake it, and hear what they hear of one that is not there
    for (const who of [zoe, {}]) assert.deepEqual((await hello(who)).first, (await hello(who, {}, 'zzzz-zzzz')).first);
    assert.equal((await api('/rooms', rae)).json.rooms[0].asleep, true);
    for (const [who, status] of [
      [rae, 403], // a reviewer
      [zoe, 404],
    ])
      assert.equal(
        (await api(`/rooms/${room}?records=keep`, who, 'DELETE')).status,
        status,
        'a room that sleeps is not deleted without the right',
      );
    assert.equal((await api(`/rooms/${room}`, pat)).status, 200);
    const again = await hello(rae, seatOf(reviewer));
    assert.equal(again.first.member, reviewer.first.member);
    assert.equal((await hello(zoe, seatOf(reviewer))).first.type, 'bye');
    assert.equal((await api(`/rooms/${room}/people`, pat)).json.people.length, 1);
    again.cut();
  });
});
