// Isodose levels: their rows in the tree.
import { html } from '../../../lib/lit-html.js';
import { classMap } from '../../../lib/directives/class-map.js';
import { live } from '../../../lib/directives/live.js';
import { shownDose, unitOf } from '../../room/dose.js';
import { addedLevel, doseOf, levelPatch, levelsOf, maxLevels, percentOf } from './level_list.js';
import { typed } from '../../parts/fields.js';
import { number, significant } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { eye, treeRow } from '../../parts/tree_row.js';
import { say } from './row_words.js';

const how = (ui, event) => ({ view: ui.active.value, at: event.timeStamp });
const still = (event) => event.stopPropagation();
/** Parts of a level: word, icon, name, name in lower case, name with its level. */
export const levelParts = [
  ['line', 'isoline', say.line, say.lineWord, say.lineOf],
  ['wash', 'wash', say.wash, say.washWord, say.washOf],
  ['surface', 'globe', say.surface, say.surfaceWord, say.surfaceOf],
];

/** "90", "1.25": a level's number as it was given. */
export const plain = (value) => String(Number(value.toPrecision(6)));
/** The level in words: "90 %", "1.01 Gy(w)". */
export const levelWords = (level, unit) => (level.unit === 'percent' ? `${plain(level.value)} %` : `${plain(level.value)} ${unit}`);
/** The level's dose in the other unit, without the unit: "1.01" or "90"; a dash where 100 % is not known. */
export const otherText = (level, reference) =>
  level.unit === 'percent' ? significant(doseOf(level, reference)) : number(percentOf(level, reference), 0);

export const levelContext = ({ room, doses }) => {
  const [plan, scene] = [room.plan.value, room.scene.value];
  return { plan, scene, reference: doses.reference.value, unit: unitOf(shownDose(plan, scene), scene.dose.quantity) };
};

export function levelRows(world) {
  const { scene, reference, unit } = levelContext(world);
  return levelsOf(scene, reference).map((level) => levelRow(world, level, reference, unit));
}

function levelRow(world, level, reference, unit) {
  const { room, ui } = world;
  const { id } = level;
  const isDisabled = !room.canChange.value;
  const change = (patch, event) => room.patchScene(levelPatch(id, patch), how(ui, event));
  const toggle = (event) => change({ visible: !level.visible }, event);
  const setValue = (value, event) => Number.isFinite(value) && value >= 0 && change({ value }, event);
  const words = levelWords(level, unit);
  const other = level.unit === 'percent' ? `${otherText(level, reference)} ${unit}` : `${otherText(level, reference)} %`;
  const isUsed = (part) => level[part] && level.visible;
  return treeRow(
    world,
    {
      kind: 'level',
      id,
      words: [words, other],
      more: levelParts.filter(([part]) => isUsed(part)).map(([, , , word]) => word),
      title: `${words}: ${other}`,
      isOn: level.visible,
      toggle,
      step: (by, event) => setValue(Math.max(level.value + by * (level.unit === 'percent' ? 1 : level.value / 100), 0), event),
    },
    html`
    ${eye(level.visible, say.level({ level: words }), say.showOrHide, isDisabled, toggle)}
    <input type="color" tabindex="-1" .value=${live(level.color)} aria-label=${say.colourOf({ level: words })} ?disabled=${isDisabled} @click=${still} @input=${(event) => change({ color: event.target.value }, event)}>
    <span class="field dose-value" @click=${still}><input type="number" step="any" min="0" tabindex="-1" .value=${typed(plain(level.value))} aria-label=${level.unit === 'percent' ? say.levelPercent : say.levelIn({ unit })} ?disabled=${isDisabled}
      @change=${(event) => setValue(event.target.valueAsNumber, event)}></span><span class="dose-unit">${level.unit === 'percent' ? '%' : unit}</span>
    <button class="name dose-other" tabindex="-1" title=${other}>${otherText(level, reference)}${level.unit === 'percent' ? '' : ' %'}</button>
    ${levelParts.map(
      ([
        part,
        picture,
        about,
        ,
        of,
      ]) => html`<button class=${classMap({ 'dose-toggle': true, on: isUsed(part) })} tabindex="-1" aria-pressed=${level[part]} aria-label=${of({ level: words })} title=${about} ?disabled=${isDisabled}
      @click=${(event) => {
        still(event);
        change({ [part]: !level[part] }, event);
      }}>${icon(picture)}</button>`,
    )}`,
  );
}

/** Adding a level, and the tables to begin with. */
export function levelActions(world) {
  const { room, ui } = world;
  const key = 'dosing:levels';
  const isFull = Object.keys(room.scene.value.dose.levels).length >= maxLevels;
  const isDisabled = !room.canChange.value;
  const enter = (event) => event.currentTarget.querySelector('button')?.focus();
  return html`<li class=${`row dose-control dose-actions${ui.row.value === key ? ' current' : ''}`} role="treeitem" id=${`row-${key}`} data-key=${key} aria-level="2" aria-selected="false" aria-label=${say.levelPresets}
    @click=${() => {
      ui.row.value = key;
    }} @row-toggle=${enter}><button tabindex="-1" ?disabled=${isDisabled || isFull} @click=${(event) => addLevel(world, event)}>${icon('plus')}${say.addLevel}</button> <button tabindex="-1" title=${say.tables} @click=${() => ui.choose('dosing', 'levels')}>${say.presets}</button></li>`;
}

export function addLevel(world, event) {
  const { room, ui } = world;
  const added = addedLevel(room.scene.value, world.doses.reference.value);
  if (!added) return;
  room.patchScene(added.patch, how(ui, event));
  ui.row.value = `level:${added.id}`;
  ui.choose('level', added.id);
}
