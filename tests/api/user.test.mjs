// The user of the daemon and its renderers: when started by root an ordinary user; in any case without capabilities.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import {
  chmodSync,
  cpSync,
  existsSync,
  lstatSync,
  mkdirSync,
  mkdtempSync,
  readFileSync,
  readdirSync,
  rmSync,
  statSync,
  symlinkSync,
  writeFileSync,
} from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join, resolve } from 'node:path';
import { after, before, test } from 'node:test';
import { bin, call, demo, openPlan, startDaemon, web } from './daemon.mjs';

const isRoot = process.getuid() === 0;
const idOf = (name) => {
  try {
    return Number(execFileSync('id', ['-u', name], { stdio: ['ignore', 'pipe', 'ignore'] }));
  } catch {
    return undefined;
  }
};
const expected = idOf('beamroom') ?? idOf('nobody');
/** True if every user may enter all folders of the path. */
const isOpen = (path) => (statSync(path).mode & 0o001) !== 0 && (path === '/' || isOpen(dirname(path)));
const needsRoot = { skip: !isRoot && 'only root can become another user' };
const needsOpen = {
  skip: !isRoot
    ? 'only root can become another user'
    : ![bin, web, demo].every((path) => isOpen(resolve(path))) && 'the checkout lies where others may not go',
};

/** Uids, capabilities and NoNewPrivs of a process. */
function status(pid) {
  const text = readFileSync(`/proc/${pid}/status`, 'utf8');
  const field = (name) => new RegExp(`^${name}:\\s*(.*)$`, 'm').exec(text)[1].trim();
  return {
    uids: field('Uid').split(/\s+/).map(Number),
    sets: ['CapPrm', 'CapEff', 'CapInh', 'CapAmb'].map((name) => BigInt(`0x${field(name)}`)),
    bounding: BigInt(`0x${field('CapBnd')}`),
    noNewPrivs: field('NoNewPrivs'),
  };
}
function allRenderersOf(daemon) {
  // children are listed under the thread that started them
  return readdirSync(`/proc/${daemon.child.pid}/task`).flatMap((task) => {
    try {
      return readFileSync(`/proc/${daemon.child.pid}/task/${task}/children`, 'utf8').trim().split(/\s+/).filter(Boolean);
    } catch {
      return [];
    }
  });
}
const none = [0n, 0n, 0n, 0n];
const isUser = (found, uid) => assert.deepEqual(found.uids, [uid, uid, uid, uid]);

let home;
before(() => {
  home = mkdtempSync(join(tmpdir(), 'beamroom-user-'));
  chmodSync(home, 0o755);
});
after(() => rmSync(home, { recursive: true, force: true }));

test("started by root, daemon and renderer are an ordinary user's and have no capabilities", needsOpen, async () => {
  const daemon = await startDaemon();
  try {
    const own = status(daemon.child.pid);
    isUser(own, expected);
    assert.deepEqual(own.sets, none);
    assert.equal(own.bounding, 0n);
    assert.equal(own.noNewPrivs, '1');
    assert.equal((await openPlan(daemon.url, 'phantom')).state, 'done');
    const renderers = allRenderersOf(daemon);
    assert.equal(renderers.length, 1);
    const renderer = status(renderers[0]);
    isUser(renderer, expected);
    assert.deepEqual([renderer.sets, renderer.bounding], [none, 0n]);
    assert.equal(statSync(daemon.data).uid, expected);
    assert.equal(statSync(join(daemon.data, 'cache', 'phantom')).uid, expected);
    assert.match(daemon.log(), /running as user (beamroom|nobody)/);
  } finally {
    assert.equal(await daemon.stop(), 0);
  }
});

test(
  'a plan folder only root can reach keeps the daemon root, which is said with its name, and its renderers without capabilities',
  needsRoot,
  async () => {
    const plans = mkdtempSync(join(home, 'closed-'));
    cpSync(join(demo, 'phantom'), join(plans, 'phantom'), { recursive: true });
    const daemon = await startDaemon({ plans: [plans] });
    try {
      assert.match(daemon.log(), new RegExp(`staying root: user (beamroom|nobody) cannot reach --plans ${plans}`));
      isUser(status(daemon.child.pid), 0);
      assert.equal((await openPlan(daemon.url, 'phantom')).state, 'done');
      const renderers = allRenderersOf(daemon);
      assert.equal(renderers.length, 1);
      assert.deepEqual(status(renderers[0]).sets, none);
      assert.equal(status(renderers[0]).bounding, 0n);
      assert.equal(statSync(daemon.data).uid, 0);
    } finally {
      assert.equal(await daemon.stop(), 0);
    }
  },
);

