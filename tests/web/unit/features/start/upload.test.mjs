// A plan on its way to the server: the tar that is made of files, and the steps that are shown.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { load } from '../../page.mjs';

const { filesOfDrop } = await load('net/dropped.js');
const { bodyOf, tarOf } = await load('net/tar.js');
const { sendPlan } = await load('net/upload.js');
const { UploadsState } = await load('features/start/uploads.js');

const fileOf = (text, lastModified = 1_700_000_000_000) => Object.assign(new Blob([text]), { lastModified });

test('the tar of files is read by tar, with long and foreign names, empty files and the times they had', async () => {
  const long = `${'deep/'.repeat(40)}slice.dcm`;
  const files = [
    ['plan.json', '{}'],
    [long, 'x'.repeat(513)],
    ['Région/Übersicht größer.nii.gz', 'äöü'],
    ['empty', ''],
    ['full block', 'b'.repeat(512)],
  ];
  const folder = mkdtempSync(join(tmpdir(), 'beamroom-tar-'));
  try {
    const blob = tarOf(files.map(([path, text]) => ({ path, file: fileOf(text) })));
    writeFileSync(join(folder, 'a.tar'), Buffer.from(await blob.arrayBuffer()));
    assert.equal(blob.size % 512, 0);
    execFileSync('tar', ['-xf', 'a.tar'], { cwd: folder, env: { ...process.env, LC_ALL: 'C.UTF-8' } });
    for (const [path, text] of files) assert.equal(readFileSync(join(folder, path), 'utf8'), text, path);
    assert.equal(statSync(join(folder, 'plan.json')).mtime.getTime(), 1_700_000_000_000);
  } finally {
    rmSync(folder, { recursive: true });
  }
});

test('an archive goes as it is; a folder or files become a tar, named after the folder or the first file', () => {
  const file = fileOf('PK');
  assert.deepEqual(bodyOf([{ path: 'head.ZIP', file }]), { name: 'head', body: file, type: 'application/zip' });
  assert.equal(bodyOf([{ path: 'head.tar.gz', file }]).body, file);
  assert.equal(bodyOf([{ path: 'head.tar.gz', file }]).name, 'head');
  const image = bodyOf([{ path: 'ct.nii.gz', file }]);
  assert.deepEqual([image.name, image.type, image.body === file], ['ct', 'application/x-tar', false]);
  assert.equal(
    bodyOf([
      { path: 'head one/ct/1.dcm', file },
      { path: 'head one/ct/2.dcm', file },
    ]).name,
    'head one',
  );
  assert.equal(
    bodyOf([
      { path: 'a.dcm', file },
      { path: 'b/c.dcm', file },
    ]).name,
    'a',
  );
});

/** An XMLHttpRequest that says what it is told to. */
class FakeRequest extends EventTarget {
  upload = new EventTarget();
  open(method, url) {
    this.asked = [method, url];
  }
  setRequestHeader(name, value) {
    this.header = [name, value];
  }
  send(body) {
    this.body = body;
  }
  abort() {
    this.dispatchEvent(new Event('abort'));
  }
  answer(status, json) {
    this.status = status;
    this.responseText = JSON.stringify(json);
    this.dispatchEvent(new Event('load'));
  }
}

test('what has been sent is told; a refusal says why; a cancelled upload ends', async () => {
  const request = new FakeRequest();
  const sent = [];
  const abort = new AbortController();
  const task = {
    makeRequest: () => request,
    url: 'api/v1/plans?name=a',
    body: new Blob(['abc']),
    type: 'application/zip',
    onSent: (n) => sent.push(n),
    signal: abort.signal,
  };
  const one = sendPlan(task);
  assert.deepEqual(
    [request.asked, request.header],
    [
      ['POST', 'api/v1/plans?name=a'],
      ['Content-Type', 'application/zip'],
    ],
  );
  request.upload.dispatchEvent(Object.assign(new Event('progress'), { loaded: 2 }));
  request.answer(202, { id: 'upload-1', state: 'queued' });
  assert.equal((await one).id, 'upload-1');
  assert.deepEqual(sent, [2]);
  const two = sendPlan(task);
  request.answer(413, { detail: 'a body of more than 2048 MiB' });
  await assert.rejects(two, /more than 2048 MiB/);
  const three = sendPlan(task);
  abort.abort();
  await assert.rejects(three, /cancelled/);
});

