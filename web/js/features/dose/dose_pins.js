// Pinned probes: the table in the Probe, its file, and their marks on the pictures.
import { html, nothing, svg } from '../../../lib/lit-html.js';
import { basisWords } from '../../room/dose.js';
import { heightOver } from '../../room/obliques.js';
import { pinsOf } from './pins.js';
import { crosshairPatch, shownImage } from '../../room/plan.js';
import { toPicture } from '../../parts/vec.js';
import { exportRows } from '../../room/exports.js';
import { imageValue, number, significant, unitText } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { say } from './drawn_words.js';

const how = (ui, event) => ({ view: ui.active.value, at: event.timeStamp });

const nameOf = (plan, answer) => plan.regions.find(({ id }) => id === answer?.regions?.[0])?.name ?? '';

/** Quantities in lower case. */
const quantityWords = {
  weighted: say.ofWeighted,
  total: say.ofTotal,
  boron: say.ofBoron,
  nitrogen: say.ofNitrogen,
  fast: say.ofFast,
  gamma: say.ofGamma,
  other: say.ofOther,
  'blood-boron': say.ofBloodBoron,
  'weighted-total': say.ofWeightedTotal,
  isoeffective: say.ofIsoeffective,
  'fast-fluence': say.ofFastFluence,
  'epithermal-fluence': say.ofEpithermalFluence,
  'thermal-fluence': say.ofThermalFluence,
};

export function pinsBlock(world) {
  const { room, ui, doses } = world;
  const [plan, scene] = [room.plan.value, room.scene.value];
  const pins = pinsOf(scene);
  if (!pins.length) return nothing;
  const isDisabled = !room.canChange.value;
  const image = shownImage(plan, scene);
  const known = doses.pins.value;
  const unit = Object.values(known).find(({ result }) => result)?.result.unit;
  const go =
    ({ at_mm: at }) =>
    (event) =>
      room.patchScene(crosshairPatch(plan, image, at, { isFree: true }), how(ui, event));
  const remove =
    ({ id }) =>
    (event) =>
      room.patchScene({ probes: { [id]: null } }, how(ui, event));
  return html`<section class="block"><h3 class="dose-head">${say.pins} <span class="dim">${plan.doses.length ? (quantityWords[scene.dose.quantity] ?? scene.dose.quantity) : ''}</span><span class="grow"></span>${room.control.mayExport ? html`<button class="dose-small" @click=${() => exportRows(world, 'probes', `${room.planId.value}-probes.csv`, pinRows(plan, scene, known))}>CSV</button>` : nothing}</h3>
    <table class="dose-pins"><thead><tr><th scope="col">${say.pinColumn}</th><th scope="col">${say.inColumn}</th>${image ? html`<th scope="col">${image.modality}</th>` : nothing}${plan.doses.length ? html`<th scope="col">${unitText(unit ?? '')}</th><th scope="col">%</th>` : nothing}<th scope="col"><span class="hidden">${say.remove}</span></th></tr></thead>
    <tbody>${pins.map((pin) => {
      const answer = known[pin.id]?.result;
      const found = image && answer?.images.find(({ id }) => id === image.id);
      return html`<tr><td><button class="link" title=${(pin.author ? say.crosshairToBy : say.crosshairTo)({ place: words(pin.at_mm), author: pin.author })} ?disabled=${isDisabled} @click=${go(pin)}>${pin.label}</button></td><td class="dose-in" title=${words(pin.at_mm)}>${nameOf(plan, answer) || '–'}</td>
        ${image ? html`<td>${found && found.value !== null ? imageValue(found.value, '').text : '–'}</td>` : nothing}
        ${plan.doses.length ? html`<td title=${answer?.value_reason ?? nothing}>${answer && Number.isFinite(answer.value) ? significant(answer.value) : '–'}</td><td>${answer && Number.isFinite(answer.percent) ? number(answer.percent, 1) : '–'}</td>` : nothing}
        <td><button class="icon-button small" aria-label=${say.removePin({ pin: pin.label })} title=${say.remove} ?disabled=${isDisabled} @click=${remove(pin)}>${icon('close', 12)}</button></td></tr>`;
    })}</tbody></table></section>`;
}

const words = (mm) => ['L', 'P', 'S'].map((letter, axis) => `${letter} ${number(mm[axis], 1)}`).join('  ');

/** Rows of the file of pins: places, regions, image, the shown dose, its components, and the basis of all numbers. */
export function pinRows(plan, scene, known) {
  const pins = pinsOf(scene);
  const answers = pins.map(({ id }) => known[id]?.result);
  const first = answers.find(Boolean);
  const quantities = [...new Set(answers.flatMap((answer) => answer?.components.map(({ quantity }) => quantity) ?? []))];
  const images = [...new Set(answers.flatMap((answer) => answer?.images.map(({ id }) => id) ?? []))];
  const partOf = (answer, quantity) => answer?.components.find((part) => part.quantity === quantity);
  const unitOfPart = (quantity) => answers.map((answer) => partOf(answer, quantity)).find(Boolean)?.unit ?? '';
  return [
    [
      say.csvPin,
      'L_mm',
      'P_mm',
      'S_mm',
      say.csvRegion,
      ...images.map((id) => say.csvImage({ image: id })),
      ...(first ? [`${first.quantity} (${first.unit})`, say.csvPercent, say.csvReference, say.csvWeights, say.csvReason] : []),
      ...quantities.map((quantity) => `${quantity} (${unitOfPart(quantity)})`),
      say.csvBasis,
    ],
    ...pins.map((pin, index) => {
      const answer = answers[index];
      return [
        pin.label,
        ...pin.at_mm,
        nameOf(plan, answer),
        ...images.map((id) => answer?.images.find((image) => image.id === id)?.value ?? null),
        ...(first
          ? [
              answer?.value ?? null,
              answer?.percent ?? null,
              answer?.reference ? `${answer.reference.words} ${answer.reference.value ?? ''}`.trim() : null,
              plan.regions.find(({ id }) => id === answer?.weighted_by)?.name ?? null,
              answer?.value_reason ?? null,
            ]
          : []),
        ...quantities.map((quantity) => partOf(answer, quantity)?.value ?? null),
        basisWords(plan, scene),
      ];
    }),
  ];
}

/** The marks over a picture: of pins that lie in its plane, in 3-D of all. */
export function pinMarks({ scene, plane, tolerance, header, box, pane }) {
  const isNear = ({ at_mm: at }) => !plane || Math.abs(heightOver(plane, at)) <= tolerance;
  return pinsOf(scene)
    .filter(isNear)
    .map((pin) => {
      const at = toPicture(header.clip_from_lps_mm, pin.at_mm);
      const [x, y] = at ? [box.x + at[0] * box.width, box.y + at[1] * box.height] : [-1, -1];
      if (x < 0 || y < 0 || x > pane[0] || y > pane[1]) return nothing;
      const d = `M${x.toFixed(1)} ${y.toFixed(1)}l-4 -7a5.5 5.5 0 1 1 8 0Z`;
      return svg`<g class="dose-pin" data-pin=${pin.id}><path class="under" d=${d} /><path class="ink" d=${d} /><text class="halo dose-pin-name" x=${x + 8} y=${y - 8}>${pin.label}</text></g>`;
    });
}
