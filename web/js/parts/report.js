// The lines of a report, for the start page and the inspector.
import { html, nothing } from '../../lib/lit-html.js';
import { number } from './format.js';
import { icon } from './icons.js';
import { say } from './words.js';

const looks = { error: ['error', say.error, 'err'], warning: ['warning', say.warning, 'warn'], note: ['note', say.note, 'dim'] };

export function reportLines({ lines, dropped }) {
  if (!lines.length) return html`<p class="empty">${say.nothing}</p>`;
  return html`<ul class="report">${lines.map((line) => {
    const [picture, word, tone] = looks[line.severity] ?? looks.note;
    return html`<li><span class=${tone}>${icon(picture)}</span><div><p><b class=${tone}>${word}</b> <a href=${`gen/reference.html#report-${line.code}`} target="_blank" title=${say.codeIs}><code>${line.code}</code></a></p><p>${line.sentence}</p>
      ${line.where ? html`<p class="place">${line.where}</p>` : nothing}</div></li>`;
  })}</ul>${dropped ? html`<p class="empty">${say.moreDropped({ n: number(dropped) })}</p>` : nothing}`;
}
