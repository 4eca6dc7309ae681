// Parts that do not fit: the bar above the panes, the marks, the form in Selection by which a person has them used all the same.
import { html, nothing } from '../../../lib/lit-html.js';
import { classMap } from '../../../lib/directives/class-map.js';
import { signal } from '../../../lib/signals-core.js';
import {
  byWordOf,
  factOf,
  inNumbersOf,
  leftOffPatch,
  markWords,
  minLetters,
  nLetters,
  partName,
  partOf,
  questionsOf,
  reasonName,
  reasonWords,
  reasons,
  selectedUse,
  selectionOf,
  usesOf,
  voidRows,
} from './fits.js';
import { patientOf } from '../../room/identity.js';
import { endLook, lookFirst } from './first_look.js';
import { icon } from '../../parts/icons.js';
import { say } from './later_words.js';

export { fitsTable, otherPatients, otherPatientsBar } from './fit_table.js';

const retryMs = 1000;
const tries = 20;
const isOpen = signal(false); // the list of the bar
const form = signal({ pair: '', reason: 'registered-elsewhere', words: '', error: '', isSent: false });

const worldUses = ({ room }) => usesOf(room.plan.value, room.scene.value, room.accepted.value);
const byAt = (row) => say.byAt({ author: row.author_name, time: time(row.created_ms) });
const time = (ms) => new Date(ms).toLocaleString([], { day: 'numeric', month: 'short', hour: '2-digit', minute: '2-digit' });

/** "Dose “Boost” is not used with MR:" in bold, what follows plain. */
function sentence(reason) {
  const at = reason.indexOf(': ');
  return at < 0 ? html`<b>${reason}</b>` : html`<b>${reason.slice(0, at + 1)}</b>${reason.slice(at + 1)}`;
}

// ---- the bar ------------------------------------------------------------------------------------------------------------------

export function fitBar(world) {
  const { room, ui } = world;
  const [plan, scene] = [room.plan.value, room.scene.value];
  if (!plan || !scene) return nothing;
  const waiting = questionsOf(plan, scene, worldUses(world));
  if (!waiting.length) return nothing;
  const [first, ...others] = waiting;
  const line = (use) => html`<p>${sentence(use.reason)}</p>${buttons(world, use)}`;
  return html`<div class="fit-bar" role="alert"><span class="warn">${icon('warning')}</span>${line(first)}
    ${room.following.isPresenting.value ? nothing : html`<span class="note why">${say.onlyPresenter}</span>`}
    ${
      others.length
        ? html`<button class="ghost" aria-expanded=${isOpen.value} @click=${() => {
            isOpen.value = !isOpen.value;
          }}>${say.andMore({ n: others.length })}</button>`
        : nothing
    }
    ${others.length && isOpen.value ? html`<ul>${others.map((use) => html`<li>${line(use)}</li>`)}</ul>` : nothing}</div>`;

  function buttons(of, use) {
    const change = (event) => room.patchScene(leftOffPatch(plan, scene, use), { view: ui.active.value, at: event.timeStamp });
    const mayAccept = room.following.isPresenting.value;
    return html`<button ?disabled=${!room.canChange.value || !mayAccept} title=${mayAccept ? '' : say.onlyPresenter}
        @click=${() => begin(of, use)}>${say.useAll}</button>
      <button class="ghost" ?disabled=${!room.canChange.value} @click=${change}>${say.leaveOff}</button>`;
  }
}

function begin({ room, ui }, use) {
  const pair = `${use.thing} ${use.with}`;
  if (form.peek().pair !== pair) form.value = { pair, reason: 'registered-elsewhere', words: '', error: '', isSent: false };
  ui.choose(...selectionOf(room.plan.peek(), use));
}

// ---- marks --------------------------------------------------------------------------------------------------------------------

/** In the row of a part: a triangle with ‘not used’, or with the two words where it is used by a person's word. */
export function rowMark(world, kind, id) {
  const use = selectedUse(world.room.plan.value, worldUses(world), { kind, id });
  if (!use) return nothing;
  const text = useWords(use);
  return html`<span class="fit-mark warn" title=${use.state === 'by-word' ? byWords(use) : use.reason}>${icon('warning', 12)} ${text}</span>`;
}

const useWords = (use) => (use.state === 'by-word' ? markWords(use.relation) : say.notUsed);

/** The words of that mark; '' where it has none. */
export function rowWords(world, kind, id) {
  const use = selectedUse(world.room.plan.value, worldUses(world), { kind, id });
  return use ? useWords(use) : '';
}

const byWords = ({ reason, by }) =>
  say.factUsedBy({ fact: factOf(reason), author: by.author_name, time: time(by.created_ms), words: by.body.words });

