// Dose-volume histograms: plot, choices, table, files.
import { html, nothing } from '../../../../lib/lit-html.js';
import { classMap } from '../../../../lib/directives/class-map.js';
import { live } from '../../../../lib/directives/live.js';
import { limitAt, metricWords } from '../dose_constraints.js';
import {
  boundsWords,
  densityAt,
  dvhCsv,
  dvhJson,
  figureNames,
  figureWords,
  openOf,
  readAt,
  shareOf,
  shareWords,
  volumeFrom,
} from '../dose_dvh.js';
import { populationWords } from '../dose_population.js';
import { ownRegions } from '../../../room/identity.js';
import { doseWaitReason } from '../../../room/waits.js';
import { doubtMark, downloads, instead, options, staleMark, tableButton, withoutMark } from './chart_parts.js';
import { dot, dotted, fontOf, hatched, legible, plot, write } from './chart_plot.js';
import { basisRows, doseName, quantityName, regionName, regionOf, unitPer } from './chart_words.js';
import { numberField, segment } from '../../../parts/fields.js';
import { listed, number, significant, unitText } from '../../../parts/format.js';
import { icon } from '../../../parts/icons.js';
import { variables } from '../../../parts/mount.js';
import { say } from './histogram_words.js';

const colorOf = ({ room }, { region }) => legible(room.scene.value.regions[region]?.color ?? '#c8c8c8');
const curveName = ({ room }, curve) =>
  `${regionName(room.plan.value)(curve.region)}${curve.of ? `, ${doseName(room.plan.value, curve.dose)}` : ''}`;
const unitOf = ({ curves }) => unitText(curves.dvh.value.result?.unit ?? '');
const shownQuantity = ({ room, curves }) => curves.quantity.value || room.scene.value.dose.quantity;
const percentWords = (percent) => number(percent, 1);
const shareAt = (curve, dose) => shareWords(curve, volumeFrom(curve, dose), percentWords);
/** "brain: in the band, 18 % has no dose" */
export function bandName(curve, name, isDifferential) {
  if (!openOf(curve)) return name;
  const share = shareOf(curve, openOf(curve), 'percent');
  return (isDifferential ? say.noDose : say.inBand)({ curve: name, percent: number(share, share < 10 ? 1 : 0) });
}
const swatch = (world, curve) =>
  html`<i class=${classMap({ swatch: true, dashed: curve.of > 0 })} ${variables({ '--color': colorOf(world, curve) })}></i>`;

/** The dose at the crosshair in the quantity of the histograms; null: not known. */
function doseHere({ curves, doses }) {
  const { result } = doses.here.value;
  const found = curves.quantity.value
    ? [...(result?.totals ?? []), ...(result?.components ?? [])].find(({ quantity }) => quantity === curves.quantity.value)
    : result;
  return Number.isFinite(found?.value) ? found.value : null;
}

/** The quantities that the dose shown has. */
function quantities({ room }) {
  const [plan, { dose }] = [room.plan.value, room.scene.value];
  const shown = plan.doses.find(({ id }) => id === dose.id) ?? plan.doses[0];
  const own = shown.components.map(({ quantity }) => quantity);
  return [...new Set([dose.quantity, ...(own.includes('boron') ? ['weighted', 'total'] : []), ...own])];
}

function controls(world) {
  const { room, curves } = world;
  const toggle = (id) => {
    const hidden = new Set(curves.hidden.value);
    if (!hidden.delete(id)) hidden.add(id);
    curves.hidden.value = hidden;
  };
  const { quantity } = room.scene.value.dose;
  return html`<div class="chart-choices">
    ${segment(
      say.kind,
      [
        ['cumulative', say.cumulative],
        ['differential', say.differential],
      ],
      curves.isDifferential.value ? 'differential' : 'cumulative',
      false,
      (id) => {
        curves.isDifferential.value = id === 'differential';
      },
    )}
    ${segment(
      say.volumeUnit,
      [
        ['percent', '%'],
        ['cm3', 'cm³'],
      ],
      curves.unit.value,
      false,
      (id) => {
        curves.unit.value = id;
      },
    )}
    <select aria-label=${say.quantity} @change=${(event) => {
      curves.quantity.value = event.target.value === quantity ? '' : event.target.value;
    }}>${quantities(world).map((id) => html`<option value=${id} .selected=${live(id === shownQuantity(world))}>${quantityName(id)}</option>`)}</select>
    <label class="chart-basis"><span>${say.weights}</span><select aria-label=${say.weightsOf} @change=${(event) => {
      curves.tissue.value = event.target.value;
    }}>${[['', say.eachOwn], ...ownRegions(room.plan.value, room.scene.value).map(({ id, name }) => [id, say.ofRegion({ region: name })])].map(([id, words]) => html`<option value=${id} .selected=${live(id === curves.tissue.value)}>${words}</option>`)}</select></label>
    ${downloads(world, 'dvh', files(world))}</div>
    <div class="chart-chips" role="group" aria-label=${say.regions}>${curves.regions.value.map(
      ({ id, name }) => html`<button class="chart-chip" aria-pressed=${!curves.hidden.value.has(id)} @click=${() => toggle(id)}>
      <i class="swatch" ${variables({ '--color': legible(room.scene.value.regions[id].color) })}></i>${name}</button>`,
    )}</div>`;
}

