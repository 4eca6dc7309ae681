// Uploads of plans against the real daemon.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import {
  chmodSync,
  cpSync,
  createReadStream,
  mkdirSync,
  mkdtempSync,
  readFileSync,
  readdirSync,
  rmSync,
  statSync,
  truncateSync,
  writeFileSync,
} from 'node:fs';
import { request } from 'node:http';
import { connect } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { bin, call, demo, openPlan, sleep, startDaemon, until } from './daemon.mjs';
import { readPng } from './png.mjs';
import { Client } from './ws_client.mjs';
import { parseStrict } from './strict_json.mjs';

let home, daemon, api;

before(async () => {
  home = mkdtempSync(join(tmpdir(), 'beamroom-upload-'));
  cpSync(join(demo, readdirSync(demo).includes('plan.json') ? '.' : readdirSync(demo)[0]), join(home, 'head'), { recursive: true });
  execFileSync('python3', ['-c', 'import shutil,sys; shutil.make_archive(sys.argv[1]+"/whole", "zip", sys.argv[1], "head")', home]);
  execFileSync('tar', ['-czf', join(home, 'bare.tar.gz'), '-C', join(home, 'head'), '.']);
  mkdirSync(join(home, 'letters'));
  writeFileSync(join(home, 'letters', 'letter.txt'), 'Dear colleague');
  execFileSync('tar', ['-cf', join(home, 'letters.tar'), '-C', join(home, 'letters'), '.']);
  daemon = await startDaemon();
  api = `${daemon.url}/api/v1`;
});
after(async () => {
  await daemon?.stop();
  rmSync(home, { recursive: true, force: true });
});

const waiting = (where = daemon) => readdirSync(join(where.data, 'uploads'));
const uploaded = (where = daemon) => readdirSync(join(where.data, 'plans'));
/** Waits until no upload is in progress; returns the names of those left after the time limit. */
const settled = (where = daemon) =>
  until(
    () => waiting(where),
    (names) => names.length === 0,
    5000,
  );
const idsOf = async (base = api) => (await call(`${base}/plans`)).json.plans.map((p) => p.id);

/** Sends a file, a buffer or a stream of chunks. */
async function send(base, name, body, { type = 'application/octet-stream', headers = {} } = {}) {
  const bytes = typeof body === 'string' ? readFileSync(body) : body;
  const answer = await fetch(`${base}/plans?name=${encodeURIComponent(name)}`, {
    method: 'POST',
    headers: { 'Content-Type': type, ...headers },
    body: bytes,
    ...(bytes instanceof ReadableStream && { duplex: 'half' }),
  });
  const text = await answer.text();
  return { status: answer.status, headers: answer.headers, text, json: parseStrict(text) };
}

const jobEnd = (base, job) =>
  until(
    async () => (await call(`${base}/jobs/${job.id}`)).json,
    (j) => j.state !== 'running' && j.state !== 'queued',
  );

/** Sends headers and the first bytes of a body over a bare connection; text() is the answer so far. */
function half(url, length, bytes = '', headers = '') {
  const { hostname, port } = new URL(url);
  const socket = connect(Number(port), hostname);
  let text = '';
  socket.on('data', (more) => {
    text += more;
  });
  socket.on('error', () => {});
  socket.write(
    `POST /api/v1/plans?name=half HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/zip\r\nContent-Length: ${length}\r\n${headers}\r\n${bytes}`,
  );
  return { socket, text: () => text };
}

