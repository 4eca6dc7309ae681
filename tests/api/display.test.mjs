// Displays: screens that are sent a shared view as a stream of pictures, through the real daemon and renderer.
import { after, before, describe, it } from 'node:test';
import assert from 'node:assert/strict';
import { connect } from 'node:net';
import { call, openPlan, renderersOf, startDaemon, until } from './daemon.mjs';
import { Client } from './ws_client.mjs';

/** A screen over a plain socket, which can stop reading. Reads parts by what the stream's description says, and chunks by RFC 9112. */
class Screen {
  #socket;
  #raw = Buffer.alloc(0);
  #body = Buffer.alloc(0);
  head = '';
  parts = [];
  isEnded = false;
  isClosed = false;

  static async open(url, path, { method = 'GET', headers = '' } = {}) {
    const screen = new Screen();
    const { hostname, port, host } = new URL(url);
    screen.#socket = connect({ host: hostname, port: Number(port) });
    screen.#socket.on('error', () => {});
    screen.#socket.on('data', (bytes) => screen.#take(bytes));
    screen.#socket.on('close', () => {
      screen.isClosed = true;
    });
    screen.#socket.write(`${method} ${path} HTTP/1.1\r\nHost: ${host}\r\n${headers}\r\n`);
    await until(() => screen.head || screen.isClosed, Boolean);
    return screen;
  }

  #take(bytes) {
    this.#raw = Buffer.concat([this.#raw, bytes]);
    if (!this.head) {
      const end = this.#raw.indexOf('\r\n\r\n');
      if (end < 0) return;
      this.head = this.#raw.subarray(0, end).toString('latin1');
      this.#raw = this.#raw.subarray(end + 4);
    }
    for (;;) {
      const line = this.#raw.indexOf('\r\n');
      const size = line < 0 ? NaN : parseInt(this.#raw.subarray(0, line).toString('latin1'), 16);
      if (line < 0 || this.#raw.length < line + 2 + size + 2) break;
      if (size === 0) this.isEnded = true;
      this.#body = Buffer.concat([this.#body, this.#raw.subarray(line + 2, line + 2 + size)]);
      this.#raw = this.#raw.subarray(line + 2 + size + 2);
    }
    while (this.#part());
  }

  #part() {
    const opening = '--beamroom\r\n',
      start = this.#body.indexOf(opening) === 0 ? opening.length : -1;
    const end = this.#body.indexOf('\r\n\r\n');
    if (start < 0 || end < 0) return false;
    const fields = Object.fromEntries(
      this.#body
        .subarray(start, end)
        .toString('latin1')
        .split('\r\n')
        .map((line) => line.split(/: /)),
    );
    const n = Number(fields['Content-Length']);
    if (this.#body.length < end + 4 + n + 2 + opening.length) return false;
    assert.equal(
      this.#body.subarray(end + 4 + n, end + 4 + n + 2 + opening.length).toString('latin1'),
      `\r\n${opening}`,
      'the boundary stands behind each part',
    );
    this.parts.push({
      fields,
      number: Number(fields['Beamroom-Picture']),
      revision: Number(fields['Beamroom-Revision']),
      picture: Buffer.from(this.#body.subarray(end + 4, end + 4 + n)),
    });
    this.#body = this.#body.subarray(end + 4 + n + 2);
    return true;
  }

  get status() {
    return Number(/^HTTP\/1\.1 (\d+)/.exec(this.head)?.[1] ?? 0);
  }
  pictures() {
    return this.parts.filter(({ number }, index) => index === 0 || number !== this.parts[index - 1].number);
  }
  part(suits = () => true, from = 0) {
    return until(() => this.parts.slice(from).find(suits), Boolean);
  }
  pause() {
    this.#socket.pause();
  }
  resume() {
    this.#socket.resume();
  }
  close() {
    this.#socket.destroy();
  }
}

describe('displays', () => {
  let daemon;
  const screens = [],
    clients = [];
  before(async () => {
    daemon = await startDaemon();
    assert.equal((await openPlan(daemon.url, 'phantom')).state, 'done');
  });
  after(async () => {
    for (const screen of screens) screen.close();
    for (const client of clients) client.cut();
    await daemon.stop();
  });

  const newRoom = async () => (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id;
  const watch = async (room, query = '', options = {}) => {
    const screen = await Screen.open(daemon.url, `/api/v1/rooms/${room}/stream${query}`, options);
    screens.push(screen);
    return screen;
  };
  const enter = async (room, document = { kind: '3d', size_px: [320, 240] }, follow = true) => {
    const client = await Client.enter(daemon.url, room, { name: 'member' });
    clients.push(client);
    if (document) client.send({ type: 'view.open', view: 1, follow, input: 1, document });
    return client;
  };
  const still = (client, input) => client.frame(({ isStill, input: shown }) => isStill && shown >= input);
  const turn = (client, input, x) =>
    client.send({
      type: 'view.patch',
      view: 1,
      input,
      patch: { camera: { position_mm: [x, -600, 50], target_mm: [0, 0, 0], up: [0, 0, 1] } },
    });
  const metric = async (name) => Number(new RegExp(`^${name} (\\d+)`, 'm').exec((await call(`${daemon.url}/metrics`)).text)[1]);
  const leave = async (...gone) => {
    for (const one of gone) (one.cut ?? one.close).call(one);
  };

  it('sends the very bytes that followers are sent, and requests nothing beside them', async () => {
    const room = await newRoom(),
      presenter = await enter(room);
    await still(presenter, 1);
    const follower = await enter(room),
      screen = await watch(room);
    assert.equal(screen.status, 200);
    assert.match(screen.head, /content-type: multipart\/x-mixed-replace; boundary=beamroom/i);
    assert.match(screen.head, /beamroom-view: 3d/i);
    const before = await metric('beamroom_renders_total');
    for (let input = 2; input < 8; input++) {
      turn(presenter, input, 40 * input);
      await still(presenter, input);
    }
    const last = presenter.frames.at(-1);
    const part = await screen.part(({ picture }) => picture.equals(last.picture));
    const requested = (await metric('beamroom_renders_total')) - before;
    assert.ok(requested <= 12, `${requested} pictures for 6 changes: a moving one and a still at most`);
    for (const { picture } of screen.pictures())
      assert.ok(
        presenter.frames.some((frame) => frame.picture.equals(picture)),
        'every part is a frame of the presenter',
      );
    assert.equal(part.fields['Beamroom-Size'], '320x240');
    assert.equal(part.fields['Content-Type'], 'image/jpeg');
    const matrix = part.fields['Beamroom-Clip-From-Lps'].split(' ').map(Number);
    assert.deepEqual(matrix.map(Math.fround), last.matrix);
    await leave(presenter, follower, screen);
  });

  it('sends the same picture again while nothing changes', async () => {
    const room = await newRoom(),
      screen = await watch(room);
    await screen.part(({ number }) => number >= 1);
    const again = await until(
      () => screen.parts.filter(({ number }, index) => index > 0 && number === screen.parts[index - 1].number),
      ({ length }) => length > 0,
    );
    assert.ok(
      screen.parts.some(
        ({ number, picture }, index) =>
          index > 0 &&
          again.includes(screen.parts[index]) &&
          number === screen.parts[index - 1].number &&
          picture.equals(screen.parts[index - 1].picture),
      ),
    );
    await leave(screen);
  });

  it('draws at the pace of its screen where nobody else looks', async () => {
    const room = await newRoom(),
      screen = await watch(room, '?view=axial');
    await screen.part();
    const scene = await call(`${daemon.url}/api/v1/rooms/${room}/scene`);
    const patched = await call(
      `${daemon.url}/api/v1/rooms/${room}/scene`,
      'PATCH',
      { image: { window: { center: 100, width: 300 } } },
      { 'If-Match': scene.headers.get('etag') },
    );
    assert.equal(patched.status, 200);
    const revision = Number(patched.headers.get('etag').slice(1, -1));
    const part = await screen.part((one) => one.revision >= revision);
    assert.ok(!part.picture.equals(screen.parts[0].picture));
    await leave(screen);
  });

  it('lets the first member decide where nobody has shown the view', async () => {
    const room = await newRoom(),
      screen = await watch(room);
    await screen.part();
    const presenter = await enter(room, {
      kind: '3d',
      size_px: [200, 160],
      camera: { position_mm: [0, -700, 0], target_mm: [0, 0, 0], up: [0, 0, 1] },
    });
    const view = await presenter.message('view');
    assert.deepEqual(view.document.camera.position_mm, [0, -700, 0]);
    assert.deepEqual(view.document.size_px, [200, 160]);
    await still(presenter, 1);
    await screen.part((one) => one.fields['Beamroom-Size'] === '200x160' && one.picture.equals(presenter.frames.at(-1).picture));
    await leave(presenter, screen);
  });

  it('costs the others nothing when it stops reading, and skips pictures', async () => {
    const room = await newRoom(),
      presenter = await enter(room, { kind: '3d', size_px: [900, 700] });
    await still(presenter, 1);
    const screen = await watch(room),
      other = await watch(room);
    await Promise.all([screen.part(), other.part()]);
    screen.pause();
    const shown = presenter.frames.length;
    let input = 2; // a socket that nobody reads takes a few hundred kilobytes at first
    for (; presenter.frames.slice(shown).reduce((sum, { picture }) => sum + picture.length, 0) < 0.6e6; input++) {
      turn(presenter, input, (input % 40) * 15);
      await presenter.frame(({ input: of }) => of >= input);
    }
    await still(presenter, input - 1);
    const last = presenter.frames.at(-1);
    await other.part(({ picture }) => picture.equals(last.picture));
    screen.resume();
    await screen.part(({ picture }) => picture.equals(last.picture));
    const sent = presenter.frames.length - shown,
      got = screen.pictures().length;
    assert.ok(got < sent, `${got} pictures of ${sent}`);
    assert.ok(screen.parts.at(-1).number === got, 'what it skipped was never begun');
    await leave(presenter, screen, other);
  });

  it('refuses a ninth, until one is gone', async () => {
    const room = await newRoom();
    const eight = await Promise.all(Array.from({ length: 8 }, () => watch(room)));
    assert.deepEqual(
      eight.map(({ status }) => status),
      Array(8).fill(200),
    );
    const ninth = await call(`${daemon.url}/api/v1/rooms/${room}/stream`);
    assert.equal(ninth.status, 429);
    assert.equal(ninth.json.type, '/problems/limit');
    eight[3].close();
    const next = await until(
      () => watch(room),
      ({ status }) => status === 200,
    );
    await next.part();
    await leave(...eight, next);
  });

  it('ends with its room', async () => {
    const room = await newRoom(),
      screen = await watch(room);
    await screen.part();
    assert.equal((await call(`${daemon.url}/api/v1/rooms/${room}`, 'DELETE')).status, 204);
    await until(() => screen.isEnded || screen.isClosed, Boolean);
    assert.ok(screen.isEnded, 'the answer is finished, not cut');
    const gone = await call(`${daemon.url}/api/v1/rooms/${room}/stream`);
    assert.equal(gone.status, 404);
  });

  it('says what is wrong with a request', async () => {
    const room = await newRoom();
    const bad = await call(`${daemon.url}/api/v1/rooms/${room}/stream?view=top`);
    assert.equal(bad.status, 422);
    assert.equal(bad.json.pointer, '/view');
    assert.equal((await call(`${daemon.url}/api/v1/rooms/${room}/stream?view=oblique`)).status, 404);
    const stranger = await call(`${daemon.url}/api/v1/rooms/${room}/stream`, 'GET', undefined, {
      'Beamroom-Member': 'member-9 0123456789abcdef0123456789abcdef',
    });
    assert.equal(stranger.status, 403);
    const head = await Screen.open(daemon.url, `/api/v1/rooms/${room}/stream`, { method: 'HEAD' });
    assert.equal(head.status, 200);
    head.close();
  });

  it('goes on when the renderer has crashed', async () => {
    const room = await newRoom(),
      presenter = await enter(room),
      screen = await watch(room);
    await still(presenter, 1);
    const shown = await screen.part();
    process.kill(renderersOf(daemon.child.pid)[0], 'SIGKILL');
    await presenter.message('renderer', ({ state }) => state === 'restarting');
    turn(presenter, 2, 300);
    await still(presenter, 2);
    await screen.part(({ picture }) => !picture.equals(shown.picture) && picture.equals(presenter.frames.at(-1).picture));
    await leave(presenter, screen);
  });

  it('neither wakes a room that sleeps nor keeps one awake', async () => {
    const other = await startDaemon({ args: ['--room-idle-close', '1'] });
    try {
      assert.equal((await openPlan(other.url, 'phantom')).state, 'done');
      const room = (await call(`${other.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id;
      const member = await Client.open(other.url, `/api/v1/rooms/${room}/ws`);
      member.send({ type: 'hello', protocol: 2, name: 'member' });
      await member.message('welcome');
      await member.ready(); // before that the scene cannot be changed
      // a room in which nobody changed anything leaves no trace
      const patched = await call(
        `${other.url}/api/v1/rooms/${room}/scene`,
        'PATCH',
        { image: { slices: { axial: { position_mm: 3 } } }, axes: { visible: true } },
        { 'If-Match': '*' },
      );
      assert.equal(patched.status, 200, patched.text);
      const screen = await Screen.open(other.url, `/api/v1/rooms/${room}/stream`);
      await screen.part();
      member.cut();
      await until(() => screen.isEnded || screen.isClosed, Boolean);
      const asleep = await call(`${other.url}/api/v1/rooms/${room}/stream`);
      assert.equal(asleep.status, 503);
      assert.match(asleep.json.detail, /sleeps/);
      const {
        json: { rooms },
      } = await call(`${other.url}/api/v1/rooms`);
      assert.equal(rooms.find(({ id }) => id === room).asleep, true);
    } finally {
      await other.stop();
    }
  });
});