/** The marks of what is shown by a person's word, each once: of panes, legends, plots, numbers. kinds: of parts that it concerns; [] for all. */
export function wordMark(world, kinds = []) {
  const { room } = world;
  const used = byWordOf(room.plan.value, room.scene.value, worldUses(world)).filter(({ kind }) => !kinds.length || kinds.includes(kind));
  if (!used.length) return nothing;
  return mark(used);
}

const mark = (used) =>
  html`<span class="fit-mark warn" title=${used.map(byWords).join('\n')}>${icon('warning', 12)} ${markWords(used[0].relation)}</span>`;

const inNumbers = ({ room }) => inNumbersOf(room.plan.value, room.scene.value, worldUses({ room }));

/** The mark of numbers of dose: plots, limits. */
export function numberMark(world) {
  const used = inNumbers(world);
  return used.length ? mark(used) : nothing;
}

const withOther = (plan, use) => say.partWith({ part: partName(plan, use.thing), other: partName(plan, use.with) });

/** Uses in the numbers as rows of a file: [name, parts, fact, who, words]. */
export const usedRows = ({ room }) =>
  inNumbers({ room }).map((use) => [
    say.rowUsed,
    withOther(room.plan.value, use),
    factOf(use.reason),
    `${use.by.author_name}, ${new Date(use.by.created_ms).toISOString()}`,
    use.by.body.words,
  ]);

/** On paper: what is used though it does not fit, with who said so. */
export function usedSheet({ room }) {
  const plan = room.plan.value;
  const rows = [...room.accepted.value.values()];
  if (!rows.length) return nothing;
  const columns = [say.parts, say.fact, say.words, say.when];
  const line = ({ body, ...row }) => html`<tr><th scope="row">${withOther(plan, body)}</th><td>${factOf(body.fact)}</td>
      <td>${say.reasonWords({ reason: reasonName(body.reason), words: body.words })}</td><td>${byAt(row)}</td></tr>`;
  return html`<h2>${say.partsUsed}</h2><div class="numbers-scroll" role="group" tabindex="0" aria-label=${say.partsUsed}>
    <table class="numbers-table"><thead><tr>${columns.map((word) => html`<th scope="col">${word}</th>`)}</tr></thead>
    <tbody>${rows.map(line)}</tbody></table></div>`;
}

// ---- Selection ----------------------------------------------------------------------------------------------------------------

/** Above what Selection shows of a part that does not fit. */
export function fitBlock(world) {
  const { room, ui } = world;
  const use = selectedUse(room.plan.value, worldUses(world), ui.selection.value);
  if (!use) return nothing;
  if (use.needs === 'never')
    return html`<section class="block fit-block err"><h3>${icon('error')} ${partName(room.plan.value, use.thing)}</h3>
      <p>${sentence(use.reason)} ${say.itIsNever}</p></section>`;
  return use.state === 'by-word' ? usedBlock(world, use) : formBlock(world, use);
}

function factsTable(plan, use) {
  const [one, two] = [partOf(plan, use.thing), partOf(plan, use.with)];
  const of = (part, word) =>
    ({ patient: patientOf(plan, part?.patient), frame: part?.frame ?? null, plan: plan.treatmentPlans[part?.plan]?.label ?? '' })[word];
  const isStated = (value) => value !== null && value !== undefined && value !== '';
  const cell = (value, word) => (!isStated(value) ? say.notStated : word === 'frame' ? say.frameNumber({ n: Number(value) + 1 }) : value);
  const rows = [
    [say.patient, 'patient'],
    [say.frame, 'frame'],
    [say.plan, 'plan'],
  ].map(([name, word]) => [name, word, of(one.part, word), of(two.part, word)]);
  const line = ([name, word, a, b]) => {
    const isWarned = a !== b && (isStated(a) || isStated(b)) && word !== 'plan';
    return html`<tr class=${classMap({ warn: isWarned })}><th scope="row">${name}</th><td>${cell(a, word)}</td><td>${cell(b, word)}</td></tr>`;
  };
  const head = one.name ? say.partQuoted({ kind: one.lower, name: one.name }) : one.lower;
  return html`<table class="fit-facts"><thead><tr><td></td><th scope="col">${head}</th><th scope="col">${two.name}</th></tr></thead>
    <tbody>${rows.map(line)}</tbody></table>`;
}

