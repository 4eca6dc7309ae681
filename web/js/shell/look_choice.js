// How the page looks for this person: its size and its colours, in the list of keys and on the start page.
import { html } from '../../lib/lit-html.js';
import { segment } from '../parts/fields.js';
import { colours, pageColours, pageSize, sizes } from '../parts/page_look.js';
import { say } from './look_words.js';

const colourWords = { dark: say.dark, light: say.light, system: say.asSystem };

export function lookChoice() {
  const set = (of) => (value) => {
    of.value = value;
  };
  const choice = (name, of, options) => html`<dt>${name}</dt><dd>${segment(name, options, of.value, false, set(of))}</dd>`;
  return html`<dl class="look-choice">${choice(
    say.pageSize,
    pageSize,
    sizes.map((percent) => [percent, say.percent({ n: percent })]),
  )}${choice(
    say.pageColours,
    pageColours,
    colours.map((one) => [one, colourWords[one]]),
  )}</dl>`;
}
