// The record as a page to print: on the sheets of the report to print (js/features/report/printout.css). The plan is named by its id: names may be a patient's.
import { html, nothing } from '../../../lib/lit-html.js';
import { signal } from '../../../lib/signals-core.js';
import { fetchRecord } from '../../net/record.js';
import { decisions, entriesOf, isOfFiles, linesOf, meanings, placeOf, roles, states, wordOf } from './checklist.js';
import { printable } from '../../room/exports.js';
import { number } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { say } from './later_words.js';

const shown = signal(null); // {record, pictures: [{name, url}]}
const time = (ms) => new Date(ms).toISOString().slice(0, 16).replace('T', ' ');

export async function openRecordPrint(world) {
  const { api, room, ui, printoutDialog } = world;
  const record = await fetchRecord(room.id, room.identity, true);
  const pictures = await Promise.all(
    record.saved_views.slice(0, 24).map(async ({ id, name }) => ({
      name,
      url: await api.bookmarkPicture(room.id, id).then(
        (blob) => URL.createObjectURL(blob),
        () => '',
      ),
    })),
  );
  shown.value = { record, pictures };
  printoutDialog.value = recordDialog;
  ui.popover.value = 'record';
}

function recordDialog(world) {
  const { ui } = world;
  if (ui.popover.value !== 'record' || !shown.value) return nothing;
  const close = () => {
    ui.popover.value = '';
    for (const { url } of shown.peek().pictures) if (url) URL.revokeObjectURL(url);
    shown.value = null;
  };
  const print = printable(world, 'printed-record', `record of room ${shown.value.record.room}`); // in the audit's language
  return html`<section class="printout record-print" role="dialog" aria-modal="true" tabindex="-1" aria-label=${say.toPrint}>
    <div class="printout-bar"><b>${say.toPrint}</b><span class="grow"></span>
      <button class="primary" @click=${print}>${icon('print')}<span>${say.print}</span></button>
      <button class="icon-button" aria-label=${say.close} @click=${close}>${icon('close')}</button></div>${sheet(world, shown.value)}</section>`;
}

function sheet({ printout }, { record, pictures }) {
  const figures = [
    ...printout.entries.value.map(({ url, caption }) => ({ url, name: caption || say.chosen })),
    ...pictures.filter(({ url }) => url),
  ];
  const figure = ({ name, url }, at) =>
    html`<figure><img src=${url} alt=${name}><figcaption><b>${say.figure({ n: at + 1 })}</b> ${name}</figcaption></figure>`;
  const made = { plan: record.plan, revision: record.plan_revision.slice(0, 12), room: record.room, time: time(record.made_ms) };
  return html`<article class="sheet"><div class="sheet-body">${head(record)}${parts(record)}
      ${figures.length ? html`<h2>${say.pictures}</h2>${figures.map(figure)}` : nothing}</div>
    <footer class="sheet-foot"><div>${say.foot(made)}<br><b>${say.research}</b></div></footer></article>`;
}

const row = (name, value) => html`<tr><th scope="row">${name}</th><td>${value}</td></tr>`;

function head(record) {
  const { audit } = record;
  const code = (text) => html`<code>${text}</code>`;
  return html`<h1>${say.title}</h1><table class="facts"><tbody>
    ${row(say.plan, code(record.plan))}
    ${row(say.planRevision, html`${code(record.plan_revision)}<br>${say.hashOver({ n: record.n_files })}`)}
    ${row(say.room, say.roomIs({ room: html`${record.room_name ? html`<b>${record.room_name}</b>, ` : nothing}${code(record.room)}`, time: time(record.created_ms), revision: record.revision }))}
    ${record.meeting ? row(say.meeting, say.meetingIs({ ...record.meeting, meeting: code(record.meeting.id) })) : nothing}
    ${row(say.audit, say.auditIs({ row: audit.rows, head: code(audit.head) }))}
    ${row(say.program, say.programIs({ server: record.server, version: record.version }))}</tbody></table>`;
}

/** Items of the record as the page's rows have them. */
const asRows = (list, kind) => list.map((item) => ({ ...item, kind, body: item }));

function parts(record) {
  const rows = [...asRows(record.checklist, 'check'), ...asRows(record.decisions, 'decision'), ...asRows(record.signatures, 'signature')];
  const revisions = [...new Set([placeOf(record), ...rows.map(({ body }) => placeOf(body)).reverse()])];
  const title = (revision) => html`<h2>${say.earlierRevision({ revision: html`<code>${revision.slice(0, 12)}</code>` })}</h2>
    <p class="values">${isOfFiles(revision, placeOf(record)) ? say.writtenBeforeStated : say.writtenBefore}</p>`;
  return html`${revisions.map((revision, at) => html`${at ? title(revision) : nothing}${under(rows, revision, at > 0)}`)}
    ${accepted(record)}${present(record)}${notes(record)}`;
}

