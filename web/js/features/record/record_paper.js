// The record of a decision as a page to print: the blocks that the server makes of what was kept at the decision (GET /records/{record}/paper), which it
// draws alike as PDF. On the sheets of the report (js/features/report/printout.css); what they say is the server's.
import { html, nothing, svg } from '../../../lib/lit-html.js';
import { signal } from '../../../lib/signals-core.js';
import { fetchPaper, pathOfFigure, pathOfPdf } from '../../net/record.js';
import { printable } from '../../room/exports.js';
import { icon } from '../../parts/icons.js';
import { say } from './later_words.js';

const shown = signal(null); // {id, paper, isNamed}

/** Opens the paper of a decision. @param {string} id of the decision */
export async function openPaper(world, id, isNamed = false) {
  const paper = await fetchPaper(id, isNamed);
  shown.value = { id, paper, isNamed };
  world.printoutDialog.value = paperDialog;
  world.ui.popover.value = 'record';
}

function paperDialog(world) {
  const { ui, room } = world;
  if (ui.popover.value !== 'record' || !shown.value) return nothing;
  const { id, isNamed } = shown.value;
  const close = () => {
    ui.popover.value = '';
    shown.value = null;
  };
  const tellAndPrint = printable(world, 'printed-record', `record of room ${room.id}`); // in the audit's language
  const print = async () => {
    const pictures = [...document.querySelectorAll('.paper img')];
    await Promise.all(pictures.map((picture) => picture.decode().catch(() => {})));
    tellAndPrint();
  };
  const name = (event) =>
    openPaper(world, id, event.target.checked).catch((problem) => {
      event.target.checked = isNamed;
      ui.notify('err', say.noPage({ why: problem.message }), 'record');
    });
  return html`<section class="printout record-print" role="dialog" aria-modal="true" tabindex="-1" aria-label=${say.toPrint}>
    <div class="printout-bar"><b>${say.toPrint}</b><span class="grow"></span>
      ${room.seesIdentity.value ? html`<label class="paper-named"><input type="checkbox" .checked=${isNamed} @change=${name}> ${say.named}</label>` : nothing}
      <a class="button" href=${pathOfPdf(id, isNamed)} download>${say.pdf}</a>
      <button class="primary" @click=${print}>${icon('print')}<span>${say.print}</span></button>
      <button class="icon-button" aria-label=${say.close} @click=${close}>${icon('close')}</button></div>${paperSheet(shown.value)}</section>`;
}

/** The sheets of paper. @param {{id: string, paper: object}} of id: of the decision @returns a template */
export function paperSheet({ id, paper }) {
  const { identity, blocks } = paper;
  const field = ({ label, text, more }) => html`<div><span>${label}</span><b>${text}</b> ${more}</div>`;
  return html`<article class="sheet paper">
    <header class="sheet-head"><div>${paper.strip ? html`<p class="paper-strip">${paper.strip}</p>` : nothing}
      <div class="paper-identity">${identity.fields.map(field)}</div></div></header>
    <div class="sheet-body"><h1>${paper.title}</h1><p class="values">${paper.under}</p>${blocks.map((one) => block(id, one))}</div>
    <footer class="sheet-foot"><div><span>${identity.line} · ${paper.foot}<br><b>${paper.use}</b></span><span>${paper.printed}</span></div></footer></article>`;
}

const block = (id, { type, ...one }) => (draw[type] ? draw[type](one, id) : nothing);