describe('an archive', () => {
  for (const [what, file, type] of [
    ['a zip of a folder', 'whole.zip', 'application/zip'],
    ['a tar.gz of its files', 'bare.tar.gz', 'application/gzip'],
  ])
    test(`${what} becomes a plan that is drawn, and goes again`, async () => {
      const sent = await send(api, `Head (2) ${file}`, join(home, file), { type });
      assert.equal(sent.status, 202, sent.text);
      assert.equal(sent.json.kind, 'upload');
      assert.match(sent.json.id, /^upload-\d+$/);
      assert.equal(sent.headers.get('location'), `/api/v1/jobs/${sent.json.id}`);
      assert.equal(sent.json.plan, null);
      const job = await jobEnd(api, sent.json);
      assert.equal(job.state, 'done', JSON.stringify(job));
      assert.equal(job.percent, 100);
      assert.equal(job.plan, file === 'whole.zip' ? 'head-2-whole' : 'head-2-bare');
      assert.equal((await call(`${api}/plans/${job.plan}`)).json.uploaded, true);
      assert.equal((await call(`${api}/plans`)).json.plans.find((p) => p.id === 'phantom').uploaded, false);
      assert.equal(statSync(join(daemon.data, 'plans', job.plan)).mode & 0o777, 0o700);
      for (const entry of readdirSync(join(daemon.data, 'plans', job.plan), { withFileTypes: true }).filter((e) => e.isFile()))
        assert.equal(statSync(join(daemon.data, 'plans', job.plan, entry.name)).mode & 0o077, 0, entry.name);

      const opened = await openPlan(daemon.url, job.plan);
      assert.equal(opened.state, 'done');
      assert.equal(opened.kind, 'open');
      assert.equal(opened.plan, job.plan);
      const picture = await fetch(`${api}/plans/${job.plan}/render`, {
        method: 'POST',
        headers: { 'Content-Type': 'application/json' },
        body: '{"view":{"size_px":[80,60]}}',
      });
      assert.equal(picture.status, 200);
      const png = readPng(Buffer.from(await picture.arrayBuffer()));
      assert.equal(png.width, 80);
      const room = (await call(`${api}/rooms`, 'POST', { plan: job.plan })).json;
      const client = await Client.open(daemon.url, `/api/v1/rooms/${room.id}/ws`);
      client.send({ type: 'hello', protocol: 2 });
      await client.message('welcome');

      assert.equal((await call(`${api}/plans/${job.plan}`, 'DELETE')).status, 204);
      assert.equal((await call(`${api}/plans/${job.plan}`)).status, 404);
      assert.match((await client.message('bye')).reason, /plan was deleted/);
      assert.equal((await call(`${api}/rooms/${room.id}`)).status, 404);
      assert.ok(!uploaded().includes(job.plan));
      assert.deepEqual(await settled(), []);
      assert.ok(!readdirSync(join(daemon.data, 'cache')).includes(job.plan));
      assert.ok(!(await idsOf()).includes(job.plan));
    });

  test('of the same name twice gives two plans', async () => {
    const first = await send(api, 'twin', join(home, 'whole.zip')),
      second = await send(api, 'twin', join(home, 'whole.zip'));
    const ids = [(await jobEnd(api, first.json)).plan, (await jobEnd(api, second.json)).plan];
    assert.deepEqual([...ids].sort(), ['twin', 'twin-2']);
    for (const id of ids) assert.equal((await call(`${api}/plans/${id}`, 'DELETE')).status, 204);
  });

  test('without a name is called after the day, whatever it holds; its own name is nowhere', async () => {
    const post = async (query) =>
      await (
        await fetch(`${api}/plans${query}`, {
          method: 'POST',
          headers: { 'Content-Type': 'application/zip', 'Content-Disposition': 'attachment; filename="Doe John.zip"' },
          body: readFileSync(join(home, 'whole.zip')),
        })
      ).json();
    const days = [new Date().toISOString().slice(0, 10)];
    const jobs = [];
    for (const query of ['', '?name=', '']) jobs.push(await jobEnd(api, await post(query)));
    days.push(new Date().toISOString().slice(0, 10)); /* the date may have changed at midnight */
    const expected = days.flatMap((day) => ['', '-2', '-3'].map((more) => `upload-${day}${more}`));
    for (const { plan } of jobs) {
      assert.ok(expected.includes(plan), plan);
      assert.equal((await call(`${api}/plans/${plan}`, 'DELETE')).status, 204);
    }
    assert.equal(new Set(jobs.map(({ plan }) => plan)).size, 3);
    assert.doesNotMatch(daemon.log(), /doe/i);
  });

  test('that is no plan fails with the reason and leaves nothing', async () => {
    const before = uploaded();
    const job = await jobEnd(api, (await send(api, 'letters', join(home, 'letters.tar'))).json);
    assert.equal(job.state, 'failed');
    assert.equal(job.problem.type, '/problems/plan-unreadable');
    assert.ok(job.problem.detail.length > 10, job.problem.detail);
    assert.equal(job.plan, null);
    assert.deepEqual(await settled(), []);
    assert.deepEqual(uploaded(), before);
  });

  test('that is none at all fails with the reason and leaves nothing', async () => {
    const job = await jobEnd(api, (await send(api, 'noise', Buffer.from('this is no archive at all'.repeat(50)))).json);
    assert.equal(job.state, 'failed');
    assert.ok(job.problem.detail.length > 10);
    assert.deepEqual(await settled(), []);
  });
});

