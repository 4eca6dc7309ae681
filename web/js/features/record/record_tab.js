// The inspector's Record: checklist, decision, signatures, who was present, under the revision of the plan's files; its export.
import { html, nothing } from '../../../lib/lit-html.js';
import { repeat } from '../../../lib/directives/repeat.js';
import { signal } from '../../../lib/signals-core.js';
import { fetchRecord } from '../../net/record.js';
import { decisions, earlierRevisions, entriesOf, isOfFiles, linesOf, meanings, placeOf, roles, states, wordOf } from './checklist.js';
import { whenWords } from '../notes/threads.js';
import { say } from './later_words.js';
import { Record } from './record.js';
import { saveBlob } from '../../room/exports.js';
import { icon } from '../../parts/icons.js';
import { styled } from '../../parts/lazy.js';
import { mayWrite as mayWriteNotes, meIn } from '../notes/note_words.js';

const command = 'beamroomd --verify-audit';
const records = new WeakMap(); // by room
const failed = signal({}); // by form: why the server refused what was last written there
const codes = new Map(); // by form: the code of that refusal
const kept = signal({}); // by form: that it is being kept until what was written is on the server's disk, then since when
const comments = new Map(); // by entry: what is being written about it

/** Whether this member may write into the record; a guest may write notes at most. */
const mayWrite = (room) => mayWriteNotes(room) && !meIn(room).is_guest;

function recordOf({ room }) {
  if (!records.has(room)) records.set(room, new Record(room, globalThis));
  return records.get(room);
}

const fail = (form, problem) => {
  codes.set(form, problem?.code ?? '');
  failed.value = { ...failed.peek(), [form]: problem?.detail || problem?.message || '' };
};

const keep = (form, words) => {
  kept.value = { ...kept.peek(), [form]: words };
};
const timeOf = (ms) => new Date(ms).toLocaleTimeString([], { hour: '2-digit', minute: '2-digit' });