const draw = {
  heading: ({ text, note }) => html`<h2>${text} ${note ? html`<small>${note}</small>` : nothing}</h2>`,
  text: ({ text, style }) => html`<p class=${`paper-text ${style}`}>${text}</p>`,
  page: () => html`<div class="paper-page"></div>`,
  table: ({ columns, rows }) => {
    const side = (at) => (columns[at].side === 'right' ? 'right' : '');
    const cell = ({ text, style }, at) =>
      html`<td class=${`${side(at)} ${style}`}>${style === 'code' ? html`<code>${text}</code>` : text}</td>`;
    return html`<table class="record-table paper-table ${rows.length < 8 ? 'whole' : ''}">
      <colgroup>${columns.map(({ percent }) => html`<col width=${`${percent}%`}>`)}</colgroup>
      <thead><tr>${columns.map(({ text }, at) => html`<th scope="col" class=${side(at)}>${text}</th>`)}</tr></thead>
      <tbody>${rows.map((row) => html`<tr>${row.map(cell)}</tr>`)}</tbody></table>`;
  },
  chart: (chart) => histogram(chart),
  figures: ({ width, figures }, id) =>
    html`<div class=${`paper-figures ${width}`}>${figures.map(
      ({ place, title, caption, width_px: w, height_px: h }) => html`<figure><figcaption><b>${title}</b></figcaption>
      <img src=${pathOfFigure(id, place)} width=${w} height=${h} alt=${title}>
      <p>${caption.map(({ rgb, text }, at) => html`${at ? (rgb ? ' ' : ' · ') : nothing}${rgb ? html`<svg class="paper-chip" width="9" height="9" aria-hidden="true"><rect width="9" height="9" fill=${rgb} stroke="#14181d"></rect></svg>` : nothing}${text}`)}</p></figure>`,
    )}</div>`,
};

// ---- the histogram: 640 x 164 units, as wide as the sheet ----------------------------------------------------------------

const [left, top, right, bottom] = [34, 16, 632, 132];
const dashes = ['', '6 3', '2 3', '9 3 2 3', '4 2', '1 2'];

/** The next of 1, 2, 5 times a power of ten. */
function stepOf(range) {
  const power = 10 ** Math.floor(Math.log10(range));
  return [1, 2, 5, 10].map((n) => n * power).find((step) => range / step <= 8);
}

function histogram({ x, y, curves }) {
  const end = Math.max(...curves.map(({ from, width, percent }) => from + width * percent.length), 1e-9);
  const step = stepOf(end);
  const atX = (value) => left + ((right - left) * value) / end;
  const atY = (percent) => bottom - ((bottom - top) * Math.min(percent, 100)) / 100;
  const ticks = Array.from({ length: Math.floor(end / step + 1e-9) + 1 }, (_, n) => n * step);
  const points = ({ from, width, percent }, more) =>
    [...percent, 0].map((share, n) => `${atX(from + n * width).toFixed(1)},${atY(n < percent.length ? share + more : more).toFixed(1)}`);
  const curve = (one) => {
    const line = points(one, 0).join(' ');
    const band = one.missing_percent > 0 ? [...points(one, one.missing_percent), ...points(one, 0).reverse()].join(' ') : '';
    return svg`${band ? svg`<polygon points=${band} fill=${one.color} fill-opacity="0.18"></polygon>` : nothing}
      <polyline points=${line} fill="none" stroke=${one.color} stroke-width="1.4" stroke-dasharray=${dashes[one.dash]}></polyline>`;
  };
  const key = ({
    name,
    color,
    dash,
    missing_percent: missing,
  }) => html`<span><svg width="28" height="8" aria-hidden="true"><line x1="0" y1="4" x2="28" y2="4"
    stroke=${color} stroke-width="1.6" stroke-dasharray=${dashes[dash]}></line></svg> ${missing > 0 ? say.inTheBand({ name, percent: missing.toFixed(1) }) : name}</span>`;
  return html`<div class="paper-chart"><svg class="chart-paper" viewBox="0 0 640 164" role="img" aria-label=${`${y}; ${x}`}>
    ${[0, 25, 50, 75, 100].map(
      (percent) => svg`<line x1=${left} x2=${right} y1=${atY(percent)} y2=${atY(percent)} stroke="#d3d8dd"></line>
      <text x=${left - 6} y=${atY(percent) + 4} text-anchor="end">${percent}</text>`,
    )}
    ${ticks.map((value) => svg`<text x=${atX(value)} y=${bottom + 14} text-anchor="middle">${Number(value.toPrecision(6))}</text>`)}
    ${curves.map(curve)}<text x="0" y="8">${y}</text><text x=${right} y="160" text-anchor="end">${x}</text></svg>
    <p class="chart-paper-key">${curves.map(key)}</p></div>`;
}
