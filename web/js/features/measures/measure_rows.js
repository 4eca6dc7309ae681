// The measures in the tree.
import { html } from '../../../lib/lit-html.js';
import { repeat } from '../../../lib/directives/repeat.js';
import { kindName } from './measures.js';
import { measureName, valueTexts } from './measure_words.js';
import { eye, name, treeRow } from '../../parts/tree_row.js';
import { say } from './drawn_words.js';

export const measuresOf = (scene) => Object.entries(scene?.measures ?? {});

export const showMeasure = ({ room, ui }, id, visible, event) =>
  room.patchScene({ measures: { [id]: { visible } } }, { view: ui.active.value, at: event.timeStamp });

export function measureRows(world) {
  const { room } = world;
  return repeat(
    measuresOf(room.scene.value),
    ([id]) => id,
    ([id, measure]) => {
      const [words, value] = [measureName(id, measure), valueTexts(world, id, measure)[0] ?? ''];
      const toggle = (event) => showMeasure(world, id, !measure.visible, event);
      return treeRow(
        world,
        { kind: 'measure', id, words: [words, value], title: kindName(measure.kind), isOn: measure.visible, toggle },
        html`
      ${eye(measure.visible, say.show({ measure: words }), say.showOrHide, !room.canChange.value, toggle)}${name(words)} <span class="tail">${value}</span>`,
      );
    },
  );
}
