// The commands of docs/api.md run as they stand there, in order, and answer what stands below them: of JSON the fields that are shown, numbers
// to 1 %, entries of a list in any place; of text all of it. Skipped where there is no curl.
import assert from 'node:assert/strict';
import { execFileSync, spawn } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, statSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { call, startDaemon, until } from './daemon.mjs';
import { parseStrict } from './strict_json.mjs';

const hasCurl = () => {
  try {
    return execFileSync('curl', ['--version']).length > 0;
  } catch {
    return false;
  }
};

/** The fences of a document: commands, each with the answer that follows it. @returns {{line: number, command: string, kind: string, answer: string}[]} */
function examples(text) {
  const fences = [...text.matchAll(/^```(\w+)\n([\s\S]*?)^```$/gm)].map((m) => ({
    kind: m[1],
    body: m[2],
    line: text.slice(0, m.index).split('\n').length,
  }));
  return fences.flatMap((fence, i) => {
    if (fence.kind !== 'sh') return [];
    const next = fences[i + 1];
    assert.ok(next && next.kind !== 'sh', `line ${fence.line}: no answer stands below the command`);
    return [{ line: fence.line, command: fence.body, kind: next.kind, answer: next.body }];
  });
}

/** Whether an answer has what is shown of it; else where it differs. */
function difference(shown, got, at = '') {
  if (Array.isArray(shown)) {
    if (!Array.isArray(got)) return `${at} is no list`;
    if (shown.length === 0 && got.length > 0) return `${at} is not empty`;
    for (const [i, entry] of shown.entries())
      if (!got.some((one) => !difference(entry, one)))
        return `${at}/${i}: none is ${JSON.stringify(entry)} in ${JSON.stringify(got).slice(0, 400)}`;
    return '';
  }
  if (shown && typeof shown === 'object') {
    if (!got || typeof got !== 'object') return `${at} is ${JSON.stringify(got)}`;
    for (const [name, value] of Object.entries(shown)) {
      if (!Object.hasOwn(got, name)) return `${at}/${name} is missing`;
      const found = difference(value, got[name], `${at}/${name}`);
      if (found) return found;
    }
    return '';
  }
  const isNear = typeof shown === 'number' && typeof got === 'number' && Math.abs(got - shown) <= 0.01 * Math.abs(shown);
  return shown === got || isNear ? '' : `${at} is ${JSON.stringify(got)}, shown is ${JSON.stringify(shown)}`;
}

const skip = hasCurl() ? false : 'curl is not installed';
describe('docs/api.md', () => {
  let daemon, folder, shell, ask;
  before(async () => {
    if (skip) return;
    daemon = await startDaemon();
    await until(
      async () => (await call(`${daemon.url}/api/v1/plans`)).json.plans,
      (plans) => plans.every(({ name, id }) => name !== id), // what lies in the folder is read after the start
    );
    folder = mkdtempSync(join(tmpdir(), 'beamroom-document-'));
    // one shell for all, so that what a command sets is there for the next one
    shell = spawn('bash', ['--norc'], { cwd: folder, env: { ...process.env, BEAMROOM: daemon.url }, stdio: ['pipe', 'pipe', 'pipe'] });
    let out = '',
      error = '',
      told;
    shell.stderr.on('data', (text) => (error += text));
    shell.stdout.on('data', (text) => {
      out += text;
      const end = /\n?<<end (\d+)>>\n$/.exec(out);
      if (!end) return;
      told({ text: out.slice(0, end.index), status: Number(end[1]), error });
      out = error = '';
    });
    ask = (command) =>
      new Promise((done) => {
        told = done;
        shell.stdin.write(`{ ${command.trimEnd()}\n} </dev/null\nprintf '\\n<<end %s>>\\n' $?\n`);
      });
  });
  after(async () => {
    shell?.kill();
    await daemon?.stop();
    if (folder) rmSync(folder, { recursive: true, force: true });
  });

  const all = examples(readFileSync('docs/api.md', 'utf8'));
  test('has commands', () => assert.ok(all.length >= 15));
  for (const { line, command, kind, answer } of all)
    test(`line ${line}: ${command.trim().split('\n').at(-1).trim().slice(0, 90)}`, { skip, timeout: 120000 }, async () => {
      const got = await ask(command);
      assert.equal(got.status, 0, `${got.error}\n${got.text}`);
      if (kind === 'json') assert.equal(difference(JSON.parse(answer), parseStrict(got.text)), '');
      else assert.equal(`${got.text.trim()}\n`, answer);
      const file = / -o (\S+\.\w+) /.exec(command)?.[1];
      if (file) assert.ok(statSync(join(folder, file)).size > 1000, file);
    });

  test('a wrong answer is seen', () => {
    assert.notEqual(difference({ a: [{ b: 1 }] }, { a: [{ b: 2 }] }), '');
    assert.notEqual(difference({ a: 'x' }, {}), '');
    assert.notEqual(difference([], [1]), '');
  });
});
