// Runs the items of several test suites from one queue, so that no core waits for the last item of a suite:
//   node tests/queue.mjs SUITE[:MOST] ITEM... -- SUITE[:MOST] ITEM... -- ...
// An item is a file of node's test runner (*.mjs, by run_node.sh), a script (*.sh), or a test program (by run_programs.sh). MOST items of a suite run at once.
// SLOTS items run at once in all. What took longest in the last run starts first; without a last run, the suites in their order and large files first.
// LAST_RUN=long: these are the long tests, whose times are kept apart. Each file of the page gets a browser that is used again by the next one (BEAMROOM_BROWSER, tests/web/browser.mjs).
// Each suite's output stays in build/test/SUITE.log. Ends with "total SUITE: N passed, N failed, N skipped" for each suite.
import { appendFileSync, existsSync, mkdirSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { spawn } from 'node:child_process';
import { basename } from 'node:path';

const folder = 'build/test';
const isLong = process.env.LAST_RUN === 'long';
const lastRun = `${folder}/${isLong ? 'long-' : ''}seconds.json`;
const slots = Number(process.env.SLOTS ?? 4);

const suites = new Map();
for (const words of process.argv.slice(2).join('\n').split('\n--\n')) {
  const [head, ...paths] = words.split('\n');
  const [name, most] = head.split(':');
  suites.set(name, { name, most: Number(most ?? slots), paths, running: 0, passed: 0, failed: 0, skipped: 0, seconds: 0 });
}
mkdirSync(folder, { recursive: true });
const known = existsSync(lastRun) ? JSON.parse(readFileSync(lastRun, 'utf8')) : {};
/** Seconds of the items that take long: a clean checkout has no last run, and one of these started last would run alone. */
const usual = isLong
  ? {
      100: `web/planner_hour api/replayed_meeting web/guide web/meeting`,
      60: `web/layout web/language web/axe web/charts api/slow web/beam_eye web/cases api/rest`,
      30: `web/start web/measure web/image web/beam_draft web/watch api/kills api/missing web/legend web/roster web/display`,
    }
  : {
      30: `web/whole_meeting api/idle web/dose web/start api/connections tests/lint web/views faults/test_draw api/ws`,
      20: `web/page api/tls web/display web/patient web/sign_in api/rights_matrix api/hostile api/audit web/pointed api/kept render/test_beam_slice
        unit/test_plan_data web/watch unit/test_unpack`,
      12: `web/image web/clip web/shell api/identity api/kept_figures api/dvh web/touch web/layout web/snapshot api/http unit/test_tls faults/test_upload
        api/display api/acts web/axe web/regions web/beam_eye web/tracks web/charts web/undo`,
    };
const usualSeconds = new Map(
  Object.entries(usual).flatMap(([seconds, names]) => names.split(/\s+/).map((name) => [name, Number(seconds)])),
);
const secondsOf = ({ path }) =>
  known[path] ??
  usualSeconds.get(
    path
      .replace(/(\.test)?\.m?[a-z]+$/, '')
      .split('/')
      .slice(-2)
      .join('/'),
  ) ??
  0;
const took = {};
const rank = [...suites.keys()];
const waiting = [...suites.values()].flatMap((suite) => suite.paths.map((path) => ({ suite, path, size: statSync(path).size })));
waiting.sort((a, b) => secondsOf(b) - secondsOf(a) || rank.indexOf(a.suite.name) - rank.indexOf(b.suite.name) || b.size - a.size);
for (const { name } of suites.values()) rmSync(`${folder}/${name}.log`, { force: true });

/** Browsers that no file uses now. They end with this process. */
const browsers = { free: [], all: [] };
async function takeBrowser() {
  if (browsers.free.length) return browsers.free.pop();
  const { startBrowser } = await import('./web/browser.mjs');
  const server = await startBrowser().catch(() => null); // the file then starts one itself, and says what is wrong
  if (server) browsers.all.push(server);
  return server;
}

const commandOf = ({ suite, path }) =>
  path.endsWith('.mjs')
    ? ['tests/run_node.sh', `${suite.name}-${basename(path, '.test.mjs')}`, path]
    : path.endsWith('.sh')
      ? [path]
      : ['tests/run_programs.sh', suite.name, path];

async function run(item) {
  const { suite, path } = item;
  const browser = /web\/[^/]*$/.test(path) ? await takeBrowser() : null;
  const start = performance.now();
  const [program, ...args] = commandOf(item);
  const child = spawn(program, args, {
    stdio: ['ignore', 'pipe', 'pipe'],
    env: { ...process.env, SUITE_SECONDS: process.env.SUITE_SECONDS ?? '400', ...(browser && { BEAMROOM_BROWSER: browser.wsEndpoint() }) },
  });
  let output = '';
  for (const stream of [child.stdout, child.stderr])
    stream.on('data', (text) => {
      output += text;
    });
  const status = await new Promise((done) => {
    child.on('close', done);
  });
  if (browser?.process().exitCode === null) browsers.free.push(browser);
  took[path] = (performance.now() - start) / 1000;
  const counts = [0, 0, 0];
  for (const found of output.matchAll(/^[^:\n]+: (\d+) passed, (\d+) failed, (\d+) skipped$/gm))
    counts.forEach((_, i) => {
      counts[i] += Number(found[i + 1]);
    });
  if (status !== 0 && counts[1] === 0) counts[1] = 1;
  ['passed', 'failed', 'skipped'].forEach((name, i) => {
    suite[name] += counts[i];
  });
  suite.seconds += took[path];
  appendFileSync(`${folder}/${suite.name}.log`, output);
  if (counts[1]) console.log(`${output.slice(-20000)}\nFAILED: ${path}`);
  else for (const line of output.split('\n')) if (/^ *(skipped|.*SKIPPED|﹣)/i.test(line) && !/passed, |^ℹ/.test(line)) console.log(line);
}

await new Promise((done) => {
  let running = 0;
  const next = () => {
    while (running < slots) {
      const at = waiting.findIndex(({ suite }) => suite.running < suite.most);
      if (at < 0) break;
      const [item] = waiting.splice(at, 1);
      running += 1;
      item.suite.running += 1;
      run(item).finally(() => {
        running -= 1;
        item.suite.running -= 1;
        next();
      });
    }
    if (!running && !waiting.length) done();
  };
  next();
});
// Some files of the page have tests for the long suite alone; a suite that ran nothing has lost its tests.
for (const suite of suites.values())
  if (suite.paths.length && !suite.passed && !suite.failed && !suite.skipped) {
    suite.failed = 1;
    console.log(`FAILED: ${suite.name} ran no test`);
  }
await Promise.all(browsers.all.map((server) => server.close()));
writeFileSync(
  lastRun,
  JSON.stringify(Object.fromEntries(Object.entries(took).map(([path, seconds]) => [path, Math.round(seconds * 10) / 10])), null, 1),
);
const slowest = Object.entries(took)
  .sort(([, a], [, b]) => b - a)
  .slice(0, 12);
console.log(`slowest: ${slowest.map(([path, seconds]) => `${basename(path)} ${seconds.toFixed(1)} s`).join(', ')}`);
for (const { name, passed, failed, skipped } of suites.values())
  console.log(`total ${name}: ${passed} passed, ${failed} failed, ${skipped} skipped`);
process.exitCode = [...suites.values()].some(({ failed }) => failed) ? 1 : 0;
