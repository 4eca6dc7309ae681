// Doses along a beam or a distance measure: plot, choices, table, files.
import { html, nothing } from '../../../../lib/lit-html.js';
import { classMap } from '../../../../lib/directives/class-map.js';
import { live } from '../../../../lib/directives/live.js';
import { aligned, depthOf, lookOf, pointAt, profileCsv, profileJson, referenceGroups, valueAt } from '../dose_profile.js';
import { crosshair, crosshairPatch, shownImage } from '../../../room/plan.js';
import { doseWaitReason } from '../../../room/waits.js';
import { doubtMark, downloads, instead, options, staleMark, tableButton, withoutMark } from './chart_parts.js';
import { dot, dotted, fontOf, legible, plot, write } from './chart_plot.js';
import { basisRows, inUnit, quantityName, regionName, row, unitPer, weightWords } from './chart_words.js';
import { number, significant, unitText } from '../../../parts/format.js';
import { icon } from '../../../parts/icons.js';
import { variables } from '../../../parts/mount.js';
import { say } from './profile_words.js';

const resultOf = ({ curves }) => curves.profile.value.result;
const mm = (depth) => `${number(depth, 1)} mm`;

/** The depth of the crosshair on the line; null when it is further than 15 mm beside it. */
function hereOn(world) {
  const line = world.curves.chosenLine.value;
  const place = line && depthOf(line, crosshair(world.room.scene.value));
  const result = resultOf(world);
  const depth = place && result ? place.depth - result.zero : NaN;
  return place?.asideMm <= 15 && depth >= result?.depths[0] && depth <= result.depths.at(-1) ? depth : null;
}

function bandAt(world, depth) {
  const band = resultOf(world).bands.findLast(({ from, to }) => depth >= from && depth <= to);
  return band ? regionName(world.room.plan.value)(band.region) : say.outside;
}

/** The reference curves that stand beside the profile; null: none. */
const referenceOf = (world) => referenceGroups(resultOf(world).references).find(({ key }) => key === world.curves.reference.value) ?? null;

/** Name, colour and dashes of every curve that is drawn. */
function drawn(world) {
  const reference = referenceOf(world);
  return [
    ...resultOf(world).curves.map(({ quantity }) => ({ ...lookOf(quantity), isReference: false })),
    ...(reference?.curves ?? []).map(({ quantity }) => ({
      ...lookOf(quantity),
      name: say.ofPhantom({ curve: lookOf(quantity).name }),
      dash: [1, 4],
      isReference: true,
    })),
  ];
}

function controls(world) {
  const { curves } = world;
  const groups = resultOf(world) ? referenceGroups(resultOf(world).references) : [];
  return html`<div class="chart-choices">${
    groups.length
      ? html`<select aria-label=${say.references} @change=${(event) => {
          curves.reference.value = event.target.value;
        }}><option value="" .selected=${live(!curves.reference.value)}>${say.noReferences}</option>
      ${groups.map(({ key, name, unit, curves: list }) => html`<option value=${key} .selected=${live(key === curves.reference.value)}>${name}: ${list.map(({ quantity }) => lookOf(quantity).name).join(', ')}${unit ? `, ${unitText(unit)}` : ''}</option>`)}</select>`
      : nothing
  }${downloads(world, 'profile', files(world))}</div>`;
}

/** Where the depths of a line count from. */
export const depthWords = ({ kind }) => (kind === 'beam' ? say.mmFromEntry : say.mmFromFirst);

/** "entry 0.0 mm, peak 1.11 Gy(w) at 27.0 mm, advantage depth 85.0 mm" */
export function readOuts(result) {
  const { entry, peak, advantage, advantageReason, unit } = result;
  return [
    entry !== null && say.entryAt({ depth: mm(entry) }),
    peak && say.peakAt({ dose: inUnit(peak.value, unit), depth: mm(peak.depth) }),
    advantage !== null ? say.advantageAt({ depth: mm(advantage) }) : advantageReason && say.noAdvantage({ reason: advantageReason }),
  ]
    .filter(Boolean)
    .join(', ');
}

function lineChoice({ curves }) {
  const chosen = curves.chosenLine.value;
  if (curves.lines.value.length < 2) return html`<span class="dim chart-kind">${chosen?.name ?? ''}</span>`;
  return html`<select class="chart-line" aria-label=${say.line} @change=${(event) => {
    curves.line.value = event.target.value;
  }}>${curves.lines.value.map(({ key, kind, name }) => html`<option value=${key} .selected=${live(key === chosen.key)}>${kind === 'beam' ? name : say.measure({ name })}</option>`)}</select>`;
}

