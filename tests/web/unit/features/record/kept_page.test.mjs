// The list of kept records: its rows are those of the search that stands above them.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../../page.mjs';
import { drawn } from '../../template.mjs';

const { listPage } = await load('features/record/kept_page.js');

const record = (id) => ({
  room: 'r',
  id,
  kind: 'decision',
  time_ms: 0,
  decision: 'accept',
  plan: 'p',
  patient: id,
  author: 'a',
  author_name: 'A',
});
const settled = () => new Promise((done) => setImmediate(done));

/** A list whose server gives these answers one after another; an error is thrown. */
function listOf(...answers) {
  const call = async () => {
    const answer = answers.shift();
    if (answer instanceof Error) throw answer;
    return answer;
  };
  let timer;
  const list = listPage({ call }, { setTimeout: (run) => (timer = run), clearTimeout() {} });
  const press = async (at) => {
    drawn(list.draw()).functions.at(at)();
    await settled();
  };
  const type = async (value) => {
    drawn(list.draw()).functions[0]({ target: { name: 'text', value } });
    timer();
    await settled();
  };
  return { list, press, type, text: () => drawn(list.draw()).text };
}

test('a search that fails leaves no rows of the one before under its words', async () => {
  const { list, type, text } = listOf({ records: [record('of-all')], more: true }, new Error('no answer'), {
    records: [record('of-b')],
    more: false,
  });
  list.start();
  await settled();
  assert.match(text(), /of-all/);
  await type('b');
  assert.match(text(), /no answer/);
  assert.doesNotMatch(text(), /of-all/);
  await type('b ');
  assert.match(text(), /of-b/);
  assert.doesNotMatch(text(), /no answer/);
});

test('rows stay when only those after them could not be had', async () => {
  const { list, press, text } = listOf({ records: [record('first')], more: true }, new Error('no answer'));
  list.start();
  await settled();
  await press(-1);
  assert.match(text(), /first/);
  assert.match(text(), /no answer/);
});
