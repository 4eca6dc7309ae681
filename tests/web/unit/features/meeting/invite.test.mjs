// Links of a meeting: what one meeting answers is never shown under another.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../../page.mjs';
import { drawn } from '../../template.mjs';

const { beginInvite, inviteForm } = await load('features/meeting/invite.js');

globalThis.location ??= { origin: 'http://beamroom.test' };

/** A meeting that answers what it is asked when it is told to. */
function meetingCalled(name) {
  const asked = [];
  const call = (method, path) =>
    new Promise((answer, fail) => {
      asked.push({ what: `${method} ${path}`, answer, fail });
    });
  return { name, asked, call };
}

const settled = () => new Promise((done) => setImmediate(done));

/** Presses "Make link" with what the form has at first. */
function makeLink({ call }) {
  const { FormData: own } = globalThis;
  globalThis.FormData = class {
    get = () => 'reviewer';
    has = () => false;
  };
  drawn(inviteForm(call, false)).functions[0]({ preventDefault() {}, target: {} });
  globalThis.FormData = own;
}

test('a link that was asked for is shown under its own meeting', async () => {
  const a = meetingCalled('A');
  beginInvite(a.call);
  makeLink(a);
  a.asked[1].answer({ url: '/join/of-a' });
  await settled();
  assert.match(drawn(inviteForm(a.call, false)).text, /join\/of-a/);
  assert.deepEqual(
    a.asked.map(({ what }) => what),
    ['GET /links', 'POST /links', 'GET /links'],
  );
});

test('neither the link of another meeting, nor its refusal, nor its list is shown', async () => {
  for (const end of [(ask) => ask.answer({ url: '/join/of-a' }), (ask) => ask.fail(new Error('A is over'))]) {
    const [a, b] = [meetingCalled('A'), meetingCalled('B')];
    beginInvite(a.call);
    makeLink(a);
    beginInvite(b.call);
    end(a.asked[1]);
    a.asked[0].answer({ links: [{ id: 'link-of-a', role: 'observer', came: 0 }] });
    await settled();
    const { text } = drawn(inviteForm(b.call, false));
    assert.doesNotMatch(text, /of-a|A is over/);
    assert.deepEqual(
      a.asked.map(({ what }) => what),
      ['GET /links', 'POST /links'],
    );
  }
});
