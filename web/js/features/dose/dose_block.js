// A dose in Selection: what is shown of it, on which basis, its reference, how it is drawn; below it weights, sum, comparison, coverage.
import { html, nothing } from '../../../lib/lit-html.js';
import { live } from '../../../lib/directives/live.js';
import {
  basisWords,
  choosePatch,
  doseName,
  isWeighted,
  missingOf,
  missingWords,
  quantityName,
  shownDose,
  summedDoses,
} from '../../room/dose.js';
import { joinReason } from '../fits/fits.js';
import { doseWords } from '../../room/plan.js';
import { compareBlock, coverageBlock } from './dose_compare.js';
import { levelBlock, tableSelect } from './dose_level.js';
import { componentNames } from './dose_probe.js';
import { referenceMore, referenceSelect, tissueSelect } from './dose_reference.js';
import { quantitySelect } from './dose_rows.js';
import { bloodBlock, isoeffectiveBlock, weightsBlock } from './dose_weights.js';
import { checkbox, numberField, segment } from '../../parts/fields.js';
import { number, significant, unitText } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';

export { levelBlock };

/** For a dose, one of its quantities, or a row of its section. */
export function doseBlock(world, isDisabled, change) {
  const { room, ui } = world;
  const [plan, scene] = [room.plan.value, room.scene.value];
  const shown = shownDose(plan, scene);
  if (!shown) return nothing;
  const { kind, id } = ui.selection.value;
  const other = kind === 'dose' && plan.doses.find((dose) => dose.id === id && dose !== shown);
  if (other) return otherBlock(other, isDisabled, change, plan, scene);
  const { quantity } = scene.dose;
  return html`<section class="block"><h3>${icon('dose')} ${quantityName(quantity)} <span class="dim">dose ${doseName(shown)}</span></h3>
      <p class="note">${aboutWords(plan, scene)}</p>${reasonNote(world)}
      <dl class="dose-list"><dt>Quantity</dt><dd>${quantitySelect(world, shown, { tabindex: 0 })}</dd>
        <dt>100 % is</dt><dd>${referenceSelect(world, { tabindex: 0 })}</dd>${referenceMore(world, isDisabled, change)}
        <dt>Weights</dt><dd>${tissueSelect(world, { tabindex: 0 })}</dd>
        <dt>Levels</dt><dd>${tableSelect(world, { tabindex: 0 })}</dd></dl></section>
    ${bloodBlock(world, shown, isDisabled, change)}
    ${isWeighted(quantity) ? weightsBlock(world, isDisabled, change) : nothing}
    ${quantity === 'isoeffective' ? isoeffectiveBlock(world, isDisabled, change) : nothing}
    ${drawnBlock(scene, isDisabled, change)}
    ${coverageBlock(world, isDisabled, change)}
    ${plan.doses.length > 1 ? html`${sumBlock(world, shown, isDisabled, change)}${compareBlock(world, isDisabled, change)}` : sumBlock(world, shown, isDisabled, change)}
    ${fileBlock(scene, shown, isDisabled, change)}`;
}

const totals = { weighted: 'each with its weight', total: 'without weights', isoeffective: 'as the photon dose of equal effect' };

/** "Boron + nitrogen + fast neutron + gamma, each with its weight. Gy(w) per 250 kW-min …" */
function aboutWords(plan, scene) {
  const { quantity } = scene.dose;
  const dose = shownDose(plan, scene);
  const isSum = totals[quantity] && !(quantity === 'total' && dose.components.some((part) => part.quantity === 'total'));
  const parts = componentNames(dose);
  return `${isSum ? `${parts.join(' + ')}, ${totals[quantity]}. ` : ''}${basisWords(plan, scene)}.`;
}

/** Why nothing is drawn, when it is for another reason. */
function reasonNote({ room, doses }) {
  const { result, error } = doses.scale.value;
  const reason = error || (result && !result.drawn && result.reason);
  return reason && reason !== shownDose(room.plan.value, room.scene.value).fit_reason
    ? html`<p class="note why">${icon('warning', 12)} Nothing is drawn: ${reason}${/[.]$/.test(reason) ? '' : '.'}</p>`
    : nothing;
}

function otherBlock(dose, isDisabled, change, plan, scene) {
  return html`<section class="block"><h3>${icon('dose')} Dose ${doseName(dose)}</h3><p class="note">${doseWords(dose)}.</p>
      <div class="buttons"><button ?disabled=${isDisabled} @click=${(event) => change(choosePatch(plan, scene, dose), event)}>Show this dose</button></div></section>${factsBlock(dose)}`;
}

