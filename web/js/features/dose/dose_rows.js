// The doses in the tree: the doses, what is shown of the chosen one, its reference and tissue, its levels, and the switches of lines, wash and surfaces. Keys D and I.
import { html, nothing } from '../../../lib/lit-html.js';
import { classMap } from '../../../lib/directives/class-map.js';
import { live } from '../../../lib/directives/live.js';
import {
  choosePatch,
  dependsOnBlood,
  doseName,
  isOn,
  isWeighted,
  missingOf,
  missingWords,
  quantitiesOf,
  quantityName,
  referenceWords,
  shownDose,
  toggledPatch,
  unitOf,
} from '../../room/dose.js';
import { doseWords } from '../../room/plan.js';
import { isOfOtherPlan, planGroups } from '../../room/plan_groups.js';
import { levelActions, levelRows } from './dose_levels.js';
import { surfacesPatch } from './level_list.js';
import { referenceSelect, tissueSelect } from './dose_reference.js';
import { typed } from '../../parts/fields.js';
import { listed, number } from '../../parts/format.js';
import { ofFits } from '../fits/feature.js';
import { icon } from '../../parts/icons.js';
import { eye, name, treeRow } from '../../parts/tree_row.js';
import { say } from './row_words.js';

const how = (ui, event) => ({ view: ui.active.value, at: event.timeStamp });
const still = (event) => event.stopPropagation();

/** "of brain max"; '' while nothing is shown. */
export function doseNote({ room }) {
  const [plan, scene] = [room.plan.value, room.scene.value];
  return scene && isOn(scene) ? say.of({ reference: referenceWords(plan, scene.dose.reference) }) : say.off;
}

export function doseRows(world) {
  const { room } = world;
  const scene = room.scene.value;
  const dose = shownDose(room.plan.value, scene);
  if (!scene || !dose) return nothing;
  return html`${grouped(world, dose)}
    ${world.ui.arrangement.value.tree === 'tree' ? quantityRow(world, dose) : quantitiesOf(dose).map((quantity) => radioRow(world, dose, quantity))}
    ${controlRow(world, 'reference', html`<span class="dose-word">100 %</span>${referenceSelect(world, { tabindex: -1 })}`, say.hundredIs)}
    ${isWeighted(scene.dose.quantity) || dependsOnBlood(dose, scene.dose.quantity) ? controlRow(world, 'tissue', html`<span class="dose-word">${say.weights}</span>${tissueSelect(world, { tabindex: -1 })}`, say.weightsOf) : nothing}
    ${levelRows(world)}${levelActions(world)}
    ${switchRow(world, 'lines', say.lines)}${washRow(world)}${switchRow(world, 'surfaces', say.surfaces)}`;
}

/** The doses, by their treatment plans. Those of other patients stand elsewhere. */
function grouped(world, shown) {
  const [plan, scene] = [world.room.plan.value, world.room.scene.value];
  return planGroups(plan, scene, plan.doses).map(
    ({ head, parts }) =>
      html`${head ? html`<li class="row-group" role="presentation">${head}</li>` : nothing}${parts.map((dose) => doseRow(world, dose, dose === shown))}`,
  );
}

function doseRow(world, dose, isShown) {
  const { room, ui } = world;
  const scene = room.scene.value;
  const { lines, wash, surfaces } = scene.dose;
  const isVisible = isShown && (lines.visible || wash.visible || surfaces.visible);
  const words = doseName(dose);
  const isOther = isOfOtherPlan(room.plan.value, scene, dose);
  const tail = isShown && room.plan.value.doses.length > 1 ? say.chosen : isOther ? say.compareOnly : dose.unit;
  const toggle = (event) => room.patchScene(toggledPatch(room.plan.value, room.scene.value, dose, isShown), how(ui, event));
  const choose = (event) => !isShown && room.patchScene(choosePatch(room.plan.value, room.scene.value, dose), how(ui, event));
  return treeRow(
    world,
    {
      kind: 'dose',
      id: dose.id,
      words: [words, ofFits(room)?.rowWords(world, 'dose', dose.id) ?? '', tail],
      more: [doseWords(dose)],
      title: doseWords(dose),
      isOn: isVisible,
      toggle,
      choose,
    },
    html`
    ${eye(isVisible, say.show({ dose: words }), isVisible ? say.hideAll : say.showLines, !room.canChange.value, toggle)}${name(words)} ${ofFits(room)?.rowMark(world, 'dose', dose.id) ?? nothing}
    <span class="tail">${tail}</span>`,
  );
}

function radioRow(world, dose, quantity) {
  const { room, ui } = world;
  const scene = room.scene.value;
  const isChosen = scene.dose.quantity === quantity;
  const choose = (event) => !isChosen && room.patchScene({ dose: { quantity } }, how(ui, event));
  const missing = missingWords(missingOf(dose, quantity));
  const tail = [unitOf(dose, quantity), quantity === 'boron' && dependsOnBlood(dose, quantity) ? `${number(scene.dose.blood_ppm)} ppm` : '']
    .filter(Boolean)
    .join(', ');
  return treeRow(
    world,
    {
      kind: 'quantity',
      id: quantity,
      words: [quantityName(quantity), missing || tail],
      more: [missing ? tail : '', isChosen ? say.chosen : ''].filter(Boolean),
      title: [quantityName(quantity), missing].filter(Boolean).join(', '),
      toggle: choose,
      choose,
    },
    html`
    <i class=${classMap({ 'dose-radio': true, on: isChosen })}></i>${name(quantityName(quantity))} <span class="tail clipped">${missing ? html`<span class="warn">${missing}</span>` : tail}</span>`,
  );
}

