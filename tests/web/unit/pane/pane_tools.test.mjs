// Input in a pane for the chosen tool: nothing else acts in the place of one whose code is still being loaded.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../page.mjs';

const { signal } = await load('../lib/signals-core.js');
const { PaneTools, addTool } = await load('pane/pane_tools.js');

test("a drag that began before its tool was loaded moves nothing; the next one is the tool's", () => {
  const seen = [];
  const told = (who) => Object.fromEntries(['start', 'move', 'tap'].map((name) => [name, (mode) => seen.push([who, name, mode]) > 0]));
  const ui = { tool: signal('beam') };
  const tools = new PaneTools({ ui, view: { kind: 'axial' } }, [told('part')]);
  const drag = (mode) => ['start', 'move'].map((name) => tools.take(name, mode, {}));

  assert.deepEqual(drag('primary'), [true, true]);
  assert.equal(tools.take('tap', { shift: false }), true);
  assert.deepEqual(seen, [], 'the crosshair, or what else stands there, does not move');
  drag('pan');
  assert.deepEqual(
    seen.splice(0),
    [
      ['part', 'start', 'pan'],
      ['part', 'move', 'pan'],
    ],
    'other buttons act as ever',
  );

  tools.take('start', 'primary', {});
  addTool('beam', () => told('beam'));
  assert.equal(tools.take('move', 'primary', {}), true);
  assert.deepEqual(seen, [], 'half a drag moves nothing either');
  drag('primary');
  assert.deepEqual(seen.splice(0), [
    ['beam', 'start', 'primary'],
    ['beam', 'move', 'primary'],
  ]);

  ui.tool.value = 'crosshair';
  drag('primary');
  assert.deepEqual(seen, [
    ['part', 'start', 'primary'],
    ['part', 'move', 'primary'],
  ]);
});
