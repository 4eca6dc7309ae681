// Checks that every proxy has to pass in front of the daemon, each with its sample configuration. One file of tests for each program calls `proves`.
import assert from 'node:assert/strict';
import { createReadStream, existsSync, statSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import { demo, sleep, until } from '../api/daemon.mjs';
import { Client } from '../api/ws_client.mjs';
import { full, missing, shoot } from '../web/browser.mjs';
import { proxies } from './proxies.mjs';
import { canary, canaryAddress, h2Shapes, sendH2Shapes, sendShapes, shapes } from './smuggling.mjs';
import { provesFreshSignIn, provesSignIn } from './sign_in.mjs';
import { Site } from './site.mjs';
import { auditOf, bigArchive, Caller, CLIENT, NAME, openSecurely, peakMib } from './world.mjs';

const megabytes = 200;
const NOTE = { body: { text: 'one' }, name: 'Script' };

/** Sends a request on a connection that stays, and waits for the whole answer of JSON with a length, or chunked. */
const askOn = (socket, world, path) =>
  new Promise((done, failed) => {
    let text = '';
    const late = setTimeout(() => failed(new Error(`no answer to ${path}: ${text}`)), 20000);
    const take = (bytes) => {
      text += bytes.toString('latin1');
      const [head, body] = text.split('\r\n\r\n', 2);
      const length = Number(/content-length: (\d+)/i.exec(head)?.[1] ?? -1);
      if (body === undefined || (length >= 0 ? body.length < length : !text.endsWith('0\r\n\r\n'))) return;
      clearTimeout(late);
      socket.off('data', take);
      done(Number(text.slice(9, 12)));
    };
    socket.on('data', take);
    const cookie = world.caller.cookie && `Cookie: ${world.caller.cookie}\r\n`;
    socket.write(`GET ${path} HTTP/1.1\r\nHost: ${world.host}\r\n${cookie}\r\n`);
  });

/** Enters a room through the proxy and waits for a picture. @param {number} before requests on the same connection before the handshake */
async function enterThrough(world, room, before) {
  const socket = await openSecurely(world.port, { ALPNProtocols: ['http/1.1'] });
  for (let n = 0; n < before; n++) assert.equal(await askOn(socket, world, '/api/v1/version'), 200);
  const headers = { Host: world.host, Origin: `https://${world.host}`, ...(world.caller.cookie && { Cookie: world.caller.cookie }) };
  const client = await Client.open(`https://${world.host}`, `/api/v1/rooms/${room}/ws`, headers, socket);
  if (client.status !== 101) return client;
  client.send({ type: 'hello', protocol: 2, name: 'Ann' });
  client.send({ type: 'view.open', view: 1, document: { kind: 'axial', size_px: [64, 48] } });
  await client.frame();
  return client;
}

/** Where a proxy keeps connections to the daemon, an answer that belongs to another request would show here. */
async function answersBelong(world) {
  const caller = new Caller(world.port);
  caller.cookies = world.caller.cookies;
  const kinds = { '/api/v1/version': /"version"/, '/healthz': /^ok/, '/api/v1/plans': /"plans"/, '/nothing-here': /not-found|<title>/ };
  for (let n = 0; n < 10; n++)
    for (const [path, expected] of Object.entries(kinds)) {
      const { status, text } = await caller.call(path);
      assert.equal(status, path === '/nothing-here' ? 404 : 200, path);
      assert.match(text, expected, path);
    }
  caller.end();
}

/** @param {string} name of `proxies` */
export function proves(name) {
  const { needs, signsIn, speaksH2, cutsByReload } = proxies[name];
  const absent = missing ?? (existsSync(needs) ? undefined : needs);
  describe(name, { skip: absent && `${absent} is not there` }, () => {
    const world = new Site();
    before(async () => {
      try {
        await world.start(name);
      } catch (error) {
        await world.stop(); // what runs still would keep this file from its end
        throw error;
      }
    });
    after(async () => {
      if (!world.daemon) return;
      const { exitCode, signalCode } = world.daemon.child;
      await world.stop();
      assert.deepEqual([exitCode, signalCode], [null, null], `the daemon ended before its time: ${world.daemon.log().slice(-2000)}`);
    });

    provesSignIn(world);
    if (signsIn === 'oidc') provesFreshSignIn(world);

    it('the page comes whole, with pictures of a room, at the address that was asked for', async () => {
      const { page, errors } = await world.visit(`/rooms/${world.room}`);
      await full(page);
      await shoot(page, `deploy-${name.replace(/\W+/g, '-')}`);
      assert.match(await page.evaluate(() => globalThis.location.href), new RegExp(`^https://${world.host}/rooms/${world.room}`));
      assert.deepEqual(errors, []);
      await page.close();
    });

    it('100 of 100 WebSockets open and get a picture, most of them behind other requests on the same connection', async () => {
      let pictures = 0;
      for (let n = 0; n < 100; n += 10) {
        const room = n % 20 ? world.room : await world.newRoom();
        const some = await Promise.all(Array.from({ length: 10 }, (_, i) => enterThrough(world, room, i % 4)));
        pictures += some.filter((client) => client.status === 101 && client.frames.length).length;
        for (const client of some) client.cut();
      }
      assert.equal(pictures, 100);
    });

    it(`an upload of ${megabytes} MB becomes a plan, and is held by nobody in memory`, async () => {
      const file = bigArchive(world.home, join(demo, 'phantom'), megabytes);
      const [daemonBefore, proxyBefore] = [peakMib(world.daemon.child.pid), peakMib(world.proxy.child.pid)];
      const begun = Date.now();
      const { status, json, text } = await world.caller.call('/api/v1/plans?name=big', {
        method: 'POST',
        headers: { 'Content-Type': 'application/zip', 'Content-Length': statSync(file).size, Origin: `https://${world.host}` },
        stream: createReadStream(file),
      });
      const seconds = (Date.now() - begun) / 1000;
      assert.equal(status, 202, text);
      const job = await world.jobEnds(json);
      assert.equal(job.state, 'done', JSON.stringify(job));
      const grown = [peakMib(world.daemon.child.pid) - daemonBefore, peakMib(world.proxy.child.pid) - proxyBefore];
      assert.ok(seconds < 120, `${seconds} s`);
      // the renderer that scans the new plan counts among the daemon's; the archive would be 200 more
      assert.ok(grown[1] < 100, `the proxy grew by ${grown[1]} MiB`);
      assert.equal((await world.caller.call(`/api/v1/plans/${job.plan ?? 'big'}`)).status, 200);
    });

    it("the client's own address is what the daemon knows, whatever the client says", async () => {
      const seen = auditOf(world.daemon.data).length;
      const claims = [
        {},
        { 'X-Forwarded-For': '203.0.113.250' },
        { Forwarded: 'for=203.0.113.251', 'X-Real-IP': '203.0.113.252' },
        { Connection: 'close, X-Forwarded-For' },
      ];
      for (const headers of claims) {
        const made = await world.caller.call(`/api/v1/rooms/${world.room}/notes`, {
          method: 'POST',
          body: NOTE,
          headers,
        });
        assert.equal(made.status, 201, made.text);
      }
      const rows = await until(
        () => auditOf(world.daemon.data).slice(seen),
        (list) => list.filter(({ address }) => address).length >= claims.length,
      );
      assert.deepEqual([...new Set(rows.map(({ address }) => address))], [CLIENT]);
    });

    it('nobody says by a header who they are', async () => {
      const [first, ...more] = ['User', 'Name', 'Groups', 'Auth-Time'].map((word) => `X-Beamroom-${word}`);
      const direct = await fetch(`${world.daemon.url}/api/v1/version`, { headers: { [first]: 'ann' } });
      assert.equal(direct.status, 400);
      for (const header of [first, first.toLowerCase(), ...more])
        assert.equal((await world.caller.call('/api/v1/version', { headers: { [header]: 'ann' } })).status, 200, header);
      // another spelling of the same header, which some programs take for the same, is nobody's either
      const spelt = await world.caller.call('/api/v1/version', { headers: { X_Beamroom_User: 'ann' } });
      assert.ok([200, 400].includes(spelt.status), `${spelt.status}`);
    });

    it('the name with its port is the origin; a page of another site changes nothing', async () => {
      const post = (origin) =>
        world.caller.call(`/api/v1/rooms/${world.room}/notes`, {
          method: 'POST',
          body: NOTE,
          headers: { Origin: origin },
        });
      assert.equal((await post(`https://${world.host}`)).status, 201);
      for (const origin of ['https://evil.example', `https://${NAME}.evil.example`, 'null'])
        assert.equal((await post(origin)).status, 403, origin);
    });

    it('a slow client is answered, and one with too large a head is told so', async () => {
      const socket = await openSecurely(world.port, { ALPNProtocols: ['http/1.1'] });
      let text = '';
      socket.on('data', (bytes) => {
        text += bytes.toString('latin1');
      });
      const cookie = world.caller.cookie && `Cookie: ${world.caller.cookie}\r\n`;
      const request = `GET /api/v1/version HTTP/1.1\r\nHost: ${world.host}\r\n${cookie}\r\n`;
      for (let at = 0, step = Math.ceil(request.length / 20); at < request.length; at += step) {
        socket.write(request.slice(at, at + step));
        await sleep(100);
      }
      await until(
        () => text,
        (all) => /^HTTP\/1\.1 200 /.test(all),
        10000,
      );
      socket.destroy();
      assert.equal((await world.caller.call('/api/v1/version', { headers: { 'X-Long': 'a'.repeat(6000) } })).status, 200);
      const large = await world.caller.call('/api/v1/version', { headers: { 'X-Long': 'a'.repeat(60000) } });
      // 502: the proxy was still sending when the daemon had said 431 and closed
      assert.ok([400, 413, 414, 431, 502].includes(large.status), `${large.status}`);
      assert.equal((await world.caller.call('/api/v1/version')).status, 200);
    });

    const tryShapes = async (send, n) => {
      const room = await world.newRoom();
      const seen = auditOf(world.daemon.data).length;
      const where = { port: world.port, host: world.host, room, cookie: world.caller.cookie, signsIn };
      const results = await send(where);
      assert.equal(results.length, n);
      await answersBelong(world);
      await sleep(300); // rows are written by another thread
      const foreign = auditOf(world.daemon.data)
        .slice(seen)
        .filter(({ address }) => address !== CLIENT);
      const through = foreign.map(({ address }) => results.find((one) => canaryAddress(one.n) === address)?.name ?? `as from ${address}`);
      assert.deepEqual(through, []);
    };
    it('the hidden requests of HTTP/1.1 stay what the proxy took them for', () => tryShapes(sendShapes, Object.keys(shapes).length));
    if (speaksH2)
      it('the hidden requests of HTTP/2 stay what the proxy took them for', () => tryShapes(sendH2Shapes, Object.keys(h2Shapes).length));
    it('a hidden request that got through would be seen', async () => {
      const room = await world.newRoom();
      await world.sendPast(canary({ host: world.host, room, signsIn, cookie: world.caller.cookie }, 250));
      await until(
        () => auditOf(world.daemon.data),
        (rows) => rows.some(({ address }) => address === canaryAddress(250)),
        10000,
      );
    });

    it('a renewed certificate counts after a reload, and a meeting goes on', async () => {
      const organisation = async () => {
        const socket = await openSecurely(world.port);
        const { O } = socket.getPeerCertificate().subject;
        socket.destroy();
        return O;
      };
      assert.equal(await organisation(), 'first');
      const inside = await enterThrough(world, world.room, 0);
      await world.proxy.reload();
      await until(organisation, (said) => said === 'renewed', 20000);
      await sleep(500);
      assert.equal(inside.closeCode, cutsByReload ? 1001 : 0);
      if (!cutsByReload) {
        const { length } = inside.frames;
        inside.send({ type: 'view.open', view: 2, document: { kind: 'coronal', size_px: [64, 48] } });
        await inside.frame(({ view }) => view === 2, length);
      }
      const later = await enterThrough(world, world.room, 1);
      assert.equal(later.status, 101);
      for (const client of [inside, later]) client.cut();
    });
  });
}