/** Which univels of a region count, for histograms, limits and coverage: its name and its switch. */
export function populationSelect({ room, curves }) {
  const { population } = curves;
  const set = (event) => room.patchScene({ dose: { population: event.target.value } }, { at: event.timeStamp });
  return html`<select class="chart-population" aria-label=${say.univels} title=${say.univelsAre} ?disabled=${!room.canChange.value} @change=${set}>
    ${population ? nothing : html`<option value="" selected>${say.usual}</option>`}${['own', 'whole'].map((id) => html`<option value=${id} .selected=${live(id === population)}>${populationWords(id)}</option>`)}</select>`;
}

function files(world) {
  const { room, curves } = world;
  if (!curves.curves.value.length) return null;
  const about = () => ({
    words: basisRows(world, shownQuantity(world), curves.dvh.value.result, {
      basis: basisWords(world),
      population: populationWords(curves.population),
    }),
    regionName: regionName(room.plan.value),
    unit: unitOf(world),
  });
  return { csv: () => dvhCsv(curves.curves.value, about()), json: () => dvhJson(curves.curves.value, about()) };
}

/** Region at the crosshair, and how much of it has at least the dose there. */
function atCrosshair(world) {
  const { room, curves, probed } = world;
  const dose = doseHere(world);
  if (dose === null || curves.isDifferential.value) return nothing;
  const inside = (probed.value.result?.regions ?? [])
    .map((id) => curves.curves.value.find(({ region, of }) => region === id && !of))
    .find(Boolean);
  return html`<span class="chart-here">≥ ${significant(dose)} ${unitOf(world)}${inside ? html` <i class="swatch" title=${regionOf(room.plan.value, inside.region).name} ${variables({ '--color': colorOf(world, inside) })}></i> <b>${shareAt(inside, dose)}</b>` : nothing}</span>`;
}

/** The curve nearest to the pointer, of the dose shown: the part that is highlighted is one of it. */
function nearest(world, { value, yValue }) {
  const { curves, unit, isDifferential } = world.curves;
  const at = (curve) => shareOf(curve, isDifferential.value ? densityAt(curve, value) : volumeFrom(curve, value), unit.value);
  return curves.value.filter(({ of }) => !of).sort((a, b) => Math.abs(at(a) - yValue) - Math.abs(at(b) - yValue))[0];
}

/** The part that the pointer is about: in the nearest curve's region the univels with at least the dose there or, for a differential one, those in the bin. */
function partAt(world, place) {
  const curve = nearest(world, place);
  if (!curve || !(place.value >= 0)) return null;
  const { end } = world.curves.points.value;
  const bin = end / 100;
  const low = world.curves.isDifferential.value ? Math.floor(place.value / bin) * bin : place.value;
  const { quantity, tissue } = world.curves;
  return {
    region: curve.region,
    low,
    high: world.curves.isDifferential.value ? low + bin : null,
    quantity: quantity.value,
    tissue: tissue.value,
  };
}

