// The generator's check of who may do what: the shipped descriptions pass, and each mistake that could leave a call without
// a check is refused.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { questionRoutes } from '../../../../proto/gen/packets.mjs';
import { checkedRights, rightsSource, roomRoutes } from '../../../../proto/gen/rights.mjs';

const read = (name) => JSON.parse(readFileSync(new URL(`../../../../proto/${name}.json`, import.meta.url), 'utf8'));
const described = () => ({ rights: read('rights'), messages: read('messages'), http: read('http'), packets: read('packets') });
const check = ({ rights, messages, http, packets }) => checkedRights(rights, [...http.routes, ...questionRoutes(packets)], messages);
const routeOf = ({ http }, method, path) => http.routes.find((route) => route.method === method && route.path === path);
const questionOf = ({ packets }, name) => packets.questions.find((question) => question.name === name);

test('every route, message and question says what it needs, and the table has each', () => {
  const checked = check(described());
  const source = rightsSource(checked);
  for (const { method, path } of checked.routes) assert.ok(source.includes(`"${method}", "${path}", ACCESS_`), `${method} ${path}`);
  const rooms = roomRoutes(checked, read('messages'));
  assert.deepEqual(
    rooms.map(({ path }) => path).filter((path) => !path.startsWith('/api/v1/rooms/{room}')),
    [],
  );
  assert.ok(rooms.every(({ right }) => ['look', 'point', 'note', 'scene', 'control'].includes(right)));
});

const mistakes = [
  ['a route without', (all) => delete routeOf(all, 'GET', '/api/v1/plans').needs, /GET \/api\/v1\/plans: does not say what it needs/],
  [
    'a message without',
    (all) => delete all.messages.messages.find(({ name }) => name === 'pointer').needs,
    /pointer: does not say what it needs/,
  ],
  ['a question without', (all) => delete questionOf(all, 'dvh').needs, /\/dvh: does not say what it needs/],
  ['the field of before', (all) => (routeOf(all, 'GET', '/api/v1/rooms').right = 'look'), /"right" is the first word of "needs"/],
  ['an unknown right', (all) => (routeOf(all, 'GET', '/api/v1/rooms').needs = ['peek', 'none']), /unknown right "peek"/],
  ['an unknown subject', (all) => (routeOf(all, 'GET', '/api/v1/rooms').needs = ['look', 'house']), /unknown subject "house"/],
  ['a plan that is free', (all) => (routeOf(all, 'GET', '/api/v1/plans/{plan}').needs = ['free', 'none']), /is about a plan/],
  ['a room asked as a plan', (all) => (routeOf(all, 'GET', '/api/v1/rooms/{room}/scene').needs = ['look', 'plan']), /is about a room/],
  ["a job that is anybody's", (all) => (routeOf(all, 'GET', '/api/v1/jobs/{job}').needs = ['signed-in', 'none']), /is about a job/],
  ['a subject not in the address', (all) => (routeOf(all, 'GET', '/api/v1/plans').needs = ['look', 'plan']), /names no plan/],
  ['a right on nothing', (all) => (routeOf(all, 'POST', '/api/v1/plans').needs = ['plan', 'none']), /is one on something/],
  [
    'a right that rooms do not know',
    (all) => (routeOf(all, 'DELETE', '/api/v1/rooms/{room}').needs = ['close', 'room']),
    /no right in a room/,
  ],
  [
    'a call with less than its message',
    (all) => (routeOf(all, 'POST', '/api/v1/rooms/{room}/control/take').needs = ['look', 'room']),
    /needs its right/,
  ],
  [
    'two tables of roles that differ',
    (all) => (all.rights.rights.find(([word]) => word === 'control')[1] = 'reviewer'),
    /the other way round/,
  ],
];
for (const [about, change, sentence] of mistakes)
  test(`the generator refuses ${about}`, () => {
    const all = described();
    change(all);
    assert.throws(() => check(all), sentence);
  });