function files(world) {
  const { room, curves } = world;
  if (!resultOf(world)?.curves.length) return null;
  const line = curves.chosenLine.value;
  const place = (point) => `L ${point[0]} P ${point[1]} S ${point[2]} mm`;
  const about = () => ({
    words: [
      ...basisRows(world, room.scene.value.dose.quantity, resultOf(world)),
      row('line', say.rowLine, line.name, say.from({ place: place(line.from) }), say.to({ place: place(line.to) })),
      row(
        'depths',
        say.rowDepths,
        resultOf(world).zero ? say.depthsFromEntry({ mm: resultOf(world).zero.toFixed(2) }) : say.depthsFromFirst,
      ),
    ],
    regionName: regionName(room.plan.value),
  });
  return { csv: () => profileCsv(resultOf(world), about()), json: () => profileJson(resultOf(world), about()) };
}

function spec(world) {
  const { room, curves } = world;
  const result = resultOf(world);
  const looks = drawn(world);
  const reference = referenceOf(world);
  const data = world.memo('profile', [result, reference?.key], () => {
    const { depths, lists } = aligned(result, reference?.curves);
    return [depths, ...lists];
  });
  const [low, high] = ends(result);
  const topOf = (lists) => Math.max(1e-30, ...lists.flat().filter(Number.isFinite)) * 1.12;
  const top = topOf(data.slice(1, result.curves.length + 1));
  const isApart = reference !== null && reference.unit !== result.unit; // with an axis of their own, at the right
  const otherTop = reference ? topOf(data.slice(result.curves.length + 1)) : 1;
  const values = (_, ticks) => ticks.map((tick) => (tick === 0 ? '0' : significant(tick)));
  const line = curves.chosenLine.value;
  return {
    key: JSON.stringify([looks.map(({ name }) => name), low, high, top, line?.key, reference?.key, otherTop]),
    marks: JSON.stringify([hereOn(world), result.bands.map(({ region }) => room.scene.value.regions[region]?.color)]),
    data,
    options: () => ({
      padding: [22, 12, 0, 0],
      scales: {
        x: { time: false, range: [low, high] },
        y: { range: [0, isApart || !reference ? top : Math.max(top, otherTop)] },
        ...(isApart ? { other: { range: [0, otherTop] } } : {}),
      },
      axes: [
        { size: 20, gap: 3 },
        { size: 40, gap: 4, values },
        ...(isApart ? [{ scale: 'other', side: 1, size: 52, gap: 4, grid: { show: false }, values }] : []),
      ],
      series: [
        {},
        ...looks.map(({ color, dash, isReference }, at) => ({
          stroke: color,
          width: at === 0 ? 2 : 1.5,
          dash,
          ...(isReference && isApart ? { scale: 'other' } : {}),
          pxAlign: 0,
          points: { show: false },
        })),
      ],
    }),
    below: (chart, pen, px) => bands(world, chart, pen, px),
    above(chart, pen, px) {
      const x = (depth) => chart.valToPos(depth, 'x', true);
      const y = (value) => chart.valToPos(value, 'y', true);
      const here = hereOn(world);
      if (here !== null) {
        dotted(chart, pen, px, x(here));
        const value = valueAt(result.depths, result.curves[0].values, here);
        if (value !== null) dot(pen, px, x(here), y(value), looks[0].color);
      }
      const { left, top: above, width, height } = chart.bbox;
      const isRoomy = width > 300 * px;
      if (result.entry !== null && Math.abs(result.entry) > 0.5 && result.entry > low)
        tick(pen, px, x(result.entry), above + height, say.entry);
      if (result.advantage !== null && result.advantage < high && isRoomy) {
        const total = valueAt(result.depths, result.curves[0].values, result.advantage) ?? 0;
        tick(pen, px, x(result.advantage), above + height, '');
        write(pen, px, say.advantageMark({ mm: number(result.advantage, 0) }), x(result.advantage) + 4 * px, y(total) - 10 * px, {
          color: '#b9c0c9',
        });
      }
      if (result.peak) {
        dot(pen, px, x(result.peak.depth), y(result.peak.value), looks[0].color);
        const isRight = x(result.peak.depth) + 130 * px < left + width;
        if (isRoomy)
          write(
            pen,
            px,
            say.peakMark({ value: significant(result.peak.value), mm: number(result.peak.depth, 0) }),
            x(result.peak.depth) + (isRight ? 8 : -8) * px,
            y(result.peak.value) - 9 * px,
            { weight: 600, align: isRight ? 'left' : 'right' },
          );
      }
    },
    pointed(place) {
      curves.pointedDepth.value = place;
    },
    clicked({ value }, event) {
      const [plan, scene] = [room.plan.value, room.scene.value];
      room.patchScene(crosshairPatch(plan, shownImage(plan, scene), pointAt(line, value + result.zero), { isFree: true }), {
        at: event.timeStamp,
      });
    },
  };
}