/** The quantities as one field, where rows are dear. */
function quantityRow(world, dose) {
  const missing = missingWords(missingOf(dose, world.room.scene.value.dose.quantity));
  return html`${controlRow(world, 'quantity', quantitySelect(world, dose, { tabindex: -1 }), say.quantity)}
    ${missing ? controlRow(world, 'missing', html`<span class="warn">${icon('warning', 12)} ${missing}</span>`, missing) : nothing}`;
}

export function quantitySelect({ room, ui }, dose, { tabindex }) {
  const { quantity } = room.scene.value.dose;
  const all = quantitiesOf(dose);
  const change = (event) => room.patchScene({ dose: { quantity: event.target.value } }, how(ui, event));
  return html`<select class="dose-select" aria-label=${say.quantity} tabindex=${tabindex} ?disabled=${!room.canChange.value} @click=${still} @change=${change}>
    ${all.includes(quantity) ? nothing : html`<option value=${quantity} selected>${say.notInDose({ quantity: quantityName(quantity) })}</option>`}
    ${all.map((one) => html`<option value=${one} ?selected=${one === quantity} .selected=${live(one === quantity)}>${listed(quantityName(one), unitOf(dose, one) || say.unitNotKnown)}</option>`)}</select>`;
}

/** A row around one control: Space moves the focus into it. */
function controlRow({ ui }, id, content, label) {
  const key = `dosing:${id}`;
  const enter = (event) => event.currentTarget.querySelector('select, input')?.focus();
  return html`<li class=${classMap({ row: true, 'dose-control': true, current: ui.row.value === key })} role="treeitem" id=${`row-${key}`} data-key=${key} aria-level="2" aria-selected="false" aria-label=${label}
    @click=${() => {
      ui.row.value = key;
    }} @row-toggle=${enter}>${content}</li>`;
}

const switchWords = (ui, visible, id) => {
  const words = visible ? say.hide : say.showOne;
  return id === 'surfaces' ? words : ui.keys.tip(words, id);
};

function switchRow(world, id, words) {
  const { room, ui, doses } = world;
  const { visible } = room.scene.value.dose[id];
  const patch = () =>
    id === 'surfaces' ? surfacesPatch(room.scene.value, doses.reference.value, !visible) : { dose: { [id]: { visible: !visible } } };
  const toggle = (event) => room.patchScene(patch(), how(ui, event));
  return treeRow(
    world,
    {
      kind: 'dosing',
      id,
      words: [words, id === 'surfaces' ? say.in3d : ''],
      title: id === 'surfaces' ? words : ui.keys.tip(words, id),
      isOn: visible,
      toggle,
    },
    html`
    ${eye(visible, words, switchWords(ui, visible, id), !room.canChange.value, toggle)}${name(words)} <span class="tail">${id === 'surfaces' ? say.in3d : ''}</span>`,
  );
}

function washRow(world) {
  const { room, ui } = world;
  const { wash } = room.scene.value.dose;
  const isDisabled = !room.canChange.value;
  const change = (patch, event) => room.patchScene({ dose: { wash: patch } }, how(ui, event));
  const toggle = (event) => change({ visible: !wash.visible }, event);
  const words = (wash.style === 'smooth' ? say.washSmooth : say.washBands)({ percent: number(wash.below_percent) });
  return treeRow(
    world,
    { kind: 'dosing', id: 'wash', words: [say.wash], more: [words], title: ui.keys.tip(words, 'wash'), isOn: wash.visible, toggle },
    html`
    ${eye(wash.visible, say.wash, switchWords(ui, wash.visible, 'wash'), isDisabled, toggle)}${name(say.wash)}
    <select class="dose-style" aria-label=${say.washStyle} tabindex="-1" ?disabled=${isDisabled} @click=${still} @change=${(event) => change({ style: event.target.value }, event)}>
      ${[
        ['bands', say.bands],
        ['smooth', say.smooth],
      ].map(
        ([id, text]) => html`<option value=${id} ?selected=${id === wash.style} .selected=${live(id === wash.style)}>${text}</option>`,
      )}</select>
    <span class="field dose-from" @click=${still}><input type="number" step="any" min="0" max="100" tabindex="-1" aria-label=${say.washFrom} .value=${typed(String(wash.below_percent))} ?disabled=${isDisabled}
      @change=${(event) => Number.isFinite(event.target.valueAsNumber) && change({ below_percent: Math.min(Math.max(event.target.valueAsNumber, 0), 100) }, event)}><span>%</span></span>`,
  );
}

// ---- keys of a pane ---------------------------------------------------------------------------------------------------------

/** Key D: the wash. Key I: isodose lines. */
export function toggleDose(room, ui, part, at) {
  room.patchScene({ dose: { [part]: { visible: !room.scene.value.dose[part].visible } } }, { view: ui.active.value, at });
}
