// The inspector's Notes: new ones, the filter, the list, and the thread of the one that is open.
import { html, nothing } from '../../../lib/lit-html.js';
import { classMap } from '../../../lib/directives/class-map.js';
import { repeat } from '../../../lib/directives/repeat.js';
import { signal } from '../../../lib/signals-core.js';
import { authorsOf, filtered, isResolved, noFilter, pointOf, threadsOf } from './threads.js';
import { crosshairPatch, shownImage } from '../../room/plan.js';
import { keyMark } from '../../parts/fields.js';
import { position } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { say } from './later_words.js';
import { beginWith, focusField, leftOver, noteEditor } from './note_editor.js';
import { byline, mayChange, mayHide, mayWrite, meIn, words } from './note_words.js';
import { noteHere } from './feature.js';

const filter = signal(noFilter);
const editing = signal(''); // id of the row that is being changed
const deleting = signal(''); // id of the row whose deletion is to be confirmed
let focusedFor = null; // the new note whose field has had the focus

const regionName = (room, id) => room.plan.value.regions.find((region) => region.id === id)?.name ?? say.notInPlan({ region: id });

/** "L 1.0  P 2.0  S 3.0 mm", "Brain", "Plan". */
function placeWords(room, anchor) {
  if (!anchor) return say.planAsWhole;
  return [anchor.region && regionName(room, anchor.region), anchor.point_mm && position(anchor.point_mm)].filter(Boolean).join(' · ');
}

export function notesTab(world) {
  const { room, ui } = world;
  const rows = room.items.notes.value;
  const threads = threadsOf(rows);
  const opened = threads.find(({ note, replies }) => note.id === ui.note.value || replies.some(({ id }) => id === ui.note.value));
  const shown = filtered(threads, filter.value, meIn(room));
  if (opened && !shown.includes(opened)) shown.unshift(opened); // a pin that was clicked, whatever the filter
  return html`${head(world)}${left(world, rows)}${threads.length ? filters(room, rows, threads) : nothing}
    ${
      shown.length
        ? html`<ol class="notes" aria-label=${say.notes}>${repeat(
            shown,
            ({ note }) => note.id,
            (thread) => item(world, thread, thread === opened),
          )}</ol>`
        : html`<p class="empty">${threads.length ? say.nonePasses : say.none}</p>`
    }`;
}

function head(world) {
  const { room, ui } = world;
  if (!mayWrite(room))
    return html`<section class="block"><p class="note">${room.link.value.state === 'ended' ? say.ended : say.observer}</p></section>`;
  const region = ui.region.value;
  const anchor = ui.newNote.value;
  if (!anchor)
    return html`<section class="block note-new">
      <button @click=${() => noteHere(world)}>${icon('plus', 12)} ${say.atCrosshair({ key: keyMark(world.ui.keys.text('note')) })}</button>
      ${
        region
          ? html`<button @click=${() => {
              ui.newNote.value = { region };
            }}>${icon('plus', 12)} ${say.onRegion({ region: regionName(room, region) })}</button>`
          : nothing
      }</section>`;
  if (focusedFor !== anchor) {
    focusedFor = anchor;
    focusField('new');
  }
  const save = async (text, mentions) => {
    const made = await room.items.put('note', { text, anchor, resolved: false, mentions, parent: '' });
    if (made) ui.note.value = made.id;
  };
  return html`<section class="block">${noteEditor(world, {
    key: 'new',
    label: say.newNote({ place: placeWords(room, anchor) }),
    word: say.add,
    save,
    cancel: () => {
      ui.newNote.value = null;
    },
  })}</section>`;
}

/** Words that were written for a note that somebody has deleted are not lost with it. */
function left({ room, ui }, rows) {
  return leftOver(room, new Set(rows.map(({ id }) => id))).map(({ text, drop }) => {
    const again = () => {
      beginWith(room, 'new', text);
      drop();
      noteHere({ room, ui });
    };
    return html`<section class="block" role="status"><p class="note-error">${say.lostNote}</p><p class="note-words">${text}</p>
      <div class="note-buttons">${mayWrite(room) && !ui.newNote.value ? html`<button @click=${again}>${say.asNew}</button>` : nothing}
        <button @click=${drop}>${say.discard}</button></div></section>`;
  });
}

function filters(room, rows, threads) {
  const set = (part) => {
    filter.value = { ...filter.peek(), ...part };
  };
  const { text, author, who, hasResolved } = filter.value;
  const nResolved = threads.filter(isResolved).length;
  return html`<section class="block note-filter" role="group" aria-label=${say.which}>
    <input type="search" placeholder=${say.filter} aria-label=${say.textIn} .value=${text} @input=${({ target }) => set({ text: target.value })}>
    <select aria-label=${say.whose} @change=${({ target }) => set({ who: target.value })}>${[
      ['all', say.all],
      ['mine', say.mine],
      ['mentions', say.mentionMe],
    ].map(([id, name]) => html`<option value=${id} ?selected=${who === id}>${name}</option>`)}</select>
    <select aria-label=${say.author} @change=${({ target }) => set({ author: target.value })}><option value="" ?selected=${!author}>${say.byAnybody}</option>
      ${authorsOf(rows).map((name) => html`<option value=${name} ?selected=${author === name}>${name}</option>`)}</select>
    <label class="note-check"><input type="checkbox" .checked=${hasResolved} @change=${({ target }) => set({ hasResolved: target.checked })}>
      ${nResolved ? say.resolvedCount({ n: nResolved }) : say.resolved}</label></section>`;
}

