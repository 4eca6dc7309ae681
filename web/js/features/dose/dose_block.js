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
import { coloursSelect, levelBlock, tableSelect } from './dose_level.js';
import { componentNames } from './dose_probe.js';
import { referenceMore, referenceSelect, tissueSelect } from './dose_reference.js';
import { quantitySelect } from './dose_rows.js';
import { surfacesPatch } from './level_list.js';
import { bloodBlock, isoeffectiveBlock, weightsBlock } from './dose_weights.js';
import { checkbox, numberField, segment } from '../../parts/fields.js';
import { number, significant, unitText } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { say } from './later_words.js';

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
  return html`<section class="block"><h3>${icon('dose')} ${quantityName(quantity)} <span class="dim">${say.doseWord({ dose: doseName(shown) })}</span></h3>
      <p class="note">${aboutWords(plan, scene)}</p>${reasonNote(world)}
      <dl class="dose-list"><dt>${say.quantity}</dt><dd>${quantitySelect(world, shown, { tabindex: 0 })}</dd>
        <dt>${say.hundredIs}</dt><dd>${referenceSelect(world, { tabindex: 0 })}</dd>${referenceMore(world, isDisabled, change)}
        <dt>${say.weights}</dt><dd>${tissueSelect(world, { tabindex: 0 })}</dd>
        <dt>${say.levels}</dt><dd>${tableSelect(world, { tabindex: 0 })}</dd>
        <dt>${say.levelColours}</dt><dd>${coloursSelect(world, { tabindex: 0 })}</dd></dl></section>
    ${bloodBlock(world, shown, isDisabled, change)}
    ${isWeighted(quantity) ? weightsBlock(world, isDisabled, change) : nothing}
    ${quantity === 'isoeffective' ? isoeffectiveBlock(world, isDisabled, change) : nothing}
    ${drawnBlock(world, scene, isDisabled, change)}
    ${coverageBlock(world, isDisabled, change)}
    ${plan.doses.length > 1 ? html`${sumBlock(world, shown, isDisabled, change)}${compareBlock(world, isDisabled, change)}` : sumBlock(world, shown, isDisabled, change)}
    ${fileBlock(scene, shown, isDisabled, change)}`;
}

const totals = { weighted: say.sumWeighted, total: say.sumTotal, isoeffective: say.sumIsoeffective };

/** "Boron + nitrogen + fast neutron + gamma, each with its weight. Gy(w) per 250 kW-min …" */
function aboutWords(plan, scene) {
  const { quantity } = scene.dose;
  const dose = shownDose(plan, scene);
  const isSum = totals[quantity] && !(quantity === 'total' && dose.components.some((part) => part.quantity === 'total'));
  const basis = basisWords(plan, scene);
  return isSum ? totals[quantity]({ parts: componentNames(dose).join(' + '), basis }) : `${basis}.`;
}

/** Why nothing is drawn, when it is for another reason. */
function reasonNote({ room, doses }) {
  const { result, error } = doses.scale.value;
  const reason = error || (result && !result.drawn && result.reason);
  return reason && reason !== shownDose(room.plan.value, room.scene.value).fit_reason
    ? html`<p class="note why">${icon('warning', 12)} ${say.nothingDrawn({ reason: reason.replace(/[.]$/, '') })}</p>`
    : nothing;
}

function otherBlock(dose, isDisabled, change, plan, scene) {
  return html`<section class="block"><h3>${icon('dose')} ${say.doseNamed({ dose: doseName(dose) })}</h3><p class="note">${doseWords(dose)}.</p>
      <div class="buttons"><button ?disabled=${isDisabled} @click=${(event) => change(choosePatch(plan, scene, dose), event)}>${say.showThis}</button></div></section>${factsBlock(dose)}`;
}

function drawnBlock({ ui, doses }, scene, isDisabled, changeScene) {
  const { wash, lines, surfaces, interpolation, error } = scene.dose;
  const change = (part, name) => (value, event) => changeScene({ dose: { [part]: { [name]: value } } }, event);
  const limits = (part, name, low, high) => (value, event) => change(part, name)(Math.min(Math.max(value, low), high), event);
  return html`<section class="block"><h3>${say.drawnAs}</h3>
    <div class="checks dose-checks">${checkbox(ui.keys.tip(say.lines, 'lines'), lines.visible, isDisabled, change('lines', 'visible'))}${checkbox(ui.keys.tip(say.washD, 'wash'), wash.visible, isDisabled, change('wash', 'visible'))}
      ${checkbox(say.surfaces, surfaces.visible, isDisabled, (isOn, event) => changeScene(surfacesPatch(scene, doses.reference.value, isOn), event), say.surfacesAre)}</div>
    <dl class="dose-list"><dt>${say.wash}</dt><dd>${segment(
      say.washStyle,
      [
        ['bands', say.bands],
        ['smooth', say.smooth],
      ],
      wash.style,
      isDisabled,
      change('wash', 'style'),
    )}</dd>
      <dt>${say.washFrom}</dt><dd>${numberField(say.washFromPercent, wash.below_percent, '%', isDisabled, limits('wash', 'below_percent', 0, 100))}</dd>
      <dt>${say.opacity}</dt><dd class="pair"><input type="range" min="0" max="100" step="1" .value=${live(String(Math.round(wash.opacity * 100)))} aria-label=${say.washOpacity} ?disabled=${isDisabled}
        @input=${(event) => change('wash', 'opacity')(event.target.valueAsNumber / 100, event)}>${numberField(say.washOpacityPercent, Math.round(wash.opacity * 100), '%', isDisabled, (value, event) => change('wash', 'opacity')(Math.min(Math.max(value, 0), 100) / 100, event))}</dd>
      <dt>${say.lineWidth}</dt><dd>${numberField(say.isodoseWidth, lines.width_px, 'px', isDisabled, limits('lines', 'width_px', 1, 8))}</dd>
      <dt>${say.surfacesIn}</dt><dd>${segment(
        say.surfaceGrid,
        [
          ['dose', say.doseGrid],
          ['univels', say.univels, say.univelsAre],
        ],
        surfaces.grid,
        isDisabled,
        change('surfaces', 'grid'),
      )}</dd>
      <dt>${say.betweenVoxels}</dt><dd>${segment(
        say.betweenDoseVoxels,
        [
          ['linear', say.trilinear],
          ['slice', say.inSlices, say.inSlicesIs],
        ],
        interpolation,
        isDisabled,
        (value, event) => changeScene({ dose: { interpolation: value } }, event),
      )}</dd></dl>
    <div class="checks dose-checks">${checkbox(say.washOnVolume, wash.volume, isDisabled, change('wash', 'volume'))}${checkbox(say.clipsCut, surfaces.clipped, isDisabled, change('surfaces', 'clipped'))}
      ${checkbox(say.errorWash, error, isDisabled, (value, event) => changeScene({ dose: { error: value } }, event), say.errorWashIs)}</div></section>`;
}