/** Where the axis begins and ends: a little beyond what has a dose or lies in a region. */
function ends({ depths, curves, bands: list }) {
  const isThere = (depth, at) =>
    curves.some(({ values }) => Number.isFinite(values[at])) || list.some(({ from, to }) => depth >= from && depth <= to);
  const [first, last] = [depths.findIndex(isThere), depths.findLastIndex(isThere)];
  return first < 0 || first === last
    ? [depths[0], depths.at(-1)]
    : [Math.max(depths[0], depths[first] - 5), Math.min(depths.at(-1), depths[last] + 5)];
}

function tick(pen, px, x, foot, words) {
  [pen.strokeStyle, pen.lineWidth] = ['#b9c0c9', px];
  pen.beginPath();
  pen.moveTo(x, foot);
  pen.lineTo(x, foot - 10 * px);
  pen.stroke();
  if (words) write(pen, px, words, x + 4 * px, foot - 10 * px, { color: '#b9c0c9' });
}

/** Shades the regions along the line behind the curves, and names them in a bar above. */
function bands({ room, curves }, chart, pen, px) {
  const { left, top, width, height } = chart.bbox;
  const clamp = (x) => Math.min(Math.max(x, left), left + width);
  for (const { region, from, to } of curves.profile.value.result.bands) {
    const [a, b] = [clamp(chart.valToPos(from, 'x', true)), clamp(chart.valToPos(to, 'x', true))];
    if (b - a < px) continue;
    const color = legible(room.scene.value.regions[region]?.color ?? '#c8c8c8');
    [pen.globalAlpha, pen.fillStyle] = [0.09, color];
    pen.fillRect(a, top, b - a, height);
    pen.globalAlpha = 1;
    pen.fillRect(a, top - 4 * px, b - a - px, 3 * px);
    const name = regionName(room.plan.value)(region);
    pen.font = fontOf(Math.round(11 * px));
    if (pen.measureText(name).width < b - a - 4 * px) write(pen, px, name, (a + b) / 2, top - 13 * px, { color, align: 'center' });
  }
}

function card(world) {
  const { curves } = world;
  const place = curves.pointedDepth.value;
  const result = resultOf(world);
  if (!place || !result) return nothing;
  const rows = [
    ...result.curves.map((curve) => [lookOf(curve.quantity), valueAt(result.depths, curve.values, place.value), curve.unit ?? result.unit]),
    ...(referenceOf(world)?.curves ?? []).map((curve) => [
      { ...lookOf(curve.quantity), name: say.ofPhantom({ curve: lookOf(curve.quantity).name }), dash: [1] },
      valueAt(curve.depths, curve.values, place.value),
      curve.unit,
    ]),
  ];
  return html`<div class="card chart-card" data-side=${place.value > (result.depths[0] + result.depths.at(-1)) / 2 ? 'left' : 'right'} ${variables({ '--x': `${place.x}px` })}><b>${mm(place.value)}</b> <span class="dim">${bandAt(world, place.value)}</span>
    <table><tbody>${rows.map(([look, value, unit]) => html`<tr><th scope="row"><i class=${classMap({ 'chart-dash': true, dashed: look.dash.length > 0 })} ${variables({ '--color': look.color })}></i> ${look.name}</th><td>${value === null ? say.notKnown : inUnit(value, unit)}</td></tr>`)}</tbody></table></div>`;
}

