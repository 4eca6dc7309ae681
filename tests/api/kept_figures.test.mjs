// Decisions are kept with what was shown: four pictures, the dose, its histogram and the limits of that moment, in a table that neither the end of the
// room nor that of the plan touches; a renderer that is gone takes no decision along; --verify-audit knows every picture.
import assert from 'node:assert/strict';
import { execFileSync, spawn, spawnSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { copyFileSync, cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { checklist } from '../../web/js/features/record/checklist.js';
import { bin, call, openPlan, startDaemon, until } from './daemon.mjs';
import { putWhole } from './made_dicom.mjs';
import { Client } from './ws_client.mjs';

const sha256 = (bytes) => createHash('sha256').update(bytes).digest('hex');
const quirin = { id: '77-30419', name: 'Zweifel^Quirin', birthDate: '19610412' };
let data, folder, daemon, api;
const clients = [];
before(async () => {
  data = mkdtempSync(join(tmpdir(), 'beamroom-kept-'));
  folder = mkdtempSync(join(tmpdir(), 'beamroom-plans-'));
  execFileSync(join(bin, 'beamroom'), ['phantom', join(folder, 'small'), '--size', '48x48x32']);
  for (const name of ['other', 'third']) cpSync(join(folder, 'small'), join(folder, name), { recursive: true });
  cpSync(join(folder, 'small'), join(folder, 'names'), { recursive: true });
  const labels = JSON.parse(readFileSync(join(folder, 'names', 'labels.json'), 'utf8'));
  for (const [i, name] of [
    'Scalp_without_a_blank_'.repeat(6),
    'Brain without the second target, drawn later, '.repeat(2),
    'الهدف السريري للورم الأرومي الدبقي',
  ].entries())
    labels.labels[[0, 2, 3][i]].name = name.slice(0, 120);
  writeFileSync(join(folder, 'names', 'labels.json'), JSON.stringify(labels));
  putWhole(join(folder, 'case-1'), quirin, { approval: 'APPROVED', label: 'BNCT-2' });
  mkdirSync(join(folder, 'bare')); // an image alone
  writeFileSync(
    join(folder, 'bare', 'ct.nrrd'),
    Buffer.concat([
      Buffer.from(
        'NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 8 8 8\nspace directions: (2,0,0) (0,2,0) (0,0,2)\n' +
          'kinds: domain domain domain\nendian: little\nencoding: raw\nspace origin: (0,0,0)\n\n',
      ),
      Buffer.alloc(8 * 8 * 8 * 2),
    ]),
  );
  await start('Europe/Helsinki');
});
async function start(zone) {
  daemon = await startDaemon({ data, plans: [folder], args: ['--gl', 'soft'], env: { TZ: zone } });
  api = `${daemon.url}/api/v1`;
}
after(async () => {
  for (const client of clients) client.cut();
  await daemon?.stop();
  for (const at of [data, folder]) rmSync(at, { recursive: true, force: true });
});

let input = 0;
async function put(client, kind, body) {
  client.send({ type: 'item.put', kind, body, input: ++input });
  const { item } = await client.message('item', (m) => m.input === input, 0, 60000);
  return item;
}
async function change(room, client, patch) {
  const at = `${api}/rooms/${room}/scene`,
    etag = (await call(at)).headers.get('etag');
  const { status, text } = await call(at, 'PATCH', patch, { ...client.headers, 'If-Match': etag });
  assert.equal(status, 200, text);
}
async function enter(plan, patch) {
  await openPlan(daemon.url, plan);
  const room = (await call(`${api}/rooms`, 'POST', { plan })).json.id,
    client = await Client.enter(daemon.url, room, { name: 'Ann' });
  clients.push(client);
  await until(
    () => call(`${api}/rooms/${room}/record`),
    ({ status }) => status === 200,
  );
  if (patch) await change(room, client, patch);
  return { room, client };
}
async function picture(url) {
  const answer = await fetch(url);
  return { status: answer.status, type: answer.headers.get('content-type'), bytes: Buffer.from(await answer.arrayBuffer()) };
}
const limits = {
  image: { slices: { axial: { position_mm: 10 }, sagittal: { position_mm: 5 }, coronal: { position_mm: -3 } } },
  dose: { wash: { visible: true }, lines: { visible: true } },
  constraints: { 'limit-1': { region: 'target', quantity: 'weighted', metric: 'mean', side: 'at-least', limit: 1 } },
};
const jpegSize = (bytes) => {
  for (let at = 2; ; at += 2 + bytes.readUInt16BE(at + 2))
    if (bytes[at + 1] >= 0xc0 && bytes[at + 1] <= 0xc2) return [bytes.readUInt16BE(at + 7), bytes.readUInt16BE(at + 5)];
};

test('a decision is kept with pictures, histogram and limits of that moment, and both survive room and plan', async () => {
  const { room, client } = await enter('small', limits);
  const item = await put(client, 'decision', { decision: 'accept', text: 'As shown' });
  await change(room, client, { dose: { quantity: 'boron' } });
  const at = `${api}/records/${item.id}`,
    one = await call(at),
    { kept, scene } = one.json.body;
  assert.deepEqual(kept.missing, []);
  assert.deepEqual(kept.zone, { name: 'EET', offset_min: 120 });
  assert.equal(scene.dose.quantity, 'weighted', 'of the moment of the decision');
  assert.equal(kept.dose.quantity, 'weighted');
  assert.equal(kept.dvh.curves.length, kept.plan.regions.length);
  assert.deepEqual(
    kept.limits.constraints.map(({ id, region, limit }) => [id, region, limit]),
    [['limit-1', 'target', 1]],
  );
  const [reach] = kept.irradiation.limits;
  assert.deepEqual([kept.irradiation.first, reach.id, kept.irradiation.output], [null, 'limit-1', 'min at 1e10 n/cm2/s']);
  assert.ok(Math.abs(reach.units * kept.limits.constraints[0].value - 1) < 1e-6, 'the limit is 1, of what is there per minute');
  assert.equal(kept.beam.is_draft, false);
  assert.equal(kept.identity_sha256, undefined, 'a phantom has none');
  assert.deepEqual(
    kept.figures.map(({ place, kind, width_px: width, height_px: height }) => [place, kind, width, height]),
    ['axial', 'sagittal', 'coronal', '3d'].map((kind, place) => [place, kind, 1600, 1200]),
  );
  const words = (row) => kept.figures[0].caption.filter((item) => item.row === row).map(({ text }) => text);
  assert.deepEqual(words('pane').slice(0, 2), ['Axial', 'S 10.0 mm']);
  assert.ok(
    words('pane').some((text) => /\b40\b.*\b400\b/.test(text)),
    `the window: ${words('pane')}`,
  );
  assert.ok(
    words('dose').some((text) => /100 % = .* Gy\(w\)/.test(text)),
    `the basis: ${words('dose')}`,
  );
  for (const { place, sha256: hash, n_bytes: nBytes } of kept.figures) {
    const { status, type, bytes } = await picture(`${at}/figures/${place + 1}`);
    assert.deepEqual([status, type], [200, 'image/jpeg']);
    assert.deepEqual([bytes.length, sha256(bytes), jpegSize(bytes)], [nBytes, hash, [1600, 1200]]);
  }
  for (const wrong of ['0', '5', '11', 'x']) assert.equal((await call(`${at}/figures/${wrong}`)).status, 404);
  assert.equal((await call(`${api}/rooms/${room}?records=keep`, 'DELETE', undefined, client.headers)).status, 204);
  assert.equal((await call(`${api}/plans/small/close`, 'POST')).status, 204);
  rmSync(join(folder, 'small'), { recursive: true });
  await until(
    async () => (await call(`${api}/plans`)).json.plans.map(({ id }) => id),
    (ids) => !ids.includes('small'),
  );
  assert.equal((await call(at)).json.sha256, one.json.sha256);
  assert.equal(sha256((await picture(`${at}/figures/1`)).bytes), kept.figures[0].sha256);
});

/** The paper of a record without the line that says when it was printed. */
async function paper(id) {
  const { status, json, text } = await call(`${api}/records/${id}/paper`);
  assert.equal(status, 200, text);
  const { printed, ...rest } = json;
  return { printed, rest };
}
const textsOf = ({ blocks }) => JSON.stringify(blocks);

test('the paper is the same after weights, scene, name of the plan and time zone have changed, but for when it was printed', async () => {
  const { room, client } = await enter('third', limits);
  await put(client, 'note', { text: 'over \u202Eexe.gnp\u202C <b>bold</b> & "so"', anchor: { point_mm: [-1.5, 2, 30] } });
  await put(client, 'check', {
    entry: 'beam',
    text: 'Beam, aperture, gap and irradiation time are as planned',
    state: 'issue',
    comment: 'gap',
  });
  const item = await put(client, 'decision', { decision: 'accept-with-changes', text: 'Less gap' }),
    before = await paper(item.id);
  assert.match(before.printed, /^printed \d+ \w+ \d{4}, \d\d:\d\d:\d\d EET \(UTC\+2\)$/);
  assert.match(before.rest.under, /^State of the decision, .* EET \(UTC\+2\)$/);
  const words = textsOf(before.rest);
  assert.match(words, /Irradiation time.*No known limit ends the irradiation/);
  for (const said of [
    'Accept with changes',
    'Less gap',
    'No draft beam stood at the decision.',
    'mean ≥ 1.00 Gy(w)',
    '✓ met',
    'R 1.5, P 2.0, S 30.0 mm',
  ])
    assert.ok(words.includes(JSON.stringify(said).slice(1, -1)), said);
  assert.ok(words.includes('over [RLO]exe.gnp[PDF] <b>bold</b> & \\"so\\"'), 'what does not show is a tag, markup is text');
  assert.deepEqual(
    before.rest.blocks.filter(({ type }) => type === 'figures').map(({ width, figures }) => [width, figures.map(({ place }) => place)]),
    [
      ['whole', [0]],
      ['half', [1, 2]],
      ['whole', [3]],
    ],
  );
  const { blocks } = before.rest,
    { rows } = blocks[blocks.findIndex(({ type, text }) => type === 'heading' && text === 'Checklist') + 1];
  assert.deepEqual(
    rows.map(([entry, state, wrong]) => [entry.text, state.text, wrong.text]),
    checklist.map(([id, text]) => [text, ...(id === 'beam' ? ['! Issue', 'gap'] : ['not marked', ''])]),
    'every entry of the page, in its order, what nobody marked as well',
  );
  const captions = blocks.flatMap(({ figures = [] }) => figures.map(({ caption }) => caption.map(({ text }) => text)));
  assert.deepEqual(
    captions.map((texts) => texts.filter((text) => text.startsWith('crosshair '))),
    [...Array(3).fill(['crosshair L 5.0, A 3.0, S 10.0 mm']), []],
  );
  await change(room, client, {
    dose: { quantity: 'boron', weights: { target: { boron_ratio: 9 } }, blood_ppm: 30 },
    image: { slices: { axial: { position_mm: -20 } } },
    constraints: { 'limit-1': null },
  });
  client.cut();
  await daemon.stop();
  const file = join(folder, 'third', 'plan.json'),
    plan = JSON.parse(readFileSync(file, 'utf8'));
  writeFileSync(file, JSON.stringify({ ...plan, name: 'Another name' }));
  await start('America/New_York');
  const again = await paper(item.id);
  assert.match(again.printed, /E[SD]T \(UTC-[45]\)$/);
  assert.deepEqual(again.rest, before.rest);
  // what is signed and decided afterwards is said
  const ben = await Client.enter(daemon.url, room, { name: 'Ben' });
  clients.push(ben);
  await until(
    () => call(`${api}/rooms/${room}/record`),
    ({ status }) => status === 200,
  );
  const later = await call(`${api}/records/${item.id}`);
  assert.deepEqual([later.json.signatures, later.json.later_decisions], [[], []]);
  const signed = await put(ben, 'signature', { name: 'B. Example', meaning: 'seen' });
  const { rest } = await paper(item.id);
  assert.ok(textsOf(rest).includes('“B. Example”'));
  const refused = await call(`${api}/records/${signed.id}/paper`);
  assert.deepEqual([refused.status, refused.json.code], [409, 'kind']);
  assert.equal((await call(`${api}/records/${item.id}/paper?identity=maybe`)).status, 422);
});

/** Reads a PDF by pdftotext, pdfinfo and pdfimages of Poppler. */
function read(pdf) {
  const file = join(data, 'read.pdf');
  writeFileSync(file, pdf);
  const info = execFileSync('pdfinfo', [file], { encoding: 'utf8' });
  return {
    pages: execFileSync('pdftotext', ['-raw', file, '-'], { encoding: 'utf8', maxBuffer: 1 << 26 })
      .split('\f')
      .slice(0, -1),
    n: Number(/Pages: +(\d+)/.exec(info)[1]),
    size: /Page size: +([\d.]+) x ([\d.]+)/.exec(info).slice(1).map(Number),
    images: execFileSync('pdfimages', ['-list', file], { encoding: 'utf8' }).split('\n').slice(2, -1),
  };
}

test('on paper no word lies on another, whatever the regions are called', async () => {
  const { client } = await enter('names', { dose: { wash: { visible: true } } });
  const item = await put(client, 'decision', { decision: 'accept', text: 'As shown' });
  for (const word of ['a4', 'letter']) {
    const file = join(data, 'names.pdf');
    writeFileSync(file, (await picture(`${api}/records/${item.id}/record.pdf?paper=${word}`)).bytes);
    const pages = execFileSync('pdftotext', ['-bbox', file, '-'], { encoding: 'utf8', maxBuffer: 1 << 26 })
      .split('<page ')
      .slice(1);
    assert.ok(pages.length > 3);
    for (const page of pages) {
      const words = [...page.matchAll(/<word xMin="(.+?)" yMin="(.+?)" xMax="(.+?)" yMax="(.+?)">(.*?)<\/word>/g)].map(([, ...at]) => at);
      for (const [i, [x0, y0, x1, y1, text]] of words.entries())
        for (const [u0, v0, u1, v1, other] of words.slice(i + 1)) {
          const across = Math.min(x1, u1) - Math.max(x0, u0);
          const down = Math.min(y1, v1) - Math.max(y0, v0);
          // boxes hold room above and below the letters: lines may share a third of it
          assert.ok(across < 1 || down < 0.35 * Math.min(y1 - y0, v1 - v0), `${word}: “${text}” lies on “${other}”`);
        }
    }
  }
});

test('the server draws the record as PDF: the same pages each time, every script, identity and number on each page', async () => {
  const { client } = await enter('third');
  await put(client, 'note', { text: 'Ελληνικά · 漢字かな · Привет · \u202Eexe.gnp\u202C <b>so</b> & so · שלום', anchor: null });
  await put(client, 'note', { text: 'word '.repeat(390), anchor: null });
  const item = await put(client, 'decision', { decision: 'accept', text: 'As shown' }),
    at = `${api}/records/${item.id}/record.pdf`;
  for (const [word, size] of [
    ['a4', [595.276, 841.89]],
    ['letter', [612, 792]],
  ]) {
    const { status, type, bytes } = await picture(`${at}?paper=${word}`);
    assert.deepEqual([status, type], [200, 'application/pdf']);
    const pdf = read(bytes);
    assert.deepEqual(pdf.size, size);
    assert.equal(pdf.pages.length, pdf.n);
    for (const [n, text] of pdf.pages.entries()) {
      assert.match(text, /PHANTOM[\s\S]*Research use only\. Not a medical device/);
      assert.ok(text.includes(`Page ${n + 1} of ${pdf.n}`), text);
    }
    const squeezed = (text) => text.replace(/[\s\u202a-\u202e]/g, ''), // words break where a column ends
      all = squeezed(pdf.pages.join(''));
    for (const words of [
      'As shown',
      'Ελληνικά',
      '漢字かな',
      'Привет',
      '[RLO]exe.gnp[PDF] <b>so</b> & so',
      'Hashes in full',
      'Figure 4: 3-D',
    ])
      assert.ok(all.includes(squeezed(words)), words);
    assert.match(all, /[שלום]{4}/u);
    assert.equal(pdf.images.filter((line) => / 1600 +1200 .* jpeg /.test(line)).length, 4, 'the kept JPEGs as they are');
  }
  assert.equal((await picture(`${at}?paper=a3`)).status, 422);
  const both = await Promise.all(
    [1, 2].map(async () =>
      read((await picture(at)).bytes)
        .pages.join('')
        .replace(/printed .*/g, ''),
    ),
  );
  assert.equal(both[0], both[1]);
});

test('the process that draws gives equal bytes for equal papers, and takes hostile ones without harm', async () => {
  const draw = (json, { magic = 0x42525050, n = Buffer.byteLength(json) } = {}) =>
    new Promise((done) => {
      const child = spawn(join(bin, 'beamroom-paper'), ['--serve'], { stdio: ['ignore', 'ignore', 'pipe', 'pipe'] });
      const head = Buffer.alloc(28),
        parts = [];
      let why = '';
      child.stderr.on('data', (text) => {
        why += text;
      });
      head.writeUInt32LE(magic, 0);
      head.writeUInt32LE(n, 8);
      child.stdio[3].on('data', (bytes) => parts.push(bytes));
      child.stdio[3].on('error', () => {});
      child.on('close', (status) => done({ status, why, pdf: Buffer.concat(parts) }));
      child.stdio[3].end(Buffer.concat([head, Buffer.from(json)]));
    });
  const long = `${'x'.repeat(10000)}\u202E<markup>&amp;${'\u0001'.repeat(50)}`;
  const table = {
    type: 'table',
    columns: [
      { text: 'a', percent: 50 },
      { text: 'b', percent: 1e9 },
    ],
    rows: [[{ text: long }], [{}, { text: 'y '.repeat(9000) }]],
  };
  const chart = { type: 'chart', x: long, y: '', curves: [{ percent: [1e300, -5, null], from: 1e300, width: 1e300, dash: 99 }, {}] };
  const paper = JSON.stringify({
    title: long,
    identity: { fields: Array(9).fill({ label: long, text: long, more: long }), line: long },
    time_ms: 1e18,
    blocks: [
      table,
      chart,
      { type: 'figures', figures: [{ place: 77 }, { place: 0, width_px: 1e9 }] },
      { type: 'text', text: long },
      { type: 'x' },
      7,
    ],
  });
  const [one, two] = [await draw(paper), await draw(paper)];
  assert.equal(one.status, 0, one.why);
  assert.equal(one.pdf.subarray(0, 5).toString(), '%PDF-');
  assert.equal(sha256(one.pdf), sha256(two.pdf));
  assert.ok(read(one.pdf).n > 3);
  for (const [json, options] of [
    ['{', {}],
    ['{}', { magic: 1 }],
    ['{}', { n: 1 << 30 }],
    ['{}', { n: 99 }],
  ]) {
    const { status, pdf } = await draw(json, options);
    assert.deepEqual([status, pdf.length], [1, 0]);
  }
  const pages = await draw(
    JSON.stringify({
      blocks: Array(600)
        .fill([{ type: 'page' }, { type: 'text', text: 'x' }])
        .flat(),
    }),
  );
  assert.deepEqual([pages.status, pages.pdf.length], [1, 0], 'too many pages');
});

test('the patient stands masked on paper, and in full for who may read that while the files name the same one', async () => {
  const { client } = await enter('case-1');
  const item = await put(client, 'decision', { decision: 'accept', text: '' }),
    at = `${api}/records/${item.id}`;
  const list = (body) => call(`${api}/records/search`, 'POST', body),
    found = await list({ text: '…419', kind: 'decision', limit: 1 }),
    [row] = found.json.records;
  assert.deepEqual([row.id, row.decision, row.patient, row.label, row.approval], [item.id, 'accept', 'Q. Z. …419', 'BNCT-2', 'APPROVED']);
  for (const text of ['bnct-2', 'CASE-1', item.id, 'accept']) assert.equal((await list({ text })).json.records[0]?.id, item.id, text);
  for (const text of ['Zweifel', '30419', '1961']) assert.deepEqual((await list({ text })).json, { records: [], more: false }, text);
  const one = await call(at),
    masked = await call(`${at}/paper`),
    named = await call(`${at}/paper?identity=true`);
  assert.match(one.json.body.kept.identity_sha256, /^[0-9a-f]{64}$/);
  for (const secret of ['Zweifel', 'Quirin', '77-30419', '1961-04-12', '19610412'])
    for (const { text } of [one, masked, found]) assert.ok(!text.includes(secret), secret);
  assert.deepEqual(
    masked.json.identity.fields.map(({ text, more }) => [text, more].join(' ').trim()),
    ['Q. Z. …419', 'masked', 'masked', 'BNCT-2 Approved'],
  );
  assert.equal(named.status, 200, named.text);
  assert.deepEqual(
    named.json.identity.fields.slice(0, 3).map(({ text }) => text),
    ['Zweifel^Quirin', '77-30419', '1961-04-12'],
  );
  assert.equal(named.json.identity.line, 'Zweifel^Quirin · 77-30419 · 1961-04-12 · plan BNCT-2');
  client.cut();
  assert.equal((await call(`${api}/plans/case-1/close`, 'POST')).status, 204);
  rmSync(join(folder, 'case-1'), { recursive: true });
  putWhole(join(folder, 'case-1'), { ...quirin, birthDate: '19610413' }, { approval: 'APPROVED' });
  const { status, json } = await call(`${at}/paper?identity=true`);
  assert.deepEqual([status, json.code], [409, 'identity']);
  assert.equal((await call(`${at}/paper`)).status, 200);
});

test('a decision without its renderer is kept all the same, and says what is missing', async () => {
  const { client } = await enter('other');
  assert.equal((await call(`${api}/plans/other/close`, 'POST')).status, 204);
  const item = await put(client, 'decision', { decision: 'defer', text: '' });
  const { kept } = (await call(`${api}/records/${item.id}`)).json.body;
  assert.deepEqual(kept.figures, []);
  assert.deepEqual(kept.missing.map(({ what }) => what).sort(), [
    '3-D picture',
    'axial picture',
    'beam',
    'coronal picture',
    'dose',
    'dvh',
    'fits',
    'identity',
    'irradiation',
    'limits',
    'sagittal picture',
  ]);
  assert.ok(kept.missing.every(({ why }) => why.length > 5));
  const { blocks } = (await call(`${api}/records/${item.id}/paper`)).json;
  const said = blocks.map(({ text }) => text ?? '').filter((text) => text.startsWith('Not kept with this decision: '));
  assert.equal(said.length, kept.missing.length, 'the plan has all of it, and the paper says each');
  assert.ok(said.some((text) => text.startsWith('Not kept with this decision: dose-volume histogram (')));
});

test('paper does not miss the dose, histogram and beam of a plan that has none, but limits that were set', async () => {
  const { room, client } = await enter('bare');
  const said = async () => {
    const item = await put(client, 'decision', { decision: 'defer', text: '' });
    const { blocks } = (await call(`${api}/records/${item.id}/paper`)).json;
    assert.ok(blocks.some(({ rows }) => rows?.some((cells) => cells.some(({ text }) => text === 'no dose'))));
    return blocks.map(({ text }) => text ?? '').filter((text) => /not kept/i.test(text));
  };
  assert.deepEqual(await said(), []);
  await change(room, client, { constraints: { 'limit-1': { ...limits.constraints['limit-1'], region: '' } } });
  assert.deepEqual(await said(), ['Not kept with this decision: limits (the plan has no dose).']);
});

test('the check of the audit knows each picture: a changed one and one that was taken away are found', async () => {
  for (const client of clients.splice(0)) client.cut();
  await daemon.stop();
  daemon = null;
  const check = (file) => spawnSync(join(bin, 'beamroomd'), ['--verify-audit', file], { encoding: 'utf8' });
  const database = join(data, 'beamroom.db');
  assert.equal(check(database).status, 0, check(database).stderr);
  for (const [change, said] of [
    ["UPDATE record_figures SET bytes = x'00' WHERE place = 2", /picture 3 of the record of decision .* was changed in the database/],
    ['DELETE FROM record_figures WHERE place = 0', /a picture of the record of decision .* is not in the database any more/],
    ['DROP TABLE record_figures', /a picture of the record of decision .* is not in the database any more/],
  ]) {
    const copy = join(data, 'changed.db');
    copyFileSync(database, copy);
    const lift = 'DROP TRIGGER record_figures_update; DROP TRIGGER record_figures_delete;';
    execFileSync('python3', [
      '-c',
      'import sqlite3, sys; d = sqlite3.connect(sys.argv[1]); d.executescript(sys.argv[2]); d.commit()',
      copy,
      `${lift}${change}`,
    ]);
    const { status, stderr, stdout } = check(copy);
    assert.notEqual(status, 0, change);
    assert.match(stderr + stdout, said);
    assert.throws(() =>
      execFileSync(
        'python3',
        [
          '-c',
          'import sqlite3, sys; sqlite3.connect(sys.argv[1]).execute(sys.argv[2])',
          database,
          change.replace('DROP TABLE', 'DELETE FROM'),
        ],
        { stdio: 'pipe' },
      ),
    );
  }
  assert.ok(readFileSync(database).length > 0);
});
