// The dose legend in Selection: where it stands, whether lines have values, and the whole list.
import { html, nothing } from '../../../lib/lit-html.js';
import { segment } from '../../parts/fields.js';
import { legendBody, rowsOf } from './dose_legend.js';
import { legendPlace } from './legend_place.js';
import { say } from './later_words.js';

export function legendBlock(world) {
  const place = legendPlace(world);
  const rows = rowsOf(world);
  const stands = place.isOffered
    ? html`<dt>${say.legendStands}</dt><dd>${segment(
        say.legendStands,
        [
          ['strip', say.abovePanes],
          ['column', say.rightOfPanes],
        ],
        place.isColumn ? 'column' : 'strip',
        false,
        (id) => place.set({ stands: id }),
      )}</dd>`
    : nothing;
  return html`<section class="block"><h3>${say.legend}</h3><dl class="dose-list">${stands}<dt>${say.legendLines}</dt><dd>${segment(
    say.legendLines,
    [
      [true, say.withValues],
      [false, say.withoutValues],
    ],
    place.hasValues,
    false,
    (values) => place.set({ values }),
  )}</dd></dl>
    <p class="note">${say.legendIs}</p></section>
    ${rows.length ? html`<section class="block legend-list">${legendBody(rows)}</section>` : html`<p class="empty">${say.noLegend}</p>`}`;
}
