// The record as a page to print: on the sheets of the report to print (js/features/report/printout.css). The plan is named by its id: names may be a patient's.
import { html, nothing } from '../../../lib/lit-html.js';
import { signal } from '../../../lib/signals-core.js';
import { fetchRecord } from '../../net/record.js';
import { decisions, entriesOf, legal, linesOf, meanings, states, wordOf } from './checklist.js';
import { printable } from '../../room/exports.js';
import { number } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';

const research = 'Research use only. Not a medical device; not for diagnosis or treatment decisions.';
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
  return html`<section class="printout record-print" role="dialog" aria-modal="true" tabindex="-1" aria-label="Record to print">
    <div class="printout-bar"><b>Record to print</b><span class="grow"></span><button class="primary" @click=${printable(world, 'printed-record', `record of room ${shown.value.record.room}`)}>${icon('print')}<span>Print or save as PDF</span></button>
      <button class="icon-button" aria-label="Close" @click=${close}>${icon('close')}</button></div>${sheet(world, shown.value)}</section>`;
}

function sheet({ printout }, { record, pictures }) {
  const figures = [
    ...printout.entries.value.map(({ url, caption }) => ({ url, name: caption || 'Chosen snapshot' })),
    ...pictures.filter(({ url }) => url),
  ];
  return html`<article class="sheet"><div class="sheet-body">${head(record)}${parts(record)}
      ${figures.length ? html`<h2>Pictures</h2>${figures.map(({ name, url }, at) => html`<figure><img src=${url} alt=${name}><figcaption><b>Figure ${at + 1}.</b> ${name}</figcaption></figure>`)}` : nothing}</div>
    <footer class="sheet-foot"><div>Plan ${record.plan}, revision ${record.plan_revision.slice(0, 12)} · room ${record.room} · made ${time(record.made_ms)} UTC<br><b>${research}</b></div></footer></article>`;
}

const row = (name, value) => html`<tr><th scope="row">${name}</th><td>${value}</td></tr>`;

function head(record) {
  const { audit } = record;
  return html`<h1>Record of a plan review</h1><table class="facts"><tbody>
    ${row('Plan', html`<code>${record.plan}</code>`)}
    ${row('Plan revision', html`<code>${record.plan_revision}</code><br>SHA-256 over the names and contents of ${record.n_files} files`)}
    ${row('Room', html`<code>${record.room}</code>, made ${time(record.created_ms)} UTC; scene revision ${record.revision}`)}
    ${row('Audit', html`row ${audit.rows}, head <code>${audit.head}</code>`)}
    ${row('Program', `Beamroom ${record.server}; record version ${record.version}`)}</tbody></table>`;
}

/** Items of the record as the page's rows have them. */
const asRows = (list, kind) => list.map((item) => ({ ...item, kind, body: item }));

function parts(record) {
  const rows = [...asRows(record.checklist, 'check'), ...asRows(record.decisions, 'decision'), ...asRows(record.signatures, 'signature')];
  const revisions = [...new Set([record.plan_revision, ...rows.map(({ body }) => body.plan_revision).reverse()])];
  return html`${revisions.map((revision, at) => html`${at ? html`<h2>Earlier revision <code>${revision.slice(0, 12)}</code></h2><p class="values">Written before the plan’s files were changed.</p>` : nothing}${under(rows, revision, at > 0)}`)}
    ${accepted(record)}${present(record)}${notes(record)}`;
}

function under(rows, revision, isEarlier) {
  const checks = entriesOf(rows, revision).filter((entry) => entry.row || !isEarlier);
  const [decided, signed] = [linesOf(rows, 'decision', revision), linesOf(rows, 'signature', revision)];
  const by = ({ row: { changed_name: name, changed_ms: ms } }) => `${name}, ${time(ms)}`;
  return html`<h2>Decision</h2>${
    decided.length
      ? table(
          ['Decision', 'In words', 'By, at (UTC)'],
          [20, 50, 30],
          decided.map((line) => [
            html`${wordOf(decisions, line.row.body.decision)}${line.isCorrected ? ' (corrected below)' : ''}`,
            line.row.body.text,
            by(line),
          ]),
        )
      : html`<p class="values">None.</p>`
  }
    <h2>Checklist</h2>${table(
      ['Entry', 'State', 'What is wrong', 'By, at (UTC)'],
      [32, 9, 34, 25],
      checks.map((entry) => [
        entry.text,
        wordOf(states, entry.row?.body.state ?? 'open'),
        entry.row?.body.comment ?? '',
        entry.row ? by(entry) : '',
      ]),
    )}
    <h2>Signatures</h2>${
      signed.length
        ? table(
            ['Name', 'Meaning', 'Role', 'By, at (UTC)'],
            [38, 16, 16, 30],
            signed.map((line) => [
              html`${line.row.body.name}${line.isCorrected ? ' (corrected below)' : ''}`,
              wordOf(meanings, line.row.body.meaning),
              line.row.body.role,
              by(line),
            ]),
          )
        : html`<p class="values">None.</p>`
    }<p class="values">${legal}</p>`;
}

/** @param {number[]} widths of the columns, in per cent: by their contents a long text would leave a few letters for a name */
const table = (names, widths, rows) =>
  html`<table class="record-table"><colgroup>${widths.map((width) => html`<col width=${`${width}%`}>`)}</colgroup><thead><tr>${names.map((name) => html`<th scope="col">${name}</th>`)}</tr></thead><tbody>${rows.map(([first, ...rest]) => html`<tr><th scope="row">${first}</th>${rest.map((value) => html`<td>${value}</td>`)}</tr>`)}</tbody></table>`;

function accepted({ acceptances: rows = [] }) {
  if (!rows.length) return nothing;
  const reason = {
    'registered-elsewhere': 'registered elsewhere',
    'same-session': 'same session and couch',
    'compared-on-anatomy': 'compared on the anatomy',
    other: 'other',
  };
  return html`<h2>Parts used though they do not fit</h2>${table(
    ['Parts', 'Fact', 'In words', 'By, at (UTC)'],
    [18, 34, 28, 20],
    rows.map((row) => [
      `${row.thing} with ${row.with}${row.counts ? '' : ' (void: other files)'}`,
      row.fact,
      `${reason[row.reason] ?? row.reason}: ${row.words}`,
      `${row.author_name}, ${time(row.created_ms)}`,
    ]),
  )}`;
}

const present = ({ present: stays, n_present_dropped: nDropped }) => html`<h2>Present</h2>${table(
  ['Name', 'Role', 'From (UTC)', 'To'],
  [40, 16, 22, 22],
  stays.map(({ name, role, entered_ms: from, left_ms: to, here }) => [
    name,
    role,
    time(from),
    to ? time(to) : here ? 'still there' : 'until the server ended',
  ]),
)}
  ${nDropped ? html`<p class="values">${nDropped} earlier stays are not kept.</p>` : nothing}`;

function notes({ notes: list }) {
  if (!list.length) return nothing;
  const place = ({ anchor, parent }) =>
    parent
      ? 'reply'
      : [anchor?.region, anchor?.point_mm && `(${anchor.point_mm.map((mm) => number(mm, 1)).join(', ')})`].filter(Boolean).join(' ') ||
        'plan';
  return html`<h2>Notes</h2>${table(
    ['Note', 'Place, LPS mm', 'By, at (UTC)', 'Resolved'],
    [42, 20, 26, 12],
    list.map((note) => [
      note.text,
      place(note),
      `${note.author_name}, ${time(note.created_ms)}`,
      note.parent ? '' : note.resolved ? 'yes' : 'no',
    ]),
  )}`;
}
