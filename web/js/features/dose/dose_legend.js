// Legend of a picture with dose: its levels with colour, value and unit, its reference, and whether it may not belong.
import { html, nothing } from '../../../lib/lit-html.js';
import { doseName, isOn, missingWords, referenceWords, shownDose, unitOf } from '../../room/dose.js';
import { levelsOf, percentOf, doseOf } from './level_list.js';
import { gradientOf, hasLines, shownScale, washKind } from './dose_scales.js';
import { isTarget } from '../../room/plan.js';
import { isInSpace } from '../../room/kinds.js';
import { toPicture } from '../../parts/vec.js';
import { ofFits } from '../fits/feature.js';
import { number, significant } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { variables } from '../../parts/mount.js';
import { say } from './drawn_words.js';

const rowPx = 16;
const [narrow, narrowest] = [320, 240]; // px: of a pane with the legend at its foot, and with one only while it is active
const scaleRows = 4; // of the colours of a comparison or an error
const besidesPx = 120; // of a pane: letters, scale, the other legends

/** @param {object} world {room, doses} @param {import('../../room/view.js').ViewState} view @param {[number, number]} size of the pane @param {boolean} isLeftTaken by another legend */
export function doseLegend({ room, ui, doses }, view, [width, height], isLeftTaken) {
  const is3d = isInSpace(view.kind);
  const [plan, scene] = [room.plan.value, room.scene.value];
  const dose = shownDose(plan, scene);
  const { result: answer, isOld } = doses.scale.value;
  if (
    !dose ||
    !answer?.drawn ||
    !doses.isOfScene(answer) ||
    !isShown(scene, is3d) ||
    (width < narrowest && !is3d && ui.active.value !== view.number)
  )
    return nothing;
  const { surfaces, compare } = scene.dose;
  const isWash = washKind(plan, scene) === 'levels';
  const isLines = hasLines(plan, scene);
  const reference = doses.reference.value;
  const unit = unitOf(dose, scene.dose.quantity);
  const isUsed = (level) =>
    level.visible && ((level.wash && isWash) || (level.line && isLines) || (is3d && level.surface && surfaces.visible));
  const all = levelsOf(scene, reference).filter(isUsed);
  const scale = shownScale(plan, scene, reference, significant);
  const most = Math.max(1, Math.floor((height - besidesPx) / 2 / rowPx) - 1 - (scale ? scaleRows : 0));
  const levels = all.slice(0, all.length > most ? Math.max(1, most - 1) : most);
  const words = referenceWords(plan, scene.dose.reference);
  const notes = [missingWords(answer.missing ?? [])].filter(Boolean);
  const mark = ofFits(room)?.wordMark({ room }, ['dose']) ?? nothing;
  const isLeft = !isLeftTaken && isAtRight(plan, view);
  const place = width < narrow ? 'foot' : isLeft ? 'left' : '';
  return html`<div class=${`legend dose-legend ${place}${scale ? ' scaled' : ''}${isOld ? ' old' : ''}`} role="group" aria-label=${say.dose}>
    ${mark === nothing ? nothing : html`<p>${mark}</p>`}${notes.map((text) => html`<p class="warn">${icon('warning', 12)} ${text}</p>`)}${scale ? scaleLegend(scale, doses.gamma.value) : nothing}
    ${all.length ? html`<p class="dose-legend-head"><span>${say.percentOf({ reference: words })}</span> <span>${unit}</span></p>` : nothing}
    <ul>${levels.map((level) => html`<li><i class=${level.wash && isWash ? 'area' : 'line'} ${variables({ '--color': level.color })}></i><span>${number(percentOf(level, reference), isWhole(percentOf(level, reference)) ? 0 : 1)} %</span><span>${significant(doseOf(level, reference))}</span></li>`)}
      ${all.length > levels.length ? html`<li class="dim">${say.lower({ n: all.length - levels.length })}</li>` : nothing}</ul>
    ${compareWords(compare, plan)}</div>`;
}

/** True if the first target, where most dose is, stands in the right half of the picture. */
function isAtRight(plan, view) {
  const target = plan.regions.find(isTarget);
  const at = target?.center_mm && toPicture(view.painted.value.clip_from_lps_mm, target.center_mm);
  return Boolean(at) && at[0] > 0.5;
}

const isWhole = (value) => Math.abs(value - Math.round(value)) < 0.05;

/** True if a picture of this kind shows dose. In 3-D lines and wash lie on slices, caps and regions whose texture is dose. */
function isShown(scene, is3d) {
  const { wash, lines, surfaces, compare, coverage } = scene.dose;
  if (!is3d) return isOn(scene) && (wash.visible || lines.visible || compare.mode !== 'none' || coverage.visible);
  const hasPlane =
    Object.values(scene.image.slices).some(({ visible }) => visible) ||
    Object.values(scene.image.obliques ?? {}).some(({ visible }) => visible);
  const hasCap = Object.values(scene.clip).some((plane) => plane?.enabled);
  const hasTexture = Object.values(scene.regions).some(({ visible, texture }) => visible && texture === 'dose');
  const isFlat = wash.visible || lines.visible || compare.mode !== 'none';
  return (
    surfaces.visible ||
    coverage.visible ||
    (isFlat && (hasPlane || hasCap)) ||
    (wash.visible && (hasTexture || (wash.volume && scene.image.volume.visible)))
  );
}

/** Names the second dose, whose lines are dashed. */
function compareWords({ id, mode }, plan) {
  const second = plan.doses.find((dose) => dose.id === id);
  return second && (mode === 'lines' || mode === 'difference') ? html`<p>${say.dashed({ dose: doseName(second) })}</p>` : nothing;
}

/** The colours of a wash that is none of levels, with their ends; of how many voxels, once the server has counted them. */
function scaleLegend({ kind, title, ends, about, more }, { result, error, isOld }) {
  const why = kind === 'error' ? '' : error || (!isOld && result?.comparison_reason) || '';
  if (why) return html`<p class="warn">${icon('warning', 12)} ${say.notCompared({ reason: why })}</p>`;
  const domain = isOld || kind === 'error' ? null : result?.domain;
  const words = domain ? say.counted({ about, n: number(domain.voxels), all: number(domain.all_voxels) }) : about;
  return html`<p class="dose-scale-title" title=${more || nothing}>${title}</p><i class="dose-scale" ${variables({ '--scale': gradientOf(kind) })}></i>
    <p class="dose-scale-ends">${ends.map((end) => html`<span>${end}</span>`)}</p>${about ? html`<p class="dim">${words}</p><span class="hidden">${more}</span>` : nothing}`;
}
