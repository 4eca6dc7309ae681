// Acts in a room by a script over HTTP: members see it at once, with its author; it is kept, refused and undone as a message is.
// --stub: grey pictures.
import assert from 'node:assert/strict';
import { after, before, describe, it } from 'node:test';
import { call, openPlan, startDaemon, until } from './daemon.mjs';
import { FullDisk } from './full_disk.mjs';
import { misfit, schemaOfAnswer } from './schema.mjs';
import { Client } from './ws_client.mjs';

let daemon, description;
before(async () => {
  daemon = await startDaemon({ args: ['--stub'] });
  description = (await call(`${daemon.url}/api/v1/openapi.json`)).json;
  await openPlan(daemon.url, 'phantom');
});
after(async () => {
  assert.equal(await daemon.stop(), 0);
});

const path = (room, rest = '') => `/api/v1/rooms/${room}${rest}`;
const newRoom = async () => (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id;

/** Calls, and holds a JSON answer to the description. */
async function ask(room, rest, method = 'GET', body, headers) {
  const answer = await call(`${daemon.url}${path(room, rest)}`, method, body, headers);
  if (answer.status < 300 && answer.json) {
    const schema = schemaOfAnswer(description, method, path(room, rest).split('?')[0], answer.status);
    assert.ok(schema, `${method} ${rest} has a schema`);
    assert.equal(misfit(schema, answer.json, description.components.schemas), '', `${method} ${rest}`);
  }
  return answer;
}
const refused = ({ status, json }) => [status, json.type.split('/').at(-1), json.pointer ?? '', json.code ?? ''];

describe('notes over HTTP', () => {
  it('members see a note at once with its author, who is the member or the name that the call gives', async () => {
    const room = await newRoom();
    const ann = await Client.enter(daemon.url, room, { name: 'Ann' }),
      ben = await Client.enter(daemon.url, room, { name: 'Ben' });
    const mine = await ask(
      room,
      '/notes',
      'POST',
      { body: { text: 'Edge?', anchor: { point_mm: [1, 2, 3] } }, name: 'Nobody' },
      ben.headers,
    );
    assert.equal(mine.status, 201);
    const { item, by, input } = await ann.message('item', ({ id }) => id === mine.json.id);
    assert.deepEqual(item, mine.json);
    assert.deepEqual([by, input, item.author, item.author_name, item.version], [ben.welcome.member, 0, ben.welcome.member, 'Ben', 1]);
    const reply = await ask(room, '/notes', 'POST', { body: { text: 'Checked', parent: mine.json.id }, name: 'Planning script' });
    assert.equal(reply.status, 201);
    assert.deepEqual(
      [reply.json.author, reply.json.author_name, reply.json.body.parent],
      ['', 'Planning script', mine.json.id],
      'a name is no seat',
    );
    await ben.message('item', ({ id }) => id === reply.json.id);
    assert.deepEqual(
      (await ask(room, '/notes')).json.notes.map(({ id }) => id),
      [mine.json.id, reply.json.id],
    );
    for (const client of [ann, ben]) client.cut();
  });

  it('a change and a deletion need the author or the rights of a presenter, and the newest version', async () => {
    const room = await newRoom();
    const ann = await Client.enter(daemon.url, room, { name: 'Ann' }),
      ben = await Client.enter(daemon.url, room, { name: 'Ben' }),
      cem = await Client.enter(daemon.url, room, { name: 'Cem' });
    const { json: note } = await ask(room, '/notes', 'POST', { body: { text: 'one' } }, ben.headers);
    const at = `/notes/${note.id}`;
    const changed = await ask(room, at, 'PATCH', { version: 1, body: { text: 'two' } }, ben.headers);
    assert.deepEqual([changed.status, changed.json.version, changed.json.body.text], [200, 2, 'two']);
    await cem.message('item', ({ item }) => item?.version === 2);
    assert.deepEqual(refused(await ask(room, at, 'PATCH', { version: 2, body: { text: 'x' } }, cem.headers)), [
      403,
      'forbidden',
      '/item',
      '',
    ]);
    assert.deepEqual(refused(await ask(room, at, 'PATCH', { version: 1, body: { text: 'x' } }, ben.headers)), [
      409,
      'conflict',
      '/version',
      '',
    ]);
    assert.deepEqual(refused(await ask(room, at, 'PATCH', { body: { text: 'x' } }, ben.headers)), [
      422,
      'validation',
      '/version',
      'required',
    ]);
    assert.deepEqual(refused(await ask(room, at, 'DELETE', undefined, cem.headers)), [403, 'forbidden', '/item', '']);
    assert.deepEqual(refused(await ask(room, `${at}?version=1`, 'DELETE', undefined, ben.headers)), [409, 'conflict', '/version', '']);
    // what a page knows of an older version does not undo what the script did since
    ben.send({ type: 'item.put', item: note.id, version: 1, kind: 'note', body: note.body, input: 7 });
    assert.equal((await ben.message('problem', ({ input }) => input === 7)).problem.type, '/problems/conflict');
    const { json: reply } = await ask(room, '/notes', 'POST', { body: { text: 'so', parent: note.id } }, cem.headers);
    assert.equal((await ask(room, `${at}?version=2`, 'DELETE', undefined, ann.headers)).status, 204, 'a member of role presenter');
    for (const id of [reply.id, note.id]) await ben.message('item', (m) => m.id === id && m.item === null);
    assert.equal((await ask(room, at, 'DELETE', undefined, ann.headers)).status, 404);
    for (const client of [ann, ben, cem]) client.cut();
  });

  it('what is wrong is refused with its place', async () => {
    const room = await newRoom();
    const name = 'Script',
      body = { text: 'x' };
    const { json: note } = await ask(room, '/notes', 'POST', { body, name });
    const [json, right] = [{ 'Content-Type': 'application/json' }, { body, name }];
    for (const [sent, headers, want] of [
      [{ body }, json, [422, 'validation', '/name', 'required']],
      [{ body, name: '' }, json, [422, 'validation', '/name', 'length']],
      [{ body, name: 'x'.repeat(41) }, json, [422, 'validation', '/name', 'length']],
      [{ body, name: 'a\nb' }, json, [422, 'validation', '/name', 'pattern']],
      [{ body, name: 3 }, json, [422, 'validation', '/name', 'type']],
      [{ name }, json, [422, 'validation', '/body', 'required']],
      [{ body: {}, name }, json, [422, 'validation', '/body/text', 'required']],
      [{ body: { text: 'x', parent: 'i-0' }, name }, json, [422, 'validation', '/body/parent', 'unknown-id']],
      [{ body, name, kind: 'decision' }, json, [422, 'validation', '/kind', 'unknown-field']],
      [{ body, name, type: 'hello' }, json, [422, 'validation', '/type', 'unknown-field']],
      [{ body, name, item: note.id, version: 1 }, json, [422, 'validation', '/item', 'unknown-field']],
      [{ body, name, more: 1 }, json, [422, 'validation', '/more', 'unknown-field']],
      [[], json, [422, 'validation', '', 'type']],
      ['{', json, [400, 'json', '', '']],
      [right, { 'Content-Type': 'text/plain' }, [415, 'media-type', '', '']],
      [right, { ...json, 'Idempotency-Key': 'a b' }, [422, 'validation', '', 'pattern']],
      [right, { ...json, 'Idempotency-Key': 'x'.repeat(201) }, [422, 'validation', '', 'pattern']],
      [right, { ...json, 'Beamroom-Member': 'm1 0' }, [403, 'forbidden', '', 'member']],
    ])
      assert.deepEqual(refused(await ask(room, '/notes', 'POST', sent, headers)), want, JSON.stringify([sent, headers]));
    assert.deepEqual((await ask(room, '/notes')).json.notes, [note]);
    assert.equal((await ask('none', '/notes', 'POST', right)).status, 404);
    assert.equal((await ask(room, '/notes/none', 'PATCH', { ...right, version: 1 })).status, 404);
    assert.equal((await ask(room, '/notes/none', 'DELETE')).status, 404);
  });

  it('in a room with links, who is no member writes notes, and changes none: who has no seat is not known again', async () => {
    const room = await newRoom();
    const ann = await Client.enter(daemon.url, room, { name: 'Ann' });
    const { json: hers } = await ask(room, '/notes', 'POST', { body: { text: 'hers' } }, ann.headers);
    const { json: link } = await ask(room, '/links', 'POST', { role: 'observer' }, ann.headers);
    const { json: own } = await ask(room, '/notes', 'POST', { body: { text: 'own' }, name: 'Script' });
    const changed = await ask(room, `/notes/${own.id}`, 'PATCH', { version: 1, body: { text: 'changed' }, name: 'Script' });
    assert.deepEqual([own.author, ...refused(changed)], ['', 403, 'forbidden', '/item', '']);
    for (const { id } of [own, hers])
      assert.deepEqual(refused(await ask(room, `/notes/${id}`, 'DELETE')), [403, 'forbidden', '/item', ''], id);
    assert.equal((await ask(room, `/notes/${own.id}`, 'DELETE', undefined, ann.headers)).status, 204);
    const olga = await Client.enter(daemon.url, room, { name: 'Olga', link: link.token });
    assert.deepEqual(refused(await ask(room, '/notes', 'POST', { body: { text: 'x' } }, olga.headers)), [403, 'forbidden', '', 'role']);
    for (const client of [ann, olga]) client.cut();
  });
});

describe('a call that is sent again', () => {
  it('with the same Idempotency-Key makes one note, also at once and after a restart', async () => {
    const own = await startDaemon({ args: ['--stub'] });
    const data = own.data;
    let now = own;
    try {
      await openPlan(now.url, 'phantom');
      const room = (await call(`${now.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id;
      const post = (text, key, name = 'Script') =>
        call(`${now.url}${path(room, '/notes')}`, 'POST', { body: { text }, name }, { 'Idempotency-Key': key });
      const both = await Promise.all([post('one', 'k-1'), post('one', 'k-1'), post('one', 'k-1')]);
      assert.equal(both.filter(({ status }) => status === 201).length, 1, 'one of them makes it');
      for (const { status, headers } of both)
        assert.ok([200, 201].includes(status) || (status === 503 && headers.get('retry-after')), `${status}`);
      const first = both.find(({ status }) => status === 201).json;
      const again = await post('one', 'k-1');
      assert.deepEqual([again.status, again.json], [200, first]);
      assert.deepEqual(refused(await post('another', 'k-1')), [409, 'conflict', '', 'key']);
      assert.equal((await post('one', 'k-2')).status, 201, 'another key');
      assert.equal((await post('one', 'k-1', 'Other script')).status, 201, "another caller's key");
      const ann = await Client.enter(now.url, room, { name: 'Ann' }),
        other = await call(
          `${now.url}${path(room, '/notes')}`,
          'POST',
          { body: { text: 'one' } },
          { ...ann.headers, 'Idempotency-Key': 'k-1' },
        );
      assert.equal(other.status, 201);
      ann.cut();
      const notes = (await call(`${now.url}${path(room, '/notes')}`)).json;
      assert.equal(notes.notes.length, 4);
      now.child.kill('SIGTERM');
      await new Promise((done) => now.child.on('exit', done));
      now = await startDaemon({ args: ['--stub'], data });
      await openPlan(now.url, 'phantom');
      assert.deepEqual((await call(`${now.url}${path(room, '/notes')}`)).json, notes, 'kept');
      const later = await until(
        () => post('one', 'k-1'),
        ({ status }) => status !== 503,
      );
      assert.deepEqual([later.status, later.json], [200, first]);
    } finally {
      if (now !== own) await now.stop();
      await own.stop();
    }
  });
});

describe('a call and the state of the room', () => {
  it('a room that plays a recording takes no note, a closed one none, and neither does a full disk', async (t) => {
    const disk = new FullDisk();
    if (disk.missing) {
      disk.remove();
      t.skip(disk.missing);
      return;
    }
    const own = await startDaemon({ data: disk.data, args: ['--stub'] });
    try {
      await openPlan(own.url, 'phantom');
      const room = (await call(`${own.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id;
      const at = `${own.url}${path(room, '/notes')}`;
      const note = { body: { text: 'x' }, name: 'Script' };
      const ann = await Client.enter(own.url, room, { name: 'Ann' });
      await ann.ready();
      ann.send({ type: 'recording.start' });
      await ann.message('recording');
      const { json: first } = await call(at, 'POST', note);
      ann.send({ type: 'recording.stop' });
      const { id } = await ann.message('recording', ({ state }) => state === 'stopped');
      const replay = (
        await until(
          () => call(`${own.url}/api/v1/rooms`, 'POST', { recording: { room, id } }),
          ({ status }) => status === 201,
        )
      ).json.id;
      assert.deepEqual(refused(await call(`${own.url}${path(replay, '/notes')}`, 'POST', note)), [409, 'conflict', '', '']);

      await ann.message('saved', ({ state }) => state === 'saved');
      disk.fill(own.child);
      let last;
      for (let n = 0; n < 400 && last?.status !== 507; n++)
        last = await call(at, 'POST', { body: { text: 'x'.repeat(1900) }, name: 'Script' }); // what is left of the last block is used up
      assert.deepEqual([last.status, last.json.type, last.json.code], [507, '/problems/storage', disk.code]);
      const n = (await call(at)).json.notes.length;
      assert.equal((await call(`${at}/${first.id}`, 'PATCH', { version: 1, ...note })).status, 507);
      assert.equal((await call(`${at}/${first.id}`, 'DELETE')).status, 507);
      assert.equal((await call(at, 'POST', note, { 'Idempotency-Key': 'k' })).status, 507);
      assert.equal((await call(at)).json.notes.length, n, 'nothing is half applied');
      disk.free(own.child);
      const made = await until(
        () => call(at, 'POST', note, { 'Idempotency-Key': 'k' }),
        ({ status }) => status < 300,
      );
      assert.equal((await call(at)).json.notes.filter((one) => one.id === made.json.id).length, 1);

      assert.equal((await call(`${own.url}${path(room)}`, 'DELETE', undefined, ann.headers)).status, 204);
      assert.equal((await call(at, 'POST', note)).status, 404);
      ann.cut();
    } finally {
      await own.stop();
      disk.remove();
    }
  });
});

describe('the other acts over HTTP', () => {
  it('saved views, the checklist, decisions and signatures', async () => {
    const room = await newRoom();
    const ann = await Client.enter(daemon.url, room, { name: 'Ann' }),
      ben = await Client.enter(daemon.url, room, { name: 'Ben' });
    await ann.ready();
    const saved = await ask(room, '/bookmarks', 'POST', { name: 'Script', body: { name: 'One' } }, { 'Idempotency-Key': 'view-1' });
    assert.equal(saved.status, 201);
    assert.deepEqual((await ann.message('item', ({ id }) => id === saved.json.id)).item, saved.json);
    const again = (body) => ask(room, '/bookmarks', 'POST', { name: 'Script', body }, { 'Idempotency-Key': 'view-1' });
    const second = await again({ name: 'One' });
    assert.deepEqual([second.status, second.json], [200, saved.json]);
    assert.deepEqual(refused(await again({ name: 'Two' })), [409, 'conflict', '', 'key']);
    const at = `/bookmarks/${saved.json.id}`;
    const renamed = await ask(room, at, 'PATCH', { name: 'Script', version: 1, body: { ...saved.json.body, name: 'Two' } });
    assert.deepEqual([renamed.status, renamed.json.body.name, renamed.json.body.token], [200, 'Two', saved.json.body.token]);
    assert.equal((await ask(room, `/notes/${saved.json.id}`, 'DELETE')).status, 404, 'a view is no note');
    assert.equal((await ask(room, at, 'DELETE')).status, 204);
    assert.deepEqual((await ask(room, '/bookmarks')).json, { bookmarks: [] });

    await until(
      () => ask(room, '/record'),
      ({ status }) => status === 200,
    );
    const check = { entry: 'registration', text: 'Plan', state: 'ok' },
      decision = { decision: 'accept', text: 'as shown' },
      signature = { name: 'A. Example', meaning: 'reviewed' };
    for (const [kind, body] of Object.entries({ checks: check, decisions: decision, signatures: signature, acceptances: { thing: 'x' } }))
      assert.deepEqual(refused(await ask(room, `/${kind}`, 'POST', { body })), [403, 'forbidden', '', 'seat'], kind);
    const ticked = await ask(room, '/checks', 'POST', { body: check }, ben.headers);
    assert.deepEqual([ticked.status, ticked.json.author_name, ticked.json.body.role], [201, 'Ben', 'reviewer']);
    assert.deepEqual(refused(await ask(room, `/checks/${ticked.json.id}`, 'DELETE')), [403, 'forbidden', '', 'seat']);
    assert.equal((await ask(room, '/record')).json.checklist.length, 1, 'nobody of the room unticks nothing');
    const wrong = await ask(room, `/checks/${ticked.json.id}`, 'PATCH', { version: 1, body: { ...check, state: 'issue' } }, ann.headers);
    assert.deepEqual([wrong.status, wrong.json.changed_name, wrong.json.body.state], [200, 'Ann', 'issue']);
    assert.deepEqual(refused(await ask(room, '/decisions', 'POST', { body: decision }, ben.headers)), [403, 'forbidden', '/kind', 'role']);
    const keyed = { ...ann.headers, 'Idempotency-Key': 'd-1' };
    const decided = await ask(room, '/decisions', 'POST', { body: decision }, keyed);
    assert.equal(decided.status, 201);
    assert.deepEqual((await ask(room, '/decisions', 'POST', { body: decision }, keyed)).json, decided.json);
    assert.equal((await ask(room, '/decisions', 'POST', { body: { ...decision, decision: 'reject' } }, keyed)).status, 409);
    assert.equal((await ask(room, '/signatures', 'POST', { body: signature }, ben.headers)).status, 201);
    assert.deepEqual(refused(await ask(room, '/acceptances', 'POST', { body: { thing: 'dose:x' } }, ben.headers)), [
      403,
      'not-presenter',
      '',
      '',
    ]);
    assert.deepEqual((await ask(room, '/acceptances')).json, { acceptances: [] });
    const { json: record } = await ask(room, '/record');
    assert.deepEqual([record.checklist.length, record.decisions.length, record.signatures.length], [1, 1, 1]);
    assert.equal((await ask(room, `/checks/${ticked.json.id}?version=2`, 'DELETE', undefined, ann.headers)).status, 204);
    for (const client of [ann, ben]) client.cut();
  });

  it('control, following and pointing are of members who are connected', async () => {
    const room = await newRoom();
    const ann = await Client.enter(daemon.url, room, { name: 'Ann' }),
      ben = await Client.enter(daemon.url, room, { name: 'Ben' });
    await ann.ready();
    const [a, b] = [ann.welcome.member, ben.welcome.member];
    const act = (rest, who, body = {}) => ask(room, rest, 'POST', body, who?.headers);
    const control = async () => (await ask(room, '/control')).json;
    await until(control, ({ presenter }) => presenter === a);
    assert.deepEqual(refused(await act('/control/take', null)), [403, 'forbidden', '', 'seat']);
    assert.deepEqual(refused(await act('/control/take', ben)), [403, 'not-presenter', '', '']);
    assert.equal((await act('/control/request', ben)).status, 204);
    await ann.message('control', ({ act: what, member }) => what === 'requested' && member === b);
    assert.deepEqual(await control(), { presenter: a, locked: false, requests: [b] });
    assert.equal((await act('/control/refuse', ann, { member: b })).status, 204);
    assert.equal((await act('/control/request', ben)).status, 429, 'not again for a while');
    assert.equal((await act('/control/lock', ann, { locked: true })).status, 204);
    assert.deepEqual(refused(await act('/control/give', ann, {})), [422, 'validation', '/member', 'required']);
    assert.deepEqual(refused(await act('/control/lock', ann, { locked: true, type: 'bye' })), [
      422,
      'validation',
      '/type',
      'unknown-field',
    ]);
    assert.equal((await act('/control/give', ann, { member: b })).status, 204);
    await ben.message('control', ({ act: what, by }) => what === 'given' && by === a);
    assert.deepEqual(await control(), { presenter: b, locked: false, requests: [] });

    assert.equal((await act('/follow', ann, { follow: true })).status, 204);
    assert.equal((await act('/follow/everyone', ben)).status, 204);
    assert.equal((await act('/look', ann, { point_mm: [1, 2, 3] })).status, 204);
    const { number } = await ben.message('look', ({ by, point_mm: point }) => by === a && point[2] === 3);
    assert.equal((await act('/look/come', ben, { number })).status, 204);
    await ann.message('look', ({ came }) => came.includes(b));
    assert.equal((await act('/pointer', ann, { view: 1, point_mm: [4, 5, 6] })).status, 204);
    await ben.message('pointer.at', ({ member, point_mm: point }) => member === a && point?.[0] === 4);

    ann.cut();
    const members = async () => (await ask(room, '/members')).json.members;
    await until(members, (list) => list.some(({ id, connected }) => id === a && !connected));
    assert.deepEqual(refused(await act('/look', ann, { point_mm: [1, 2, 3] })), [409, 'conflict', '', 'away']);
    assert.equal((await ask(room, '/notes', 'POST', { body: { text: 'still mine' } }, ann.headers)).json.author, a);
    ben.cut();
  });

  it('a meeting is recorded and its recording played', async () => {
    const room = await newRoom();
    const ann = await Client.enter(daemon.url, room, { name: 'Ann' });
    await ann.ready();
    const act = (where, rest, who, body = {}) => ask(where, rest, 'POST', body, who.headers);
    assert.equal((await act(room, '/recording/start', ann)).status, 204);
    assert.equal((await act(room, '/recording/start', ann)).status, 409);
    const { id } = await ann.message('recording');
    assert.equal((await act(room, '/recording/stop', ann)).status, 204);
    const made = await until(
      () => call(`${daemon.url}/api/v1/rooms`, 'POST', { recording: { room, id } }),
      ({ status }) => status === 201,
    );
    const ben = await Client.enter(daemon.url, made.json.id, { name: 'Ben' });
    await ben.message('replay');
    assert.equal((await act(made.json.id, '/control/take', ben)).status, 409);
    for (const [rest, body] of [
      ['/replay/play', { rate: 2 }],
      ['/replay/pause', {}],
      ['/replay/seek', { t_ms: 0 }],
    ])
      assert.equal((await act(made.json.id, rest, ben, body)).status, 204, rest);
    assert.equal((await act(made.json.id, '/replay/leave', ben)).status, 204);
    await ben.message('replay.at', ({ state }) => state === 'left');
    for (const client of [ann, ben]) client.cut();
  });

  it('links are listed without their tokens, and a revoked one lets nobody in', async () => {
    const room = await newRoom();
    const ann = await Client.enter(daemon.url, room, { name: 'Ann' });
    const post = async (body) => (await ask(room, '/links', 'POST', body, ann.headers)).json;
    const [one, two] = [await post({ role: 'observer' }), await post({ role: 'reviewer', one_use: true, expires_s: 60 })];
    const list = async () => (await ask(room, '/links', 'GET', undefined, ann.headers)).json.links;
    const links = await list();
    assert.deepEqual(
      links.map(({ id, role, one_use: oneUse, used }) => [id, role, oneUse, used]),
      [
        [one.id, 'observer', false, false],
        [two.id, 'reviewer', true, false],
      ],
    );
    assert.ok(links[1].expires_s > 0 && links[1].expires_s <= 60);
    assert.ok(![one, two].some(({ token }) => JSON.stringify(links).includes(token)));
    const ola = await Client.enter(daemon.url, room, { name: 'Ola', link: one.token });
    for (const [rest, method] of [
      ['/links', 'GET'],
      [`/links/${one.id}`, 'DELETE'],
    ])
      for (const headers of [{}, ola.headers])
        assert.deepEqual(refused(await ask(room, rest, method, undefined, headers)), [403, 'forbidden', '', 'role'], rest);
    assert.equal((await ask(room, `/links/${one.id}`, 'DELETE', undefined, ann.headers)).status, 204);
    assert.equal((await ask(room, `/links/${one.id}`, 'DELETE', undefined, ann.headers)).status, 404);
    assert.deepEqual(
      (await list()).map(({ id }) => id),
      [two.id],
    );
    const late = await Client.hello(daemon.url, room, { name: 'Late', link: one.token });
    assert.match((await late.message('bye')).reason, /not one of this room/);
    assert.equal((await ask(room, '/notes', 'GET', undefined, ola.headers)).status, 200, 'who came in by it stays');
    for (const client of [ann, ola, late]) client.cut();
  });
});
