// Labels of isodose lines over HTTP: those of the picture that a room's view shows.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { call, demo, openPlan, startDaemon } from './daemon.mjs';

let daemon, plan;

before(async () => {
  daemon = await startDaemon({ plans: [demo] });
  plan = `${daemon.url}/api/v1/plans/phantom`;
  await openPlan(daemon.url, 'phantom');
});
after(() => daemon?.stop());

const levels = {
  low: { value: 30, color: '#00ffff' },
  high: { value: 50, color: '#0000ff' },
  hidden: { value: 45, visible: false },
  unlined: { value: 60, line: false },
  ...Object.fromEntries([1, 2, 3, 4, 5, 6].map((n) => [`level-${n}`, { visible: false }])), // those of a new room
};
const ask = (size, kind, lines = true) => {
  const override = { dose: { quantity: 'gamma', levels, lines: { visible: lines } } };
  return call(`${plan}/dose/isolines?text_px=12&view=${encodeURIComponent(JSON.stringify({ kind, size_px: size, override }))}`);
};

// The corners of a label's box.
function corners({ x_px, y_px, angle_deg, width_px, height_px }) {
  const turn = (angle_deg * Math.PI) / 180;
  return [
    [-1, -1],
    [1, -1],
    [1, 1],
    [-1, 1],
  ].map(([i, j]) => {
    const [x, y] = [(i * width_px) / 2, (j * height_px) / 2];
    return [x_px + x * Math.cos(turn) - y * Math.sin(turn), y_px + x * Math.sin(turn) + y * Math.cos(turn)];
  });
}
// Rectangles are apart if a direction along a side of one of them parts them.
function overlap(a, b) {
  const [p, q] = [corners(a), corners(b)];
  return [a, b].every(({ angle_deg }) =>
    [0, 90].every((more) => {
      const turn = ((angle_deg + more) * Math.PI) / 180;
      const at = (points) => points.map(([x, y]) => x * Math.cos(turn) + y * Math.sin(turn));
      return Math.max(...at(p)) >= Math.min(...at(q)) && Math.max(...at(q)) >= Math.min(...at(p));
    }),
  );
}

for (const [kind, size] of [
  ['axial', [1024, 768]],
  ['coronal', [640, 480]],
  ['sagittal', [320, 240]],
])
  test(`a ${kind} pane of ${size.join(' x ')} px has labels on its lines, within it, none over another`, async () => {
    const answer = await ask(size, kind);
    assert.equal(answer.status, 200, answer.text);
    assert.deepEqual(
      answer.json.levels.map(({ id, text, percent, color }) => [id, text, Math.round(percent), color]),
      [
        ['low', '30 %', 30, '#00ffff'],
        ['high', '50 %', 50, '#0000ff'],
      ],
    );
    const labels = answer.json.levels.flatMap((level) => level.labels);
    assert.ok(labels.length > 0, answer.text);
    for (const [i, label] of labels.entries()) {
      for (const [x, y] of corners(label)) assert.ok(x >= 0 && y >= 0 && x <= size[0] && y <= size[1], JSON.stringify(label));
      for (const other of labels.slice(0, i)) assert.ok(!overlap(label, other), JSON.stringify([label, other]));
    }
  });

test('with choice a level has many places on its lines, the best one first, of the same size', async () => {
  const view = { kind: 'axial', size_px: [1024, 768], override: { dose: { quantity: 'gamma', levels, lines: { visible: true } } } };
  const answer = await call(`${plan}/dose/isolines?text_px=12&choice=true&view=${encodeURIComponent(JSON.stringify(view))}`);
  const usual = await ask([1024, 768], 'axial');
  for (const [at, { labels }] of answer.json.levels.entries()) {
    assert.ok(labels.length > usual.json.levels[at].labels.length, answer.text);
    for (const [i, label] of labels.entries()) {
      for (const [x, y] of corners(label)) assert.ok(x >= 0 && y >= 0 && x <= 1024 && y <= 768, JSON.stringify(label));
      for (const other of labels.slice(0, i)) assert.ok(!overlap(label, other), 'of one level none lies over another');
    }
  }
});

test('low panes and views into space have levels and no labels, a scene without lines has none of both', async () => {
  for (const [kind, size] of [
    ['axial', [800, 239]],
    ['3d', [800, 600]],
  ]) {
    const { levels: shown } = (await ask(size, kind)).json;
    assert.deepEqual(
      shown.map((level) => level.labels.length),
      [0, 0],
    );
  }
  assert.deepEqual((await ask([800, 600], 'axial', false)).json, { unit: '', levels: [] });
});