function formBlock(world, use) {
  const { room, ui } = world;
  const plan = room.plan.value;
  const pair = `${use.thing} ${use.with}`;
  const now = form.value.pair === pair ? form.value : { pair, reason: 'registered-elsewhere', words: '', error: '', isSent: false };
  const set = (more) => {
    form.value = { ...now, ...more };
  };
  const mayAccept = room.following.isPresenting.value;
  const isShort = nLetters(now.words) < minLetters;
  const cancel = () => {
    set({ words: '', error: '' });
    endLook();
    ui.showTab('probe');
  };
  const part = partOf(plan, use.thing);
  return html`<section class="block fit-block" aria-label=${say.whatNot}>
    <h3 class="warn">${icon('warning')} ${say.notWith({ part: part.name || part.word, other: partOf(plan, use.with).name })}</h3>
    <p class="note">${use.reason}</p>${factsTable(plan, use)}
    ${lookFirst(world, use, !mayAccept || now.isSent)}
    <label class="fit-label" for="fit-reason">${say.why}</label>
    <select id="fit-reason" ?disabled=${!mayAccept || now.isSent} @change=${(event) => set({ reason: event.target.value })}>
      ${reasons.map(([id, name]) => html`<option value=${id} ?selected=${id === now.reason}>${name}</option>`)}</select>
    <label class="fit-label" for="fit-words">${say.inWords({ n: minLetters })}</label>
    <textarea id="fit-words" rows="2" maxlength="300" .value=${now.words} ?disabled=${!mayAccept || now.isSent}
      @input=${(event) => set({ words: event.target.value, error: '' })}></textarea>
    <p class="note">${say.everybodySees({ mark: icon('warning', 12) })}</p>
    ${now.error ? html`<p class="note err" role="alert">${now.error}</p>` : nothing}
    ${mayAccept ? nothing : html`<p class="note why">${icon('warning', 12)} ${say.onlyPresenter}</p>`}
    <div class="buttons"><button class="primary" ?disabled=${!mayAccept || isShort || now.isSent} @click=${() => accept(world, use, now, set)}>${say.use}</button>
      <button class="ghost" @click=${cancel}>${say.cancel}</button></div></section>
    ${listBlock(world)}`;
}

async function accept(world, use, { reason, words }, set) {
  const { room, clock, undo } = world;
  const body = { thing: use.thing, with: use.with, reason, words: words.trim() };
  set({ isSent: true, error: '' });
  for (let n = 1; ; n++) {
    try {
      const row = await room.items.put('acceptance', body);
      undo?.noteAct({ name: say.undoUse({ part: partName(room.plan.peek(), use.thing) }), ...acts(room, row, body) });
      endLook();
      return void set({ isSent: false, words: '' });
    } catch (problem) {
      if (problem.type !== '/problems/busy' || n === tries) return void set({ isSent: false, error: problem.detail || say.refused });
      await new Promise((done) => clock.setTimeout(done, retryMs));
    }
  }
}

/** Taking an acceptance back, and making it again. */
function acts(room, first, body) {
  let row = first;
  return {
    undo: () => room.items.delete(row),
    redo: async () => {
      row = await room.items.put('acceptance', body);
    },
  };
}

async function withdraw(world, row) {
  const { room, undo } = world;
  try {
    await room.items.delete(row);
    const body = { thing: row.body.thing, with: row.body.with, reason: row.body.reason, words: row.body.words };
    let again = row;
    undo?.noteAct({
      name: say.undoWithdrawal,
      undo: async () => {
        again = await room.items.put('acceptance', body);
      },
      redo: () => room.items.delete(again),
    });
  } catch (problem) {
    room.notify('err', problem.detail || say.refused);
  }
}

const usedBlock = (world, use) =>
  html`<section class="block fit-block"><h3 class="warn">${icon('warning')} ${markWords(use.relation)}</h3><p class="note">${factOf(use.reason)}</p></section>${listBlock(world)}`;

/** Lists the parts that are used all the same in this room, with the person who said so; and acceptances for other files. */
export function listBlock(world) {
  const { room } = world;
  const plan = room.plan.value;
  const rows = [...room.accepted.value.values()];
  const old = voidRows(room.items.rows.value, room.acceptances.value.items);
  if (!rows.length && !old.length) return nothing;
  const mayWithdraw = room.following.isPresenting.value;
  const entry = (
    row,
    isVoid,
  ) => html`<dl class=${classMap({ 'fit-used': true, void: isVoid })}><dt>${partOf(plan, row.body.thing).word}</dt>
      <dd>${say.usedPart({ part: partOf(plan, row.body.thing).name, other: partOf(plan, row.body.with).name })}</dd>
      <dt>${say.by}</dt><dd>${byAt(row)}</dd><dt>${say.because}</dt><dd>${reasonWords(row.body)}</dd></dl>
    ${isVoid ? html`<p class="note">${room.acceptances.value.known ? say.isVoid : say.notYet}</p>` : nothing}
    <div class="buttons"><button ?disabled=${!mayWithdraw} title=${mayWithdraw ? '' : say.onlyPresenterWithdraws}
      @click=${() => withdraw(world, row)}>${say.withdraw}</button></div>`;
  return html`<section class="block"><h3>${say.used} <span class="dim">${rows.length}</span></h3>${rows.map((row) => entry(row, false))}${old.map((row) => entry(row, true))}</section>`;
}