test('a user that is named is held to: what it cannot reach is an error that names folder and user', needsRoot, async () => {
  const plans = mkdtempSync(join(home, 'closed-'));
  await assert.rejects(startDaemon({ plans: [plans], args: ['--user', 'nobody'] }), (error) => {
    assert.match(error.message, /ended with 1/);
    assert.match(error.message, new RegExp(`user nobody cannot reach --plans ${plans}; let him, or say --user root`));
    return true;
  });
  await assert.rejects(startDaemon({ args: ['--user', 'no-such-user'] }), /there is no user no-such-user/);
});

test('--user root stays root and says so', needsRoot, async () => {
  const daemon = await startDaemon({ args: ['--user', 'root'] });
  isUser(status(daemon.child.pid), 0);
  assert.match(daemon.log(), /running as root, as --user root asks/);
  assert.equal(await daemon.stop(), 0);
});

test('from a working folder below one that only root may enter, paths from there on serve the ordinary user', needsRoot, async () => {
  const closed = mkdtempSync(join(home, 'roots-')),
    here = join(closed, 'checkout');
  mkdirSync(join(here, 'bin'), { recursive: true });
  for (const program of ['beamroomd', 'beamroom-render']) cpSync(join(bin, program), join(here, 'bin', program));
  cpSync(web, join(here, 'web'), { recursive: true });
  cpSync(demo, join(here, 'plans'), { recursive: true });
  mkdirSync(join(here, 'data'));
  for (const plans of ['plans', join(here, 'plans')]) {
    const daemon = await startDaemon({
      cwd: here,
      folders: { bin: join(here, 'bin'), web: 'web' },
      plans: [plans],
      data: plans === 'plans' ? 'data' : join(here, 'data'),
    });
    try {
      isUser(status(daemon.child.pid), expected);
      assert.equal((await call(`${daemon.url}/`)).status, 200);
      assert.equal((await openPlan(daemon.url, 'phantom')).state, 'done');
      isUser(status(allRenderersOf(daemon)[0]), expected);
      assert.ok(existsSync(join(here, 'data', 'cache', 'phantom')));
    } finally {
      assert.equal(await daemon.stop(), 0);
    }
  }
});

test("what an earlier daemon wrote as root is given to the user, and nobody else's folder is", needsOpen, async () => {
  const data = join(home, 'data'),
    other = join(home, 'other');
  mkdirSync(join(data, 'cache', 'phantom'), { recursive: true, mode: 0o700 });
  writeFileSync(join(data, 'cache', 'phantom', 'plan.cache'), 'old', { mode: 0o600 });
  let daemon = await startDaemon({ data });
  assert.equal((await openPlan(daemon.url, 'phantom')).state, 'done');
  assert.equal(statSync(join(data, 'cache', 'phantom')).uid, expected);
  assert.equal(statSync(data).uid, expected);
  assert.equal(await daemon.stop(), 0);

  mkdirSync(join(other, 'letters'), { recursive: true });
  daemon = await startDaemon({ data: other });
  assert.match(daemon.log(), /staying root: --data \S+other belongs to root and holds other things \(letters\)/);
  assert.equal(statSync(other).uid, 0);
  assert.equal(await daemon.stop(), 0);
  await assert.rejects(startDaemon({ data: other, args: ['--user', 'nobody'] }), /holds other things/);
});

test('a data folder named by a link is given with what root wrote in it later, and links inside are not followed', needsOpen, async () => {
  const data = join(home, 'linked-data'),
    link = join(home, 'link-to-data'),
    secret = join(home, 'secret');
  mkdirSync(data);
  writeFileSync(secret, 'of root', { mode: 0o600 });
  symlinkSync(data, link);
  let daemon = await startDaemon({ data: link });
  isUser(status(daemon.child.pid), expected);
  assert.equal(await daemon.stop(), 0);
  assert.equal(statSync(data).uid, expected);
  assert.equal(lstatSync(link).uid, 0);

  mkdirSync(join(data, 'cache', 'phantom')); // as a daemon with --user root leaves it
  writeFileSync(join(data, 'cache', 'phantom', 'plan.cache'), 'old', { mode: 0o600 });
  symlinkSync(secret, join(data, 'cache', 'phantom', 'elsewhere'));
  daemon = await startDaemon({ data: link });
  assert.equal(await daemon.stop(), 0);
  assert.equal(statSync(join(data, 'cache', 'phantom')).uid, expected);
  assert.equal(statSync(join(data, 'cache', 'phantom', 'plan.cache')).uid, expected);
  assert.equal(statSync(secret).uid, 0);
});

test("started by another user nothing changes but the renderer's capabilities", { skip: isRoot && 'started by root' }, async () => {
  const daemon = await startDaemon({ args: ['--user', 'nobody'] });
  isUser(status(daemon.child.pid), process.getuid());
  assert.equal((await openPlan(daemon.url, 'phantom')).state, 'done');
  assert.deepEqual(status(allRenderersOf(daemon)[0]).sets, none);
  assert.equal(await daemon.stop(), 0);
});
