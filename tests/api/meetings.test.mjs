// A meeting of three cases over HTTP and WebSocket: who sees it, who goes along, who waits outside, links, minutes, and all of it after a kill.
// --stub: grey pictures.
import assert from 'node:assert/strict';
import { cpSync, mkdirSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { call, demo, startDaemon, until } from './daemon.mjs';
import { FullDisk } from './full_disk.mjs';
import { casesOnDisk } from './on_disk.mjs';
import { Client } from './ws_client.mjs';

const password = 'correct horse';

test('on a full disk nothing of a meeting is accepted, and what was answered is there afterwards', async (t) => {
  const disk = new FullDisk();
  if (disk.missing) {
    disk.remove();
    t.skip(disk.missing);
    return;
  }
  let daemon = await startDaemon({ data: disk.data, args: ['--stub'] });
  try {
    const api = (path, method, body) => call(`${daemon.url}/api/v1/meetings${path}`, method, body);
    const made = (await api('', 'POST', { name: 'Board', cases: [{ plan: 'phantom' }, { plan: 'phantom' }] })).json;
    const go = (from) => api(`/${made.id}/case`, 'POST', { case: 'next', from });
    assert.equal((await go(null)).status, 200);
    disk.fill(daemon.child);
    const rename = (name) => api(`/${made.id}`, 'PATCH', { name });
    let kept = 'Board';
    for (let n = 0; n < 200; n++) {
      const name = `Board ${n} ${'x'.repeat(60)}`; // what is left of the last block is used up
      const { status } = await rename(name);
      if (status !== 200) break;
      kept = name;
    }
    const refused = await go('c1');
    assert.deepEqual([refused.json.type, refused.json.code], ['/problems/storage', disk.code]);
    for (const answer of [
      await rename('Lost'),
      await api('', 'POST', { name: 'Lost' }),
      await api(`/${made.id}/links`, 'POST', { role: 'observer' }),
    ])
      assert.equal(answer.json.type, '/problems/storage');
    const { name, case: now, cases } = (await api(`/${made.id}`)).json;
    assert.deepEqual([name, now, cases[1].state], [kept, 1, 'open'], 'nothing has changed for those who look');
    disk.free(daemon.child);
    await until(
      () => go('c1'),
      ({ status }) => status === 200,
    );
    daemon.child.kill('SIGKILL');
    await new Promise((done) => daemon.child.on('exit', done));
    daemon = await startDaemon({ data: disk.data, args: ['--stub'] });
    const again = (await api(`/${made.id}`)).json;
    assert.deepEqual([again.name, again.case, (await api('')).json.meetings.length], [kept, 2, 1]);
  } finally {
    await daemon.stop();
    disk.remove();
  }
});

describe('A meeting of three cases', { concurrency: false }, () => {
  let folder, daemon, args, plans, pat, rae, zoe, mia, meeting, cases;
  const people = {};
  const api = (path, who = {}, method = 'GET', body) => call(`${daemon.url}/api/v1${path}`, method, body, who);
  const ok = async (...asked) => {
    const answer = await api(...asked);
    assert.ok(answer.status < 300, `${asked[2] ?? 'GET'} ${asked[0]}: ${answer.status} ${answer.text}`);
    return answer.json;
  };
  const signIn = async (user) => {
    const { status, headers } = await api('/session', {}, 'POST', { user, password });
    assert.equal(status, 201);
    return { Cookie: headers.get('set-cookie').split(';')[0] };
  };
  /** Opens a WebSocket and says hello. @returns {Promise<Client>} with `first`, the welcome or the bye */
  const enter = async (who, room, fields = {}) => {
    const client = await Client.open(daemon.url, `/api/v1/rooms/${room}/ws`, who);
    client.send({ type: 'hello', protocol: 2, ...fields });
    client.first = await client.until(() => client.messages.find(({ type }) => type === 'welcome' || type === 'bye'), 'an answer');
    return client;
  };
  const welcomed = async (...asked) => {
    const client = await enter(...asked);
    assert.equal(client.first.type, 'welcome', JSON.stringify(client.first));
    return client;
  };
  /** The next meeting.case that this client is told, and the seat for hello in it. */
  const toldCase = (client) => client.message('meeting.case', () => true, client.seen ?? 0);
  const seatIn = ({ member, secret }) => ({ member, secret });
  const membersOf = (client) => client.until(() => client.messages.findLast(({ type }) => type === 'members')?.members, 'members');
  const start = async () => {
    daemon = await startDaemon({ plans: [join(folder, 'a'), join(folder, 'b')], args, data: join(folder, 'data') });
  };

  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'beamroom-meetings-'));
    for (const name of ['a/one', 'b/secret', 'a/three']) {
      mkdirSync(join(folder, name), { recursive: true });
      cpSync(join(demo, 'phantom'), join(folder, name), { recursive: true });
    }
    mkdirSync(join(folder, 'data'));
    const grants = ['* pat planner', `${folder}/a rae reviewer`, `${folder}/a zoe observer`, '* mia planner'];
    args = ['--stub', '--sign-in', 'local', '--guest-links', ...grants.flatMap((line) => ['--grant', line])];
    await start();
    const token = await until(
      () => /signin\/first#([0-9a-f]{64})/.exec(daemon.log())?.[1],
      (found) => found,
    );
    assert.ok((await api('/session/first', {}, 'POST', { token, user: 'ada', name: 'Ada', password })).status < 300);
    const admin = await signIn('ada');
    people.admin = admin;
    for (const [user, name] of Object.entries({ pat: 'Pat Lee', rae: 'Rae', zoe: 'Zoe', mia: 'Mia' }))
      assert.equal((await api('/users', admin, 'POST', { user, name, password, groups: '' })).status, 204);
    [pat, rae, zoe, mia] = [await signIn('pat'), await signIn('rae'), await signIn('zoe'), await signIn('mia')];
    const listed = async (who, n) =>
      (
        await until(
          () => ok('/plans', who),
          (found) => found.plans.length === n,
        )
      ).plans.map(({ id }) => id);
    const [all, ofRae] = [await listed(pat, 3), await listed(rae, 2)];
    plans = [ofRae[0], all.find((id) => !ofRae.includes(id)), ofRae[1]];
  });
  after(async () => {
    assert.equal(await daemon?.stop(), 0);
    rmSync(folder, { recursive: true, force: true });
  });

  test('it is made by who presents or plans, kept when it is answered, and nobody else sees it', async () => {
    const body = {
      name: 'Tumour board',
      starts_ms: 1795000000000,
      cases: plans.map((plan) => ({ plan })),
      people: [{ who: 'rae' }, { who: 'zoe' }],
    };
    assert.equal((await api('/meetings', zoe, 'POST', { name: 'Mine' })).json.code, 'role');
    assert.equal((await api('/meetings', rae, 'POST', { ...body, cases: [] })).json.code, 'role');
    const made = await ok('/meetings', pat, 'POST', body);
    [meeting, cases] = [made.id, made.cases.map(({ id }) => id)];
    assert.deepEqual([made.state, made.case, made.n_cases, made.owner, made.starts_ms], ['planned', null, 3, 'pat', 1795000000000]);
    assert.deepEqual(made.may, { edit: true, advance: true });
    assert.deepEqual(
      made.cases.map(({ plan, room, state, spent_ms }) => [plan, room, state, spent_ms]),
      plans.map((plan) => [plan, null, 'open', 0]),
    );
    for (const [path, method, sent] of [
      ['', 'GET'],
      ['', 'PATCH', {}],
      ['', 'DELETE'],
      ['/case', 'POST', { case: 'next', from: null }],
      ['/minutes', 'GET'],
      ['/links', 'POST', { role: 'observer' }],
      ['/end', 'POST', {}],
    ]) {
      const [there, absent] = [
        await api(`/meetings/${meeting}${path}`, mia, method, sent),
        await api(`/meetings/m-zzzz-zzzz${path}`, mia, method, sent),
      ];
      assert.deepEqual(
        [there.status, there.text.replaceAll(meeting, 'ID')],
        [404, absent.text.replaceAll('m-zzzz-zzzz', 'ID')],
        path + method,
      );
    }
    assert.deepEqual((await ok('/meetings', mia)).meetings, []);
    assert.deepEqual(
      (await ok('/meetings', rae)).meetings.map(({ id, n_cases }) => [id, n_cases]),
      [[meeting, 3]],
    );
  });

  test('a case of a folder that somebody may not see is closed to them, without a name', async () => {
    const seen = await ok(`/meetings/${meeting}`, rae);
    assert.deepEqual(seen.may, { edit: false, advance: false });
    const { id, spent_ms, since_ms, ...rest } = seen.cases[1];
    assert.deepEqual(rest, {
      plan: null,
      label: null,
      patient: null,
      approval: null,
      room: null,
      state: 'closed',
      decided_ms: null,
      decision: null,
      does_not_fit: null,
    });
    assert.doesNotMatch(JSON.stringify(seen), new RegExp(plans[1]));
    assert.equal((await api(`/meetings/${meeting}`, rae, 'PATCH', { name: 'X' })).json.code, 'role');
    assert.equal((await api(`/meetings/${meeting}/case`, rae, 'POST', { case: 'next', from: null })).json.code, 'role');
  });

  test('limits are told, and nothing half applied', async () => {
    const wrong = async (body, code, who = pat) => {
      const { status, json } = await api('/meetings', who, 'POST', body);
      assert.deepEqual([status >= 400, json.code ?? ''], [true, code], JSON.stringify(body).slice(0, 80));
    };
    await wrong({}, 'required');
    await wrong({ name: ' ' }, 'range');
    await wrong({ name: 'ä'.repeat(81) }, 'range');
    await wrong({ name: 'a\nb' }, 'pattern');
    await wrong({ name: 'a', starts_ms: 'soon' }, 'range');
    await wrong({ name: 'a', extra: 1 }, 'unknown-field');
    await wrong({ name: 'a', cases: Array(41).fill({ plan: plans[0] }) }, '');
    await wrong({ name: 'a', people: [{ who: 'x', role: 'wall' }] }, 'enum');
    await wrong({ name: 'a', people: Array.from({ length: 101 }, (_, i) => ({ who: `u${i}` })) }, '');
    await wrong({ name: 'a', cases: [{ plan: plans[0], room: 'zzzz-zzzz' }] }, '');
    assert.equal((await ok('/meetings', pat)).meetings.length, 1);
    const made = await ok('/meetings', pat, 'POST', { name: 'ä'.repeat(80), cases: Array(40).fill({ plan: plans[0] }) });
    assert.equal((await api(`/meetings/${made.id}/cases`, pat, 'POST', { plan: plans[0] })).status, 429);
    assert.equal((await api(`/meetings/${made.id}`, pat, 'DELETE')).status, 204);
  });

  test('its agenda is put in order before and while it runs', async () => {
    const ids = async (...asked) => (await ok(...asked)).cases.map(({ id }) => id);
    const [a, b, c] = cases;
    const more = await ids(`/meetings/${meeting}/cases`, pat, 'POST', { plan: plans[2], before: b });
    const added = more.find((id) => !cases.includes(id));
    assert.deepEqual(more, [a, added, b, c]);
    assert.deepEqual(await ids(`/meetings/${meeting}/cases/${added}`, pat, 'PATCH', { before: null }), [a, b, c, added]);
    assert.deepEqual(await ids(`/meetings/${meeting}/cases/${added}`, pat, 'PATCH', { before: a }), [added, a, b, c]);
    assert.equal((await api(`/meetings/${meeting}/cases/${added}`, pat, 'PATCH', { before: 'c99' })).status, 404);
    assert.deepEqual(await ids(`/meetings/${meeting}/cases/${added}`, pat, 'DELETE'), cases);
  });

  test('the first case is entered once, however many press', async () => {
    const go = () => api(`/meetings/${meeting}/case`, pat, 'POST', { case: 'next', from: null });
    const answers = await Promise.all([go(), go(), go()]);
    assert.deepEqual(answers.map(({ status }) => status).sort(), [200, 409, 409]);
    assert.deepEqual([...new Set(answers.filter(({ status }) => status === 409).map(({ json }) => json.code))], ['from']);
    const now = await ok(`/meetings/${meeting}`, pat);
    assert.deepEqual([now.state, now.case, now.cases.map(({ state }) => state)], ['running', 1, ['now', 'open', 'open']]);
    people.room = now.cases[0].room;
  });

  test('links of the meeting let in, capped and as guests; who has none is told nothing', async () => {
    assert.equal((await api(`/meetings/${meeting}/links`, pat, 'POST', { role: 'nobody' })).json.code, 'enum');
    const link = await ok(`/meetings/${meeting}/links`, pat, 'POST', { role: 'reviewer', guests: true, name: 'surgery' });
    const wall = await ok(`/meetings/${meeting}/links`, pat, 'POST', { role: 'wall', expires_s: 31536000 });
    assert.equal(link.url, `/meetings/${meeting}#link=${link.token}`);
    const door = await ok(`/meetings/${meeting}/enter`, {}, 'POST', { link: link.token });
    assert.deepEqual([door.room, door.state, door.role], [people.room, 'running', 'reviewer']);
    assert.equal((await api(`/meetings/${meeting}/enter`, {}, 'POST', { link: '0'.repeat(32) })).status, 404);
    people.link = link;
    people.guest = await welcomed({}, door.room, { name: 'Dr. Guest', link: link.token });
    people.wall = await welcomed({}, door.room, { link: wall.token });
    people.wallLink = wall;
    people.pat = await welcomed(pat, people.room);
    people.rae = await welcomed(rae, people.room);
    people.zoe = await welcomed(zoe, people.room);
    assert.equal((await enter(mia, people.room)).first.type, 'bye');
    const { links } = await ok(`/meetings/${meeting}/links`, pat);
    assert.deepEqual(
      links.map(({ role, came }) => [role, came]),
      [
        ['reviewer', 1],
        ['wall', 1],
      ],
    );
    assert.doesNotMatch(JSON.stringify(links), new RegExp(link.token));
    const told = await people.rae.message('meeting');
    assert.deepEqual([told.meeting, told.n, told.of, told.now, told.may_advance], [meeting, 1, 3, cases[0], false]);
    assert.deepEqual([told.n_next, told.next_patient, told.next_plan], [2, '', ''], 'the next case is not open to her, and counted alone');
    assert.doesNotMatch(JSON.stringify(told), new RegExp(plans[1]));
    for (const who of ['pat', 'wall']) {
      const next = await people[who].message('meeting');
      assert.deepEqual([next.n_next, next.next_patient, next.next_plan], [2, 'PHANTOM', 'Phantom: modified Snyder head']);
    }
  });

  test('the presenter has it go on: who follows goes along, who may not see the case waits without being told of whom it is', async () => {
    people.pat.send({ type: 'present' });
    await people.pat.until(
      () => people.pat.messages.findLast(({ type }) => type === 'members')?.members.some((m) => m.presenting),
      'a presenter',
    );
    people.zoe.send({ type: 'view.open', view: 1, document: { kind: '3d', number: 1, size_px: [64, 64] }, follow: false });
    people.rae.send({ type: 'meeting.next', from: cases[0] });
    assert.equal((await people.rae.message('problem', ({ to }) => to === 'meeting.next')).problem.status, 403, 'of who does not present');
    for (const client of [people.pat, people.rae, people.zoe, people.guest, people.wall]) client.seen = client.messages.length;
    people.pat.send({ type: 'meeting.next', from: cases[0] });
    const [ofPat, ofRae, ofZoe, ofGuest, ofWall] = await Promise.all(
      ['pat', 'rae', 'zoe', 'guest', 'wall'].map((name) => toldCase(people[name])),
    );
    for (const closed of [ofRae, ofZoe]) {
      assert.deepEqual(
        [closed.open, closed.n, closed.of, closed.room, closed.to, closed.patient, closed.plan, closed.member],
        [false, 2, 3, '', '', '', '', ''],
      );
      assert.doesNotMatch(JSON.stringify(closed), new RegExp(plans[1]));
    }
    for (const along of [ofPat, ofGuest, ofWall]) assert.deepEqual([along.open, along.asks, along.n, along.to], [true, false, 2, cases[1]]);
    assert.ok(ofPat.plan);
    const room = ofPat.room;
    [people.pat2, people.guest2, people.wall2] = [
      await welcomed(pat, room, seatIn(ofPat)),
      await welcomed({}, room, seatIn(ofGuest)),
      await welcomed({}, room, seatIn(ofWall)),
    ];
    const list = await membersOf(people.pat2);
    const of = (name) => list.find((member) => member.name === name);
    assert.deepEqual([of('Pat Lee').presenting, of('Dr. Guest').is_guest, of('Dr. Guest').role], [true, true, 'reviewer']);
    assert.ok(list.some(({ role }) => role === 'wall'));
    for (const who of [rae, zoe]) assert.equal((await enter(who, room)).first.type, 'bye', 'not by the address either');
    assert.equal((await enter({}, room, { ...seatIn(ofPat), name: 'thief' })).first.type, 'bye', "a seat is its person's");
    people.room2 = room;
  });

  test('at the next case that is open to them they come back by themselves; who looks on their own is asked', async () => {
    people.zoe3 = people.zoe;
    for (const client of [people.pat2, people.rae, people.zoe, people.guest2]) client.seen = client.messages.length;
    people.guest2.send({ type: 'view.open', view: 1, document: { kind: '3d', number: 1, size_px: [64, 64] }, follow: false });
    await people.guest2.until(() => people.guest2.frames.length, 'a picture of their own');
    assert.equal((await people.pat2.message('meeting')).opens, true, 'whoever presents begins with the first saved view');
    people.pat2.send({ type: 'meeting.next', to: cases[2], from: cases[1] });
    const [ofPat, ofRae, ofZoe, ofGuest] = await Promise.all(['pat2', 'rae', 'zoe', 'guest2'].map((name) => toldCase(people[name])));
    assert.deepEqual([ofRae.open, ofRae.asks, ofRae.n], [true, false, 3]);
    assert.deepEqual([ofZoe.open, ofZoe.asks], [true, false], 'also of who looked on their own before');
    assert.deepEqual([ofGuest.open, ofGuest.asks, ofGuest.member, ofGuest.n], [true, true, '', 3]);
    people.guest2.seen = people.guest2.messages.length;
    people.guest2.send({ type: 'meeting.go', to: cases[2] });
    const seat = await toldCase(people.guest2);
    assert.deepEqual([seat.asks, seat.room], [false, ofPat.room]);
    people.room3 = ofPat.room;
    people.rae3 = await welcomed(rae, ofRae.room, seatIn(ofRae));
    assert.equal((await people.rae3.message('meeting')).opens, false, 'who does not present');
    people.pat3 = await welcomed(pat, ofPat.room, seatIn(ofPat));
    assert.equal((await people.pat3.message('meeting')).opens, true);
    const tab = await welcomed(pat, ofPat.room);
    assert.equal((await tab.message('meeting')).opens, false, 'a second time');
    tab.cut();
    people.guest3 = await welcomed({}, seat.room, seatIn(seat));
    const last = await people.rae3.message('meeting');
    assert.deepEqual([last.n_now, last.n_next, last.next_plan], [3, 0, ''], 'nothing is behind the last case');
    await ok(`/rooms/${people.room3}`, { ...pat, 'Beamroom-Member': `${people.pat3.first.member} ${people.pat3.first.secret}` }, 'PATCH', {
      name: 'Second look',
    });
    people.wall3 = await welcomed({}, people.room2, { link: people.wallLink.token }).catch(() => null);
    assert.equal(people.wall3, null, 'the link leads to the case of now alone');
  });

  test('a wall that is started anew at the address that it was given goes to the case of now', async () => {
    const link = await ok(`/rooms/${people.room}/links`, pat, 'POST', { role: 'wall' });
    const wall = await welcomed({}, people.room, { link: link.token });
    const told = await wall.message('meeting.case');
    assert.deepEqual([told.open, told.asks, told.n, told.room], [true, false, 3, people.room3]);
    const there = await welcomed({}, told.room, seatIn(told));
    assert.equal((await there.message('meeting')).n_now, 3);
    wall.cut();
    there.cut();
  });

  test('an ended link puts out who came by it in every room, and lets nobody in again', async () => {
    assert.equal((await api(`/meetings/${meeting}/links/${people.link.id}`, pat, 'DELETE')).status, 204);
    await people.guest3.message('bye');
    assert.equal((await api(`/meetings/${meeting}/enter`, {}, 'POST', { link: people.link.token })).status, 404);
    assert.equal((await enter({}, people.room3, { link: people.link.token, name: 'Dr. Guest' })).first.type, 'bye');
    assert.equal((await enter({}, people.room2, seatIn(people.guest2.first))).first.type, 'bye', 'nor by an old seat');
  });

  test('minutes: time and decision of each case, one attendance; after a kill the same', async () => {
    await until(
      () => api(`/plans/${plans[2]}/revision`, pat),
      ({ status }) => status === 200,
    );
    const decided = await until(
      () =>
        api(
          `/rooms/${people.room3}/decisions`,
          { ...pat, 'Beamroom-Member': `${people.pat3.first.member} ${people.pat3.first.secret}` },
          'POST',
          {
            body: { decision: 'accept', text: 'as planned' },
          },
        ),
      ({ status }) => status !== 503, // the revision of the files is being found out
    );
    assert.equal(decided.status, 201, decided.text);
    const check = (minutes) => {
      assert.deepEqual(
        minutes.cases.map(({ n, decision, is_open }) => [n, decision, is_open]),
        [
          [1, null, true],
          [2, null, true],
          [3, 'accept', true],
        ],
      );
      assert.deepEqual(
        minutes.cases.map(({ room_name }) => room_name),
        [null, null, 'Second look'],
      );
      assert.ok(minutes.cases.every(({ spent_ms, visits }) => spent_ms > 0 && visits.length === 1));
      const of = (name) => minutes.people.find((person) => person.name === name);
      assert.deepEqual(
        of('Rae').cases.map(({ n }) => n),
        [1, 3],
      );
      assert.deepEqual(
        of('Pat Lee').cases.map(({ n }) => n),
        [1, 2, 3],
      );
      assert.deepEqual([of('Dr. Guest').is_guest, of('Dr. Guest').cases.map(({ n }) => n)], [true, [1, 2, 3]]);
      assert.ok(!minutes.people.some(({ role }) => role === 'wall'));
    };
    check(await ok(`/meetings/${meeting}/minutes`, pat));
    const ofRae = await ok(`/meetings/${meeting}/minutes`, rae);
    assert.deepEqual([ofRae.cases[1].is_open, ofRae.cases[1].plan, ofRae.cases[1].label], [false, null, null]);
    assert.deepEqual(
      (await ok(`/meetings/${meeting}`, pat)).cases.map(({ state }) => state),
      ['left', 'left', 'now'],
    );
    await until(
      async () => (await ok(`/meetings/${meeting}`, pat)).cases[2].decision,
      (word) => word === 'accept',
    );
    await until(
      () => casesOnDisk(meeting, join(folder, 'data')), // who is there and what was decided is written a moment later
      ([, , third]) =>
        third.decision === 'accept' && ['Pat Lee', 'Rae', 'Dr. Guest'].every((name) => JSON.stringify(third.stays ?? []).includes(name)),
    );
    daemon.child.kill('SIGKILL');
    await new Promise((done) => daemon.child.on('exit', done));
    await start();
    await until(
      () => api(`/meetings/${meeting}`, pat),
      ({ status }) => status === 200,
    );
    check(await ok(`/meetings/${meeting}/minutes`, pat));
    people.back = await welcomed(rae, people.room3, seatIn(people.rae3.first));
    assert.deepEqual((await people.back.message('meeting')).n_now, 3);
  });

  test('who waits outside does so also after a restart, and comes along when a case became open to them while they were away', async () => {
    const go = (to, from) => ok(`/meetings/${meeting}/case`, pat, 'POST', { case: to, from });
    people.back.seen = people.back.messages.length;
    await go(cases[1], cases[2]);
    assert.equal((await toldCase(people.back)).open, false);
    assert.equal(await daemon.stop(), 0);
    await start();
    await until(
      () => api(`/meetings/${meeting}`, pat),
      ({ status }) => status === 200,
    );
    const waiting = await welcomed(rae, people.room3, seatIn(people.rae3.first));
    const told = await waiting.message('meeting');
    assert.deepEqual([told.waits, told.open, told.n_now, told.now], [true, false, 2, '']);
    waiting.cut();
    await go(cases[0], cases[1]);
    const again = await welcomed(rae, people.room3, seatIn(people.rae3.first));
    const along = await again.message('meeting.case');
    assert.deepEqual([along.open, along.asks, along.n, along.room], [true, false, 1, people.room]);
    const there = await welcomed(rae, along.room, seatIn(along));
    assert.deepEqual([(await there.message('meeting')).waits, (await there.message('meeting')).opens], [false, false]);
    await go(cases[2], cases[0]);
    again.cut();
    there.cut();
  });

  test('the audit has each case that it went to: who, which room and plan', async () => {
    const { rows } = await ok('/audit?action=meeting', people.admin);
    const of = (what) => rows.filter(({ detail }) => detail.meeting === meeting && detail.what === what);
    const went = of('case').reverse(); // the newest first
    assert.deepEqual(
      went.map(({ user, detail, room }) => [user, detail.case, room]),
      [0, 1, 2, 1, 0, 2].map((at) => ['pat', cases[at], [people.room, people.room2, people.room3][at]]),
    );
    assert.ok(went.every(({ plan, name, address }) => /^plan-[0-9a-f]{16}$/.test(plan) && name === 'Pat Lee' && address));
  });

  test('when it is over it stays readable, its agenda and links do not change any more', async () => {
    const over = await ok(`/meetings/${meeting}/end`, pat, 'POST', {});
    const [ended] = (await ok('/audit?action=meeting', people.admin)).rows.filter(({ detail }) => detail.what === 'ended');
    assert.deepEqual([ended.user, ended.detail.meeting], ['pat', meeting]);
    assert.deepEqual([over.state, over.case, over.may], ['over', null, { edit: false, advance: false }]);
    assert.deepEqual(
      over.cases.map(({ state }) => state),
      ['left', 'left', 'decided'],
    );
    assert.equal((await api(`/meetings/${meeting}/case`, pat, 'POST', { case: 'next', from: null })).json.code, 'over');
    assert.equal((await api(`/meetings/${meeting}/cases`, pat, 'POST', { plan: plans[0] })).json.code, 'over');
    assert.equal((await ok(`/meetings/${meeting}/enter`, {}, 'POST', { link: people.wallLink.token })).room, null);
    // after the kill above the folder of plans is read again: until then cases have no words
    const before = await until(
      () => ok(`/meetings/${meeting}/minutes`, pat),
      ({ cases }) => cases.every(({ is_open: isOpen, label, plan }) => !isOpen || label !== plan),
    );
    const { made_ms: _, ...again } = await ok(`/meetings/${meeting}/minutes`, pat);
    assert.deepEqual({ ...again, made_ms: before.made_ms }, before);
  });

  test('who presents one case to others is given no control in the room of another, and takes none; each room has one presenter, and nothing is lost', async () => {
    const made = await ok('/meetings', pat, 'POST', {
      name: 'Two rooms',
      cases: [plans[0], plans[2]].map((plan) => ({ plan })),
      people: [{ who: 'rae' }],
    });
    const { cases: begun } = await ok(`/meetings/${made.id}/case`, pat, 'POST', { case: 'next', from: null });
    const first = begun[0].room;
    const { room: second } = (await ok(`/meetings/${made.id}/cases/${begun[1].id}/room`, pat, 'POST', {})).cases[1];
    const presenters = async (client) =>
      (await client.until(() => client.messages.findLast(({ type }) => type === 'members')?.members, 'members'))
        .filter(({ presenting }) => presenting)
        .map(({ name, id }) => [name, id]);
    const presents = (client, name) =>
      client.until(
        () =>
          client.messages
            .findLast(({ type }) => type === 'members')
            ?.members.filter(({ presenting }) => presenting)
            .map((one) => one.name)
            .join() === name,
        `${name} presents`,
      );
    // one after the other: who is alone presents
    const patHere = await welcomed(pat, first);
    await presents(patHere, 'Pat Lee');
    const raeHere = await welcomed(rae, first);
    const raeThere = await welcomed(rae, second);
    await presents(raeThere, 'Rae');
    const patThere = await welcomed(pat, second);
    const scene = () => ok(`/rooms/${second}/scene`, pat);
    await patThere.message('renderer', ({ state }) => state === 'ready');
    raeThere.send({ type: 'scene.patch', input: 1, patch: { axes: { visible: true } } });
    await patThere.message('scene');
    const before = await scene();
    assert.equal(before.axes.visible, true);

    raeThere.send({ type: 'control.give', member: patThere.first.member });
    const refused = await raeThere.message('problem', ({ to }) => to === 'control.give');
    assert.deepEqual(
      [refused.problem.type, refused.problem.code, refused.problem.detail_code],
      ['/problems/conflict', 'presents', 'member-presents-case'],
    );
    assert.deepEqual(refused.problem.detail_values, { member: patThere.first.member, n: 1 });
    patThere.send({ type: 'control.take' });
    assert.equal((await patThere.message('problem', ({ to }) => to === 'control.take')).problem.code, 'presents');
    raeHere.send({ type: 'control.request' }); // she presents the other case, to Pat
    await patHere.message('control', ({ requests }) => requests.length === 1);
    patHere.send({ type: 'control.give', member: raeHere.first.member });
    const other = await patHere.message('problem', ({ to }) => to === 'control.give');
    assert.deepEqual([other.problem.code, other.problem.detail_values.n], ['presents', 2]);
    assert.deepEqual(
      [await presenters(raeHere), await presenters(patThere)],
      [[['Pat Lee', patHere.first.member]], [['Rae', raeThere.first.member]]],
    );
    assert.deepEqual(await scene(), before, 'what she prepared is there');
    assert.deepEqual(patHere.messages.findLast(({ type }) => type === 'control').requests, [raeHere.first.member], 'her request stands');

    // nobody looks on in the second room: what is there is hers to prepare, and she may have control here
    patThere.cut();
    await raeThere.until(
      () =>
        raeThere.messages.findLast(({ type }) => type === 'members')?.members.every(({ name, connected }) => name === 'Rae' || !connected),
      'Pat is away',
    );
    patHere.send({ type: 'control.give', member: raeHere.first.member });
    await presents(patHere, 'Rae');

    // the meeting goes on to the second case: Rae presents there by the seat that she came with, and no more by the one that she had
    raeHere.send({ type: 'meeting.next', from: begun[0].id });
    const seat = await raeHere.message('meeting.case');
    assert.equal(seat.room, second);
    const raeCame = await welcomed(rae, second, seatIn(seat));
    await raeThere.until(
      () =>
        raeThere.messages
          .findLast(({ type }) => type === 'members')
          ?.members.filter(({ presenting }) => presenting)
          .map(({ id }) => id)
          .join() === seat.member,
      'one seat presents',
    );
    assert.deepEqual(await scene(), before);
    for (const client of [patHere, raeHere, raeThere, raeCame]) client.cut();
  });
});