function spec(world) {
  const { room, curves, highlight } = world;
  const shown = curves.curves.value;
  const { doses, values, tops, end } = curves.points.value;
  const isDifferential = curves.isDifferential.value;
  const top =
    isDifferential || curves.unit.value === 'cm3' ? Math.max(1e-9, ...values.flat(), ...tops.flatMap((list) => list ?? [])) * 1.04 : 100;
  const colors = shown.map((curve) => colorOf(world, curve));
  return {
    key: JSON.stringify([shown.map(({ region, of }) => [region, of]), colors, end, top]),
    marks: JSON.stringify([doseHere(world), room.scene.value.constraints ?? {}, shownQuantity(world), curves.tissue.value]),
    data: world.memo('dvh', [doses, values], () => [doses, ...values]),
    options: () => ({
      scales: { x: { time: false, range: [0, end] }, y: { range: [0, top] } },
      axes: [
        { size: 20, gap: 3 },
        { size: 36, gap: 4, values: (_, ticks) => ticks.map((tick) => (top >= 10 ? number(tick) : significant(tick))) },
      ],
      series: [
        {},
        ...shown.map((curve, at) => ({
          stroke: colors[at],
          width: 1.6,
          dash: curve.of ? [6, 4] : undefined,
          pxAlign: 0,
          points: { show: false },
        })),
      ],
    }),
    below(chart, pen, px) {
      const xs = doses.map((dose) => chart.valToPos(dose, 'x', true));
      const ys = (list) => list.map((value) => chart.valToPos(value, 'y', true));
      tops.forEach((list, at) => list && hatched(pen, px, xs, ys(values[at]), ys(list), colors[at]));
    },
    above(chart, pen, px) {
      const x = (dose) => chart.valToPos(dose, 'x', true);
      const y = (value) => chart.valToPos(value, 'y', true);
      const here = doseHere(world);
      if (here !== null && here <= end) {
        dotted(chart, pen, px, x(here));
        if (!isDifferential)
          for (const { curve, cm3 } of readAt(shown, here))
            dot(pen, px, x(here), y(shareOf(curve, cm3, curves.unit.value)), colorOf(world, curve));
      }
      if (!isDifferential) limitMarks(world, chart, pen, px);
      curveNames(world, chart, pen, px);
    },
    pointed(place) {
      curves.pointedDose.value = place && place.value >= 0 && place.value <= end ? place : null;
      const part = curves.pointedDose.value && partAt(world, place);
      if (part) highlight.show(part);
      else highlight.end();
    },
    clicked(place, event) {
      const part = partAt(world, place);
      if (!part) return;
      highlight.end();
      room.patchScene({ dose: { coverage: { visible: true, ...part, unit: 'dose' } } }, { at: event.timeStamp });
      const said = {
        region: regionName(room.plan.value)(part.region),
        low: significant(part.low),
        high: significant(part.high),
        unit: unitOf(world),
      };
      world.ui.notify('ok', (part.high === null ? say.highlightedFrom : say.highlighted)(said), 'coverage', {
        word: say.hide,
        act: () => room.patchScene({ dose: { coverage: { visible: false } } }),
      });
    },
  };
}

/** Triangles where limits of the regions shown stand. */
function limitMarks(world, chart, pen, px) {
  const { room, curves } = world;
  const quantity = shownQuantity(world);
  for (const constraint of Object.values(room.scene.value.constraints ?? {})) {
    const curve = curves.curves.value.find(({ region, of }) => region === constraint.region && !of);
    if (!curve || constraint.quantity !== quantity || (constraint.tissue ?? '') !== curves.tissue.value) continue;
    const { dose, percent, cm3 } = limitAt(constraint);
    const volume = percent !== undefined ? (percent * curve.volume) / 100 : (cm3 ?? 0);
    const [x, y] = [chart.valToPos(dose, 'x', true), chart.valToPos(shareOf(curve, volume, curves.unit.value), 'y', true)];
    if (dose > curves.points.value.end) continue;
    pen.fillStyle = colorOf(world, curve);
    const side = constraint.side === 'at-most' ? 1 : -1; // points to where the curve has to be
    pen.beginPath();
    pen.moveTo(x, y);
    pen.lineTo(x - 4 * px, y - side * 7 * px);
    pen.lineTo(x + 4 * px, y - side * 7 * px);
    pen.fill();
    const isRight = x < chart.bbox.left + 0.6 * chart.bbox.width;
    if (chart.width > 420)
      write(
        pen,
        px,
        `${regionName(room.plan.value)(constraint.region)} ${metricWords(constraint.metric, unitOf(world))} ${constraint.side === 'at-most' ? '≤' : '≥'} ${significant(constraint.limit)}`,
        x + (isRight ? 8 : -8) * px,
        y - side * 8 * px,
        { color: '#b9c0c9', align: isRight ? 'left' : 'right' },
      );
  }
}

