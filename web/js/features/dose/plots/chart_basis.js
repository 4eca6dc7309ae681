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

/** Weights stand here alone, so it is drawn also while the unit and 100 % are not known, or cannot be. @param {object} world with doses and curves */
export function basisTable(world) {
  const { room, doses, curves } = world;
  const [plan, scene] = [room.plan.value, room.scene.value];
  if (!plan?.doses.length || !scene?.dose) return nothing;
  const { result, error } = doses.scale.value;
  const answer = !error && doses.isOfScene(result) ? result : null;
  const { dose } = scene;
  const quantity = answer?.quantity ?? dose.quantity;
  const facts = basisRows(world, quantity, answer, {
    basis: weightWords(plan, { ...dose, quantity }),
    population: populationWords(curves.population),
  }).filter(({ id }) => !['plan', 'revision', 'use', 'method', ...(answer ? [] : ['unit'])].includes(id));
  const rows = [
    ...facts.map(({ name, values }) => [name, values.join(', ')]),
    ...(quantity === 'isoeffective' ? [[say.irradiation, say.minutes({ n: number(dose.irradiation_min, 1) })]] : []),
    ...(answer ? [hundredRow(answer)] : []),
  ];
  return html`<h2>${say.basis}</h2>${error ? html`<p class="values">${error}</p>` : nothing}<p class="values">${say.basisIs}</p><table class="facts"><tbody>${rows.map(([name, value]) => html`<tr><th scope="row">${name}</th><td>${value}</td></tr>`)}</tbody></table>`;
}
