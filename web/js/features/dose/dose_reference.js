// Reference of 100 %, and the region whose weights hold: fields for the tree and for Selection.
import { html, nothing } from '../../../lib/lit-html.js';
import { live } from '../../../lib/directives/live.js';
import { referenceWords, shownDose, unitOf } from '../../room/dose.js';
import { ownRegions } from '../../room/identity.js';
import { crosshair } from '../../room/plan.js';
import { numberField } from '../../parts/fields.js';
import { significant } from '../../parts/format.js';
import { say } from './row_words.js';

const still = (event) => event.stopPropagation();

/** The value of 100 % as the scene is now; null: not known, or still to come. */
const newestReference = ({ doses }) => (doses.scale.value.isOld ? null : doses.reference.value);

/** "brain max, 1.13 Gy(w)": the reference with its value, as far as it is known. */
export function referenceText(world) {
  const { room } = world;
  const [plan, scene] = [room.plan.value, room.scene.value];
  const { reference } = scene.dose;
  const words = referenceWords(plan, reference);
  const value = reference.kind === 'value' ? reference.value : newestReference(world);
  return Number.isFinite(value) ? `${words}, ${significant(value)} ${unitOf(shownDose(plan, scene), scene.dose.quantity)}` : words;
}

const keyOf = ({ kind, region }) => (kind.startsWith('region') ? `${kind} ${region}` : kind);

/** The patch for a choice of the list. A point is the crosshair; a prescription begins with what 100 % was. */
function chosenPatch(world, key) {
  const [kind, region = ''] = key.split(' ');
  const scene = world.room.scene.value;
  const value = newestReference(world);
  return {
    dose: {
      reference: {
        kind,
        ...(kind.startsWith('region') && { region }),
        ...(kind === 'point' && { point_mm: crosshair(scene) }),
        ...(kind === 'value' && Number.isFinite(value) && value > 0 && { value: Number(value.toPrecision(4)) }),
      },
    },
  };
}

export function referenceSelect(world, { tabindex }) {
  const { room, ui } = world;
  const [plan, scene] = [room.plan.value, room.scene.value];
  const { reference, quantity } = scene.dose;
  const dose = shownDose(plan, scene);
  const own = Number.isFinite(dose.components.find((part) => part.quantity === quantity)?.reference);
  const chosen = keyOf(reference);
  const option = (key, words) =>
    html`<option value=${key} ?selected=${key === chosen} .selected=${live(key === chosen)}>${key === chosen ? referenceText(world) : words}</option>`;
  const choices = ownRegions(plan, scene);
  const firstTarget = choices.find(({ is_target: is }) => is);
  const regions = choices.filter(({ voxels }) => voxels > 0);
  const ofRegions = (kind, words) =>
    regions.length
      ? html`<optgroup label=${words}>${reference.kind === kind && !reference.region ? option(`${kind} `, firstTarget?.name) : nothing}
    ${regions.map(({ id, name }) => option(`${kind} ${id}`, name))}</optgroup>`
      : nothing;
  const change = (event) => room.patchScene(chosenPatch(world, event.target.value), { view: ui.active.value, at: event.timeStamp });
  return html`<select class="dose-select" aria-label=${say.referenceIs} title=${say.hundredIsOf({ reference: referenceText(world) })} tabindex=${tabindex} ?disabled=${!room.canChange.value} @click=${still} @change=${change}>
    ${option('body', say.bodyMaximum)}${own || reference.kind === 'file' ? option('file', say.fileReference) : nothing}${option('point', say.atCrosshair)}${option('value', say.prescription)}
    ${ofRegions('region-max', say.maximumOf)}${ofRegions('region-mean', say.meanOf)}</select>`;
}

/** Further fields of the chosen kind of reference: its number, its place. */
export function referenceMore(world, isDisabled, change) {
  const { room, doses } = world;
  const [plan, scene] = [room.plan.value, room.scene.value];
  const { reference, quantity } = scene.dose;
  const reason = doses.scale.value.result?.reference?.reason;
  const set = (patch, event) => change({ dose: { reference: patch } }, event);
  return html`${reference.kind === 'value' ? html`<dt>${say.prescriptionField}</dt><dd>${numberField(say.prescribed, reference.value, unitOf(shownDose(plan, scene), quantity), isDisabled, (value, event) => value > 0 && set({ value }, event))}</dd>` : nothing}
    ${reference.kind === 'point' ? html`<dt>${say.point}</dt><dd><button class="dose-small" ?disabled=${isDisabled} @click=${(event) => set({ point_mm: crosshair(scene) }, event)}>${say.toCrosshair}</button></dd>` : nothing}
    ${reason ? html`<dt>${say.reference}</dt><dd class="err">${reason}</dd>` : nothing}`;
}

/** Choice of weights: each tissue its own, or one region's everywhere. */
export function tissueSelect({ room, ui }, { tabindex }) {
  const [plan, scene] = [room.plan.value, room.scene.value];
  const { tissue } = scene.dose;
  const change = (event) => room.patchScene({ dose: { tissue: event.target.value } }, { view: ui.active.value, at: event.timeStamp });
  return html`<select class="dose-select" aria-label=${say.weightsOf} title=${say.weightsAre} tabindex=${tabindex} ?disabled=${!room.canChange.value} @click=${still} @change=${change}>
    <option value="" ?selected=${!tissue} .selected=${live(!tissue)}>${say.eachItsOwn}</option>
    ${ownRegions(plan, scene).map(({ id, name }) => html`<option value=${id} ?selected=${id === tissue} .selected=${live(id === tissue)}>${say.asRegion({ region: name })}</option>`)}</select>`;
}
