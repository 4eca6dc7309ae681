// The checklist of a plan review, and the words of the record. Pure.
import { say } from './later_words.js';

/** [id, words]: an entry's words are kept with what members say about it. */
export const checklist = [
  ['identity', say.identity],
  ['registration', say.registration],
  ['regions', say.regions],
  ['boron', say.boron],
  ['dose', say.dose],
  ['constraints', say.constraints],
  ['beam', say.beam],
  ['positioning', say.positioning],
  ['deviations', say.deviations],
];
export const states = [
  ['open', say.open],
  ['ok', say.ok],
  ['issue', say.issue],
];
export const decisions = [
  ['accept', say.accept],
  ['accept-with-changes', say.acceptWithChanges],
  ['reject', say.reject],
  ['defer', say.defer],
];
export const meanings = [
  ['reviewed', say.reviewed],
  ['approved', say.approved],
  ['seen', say.seen],
];
export const roles = [
  ['planner', say.isPlanner],
  ['presenter', say.isPresenter],
  ['reviewer', say.isReviewer],
  ['observer', say.isObserver],
];
export const wordOf = (words, id) => words.find(([word]) => word === id)?.[1] ?? id;

const entryOf = (row) => row.body.entry || row.id;

/** The place of a line: the revision of the plan's files and, where one was used, when it was stated whom the plan is of. */
export const placeOf = ({ plan_revision: revision, statement_ms: ms }) => (ms ? `${revision} ${ms}` : revision);

/** Whether both places are of the same files: what was stated of whom they are is another then. */
export const isOfFiles = (place, other) => place.split(' ')[0] === other.split(' ')[0];

/** The entries under one revision, in the checklist's order, then those that members added: {key, entry, text, row: the item or null}. */
export function entriesOf(rows, revision) {
  const here = rows.filter(({ kind, body }) => kind === 'check' && placeOf(body) === revision);
  const marked = new Map(here.map((row) => [entryOf(row), row]));
  return [
    ...checklist.map(([id, text]) => ({ key: id, entry: id, text: marked.get(id)?.body.text ?? text, row: marked.get(id) ?? null })),
    ...here
      .filter(({ body }) => !checklist.some(([id]) => id === body.entry))
      .map((row) => ({ key: row.id, entry: row.body.entry, text: row.body.text, row })),
  ];
}

/** Items of one kind under a revision, oldest first; corrected: those that a later one replaces. */
export function linesOf(rows, kind, revision) {
  const lines = rows.filter((row) => row.kind === kind && placeOf(row.body) === revision);
  const corrected = new Set(
    rows
      .filter((row) => row.kind === kind)
      .map(({ body }) => body.corrects)
      .filter(Boolean),
  );
  return lines.map((row) => ({ row, isCorrected: corrected.has(row.id) }));
}

/** The other revisions that lines stand under, the newest first. @returns {{revision: string, rows: object[]}[]} */
export function earlierRevisions(rows, revision) {
  const groups = new Map();
  for (const row of rows)
    if (['check', 'decision', 'signature'].includes(row.kind) && placeOf(row.body) !== revision)
      groups.set(placeOf(row.body), [...(groups.get(placeOf(row.body)) ?? []), row]);
  return [...groups]
    .map(([of, list]) => ({ revision: of, rows: list }))
    .sort((a, b) => b.rows.at(-1).created_ms - a.rows.at(-1).created_ms);
}