/** How many times the dose counts, and which others are added. */
function sumBlock({ room }, shown, isDisabled, change) {
  const [plan, scene] = [room.plan.value, room.scene.value];
  const { factor, sum, quantity } = scene.dose;
  const per = shown.per ? unitText(shown.per.replace(/^per /, '')) : '';
  const others = plan.doses.filter((dose) => dose !== shown);
  const missing = missingWords([...new Set(summedDoses(plan, scene).flatMap((dose) => missingOf(dose, quantity)))]);
  return html`<section class="block"><h3>${say.timesAndSum} <span class="dim">${per ? say.fileIsPer({ unit: per }) : say.fileIsPerNothing}</span></h3>
    <dl class="dose-list"><dt>${doseName(shown)} ×</dt><dd>${numberField(say.factorOf({ dose: doseName(shown) }), factor, '', isDisabled, (value, event) => change({ dose: { factor: Math.min(Math.max(value, 1e-9), 1e9) } }, event))}</dd></dl>
    ${others.map((dose) => {
      const part = sum[dose.id];
      const why = joinReason(plan, scene, shown, dose, true, room.accepted.value);
      return html`<div class="dose-part" title=${why?.reason ?? nothing}>${checkbox(`+ ${doseName(dose)}`, Boolean(part), isDisabled || Boolean(why && !part), (on, event) => change({ dose: { sum: { [dose.id]: on ? { factor: 1 } : null } } }, event), doseWords(dose))}
        ${part ? html`<span>×</span>${numberField(say.factorOf({ dose: doseName(dose) }), part.factor, '', isDisabled, (value, event) => change({ dose: { sum: { [dose.id]: { factor: Math.min(Math.max(value, 0), 1000) } } } }, event))}` : nothing}${why ? html`<span class="dim">${why.words}</span>` : nothing}</div>`;
    })}${missing ? html`<p class="note why">${icon('warning', 12)} ${say.sumIs({ missing })}</p>` : nothing}</section>`;
}

/** The file: its grid, its components. */
function fileBlock(scene, shown, isDisabled, change) {
  const { grid } = scene.dose;
  return html`${factsBlock(shown)}<section class="block"><div class="buttons dose-last"><button class=${grid ? 'on' : ''} aria-pressed=${grid} ?disabled=${isDisabled} @click=${(event) => change({ dose: { id: shown.id, grid: !grid } }, event)}>${say.gridBox}</button></div></section>`;
}

function factsBlock(shown) {
  const grids = new Set(shown.components.map(({ grid }) => JSON.stringify(grid.lps_mm_from_ijk)));
  const [{ grid }] = shown.components;
  const rows = [
    [say.grid, say.gridIs({ size: grid.size.join(' × '), spacing: grid.spacing_mm.map((mm) => number(mm, 1)).join(' × ') })],
    grids.size > 1 && [say.otherComponents, say.ownGrids],
    [say.gridAxes, grid.orientation],
    shown.masked && [say.outsideBody, say.notKnown],
  ].filter(Boolean);
  return html`<details class="block more"><summary>${icon('chevronDown', 12)}<span>${say.file({ about: doseWords(shown) })}</span></summary>
    <dl class="dose-list">${rows.map(([name, value]) => html`<dt>${name}</dt><dd>${value}</dd>`)}</dl>
    <table><thead><tr><th scope="col">${say.component}</th><th scope="col">${say.highest}</th><th scope="col">${say.inBody}</th></tr></thead>
      <tbody>${shown.components.map((part) => html`<tr><td>${part.per_ppm ? say.perPpm({ component: quantityName(part.quantity) }) : quantityName(part.quantity)}</td><td>${significant(part.high)} ${unitText(part.unit)}</td><td>${Number.isFinite(part.body_high) ? significant(part.body_high) : '–'}</td></tr>`)}</tbody></table></details>`;
}
