// The inspector's Selection of a saved view, and of one to be saved.
import { html, nothing } from '../../../lib/lit-html.js';
import { canEdit, canSave, bookmarksOf, freeName, linkOf, maxName, move, remove, rename, save, update } from './bookmarks.js';
import { attempt, bookmarksIn, pictureOf, play, show } from './bookmark_rows.js';
import { typed } from '../../parts/fields.js';
import { icon } from '../../parts/icons.js';
import { say } from './later_words.js';

export function bookmarkBlock(world, isDisabled) {
  const { room, ui } = world;
  const { id } = ui.selection.value;
  const row = bookmarksOf(room).find((other) => other.id === id);
  if (row) return html`${savedBlock(world, row, isDisabled)}${reportBlock(world, id)}`;
  const gone = html`<section class="block"><p class="note">${say.wasDeleted}</p></section>`;
  return html`${id ? nothing : newBlock(world)}${reportBlock(world, id)}${id ? gone : nothing}`;
}

function newBlock(world) {
  const { room, ui } = world;
  const isOff = !canSave(room);
  const submit = async (event) => {
    event.preventDefault();
    const field = event.target.elements.name;
    const row = await attempt(world, () => save(world, field.value.trim()), say.saved);
    if (!row) return;
    field.value = '';
    ui.choose('bookmark', row.id);
  };
  const about = isOff && room.canChange.value ? say.observers : room.following.isFollowing.value ? say.asRoom : say.asYou;
  return html`<section class="block"><h3>${icon('bookmark')} ${say.saveView}</h3>
    <form class="bookmark-new" @submit=${submit}>
      <input name="name" maxlength=${maxName} autocomplete="off" aria-label=${say.nameOfView} placeholder=${freeName(bookmarksOf(room))} ?disabled=${isOff}>
      <button class="primary" ?disabled=${isOff}>${say.save}</button></form>
    <p class="note">${about} ${say.allHave}</p></section>`;
}

const when = (ms) => new Date(ms).toLocaleString([], { dateStyle: 'medium', timeStyle: 'short' });

function savedBlock(world, row, isDisabled) {
  const { room, ui } = world;
  const rows = bookmarksOf(room);
  const at = rows.indexOf(row);
  const isOff = isDisabled || !canEdit(room, row);
  const isPresenting = room.following.isPresenting.value;
  const changeName = (event) => {
    const text = event.target.value.trim();
    if (text && text !== row.body.name) void attempt(world, () => rename(world, row, text), say.renamed);
    else event.target.value = row.body.name;
  };
  const drop = async () => {
    if (await attempt(world, () => remove(world, row).then(() => true), say.deleted({ name: row.body.name }))) ui.select('bookmark', '');
  };
  const act = (run, done) => () => void attempt(world, run, done);
  const changed = html`<dt>${say.changedAt}</dt><dd>${say.byAt({ name: row.changed_name, time: when(row.changed_ms) })}</dd>`;
  return html`<section class="block bookmark-block"><h3>${icon('bookmark')} <span>${row.body.name}</span> <span class="dim">${say.place({ n: at + 1, all: rows.length })}</span></h3>
    ${pictureOf(world, row)}
    <div class="buttons"><button class="primary" ?disabled=${isDisabled} title=${isPresenting ? say.showAllIs : say.showMeIs}
        @click=${() => void show(world, row)}>${isPresenting ? say.showAll : say.showMe}</button>
      <button ?disabled=${isDisabled} title=${say.presentIs} @click=${() => void play(world, row)}>${say.present}</button></div>
    <dl><dt>${say.name}</dt><dd><input class="clip-name" maxlength=${maxName} aria-label=${say.nameOf} .value=${typed(row.body.name)}
        ?disabled=${isOff} title=${isOff ? say.mine : nothing} @change=${changeName}></dd>
      <dt>${say.savedAt}</dt><dd>${say.byAt({ name: row.author_name, time: when(row.created_ms) })}</dd>${row.version > 1 ? changed : nothing}</dl>
    <div class="buttons">
      <button ?disabled=${isOff} title=${isOff ? say.mine : say.updateIs} @click=${act(() => update(world, row), say.updated)}>${say.update}</button>
      <button class="icon-button" aria-label=${say.earlierInList} title=${say.earlier} ?disabled=${isOff || at === 0}
        @click=${act(() => move(world, row, -1))}>${icon('chevronDown')}</button>
      <button class="icon-button" aria-label=${say.laterInList} title=${say.later} ?disabled=${isOff || at === rows.length - 1}
        @click=${act(() => move(world, row, 1))}>${icon('chevronDown')}</button>
      <button class="icon-button" aria-label=${say.delete} title=${isOff ? say.mine : say.deleteIs} ?disabled=${isOff}
        @click=${drop}>${icon('trash')}</button></div>
    <div class="bookmark-link"><label for="bookmark-link">${say.link}</label><span>
      <input id="bookmark-link" readonly .value=${linkOf(row)} @focus=${({ target }) => target.select()}>
      <button @click=${(event) => void copy(world, row, event)}>${say.copy}</button></span>
      <p class="note">${say.linkIs}</p></div></section>`;
}

/** Without a secure connection a browser has no clipboard for pages: the link is selected then. */
async function copy({ ui }, row, event) {
  const field = event.target.closest('.bookmark-link').querySelector('input');
  try {
    await navigator.clipboard.writeText(linkOf(row));
    ui.notify('ok', say.copied, 'saved');
  } catch {
    field.focus();
    ui.notify('ok', say.selected, 'saved');
  }
}

/** Report of the parts of the view shown last that could not be shown. */
function reportBlock(world, id) {
  const { lines, n, name, id: of } = bookmarksIn(world).report.value;
  if (!n || of !== id) return nothing;
  return html`<section class="block"><h3>${icon('warning')} ${say.notShownOf({ name })}</h3>
    <ul class="bookmark-report">${lines.map(({ pointer, detail }) => html`<li>${detail} <code>${pointer}</code></li>`)}</ul>
    ${n > lines.length ? html`<p class="note">${say.andMore({ n: n - lines.length })}</p>` : nothing}</section>`;
}
