// The oblique planes in the tree, and what makes, changes and opens them.
import { html } from '../../../lib/lit-html.js';
import { repeat } from '../../../lib/directives/repeat.js';
import { obliqueView } from '../../room/layout.js';
import { facing, freeId, maxObliques, newOblique, obliqueName } from '../../room/obliques.js';
import { icon } from '../../parts/icons.js';
import { showOblique } from '../../pane/pane_kind.js';
import { eye, name, treeRow } from '../../parts/tree_row.js';
import { say } from './words.js';

export const obliquesOf = ({ room }) => room.scene.value?.image.obliques ?? {};
export const isFull = (world) => Object.keys(obliquesOf(world)).length >= maxObliques;

export function obliqueNote(world) {
  const n = Object.keys(obliquesOf(world)).length;
  return n ? String(n) : '';
}

export function obliqueRows(world) {
  const { room } = world;
  const isDisabled = !room.canChange.value;
  const rows = Object.entries(obliquesOf(world));
  return html`${repeat(
    rows,
    ([id]) => id,
    ([id, oblique]) => {
      const words = obliqueName(id, oblique);
      const about = facing(oblique.normal);
      const toggle = (event) => change(world, id, { visible: !oblique.visible }, event);
      return treeRow(
        world,
        { kind: 'oblique', id, words: [words, about], title: say.faces({ plane: words, direction: about }), isOn: oblique.visible, toggle },
        html`
      ${eye(oblique.visible, say.show({ plane: words }), say.showOrHide, isDisabled, toggle)}${name(words)} <span class="tail clipped">${about}</span>
      <button class="eye" tabindex="-1" aria-label=${say.paneOf({ plane: words })} title=${say.pane} @click=${(event) => {
        event.stopPropagation();
        openOblique(world, id);
      }}>${icon('single')}</button>`,
      );
    },
  )}${treeRow(world, { kind: 'oblique', id: '', words: [say.newPlane, '…'], title: say.ways }, html`${icon('plane')}${name(say.addPlane)}`)}`;
}

// ---- changes ------------------------------------------------------------------------------------------------------------

export const change = ({ room, ui }, id, fields, event) =>
  room.patchScene({ image: { obliques: { [id]: fields } } }, { view: ui.active.value, at: event.timeStamp });

/** Makes a plane and chooses it; with an id, gives that plane another place. @param {{origin_mm: number[], normal: number[]}|null} plane */
export function setOblique(world, id, plane, event) {
  const { ui } = world;
  if (!plane) return void ui.notify('warn', say.onOneLine, 'oblique');
  if (id) return void change(world, id, plane, event);
  if (isFull(world)) return void ui.notify('warn', say.full({ n: maxObliques }), 'oblique');
  const made = freeId(obliquesOf(world));
  change(world, made, newOblique(plane), event);
  ui.select('oblique', made);
}

export function deleteOblique(world, id, event) {
  change(world, id, null, event);
  world.ui.select('oblique', '');
}

/** Shows the plane in the oblique pane; with no such pane on the screen, beside the 3-D picture, on a telephone in its place. */
export function openOblique({ room, ui }, id) {
  showOblique(room, id);
  if (ui.visible.value.includes(obliqueView)) return;
  if (ui.arrangement.value.size === 'phone') ui.showInPlaceOf(ui.active.value, obliqueView);
  else ui.setLayout('oblique');
}