function item(world, thread, isOpen) {
  const { room, ui } = world;
  const { note, number, replies } = thread;
  const isDone = isResolved(thread);
  const id = `note-${note.id}`;
  const toggle = () => {
    ui.note.value = isOpen ? '' : note.id;
    deleting.value = '';
  };
  const answer = (text, mentions) => room.items.put('note', { text, mentions, parent: note.id });
  return html`<li class=${classMap({ open: isOpen, resolved: isDone })} data-note=${note.id}>
    <button class="note-head" aria-expanded=${isOpen} aria-controls=${isOpen ? id : nothing} @click=${toggle}>
      <span class="note-number">${isDone ? icon('check', 12) : number}<span class="hidden">${isDone ? html` ${say.noteResolved({ number })}` : ''}</span></span>
      <span class="note-line"><span class="note-text">${words(note)}</span>
        <span class="note-facts">${byline(note)}${replies.length ? html`<span class="dim">${say.nReplies({ n: replies.length })}</span>` : nothing}</span></span></button>
    ${
      isOpen
        ? html`<div class="note-thread" id=${id}><p class="dim note-place">${placeWords(room, note.body.anchor)}</p>${actions(world, thread)}
      ${editing.value === note.id ? editor(world, note) : nothing}
      <ol class="note-replies" aria-label=${say.replies}>${repeat(
        replies,
        (reply) => reply.id,
        (reply) => html`<li data-note=${reply.id}>${byline(reply)}
        ${editing.value === reply.id ? editor(world, reply) : html`<p class="note-words">${words(reply)}</p>${rowActions(world, reply, [])}`}</li>`,
      )}</ol>
      ${mayWrite(room) ? noteEditor(world, { key: `re-${note.id}`, label: say.reply, word: say.reply, save: answer }) : nothing}</div>`
        : nothing
    }</li>`;
}

/** Whether the jump moves the room or this person's own view stands on the button. */
function actions(world, thread) {
  const { room, ui } = world;
  const { note, replies } = thread;
  const point = pointOf(note, room.plan.value);
  const isForAll = room.following.isPresenting.value && room.members.value.filter(({ connected }) => connected !== false).length > 1;
  const jump = (event) => {
    const plan = room.plan.value;
    if (note.body.anchor?.region) ui.select('region', note.body.anchor.region, false);
    room.patchScene(crosshairPatch(plan, shownImage(plan, room.scene.value), point, { isFree: true }), {
      view: ui.active.value,
      at: event.timeStamp,
    });
  };
  const jumpButton = () => html`<button ?disabled=${!room.canChange.value} title=${isForAll ? say.jumpAllIs : say.jumpOwnIs}
      @click=${jump}>${icon('target', 12)} ${isForAll ? say.jumpAll : say.jumpOwn}</button>`;
  const resolve = () => change(world, note, { resolved: !note.body.resolved });
  return html`<div class="note-buttons">${point ? jumpButton() : nothing}
    ${mayChange(room, note) ? html`<button @click=${resolve}>${icon('check', 12)} ${note.body.resolved ? say.reopen : say.resolve}</button>` : nothing}
    ${rowActions(world, note, replies)}</div>`;
}

function rowActions(world, row, replies) {
  const { room, ui } = world;
  const hide = () => void room.items.hide(row, !row.hidden_by).catch((problem) => ui.notify('err', problem.detail, 'notes'));
  const hideButton = mayHide(room) ? html`<button class="link" @click=${hide}>${row.hidden_by ? say.unhide : say.hide}</button>` : nothing;
  if (!mayChange(room, row)) return mayHide(room) ? html`<span class="note-row">${hideButton}</span>` : nothing;
  const edit = () => {
    editing.value = row.id;
    beginWith(room, `edit-${row.id}`, row.body.text);
    focusField(`edit-${row.id}`);
  };
  const remove = async () => {
    if (deleting.peek() !== row.id) return void (deleting.value = row.id);
    deleting.value = '';
    try {
      await room.items.delete(row);
    } catch (problem) {
      ui.notify('err', problem.detail, 'notes');
    }
  };
  const isAsked = deleting.value === row.id;
  const sure = replies.length ? say.deleteWith({ n: replies.length }) : say.deleteAll;
  return html`<span class="note-row"><button class="link" @click=${edit}>${say.edit}</button><button class=${classMap({ link: true, sure: isAsked })}
    @click=${remove}>${isAsked ? sure : say.delete}</button>${hideButton}</span>`;
}

/** Writes another body; a refusal is told. */
async function change({ room, ui }, row, part) {
  try {
    await room.items.put('note', { ...row.body, ...part }, row);
  } catch (problem) {
    ui.notify('err', problem.detail, 'notes');
  }
}

/** Saving again after a conflict is for the version that is shown by then, above the field. */
function editor(world, row) {
  const { room } = world;
  const save = (text, mentions) =>
    room.items.put('note', { ...row.body, text, mentions }, bases.get(row.id) ?? row).catch((problem) => {
      bases.delete(row.id);
      throw problem.type === '/problems/conflict' ? { detail: say.conflict({ detail: problem.detail }) } : problem;
    });
  if (!bases.has(row.id)) bases.set(row.id, row);
  return html`${bases.get(row.id) !== row ? html`<p class="note-error" role="status">${say.changedMeanwhile({ name: row.changed_name })}</p>` : nothing}${noteEditor(
    world,
    {
      key: `edit-${row.id}`,
      label: say.change,
      word: say.save,
      save,
      before: row.body.mentions,
      cancel: () => {
        bases.delete(row.id);
        editing.value = '';
      },
    },
  )}`;
}
const bases = new Map(); // by id: the row that was there when its change was begun
