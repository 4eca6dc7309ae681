// The lines of a report, for the start page and the inspector.
import { html, nothing } from '../../lib/lit-html.js';
import { number } from './format.js';
import { icon } from './icons.js';

const looks = { error: ['error', 'Error', 'err'], warning: ['warning', 'Warning', 'warn'], note: ['note', 'Note', 'dim'] };

export function reportLines({ lines, dropped }) {
  if (!lines.length) return html`<p class="empty">Nothing was noticed while loading.</p>`;
  return html`<ul class="report">${lines.map((line) => {
    const [picture, word, tone] = looks[line.severity] ?? looks.note;
    return html`<li><span class=${tone}>${icon(picture)}</span><div><p><b class=${tone}>${word}</b> <a href=${`gen/reference.html#report-${line.code}`} target="_blank" title="What it means and what to do"><code>${line.code}</code></a></p><p>${line.sentence}</p>
      ${line.where ? html`<p class="place">${line.where}</p>` : nothing}</div></li>`;
  })}</ul>${dropped ? html`<p class="empty">${number(dropped)} more are not kept.</p>` : nothing}`;
}
