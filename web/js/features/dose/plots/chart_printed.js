// Plots of dose in the report to print: on white paper, as vector drawings, with their tables and the limits.
import { html, nothing, svg } from '../../../../lib/lit-html.js';
import { boundsWords, figureNames, figureWords } from '../dose_dvh.js';
import { populationWords } from '../dose_population.js';
import { lookOf } from '../dose_profile.js';
import { axisWords, bandName, basisWords, leftWords } from './chart_dvh.js';
import { limitBasis, limitPopulation, limitRows, limitWords, valueWords, verdictWord } from './chart_limits.js';
import { basisOf, headline, tables } from './irradiation.js';
import { say as irradiationWords } from './irradiation_words.js';
import { depthWords, readOuts } from './chart_profile.js';
import { basisRows, doseName, quantityName, regionName, unitPer } from './chart_words.js';
import { listed, number, significant, unitText } from '../../../parts/format.js';
import { say } from './printed_words.js';

const [width, height, left, foot] = [640, 240, 46, 34];
/** Regions differ by dash, too: paper may be grey. */
const dashes = [[], [9, 3], [2, 3], [9, 3, 2, 3], [14, 4], [5, 3], [9, 3, 2, 3, 2, 3], [1, 2]];

/** Numbers for an axis: from low to high by a round step, about five. */
function ticksOf(low, high) {
  const rough = (high - low) / 5;
  const size = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 2.5, 5, 10].map((part) => part * size).find((one) => one >= rough);
  return Array.from(
    { length: Math.floor(high / step + 1e-9) - Math.ceil(low / step - 1e-9) + 1 },
    (_, at) => (Math.ceil(low / step - 1e-9) + at) * step,
  );
}

/** A narrow column breaks neither a number nor its sign. */
const unbroken = (text) => text.replaceAll('\u2009', '\u202f').replace(/([≤≥]) /g, '$1\u00a0');

/** On paper a colour has to be dark enough. */
const onPaper = (color) => {
  const rgb = [1, 3, 5].map((at) => Number.parseInt(color.slice(at, at + 2), 16));
  const light = (0.3 * rgb[0] + 0.59 * rgb[1] + 0.11 * rgb[2]) / 255;
  return `rgb(${rgb.map((c) => Math.round(light > 0.55 ? (c * 0.55) / light : c)).join(',')})`;
};

/** @param {{name: string, color: string, dash: number[], isThin?: boolean, xs: number[], ys: (number|null)[], tops?: number[]|null}[]} lines tops: the upper edge of a band above the line */
function drawing(label, lines, { xWords, yWords, low, high, top }) {
  const x = (value) => left + ((value - low) / (high - low)) * (width - left - 10);
  const y = (value) => height - foot - (value / top) * (height - foot - 12);
  const path = ({ xs, ys }) => {
    let isDown = false;
    return xs
      .map((value, at) => {
        const isThere = ys[at] !== null && Number.isFinite(ys[at]);
        const step = isThere ? `${isDown ? 'L' : 'M'}${x(value).toFixed(1)} ${y(ys[at]).toFixed(1)}` : '';
        isDown = isThere;
        return step;
      })
      .join('');
  };
  const band = ({ xs, ys, tops }) =>
    `${[...xs.map((value, at) => [value, tops[at]]), ...xs.map((value, at) => [value, ys[at]]).reverse()].map(([value, to], at) => `${at ? 'L' : 'M'}${x(value).toFixed(1)} ${y(to).toFixed(1)}`).join('')}Z`;
  return html`<svg class="chart-paper" viewBox=${`0 0 ${width} ${height}`} role="img" aria-label=${label}>
    ${ticksOf(low, high).map((value) => svg`<line x1=${x(value)} x2=${x(value)} y1="12" y2=${height - foot} stroke="#ddd" /><text x=${x(value)} y=${height - foot + 13} text-anchor="middle">${significant(value)}</text>`)}
    ${ticksOf(0, top).map((value) => svg`<line x1=${left} x2=${width - 10} y1=${y(value)} y2=${y(value)} stroke="#ddd" /><text x=${left - 5} y=${y(value) + 4} text-anchor="end">${significant(value)}</text>`)}
    <text x=${left} y=${height - 4}>${yWords}</text><text x=${width - 10} y=${height - 4} text-anchor="end">${xWords}</text>
    ${lines.map((line, at) => (line.tops ? svg`<pattern id=${`band-${at}`} width="6" height="6" patternUnits="userSpaceOnUse" patternTransform="rotate(45)"><line x1="0" x2="0" y1="0" y2="6" stroke=${onPaper(line.color)} stroke-width="1.2" /></pattern><path class="chart-paper-band" d=${band(line)} fill=${`url(#band-${at})`} stroke=${onPaper(line.color)} stroke-width="0.8" stroke-dasharray="3 3" />` : nothing))}
    ${lines.map((line) => svg`<path d=${path(line)} fill="none" stroke=${onPaper(line.color)} stroke-width=${line.isThin ? 0.8 : 1.6} stroke-dasharray=${line.dash.join(' ')} />`)}</svg>
    <ul class="chart-paper-key" aria-label=${say.curves}>${lines.map(({ name, color, dash }) => html`<li><svg viewBox="0 0 24 6" width="24" height="6" aria-hidden="true"><line x1="0" x2="24" y1="3" y2="3" stroke=${onPaper(color)} stroke-width="2" stroke-dasharray=${dash.join(' ')} /></svg> ${name}</li>`)}</ul>`;
}

