// Notes of a room as threads: their numbers, their filter, who is mentioned. Pure.

export const maxText = 2000; // characters, server/room/items/note_body.h
const maxMentions = 16;

/** @typedef {{note: object, number: number, replies: object[], lastMs: number}} Thread */

/** All notes with their replies, oldest first; a reply whose note is gone stands for itself. @returns {Thread[]} */
export function threadsOf(rows) {
  const ids = new Set(rows.map(({ id }) => id));
  const isReply = ({ body }) => body.parent !== '' && ids.has(body.parent);
  return rows
    .filter((row) => !isReply(row))
    .map((note, index) => {
      const replies = rows.filter((row) => isReply(row) && row.body.parent === note.id);
      return { note, number: index + 1, replies, lastMs: Math.max(...[note, ...replies].map(({ changed_ms: ms }) => ms)) };
    });
}

export const isResolved = ({ note }) => note.body.resolved;

/** Whether a text names this member: by id, or by name for who has come back as another member. */
export const mentions = (row, { id, name }) =>
  row.body.mentions.some((mention) => mention.member === id || mention.name.toLowerCase() === name.toLowerCase());

/** @typedef {{text: string, author: string, who: 'all'|'mine'|'mentions', hasResolved: boolean}} NoteFilter author: a name, '' all */
export const noFilter = { text: '', author: '', who: 'all', hasResolved: false };

/** The threads that pass, open ones first, then by what was written last. @param {Thread[]} threads @param {NoteFilter} filter @param {{id: string, name: string}} me */
export function filtered(threads, { text, author, who, hasResolved }, me) {
  const words = text.trim().toLowerCase();
  const rowsOf = ({ note, replies }) => [note, ...replies];
  const passes = [
    (thread) => hasResolved || !isResolved(thread),
    (thread) => !words || rowsOf(thread).some(({ body, author_name: name }) => `${body.text}\n${name}`.toLowerCase().includes(words)),
    (thread) => !author || rowsOf(thread).some(({ author_name: name }) => name === author),
    (thread) => who === 'all' || rowsOf(thread).some((row) => (who === 'mine' ? row.author === me.id : mentions(row, me))),
  ];
  return threads
    .filter((thread) => passes.every((pass) => pass(thread)))
    .sort((a, b) => isResolved(a) - isResolved(b) || b.lastMs - a.lastMs || b.number - a.number);
}

/** The names of all who wrote, each once. */
export const authorsOf = (rows) => [...new Set(rows.map(({ author_name: name }) => name))].sort((a, b) => a.localeCompare(b));

/** The mentions of a body: members, and people mentioned before, whose "@name" is in the text. */
export function mentionsIn(text, members, before = []) {
  const all = [...members.map(({ id, name }) => ({ member: id, name })), ...before];
  const found = all.filter(
    ({ name }, at) => text.includes(`@${name}`) && all.findIndex((other) => other.member === name || other.name === name) === at,
  );
  return found.slice(0, maxMentions);
}

/** The name that is being written before the caret: where its "@" is, and the members it may become; null: none. */
export function completion(text, caret, members) {
  const at = text.lastIndexOf('@', caret - 1);
  if (at < 0 || (at > 0 && !/\s|[([]/.test(text[at - 1]))) return null;
  const begun = text.slice(at + 1, caret).toLowerCase();
  if (begun.includes('\n')) return null;
  const names = [...new Set(members.map(({ name }) => name))].filter(
    (name) => name.toLowerCase().startsWith(begun) && name.toLowerCase() !== begun,
  );
  return names.length ? { at, names: names.slice(0, 6) } : null;
}

/** The text in parts, of which those with a name are mentions. @returns {{text: string, isName: boolean}[]} */
export function partsOf(text, mentioned) {
  const names = mentioned.map(({ name }) => `@${name}`).sort((a, b) => b.length - a.length);
  const parts = [];
  let plain = '';
  for (let at = 0; at < text.length; ) {
    const name = names.find((other) => text.startsWith(other, at));
    if (name) {
      if (plain) parts.push({ text: plain, isName: false });
      parts.push({ text: name, isName: true });
      plain = '';
    } else {
      plain += text[at];
    }
    at += name?.length ?? 1;
  }
  return plain ? [...parts, { text: plain, isName: false }] : parts;
}

/** The point of a note: its own, else the centre of its region; null: it is about the plan. */
export function pointOf(note, plan) {
  const { anchor } = note.body;
  return anchor?.point_mm ?? (anchor?.region ? (plan?.regions.find(({ id }) => id === anchor.region)?.center_mm ?? null) : null);
}

const fadeMm = 20;

/** How much of a pin is left this far from the slice, 0 to 1. @param {number} awayMm @param {number} toleranceMm half a slice */
export const pinStrength = (awayMm, toleranceMm) => (awayMm <= toleranceMm ? 1 : Math.max(0, 0.6 * (1 - (awayMm - toleranceMm) / fadeMm)));

/** "14:05" today, else with the date, in local time. */
export function whenWords(ms, nowMs, locale = undefined) {
  const [then, now] = [new Date(ms), new Date(nowMs)];
  const time = then.toLocaleTimeString(locale, { hour: '2-digit', minute: '2-digit' });
  return then.toDateString() === now.toDateString()
    ? time
    : `${then.toLocaleDateString(locale, { day: 'numeric', month: 'short', ...(then.getFullYear() !== now.getFullYear() && { year: 'numeric' }) })}, ${time}`;
}
