// Runs the bench programs and writes what they measured: run.mjs OUT.json
//
// A bench is bench_*.c (built to build/release/bench/), bench_*.py or bench_*.mjs in this folder. It prints one JSON
// object a line: {name, value, unit, peer, peer_value, ratio, note}. name, value and unit are required; peer,
// peer_value and ratio come together: what it was compared with in the same run, and how many times better ours is.
// A line {"machine": {...}} adds facts about the machine ("gl": "llvmpipe ..."); other lines are passed through.
// BENCH=word runs only the benches whose name has the word in it. Exit status 1 when one of them failed.
import { spawnSync } from 'node:child_process';
import { readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { cpus, release, totalmem } from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';

const out = process.argv[2] ?? 'build/bench.json';
const here = path.dirname(fileURLToPath(import.meta.url));
const programs = path.join(process.env.BEAMROOM_BIN ?? 'build/release', 'bench');
const seconds = Number(process.env.BENCH_SECONDS ?? 300);

/** The command that runs a bench file. */
function command(file) {
  const source = path.join(here, file);
  switch (path.extname(file)) {
    case '.c':
      return [path.join(programs, path.basename(file, '.c'))];
    case '.py':
      return [process.env.PYTHON ?? '/usr/bin/python3', source];
    default:
      return [process.execPath, source];
  }
}

/** The fault of a result, '' for none. */
function complaint(result) {
  if (typeof result.name !== 'string' || typeof result.unit !== 'string') return 'name and unit must be words';
  if (!Number.isFinite(result.value)) return 'value must be a number';
  const peers = [result.peer, result.peer_value, result.ratio].filter((part) => part !== undefined && part !== null);
  if (peers.length !== 0 && peers.length !== 3) return 'peer, peer_value and ratio come together';
  return '';
}

/** Runs one bench: its results and whether it failed. */
function run(file, machine) {
  const [program, ...args] = command(file);
  const done = spawnSync(program, args, {
    encoding: 'utf8',
    timeout: seconds * 1000,
    maxBuffer: 64 << 20,
    stdio: ['ignore', 'pipe', 'inherit'],
  });
  const results = [];
  let failure = done.status === 0 || done.status === 77 ? '' : (done.error?.message ?? `exit ${done.status ?? done.signal}`);
  for (const line of (done.stdout ?? '').split('\n')) {
    if (!line.startsWith('{')) {
      if (line) console.log(line);
      continue;
    }
    try {
      const result = JSON.parse(line);
      if (result.machine) Object.assign(machine, result.machine);
      else if (complaint(result)) failure ||= `${complaint(result)}: ${line}`;
      else results.push(result);
    } catch (error) {
      failure ||= `${error.message}: ${line}`;
    }
  }
  return { results, failure };
}

const number = (value) => (value === undefined || value === null ? '' : Number(value.toPrecision(4)).toString());

/** The results as lines of a table with columns as wide as their widest word. */
function table(results) {
  const rows = [
    ['what', 'ours', 'unit', 'compared with', 'theirs', 'ratio', ''],
    ...results.map((r) => [
      r.name,
      number(r.value),
      r.unit,
      r.peer ?? '',
      number(r.peer_value),
      r.ratio ? `x${Number(r.ratio).toFixed(2)}` : '',
      r.note ?? '',
    ]),
  ];
  const widths = rows[0].map((_, column) => Math.max(...rows.map((row) => row[column].length)));
  const right = new Set([1, 4, 5]);
  return rows.map((row) =>
    row
      .map((word, column) => (right.has(column) ? word.padStart(widths[column]) : word.padEnd(widths[column])))
      .join('  ')
      .trimEnd(),
  );
}

const cpu = cpus();
const machine = {
  cpu: cpu[0]?.model ?? 'unknown',
  cores: cpu.length,
  memory_gib: Math.round(totalmem() / 2 ** 30),
  kernel: release(),
  os: /^PRETTY_NAME="?([^"\n]*)/m.exec(readFileSync('/etc/os-release', 'utf8'))?.[1] ?? '',
  date: new Date().toISOString().replace(/\.\d+Z$/, 'Z'),
};
const results = [];
const failures = [];
for (const file of readdirSync(here)
  .filter((name) => /^bench_.*\.(c|py|mjs)$/.test(name))
  .sort()) {
  if (process.env.BENCH && !file.includes(process.env.BENCH)) continue;
  console.error(`  BENCH ${file}`);
  const one = run(file, machine);
  results.push(...one.results);
  if (one.failure) failures.push(`${file}: ${one.failure}`);
}
console.log(
  `\n${machine.cpu}, ${machine.cores} cores, ${machine.memory_gib} GiB, Linux ${machine.kernel}` +
    `${machine.gl ? `, ${machine.gl}` : ''}, ${machine.date}\n`,
);
for (const line of table(results)) console.log(line);
for (const failure of failures) console.log(`FAILED: ${failure}`);
writeFileSync(out, `${JSON.stringify({ machine, results, failures }, null, 2)}\n`);
console.log(`\nbench: ${results.length} figures in ${out}, ${failures.length} failed`);
process.exitCode = failures.length ? 1 : 0;
