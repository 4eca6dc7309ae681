// Rights over HTTP: every route of proto/ by ten kinds of caller, on what is their own, granted to them, and neither.
// Which right a route needs comes from proto/; which kind of caller has which right stands here. --stub: grey pictures.
import assert from 'node:assert/strict';
import { createHash } from 'node:crypto';
import { chmodSync, cpSync, mkdirSync, mkdtempSync, readFileSync, realpathSync, rmSync } from 'node:fs';
import { request } from 'node:http';
import { connect } from 'node:net';
import { tmpdir, userInfo } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { questionRoutes } from '../../proto/gen/packets.mjs';
import { demo, startDaemon, until } from './daemon.mjs';
import { isRefused, sent } from './sample_messages.mjs';
import { Client } from './ws_client.mjs';

const read = (name) => JSON.parse(readFileSync(new URL(`../../proto/${name}.json`, import.meta.url), 'utf8'));
const described = [...read('http').routes, ...questionRoutes(read('packets'))];

const reads = ['look', 'measure', 'export'];
const rightsOf = {
  none: [],
  observer: ['look'],
  reviewer: [...reads, 'point', 'note', 'scene', 'meet'],
  presenter: [...reads, 'point', 'note', 'scene', 'meet', 'control'],
  planner: [...reads, 'point', 'note', 'scene', 'meet', 'control', 'close', 'plan'],
  admin: [...reads, 'point', 'note', 'scene', 'meet', 'control', 'close', 'plan', 'serve'],
  reader: reads, // a token that may only read, of a planner
  guest: ['look', 'point', 'note'], // of a link of the role reviewer
  wall: ['look'],
};
/** Each kind of caller: what it has on what is its own, what is granted, and what is neither; on the server. */
const kinds = {
  nobody: { own: null, granted: 'none', foreign: 'none', server: 'none' },
  observer: { own: null, granted: 'observer', foreign: 'none', server: 'none' },
  reviewer: { own: 'reviewer', granted: 'reviewer', foreign: 'none', server: 'none' },
  presenter: { own: 'presenter', granted: 'presenter', foreign: 'none', server: 'none' },
  planner: { own: 'planner', granted: 'planner', foreign: 'none', server: 'none', uploads: 'planner' },
  admin: { own: 'admin', granted: 'admin', foreign: 'admin', server: 'admin', uploads: 'admin' },
  guest: { own: 'guest', granted: 'none', foreign: 'none', server: 'none' },
  wall: { own: 'wall', granted: 'none', foreign: 'none', server: 'none' },
  'token read': { own: 'reader', granted: 'reader', foreign: 'none', server: 'none' },
  'token plan': { own: 'planner', granted: 'planner', foreign: 'none', server: 'none', uploads: 'planner' },
};
const isSignedIn = (kind) => !['nobody', 'guest', 'wall'].includes(kind);

/** The words for an answer: signed-out, absent, forbidden or allowed. */
function saidBy({ status, json, headers }) {
  if (status === 401 || (status === 303 && headers.location?.startsWith('/signin?'))) return 'signed-out';
  if (status === 403 && json?.code === 'role') return 'forbidden';
  return status === 404 ? 'absent' : 'allowed';
}