const world = (jobs, send) => {
  const arrived = [];
  const clock = {
    setTimeout: (callback) => {
      setImmediate(callback);
    },
  };
  const api = { job: async () => jobs.shift(), cancelJob: async () => {} };
  const state = new UploadsState({ api, clock, send, arrived: (plan) => arrived.push(plan) });
  return { state, arrived };
};

test("an upload goes from sending over the server's job to a plan, and its row goes", async () => {
  const seen = [];
  const { state, arrived } = world(
    [
      { id: 'upload-1', state: 'running', phase: 'unpacking', percent: 40 },
      { id: 'upload-1', state: 'done', plan: 'head' },
    ],
    async ({ onSent }) => {
      onSent(3);
      seen.push(state.rows.value[0].sent);
      return { id: 'upload-1', state: 'queued' };
    },
  );
  await state.send(state.offer({ name: 'head', body: new Blob(['12345']), type: 'application/zip' }), '');
  assert.deepEqual([seen, arrived, state.rows.value], [[3], ['head'], []]);
});

test('a refused plan stays with the reason until it is dismissed', async () => {
  const { state, arrived } = world(
    [{ id: 'upload-1', state: 'failed', problem: { detail: 'entry 3 leads out of the folder' } }],
    async () => ({ id: 'upload-1', state: 'queued' }),
  );
  await state.send(state.offer({ name: 'head', body: new Blob(['1']), type: 'application/zip' }), '');
  const [row] = state.rows.value;
  assert.deepEqual([row.state, row.error, arrived], ['failed', 'entry 3 leads out of the folder', []]);
  state.dismiss(row.key);
  assert.deepEqual(state.rows.value, []);
});

test('cancelling while it is sent stops the sending; later it cancels the job', async () => {
  const { state } = world(
    [],
    ({ signal }) =>
      new Promise((_, reject) => {
        signal.addEventListener('abort', () => reject(new Error('cancelled')));
      }),
  );
  const adding = state.send(state.offer({ name: 'head', body: new Blob(['1']), type: 'application/zip' }), '');
  state.cancel(state.rows.value[0].key);
  await adding;
  assert.deepEqual(state.rows.value, []);
});

test('what is larger than the server takes is not sent at all', async () => {
  const state = new UploadsState({ api: {}, clock: {}, send: () => assert.fail('was sent'), arrived: () => {}, limit: () => 3 });
  await state.send(state.offer({ name: 'head', body: new Blob(['1234']), type: 'application/zip' }), '');
  assert.match(state.rows.value[0].error, /at most 1 MB/);
});

test("what is sent carries the name that was given for everybody, never the file's; nothing is sent before", async () => {
  const sent = [];
  const { state } = world([], async (task) => {
    sent.push(task);
    return { id: 'upload-1', state: 'cancelled' };
  });
  const key = state.offer({ name: 'Doe John 1950', body: new Blob(['1']), type: 'application/zip' });
  assert.deepEqual([state.rows.value[0].state, state.rows.value[0].name, sent], ['asking', 'Doe John 1950', []]);
  await state.send(key, '  head one ');
  await state.send(key, 'again'); // one press too many
  assert.deepEqual(
    sent.map(({ signal, onSent, body, ...rest }) => rest),
    [{ publicName: 'head one', type: 'application/zip' }],
  );
  assert.ok(!JSON.stringify(sent).includes('Doe'));
  const other = state.offer({ name: 'x', body: new Blob(['1']), type: 'application/zip' });
  state.cancel(other);
  await state.send(other, 'x');
  assert.deepEqual([state.rows.value, sent.length], [[], 1]);
});

test('without a name none is in the address', async () => {
  const { makeApi } = await load('net/api.js');
  const api = makeApi(async () => {});
  assert.doesNotMatch(api.uploadUrl(''), /name/);
  assert.match(api.uploadUrl('head one'), /\/plans\?name=head%20one$/);
});

test('what another program hands over is a file without an entry, and goes as one', async () => {
  const item = (entry, file) => ({ kind: 'file', webkitGetAsEntry: () => entry, getAsFile: () => file });
  const entry = { isFile: true, fullPath: '/b.nii', file: (resolve) => resolve({ name: 'b.nii' }) };
  const items = [item(null, { name: 'mail.zip' }), item(entry, { name: 'b.nii' }), { kind: 'string' }, item(null, null)];
  assert.deepEqual(
    (await filesOfDrop({ items })).map(({ path }) => path),
    ['b.nii', 'mail.zip'],
  );
});
