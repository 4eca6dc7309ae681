// The clip planes in the tree: a row for each with its switch, the side it keeps, its position and its cap; below them what caps show. Loaded before the first click.
import { html, nothing } from '../../../lib/lit-html.js';
import { live } from '../../../lib/directives/live.js';
import { allThroughCrosshair, capWords, clipName, clipsOf, enabledClips, movedClip, positionOfClip, switchedClip } from './clip.js';
import { number } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { eye, name, treeRow } from '../../parts/tree_row.js';
import { toggleClips } from './clip_switch.js';
import { say } from './row_words.js';

const how = (ui, event) => ({ view: ui.active.value, at: event.timeStamp });
const tenths = (value) => Math.round(value * 10) / 10 || 0;

/** "S −64.9 mm", "12.0 mm" along a beam. */
export const clipPosition = (row, position) => `${row.letter ? `${row.letter} ` : ''}${number(position, 1)} mm`;

export function clipRows(world) {
  const { room } = world;
  if (!room.scene.value?.clip) return nothing;
  return html`${clipsOf(room.plan.value).map((row) => planeRow(world, row))}${capsRow(world)}${actionRows(world)}`;
}

function planeRow(world, row) {
  const { room, ui } = world;
  const [plan, scene] = [room.plan.value, room.scene.value];
  const { id } = row;
  const { enabled: isOn, cap } = scene.clip[id];
  const isDisabled = !room.canChange.value;
  const words = clipName(id);
  const position = tenths(positionOfClip(plan, scene, id));
  const change = (patch, event) => room.patchScene(patch, how(ui, event));
  const toggle = (event) => change(switchedClip(plan, scene, id, !isOn), event);
  const move = (mm, event) => Number.isFinite(mm) && change(movedClip(plan, scene, id, mm), event);
  const still = (event) => event.stopPropagation();
  const text = clipPosition(row, position);
  return treeRow(
    world,
    {
      kind: 'clip',
      id,
      words: [words, text],
      more: [cap ? say.withCap : say.withoutCap],
      title: say.at({ plane: words, position: text }),
      isOn,
      toggle,
      step: (by, event) => move(position + by, event),
    },
    html`
    ${eye(isOn, say.clipPlane({ plane: words }), isOn ? say.uncut : say.cut, isDisabled, toggle)}${name(words)}
    <span class="field clip-field" data-letter=${row.letter} @click=${still}><input type="number" step="any" tabindex="-1" .value=${live(position.toFixed(1))}
      aria-label=${say.positionOf({ plane: words })} ?disabled=${isDisabled} @change=${(event) => move(event.target.valueAsNumber, event)}></span>
    <button class="clip-cap" tabindex="-1" aria-pressed=${cap} aria-label=${say.capOf({ plane: words })} title=${cap ? say.leaveOpen : say.close} ?disabled=${isDisabled}
      @click=${(event) => {
        event.stopPropagation();
        change({ clip: { [id]: { cap: !cap } } }, event);
      }}>${icon('image')}</button>`,
  );
}

/** The row of caps: chosen as a plane is, and then in Selection. */
function capsRow(world) {
  const words = capWords(world.room.scene.value.clip.cap);
  return treeRow(
    world,
    { kind: 'clip', id: 'caps', words: [say.caps, words], title: say.capsShow({ what: words }) },
    html`${icon('image')}${name(say.caps)} <span class="tail clipped">${words}</span>`,
  );
}

/** Actions on all planes: key C's, and the move to the crosshair. */
function actionRows({ room, ui }) {
  const nOn = enabledClips(room.plan.value, room.scene.value).length;
  const toggle = (event) => toggleClips(room, ui, event.timeStamp);
  const move = (event) => room.patchScene(allThroughCrosshair(room.plan.value, room.scene.value), how(ui, event));
  return html`${actionRow(room, ui, 'switch', 'clip', nOn ? say.allOff : say.onAgain, !nOn && !ui.clips.length, toggle)}${actionRow(room, ui, 'crosshair', 'crosshair', say.allToCrosshair, !nOn, move)}`;
}

function actionRow(room, ui, id, picture, words, isOff, act) {
  const isDisabled = isOff || !room.canChange.value;
  const key = `clip:${id}`;
  const run = (event) => !isDisabled && act(event);
  return html`<li class=${`row clip-all${ui.row.value === key ? ' current' : ''}`} role="treeitem" id=${`row-${key}`} data-key=${key} aria-level="2" aria-selected="false" aria-disabled=${isDisabled}
    aria-label=${words} @click=${(event) => {
      ui.row.value = key;
      run(event);
    }} @row-toggle=${(event) => run(event.detail)}><button tabindex="-1" ?disabled=${isDisabled}>${icon(picture)}${words}</button></li>`;
}
