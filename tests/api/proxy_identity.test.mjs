// People whom a proxy names: believed at its Unix socket alone, in one form; grants are read again on SIGHUP. --stub: grey pictures.
import assert from 'node:assert/strict';
import { chmodSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { request } from 'node:http';
import { connect } from 'node:net';
import { tmpdir, userInfo } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { call, demo, startDaemon, until } from './daemon.mjs';
import { Client } from './ws_client.mjs';

const me = userInfo().username;
const grants = (...lines) => lines.map((line) => `grant = ${line}\n`).join('');

describe('Whom the proxy names', () => {
  let folder, path, config, daemon;
  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'beamroom-proxy-'));
    chmodSync(folder, 0o777); // the daemon may give root up
    path = join(folder, 'http.sock');
    config = join(folder, 'beamroomd.conf');
    writeFileSync(config, grants('* anna observer', '* @chiefs admin'));
    daemon = await startDaemon({
      args: [
        '--stub',
        '--config',
        config,
        '--sign-in',
        'proxy',
        '--listen',
        `unix:${path}`,
        '--proxy-user',
        me,
        '--public-name',
        'beamroom.example',
      ],
    });
  });
  after(async () => {
    assert.equal(await daemon?.stop(), 0);
    rmSync(folder, { recursive: true, force: true });
  });

  /** One request of the proxy. headers: pairs, so that a name may come twice. */
  const ask = (at, headers = [], method = 'GET') =>
    new Promise((done, failed) => {
      request(
        {
          socketPath: path,
          path: at,
          method,
          headers: [['Host', 'beamroom.example'], ['X-Forwarded-For', '192.0.2.7'], ...headers].flat(),
        },
        (answer) => {
          let text = '';
          answer.on('data', (part) => (text += part));
          answer.on('end', () =>
            done({
              status: answer.statusCode,
              headers: answer.headers,
              text,
              json: /json/.test(answer.headers['content-type']) ? JSON.parse(text) : null,
            }),
          );
        },
      )
        .on('error', failed)
        .end();
    });
  /** Writes the configuration, has it read again, and waits for the line in the log. */
  const reload = async (text, words) => {
    const before = daemon.log().length;
    writeFileSync(config, text);
    daemon.child.kill('SIGHUP');
    await until(
      () => daemon.log().slice(before),
      (log) => words.test(log),
    );
  };
  const user = (name) => [['X-Beamroom-User', name]];

  test('has name, groups and time of sign-in; nobody else has one', async () => {
    const { status, json } = await ask('/api/v1/session', [
      ['X-Beamroom-User', 'anna'],
      ['X-Beamroom-Name', 'Ännchen Berg'].map((text) => Buffer.from(text).toString('latin1')),
      ['x-beamroom-groups', 'physics, planners'],
      ['X-Beamroom-Auth-Time', '1795000000'],
    ]);
    assert.equal(status, 200);
    assert.deepEqual(json.sign_in, ['proxy']);
    assert.equal(json.open_to_everybody, false);
    const { user: id, name, groups, source, proved_ms } = json.identity;
    assert.deepEqual([id, name, groups, source, proved_ms], ['anna', 'Ännchen Berg', ['physics', 'planners'], 'proxy', 1795000000000]);
    assert.equal((await ask('/api/v1/session')).json.identity, null);
    assert.equal((await ask('/api/v1/session', user(''))).json.identity, null);
    assert.equal((await call(`${daemon.url}/api/v1/session`)).json.identity, null);
    assert.equal((await ask('/')).status, 200, 'pages are free');
  });

  test('is refused in any other form, and anywhere else', async () => {
    for (const [what, headers] of [
      ['twice', [...user('anna'), ...user('anna')]],
      ['two users', [...user('anna'), ...user('bert')]],
      ['groups twice', [...user('anna'), ['X-Beamroom-Groups', 'a'], ['X-Beamroom-Groups', 'b']]],
      ['another spelling', [...user('anna'), ['X_Beamroom_User', 'bert']]],
      ['another spelling alone', [['X-Beamroom_Groups', 'admins']]],
      ['too long', user('a'.repeat(65))],
      ['a name too long', [...user('anna'), ['X-Beamroom-Name', 'a'.repeat(161)]]],
      ['a space', user('anna berg')],
      ['what Apache writes for nothing', user('(null)')],
      ['no time', [...user('anna'), ['X-Beamroom-Auth-Time', 'yesterday']]],
    ]) {
      const { status, json } = await ask('/api/v1/session', headers);
      assert.deepEqual([status, json.type], [400, '/problems/request'], what);
    }
    for (const at of ['/', '/api/v1/session', '/api/v1/plans'])
      assert.equal((await call(`${daemon.url}${at}`, 'GET', undefined, { 'X-Beamroom-User': 'anna' })).status, 400, at);
    const raw = connect(path); // no client of HTTP sends a control character
    raw.write('GET /api/v1/session HTTP/1.1\r\nHost: beamroom.example\r\nX-Beamroom-User: an\x01na\r\n\r\n');
    assert.match(await new Promise((done) => raw.once('data', (bytes) => done(bytes.toString()))), /^HTTP\/1\.1 400 /);
    raw.destroy();
  });

  test('may do what is granted, from the next request after SIGHUP on; a wrong line changes nothing', async () => {
    const plans = async (name) => (await ask('/api/v1/plans', user(name))).json.plans.length;
    await until(
      () => plans('anna'),
      (n) => n > 0,
    );
    assert.equal((await ask('/api/v1/plans')).status, 401);
    assert.equal(await plans('bert'), 0);
    // what stands in a wrong line may name a patient: the log has file and line alone
    const before = daemon.log().length;
    const unchanged = /grants: those in use stay: .*beamroomd\.conf, line 2 is wrong/;
    await reload(grants(`${demo} bert reviewer`, '/srv/Doe_Jane anna king'), unchanged);
    assert.doesNotMatch(daemon.log().slice(before), /king|Doe|bert/);
    assert.deepEqual([(await plans('anna')) > 0, await plans('bert')], [true, 0]);
    await reload(grants(`${demo} bert reviewer`, '* @chiefs admin'), /grants: read again: 1 new, 1 gone, 2 in use/);
    assert.deepEqual([await plans('anna'), (await plans('bert')) > 0], [0, true]);
    const rows = (await ask('/api/v1/audit?action=grants', [...user('cleo'), ['X-Beamroom-Groups', 'chiefs']])).json;
    const details = rows.rows.map(({ detail }) => detail);
    assert.deepEqual(
      details.find(({ added }) => added),
      { added: [`${demo} bert reviewer`], removed: ['* anna observer'] },
    );
    assert.match(details.find(({ refused }) => refused).refused, /king/);
  });

  test('meets others in a room; nobody does without being named', async () => {
    const headers = { Host: 'beamroom.example', Origin: 'https://beamroom.example' };
    const id = (await ask('/api/v1/plans', user('bert'))).json.plans[0].id;
    const post = (to, json) =>
      new Promise((done) => {
        const body = JSON.stringify(json);
        request(
          {
            socketPath: path,
            path: to,
            method: 'POST',
            headers: { ...headers, 'X-Beamroom-User': 'bert', 'Content-Type': 'application/json', 'Content-Length': body.length },
          },
          (answer) => {
            let text = '';
            answer.on('data', (part) => (text += part));
            answer.on('end', () => done({ status: answer.statusCode, json: JSON.parse(text) }));
          },
        ).end(body);
      });
    const made = await post('/api/v1/rooms', { plan: id });
    assert.equal(made.status, 201);
    const at = `/api/v1/rooms/${made.json.id}/ws`;
    const bert = await Client.open(daemon.url, at, { ...headers, 'X-Beamroom-User': 'bert' }, connect(path));
    bert.send({ type: 'hello', protocol: 2, name: 'Somebody else' });
    await bert.message('welcome');
    const { members } = await bert.message('members', ({ members: list }) => list.length === 1);
    assert.deepEqual([members[0].name, members[0].user], ['bert', 'bert']);
    const nobody = await Client.open(daemon.url, at, headers, connect(path));
    nobody.send({ type: 'hello', protocol: 2 });
    const bye = await nobody.message('bye');
    assert.equal(bye.code, 'sign-in');
    const row = (await ask(`/api/v1/rooms/${made.json.id}`, user('bert'))).json;
    assert.equal(row.id, made.json.id);

    const film = (await post(`/api/v1/plans/${id}/video`, { seconds: 1, fps: 2, view: { kind: '3d', size_px: [240, 240] } })).json;
    const job = `/api/v1/jobs/${film.id}`;
    const copy = async () => (({ status, json }) => [status, json?.code])(await ask(`${job}/video`, user('bert')));
    await until(
      async () => (await ask(job, user('bert'))).json,
      ({ state }) => state === 'done',
    );
    assert.deepEqual(await copy(), [200, undefined]);

    await reload(grants(`${demo} bert observer`, '* @chiefs admin'), /1 new, 1 gone/); // another role: comes in again
    assert.deepEqual((({ reason, retry_ms }) => ({ reason, retry_ms }))(await bert.message('bye')), {
      reason: 'you have another role here now',
      retry_ms: 0,
    });
    const again = await Client.open(daemon.url, at, { ...headers, 'X-Beamroom-User': 'bert' }, connect(path));
    again.send({ type: 'hello', protocol: 2 });
    await again.message('members', ({ members: list }) => list.some(({ user: id, role }) => id === 'bert' && role === 'observer'));
    assert.deepEqual(await copy(), [403, 'role'], 'an observer takes nothing away');
    await reload(grants('* @chiefs admin'), /0 new, 1 gone/);
    assert.equal((await copy())[0], 404);
    assert.deepEqual((({ reason, retry_ms }) => ({ reason, retry_ms }))(await again.message('bye')), {
      reason: 'you may not be in this room any more',
      retry_ms: null,
    });
    const absent = await ask('/api/v1/rooms/none-none', user('bert')),
      foreign = await ask(`/api/v1/rooms/${made.json.id}`, user('bert'));
    assert.deepEqual([foreign.status, foreign.json.type], [404, absent.json.type]);
  });
});

test('The start says what sign-in lacks', async () => {
  for (const [args, words] of [
    [['--sign-in', 'proxy'], /--sign-in proxy needs --listen unix:/],
    [['--sign-in', 'local', '--listen', '0.0.0.0:0'], /would carry passwords without encryption; give --tls-cert/],
    [['--sign-in', 'local', '--open-to-everybody'], /expected one of them/],
    [['--sign-in', 'ldap'], /expected none, local, proxy or local,proxy/],
    [['--grant', '* anna admin'], /--grant says who may do what, and nobody signs in here/],
    [['--sign-in', 'local', '--grant', 'anna admin'], /the command line.*anna admin/],
    [['--sign-in', 'local', '--proxy-user-header', 'Cookie'], /begins with X- or Remote-/],
    [['--listen', '0.0.0.0:0'], /nobody signs in here.*--sign-in local.*--open-to-everybody/],
  ])
    await assert.rejects(startDaemon({ args: ['--stub', ...args] }), words, args.join(' '));
});
