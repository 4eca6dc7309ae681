// The checklist of a plan review, and the words of the record. Pure.

/** [id, words]: an entry's words are kept with what members say about it. */
export const checklist = [
  ['identity', 'Plan, patient position and treated side are those of the prescription'],
  ['registration', 'Images are registered, and oriented as the patient lies'],
  ['regions', 'Targets and organs at risk are complete and rightly named'],
  ['boron', 'Boron concentrations, ratios and biological weights are as prescribed'],
  ['dose', 'Dose is plausible by component and in total; unit and fraction are clear'],
  ['constraints', 'Constraints of organs at risk and the coverage of the target are met'],
  ['beam', 'Beam, aperture, gap and irradiation time are as planned'],
  ['positioning', 'The position can be set up, and checked at the beam'],
  ['deviations', 'Deviations from the protocol are named and justified'],
];
export const states = [
  ['open', 'Open'],
  ['ok', 'OK'],
  ['issue', 'Issue'],
];
export const decisions = [
  ['accept', 'Accept'],
  ['accept-with-changes', 'Accept with changes'],
  ['reject', 'Reject'],
  ['defer', 'Defer'],
];
export const meanings = [
  ['reviewed', 'Reviewed'],
  ['approved', 'Approved'],
  ['seen', 'Seen'],
];
export const wordOf = (words, id) => words.find(([word]) => word === id)?.[1] ?? id;
export const legal = 'Names are as members gave them; these lines are not electronic signatures in the legal sense.';

const entryOf = (row) => row.body.entry || row.id;

/** The entries under one revision, in the checklist's order, then those that members added: {key, entry, text, row: the item or null}. */
export function entriesOf(rows, revision) {
  const here = rows.filter(({ kind, body }) => kind === 'check' && body.plan_revision === revision);
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
  const lines = rows.filter((row) => row.kind === kind && row.body.plan_revision === revision);
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
    if (['check', 'decision', 'signature'].includes(row.kind) && row.body.plan_revision !== revision)
      groups.set(row.body.plan_revision, [...(groups.get(row.body.plan_revision) ?? []), row]);
  return [...groups]
    .map(([of, list]) => ({ revision: of, rows: list }))
    .sort((a, b) => b.rows.at(-1).created_ms - a.rows.at(-1).created_ms);
}
