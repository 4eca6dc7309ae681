// Rights in a room: every message from the page and every route of a room, by every role. What they are and which
// right each needs comes from proto/; which role has which right stands here.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, describe, it } from 'node:test';
import { call, openPlan, startDaemon } from './daemon.mjs';
import { isRefused as isMessageRefused, rightOfMember, sent } from './sample_messages.mjs';
import { Client } from './ws_client.mjs';

const may = {
  observer: ['look'],
  reviewer: ['look', 'point', 'note', 'scene'],
  presenter: ['look', 'point', 'note', 'scene', 'control'],
};
/** In a room that has links, of a call that comes from no member. */
const nobodyMay = ['look', 'point', 'note'];

const read = (name) => JSON.parse(readFileSync(new URL(`../../proto/${name}.json`, import.meta.url), 'utf8'));
const routes = read('http').routes.filter(({ path }) => path.includes('{room}'));

describe('rights in a room', () => {
  let daemon;
  let room;
  const people = {};
  const headers = {};
  const api = (path, method, body, more) => call(`${daemon.url}/api/v1/rooms/${room}${path}`, method, body, more);

  async function enter(hello = {}) {
    const client = await Client.hello(daemon.url, room, hello);
    const welcome = await client.until(() => client.messages.find(({ type }) => type === 'welcome' || type === 'bye'), 'welcome or bye');
    return { client, welcome };
  }

  before(async () => {
    daemon = await startDaemon();
    await openPlan(daemon.url, 'phantom');
    room = (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id;
    people.presenter = await enter();
    for (const role of ['reviewer', 'observer']) {
      const { json } = await api(
        '/links',
        'POST',
        { role },
        { 'Beamroom-Member': `${people.presenter.welcome.member} ${people.presenter.welcome.secret}` },
      );
      people[role] = await enter({ link: json.token });
    }
    for (const [role, { welcome }] of Object.entries(people)) headers[role] = { 'Beamroom-Member': `${welcome.member} ${welcome.secret}` };
  });
  after(async () => {
    for (const { client } of Object.values(people)) client.cut();
    assert.equal(await daemon.stop(), 0);
  });

  it('roles and links give what members tells', async () => {
    const { json } = await api('/members');
    assert.deepEqual(
      json.members.map(({ role, color, lag, tabs }) => [role, /^#[0-9a-f]{6}$/.test(color), lag, tabs]),
      [
        ['presenter', true, 'none', 1],
        ['reviewer', true, 'none', 1],
        ['observer', true, 'none', 1],
      ],
    );
    assert.equal(new Set(json.members.map(({ color }) => color)).size, 3);
  });

  for (const message of sent)
    it(`${message.name} needs ${message.needs[0]}`, async () => {
      for (const [role, { client }] of Object.entries(people)) {
        const refused = await isMessageRefused(client, message);
        assert.equal(!refused, may[role].includes(message.needs[0]), `${role} ${refused ? 'was refused' : 'may'} ${message.name}`);
      }
    });

  const endsRoom = ({ method, path }) => Number(method === 'DELETE' && path === '/api/v1/rooms/{room}'); // the last one
  for (const { method, path, needs } of routes.sort((a, b) => endsRoom(a) - endsRoom(b)))
    it(`${method} ${path} needs ${needs[0]}`, async () => {
      const right = rightOfMember(needs[0]);
      const within = path.slice('/api/v1/rooms/{room}'.length).replace(/\{\w+\}/g, 'x');
      const body = method === 'GET' || method === 'DELETE' ? undefined : {};
      const isRefused = async (more) => {
        const { status, json } = await api(within, method, body, more);
        return status === 403 && ['role', 'member'].includes(json.code);
      };
      assert.equal(await isRefused({ 'Beamroom-Member': 'm1 0123456789abcdef0123456789abcdef' }), true, 'a wrong secret');
      assert.equal(await isRefused({}), !nobodyMay.includes(right), 'nobody of the room');
      for (const role of ['observer', 'reviewer', 'presenter'])
        assert.equal(await isRefused(headers[role]), !may[role].includes(right), role);
    });
});

describe('links of a room', () => {
  let daemon;
  before(async () => {
    daemon = await startDaemon();
  });
  after(async () => {
    assert.equal(await daemon.stop(), 0);
  });

  const newRoom = async () => {
    await openPlan(daemon.url, 'phantom');
    return `${daemon.url}/api/v1/rooms/${(await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id}`;
  };
  async function hello(room, link) {
    const client = await Client.open(daemon.url, `${new URL(room).pathname}/ws`);
    client.send({ type: 'hello', protocol: 2, link });
    const first = await client.until(() => client.messages.find(({ type }) => type === 'welcome' || type === 'bye'), 'welcome or bye');
    client.cut();
    return first;
  }

  it('the end of a link puts out who came by it, and a call removes a member', async () => {
    const room = await newRoom();
    const enter = async (link = '') => {
      const client = await Client.hello(daemon.url, room.split('/').at(-1), { link, name: link ? 'Ben' : 'Ann' });
      return { client, welcome: await client.message('welcome') };
    };
    const ann = await enter();
    const headers = { 'Beamroom-Member': `${ann.welcome.member} ${ann.welcome.secret}` };
    const make = async (body) => (await call(`${room}/links`, 'POST', body, headers)).json;
    const link = await make({ role: 'observer', name: 'Thursday', guests: true });
    assert.equal((await make({ role: 'planner' })).code, 'role'); // more than Ann has
    const [ben, wall] = [await enter(link.token), await enter((await make({ role: 'wall' })).token)];
    const { links } = (await call(`${room}/links`, 'GET', undefined, headers)).json;
    assert.deepEqual(
      links.map(({ name, guests, came }) => [name, guests, came]),
      [
        ['Thursday', true, 1],
        ['', false, 1],
      ],
    );
    const refused = await call(`${room}/links/${link.id}?members=all`, 'DELETE', undefined, headers);
    assert.deepEqual([refused.status, refused.json.pointer], [422, '/members']);
    assert.equal((await call(`${room}/links/${link.id}?members=remove`, 'DELETE', undefined, headers)).status, 204);
    const bye = await ben.client.message('bye');
    assert.deepEqual([bye.code, bye.reason, bye.retry_ms], ['removed', 'Ann removed you from this room', null]);
    const gone = await call(`${room}/members/${wall.welcome.member}?reason=the%20meeting%20is%20over`, 'DELETE', undefined, headers);
    assert.equal(gone.status, 204);
    assert.match((await wall.client.message('bye')).reason, /^Ann removed you from this room: the meeting is over$/);
    assert.equal((await call(`${room}/members/${wall.welcome.member}`, 'DELETE', undefined, headers)).status, 404);
    assert.equal((await call(`${room}/members`)).json.members.length, 1);
    ann.client.cut();
  });

  it('a link is made with a role, a time and for one or many', async () => {
    const room = await newRoom();
    const { status, json } = await call(`${room}/links`, 'POST', { role: 'reviewer', expires_s: 60, one_use: true });
    assert.equal(status, 201);
    assert.match(json.token, /^[0-9a-f]{32}$/);
    assert.equal(json.url, `/rooms/${room.split('/').at(-1)}#link=${json.token}`);
    assert.deepEqual([json.role, json.expires_s, json.one_use], ['reviewer', 60, true]);
    assert.equal((await hello(room, json.token)).type, 'welcome');
    const again = await hello(room, json.token);
    assert.deepEqual([again.type, again.retry_ms], ['bye', null]);
    assert.match(again.reason, /has been used/);
    assert.match((await hello(room, 'f'.repeat(32))).reason, /not one of this room/);
    const other = await newRoom();
    const theirs = (await call(`${other}/links`, 'POST', { role: 'presenter' })).json;
    assert.equal(theirs.expires_s, 86400);
    assert.match((await hello(room, theirs.token)).reason, /not one of this room/);
  });

  it('what is no link is refused with the field', async () => {
    const room = await newRoom();
    for (const [body, pointer] of [
      [{}, '/role'],
      [{ role: 'boss' }, '/role'],
      [{ role: 1 }, '/role'],
      [{ role: 'observer', expires_s: 59 }, '/expires_s'],
      [{ role: 'observer', expires_s: 2592001 }, '/expires_s'],
      [{ role: 'observer', expires_s: 60.5 }, '/expires_s'],
      [{ role: 'observer', expires_s: '60' }, '/expires_s'],
      [{ role: 'observer', one_use: 1 }, '/one_use'],
      [{ role: 'observer', until: 1 }, '/until'],
    ]) {
      const { status, json } = await call(`${room}/links`, 'POST', body);
      assert.deepEqual([status, json.pointer], [422, pointer], JSON.stringify(body));
    }
  });

  it('a room keeps 32 links', async () => {
    const room = await newRoom();
    const headers = {};
    const client = await Client.open(daemon.url, `${new URL(room).pathname}/ws`);
    client.send({ type: 'hello', protocol: 2 });
    const { member, secret } = await client.message('welcome');
    headers['Beamroom-Member'] = `${member} ${secret}`;
    for (let n = 0; n < 32; n++) assert.equal((await call(`${room}/links`, 'POST', { role: 'observer' }, headers)).status, 201);
    const { status, json } = await call(`${room}/links`, 'POST', { role: 'observer' }, headers);
    assert.deepEqual([status, json.type], [429, '/problems/limit']);
    client.cut();
  });

  it('a room without links takes changes from everybody, one with links from who presents', async () => {
    const room = await newRoom();
    const patch = (headers = {}) => call(`${room}/scene`, 'PATCH', { axes: { visible: false } }, { 'If-Match': '*', ...headers });
    assert.equal((await patch()).status, 200);
    assert.equal((await call(`${room}/links`, 'POST', { role: 'observer' })).status, 201);
    const { status, json } = await patch();
    assert.deepEqual([status, json.code], [403, 'role']);
    assert.equal((await call(`${room}/scene`)).status, 200);
    const client = await Client.open(daemon.url, `${new URL(room).pathname}/ws`);
    client.send({ type: 'hello', protocol: 2 });
    const { member, secret } = await client.message('welcome');
    await client.message('members');
    assert.equal((await patch({ 'Beamroom-Member': `${member} ${secret}` })).status, 200);
    client.cut();
  });
});