function under(rows, revision, isEarlier) {
  const checks = entriesOf(rows, revision).filter((entry) => entry.row || !isEarlier);
  const [decided, signed] = [linesOf(rows, 'decision', revision), linesOf(rows, 'signature', revision)];
  const by = ({ row: { changed_name: name, changed_ms: ms } }) => say.byAt({ name, time: time(ms) });
  const corrected = (text, { isCorrected }) => (isCorrected ? say.correctedBelow({ text }) : text);
  return html`<h2>${say.decision}</h2>${
    decided.length
      ? table(
          [say.decision, say.inWords, say.byAtUtc],
          [20, 50, 30],
          decided.map((line) => [corrected(wordOf(decisions, line.row.body.decision), line), line.row.body.text, by(line)]),
        )
      : html`<p class="values">${say.none}</p>`
  }
    <h2>${say.checklist}</h2>${table(
      [say.entry, say.state, say.whatIsWrong, say.byAtUtc],
      [32, 9, 34, 25],
      checks.map((entry) => [
        entry.text,
        wordOf(states, entry.row?.body.state ?? 'open'),
        entry.row?.body.comment ?? '',
        entry.row ? by(entry) : '',
      ]),
    )}
    <h2>${say.signatures}</h2>${
      signed.length
        ? table(
            [say.name, say.meaning, say.role, say.byAtUtc],
            [38, 16, 16, 30],
            signed.map((line) => [
              corrected(signerOf(line.row), line),
              wordOf(meanings, line.row.body.meaning),
              wordOf(roles, line.row.body.role),
              by(line),
            ]),
          )
        : html`<p class="values">${say.none}</p>`
    }<p class="values">${say.legal}</p>`;
}

/** A name that somebody typed stands in quotation marks. */
const signerOf = ({ body, author_user: user }) => (user ? say.signedAs({ name: body.name, user }) : say.notSignedIn({ name: body.name }));

/** @param {number[]} widths of the columns, in per cent: by their contents a long text would leave a few letters for a name */
const table = (names, widths, rows) =>
  html`<table class="record-table"><colgroup>${widths.map((width) => html`<col width=${`${width}%`}>`)}</colgroup>
    <thead><tr>${names.map((name) => html`<th scope="col">${name}</th>`)}</tr></thead>
    <tbody>${rows.map(([first, ...rest]) => html`<tr><th scope="row">${first}</th>${rest.map((value) => html`<td>${value}</td>`)}</tr>`)}</tbody></table>`;

function accepted({ acceptances: rows = [] }) {
  if (!rows.length) return nothing;
  const reasons = {
    'registered-elsewhere': say.registeredElsewhere,
    'same-session': say.sameSession,
    'compared-on-anatomy': say.comparedOnAnatomy,
    other: say.other,
  };
  return html`<h2>${say.partsUsed}</h2>${table(
    [say.parts, say.fact, say.inWords, say.byAtUtc],
    [18, 34, 28, 20],
    rows.map((row) => [
      (row.counts ? say.partWith : say.partWithVoid)({ part: row.thing, other: row.with }),
      row.fact,
      (reasons[row.reason] ?? say.reasonWords)(row),
      say.byAt({ name: row.author_name, time: time(row.created_ms) }),
    ]),
  )}`;
}

const present = ({ present: stays, n_present_dropped: nDropped }) => html`<h2>${say.present}</h2>${table(
  [say.name, say.role, say.from, say.to],
  [40, 16, 22, 22],
  stays.map(({ name, role, entered_ms: from, left_ms: to, here }) => [
    name,
    wordOf(roles, role),
    time(from),
    to ? time(to) : here ? say.stillThere : say.untilEnded,
  ]),
)}
  ${nDropped ? html`<p class="values">${say.notKept({ n: nDropped })}</p>` : nothing}`;

function notes({ notes: list }) {
  if (!list.length) return nothing;
  const place = ({ anchor, parent }) =>
    parent
      ? say.reply
      : [anchor?.region, anchor?.point_mm && `(${anchor.point_mm.map((mm) => number(mm, 1)).join(', ')})`].filter(Boolean).join(' ') ||
        say.wholePlan;
  return html`<h2>${say.notes}</h2>${table(
    [say.note, say.placeLps, say.byAtUtc, say.resolved],
    [42, 20, 26, 12],
    list.map((note) => [
      note.text,
      place(note),
      say.byAt({ name: note.author_name, time: time(note.created_ms) }),
      note.parent ? '' : note.resolved ? say.yes : say.no,
    ]),
  )}`;
}