/** The expected words for the answer to this route, by the right that it needs. Several words: each will do, as ids inside the subject are made up. */
function expected({ path, needs: [right, subject] }, kind, which) {
  const may = kinds[kind];
  const nothing = isSignedIn(kind) ? ['absent'] : ['signed-out'];
  const allowed = ['allowed', 'absent'];
  if (right === 'free') return /session|signin/.test(path) ? [...allowed, 'signed-out'] : allowed; // signing in may say so itself
  if (right === 'signed-in') return isSignedIn(kind) ? allowed : ['signed-out'];
  if (['job', 'record', 'saved', 'named', 'meeting'].includes(subject) && !isSignedIn(kind)) return ['signed-out'];
  if (['job', 'record', 'saved'].includes(subject)) return ['absent']; // made up
  if (subject === 'named') return ['allowed']; // an empty body is told what is missing; rooms on plans: below
  const whole = subject === 'server' ? may.server : subject === 'uploads' ? (may.uploads ?? 'none') : may[which];
  const role = ['room', 'meeting'].includes(subject) && whole === 'reader' ? 'observer' : whole; // in rooms such a token looks
  if (path === '/metrics' && !kinds[kind].bySocket) return allowed; // this machine's own
  if (rightsOf[role].includes(right)) return allowed;
  if (right === 'measure' && subject === 'plan' && role === 'guest') return allowed; // what a reviewer's page asks for
  if (['server', 'uploads'].includes(subject)) return isSignedIn(kind) ? ['forbidden'] : ['signed-out'];
  if (!rightsOf[role].includes('look')) return nothing;
  return isSignedIn(kind) ? ['forbidden'] : subject === 'plan' ? ['signed-out'] : ['forbidden', 'signed-out'];
}

/** Routes that must not be used for real while others are still to be asked. */
const ends = ({ method, path }) =>
  (method === 'DELETE' && /^\/api\/v1\/(rooms\/\{room\}|plans\/\{plan\}|meetings\/\{meeting\})$/.test(path)) ||
  /\/(close|erase|end)$/.test(path) ||
  path.includes('/session') ||
  path.endsWith('/people');

