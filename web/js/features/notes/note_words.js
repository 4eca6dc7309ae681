// Help shared by the parts of notes: this member and their rights, the line with author and time, a text with its mentions.
import { html, nothing } from '../../../lib/lit-html.js';
import { say } from './later_words.js';
import { partsOf, whenWords } from './threads.js';
import { variables } from '../../parts/mount.js';

/** This member, as notes name one; user: empty without sign-in. @returns {{id: string, name: string, role: string, user: string, is_guest: boolean}} */
export function meIn(room) {
  const id = room.member.value;
  const row = room.members.value.find((member) => member.id === id);
  const { name = room.identity?.name ?? '', role = '', user = '', is_guest = false } = row ?? {};
  return { id, name, role, user, is_guest };
}

export const mayWrite = (room) => !['observer', 'wall'].includes(meIn(room).role) && room.link.value.state !== 'ended';

/** With sign-in a note is its writer's alone; a planner hides it. */
export function mayChange(room, row) {
  const me = meIn(room);
  const isOwn = row.author_user ? row.author_user === me.user : row.author === me.id;
  return mayWrite(room) && (isOwn || (!me.user && !me.is_guest && me.role === 'presenter'));
}

export const mayHide = (room) => mayWrite(room) && meIn(room).role === 'planner';

function changed(row, now) {
  const isOwn = row.changed_name === row.author_name;
  const title = say.version({ n: row.version, time: new Date(row.changed_ms).toLocaleString() });
  const words = (isOwn ? say.changedAt : say.changedByAt)({ name: row.changed_name, time: whenWords(row.changed_ms, now) });
  return html`<span class="dim" title=${title}>${words}</span>`;
}

/** The author's colour and name, and when; who changed it, when that was another. */
export function byline(row) {
  const [now, full] = [Date.now(), new Date(row.created_ms)];
  const isChanged = row.version > 1;
  return html`<span class="note-by"><i class="note-dot" ${variables({ '--author': row.author_color })}></i><b>${row.author_name}</b>${row.is_guest ? html` <span class="dim">${say.guest}</span>` : nothing}
    <time class="dim" datetime=${full.toISOString()} title=${full.toLocaleString()}>${whenWords(row.created_ms, now)}</time>${isChanged ? changed(row, now) : nothing}</span>`;
}

/** The text of a note; of a hidden one the sentence that says by whom. */
export const textOf = (row) => (row.hidden_by ? say.hiddenBy({ name: row.hidden_by }) : row.body.text);

export const words = (row) =>
  partsOf(textOf(row), row.hidden_by ? [] : row.body.mentions).map(({ text, isName }) =>
    isName ? html`<b class="note-name">${text}</b>` : text,
  );
