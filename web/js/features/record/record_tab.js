// The inspector's Record: checklist, decision, signatures, who was present, under the revision of the plan's files; its export.
import { html, nothing } from '../../../lib/lit-html.js';
import { repeat } from '../../../lib/directives/repeat.js';
import { signal } from '../../../lib/signals-core.js';
import { fetchRecord } from '../../net/record.js';
import { decisions, earlierRevisions, entriesOf, legal, linesOf, meanings, states, wordOf } from './checklist.js';
import { whenWords } from '../notes/threads.js';
import { Record } from './record.js';
import { saveBlob } from '../../room/exports.js';
import { icon } from '../../parts/icons.js';
import { styled } from '../../parts/lazy.js';
import { mayWrite, meIn } from '../notes/note_words.js';

const records = new WeakMap(); // by room
const failed = signal({}); // by form: why the server refused what was last written there
const kept = signal({}); // by form: 'Keeping …' until what was written is on the server's disk, then 'Kept 14:36'
const comments = new Map(); // by entry: what is being written about it

function recordOf({ room }) {
  if (!records.has(room)) records.set(room, new Record(room, globalThis));
  return records.get(room);
}

const fail = (form, problem) => {
  failed.value = { ...failed.peek(), [form]: problem?.detail || problem?.message || '' };
};

const keep = (form, words) => {
  kept.value = { ...kept.peek(), [form]: words };
};
const timeOf = (ms) => new Date(ms).toLocaleTimeString([], { hour: '2-digit', minute: '2-digit' });

/** Writes an item, which the server accepts only once it is on its disk; why not stands at the form. Resolves to whether it was written. */
async function write(room, form, kind, body, of = null) {
  fail(form, null);
  keep(form, 'Keeping …');
  try {
    const { changed_ms: ms } = await room.items.put(kind, body, of);
    keep(form, `Kept ${timeOf(ms)}`);
    return true;
  } catch (problem) {
    keep(form, '');
    fail(form, problem);
    return false;
  }
}

const errorOf = (form) =>
  failed.value[form]
    ? html`<p class="note-error" role="alert">${failed.value[form]}</p>`
    : kept.value[form]
      ? html`<p class="note" role="status">${kept.value[form]}</p>`
      : nothing;
const when = (ms) =>
  html`<time datetime=${new Date(ms).toISOString()} title=${new Date(ms).toLocaleString()}>${whenWords(ms, Date.now())}</time>`;

export function recordTab(world) {
  const { room } = world;
  const rows = [...room.items.rows.value.values()];
  const record = recordOf(world);
  const present = room.members.value.map(({ id, connected }) => `${id} ${connected}`).join();
  const nLines = rows.filter(({ kind }) => kind === 'decision' || kind === 'signature').length;
  queueMicrotask(() => record.keep(`${room.planId.value} ${nLines} ${present}`));
  const facts = record.facts.value;
  if (!facts)
    return html`<p class="empty" role="status">${record.error.value || 'The plan’s files are being read: what is written here stands under their revision.'}</p>`;
  const revision = facts.plan_revision;
  return html`${head(facts)}${checks(world, rows, revision)}${decided(world, rows, revision)}${signed(world, rows, revision)}${attendance(facts)}${earlier(rows, revision)}${exports(world)}`;
}

const head = ({ plan_revision: revision, n_files: nFiles }) => html`<section class="block"><h3>Plan revision</h3>
  <p class="note"><code title=${revision}>${revision.slice(0, 12)}</code> · SHA-256 over the names and contents of ${nFiles} files. What is written here stands under it.</p></section>`;

// ---- checklist ---------------------------------------------------------------------------------------------------------

