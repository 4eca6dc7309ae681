// Waits of a script: the first picture of the demo plan from a daemon that has just started, pictures of a plan that is
// open, and what daemon and renderer hold in memory and use while nobody asks for anything.
import { readFileSync, readdirSync } from 'node:fs';
import { call, openPlan, sleep, startDaemon } from '../api/daemon.mjs';

const view = (turn) => ({
  kind: '3d',
  size_px: [1024, 768],
  camera: { position_mm: [800 * Math.sin(turn), -800 * Math.cos(turn), 0], target_mm: [0, 0, 0], up: [0, 0, 1] },
});

/** Milliseconds until a picture is here. */
async function picture(url, turn) {
  const began = performance.now();
  const answer = await fetch(`${url}/api/v1/plans/phantom/render`, {
    method: 'POST',
    headers: { 'Content-Type': 'application/json' },
    body: JSON.stringify({ view: view(turn), format: 'jpeg' }),
  });
  const bytes = await answer.arrayBuffer();
  if (answer.status !== 200) throw new Error(`render: ${answer.status} ${new TextDecoder().decode(bytes)}`);
  return performance.now() - began;
}

const median = (values) => [...values].sort((a, b) => a - b)[values.length >> 1];
const tell = (name, value, unit, note) => console.log(JSON.stringify({ name, value: Number(value.toFixed(2)), unit, note }));

/** Processes below one, itself included. */
function family(pid) {
  const parents = readdirSync('/proc')
    .filter((name) => /^\d+$/.test(name))
    .map((name) => {
      try {
        const stat = readFileSync(`/proc/${name}/stat`, 'utf8');
        return [Number(name), Number(stat.slice(stat.lastIndexOf(')') + 2).split(' ')[1])];
      } catch {
        return [0, 0]; // gone since
      }
    });
  const found = [pid];
  for (const one of found) found.push(...parents.filter(([, parent]) => parent === one).map(([child]) => child));
  return found;
}
const resident = (pid) => Number(/VmRSS:\s*(\d+)/.exec(readFileSync(`/proc/${pid}/status`, 'utf8'))?.[1] ?? 0) / 1024;
/** Clock ticks (10 ms) a process has used. */
function ticks(pid) {
  const stat = readFileSync(`/proc/${pid}/stat`, 'utf8');
  const fields = stat.slice(stat.lastIndexOf(')') + 2).split(' ');
  return Number(fields[11]) + Number(fields[12]);
}

const firsts = [];
let daemon;
for (let run = 0; run < 3; run++) {
  await daemon?.stop();
  daemon = await startDaemon();
  const began = performance.now();
  const opened = await call(`${daemon.url}/api/v1/plans/phantom/open`, 'POST');
  if (opened.status !== 202) throw new Error(`open: ${opened.text}`);
  await picture(daemon.url, 0.1);
  firsts.push(performance.now() - began);
}
tell('request to first picture, demo plan, 1024 x 768', median(firsts), 'ms', `median of ${firsts.length} daemons; at most 1000 asked for`);

await openPlan(daemon.url, 'phantom');
const version = await call(`${daemon.url}/api/v1/version`);
const gl = version.json?.gl;
if (gl) console.log(JSON.stringify({ machine: { gl: `${gl.back_end}: ${gl.renderer}` } }));

const opens = [];
for (let run = 0; run < 9; run++) opens.push(await picture(daemon.url, 0.2 + 0.1 * run));
tell('request to picture, open plan, 1024 x 768, still', median(opens), 'ms', 'median of 9 cameras; at most 300 asked for');

const processes = family(daemon.child.pid);
tell('memory of the daemon, one plan open', resident(processes[0]), 'MiB', 'resident');
tell(
  'memory of its renderer, demo plan',
  processes.slice(1).reduce((sum, pid) => sum + resident(pid), 0),
  'MiB',
  'resident',
);
await sleep(500);
const before = processes.map(ticks);
await sleep(3000);
const used = processes.map(ticks).reduce((sum, now, at) => sum + now - before[at], 0) * 10;
tell('processor time of both while nobody asks', used / 3, 'ms a second', 'over 3 s');
await daemon.stop();