/** Writes an item, which the server accepts only once it is on its disk; why not stands at the form. Resolves to whether it was written. */
async function write(room, form, kind, body, of = null) {
  fail(form, null);
  keep(form, say.keeping);
  try {
    const { changed_ms: ms } = await room.items.put(kind, body, of);
    keep(form, say.kept({ time: timeOf(ms) }));
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

const by = (row) => say.byAt({ name: row.changed_name, time: when(row.changed_ms) });

export function recordTab(world) {
  const { room } = world;
  const rows = [...room.items.rows.value.values()];
  const record = recordOf(world);
  const present = room.members.value.map(({ id, connected }) => `${id} ${connected}`).join();
  const nLines = rows.filter(({ kind }) => kind === 'decision' || kind === 'signature').length;
  queueMicrotask(() => record.keep(`${room.planId.value} ${nLines} ${present}`));
  const facts = record.facts.value;
  if (!facts) return html`<p class="empty" role="status">${record.error.value || say.reading}</p>`;
  const said = room.plan.value?.statement; // of now: the facts may be older
  const revision = placeOf({ plan_revision: facts.plan_revision, statement_ms: said?.state === 'used' ? said.time_ms : 0 });
  return html`${head(facts)}${checks(world, rows, revision)}${decided(world, rows, revision)}${signed(world, rows, revision)}${attendance(facts)}${earlier(rows, revision)}${exports(world)}`;
}

const revisionCode = (revision) => html`<code title=${revision}>${revision.slice(0, 12)}</code>`;

const head = ({ plan_revision: revision, n_files: nFiles }) => html`<section class="block"><h3>${say.planRevision}</h3>
  <p class="note">${say.revisionIs({ revision: revisionCode(revision), n: nFiles })}</p></section>`;

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
  const form = html`<form class="record-add" @submit=${add}><input name="text" maxlength="200" aria-label=${say.another} placeholder=${say.another}>
    <button>${icon('plus', 12)} ${say.add}</button></form>`;
  return html`<section class="block"><h3>${say.checklist} <span class="dim">${say.doneOf({ n: nDone, all: entries.length })}</span></h3>
    <ol class="checks" aria-label=${say.checklist}>${repeat(
      entries,
      ({ key }) => key,
      (entry) => check(world, entry, revision),
    )}</ol>
    ${mayWrite(room) ? html`${form}${errorOf('entry')}` : nothing}</section>`;
}

function check({ room }, { key, entry, text, row }, revision) {
  const state = row?.body.state ?? 'open';
  const draft = comments.get(`${revision} ${key}`);
  const set = (part) => write(room, key, 'check', { entry, text, state, comment: row?.body.comment ?? '', ...part }, row);
  const onComment = async (event) => {
    const comment = event.target.value.trim();
    comments.set(`${revision} ${key}`, comment);
    if (comment === (row?.body.comment ?? '') || (await set({ comment }))) comments.delete(`${revision} ${key}`);
  };
  const id = `check-${key}`;
  const button = ([word, name]) => html`<button aria-pressed=${state === word} ?disabled=${!mayWrite(room)}
    @click=${() => state === word || set({ state: word })}>${word === 'ok' && state === 'ok' ? icon('check', 12) : nothing}${name}</button>`;
  const comment = () =>
    mayWrite(room)
      ? html`<textarea rows="2" maxlength="2000" aria-label=${say.wrongOf({ entry: text })} placeholder=${say.whatIsWrong}
          .value=${draft ?? row?.body.comment ?? ''} @change=${onComment}></textarea>`
      : html`<p class="note-words">${row.body.comment}</p>`;
  return html`<li data-check=${key} data-state=${state}><span class="check-text" id=${id}>${text}</span>
    <span class="segments" role="group" aria-labelledby=${id}>${states.map(button)}</span>
    ${row ? html`<span class="check-by dim">${by(row)}</span>` : nothing}
    ${state === 'issue' || row?.body.comment ? comment() : nothing}${errorOf(key)}</li>`;
}

// ---- decision and signatures -------------------------------------------------------------------------------------------

function lines(list, label, words, more = () => nothing) {
  if (!list.length) return nothing;
  const facts = ({ row, isCorrected }) =>
    (isCorrected ? say.byRoleCorrected : say.byRoleAt)({
      name: row.author_name,
      role: wordOf(roles, row.body.role),
      time: when(row.created_ms),
    });
  const line = (one) =>
    html`<li data-corrected=${one.isCorrected}>${words(one.row)}<span class="dim">${facts(one)}</span>${more(one.row)}</li>`;
  return html`<ol class="record-lines" aria-label=${label}>${list.map(line)}</ol>`;
}

const decisionWords = ({ body }) =>
  html`<b>${wordOf(decisions, body.decision)}</b>${body.text ? html`<span class="note-words">${body.text}</span>` : nothing}`;
const signatureWords = ({ body }) => html`<b>${body.name}</b> <span>${wordOf(meanings, body.meaning)}</span>`;

/** Opens the page to print of a decision, of a kept one alone. */
async function printDecision(world, id) {
  try {
    const [{ openPaper }] = await Promise.all([
      import('./record_paper.js'),
      styled('js/features/report/printout.css').then(() => styled('js/features/record/paper.css')),
    ]);
    await openPaper(world, id);
  } catch (problem) {
    world.ui.notify('err', say.noPage({ why: problem.message }), 'record');
  }
}

const printButton = (world) => (row) =>
  world.room.control.mayExport
    ? html`<button class="icon-button small" title=${say.printDecision} aria-label=${say.printDecision} @click=${() => printDecision(world, row.id)}>${icon('print', 12)}</button>`
    : nothing;

const option = ([id, name]) => html`<option value=${id}>${name}</option>`;

/** Which earlier line a new one corrects. */
const corrects = (list, words) => {
  const open = list.filter(({ isCorrected }) => !isCorrected);
  return open.length
    ? html`<label>${say.corrects} <select name="corrects"><option value="">${say.noEarlier}</option>
        ${open.map(({ row }) => html`<option value=${row.id}>${words(row)}</option>`)}</select></label>`
    : nothing;
};

function decided(world, rows, revision) {
  const { room } = world;
  const list = linesOf(rows, 'decision', revision);
  const submit = async (event) => {
    event.preventDefault();
    const form = event.target;
    const data = Object.fromEntries(new FormData(form));
    if (await write(room, 'decision', 'decision', { decision: data.decision, text: data.text.trim(), corrects: data.corrects ?? '' }))
      form.reset();
  };
  const { user, role } = meIn(room);
  const isMine = mayWrite(room) && (Boolean(user) || role === 'presenter'); // without sign-in presenters alone decide
  return html`<section class="block"><h3>${say.decision}</h3>${lines(list, say.decisions, decisionWords, printButton(world))}
    ${
      isMine
        ? html`<form class="record-form" @submit=${submit}><label>${say.decision} <select name="decision" required>
        <option value="">–</option>${decisions.map(option)}</select></label>
      <label>${say.inWords} <textarea name="text" rows="2" maxlength="2000"></textarea></label>
      ${corrects(list, ({ body }) => wordOf(decisions, body.decision))}
      <p class="note">${say.decisionStays}</p><div class="note-buttons"><button>${say.writeDown}</button></div></form>${errorOf('decision')}`
        : list.length
          ? nothing
          : html`<p class="note">${say.noDecision}</p>`
    }</section>`;
}

const signatureOf = ({ body }) => say.signatureOf({ name: body.name, meaning: wordOf(meanings, body.meaning) });

/** Signatures and the form for one: a person who is signed in signs under that name, and proves it once more; elsewhere a name is typed, but on a server that is open to everybody. */
function signed({ room, session }, rows, revision) {
  const list = linesOf(rows, 'signature', revision);
  const submit = async (event) => {
    event.preventDefault();
    const form = event.target;
    const data = Object.fromEntries(new FormData(form));
    if (await write(room, 'signature', 'signature', { name: data.name.trim(), meaning: data.meaning, corrects: data.corrects ?? '' }))
      form.reset();
  };
  return html`<section class="block"><h3>${say.signatures}</h3>${lines(list, say.signatures, signatureWords)}
    ${
      session.value
        ? html`${session.value.signing({
            room: room.id,
            isGuest: !mayWrite(room),
            fields: html`<label>${say.meaning} <select name="meaning">${meanings.map(option)}</select></label>${corrects(list, signatureOf)}`,
            note: html`<p class="note">${say.lineStays}</p>`,
            write: (body) => write(room, 'signature', 'signature', body).then((isDone) => isDone || codes.get('signature')),
          })}${errorOf('signature')}`
        : mayWrite(room)
          ? html`<form class="record-form" @submit=${submit}><label>${say.name} <input name="name" required maxlength="80" autocomplete="name"></label>
      <label>${say.meaning} <select name="meaning">${meanings.map(option)}</select></label>${corrects(list, signatureOf)}
      <p class="note">${say.legal} ${say.lineStays}</p><div class="note-buttons"><button>${say.sign}</button></div></form>${errorOf('signature')}`
          : html`<p class="note">${say.legal}</p>`
    }</section>`;
}

// ---- who was there, earlier revisions, export --------------------------------------------------------------------------

function attendance({ present, n_present_dropped: nDropped }) {
  const stay = ({ name, role, entered_ms: from, left_ms: to, here }) => {
    const end = to ? when(to) : here ? say.now : say.serverEnded;
    return html`<li><b>${name}</b> <span class="dim">${say.stay({ role: wordOf(roles, role), from: when(from), to: end })}</span></li>`;
  };
  return html`<section class="block"><h3>${say.present}</h3><ul class="record-present" aria-label=${say.present}>${present.map(stay)}</ul>
    ${nDropped ? html`<p class="note">${say.notKept({ n: nDropped })}</p>` : nothing}</section>`;
}

function earlier(rows, revision) {
  const groups = earlierRevisions(rows, revision);
  const words = (row) =>
    row.kind === 'check'
      ? html`${say.entryIs({ entry: row.body.text, state: html`<b>${wordOf(states, row.body.state)}</b>` })}${row.body.comment ? html`<span class="note-words">${row.body.comment}</span>` : nothing}`
      : row.kind === 'decision'
        ? decisionWords(row)
        : signatureWords(row);
  return groups.map(
    ({ revision: of, rows: list }) => html`<section class="block"><details class="record-earlier">
    <summary>${say.earlierRevision({ revision: revisionCode(of) })} <span class="dim">${say.nLines({ n: list.length })}</span></summary>
    <p class="note">${isOfFiles(of, revision) ? say.statedAnew : say.filesChanged}</p>
    <ol class="record-lines">${list.map((row) => html`<li>${words(row)}<span class="dim">${by(row)}</span></li>`)}</ol></details></section>`,
  );
}

function exports(world) {
  const { room, ui } = world;
  if (!room.control.mayExport) return nothing;
  const save = async () => {
    try {
      saveBlob(
        `record-${room.id}.json`,
        new Blob([JSON.stringify(await fetchRecord(room.id, room.identity, true), null, 1)], { type: 'application/json' }),
      );
    } catch (problem) {
      ui.notify('err', say.noRecord({ why: problem.message }), 'record');
    }
  };
  const decisionRows = [...room.items.rows.value.values()].filter(({ kind }) => kind === 'decision');
  const newest = decisionRows.sort((a, b) => a.created_ms - b.created_ms).at(-1);
  const print = async () => {
    if (newest) return printDecision(world, newest.id); // of the moment of the decision, not of now
    try {
      const [{ openRecordPrint }] = await Promise.all([import('./record_print.js'), styled('js/features/report/printout.css')]);
      await openRecordPrint(world);
    } catch (problem) {
      ui.notify('err', say.noPage({ why: problem.message }), 'record');
    }
  };
  return html`<section class="block"><h3>${say.export}</h3>
    <div class="note-buttons"><button @click=${print}>${icon('print', 12)} ${say.page}</button><button @click=${save}>JSON</button></div>
    <p class="note">${say.exportIs({ command: html`<code>${command}</code>` })}</p></section>`;
}
