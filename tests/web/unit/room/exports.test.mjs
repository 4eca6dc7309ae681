// Files and printouts of the page: the server is told first, and what it has not acknowledged is not made.
import assert from 'node:assert/strict';
import { beforeEach, test } from 'node:test';
import { load } from '../page.mjs';

const { exportFile, exportRows, printable, savePicture } = await load('room/exports.js');

// A saved file is let go of a minute later; the test does not wait for that.
const { setTimeout } = globalThis;
globalThis.setTimeout = (...given) => setTimeout(...given).unref();

let made, said;
beforeEach(() => {
  [made, said] = [[], []];
});
globalThis.document = {
  createElement: () => ({
    click() {
      made.push(this.download);
    },
  }),
  querySelector: () => ({}),
};
globalThis.URL.createObjectURL = () => 'blob:';
globalThis.print = () => {
  globalThis.onbeforeprint();
  made.push('print');
};

/** @param {(object|null)[]} answers one for each call: null, or the problem with which it is refused */
function worldThat(answers) {
  const calls = [];
  const call = async (method, path, { body, more }) => {
    calls.push([method, path, body, more['Beamroom-Member']]);
    assert.deepEqual(made, [], 'nothing is made before the server has answered');
    const problem = answers.length ? answers.shift() : null;
    if (problem) throw Object.assign(new Error(problem.detail), problem);
    return null;
  };
  return {
    calls,
    api: { call },
    room: { id: 'r1', identity: { member: 'm2', secret: 's' }, planId: { value: 'phantom' } },
    ui: { notify: (kind, text) => said.push([kind, text]) },
    clock: { setTimeout: (run) => run() },
  };
}

test('a file is made once the export is recorded, under the name that was recorded', async () => {
  const world = worldThat([]);
  await exportRows(world, 'probes', 'phantom-probes.csv', [['pin'], [1]]);
  assert.deepEqual(world.calls, [['POST', 'rooms/r1/exports', { what: 'probes', name: 'phantom-probes.csv' }, 'm2 s']]);
  assert.deepEqual([made, said], [['phantom-probes.csv'], []]);
});

test('the server may need time to know the revision of the files: the page asks again', async () => {
  const world = worldThat([{ type: '/problems/busy' }, { type: '/problems/busy' }]);
  await exportFile(world, 'beam-card', 'phantom.txt', 'x', 'text/plain');
  assert.equal(world.calls.length, 3);
  assert.deepEqual(made, ['phantom.txt']);
});

test('what the server refuses is not made, and the reason is said', async () => {
  await exportFile(
    worldThat([{ type: '/problems/storage', detail: 'the disk takes no more records now' }]),
    'dvh',
    'a.csv',
    '',
    'text/csv',
  );
  await printable(worldThat([{ type: '', detail: 'The server does not answer.' }]), 'printed-report', 'report')();
  assert.deepEqual(made, []);
  assert.deepEqual(said, [
    ['err', 'Not saved: the disk takes no more records now'],
    ['err', 'Not saved: The server does not answer.'],
  ]);
});

test('a printout is told once by its button, and also when the menu of the browser prints it', async () => {
  const world = worldThat([]);
  await printable(world, 'printed-record', 'record of room r1')();
  assert.deepEqual([made, world.calls.length], [['print'], 1]);
  made.length = 0;
  globalThis.onbeforeprint();
  assert.deepEqual(
    world.calls.map(([, , body]) => body),
    [
      { what: 'printed-record', name: 'record of room r1' },
      { what: 'printed-record', name: 'record of room r1' },
    ],
  );
});

test('a saved picture is asked for by the member, so that its row says who', async () => {
  const world = worldThat([]);
  const rooms = [];
  world.api.snapshot = async (room) => {
    rooms.push(room);
    return new Blob(['png']);
  };
  await savePicture(world, { kind: 'axial' }, {});
  assert.deepEqual([rooms, made.length], [[world.room], 1]);
  assert.match(made[0], /^phantom-axial-\d{8}T\d{6}Z\.png$/); // two of one view do not overwrite each other
});