function checks(world, rows, revision) {
  const { room } = world;
  const entries = entriesOf(rows, revision);
  const nDone = entries.filter(({ row }) => row && row.body.state !== 'open').length;
  const add = async (event) => {
    event.preventDefault();
    const form = event.target;
    const text = new FormData(form).get('text').trim();
    if (text && (await write(room, 'entry', 'check', { entry: '', text, state: 'open', comment: '' }))) form.reset();
  };
  return html`<section class="block"><h3>Checklist <span class="dim">${nDone} of ${entries.length}</span></h3>
    <ol class="checks" aria-label="Checklist">${repeat(
      entries,
      ({ key }) => key,
      (entry) => check(world, entry, revision),
    )}</ol>
    ${mayWrite(room) ? html`<form class="record-add" @submit=${add}><input name="text" maxlength="200" aria-label="Another entry" placeholder="Another entry"><button>${icon('plus', 12)} Add</button></form>${errorOf('entry')}` : nothing}</section>`;
}

function check({ room }, { key, entry, text, row }, revision) {
  const state = row?.body.state ?? 'open';
  const draft = comments.get(`${revision} ${key}`);
  const set = (part) => write(room, key, 'check', { entry, text, state, comment: row?.body.comment ?? '', ...part }, row);
  const say = async (event) => {
    const comment = event.target.value.trim();
    comments.set(`${revision} ${key}`, comment);
    if (comment === (row?.body.comment ?? '') || (await set({ comment }))) comments.delete(`${revision} ${key}`);
  };
  const id = `check-${key}`;
  return html`<li data-check=${key} data-state=${state}><span class="check-text" id=${id}>${text}</span>
    <span class="segments" role="group" aria-labelledby=${id}>${states.map(([word, name]) => html`<button aria-pressed=${state === word} ?disabled=${!mayWrite(room)} @click=${() => state === word || set({ state: word })}>${word === 'ok' && state === 'ok' ? icon('check', 12) : nothing}${name}</button>`)}</span>
    ${row ? html`<span class="check-by dim">${row.changed_name}, ${when(row.changed_ms)}</span>` : nothing}
    ${state === 'issue' || row?.body.comment ? (mayWrite(room) ? html`<textarea rows="2" maxlength="2000" aria-label=${`What is wrong: ${text}`} placeholder="What is wrong" .value=${draft ?? row?.body.comment ?? ''} @change=${say}></textarea>` : html`<p class="note-words">${row.body.comment}</p>`) : nothing}${errorOf(key)}</li>`;
}

// ---- decision and signatures -------------------------------------------------------------------------------------------

const lines = (list, label, words) =>
  list.length
    ? html`<ol class="record-lines" aria-label=${label}>${list.map(({ row, isCorrected }) => html`<li data-corrected=${isCorrected}>${words(row)}<span class="dim">${row.author_name}, ${row.body.role}, ${when(row.created_ms)}${isCorrected ? ' · corrected by a later line' : ''}</span></li>`)}</ol>`
    : nothing;

const decisionWords = ({ body }) =>
  html`<b>${wordOf(decisions, body.decision)}</b>${body.text ? html`<span class="note-words">${body.text}</span>` : nothing}`;
const signatureWords = ({ body }) => html`<b>${body.name}</b> <span>${wordOf(meanings, body.meaning)}</span>`;

/** Which earlier line a new one corrects. */
const corrects = (list, words) => {
  const open = list.filter(({ isCorrected }) => !isCorrected);
  return open.length
    ? html`<label>Corrects <select name="corrects"><option value="">no earlier line</option>${open.map(({ row }) => html`<option value=${row.id}>${words(row)}</option>`)}</select></label>`
    : nothing;
};

function decided({ room }, rows, revision) {
  const list = linesOf(rows, 'decision', revision);
  const submit = async (event) => {
    event.preventDefault();
    const form = event.target;
    const data = Object.fromEntries(new FormData(form));
    if (await write(room, 'decision', 'decision', { decision: data.decision, text: data.text.trim(), corrects: data.corrects ?? '' }))
      form.reset();
  };
  const isMine = meIn(room).role === 'presenter' && mayWrite(room);
  return html`<section class="block"><h3>Decision</h3>${lines(list, 'Decisions', decisionWords)}
    ${
      isMine
        ? html`<form class="record-form" @submit=${submit}><label>Decision <select name="decision" required><option value="">–</option>${decisions.map(([id, name]) => html`<option value=${id}>${name}</option>`)}</select></label>
      <label>In words <textarea name="text" rows="2" maxlength="2000"></textarea></label>${corrects(list, ({ body }) => wordOf(decisions, body.decision))}
      <p class="note">It is never changed or deleted: a correction is another line.</p><div class="note-buttons"><button>Write down</button></div></form>${errorOf('decision')}`
        : list.length
          ? nothing
          : html`<p class="note">None yet. A member of role presenter writes it down.</p>`
    }</section>`;
}

