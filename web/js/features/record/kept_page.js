// The kept records (/records): a list that is searched on the server, and the paper of one decision (/records/ID). Both are there when room and plan are gone.
import { html, nothing } from '../../../lib/lit-html.js';
import { repeat } from '../../../lib/directives/repeat.js';
import { signal } from '../../../lib/signals-core.js';
import { fetchPaper, pathOfPdf } from '../../net/record.js';
import { icon } from '../../parts/icons.js';
import { styled } from '../../parts/lazy.js';
import { mount } from '../../parts/mount.js';
import { decisions, wordOf } from './checklist.js';
import { paperSheet } from './record_paper.js';
import { say } from './kept_words.js';

const [waitMs, pageSize] = [200, 50];

/** In the order in which one goes over another. */
async function styles() {
  for (const sheet of ['report/printout.css', 'record/record.css', 'record/paper.css', 'record/kept.css'])
    await styled(`js/features/${sheet}`).catch(() => {});
}

/** "2026-11-27 14:36", of this computer's zone. */
const time = (ms) => new Date(ms).toLocaleString('sv', { dateStyle: 'short', timeStyle: 'short' });

/** @param {HTMLElement} host @param {string} id of a decision; '' for the list @param {object} world {api, clock} @returns {() => void} leaves the page */
export function recordsPage(host, id, { api, clock }) {
  void styles();
  const page = id ? onePage(id) : listPage(api, clock);
  const unmount = mount(host, page.draw);
  document.title = id ? say.pageTitle : say.title;
  page.start();
  return () => {
    page.stop();
    unmount();
    document.title = 'Beamroom';
  };
}

// ---- the list ---------------------------------------------------------------------------------------------------------------

/** The list, before it is mounted. */
export function listPage(api, clock) {
  const state = signal({ rows: [], hasMore: false, isReading: true, error: '' });
  const asked = { text: '', kind: '' };
  let [timer, n] = [0, 0];

  /** Asks for the newest, or for those before the last row. */
  async function ask(before = '') {
    const number = ++n;
    state.value = { ...state.value, isReading: true, error: '' };
    const answer = await api
      .call('POST', 'records/search', { body: { ...asked, limit: pageSize, ...(before && { before }) } })
      .catch((error) => ({ error: error.message }));
    if (number !== n) return; // a later search is under way
    const { rows } = state.value;
    state.value = answer.error
      ? { rows: before ? rows : [], hasMore: before !== '' && state.value.hasMore, isReading: false, error: answer.error }
      : { rows: before ? [...rows, ...answer.records] : answer.records, hasMore: answer.more, isReading: false, error: '' };
  }

  const search = (event) => {
    asked[event.target.name] = event.target.value;
    clock.clearTimeout(timer);
    timer = clock.setTimeout(() => void ask(), waitMs);
  };
  return {
    start: () => void ask(),
    stop() {
      n++;
      clock.clearTimeout(timer);
    },
    draw: () => listDrawn(state.value, asked, search, ask),
  };
}

function listDrawn({ rows, hasMore, isReading, error }, asked, search, ask) {
  const isAll = !asked.text && !asked.kind;
  const status = isReading ? say.reading : rows.length || error ? '' : isAll ? say.none : say.noneFound;
  return html`<div class="records"><header class="records-bar"><a class="button" href="/">${say.toPlans}</a><h1>${say.title}</h1><span class="grow"></span>
      <label class="records-find">${icon('search')}<input type="search" name="text" maxlength="60" placeholder=${say.find} aria-label=${say.find} @input=${search}></label>
      <select name="kind" aria-label=${say.kind} @change=${search}><option value="">${say.both}</option>
        <option value="decision">${say.decisions}</option><option value="signature">${say.signatures}</option></select></header>
    <main><p class="note">${say.about}</p>
      ${error ? html`<p class="err" role="alert">${say.noAnswer({ why: error })} <button @click=${() => ask()}>${say.again}</button></p>` : nothing}
      ${rows.length ? listTable(rows) : nothing}
      <p class="note" role="status" data-reading=${isReading}>${status}</p>
      ${hasMore && !isReading ? html`<p><button @click=${() => ask(rows.at(-1).id)}>${say.more}</button></p>` : nothing}</main></div>`;
}

const listTable = (rows) => html`<table class="records-table"><thead><tr>
    ${[say.when, say.what, say.patient, say.plan, say.by, say.paper].map((word) => html`<th scope="col">${word}</th>`)}</tr></thead>
  <tbody>${repeat(rows, ({ room, id }) => `${room} ${id}`, listRow)}</tbody></table>`;

function listRow(record) {
  const { id, kind, time_ms: ms, decision, patient, plan, plan_name: name, label, author, author_name: by } = record;
  const at = time(ms);
  const isDecision = kind === 'decision';
  return html`<tr data-record=${id}><td>${at}</td><td>${isDecision ? html`<b>${wordOf(decisions, decision)}</b>` : say.signed}</td><td>${patient || '–'}</td>
    <td>${label ? html`<b>${label}</b> ` : nothing}${name}${name && name !== plan ? ' ' : nothing}<span class="dim">${plan || say.erased}</span></td>
    <td title=${author}>${by}</td>
    <td class="records-paper">${
      isDecision
        ? html`<a class="button" href=${`/records/${encodeURIComponent(id)}`} aria-label=${say.pagesOf({ when: at })}>${say.pages}</a>
      <a class="button" href=${pathOfPdf(id, false)} download aria-label=${say.pdfOf({ when: at })}>${say.pdf}</a>`
        : html`<span class="dim">${say.underDecision}</span>`
    }</td></tr>`;
}

// ---- one decision -----------------------------------------------------------------------------------------------------------

function onePage(id) {
  const paper = signal(null);
  const error = signal('');
  const size = signal('a4');
  let isLeft = false;
  const ask = async () => {
    error.value = '';
    try {
      const answer = await fetchPaper(id, false);
      if (!isLeft) paper.value = answer;
    } catch (problem) {
      error.value = problem.message;
    }
  };
  const print = async () => {
    await Promise.all([...document.querySelectorAll('.paper img')].map((picture) => picture.decode().catch(() => {})));
    globalThis.print();
  };
  const choose = (event) => {
    size.value = event.target.value;
  };
  const bar =
    () => html`<div class="printout-bar"><a class="button" href="/records">${say.toRecords}</a><b>${say.pageTitle}</b><span class="grow"></span>
    <label class="paper-named">${say.paperSize} <select @change=${choose}><option value="a4">${say.a4}</option><option value="letter">${say.letter}</option></select></label>
    <a class="button" href=${`${pathOfPdf(id, false)}&paper=${size.value}`} download>${say.pdf}</a>
    <button class="primary" ?disabled=${!paper.value} @click=${print}>${icon('print')}<span>${say.print}</span></button></div>`;
  const state = () =>
    error.value
      ? html`<p class="bar-note" role="alert">${say.noAnswer({ why: error.value })} <button @click=${ask}>${say.again}</button></p>`
      : html`<p class="bar-note" role="status">${say.reading}</p>`;
  return {
    start: () => void ask(),
    stop() {
      isLeft = true;
    },
    draw: () =>
      html`<main class="printout record-print" aria-label=${say.pageTitle}>${bar()}${
        paper.value ? html`<p class="records-masked note on-screen">${say.masked}</p>${paperSheet({ id, paper: paper.value })}` : state()
      }</main>`,
  };
}
