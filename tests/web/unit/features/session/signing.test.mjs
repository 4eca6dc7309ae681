// A signature after a sign-in at the hospital: what the form holds when it is written, in the room for which the proof was wanted. The form, the window and the server are fakes.
import assert from 'node:assert/strict';
import { afterEach, beforeEach, test } from 'node:test';
import { load } from '../../page.mjs';

const { forgetSigning, signing } = await load('features/session/signing.js');
const { openWindow } = await load('features/session/hospital.js');
const { linkOf } = await load('features/session/people_links.js');

const real = {
  FormData: globalThis.FormData,
  fetch: globalThis.fetch,
  BroadcastChannel: globalThis.BroadcastChannel,
  window: globalThis.window,
};
let told; // the channel's listener: somebody is done in the window
let proved; // proved_ms that the server tells
let isClosed;

beforeEach(() => {
  forgetSigning();
  isClosed = false;
  proved = 1000;
  const window = {
    close: () => {
      isClosed = true;
    },
  };
  globalThis.window = { open: () => window };
  globalThis.BroadcastChannel = class {
    set onmessage(look) {
      told = look;
    }
    close() {}
  };
  globalThis.fetch = async () =>
    new Response(JSON.stringify({ identity: { user: 'ann', source: 'proxy', proved_ms: proved } }), { status: 200 });
  globalThis.FormData = class extends Map {
    constructor(form) {
      super(Object.entries(form.fields));
    }
  };
});
afterEach(() => Object.assign(globalThis, real));

const makeSession = () => ({
  isOn: true,
  person: { value: { user: 'ann', name: 'Ann', source: 'proxy', proved_ms: 1000 } },
  waiting: { value: null, peek: () => null },
  goOn: () => null,
});
const makeForm = (fields) => ({ fields, isConnected: true, nResets: 0, reset: () => {} });

/** The functions in a template, from the outside in. */
const acts = ({ values = [] }) => values.flatMap((value) => (typeof value === 'function' ? [value] : value?.values ? acts(value) : []));
const wordsOf = ({ strings = [], values = [] }) =>
  [...strings, ...values.map((value) => (value?.strings ? wordsOf(value) : String(value)))].join(' ');
const isAsking = (drawn) => wordsOf(drawn).includes('Sign in with your hospital');

/** A room's form, whose first signature the server refuses until it is proved anew. */
function roomForm(room, written) {
  const answers = ['confirm', true];
  const write = async (body) => {
    written.push([room, body.meaning, body.corrects]);
    return answers.shift();
  };
  const session = makeSession();
  return () => signing(session, { room, isGuest: false, fields: '', note: '', write });
}

const submit = (draw, form) => acts(draw())[0]({ preventDefault() {}, target: form });
const atHospital = (draw, form) => acts(draw()).at(-1)({ currentTarget: { form } });
const settled = () => new Promise((done) => setImmediate(() => setImmediate(done)));

test('what is chosen in the form when the proof has come is signed, not what was there before', async () => {
  const written = [];
  const [draw, form] = [roomForm('a', written), makeForm({ meaning: 'reviewed', corrects: '' })];
  await submit(draw, form);
  assert.equal(isAsking(draw()), true);
  form.fields = { meaning: 'seen', corrects: 'i-7' };
  atHospital(draw, form);
  await told();
  assert.equal(written.length, 1, 'the old sign-in is no proof');
  assert.equal(isClosed, false);
  proved = 2000;
  await told();
  await settled();
  assert.deepEqual(written, [
    ['a', 'reviewed', ''],
    ['a', 'seen', 'i-7'],
  ]);
  assert.deepEqual([isClosed, isAsking(draw())], [true, false]);
});

test('another room asks for no proof of its own, and gets no signature of the one that was left', async () => {
  const written = [];
  const [a, b, form] = [roomForm('a', written), roomForm('b', written), makeForm({ meaning: 'reviewed' })];
  await submit(a, form);
  assert.deepEqual([isAsking(a()), isAsking(b())], [true, false]);
  atHospital(a, form);
  forgetSigning(); // the room is left
  proved = 2000;
  await told();
  await settled();
  assert.deepEqual([written.length, isAsking(a()), isAsking(b())], [1, false, false]);
});

test('a form that is gone when the proof comes is not signed', async () => {
  const written = [];
  const [draw, form] = [roomForm('a', written), makeForm({ meaning: 'reviewed' })];
  await submit(draw, form);
  atHospital(draw, form);
  form.isConnected = false;
  proved = 2000;
  await told();
  await settled();
  assert.deepEqual([written.length, isAsking(draw())], [1, false]);
});

test('a window for a first sign-in closes as soon as somebody is signed in', async () => {
  const facts = [];
  openWindow((answer) => facts.push(answer.identity.user));
  await told();
  assert.deepEqual([facts, isClosed], [['ann'], true]);
});

test('on a server that is open to everybody there is no form', () => {
  const drawn = signing({ isOn: false }, { room: 'a', isGuest: false, fields: '', note: '', write: () => {} });
  assert.match(wordsOf(drawn), /Nothing can be signed/);
  assert.deepEqual(acts(drawn), []);
});

test('a link for a display is for as many uses as it comes back; any other may be for one', () => {
  globalThis.FormData = real.FormData;
  const form = (role) => {
    const data = new FormData();
    for (const [name, value] of Object.entries({ role, expires: '3600', name: ' Wall ', one: 'on' })) data.set(name, value);
    return data;
  };
  assert.deepEqual(linkOf(form('wall')), { role: 'wall', expires_s: 3600, one_use: false, guests: false, name: 'Wall' });
  assert.equal(linkOf(form('reviewer')).one_use, true);
});
