// Signing in with a user and a password: the first administrator, sessions and their end, tokens, the commands `beamroom user` and `beamroom token`. --stub: grey pictures.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { mkdtempSync, rmSync, statSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import { bin, call, sleep, startDaemon, until, within } from './daemon.mjs';
import { misfit, schemaOfAnswer } from './schema.mjs';
import { Client } from './ws_client.mjs';

const password = 'correct horse';

describe('signing in here', () => {
  let data, daemon, description;
  const start = async () => {
    daemon = await startDaemon({ data, args: ['--sign-in', 'local', '--stub'] });
  };
  before(async () => {
    data = mkdtempSync(join(tmpdir(), 'beamroom-sign-in-'));
    await start();
    description = (await call(`${daemon.url}/api/v1/openapi.json`)).json;
  });
  after(async () => {
    await daemon?.stop();
    rmSync(data, { recursive: true, force: true });
  });

  const api = (path, method, body, headers) => call(`${daemon.url}/api/v1${path}`, method, body, headers);
  const signIn = (user, secret = password) => api('/session', 'POST', { user, password: secret });
  const cookieOf = (answer) => ({ Cookie: answer.headers.get('set-cookie').split(';')[0] });
  const beamroom = (words, input = '') => {
    const { status, stdout, stderr } = spawnSync(join(bin, 'beamroom'), [...words, '--data', data], { input, encoding: 'utf8' });
    return { status, stdout, stderr };
  };
  /** Holds the answer to its description. */
  const described = async (path, method, body, headers) => {
    const answer = await api(path, method, body, headers);
    const schema = schemaOfAnswer(description, method, `/api/v1${path}`, answer.status);
    assert.ok(schema?.$ref, answer.text);
    assert.equal(misfit(schema, answer.json, description.components.schemas), '');
    return answer;
  };

  it('the first administrator is made with the secret of the log, once', async () => {
    const [, token] = await until(() => /\/signin\/first#([0-9a-f]{64})/.exec(daemon.log()), Boolean);
    const first = { user: 'ann', name: 'Ann Example', password };
    assert.equal((await api('/session/first', 'POST', { ...first, token: token.replace(/./, 'x') })).status, 401);
    assert.equal((await api('/session/first', 'POST', { ...first, token })).status, 204);
    assert.equal((await api('/session/first', 'POST', { ...first, user: 'eve', token })).json.code, 'first');
    assert.equal((await api('/session/first', 'POST', { ...first, user: 'eve', token, more: 1 })).json.code, 'unknown-field');
  });

  it('the cookie of a sign-in opens it, and ends with it', async () => {
    const nobody = await described('/session', 'GET');
    assert.deepEqual([nobody.json.sign_in, nobody.json.identity, nobody.json.idle_ends_ms], [['local'], null, null]);
    const begun = await described('/session', 'POST', { user: 'ann', password });
    assert.equal(begun.status, 201);
    const cookie = begun.headers.get('set-cookie');
    assert.match(cookie, /^beamroom=[0-9a-f]{64}; Path=\/; HttpOnly; SameSite=Strict$/);
    const { identity, idle_ends_ms: idle, ends_ms: end } = begun.json;
    assert.deepEqual([identity.user, identity.name, identity.groups, identity.source], ['ann', 'Ann Example', ['admin'], 'password']);
    assert.equal(idle - identity.proved_ms, 30 * 60000);
    assert.equal(end - identity.proved_ms, 12 * 3600000);
    const mine = cookieOf(begun);
    assert.equal((await api('/session', 'GET', undefined, mine)).json.identity.user, 'ann');
    await sleep(5);
    assert.ok((await described('/session/input', 'POST', {}, mine)).json.idle_ends_ms > idle);
    const ended = await api('/session', 'DELETE', undefined, mine);
    assert.equal(ended.status, 204);
    assert.equal(ended.headers.get('clear-site-data'), '"cache", "cookies", "storage"');
    assert.match(ended.headers.get('set-cookie'), /beamroom=; Path=\/; HttpOnly; SameSite=Strict; Max-Age=0/);
    assert.equal((await api('/session', 'GET', undefined, mine)).json.identity, null);
    assert.equal((await api('/session/input', 'POST', {}, mine)).status, 401);
  });

  it('from a page of https the cookie is kept to https', async () => {
    const origin = daemon.url.replace('http:', 'https:');
    const refused = await api('/session', 'POST', { user: 'ann', password }, { Origin: 'https://evil.example' });
    assert.equal(refused.status, 403);
    const begun = await api('/session', 'POST', { user: 'ann', password }, { Origin: origin });
    if (begun.status === 201) assert.match(begun.headers.get('set-cookie'), /^__Host-beamroom=[0-9a-f]{64}; .*; Secure$/);
    else assert.equal(begun.status, 403); // it came without TLS, so this is not its origin
  });

  it('wrong passwords are counted alike for users who are there and who are not', async () => {
    for (const user of ['bob', 'nobody-at-all']) {
      if (user === 'bob') assert.equal(beamroom(['user', 'add', 'bob'], `${password}\n`).status, 0);
      for (let left = 4; left >= 0; left--) {
        const { status, json } = await signIn(user, 'wrong horse');
        assert.deepEqual([status, json.code, json.detail_values], [401, 'password', { tries_left: left, pause_s: 60 }]);
      }
      const paused = await signIn(user);
      assert.deepEqual([paused.status, paused.json.code], [429, 'pause']);
      const seconds = Number(paused.headers.get('retry-after'));
      assert.ok(seconds > 50 && seconds <= 60, `${seconds}`);
    }
    const mine = cookieOf(await signIn('ann'));
    const { rows } = await until(
      async () => (await api('/audit?action=sign-in-refused', 'GET', undefined, mine)).json,
      ({ rows }) => rows.length >= 2,
    );
    const told = rows.map(({ user, result, detail }) => [user, result, detail.what]);
    assert.deepEqual(told.sort(), [
      ['', 'refused', 'password'], // a name that is nobody's may be a password
      ['bob', 'refused', 'password'],
    ]); // and more of the same, as a number, after a minute
  });

  it('the password is given again to confirm', async () => {
    const begun = await signIn('ann');
    const mine = cookieOf(begun);
    assert.equal((await api('/session/confirm', 'POST', { password: 'wrong horse' }, mine)).json.code, 'password');
    const confirmed = await described('/session/confirm', 'POST', { password }, mine);
    assert.ok(confirmed.json.identity.proved_ms > begun.json.identity.proved_ms);
    assert.equal((await api('/session/confirm', 'POST', { password })).status, 401);
  });

  it('a stream of pictures and one of events end with the sign-in that they began with', async () => {
    const plans = await until(
      async () => (await api('/plans', 'GET', undefined, cookieOf(await signIn('ann')))).json.plans,
      ({ length }) => length > 0,
    );
    const { id } = (await api('/rooms', 'POST', { plan: plans[0].id }, cookieOf(await signIn('ann')))).json;
    const ends = [
      (mine) => api('/session', 'DELETE', undefined, mine),
      async () => assert.equal(beamroom(['user', 'passwd', 'ann'], `${password}\n`).status, 0), // which ends sign-ins
    ];
    for (const end of ends)
      for (const what of ['stream', 'events']) {
        const mine = cookieOf(await signIn('ann'));
        const other = cookieOf(await signIn('ann'));
        const entered = await Client.open(daemon.url, `/api/v1/rooms/${id}/ws`, other); // so that there are pictures
        entered.send({ type: 'hello', protocol: 2 });
        await entered.message('welcome');
        const answer = await fetch(`${daemon.url}/api/v1/rooms/${id}/${what}`, { headers: mine });
        assert.equal(answer.status, 200, what);
        const reader = answer.body.getReader();
        if (what === 'events') await reader.read(); // it runs
        await end(mine);
        const over = (async () => {
          while (!(await reader.read()).done);
          return true;
        })().catch(() => true);
        assert.equal(await within(60000, over), true, `${what} goes on`);
        entered.cut();
      }
  });

  it('users are managed by the socket in the data folder, which is the daemon’s alone', async () => {
    assert.equal(statSync(join(data, 'control.sock')).mode & 0o777, 0o600);
    assert.equal(beamroom(['user', 'add', 'cem', '--name', 'Cem Example', '--groups', 'physics,board'], `${password}\n`).status, 0);
    assert.match(beamroom(['user', 'add', 'cem'], `${password}\n`).stderr, /there is a user "cem" already/);
    assert.match(beamroom(['user', 'add', 'dee'], 'short\n').stderr, /8 characters at least/);
    assert.match(
      beamroom(['user', 'list']).stdout,
      /^cem\tCem Example\tenabled\tboard,physics$|^cem\tCem Example\tenabled\tphysics,board$/m,
    );
    const mine = cookieOf(await signIn('cem'));
    assert.equal(beamroom(['user', 'disable', 'cem']).status, 0);
    assert.equal((await api('/session', 'GET', undefined, mine)).json.identity, null);
    assert.equal((await signIn('cem')).json.code, 'password');
    assert.equal(beamroom(['user', 'enable', 'cem']).status, 0);
    assert.equal(beamroom(['user', 'passwd', 'cem'], 'battery staple\n').status, 0);
    assert.equal((await signIn('cem', 'battery staple')).status, 201);
    assert.match(beamroom(['user', 'disable', 'nobody-here']).stderr, /there is no user "nobody-here"/);
    const nowhere = spawnSync(join(bin, 'beamroom'), ['user', 'list', '--data', '/nonexistent'], { encoding: 'utf8' });
    assert.equal(nowhere.status, 1);
    assert.match(nowhere.stderr, /a daemon with --sign-in must run/);
  });

  it('only administrators list users and make tokens', async () => {
    const admin = cookieOf(await signIn('ann')),
      other = cookieOf(await signIn('cem', 'battery staple'));
    const { json } = await described('/users', 'GET', undefined, admin);
    assert.deepEqual(
      json.users.map(({ user }) => user),
      ['ann', 'bob', 'cem'],
    );
    assert.ok(!JSON.stringify(json).includes('argon2'));
    for (const [headers, status] of [
      [{}, 401],
      [other, 403],
    ]) {
      assert.equal((await api('/users', 'GET', undefined, headers)).status, status);
      assert.equal((await api('/tokens', 'GET', undefined, headers)).status, status);
      assert.equal((await api('/users/disable', 'POST', { user: 'ann', is_disabled: true }, headers)).status, status);
      assert.equal((await api('/users/password', 'POST', { user: 'ann', password }, headers)).status, status);
    }
  });

  it('a token is its user’s, until it is revoked', async () => {
    const admin = cookieOf(await signIn('ann'));
    const wanted = { user: 'ann', name: 'nightly', scope: ['read', 'admin'], folders: ['/srv/plans'], days: 30 };
    const { json: made } = await described('/tokens', 'POST', wanted, admin);
    assert.match(made.token, /^br_[0-9a-f]{12}_[0-9a-f]{64}$/);
    const bearer = (token) => ({ Authorization: `Bearer ${token}` });
    const { identity } = (await api('/session', 'GET', undefined, bearer(made.token))).json;
    assert.deepEqual([identity.user, identity.name, identity.source], ['ann', 'nightly', 'token']);
    const { json } = await described('/tokens', 'GET', undefined, admin);
    assert.ok(!JSON.stringify(json).includes(made.token.slice(-64)));
    assert.deepEqual([json.tokens[0].scope, json.tokens[0].folders], [['read', 'admin'], ['/srv/plans']]);
    for (const [change, pointer] of [
      [{ days: 367 }, '/days'],
      [{ days: 0.5 }, '/days'],
      [{ scope: ['all'] }, '/scope'],
      [{ scope: [] }, '/scope'],
      [{ user: 'a b' }, '/user'],
      [{ name: '' }, '/name'],
      [{ folders: [1] }, '/folders'],
      [{ more: 1 }, '/more'],
    ])
      assert.equal((await api('/tokens', 'POST', { ...wanted, ...change }, admin)).json.pointer, pointer);
    assert.equal((await api('/session', 'GET', undefined, bearer(`${made.token.slice(0, -1)}x`))).json.code, 'token');
    assert.equal((await api(`/tokens/${made.id}`, 'DELETE', undefined, admin)).status, 204);
    assert.equal((await api('/session', 'GET', undefined, bearer(made.token))).status, 401);
    const printed = beamroom(['token', 'create', '--user', 'ann', '--name', 'script', '--scope', 'read', '--days', '1']).stdout.trim();
    assert.equal((await api('/session', 'GET', undefined, bearer(printed))).json.identity.name, 'script');
    assert.match(beamroom(['token', 'list']).stdout, /\tann\tscript\tread\tuntil /);
    assert.equal(beamroom(['token', 'revoke', printed.split('_')[1]]).status, 0);
    assert.equal((await api('/session', 'GET', undefined, bearer(printed))).status, 401);
  });

  it('signing out ends a WebSocket with bye sign-in; signing in again leads back to the seat', async () => {
    let mine = cookieOf(await signIn('ann'));
    const { json: room } = await api('/rooms', 'POST', { plan: 'phantom' }, mine);
    const enter = async (hello) => {
      const client = await Client.open(daemon.url, `/api/v1/rooms/${room.id}/ws`, mine);
      client.send({ type: 'hello', protocol: 2, ...hello });
      return client;
    };
    const ann = await enter({});
    const { member, secret } = await ann.message('welcome');
    await api('/session', 'DELETE', undefined, mine);
    assert.equal((await ann.message('bye')).code, 'sign-in');
    await ann.until(() => ann.closeCode, 'the close');
    assert.equal(ann.closeCode, 1008);
    mine = cookieOf(await signIn('ann'));
    const again = await enter({ member, secret });
    assert.equal((await again.message('welcome')).member, member);
    assert.equal(beamroom(['user', 'passwd', 'ann'], `${password}\n`).status, 0); // a new password ends all sign-ins
    assert.equal((await again.message('bye')).code, 'sign-in');
  });

  it('more sign-ins at once than wait are to be sent again, and all come in', async () => {
    const enter = async () => {
      for (let n = 0; ; n++) {
        const answer = await signIn('ann');
        if (answer.status === 201) return n;
        assert.equal(answer.status, 429);
        await sleep(Number(answer.headers.get('retry-after')) * 1000);
      }
    };
    const tries = await Promise.all(Array.from({ length: 24 }, enter));
    assert.ok(Math.max(...tries) > 0, 'some had to wait');
  });

  it('sign-ins and tokens outlive the daemon; an open password or secret lies nowhere', async () => {
    const mine = cookieOf(await signIn('ann'));
    await daemon.stop();
    const found = spawnSync('grep', ['-rlaE', `${password}|${mine.Cookie.split('=')[1]}`, data], { encoding: 'utf8' });
    assert.equal(found.stdout, '');
    assert.ok(!daemon.log().includes(password) && !daemon.log().includes(mine.Cookie.split('=')[1]));
    await start();
    assert.equal((await api('/session', 'GET', undefined, mine)).json.identity.user, 'ann');
    assert.ok(!daemon.log().includes('/signin/first'));
  });

  it('a password is no word of a command line', () => {
    assert.equal(beamroom(['user', 'add', 'eve', password]).status, 2);
    const child = spawn(join(bin, 'beamroom'), ['user', 'add', 'eve', '--data', data], { stdio: ['pipe', 'ignore', 'ignore'] });
    assert.ok(child.spawnargs.every((word) => word !== password));
    child.kill();
  });
});
