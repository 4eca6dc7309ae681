// Help shared by the parts of notes: this member and their rights, the line with author and time, a text with its mentions.
import { html, nothing } from '../../../lib/lit-html.js';
import { say } from './later_words.js';
import { partsOf, whenWords } from './threads.js';
import { variables } from '../../parts/mount.js';

/** This member, as notes name one. @returns {{id: string, name: string, role: string}} */
export function meIn(room) {
  const id = room.member.value;
  const row = room.members.value.find((member) => member.id === id);
  return { id, name: row?.name ?? room.identity?.name ?? '', role: row?.role ?? '' };
}

export const mayWrite = (room) => meIn(room).role !== 'observer' && room.link.value.state !== 'ended';
export const mayChange = (room, row) => mayWrite(room) && (row.author === room.member.value || meIn(room).role === 'presenter');

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
  return html`<span class="note-by"><i class="note-dot" ${variables({ '--author': row.author_color })}></i><b>${row.author_name}</b>
    <time class="dim" datetime=${full.toISOString()} title=${full.toLocaleString()}>${whenWords(row.created_ms, now)}</time>${isChanged ? changed(row, now) : nothing}</span>`;
}

export const words = (row) =>
  partsOf(row.body.text, row.body.mentions).map(({ text, isName }) => (isName ? html`<b class="note-name">${text}</b>` : text));