describe('what is refused', () => {
  let small;
  before(async () => {
    small = await startDaemon({ args: ['--max-upload-mib', '1'] });
  });
  after(() => small?.stop());

  test('a media type that is no archive, and an empty body', async () => {
    const text = await send(api, 'x', Buffer.from('{}'), { type: 'application/json' });
    assert.equal(text.status, 415);
    assert.equal(text.json.type, '/problems/media-type');
    assert.equal((await send(api, 'x', Buffer.alloc(0))).status, 422);
  });

  test('a page of another origin', async () => {
    const { hostname, port } = new URL(daemon.url);
    const status = await new Promise((done) =>
      request(
        {
          hostname,
          port,
          path: '/api/v1/plans',
          method: 'POST',
          headers: { Origin: 'http://evil.example', 'Content-Type': 'application/zip' },
        },
        (answer) => {
          answer.resume();
          done(answer.statusCode);
        },
      ).end('PK'),
    );
    assert.equal(status, 403);
    assert.deepEqual(await settled(), []);
    assert.equal((await call(`${api}/version`)).json.max_upload_bytes, 2048 * 2 ** 20);
  });

  test('more than may be, at once when the sender says how much', async () => {
    const { socket, text } = half(daemon.url, 3 * 2 ** 30, 'PK');
    await until(text, (t) => t.includes('\r\n\r\n'), 3000);
    assert.match(text(), /^HTTP\/1\.1 413 /);
    socket.destroy();
    const polite = half(small.url, 2 ** 20 + 1, '', 'Expect: 100-continue\r\n');
    await until(polite.text, (t) => t.includes('\r\n\r\n'), 3000);
    assert.match(polite.text(), /^HTTP\/1\.1 413 /); /* and no 100 before it */
    polite.socket.destroy();
    const sent = await send(`${small.url}/api/v1`, 'x', Buffer.alloc(2 ** 20 + 1));
    assert.equal(sent.status, 413);
    assert.match(sent.json.detail, /1 MiB/);
    assert.deepEqual(await settled(small), []);
  });

  test('more than may be, when a stream of unknown length crosses it', async () => {
    let n = 0;
    const stream = new ReadableStream({
      pull(to) {
        if (n++ < 1600) to.enqueue(new Uint8Array(65536));
        else to.close();
      },
    }); // 100 MiB
    const sent = await send(`${small.url}/api/v1`, 'x', stream);
    assert.equal(sent.status, 413);
    assert.deepEqual(await settled(small), []);
    const exact = new ReadableStream({
      start(to) {
        to.enqueue(new Uint8Array(2 ** 20));
        to.close();
      },
    });
    assert.equal((await send(`${small.url}/api/v1`, 'x', exact)).status, 202);
    assert.deepEqual(await settled(small), []);
  });

  test('a fifth at once, with when to try again', async () => {
    const four = Array.from({ length: 4 }, () => half(daemon.url, 1000, 'PK'));
    assert.equal((await until(waiting, (names) => names.length === 4)).length, 4);
    for (const name of waiting()) assert.equal(statSync(join(daemon.data, 'uploads', name)).mode & 0o777, 0o600);
    const fifth = await send(api, 'x', Buffer.from('PK'));
    assert.equal(fifth.status, 429);
    assert.equal(fifth.json.type, '/problems/limit');
    assert.ok(Number(fifth.headers.get('retry-after')) > 0);
    for (const { socket } of four) socket.destroy();
    assert.deepEqual(await settled(), []);
    assert.equal((await send(api, 'x', Buffer.from('PK'))).status, 202);
    assert.deepEqual(await settled(), []);
  });

  test('deleting a plan that the server only reads', async () => {
    const answer = await call(`${api}/plans/phantom`, 'DELETE');
    assert.equal(answer.status, 403);
    assert.equal(answer.json.type, '/problems/forbidden');
    assert.equal((await call(`${api}/plans/phantom`)).status, 200);
    assert.equal((await call(`${api}/plans/nothing`, 'DELETE')).status, 404);
  });
});

