// The basis of all numbers and pictures of dose in the report to print, as a table of its own.
import { html, nothing } from '../../../../lib/lit-html.js';
import { populationWords } from '../dose_population.js';
import { listed, number } from '../../../parts/format.js';
import { basisRows, inUnit, unitPer, weightWords } from './chart_words.js';
import { say } from './printed_words.js';

/** "100 %" with its value and what it is of. */
function hundredRow(result) {
  const { value, words, reason } = result.reference;
  return ['100 %', Number.isFinite(value) ? listed(inUnit(value, unitPer(result)), words) : (reason ?? say.notKnown)];
}

/** @param {object} world with doses and curves */
export function basisTable(world) {
  const { room, doses, curves } = world;
  const { result, error } = doses.scale.value;
  if (error) return html`<h2>${say.basis}</h2><p class="values">${error}</p>`;
  if (!doses.isOfScene(result)) return nothing;
  const [plan, { dose }] = [room.plan.value, room.scene.value];
  const facts = basisRows(world, result.quantity, result, {
    basis: weightWords(plan, { ...dose, quantity: result.quantity }),
    population: populationWords(curves.population),
  }).filter(({ id }) => !['plan', 'revision', 'use', 'method'].includes(id));
  const rows = [
    ...facts.map(({ name, values }) => [name, values.join(', ')]),
    ...(result.quantity === 'isoeffective' ? [[say.irradiation, say.minutes({ n: number(dose.irradiation_min, 1) })]] : []),
    hundredRow(result),
  ];
  return html`<h2>${say.basis}</h2><p class="values">${say.basisIs}</p><table class="facts"><tbody>${rows.map(([name, value]) => html`<tr><th scope="row">${name}</th><td>${value}</td></tr>`)}</tbody></table>`;
}