export function printed(world) {
  const { room, curves } = world;
  const [plan, scene] = [room.plan.value, room.scene.value];
  if (!plan || !scene?.dose) return nothing;
  return html`${histograms(world, plan, scene)}${profile(world, scene)}${limits(world)}${irradiation(world)}${curves.dvh.value.error ? html`<p class="values">${say.histogramError({ reason: curves.dvh.value.error })}</p>` : nothing}`;
}

function histograms(world, plan, scene) {
  const { curves } = world;
  const list = curves.curves.value;
  const { result } = curves.dvh.value;
  if (!list.length || !result) return nothing;
  const unit = unitText(result.unit);
  const { doses, values, tops, end } = curves.points.value;
  const regions = [...new Set(list.map(({ region }) => region))];
  const isPercent = curves.unit.value === 'percent' && !curves.isDifferential.value;
  const name = (curve) => `${regionName(plan)(curve.region)}${curve.of ? `, ${doseName(plan, curve.dose)}` : ''}`;
  const basis = basisRows(world, result.quantity || scene.dose.quantity, result, {
    basis: basisWords(world),
    population: populationWords(curves.population),
  }).filter(({ id }) => !['plan', 'revision', 'use', 'method'].includes(id) && !id.startsWith('weights_of_')); // those stand in the basis
  return html`<h2>${say.histogram}</h2><p class="values">${basis.map(({ name: word, values: of }) => `${word}: ${of.join(', ')}`).join('; ')}.</p>
    ${drawing(
      say.histogram,
      list.map((curve, at) => ({
        name: bandName(curve, name(curve), curves.isDifferential.value),
        color: scene.regions[curve.region]?.color ?? '#888888',
        dash: dashes[regions.indexOf(curve.region) % dashes.length],
        isThin: curve.of > 0,
        xs: doses,
        ys: values[at],
        tops: tops[at],
      })),
      {
        low: 0,
        high: end,
        top: isPercent ? 100 : Math.max(1e-9, ...values.flat(), ...tops.flatMap((one) => one ?? [])),
        xWords: listed(unitPer(result), quantityName(result.quantity || scene.dose.quantity)),
        yWords: axisWords(world),
      },
    )}
    <div class="numbers-scroll" role="group" tabindex="0" aria-label=${say.figures}><table class="numbers-table chart-figures"><thead><tr><th scope="col">${listed(say.region, unit)}</th><th scope="col">cm³</th><th scope="col">${say.withoutDose}</th><th scope="col">${say.univels}</th>${['min', 'mean', 'max', ...figureNames].map((figure) => html`<th scope="col">${figureWords(figure)}</th>`)}</tr></thead>
      <tbody>${list.map((curve) => html`<tr><th scope="row">${name(curve)}</th><td>${number(curve.volume, 2)}</td><td>${curve.missing ? significant(curve.missing) : '0'}</td><td>${unbroken(number(curve.univels))}</td>${['min', 'mean', 'max', ...figureNames].map((figure) => html`<td>${unbroken(boundsWords(curve.figures[figure], significant))}</td>`)}</tr>`)}</tbody></table></div>
    <p class="values">${result.method} ${leftWords(world)}</p>`;
}

function profile({ curves, room }, scene) {
  const { result } = curves.profile.value;
  if (!result?.curves.length || !curves.chosenLine.value) return nothing;
  const top = Math.max(1e-30, ...result.curves.flatMap(({ values }) => values).filter(Number.isFinite)) * 1.05;
  const facts = [
    readOuts(result),
    ...result.bands.map(({ region, from, to }) =>
      say.band({ region: regionName(room.plan.value)(region), from: number(from, 1), to: number(to, 1) }),
    ),
  ].filter(Boolean);
  return html`<h2>${say.profileOf({ line: curves.chosenLine.value.name })}</h2>
    ${drawing(
      say.profile,
      result.curves.map(({ quantity, values }, at) => ({
        name: lookOf(quantity).name,
        color: at === 0 ? '#222222' : lookOf(quantity).color,
        dash: lookOf(quantity).dash,
        xs: result.depths,
        ys: values,
      })),
      {
        low: result.depths[0],
        high: result.depths.at(-1),
        top,
        xWords: depthWords(curves.chosenLine.value),
        yWords: listed(unitPer(result), quantityName(scene.dose.quantity)),
      },
    )}
    <p class="values">${facts.join('; ')}. ${result.doubts.join(' ')} ${result.method}</p>`;
}

function limits(world) {
  const rows = limitRows(world);
  if (!rows.length) return nothing;
  return html`<h2>${say.limits}</h2>${limitPopulation(world) ? html`<p class="values">${say.univelsOfEach({ population: limitPopulation(world) })}</p>` : nothing}<div class="numbers-scroll" role="group" tabindex="0" aria-label=${say.limits}><table class="numbers-table"><thead><tr><th scope="col">${say.region}</th><th scope="col">${say.limit}</th><th scope="col">${say.quantity}</th><th scope="col">${say.weights}</th><th scope="col">${say.value}</th><th scope="col">${say.met}</th></tr></thead>
    <tbody>${rows.map((row) => html`<tr><th scope="row">${limitWords(world, row)[0]}</th><td>${limitWords(world, row)[1]}</td><td>${quantityName(row.constraint.quantity)}</td><td>${limitBasis(world, row) || '–'}</td><td>${valueWords(row)}</td><td>${verdictWord(row.verdict)}${row.verdict.reason ? `: ${row.verdict.reason}` : ''}</td></tr>`)}</tbody></table></div>`;
}

function irradiation(world) {
  const { result } = world.curves.irradiation.value;
  if (!result?.limits.length) return nothing;
  const { words, doubt } = headline(world, result);
  return html`<h2>${irradiationWords.title}</h2><p class="values">${words} ${doubt} ${basisOf(result)}</p>${tables(world, result)}<p class="values">${result.method}</p>`;
}