describe('an upload that does not come to its end', () => {
  test('leaves nothing when the sender goes away', async () => {
    const { socket } = half(daemon.url, 100000, 'PK'.repeat(1000));
    assert.equal((await until(waiting, (names) => names.length === 1)).length, 1);
    socket.destroy();
    assert.deepEqual(await settled(), []);
  });

  test('leaves nothing when it is cancelled while it is unpacked', async () => {
    const slow = await startSlow();
    try {
      const base = `${slow.url}/api/v1`;
      const sent = await send(base, 'slow', Buffer.from('PK'));
      const job = await until(
        async () => (await call(`${base}/jobs/${sent.json.id}`)).json,
        (j) => j.percent === 12.5,
      );
      assert.deepEqual([job.state, job.phase, job.percent, job.plan], ['running', 'unpacking', 12.5, null]);
      const pid = Number(readFileSync(join(home, 'pid'), 'utf8'));
      const cancelled = await call(`${base}/jobs/${sent.json.id}`, 'DELETE');
      assert.equal(cancelled.json.state, 'cancelled');
      assert.deepEqual(await settled(slow), []);
      assert.throws(() => process.kill(pid, 0));
      assert.equal((await call(`${base}/jobs/${sent.json.id}`)).json.state, 'cancelled');
    } finally {
      await slow.stop();
    }
  });

  test('leaves nothing after a restart; uploaded plans are there again', async () => {
    const data = mkdtempSync(join(home, 'data-'));
    let one = await startDaemon({ data });
    const job = await jobEnd(`${one.url}/api/v1`, (await send(`${one.url}/api/v1`, 'Kept', join(home, 'whole.zip'))).json);
    assert.equal(job.plan, 'kept', JSON.stringify(job));
    await one.stop();
    mkdirSync(join(data, 'uploads', '7', 'deep', 'er'), { recursive: true });
    writeFileSync(join(data, 'uploads', '7', 'deep', 'er', 'file'), 'x');
    writeFileSync(join(data, 'uploads', '1.part'), 'x');
    one = await startDaemon({ data });
    try {
      assert.deepEqual(await settled(one), []);
      const kept = await until(
        async () => (await call(`${one.url}/api/v1/plans/kept`)).json,
        (plan) => plan.parts?.length,
      );
      assert.equal(kept.uploaded, true);
      assert.equal((await openPlan(one.url, 'kept')).state, 'done');
    } finally {
      await one.stop();
    }
  });
});

/** A daemon whose unpacker reports 12.5 % and then nothing for a long time. */
async function startSlow() {
  const stand = join(home, 'slow-render');
  writeFileSync(
    stand,
    `#!/bin/sh\nif [ "$1" = --unpack ]; then\n  echo $$ > ${home}/pid; echo x > "$4/half"\n  echo '{"percent": 12.5}'\n  sleep 60\n  exit 1\nfi\nexec ${bin}/beamroom-render "$@"\n`,
  );
  chmodSync(stand, 0o755);
  return startDaemon({ args: ['--renderer', stand] });
}

test('300 MB pass through without the memory growing and without others waiting', { timeout: 300000 }, async () => {
  const big = join(home, 'big.tar');
  const zeros = join(home, 'letters', 'zeros.bin');
  writeFileSync(zeros, '');
  truncateSync(zeros, 300e6);
  execFileSync('tar', ['-cf', big, '-C', join(home, 'letters'), '.']);
  rmSync(zeros);
  await openPlan(daemon.url, 'phantom');
  const memory = () => Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${daemon.child.pid}/status`, 'utf8'))[1]);
  const render = async () => {
    const began = Date.now();
    assert.equal(
      (
        await fetch(`${api}/plans/phantom/render`, {
          method: 'POST',
          headers: { 'Content-Type': 'application/json' },
          body: '{"view":{"size_px":[64,48]}}',
        })
      ).status,
      200,
    );
    return Date.now() - began;
  };
  await render();
  const before = memory();
  let most = before,
    slowest = 0,
    isSent = false;
  const { hostname, port } = new URL(daemon.url);
  const sending = new Promise((done, failed) => {
    const post = request(
      { hostname, port, path: '/api/v1/plans?name=big', method: 'POST', headers: { 'Content-Type': 'application/x-tar' } },
      (answer) => {
        let text = '';
        answer.on('data', (more) => {
          text += more;
        });
        answer.on('end', () => done({ status: answer.statusCode, json: parseStrict(text) }));
      },
    );
    post.on('error', failed);
    createReadStream(big, { highWaterMark: 1 << 20 }).pipe(post);
  }).finally(() => {
    isSent = true;
  });
  while (!isSent) {
    slowest = Math.max(slowest, await render());
    most = Math.max(most, memory());
    await sleep(20);
  }
  const sent = await sending;
  assert.equal(sent.status, 202);
  const job = await jobEnd(api, sent.json);
  most = Math.max(most, memory());
  assert.equal(job.state, 'failed', JSON.stringify(job)); /* the content is no plan */
  assert.ok(most - before < 16 * 1024, `grew by ${most - before} KiB`);
  assert.ok(slowest < 20000, `a picture took ${slowest} ms meanwhile`);
  assert.deepEqual(await settled(), []);
});
