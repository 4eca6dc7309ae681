// The inspector's Selection of a saved view, and of one to be saved.
import { html, nothing } from '../../../lib/lit-html.js';
import { canEdit, canSave, bookmarksOf, freeName, linkOf, maxName, move, remove, rename, save, update } from './bookmarks.js';
import { attempt, bookmarksIn, pictureOf, play, show } from './bookmark_rows.js';
import { typed } from '../../parts/fields.js';
import { icon } from '../../parts/icons.js';

export function bookmarkBlock(world, isDisabled) {
  const { room, ui } = world;
  const { id } = ui.selection.value;
  const row = bookmarksOf(room).find((other) => other.id === id);
  if (row) return html`${savedBlock(world, row, isDisabled)}${reportBlock(world, id)}`;
  return html`${id ? nothing : newBlock(world)}${reportBlock(world, id)}${id ? html`<section class="block"><p class="note">This saved view was deleted.</p></section>` : nothing}`;
}

function newBlock(world) {
  const { room, ui } = world;
  const isOff = !canSave(room);
  const submit = async (event) => {
    event.preventDefault();
    const field = event.target.elements.name;
    const row = await attempt(world, () => save(world, field.value.trim()), 'View saved');
    if (!row) return;
    field.value = '';
    ui.choose('bookmark', row.id);
  };
  return html`<section class="block"><h3>${icon('bookmark')} Save this view</h3>
    <form class="bookmark-new" @submit=${submit}><input name="name" maxlength=${maxName} autocomplete="off" aria-label="Name of the view" placeholder=${freeName(bookmarksOf(room))} ?disabled=${isOff}><button class="primary" ?disabled=${isOff}>Save</button></form>
    <p class="note">${isOff && room.canChange.value ? 'Observers look only.' : room.following.isFollowing.value ? 'The scene with its cameras and panes, as the room shows it now.' : 'The scene with its cameras and panes, as you see it now.'} All in this room have it in their list.</p></section>`;
}

const when = (ms) => new Date(ms).toLocaleString([], { dateStyle: 'medium', timeStyle: 'short' });

function savedBlock(world, row, isDisabled) {
  const { room, ui } = world;
  const rows = bookmarksOf(room);
  const at = rows.indexOf(row);
  const isOff = isDisabled || !canEdit(room, row);
  const mine = 'Who saved it, and presenters, may change it';
  const isPresenting = room.following.isPresenting.value;
  const changeName = (event) => {
    const text = event.target.value.trim();
    if (text && text !== row.body.name) void attempt(world, () => rename(world, row, text), 'View renamed');
    else event.target.value = row.body.name;
  };
  const drop = async () => {
    if (await attempt(world, () => remove(world, row).then(() => true), `“${row.body.name}” deleted`)) ui.select('bookmark', '');
  };
  const act = (run, done) => () => void attempt(world, run, done);
  return html`<section class="block bookmark-block"><h3>${icon('bookmark')} <span>${row.body.name}</span> <span class="dim">${at + 1} of ${rows.length}</span></h3>
    ${pictureOf(world, row)}
    <div class="buttons"><button class="primary" ?disabled=${isDisabled} title=${isPresenting ? 'Everybody who follows sees it' : 'You leave the presenter and see it alone'} @click=${() => void show(world, row)}>${isPresenting ? 'Show to everybody' : 'Show to me'}</button>
      <button ?disabled=${isDisabled} title="Next and back with Page down and Page up" @click=${() => void play(world, row)}>Present from here</button></div>
    <dl><dt>Name</dt><dd><input class="clip-name" maxlength=${maxName} aria-label="Name of the saved view" .value=${typed(row.body.name)} ?disabled=${isOff} title=${isOff ? mine : nothing} @change=${changeName}></dd>
      <dt>Saved</dt><dd>${row.author_name}, ${when(row.created_ms)}</dd>${row.version > 1 ? html`<dt>Changed</dt><dd>${row.changed_name}, ${when(row.changed_ms)}</dd>` : nothing}</dl>
    <div class="buttons"><button ?disabled=${isOff} title=${isOff ? mine : 'Keeps name, place and link'} @click=${act(() => update(world, row), 'View updated')}>Update to what is shown</button>
      <button class="icon-button" aria-label="Earlier in the list" title="Earlier" ?disabled=${isOff || at === 0} @click=${act(() => move(world, row, -1))}>${icon('chevronDown')}</button>
      <button class="icon-button" aria-label="Later in the list" title="Later" ?disabled=${isOff || at === rows.length - 1} @click=${act(() => move(world, row, 1))}>${icon('chevronDown')}</button>
      <button class="icon-button" aria-label="Delete the saved view" title=${isOff ? mine : 'Delete; its link then opens nothing'} ?disabled=${isOff} @click=${drop}>${icon('trash')}</button></div>
    <div class="bookmark-link"><label for="bookmark-link">Link to it</label><span><input id="bookmark-link" readonly .value=${linkOf(row)} @focus=${({ target }) => target.select()}><button @click=${(event) => void copy(world, row, event)}>Copy</button></span>
      <p class="note">Opens a new room of its own with this view; nobody here is disturbed. Whoever has the link can see the plan.</p></div></section>`;
}

/** Without a secure connection a browser has no clipboard for pages: the link is selected then. */
async function copy({ ui }, row, event) {
  const field = event.target.closest('.bookmark-link').querySelector('input');
  try {
    await navigator.clipboard.writeText(linkOf(row));
    ui.notify('ok', 'Link copied', 'saved');
  } catch {
    field.focus();
    ui.notify('ok', 'The link is selected: copy it with Ctrl+C', 'saved');
  }
}

/** Report of the parts of the view shown last that could not be shown. */
function reportBlock(world, id) {
  const { lines, n, name, id: of } = bookmarksIn(world).report.value;
  if (!n || of !== id) return nothing;
  return html`<section class="block"><h3>${icon('warning')} Not shown of “${name}”</h3><ul class="bookmark-report">${lines.map(({ pointer, detail }) => html`<li>${detail} <code>${pointer}</code></li>`)}</ul>
    ${n > lines.length ? html`<p class="note">and ${n - lines.length} more</p>` : nothing}</section>`;
}
