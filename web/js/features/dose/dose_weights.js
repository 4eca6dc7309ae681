// Boron in blood, and the biological weights of each region: in Selection.
import { html, nothing } from '../../../lib/lit-html.js';
import { live } from '../../../lib/directives/live.js';
import { dependsOnBlood } from '../../room/dose.js';
import {
  choosePresetPatch,
  editPatch,
  isEdited,
  isoeffectiveSets,
  presetOf,
  presetRow,
  presetsFor,
  tissueFor,
  weightsOf,
} from './weight_table.js';
import { ownRegions } from '../../room/identity.js';
import { numberField, typed } from '../../parts/fields.js';
import { number } from '../../parts/format.js';
import { icon, swatch } from '../../parts/icons.js';
import { say } from './later_words.js';

const [sliderHigh, highest] = [40, 1000]; // ppm: the slider's end, proto/scene.json
const columns = [
  ['boron_ratio', say.boronRatioIs],
  ['cbe', say.cbeIs],
  ['nitrogen', say.nitrogenIs],
  ['fast', say.fastIs],
  ['gamma', say.gammaIs],
];

/** Boron in blood, live. */
export function bloodBlock({ room }, dose, isDisabled, change) {
  const { blood_ppm: ppm, quantity } = room.scene.value.dose;
  if (!dependsOnBlood(dose, quantity)) return nothing;
  const set = (value, event) => Number.isFinite(value) && change({ dose: { blood_ppm: Math.min(Math.max(value, 0), highest) } }, event);
  return html`<section class="block"><h3 class="dose-head">${say.bloodBoron} <span class="grow"></span>${numberField(say.boronInBlood, Number(ppm.toFixed(2)), 'ppm', isDisabled, set)}</h3>
    <input class="dose-slider" type="range" min="0" max=${Math.max(sliderHigh, ppm)} step="0.5" .value=${live(String(ppm))} aria-label=${say.boronInBloodPpm} aria-valuetext=${`${number(ppm, 1)} ppm`} ?disabled=${isDisabled}
      @input=${(event) => set(event.target.valueAsNumber, event)}>
    <div class="dose-scale">${[0, 1, 2, 3, 4].map((part) => html`<span>${number((part * Math.max(sliderHigh, ppm)) / 4)}</span>`)}</div></section>`;
}

export function weightsBlock({ room }, isDisabled, change) {
  const [plan, scene] = [room.plan.value, room.scene.value];
  const preset = presetOf(plan, scene);
  const choose = (event) => {
    const found = presetsFor(plan).find(({ name }) => name === event.target.value);
    if (found) change(choosePresetPatch(plan, scene, found), event);
  };
  const edited = isEdited(scene);
  const hasOther = room.plan.value.doses.some((dose) => dose.components.some(({ quantity }) => quantity === 'other'));
  return html`<section class="block"><h3 class="dose-head">${say.weights} <span class="dim">${edited ? say.edited : ''}</span><span class="grow"></span>
      <select class="dose-presets" aria-label=${say.weightSet} ?disabled=${isDisabled} @change=${choose}>${preset && !edited ? nothing : html`<option value="" selected disabled>${preset ? say.editedSet({ set: preset.name }) : say.edited}</option>`}
        ${presetsFor(plan).map(({ name }) => html`<option value=${name} ?selected=${!edited && preset?.name === name} .selected=${live(!edited && preset?.name === name)}>${name}</option>`)}</select>
      <button class="icon-button" title=${preset ? say.backTo({ set: preset.name }) : say.setNotKnown} aria-label=${say.resetWeights} ?disabled=${isDisabled || !edited || !preset} @click=${(event) => change(choosePresetPatch(plan, scene, preset), event)}>${icon('reset')}</button></h3>
    <table class="dose-weights"><thead><tr><th scope="col">${say.tissue}</th><th scope="col" title=${columns[0][1]}>${say.boronToBlood}</th><th scope="col">ppm</th><th scope="col" title=${columns[1][1]}>CBE</th><th scope="col" title=${columns[2][1]}>RBE N</th><th scope="col" title=${columns[3][1]}>${say.rbeFast}</th><th scope="col" title=${columns[4][1]}>γ</th></tr></thead>
      <tbody>${ownRegions(plan, scene)
        .filter(({ voxels }) => voxels > 0)
        .map((region) => weightRow(plan, scene, region, preset, isDisabled, change))}</tbody></table>
    <p class="note dose-warn">${icon('warning', 12)} ${say.exampleValues}</p>
    ${preset ? html`<p class="note">${preset.name}: ${preset.source}.</p>` : nothing}${hasOther ? html`<p class="note">${say.othersWeightOne}</p>` : nothing}</section>`;
}

