// Starts the real daemon for a test, on a port of its own, with its own state folder.
import { spawn } from 'node:child_process';
import { existsSync, mkdtempSync, readdirSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { createInterface } from 'node:readline';
import { inspect } from 'node:util';
import { heldToSentences } from './sentences.mjs';
import { parseStrict } from './strict_json.mjs';

export const bin = process.env.BEAMROOM_BIN ?? resolve('build/release');
export const web = process.env.BEAMROOM_WEB ?? resolve('build/web');
export const demo = process.env.BEAMROOM_DEMO ?? resolve('build/demo/plans');
/** Real plans, when this machine has them; tests that need them skip otherwise. */
export const realData = [process.env.BEAMROOM_DATA, '../shared/data']
  .filter(Boolean)
  .map((p) => resolve(p))
  .find(existsSync);

/** data: an existing state folder, kept afterwards. cwd: working folder of the daemon. folders: programs and page, as seen from there.
 *  env: further environment variables.
 *  @returns {Promise<{url: string, data: string, child: import('node:child_process').ChildProcess, log: () => string, stop: () => Promise<number|null>}>} */
export async function startDaemon({ plans = [demo], args = [], data: given, cwd, folders = { bin, web }, env = {} } = {}) {
  const data = given ?? mkdtempSync(join(tmpdir(), 'beamroom-test-'));
  const child = spawn(
    join(folders.bin, 'beamroomd'),
    ['--listen', '127.0.0.1:0', '--data', data, '--web', folders.web, ...plans.flatMap((p) => ['--plans', p]), ...args],
    { cwd, stdio: ['ignore', 'pipe', 'pipe'], env: { ...process.env, ...env } },
  );
  let log = '';
  child.stderr.on('data', (text) => {
    log += text;
  });
  // its last words are read, too; a renderer that outlives it may hold the pipe open
  const ended = new Promise((done) => {
    child.on('close', (code) => done(code));
    child.on('exit', (code) => setTimeout(done, 2000, code).unref());
  });
  const url = await new Promise((ready, failed) => {
    createInterface({ input: child.stdout }).on('line', (line) => {
      const found = /^ready (https?:\S+)$/.exec(line);
      if (found) ready(found[1]);
    });
    child.on('exit', (code) => failed(new Error(`beamroomd ended with ${code}: ${log}`)));
  });
  const stop = async () => {
    child.kill('SIGTERM');
    let timer;
    const code = await Promise.race([
      ended,
      new Promise((late) => {
        timer = setTimeout(late, 60000, null);
      }),
    ]);
    clearTimeout(timer); /* or the test run would wait for it */
    if (code === null) child.kill('SIGKILL');
    if (!given) rmSync(data, { recursive: true, force: true });
    return code;
  };
  return { url, child, data, log: () => log, stop };
}

export const sleep = (ms) => new Promise((done) => setTimeout(done, ms));

/** Result of the promise, or false when it has not within that time. The timer does not hold up the end of the tests. */
export const within = (ms, promise) => Promise.race([promise, new Promise((done) => setTimeout(done, ms, false).unref())]);

/** Asks until the answer suits, and returns it. A minute is long, as machines may be slow and busy; then the wait itself fails. */
export async function until(ask, suits, ms = 60000) {
  const end = Date.now() + ms;
  for (;;) {
    const answer = await ask();
    if (suits(answer)) return answer;
    if (Date.now() > end) throw new Error(`not within ${ms} ms: ${suits}; the last answer: ${inspect(answer, { depth: 4 })}`);
    await sleep(30);
  }
}

/** fetch with JSON in and out; of an answer without an end it takes the head alone; throws when an answer of type JSON is none, or has a name twice in an object. */
export async function call(url, method = 'GET', body, headers = {}) {
  const answer = await fetch(url, {
    method,
    headers: { ...(body !== undefined && { 'Content-Type': 'application/json' }), ...headers },
    body: body === undefined || typeof body === 'string' ? body : JSON.stringify(body),
  });
  const type = answer.headers.get('content-type') ?? '';
  const isEndless = /^(multipart\/x-mixed-replace|text\/event-stream)/.test(type);
  if (isEndless) await answer.body.cancel();
  const text = isEndless ? '' : await answer.text();
  const json = /^application\/(.*\+)?json\b/.test(type) && text ? heldToSentences(parseStrict(text)) : undefined;
  return { status: answer.status, headers: answer.headers, type, text, json };
}

/** Opens a plan and waits until its job has ended. */
export async function openPlan(url, plan) {
  const opened = await call(`${url}/api/v1/plans/${plan}/open`, 'POST');
  if (opened.status !== 202) throw new Error(`open ${plan}: ${opened.text}`);
  return until(
    async () => (await call(`${url}/api/v1/jobs/${opened.json.id}`)).json,
    (job) => job.state !== 'running',
  );
}

/** Process ids of the renderers a daemon has. */
export function renderersOf(parent) {
  const look = (pid, name) => {
    try {
      return readFileSync(`/proc/${pid}/${name}`, 'latin1');
    } catch {
      return '';
    }
  };
  return readdirSync('/proc')
    .filter(
      (pid) =>
        /^\d+$/.test(pid) &&
        look(pid, 'status').includes(`\nPPid:\t${parent}\n`) &&
        /beamroom-render/.test(look(pid, 'cmdline')) &&
        !/--(scan|probe-gl)/.test(look(pid, 'cmdline')),
    )
    .map(Number);
}