/** The table twin: steps along the line, and the depths that have a name. */
export function profileTable(world) {
  const { curves, depths, peak, entry, advantage } = resultOf(world);
  const [low, high] = ends(resultOf(world));
  const step = [1, 2, 5, 10, 20, 50, 100].find((size) => (high - low) / size <= 20) ?? 200;
  const here = hereOn(world);
  const named = [
    [entry, say.entry],
    [peak?.depth, say.peak],
    [advantage, say.advantage],
    [here, say.crosshair],
  ].filter(([depth]) => Number.isFinite(depth));
  const steps = Array.from(
    { length: Math.floor(high / step) - Math.ceil(low / step) + 1 },
    (_, at) => (Math.ceil(low / step) + at) * step,
  ).filter((depth) => named.every(([other]) => Math.abs(other - depth) > 0.05));
  const rows = [...named, ...steps.map((depth) => [depth, ''])].sort(([a], [b]) => a - b);
  return html`<div class="chart-table" role="group" tabindex="0" aria-label=${say.dosesAlong}><table><thead><tr><th scope="col">mm</th><th scope="col">${say.place}</th>${curves.map(({ quantity, unit }) => html`<th scope="col">${lookOf(quantity).name}, ${unitText(unit ?? resultOf(world).unit)}</th>`)}</tr></thead>
    <tbody>${rows.map(([depth, name]) => html`<tr><th scope="row">${number(depth, 1)}</th><td class="place">${[name, bandAt(world, depth)].filter(Boolean).join(', ')}</td>${curves.map(({ values }) => html`<td>${significant(valueAt(depths, values, depth) ?? NaN)}</td>`)}</tr>`)}</tbody></table></div>`;
}

/** @param {{isInline: boolean, close?: unknown}} how close: buttons at the end of the head */
export function profilePart(world, { isInline, close = nothing }) {
  const { room, curves } = world;
  const state = curves.profile.value;
  const hasLine = curves.chosenLine.value !== null;
  const reason = hasLine
    ? instead(state, {
        empty: state.result && !state.result.curves.length && (state.result.reason || say.noDose),
        idle: doseWaitReason(room),
      })
    : html`<p class="chart-note empty">${say.noBeam}</p>`;
  const isTable = curves.isTable.value.profile && !isInline;
  const here = reason ? null : hereOn(world);
  const value = here === null ? null : valueAt(state.result.depths, state.result.curves[0].values, here);
  const { quantity } = room.scene.value.dose;
  const reference = reason ? null : referenceOf(world);
  const warnings = [
    ...(reason ? [] : state.result.doubts),
    ...(reference ? [reference.unit === state.result.unit ? say.phantom : say.phantomAxis({ unit: unitText(reference.unit) })] : []),
  ];
  const warning = warnings.length
    ? html`<span class="warn" title=${warnings.join(' ')}>${icon('warning', 12)} ${warnings.join(' ')}</span>`
    : nothing;
  const facts = reason ? nothing : html`<p class="chart-method chart-facts">${readOuts(state.result)}</p>`;
  return html`<section class=${classMap({ 'chart-part': true, 'chart-profile': true, old: state.isOld && hasLine })} aria-label=${say.profile}>
    <header class="chart-head"><h2>${isInline ? say.profile : say.depth}</h2>${lineChoice(world)}${hasLine ? staleMark(state.isOld) : nothing}${withoutMark(state.result?.missing)}${doubtMark(world)}<span class="grow"></span>
      ${value === null ? nothing : html`<span class="chart-here">${mm(here)} <b>${inUnit(value, state.result.unit)}</b></span>`}
      ${isInline ? nothing : html`${options(world, 'profile', say.choices, html`${controls(world)}${facts}<p class="chart-method">${state.result?.method ?? ''} ${warning}</p>`)}${tableButton(world, 'profile', say.asTable)}`}${close}</header>
    ${isInline ? controls(world) : nothing}
    ${
      reason ??
      html`${
        isTable
          ? profileTable(world)
          : html`<div class="chart-box"><div class="chart-plot" role="img" aria-label=${say.plotOf({ line: curves.chosenLine.value.name, curves: state.result.curves.map((curve) => lookOf(curve.quantity).name).join(', ') })} ${plot(spec(world))}></div>
        <ul class="chart-key" aria-label=${say.curves}>${drawn(world).map(({ name, color, dash }) => html`<li><i class=${classMap({ 'chart-dash': true, dashed: dash.length > 0 })} ${variables({ '--color': color })}></i>${name}</li>`)}</ul>${card(world)}</div>
      <p class="chart-foot"><span>${[unitPer(state.result), quantityName(quantity), weightWords(room.plan.value, room.scene.value.dose)].filter(Boolean).join(', ')}</span>${isInline ? nothing : warning}<span>${depthWords(curves.chosenLine.value)}</span></p>`
      }
      ${isInline ? html`${facts}${profileTable(world)}<p class="chart-method">${state.result.method} ${warning}</p>` : nothing}`
    }</section>`;
}