/** Names beside the curves, where they do not lie over each other. */
function curveNames(world, chart, pen, px) {
  const taken = [];
  const { doses, values, tops } = world.curves.points.value;
  const { left, top, width, height } = chart.bbox;
  world.curves.curves.value.forEach((curve, at) => {
    const name = bandName(curve, curveName(world, curve), world.curves.isDifferential.value);
    const high = Math.max(...values[at]);
    for (const part of [0.5, 0.3, 0.7, 0.15, 0.85, 0.05]) {
      const index = values[at].findLastIndex((value) => value >= high * part);
      const [x, y] = [chart.valToPos(doses[index], 'x', true) + 6 * px, chart.valToPos(values[at][index], 'y', true)];
      pen.font = fontOf(Math.round(11 * px));
      const box = [x, y - 8 * px, x + pen.measureText(name).width, y + 8 * px];
      if (
        box[2] > left + width ||
        box[1] < top ||
        box[3] > top + height ||
        taken.some((other) => box[0] < other[2] && other[0] < box[2] && box[1] < other[3] && other[1] < box[3])
      )
        continue;
      taken.push(box);
      return void write(pen, px, name, x, y, { color: colorOf(world, curve) });
    }
    if (!tops[at]) return undefined;
    const index = Math.floor(doses.length / 40); // in the band itself
    const y = chart.valToPos((values[at][index] + tops[at][index]) / 2, 'y', true);
    return void write(pen, px, name, chart.valToPos(doses[index], 'x', true), y, { color: colorOf(world, curve) });
  });
}

function card(world) {
  const { curves } = world;
  const place = curves.pointedDose.value;
  if (!place) return nothing;
  const unit = unitOf(world);
  const rows = curves.isDifferential.value
    ? curves.curves.value.map((curve) => [
        curve,
        `${significant(shareOf(curve, densityAt(curve, place.value), curves.unit.value))} ${curves.unit.value === 'cm3' ? 'cm³' : '%'} / ${unit}`,
        '',
      ])
    : readAt(curves.curves.value, place.value).map(({ curve, cm3 }) => [
        curve,
        shareWords(curve, cm3, percentWords),
        `${boundsWords([cm3, cm3 + openOf(curve)], significant)} cm³`,
      ]);
  return html`<div class="card chart-card" data-side=${place.value > curves.points.value.end / 2 ? 'left' : 'right'} ${variables({ '--x': `${place.x}px` })}><b>${(curves.isDifferential.value ? say.at : say.atLeast)({ value: significant(place.value), unit })}</b>
    <table><tbody>${rows.slice(0, 6).map(([curve, first, second]) => html`<tr><th scope="row">${swatch(world, curve)} ${curveName(world, curve)}</th><td>${first}</td><td>${second}</td></tr>`)}</tbody></table>${rows.length > 6 ? html`<span class="dim">${say.more({ n: rows.length - 6 })}</span>` : nothing}</div>`;
}

/** The table twin: figures of each region. */
export function dvhTable(world) {
  const { curves } = world;
  const unit = unitOf(world);
  const level = curves.level.value ?? Number((curves.points.value.end / 2).toPrecision(2));
  const cell = (bounds) => html`<td>${boundsWords(bounds, significant)}</td>`;
  return html`<div class="chart-table" role="group" tabindex="0" aria-label=${say.figures}><table><thead><tr><th scope="col">${say.region}</th><th scope="col">cm³</th><th scope="col">${say.univelsColumn}</th>${['min', 'mean', 'max', ...figureNames].map((name) => html`<th scope="col">${figureWords(name).replace('%', ' %')}</th>`)}
      <th scope="col"><span class="chart-level">V ≥ ${numberField(say.doseIn({ unit }), level, '', false, (value) => {
        curves.level.value = Math.max(0, value);
      })}</span></th></tr></thead>
    <tbody>${curves.curves.value.map(
      (
        curve,
      ) => html`<tr><th scope="row">${swatch(world, curve)} ${curveName(world, curve)}${curve.missing ? html` <span class="warn" title=${withoutWords(curve)}>${say.withoutDose({ cm3: significant(curve.missing) })}</span>` : nothing}</th><td>${number(curve.volume, 2)}</td><td>${number(curve.univels)}</td>
      ${['min', 'mean', 'max', ...figureNames].map((name) => cell(curve.figures[name]))}<td>${shareAt(curve, level)}</td></tr>`,
    )}</tbody></table></div>`;
}