function weightRow(plan, scene, region, preset, isDisabled, change) {
  const held = weightsOf(plan, scene, region);
  const given = presetRow(preset, region);
  const kind = preset && !preset.rows ? tissueFor(preset, region) : null;
  const isInherited = held && held.from !== region.id;
  const about = [
    held ? '' : say.noWeights,
    isInherited ? say.asAround({ region: plan.regions.find(({ id }) => id === held.from).name }) : '',
    kind ? `${preset.name}: ${kind.tissue}${kind.assumed ? ` (${kind.assumed})` : ''}` : '',
  ]
    .filter(Boolean)
    .join('; ');
  const cell = ([field, words]) => {
    const value = held?.row[field];
    const isChanged = given && held && value !== given[field];
    return html`<td><input type="number" step="any" min="0" max="100" class=${isChanged ? 'dose-edited' : ''} .value=${typed(value === undefined ? '' : String(Number(value.toPrecision(4))))} ?disabled=${isDisabled}
      aria-label=${`${region.name}: ${words}`} title=${isChanged ? say.givenIn({ value: given[field], set: preset.name }) : words}
      @change=${(event) => Number.isFinite(event.target.valueAsNumber) && change(editPatch(plan, scene, region, { [field]: Math.min(Math.max(event.target.valueAsNumber, 0), 100) }), event)}></td>`;
  };
  const ppm = held ? held.row.boron_ratio * scene.dose.blood_ppm : NaN;
  return html`<tr class=${isInherited ? 'inherited' : ''}><th scope="row" title=${[region.name, about].filter(Boolean).join(': ')}>${swatch(scene.regions[region.id]?.color ?? region.color)}<span>${region.name}</span></th>
    ${cell(columns[0])}<td class="dose-ppm">${number(ppm, ppm < 99.95 ? 1 : 0)}</td>${columns.slice(1).map(cell)}</tr>`;
}

/** The photon-isoeffective dose: its formula, its sets of parameters by region, and where they come from. */
export function isoeffectiveBlock({ room }, isDisabled, change) {
  const [plan, scene] = [room.plan.value, room.scene.value];
  const rows = ownRegions(plan, scene).filter(({ voxels }) => voxels > 0);
  const used = [...new Set(rows.map((region) => weightsOf(plan, scene, region)?.row.isoeffective).filter(Boolean))];
  return html`<section class="block"><h3>${say.isoeffective}</h3>
    <p class="note dose-formula">α<sub>R</sub> D + G<sub>R</sub> β<sub>R</sub> D² = Σ α<sub>i</sub> D<sub>i</sub> + Σ Σ G<sub>ij</sub> √(β<sub>i</sub> β<sub>j</sub>) D<sub>i</sub> D<sub>j</sub></p>
    <p class="note">${say.isoeffectiveIs({ doses: html`D<sub>i</sub>` })}</p>
    <dl class="dose-list">${rows.map((region) => {
      const set = weightsOf(plan, scene, region)?.row.isoeffective ?? '';
      return html`<dt>${region.name}</dt><dd><select class="dose-select" aria-label=${say.parametersOf({ region: region.name })} ?disabled=${isDisabled} @change=${(event) => change(editPatch(plan, scene, region, { isoeffective: event.target.value }), event)}>
        <option value="" ?selected=${!set} .selected=${live(!set)}>${say.noParameters}</option>${isoeffectiveSets.map(({ name }) => html`<option value=${name} ?selected=${set === name} .selected=${live(set === name)}>${name}</option>`)}</select></dd>`;
    })}</dl>
    ${used.map((name) => {
      const set = isoeffectiveSets.find((other) => other.name === name);
      return set ? html`<p class="note">${say.setSource({ set: name, source: set.source, repair: set.repair_source })}</p>` : nothing;
    })}
    <p class="note dose-warn">${icon('warning', 12)} ${say.exampleValues}</p></section>`;
}