describe('The matrix of rights', { concurrency: false }, () => {
  let folder, socketPath, daemon;
  const plans = {};
  const rooms = { own: {} };
  const meetings = { own: {} };
  const callers = {};
  const seats = [];

  /** One call, of a stream the head alone. */
  const ask = (kind, path, method = 'GET', body) =>
    new Promise((done, failed) => {
      const { headers, socket } = callers[kind];
      const { hostname, port } = new URL(daemon.url);
      const text = body === undefined ? undefined : JSON.stringify(body);
      const call = request(
        {
          ...(socket ? { socketPath } : { hostname, port }),
          path,
          method,
          agent: false,
          headers: {
            ...headers,
            ...(text !== undefined && { 'Content-Type': 'application/json', 'Content-Length': Buffer.byteLength(text), 'If-Match': '*' }),
          },
        },
        (answer) => {
          let got = '';
          const end = () => {
            let json;
            if (/json/.test(answer.headers['content-type'])) json = JSON.parse(got);
            done({ status: answer.statusCode, headers: answer.headers, text: got, json });
          };
          if (/multipart|event-stream/.test(answer.headers['content-type'])) {
            end();
            call.destroy();
            return;
          }
          answer.setEncoding('latin1');
          answer.on('data', (part) => (got += part));
          answer.on('end', end);
        },
      );
      call.on('error', failed);
      call.end(text);
    });

  const made = async (kind, path, body) => {
    const answer = await ask(kind, path, 'POST', body);
    assert.ok(answer.status < 300, `${kind} ${path}: ${answer.status} ${answer.text}`);
    return answer.json;
  };
  const person = (user) => ({
    socket: true,
    headers: { Host: 'beamroom.example', 'X-Forwarded-For': '192.0.2.7', ...(user && { 'X-Beamroom-User': user }) },
  });
  const idOf = (path) => createHash('sha256').update(realpathSync(path)).digest('hex').slice(0, 16);

  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'beamroom-matrix-'));
    chmodSync(folder, 0o777);
    for (const which of ['granted', 'foreign']) {
      const at = join(folder, which, 'plans'); // folders of one name
      mkdirSync(at, { recursive: true });
      cpSync(join(demo, 'phantom'), join(at, `smith-john-${which}`), { recursive: true });
      plans[which] = idOf(join(at, `smith-john-${which}`));
    }
    socketPath = join(folder, 'http.sock');
    const granted = ['observer', 'reviewer', 'presenter', 'planner'].map((role) => `${folder}/granted ${role} ${role}`);
    daemon = await startDaemon({
      plans: [join(folder, 'granted/plans'), join(folder, 'foreign/plans')],
      args: [
        ...['--stub', '--sign-in', 'proxy', '--guest-links', '--listen', `unix:${socketPath}`, '--proxy-user', userInfo().username],
        ...['--public-name', 'beamroom.example'],
        ...[...granted, '* admin admin', 'uploads planner planner'].flatMap((line) => ['--grant', line]),
      ],
    });
    for (const kind of ['observer', 'reviewer', 'presenter', 'planner', 'admin']) callers[kind] = person(kind);
    for (const kind of ['observer', 'reviewer', 'presenter', 'planner', 'admin']) kinds[kind].bySocket = true;
    callers.nobody = { headers: {} };
    for (const scope of ['read', 'plan']) {
      const { token } = await made('admin', '/api/v1/tokens', { user: 'planner', name: `for ${scope}`, scope: [scope], days: 1 });
      callers[`token ${scope}`] = { headers: { Authorization: `Bearer ${token}` } };
    }
    await until(
      () => ask('admin', '/api/v1/plans'),
      ({ json }) => json.plans.length === 2,
    );
    for (const kind of ['reviewer', 'presenter', 'planner', 'admin'])
      rooms.own[kind] = (await made(kind, '/api/v1/rooms', { plan: plans.granted })).id;
    rooms.own['token plan'] = rooms.own['token read'] = rooms.own.planner; // of one person
    rooms.granted = (await made('planner', '/api/v1/rooms', { plan: plans.granted })).id;
    assert.equal((await ask('planner', `/api/v1/rooms/${rooms.granted}/people`, 'PATCH', { is_open: true })).status, 200);
    rooms.foreign = (await made('admin', '/api/v1/rooms', { plan: plans.foreign })).id;
    const agenda = (plan, people = []) => ({ name: 'Board', cases: [{ plan }], people });
    for (const kind of ['presenter', 'planner', 'admin'])
      meetings.own[kind] = (await made(kind, '/api/v1/meetings', agenda(plans.granted))).id;
    meetings.own['token plan'] = meetings.own['token read'] = meetings.own.planner;
    meetings.own.reviewer = (await made('planner', '/api/v1/meetings', agenda(plans.granted, [{ who: 'reviewer' }]))).id; // makes none
    const named = ['observer', 'reviewer', 'presenter'].map((who) => ({ who }));
    meetings.granted = (await made('planner', '/api/v1/meetings', agenda(plans.granted, named))).id;
    meetings.foreign = (await made('admin', '/api/v1/meetings', agenda(plans.foreign))).id;
    for (const [kind, role] of [
      ['guest', 'reviewer'],
      ['wall', 'wall'],
    ]) {
      rooms.own[kind] = (await made('planner', '/api/v1/rooms', { plan: plans.granted })).id;
      const { token } = await made('planner', `/api/v1/rooms/${rooms.own[kind]}/links`, { role, guests: true });
      const client = await Client.enter(daemon.url, rooms.own[kind], { link: token, name: 'Somebody' });
      callers[kind] = { headers: client.headers };
      seats.push(client);
    }
  });
  after(async () => {
    for (const client of seats) client.cut();
    assert.equal(await daemon?.stop(), 0);
    rmSync(folder, { recursive: true, force: true });
  });

  const addressOf = (path, kind, which) =>
    path
      .replace('{plan}', which === 'own' ? plans.granted : plans[which])
      .replace('{room}', which === 'own' ? rooms.own[kind] : rooms[which])
      .replace('{meeting}', (which === 'own' ? meetings.own[kind] : meetings[which]) ?? 'x')
      .replace(/\{\w+\}/g, 'x');

  /** Cells of the matrix whose answer is not as the routes say. */
  async function wrongCells(routes) {
    const wrong = [];
    for (const route of routes)
      for (const kind of Object.keys(kinds))
        for (const which of ['own', 'granted', 'foreign']) {
          const isAbout = ['plan', 'room', 'meeting'].includes(route.needs[1]) || /\{(plan|room|meeting)\}/.test(route.path);
          if (isAbout ? kinds[kind][which] === null : which !== 'granted') continue;
          if (which === 'granted' && route.needs[1] === 'plan' && ['guest', 'wall'].includes(kind)) continue; // it is that of their room
          const should = expected(route, kind, which);
          if (should.includes('allowed') && ends(route)) continue;
          const body = ['GET', 'DELETE'].includes(route.method) ? undefined : {};
          const answer = await ask(kind, addressOf(route.path, kind, which), route.method, body);
          if (!should.includes(saidBy(answer)))
            wrong.push(
              `${route.method} ${route.path}, ${kind}, ${which}: ${answer.status} ${answer.text.slice(0, 120)}, expected ${should}`,
            );
        }
    return wrong;
  }

  test('each route answers each kind of caller by the right that it needs', async () => {
    assert.deepEqual(await wrongCells(described), []);
  });

  test('a route that asked for another right than it says would be found', async () => {
    const planted = (method, path, needs) => [{ ...described.find((route) => route.method === method && route.path === path), needs }];
    assert.notEqual((await wrongCells(planted('GET', '/api/v1/plans/{plan}', ['free', 'none']))).length, 0);
    assert.notEqual((await wrongCells(planted('GET', '/api/v1/rooms/{room}/scene', ['control', 'room']))).length, 0);
    assert.notEqual((await wrongCells(planted('GET', '/api/v1/audit', ['signed-in', 'none']))).length, 0);
    assert.notEqual((await wrongCells(planted('GET', '/api/v1/meetings/{meeting}', ['control', 'meeting']))).length, 0);
  });

  test('what may not be seen is byte for byte as what is not there', async () => {
    const absent = { plan: '0123456789abcdef', room: 'zzzz-zzzz', meeting: 'm-zzzz-zzzz' };
    for (const route of described.filter(({ needs }) => ['plan', 'room', 'meeting'].includes(needs[1])))
      for (const kind of ['planner', 'token read']) {
        const body = ['GET', 'DELETE'].includes(route.method) ? undefined : {};
        const plain = ({ status, headers, text }, id) => {
          const { date: _, ...rest } = headers;
          return { status, headers: rest, text: text.replaceAll(id, 'ID') };
        };
        const subject = route.needs[1];
        const at = (id) => route.path.replace(`{${subject}}`, id).replace(/\{\w+\}/g, 'x');
        const foreign = { plan: plans.foreign, room: rooms.foreign, meeting: meetings.foreign }[subject];
        assert.deepEqual(
          plain(await ask(kind, at(foreign), route.method, body), foreign),
          plain(await ask(kind, at(absent[subject]), route.method, body), absent[subject]),
          `${route.method} ${route.path} ${kind}`,
        );
      }
  });

  test('lists have what may be seen; no address and no name tells the folder', async () => {
    const ids = async (kind, path, list) => (await ask(kind, path)).json[list].map(({ id }) => id);
    for (const kind of ['observer', 'planner', 'token read']) assert.deepEqual(await ids(kind, '/api/v1/plans', 'plans'), [plans.granted]);
    assert.equal((await ids('admin', '/api/v1/plans', 'plans')).length, 2);
    assert.ok(!(await ids('planner', '/api/v1/rooms', 'rooms')).includes(rooms.foreign));
    assert.ok(!(await ids('reviewer', '/api/v1/rooms', 'rooms')).includes(rooms.own.planner));
    for (const path of ['/api/v1/plans', `/api/v1/plans/${plans.granted}`, '/api/v1/rooms'])
      assert.doesNotMatch((await ask('admin', path)).text, /smith/i, path);
    assert.doesNotMatch(daemon.log(), /smith/i);
  });

  test('nobody enters a room without a link, whether it is there or not', async () => {
    for (const room of [rooms.granted, rooms.foreign, rooms.own.planner]) {
      const client = await Client.hello(daemon.url, room, { name: 'Stranger' });
      const { code } = await client.message('bye');
      assert.equal(code, 'sign-in');
      client.cut();
    }
  });

  /** A WebSocket of this kind of caller in the room, with the seat that it has there. */
  async function enter(kind, room, more = {}) {
    const seat = seats[['guest', 'wall'].indexOf(kind)];
    if (seat && room === rooms.own[kind]) return seat;
    const { headers, socket } = callers[kind];
    const client = await Client.open(daemon.url, `/api/v1/rooms/${room}/ws`, headers, socket ? connect(socketPath) : null);
    client.send({ type: 'hello', protocol: 2, name: 'Somebody', ...more });
    return client;
  }

  test('each message of a room is refused to whom its right is not, and a room to whom it is closed', async () => {
    const wrong = [];
    for (const kind of Object.keys(kinds))
      for (const which of ['own', 'granted', 'foreign']) {
        const whole = kinds[kind][which];
        if (whole === null) continue;
        const role = whole === 'reader' ? 'observer' : whole;
        const client = await enter(kind, which === 'own' ? rooms.own[kind] : rooms[which]);
        const first = await client.until(() => client.messages.find(({ type }) => ['welcome', 'bye'].includes(type)), 'welcome or bye');
        if ((first.type === 'welcome') !== (role !== 'none')) wrong.push(`${kind}, ${which}: ${first.type}`);
        for (const message of first.type === 'welcome' ? sent : []) {
          const may = rightsOf[role].includes(message.needs[0]);
          if ((await isRefused(client, message)) === may) wrong.push(`${message.name}, ${kind}, ${which}: ${may ? 'refused' : 'done'}`);
        }
        if (!seats.includes(client)) client.cut();
      }
    assert.deepEqual(wrong, []);
  });

  test('an archive of who may not upload is refused before it is sent', async () => {
    const before = await ask('admin', '/api/v1/plans');
    for (const [kind, status] of [
      ['nobody', 401],
      ['guest', 401],
      ['reviewer', 403],
      ['token read', 403],
    ]) {
      const { headers, socket } = callers[kind];
      const { hostname, port } = new URL(daemon.url);
      const answer = await new Promise((done, failed) => {
        const call = request(
          {
            ...(socket ? { socketPath } : { hostname, port }),
            path: '/api/v1/plans',
            method: 'POST',
            agent: false,
            headers: { ...headers, 'Content-Type': 'application/zip', 'Content-Length': 100000000 },
          },
          done,
        );
        call.on('error', failed);
        call.flushHeaders(); // and not a byte of the body
      });
      answer.destroy();
      assert.equal(answer.statusCode, status, kind);
    }
    assert.equal((await ask('admin', '/api/v1/plans')).text, before.text);
  });

  test('a question about a plan sees the scene of no room that the caller does not see', async () => {
    const at = (room) => `/api/v1/plans/${plans.granted}/fits?room=${room}`;
    const closed = await ask('presenter', at(rooms.own.planner)); // a room of somebody else, on a plan that is granted
    const absent = await ask('presenter', at('zzzz-zzzz'));
    assert.equal(closed.status, 404);
    assert.equal(closed.text.replaceAll(rooms.own.planner, 'ID'), absent.text.replaceAll('zzzz-zzzz', 'ID'));
    assert.equal((await ask('presenter', at(rooms.own.presenter))).status, 200);
  });

  test('a wall is told the values at the crosshair of its room, and at no other place', async () => {
    const scene = await until(
      () => ask('wall', `/api/v1/rooms/${rooms.own.wall}/scene`), // there once the plan is loaded
      ({ status }) => status === 200,
    );
    const { slices } = scene.json.image;
    const [x, y, z] = ['sagittal', 'coronal', 'axial'].map((axis) => slices[axis].position_mm);
    const at = (question, parameters, plan = plans.granted) =>
      `/api/v1/plans/${plan}/${question}?${new URLSearchParams({ room: rooms.own.wall, x, y, z, ...parameters })}`;
    const said = async (kind, path) => saidBy(await ask(kind, path));
    for (const question of ['probe', 'dose/probe']) {
      assert.equal(await said('wall', at(question, {})), 'allowed', question);
      for (const other of [
        { x: x + 0.01 },
        { y: y - 1 },
        { z: z + 1e-3 },
        { z: 'x' },
        { room: rooms.granted },
        { room: rooms.own.guest },
        { room: '' },
      ])
        assert.equal(await said('wall', at(question, other)), 'signed-out', `${question} ${JSON.stringify(other)}`);
      assert.equal(await said('wall', at(question, {}, plans.foreign)), 'signed-out', question);
      assert.equal(await said('observer', at(question, { room: rooms.granted })), 'forbidden', question);
      assert.equal(await said('nobody', at(question, {})), 'signed-out', question);
    }
    for (const question of ['dvh', 'constraints', 'coverage', 'irradiation', 'pick'])
      assert.equal(await said('wall', at(question, {})), 'signed-out', question);
    // what the view says of the scene does not count
    const view = JSON.stringify({ override: { dose: { quantity: 'no such quantity' } } });
    assert.equal((await ask('planner', at('dose/probe', { view, room: rooms.own.planner }))).status, 422);
    assert.notEqual((await ask('wall', at('dose/probe', { view }))).status, 422);
    // nor another place named beside the crosshair, whichever of the two is read
    for (const twice of [`&x=${x + 5}`, `&room=${rooms.own.guest}`])
      for (const path of [`${at('probe', {})}${twice}`, at('probe', {}).replace('?', `?${twice.slice(1)}&`)]) {
        const { json } = await ask('wall', path);
        assert.ok(!json.point_lps_mm || Math.abs(json.point_lps_mm[0] - x) < 1e-6, path);
      }
    for (const question of ['probe', 'dose/probe']) assert.doesNotMatch((await ask('wall', at(question, {}))).text, /smith/i);
  });

  test('a wall whose link has ended is told nothing more', async () => {
    const room = rooms.own.wall;
    const link = await made('planner', `/api/v1/rooms/${room}/links`, { role: 'wall', guests: true });
    const client = await Client.enter(daemon.url, room, { link: link.token, name: 'Wall' });
    callers.ended = { headers: client.headers };
    const { slices } = (await ask('ended', `/api/v1/rooms/${room}/scene`)).json.image;
    const [x, y, z] = ['sagittal', 'coronal', 'axial'].map((axis) => slices[axis].position_mm);
    const paths = ['probe', 'dose/probe'].map(
      (question) => `/api/v1/plans/${plans.granted}/${question}?${new URLSearchParams({ room, x, y, z })}`,
    );
    for (const path of paths) assert.equal((await ask('ended', path)).status, 200, path);
    const ended = await ask('planner', `/api/v1/rooms/${room}/links/${link.id}?members=remove`, 'DELETE');
    assert.ok(ended.status < 300, ended.text);
    await client.message('bye');
    for (const path of paths) assert.equal(saidBy(await ask('ended', path)), 'signed-out', path);
    client.cut();
  });

  test('a guest takes no surface away as a file, of the plan whose pictures it sees', async () => {
    const [{ id: region }] = (await ask('planner', `/api/v1/plans/${plans.granted}`)).json.regions;
    const at = `/api/v1/plans/${plans.granted}/regions/${region}/surface?format=stl`;
    const refused = await ask('guest', at);
    assert.deepEqual([refused.status, refused.json?.code], [403, 'role']);
    assert.notEqual((await ask('planner', at)).status, 403);
  });

  const film = { seconds: 1, fps: 2, view: { kind: '3d', size_px: [240, 240] } };
  const filmOf = async (kind, at, order = film) => (await made(kind, `${at}/video`, order)).id;
  async function madeFilm(kind, at) {
    const path = `/api/v1/jobs/${await filmOf(kind, at)}`;
    const job = await until(
      async () => (await ask(kind, path)).json,
      ({ state }) => !['queued', 'running'].includes(state),
    );
    assert.equal(job.state, 'done', JSON.stringify(job));
    return path;
  }

  test('a film is its maker’s alone, with its job; one person has two that are not made yet', async () => {
    const plan = `/api/v1/plans/${plans.granted}`;
    assert.equal(saidBy(await ask('planner', `${plan}/video`, 'POST', { ...film, identity: true })), 'forbidden', 'nor with a name');
    const path = await madeFilm('planner', plan);
    for (const kind of ['planner', 'token read']) assert.equal((await ask(kind, `${path}/video`)).headers['content-type'], 'video/webm');
    const long = { ...film, seconds: 60, fps: 30 };
    const jobs = [await filmOf('planner', plan, long), await filmOf('planner', plan, long)];
    const third = await ask('token plan', `${plan}/video`, 'POST', long); // of one person
    assert.deepEqual([third.status, third.json.type], [429, '/problems/limit']);
    const others = await filmOf('presenter', plan, long);
    for (const job of [path, ...jobs.map((id) => `/api/v1/jobs/${id}`)])
      for (const [method, at] of [
        ['GET', job],
        ['GET', `${job}/video`],
        ['DELETE', job],
      ])
        for (const kind of ['presenter', 'reviewer', 'guest', 'nobody'])
          assert.equal(saidBy(await ask(kind, at, method)), isSignedIn(kind) ? 'absent' : 'signed-out', `${kind}: ${method} ${at}`);
    const cancelled = async (kind, id) => assert.equal((await ask(kind, `/api/v1/jobs/${id}`, 'DELETE')).json.state, 'cancelled');
    await cancelled('planner', jobs[0]);
    jobs[0] = await filmOf('planner', plan, long); // the place is free again
    for (const id of jobs) await cancelled('planner', id);
    await cancelled('presenter', others);
  });

  test('whoever may not order a film any more does not get the one that was made, and each copy is an export', async () => {
    const { id } = await made('admin', '/api/v1/rooms', { plan: plans.foreign });
    const room = `/api/v1/rooms/${id}`;
    const { token } = await made('admin', `${room}/links`, { role: 'reviewer' });
    const seat = await enter('presenter', id, { link: token }); // on the plan itself they have no right
    seats.push(seat);
    const { member, secret } = await seat.message('welcome');
    seat.headers = { 'Beamroom-Member': `${member} ${secret}` };
    callers.seated = { ...callers.presenter, headers: { ...callers.presenter.headers, ...seat.headers } };
    const path = `${await madeFilm('seated', room)}/video`;
    assert.equal(saidBy(await ask('presenter', path)), 'absent', 'without the seat');
    const exports = async () => (await ask('admin', '/api/v1/audit?action=export')).json.rows.filter(({ user }) => user === 'presenter');
    const before = (await exports()).length;
    const got = await ask('seated', path);
    assert.deepEqual([got.status, got.headers['content-type']], [200, 'video/webm']);
    assert.match(got.headers['content-disposition'], new RegExp(`filename="${plans.foreign}-turn-\\d{8}T\\d{6}Z\\.webm"`));
    const { length } = got.text;
    const rows = await until(exports, (all) => all.length > before);
    const row = rows.find(({ detail }) => detail.media_type === 'video/webm');
    assert.deepEqual([row.detail.what, row.detail.bytes, row.result], ['film', length, 'done']);
    assert.ok((await ask('admin', `${room}/members/${member}`, 'DELETE')).status < 300);
    assert.equal(saidBy(await ask('seated', path)), 'absent');
  });

  test('one person takes at most half of the displays of a room', async () => {
    const streams = [];
    const open = (kind) =>
      new Promise((done, failed) => {
        const { headers } = callers[kind];
        const path = `/api/v1/rooms/${rooms.granted}/stream`;
        const call = request({ socketPath, path, agent: false, headers }, (answer) => done(answer));
        call.on('error', failed);
        call.end();
        streams.push(call);
      });
    for (let i = 0; i < 4; i++) assert.equal((await open('planner')).statusCode, 200);
    const fifth = await open('planner');
    assert.deepEqual([fifth.statusCode, Number(fifth.headers['retry-after']) > 0], [429, true]);
    assert.equal((await open('presenter')).statusCode, 200);
    for (const call of streams) call.destroy();
  });

  test('records before one that may not be seen are those before one that is not there', async () => {
    const decided = async (plan) => {
      const room = await made('admin', '/api/v1/rooms', { plan });
      const client = await enter('admin', room.id);
      await client.message('welcome');
      await until(
        () => ask('admin', `/api/v1/plans/${plan}/revision`),
        ({ status }) => status === 200,
      );
      client.send({ type: 'item.put', kind: 'decision', body: { decision: 'accept', text: 'As shown' }, input: 1 });
      const { item } = await client.message('item', (m) => m.input === 1);
      client.cut();
      return item.id;
    };
    const own = await decided(plans.granted);
    const foreign = await decided(plans.foreign);
    const newest = await decided(plans.granted);
    const before = async (kind, id) => {
      const { status, json } = await ask(kind, `/api/v1/records?before=${id}`);
      return [status, json.records.map((record) => record.id)];
    };
    assert.deepEqual(await before('admin', newest), [200, [foreign, own]]);
    assert.deepEqual(await before('planner', newest), [200, [own]]);
    assert.deepEqual(await before('admin', foreign), [200, [own]]);
    assert.deepEqual(await before('planner', 'i-0000000000'), [200, []]);
    assert.deepEqual(await before('planner', foreign), [200, []]);
    const found = async (kind, body) => {
      const { status, json } = await ask(kind, '/api/v1/records/search', 'POST', body);
      return [status, json.records.map((record) => record.id), json.more];
    };
    assert.deepEqual(await found('admin', { limit: 2 }), [200, [newest, foreign], true]);
    assert.deepEqual(await found('planner', { limit: 2 }), [200, [newest, own], false]);
    assert.deepEqual(await found('planner', { before: foreign }), [200, [], false]);
    assert.deepEqual(await found('planner', { text: plans.foreign }), [200, [], false]);
  });

  test('a search finds what may be seen, and counts no other', async () => {
    const found = async (kind, body) => (await ask(kind, '/api/v1/plans/search', 'POST', body)).json;
    assert.equal((await found('planner', {})).total, 1);
    assert.equal((await found('planner', { text: plans.foreign })).total, 0);
    assert.equal((await found('admin', { text: 'smith' })).total, 0); // the folder's name is no name
    const first = await found('admin', { text: 'SNYDER', limit: 1 });
    assert.deepEqual([first.total, first.plans.length], [2, 1]);
    const next = await found('admin', { text: 'snyder', limit: 1, cursor: first.next });
    assert.deepEqual([next.total, next.plans.length, next.next], [2, 1, null]);
    assert.notEqual(next.plans[0].id, first.plans[0].id);
  });

  test('folders of one name are told apart by who sees both; who sees one is not told that there is another', async () => {
    const found = async (kind, body = {}) => (await ask(kind, '/api/v1/plans/search', 'POST', body)).json;
    const [granted, foreign] = ['granted', 'foreign'].map((which) => idOf(join(folder, which, 'plans')));
    const { folders } = await found('admin');
    assert.deepEqual(
      [...folders].sort((a, b) => (a.name < b.name ? -1 : 1)),
      [
        { id: foreign, name: 'foreign/plans', n: 1 },
        { id: granted, name: 'granted/plans', n: 1 },
      ],
    );
    assert.deepEqual((await found('planner')).folders, [{ id: granted, name: 'plans', n: 1 }]);
    const ids = async (kind, of) => (await found(kind, { folder: of })).plans.map(({ id }) => id);
    for (const of of [foreign, 'foreign/plans']) {
      assert.deepEqual(await ids('admin', of), [plans.foreign]);
      assert.deepEqual(await ids('planner', of), []);
    }
    assert.deepEqual((await ids('admin', 'plans')).sort(), [plans.foreign, plans.granted].sort(), 'a name that both have');
    assert.deepEqual(await ids('admin', 'lans'), [], 'a part of a name is none');
  });

  test('rooms are made on plans by who may work with them', async () => {
    const status = async (kind, plan) => (await ask(kind, '/api/v1/rooms', 'POST', { plan })).status;
    assert.equal(await status('observer', plans.granted), 403);
    assert.equal(await status('token read', plans.granted), 403);
    assert.equal(await status('planner', plans.foreign), 404);
    assert.equal(await status('token plan', plans.granted), 201);
    assert.equal(await status('guest', plans.granted), 401);
  });
});