/** How well the isodoses of the levels fit the targets. */
export function conformityTable(world) {
  const { curves, room } = world;
  const rows = curves.curves.value.flatMap((curve) => curve.conformity.map((row) => ({ curve, ...row })));
  if (!rows.length) return nothing;
  const unit = unitOf(world);
  return html`<details class="more chart-more"><summary>${icon('chevronDown', 12)} ${say.conformity}</summary><div class="chart-table" role="group" tabindex="0" aria-label=${say.conformity}><table><thead><tr><th scope="col">${say.target}</th><th scope="col">${listed(say.level, unit)}</th><th scope="col">${say.isodoseCm3}</th><th scope="col">${say.coveredCm3}</th><th scope="col" title=${say.paddickIs}>${say.paddick}</th><th scope="col" title=${say.rtogIs}>${say.rtog}</th></tr></thead>
    <tbody>${rows.map((row) => html`<tr><th scope="row">${regionName(room.plan.value)(row.curve.region)}</th>${[row.value, row.isodose_cm3, row.covered_cm3, row.paddick, row.rtog].map((value) => html`<td>${significant(value ?? NaN)}</td>`)}</tr>`)}</tbody></table></div>
    <p class="chart-method">${say.conformityIs}</p></details>`;
}

const withoutWords = (curve) => (curve.isPartial ? say.missingBounds : say.missingLittle)({ cm3: significant(curve.missing) });

/** The unit of the volumes: "% of the whole volume", "cm³ per Gy(w)". */
export function axisWords(world) {
  const isVolume = world.curves.unit.value === 'cm3';
  const unit = unitOf(world);
  if (world.curves.isDifferential.value) return (isVolume ? say.cm3Per : say.percentPer)({ unit });
  return isVolume ? 'cm³' : say.percentOfVolume;
}

/** Regions shown that have no curve, with the reason. */
export const leftWords = ({ room, curves }) =>
  (curves.dvh.value.result?.left ?? [])
    .filter(({ region }) => curves.shownRegions.value.some(({ id }) => id === region))
    .map(({ region, reason }) => say.leftOut({ region: regionName(room.plan.value)(region), reason }))
    .join(' ');

/** Names the weights of the histograms: "each region's own weights"; '' none. */
export const basisWords = ({ curves }) => curves.curves.value[0]?.basis ?? '';

/** @param {{isInline: boolean}} how isInline: choices and table beside the plot, as there is room */
export function dvhPart(world, { isInline }) {
  const { room, curves } = world;
  const state = curves.dvh.value;
  const noRegion = curves.regions.value.length ? '' : say.noRegion;
  const reason = instead(state, {
    empty: state.result && !curves.curves.value.length && (noRegion || leftWords(world) || state.result.reason || say.noUnivels),
    idle: doseWaitReason(room) || noRegion,
  });
  const isTable = curves.isTable.value.dvh && !isInline;
  const left = leftWords(world);
  const words = html`<p class="chart-method" title=${`${state.result?.method ?? ''} ${left}`}>${state.result?.method ?? ''}${left ? html` <span class="warn">${left}</span>` : nothing}</p>`;
  return html`<section class=${classMap({ 'chart-part': true, 'chart-dvh': true, old: state.isOld })} aria-label=${say.histogram}>
    <header class="chart-head"><h2>${isInline ? say.histogram : say.dvh}</h2>${populationSelect(world)}<span class="dim chart-kind">${curves.isDifferential.value ? say.differentialKind : say.cumulativeKind}</span>${staleMark(state.isOld)}${withoutMark(state.result?.missing)}${doubtMark(world)}${left && !reason ? html`<span class="chart-without warn" title=${left}>${icon('warning', 12)} ${left}</span>` : nothing}<span class="grow"></span>
      ${reason ? nothing : atCrosshair(world)}${isInline ? nothing : html`${options(world, 'dvh', say.choices, html`${controls(world)}${words}`)}${tableButton(world, 'dvh', say.asTable)}`}</header>
    ${isInline ? controls(world) : nothing}
    ${
      reason ??
      html`${
        isTable
          ? dvhTable(world)
          : html`<div class="chart-box"><div class="chart-plot" role="img" aria-label=${(curves.isDifferential.value ? say.differentialOf : say.cumulativeOf)({ curves: curves.curves.value.map((curve) => curveName(world, curve)).join(', ') })} ${plot(spec(world))}></div>${card(world)}</div>
      <p class="chart-foot"><span>${axisWords(world)}</span><span>${[unitPer(state.result), quantityName(shownQuantity(world)), basisWords(world)].filter(Boolean).join(', ')}</span></p>`
      }
      ${isInline ? html`${dvhTable(world)}${words}${conformityTable(world)}` : nothing}`
    }</section>`;
}