function drawnBlock(scene, isDisabled, changeScene) {
  const { wash, lines, surfaces, interpolation, error } = scene.dose;
  const change = (part, name) => (value, event) => changeScene({ dose: { [part]: { [name]: value } } }, event);
  const limits = (part, name, low, high) => (value, event) => change(part, name)(Math.min(Math.max(value, low), high), event);
  return html`<section class="block"><h3>Drawn as</h3>
    <div class="checks dose-checks">${checkbox('Isodose lines (I)', lines.visible, isDisabled, change('lines', 'visible'))}${checkbox('Wash (D)', wash.visible, isDisabled, change('wash', 'visible'))}
      ${checkbox('Surfaces in 3-D', surfaces.visible, isDisabled, change('surfaces', 'visible'), 'Of the levels that have a surface')}</div>
    <dl class="dose-list"><dt>Wash</dt><dd>${segment(
      'Style of the wash in Selection',
      [
        ['bands', 'Bands'],
        ['smooth', 'Smooth'],
      ],
      wash.style,
      isDisabled,
      change('wash', 'style'),
    )}</dd>
      <dt>Wash from</dt><dd>${numberField('Wash from, in per cent of the reference', wash.below_percent, '%', isDisabled, limits('wash', 'below_percent', 0, 100))}</dd>
      <dt>Opacity</dt><dd class="pair"><input type="range" min="0" max="100" step="1" .value=${live(String(Math.round(wash.opacity * 100)))} aria-label="Opacity of the wash" ?disabled=${isDisabled}
        @input=${(event) => change('wash', 'opacity')(event.target.valueAsNumber / 100, event)}>${numberField('Opacity of the wash in per cent', Math.round(wash.opacity * 100), '%', isDisabled, (value, event) => change('wash', 'opacity')(Math.min(Math.max(value, 0), 100) / 100, event))}</dd>
      <dt>Width of lines</dt><dd>${numberField('Width of isodose lines', lines.width_px, 'px', isDisabled, limits('lines', 'width_px', 1, 8))}</dd>
      <dt>Surfaces in</dt><dd>${segment(
        'Grid of the surfaces',
        [
          ['dose', "dose's grid"],
          ['univels', 'univels', 'In the grid of the regions, as Sera3d does'],
        ],
        surfaces.grid,
        isDisabled,
        change('surfaces', 'grid'),
      )}</dd>
      <dt>Between voxels</dt><dd>${segment(
        'Between voxels of the dose',
        [
          ['linear', 'Tri-linear'],
          ['slice', 'In slices', 'Bilinear within the nearest slice of the dose, as Sera3d does'],
        ],
        interpolation,
        isDisabled,
        (value, event) => changeScene({ dose: { interpolation: value } }, event),
      )}</dd></dl>
    <div class="checks dose-checks">${checkbox('Wash on the volume', wash.volume, isDisabled, change('wash', 'volume'))}${checkbox('Clip planes cut surfaces', surfaces.clipped, isDisabled, change('surfaces', 'clipped'))}
      ${checkbox('Statistical error as wash', error, isDisabled, (value, event) => changeScene({ dose: { error: value } }, event), 'In per cent of the value, where the files give it')}</div></section>`;
}

/** How many times the dose counts, and which others are added. */
function sumBlock({ room }, shown, isDisabled, change) {
  const [plan, scene] = [room.plan.value, room.scene.value];
  const { factor, sum, quantity } = scene.dose;
  const per = shown.per ? unitText(shown.per.replace(/^per /, '')) : '';
  const others = plan.doses.filter((dose) => dose !== shown);
  const missing = missingWords([...new Set(summedDoses(plan, scene).flatMap((dose) => missingOf(dose, quantity)))]);
  return html`<section class="block"><h3>Times and sum <span class="dim">${per ? `the file is per ${per}` : 'the file does not say per what'}</span></h3>
    <dl class="dose-list"><dt>${doseName(shown)} ×</dt><dd>${numberField(`Factor of ${doseName(shown)}`, factor, '', isDisabled, (value, event) => change({ dose: { factor: Math.min(Math.max(value, 1e-9), 1e9) } }, event))}</dd></dl>
    ${others.map((dose) => {
      const part = sum[dose.id];
      const why = joinReason(plan, scene, shown, dose, true, room.accepted.value);
      return html`<div class="dose-part" title=${why?.reason ?? nothing}>${checkbox(`+ ${doseName(dose)}`, Boolean(part), isDisabled || Boolean(why && !part), (on, event) => change({ dose: { sum: { [dose.id]: on ? { factor: 1 } : null } } }, event), doseWords(dose))}
        ${part ? html`<span>×</span>${numberField(`Factor of ${doseName(dose)}`, part.factor, '', isDisabled, (value, event) => change({ dose: { sum: { [dose.id]: { factor: Math.min(Math.max(value, 0), 1000) } } } }, event))}` : nothing}${why ? html`<span class="dim">${why.words}</span>` : nothing}</div>`;
    })}${missing ? html`<p class="note why">${icon('warning', 12)} The sum is ${missing}.</p>` : nothing}</section>`;
}

/** The file: its grid, its components. */
function fileBlock(scene, shown, isDisabled, change) {
  const { grid } = scene.dose;
  return html`${factsBlock(shown)}<section class="block"><div class="buttons dose-last"><button class=${grid ? 'on' : ''} aria-pressed=${grid} ?disabled=${isDisabled} @click=${(event) => change({ dose: { id: shown.id, grid: !grid } }, event)}>Box of the grid</button></div></section>`;
}

function factsBlock(shown) {
  const grids = new Set(shown.components.map(({ grid }) => JSON.stringify(grid.lps_mm_from_ijk)));
  const [{ grid }] = shown.components;
  const rows = [
    ['Grid', `${grid.size.join(' × ')} of ${grid.spacing_mm.map((mm) => number(mm, 1)).join(' × ')} mm`],
    grids.size > 1 && ['Other components', 'have grids of their own'],
    ['Axes of the grid', grid.orientation],
    shown.masked && ['Outside the body', 'not known'],
  ].filter(Boolean);
  return html`<details class="block more"><summary>${icon('chevronDown', 12)}<span>The file: ${doseWords(shown)}</span></summary>
    <dl class="dose-list">${rows.map(([name, value]) => html`<dt>${name}</dt><dd>${value}</dd>`)}</dl>
    <table><thead><tr><th scope="col">Component</th><th scope="col">Highest</th><th scope="col">in body</th></tr></thead>
      <tbody>${shown.components.map((part) => html`<tr><td>${quantityName(part.quantity)}${part.per_ppm ? ', per ppm' : ''}</td><td>${significant(part.high)} ${unitText(part.unit)}</td><td>${Number.isFinite(part.body_high) ? significant(part.body_high) : '–'}</td></tr>`)}</tbody></table></details>`;
}
