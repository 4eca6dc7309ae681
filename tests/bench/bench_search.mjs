// The wait of a person who types into the search of the start page, on a server with 2,000 plans in 40 folders and 300 rooms:
// POST /plans/search with its answer read, by texts that many plans fit, that one fits and that none does.
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { call, startDaemon, until } from '../api/daemon.mjs';

const [nPlans, nFolders, nRooms, runs] = [2000, 40, 300, 25];
const median = (values) => [...values].sort((a, b) => a - b)[values.length >> 1];
const tell = (name, value, note) => console.log(JSON.stringify({ name, value: Number(value.toFixed(2)), unit: 'ms', note }));

const root = mkdtempSync(join(tmpdir(), 'beamroom-search-'));
const folders = Array.from({ length: nFolders }, (_, i) => join(root, `ward-${i >> 1}`, i % 2 ? 'plans' : 'others'));
for (let i = 0; i < nPlans; i++) {
  const at = join(folders[i % nFolders], `case-${i}`);
  mkdirSync(at, { recursive: true });
  const plan = {
    format: 'beamroom-plan',
    version: 1,
    name: `Head ${i}`,
    note: `Made up, series ${i % 97}`,
    images: [{ id: 'ct', path: 'ct.nii' }],
  };
  writeFileSync(join(at, 'plan.json'), JSON.stringify(plan));
}
const daemon = await startDaemon({ plans: folders, args: ['--stub'] });
try {
  const search = async (text, more = {}) => {
    const body = JSON.stringify({ text, kind: 'plan', sort: 'used', limit: 50, ...more });
    const began = performance.now();
    const answer = await fetch(`${daemon.url}/api/v1/plans/search`, {
      method: 'POST',
      headers: { 'Content-Type': 'application/json' },
      body,
    });
    const found = await answer.json();
    return { ms: performance.now() - began, found };
  };
  await until(
    () => search('head'),
    ({ found }) => found.total === nPlans, // each was looked at
    300000,
  );
  for (let i = 0; i < nRooms; i++) {
    const { json } = await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: `case-${i * 6}` });
    if (json?.id) await call(`${daemon.url}/api/v1/rooms/${json.id}`, 'PATCH', { name: `Look ${i}` });
  }
  for (const [what, text, total] of [
    ['that many fit', 'head', nPlans],
    ['that one fits', 'head 1234', 1],
    ['that none fits', 'nobody is called so', 0],
  ]) {
    const times = [];
    for (let run = 0; run < runs; run++) {
      const { ms, found } = await search(text);
      if (found.total !== total) throw new Error(`${text}: ${found.total} found, ${total} expected`);
      times.push(ms);
    }
    tell(
      `search of 2,000 plans by a text ${what}`,
      median(times),
      `median of ${runs}, most ${Math.max(...times).toFixed(1)}; at most 200 asked for`,
    );
  }
} finally {
  await daemon.stop();
  rmSync(root, { recursive: true, force: true });
}