function signed({ room }, rows, revision) {
  const list = linesOf(rows, 'signature', revision);
  const submit = async (event) => {
    event.preventDefault();
    const form = event.target;
    const data = Object.fromEntries(new FormData(form));
    if (await write(room, 'signature', 'signature', { name: data.name.trim(), meaning: data.meaning, corrects: data.corrects ?? '' }))
      form.reset();
  };
  return html`<section class="block"><h3>Signatures</h3>${lines(list, 'Signatures', signatureWords)}
    ${
      mayWrite(room)
        ? html`<form class="record-form" @submit=${submit}><label>Name <input name="name" required maxlength="80" autocomplete="name"></label>
      <label>Meaning <select name="meaning">${meanings.map(([id, name]) => html`<option value=${id}>${name}</option>`)}</select></label>${corrects(list, ({ body }) => `${body.name}, ${wordOf(meanings, body.meaning)}`)}
      <p class="note">${legal} A line is never changed or deleted.</p><div class="note-buttons"><button>Sign</button></div></form>${errorOf('signature')}`
        : html`<p class="note">${legal}</p>`
    }</section>`;
}

// ---- who was there, earlier revisions, export --------------------------------------------------------------------------

function attendance({ present, n_present_dropped: nDropped }) {
  return html`<section class="block"><h3>Present</h3><ul class="record-present" aria-label="Present">${present.map(({ name, role, entered_ms: from, left_ms: to, here }) => html`<li><b>${name}</b> <span class="dim">${role}, ${when(from)} – ${to ? when(to) : here ? 'now' : 'the server ended'}</span></li>`)}</ul>
    ${nDropped ? html`<p class="note">${nDropped} earlier stays are not kept.</p>` : nothing}</section>`;
}

function earlier(rows, revision) {
  const groups = earlierRevisions(rows, revision);
  const words = (row) =>
    row.kind === 'check'
      ? html`${row.body.text}: <b>${wordOf(states, row.body.state)}</b>${row.body.comment ? html`<span class="note-words">${row.body.comment}</span>` : nothing}`
      : row.kind === 'decision'
        ? decisionWords(row)
        : signatureWords(row);
  return groups.map(
    ({
      revision: of,
      rows: list,
    }) => html`<section class="block"><details class="record-earlier"><summary>Earlier revision <code title=${of}>${of.slice(0, 12)}</code> <span class="dim">${list.length} lines</span></summary>
    <p class="note">The plan’s files have changed since: these lines were written about what they were before.</p>
    <ol class="record-lines">${list.map((row) => html`<li>${words(row)}<span class="dim">${row.changed_name}, ${when(row.changed_ms)}</span></li>`)}</ol></details></section>`,
  );
}

function exports(world) {
  const { room, ui } = world;
  const save = async () => {
    try {
      saveBlob(
        `record-${room.id}.json`,
        new Blob([JSON.stringify(await fetchRecord(room.id, room.identity, true), null, 1)], { type: 'application/json' }),
      );
    } catch (problem) {
      ui.notify('err', `No record: ${problem.message}`, 'record');
    }
  };
  const print = async () => {
    try {
      const [{ openRecordPrint }] = await Promise.all([import('./record_print.js'), styled('js/features/report/printout.css')]);
      await openRecordPrint(world);
    } catch (problem) {
      ui.notify('err', `The page to print could not be made: ${problem.message}`, 'record');
    }
  };
  return html`<section class="block"><h3>Export</h3><div class="note-buttons"><button @click=${print}>${icon('print', 12)} Page to print</button><button @click=${save}>JSON</button></div>
    <p class="note">An export is recorded. <code>beamroomd --verify-audit</code> checks what was recorded.</p></section>`;
}
