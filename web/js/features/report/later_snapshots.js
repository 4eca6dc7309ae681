// Snapshots, loaded when the menu of the camera button opens or a picture comes back: what the menu does, pictures shown again, those of another plan.
import { html, nothing } from '../../../lib/lit-html.js';
import { shownPatient } from '../../room/identity.js';
import { icon } from '../../parts/icons.js';
import { styled } from '../../parts/lazy.js';
import { say } from './later_words.js';
import { pendingKey } from './snapshots.js';
import { menuKeys } from '../../parts/roving.js';

const leastWidthPx = 1200; // enough for a column of a printed page
const mostPx = 4096;

/** How pictures are read and shown again: no part of what a first visit loads. */
const records = () => import('./snapshot_record.js');

/** The view as it is on the screen, as large as a report needs it; nothing of the page stands at its foot. */
function viewDocument(view) {
  const [width, height] = view.document.value.size_px;
  const factor = Math.min(Math.max(1, leastWidthPx / width), mostPx / Math.max(width, height));
  return { ...view.document.value, size_px: [Math.round(width * factor), Math.round(height * factor)], foot_px: 0 };
}

async function save(world, isNamed) {
  const view = world.room.view(world.ui.active.value);
  const document = viewDocument(view);
  try {
    await (await import('../../room/exports.js')).savePicture(world, view, document, isNamed);
  } catch {
    world.ui.notify('err', say.noAnswer, 'snapshot');
  }
}

async function add({ room, ui, printout }) {
  const view = room.view(ui.active.value);
  try {
    await printout.add(room, viewDocument(view));
    const n = printout.entries.value.length;
    ui.notify('ok', say.inReport({ n }), 'snapshot');
  } catch (error) {
    ui.notify('err', say.noSnapshot({ why: error.message }), 'snapshot');
  }
}

/** The dialog is loaded when it is first opened. */
async function openPrintout({ ui, printoutDialog }) {
  try {
    [{ printoutDialog: printoutDialog.value }] = await Promise.all([import('./printout.js'), styled('js/features/report/printout.css')]);
    ui.popover.value = 'printout';
  } catch {
    ui.notify('err', say.notLoaded, 'snapshot');
  }
}

/** Likewise. */
async function openFilm({ ui, filmDialog }, recording) {
  try {
    const [film] = await Promise.all([import('./film.js'), styled('js/features/report/film.css')]);
    filmDialog.value = recording ? film.meetingDialog(recording) : film.filmDialog;
    ui.popover.value = 'film';
  } catch {
    ui.notify('err', say.filmNotLoaded, 'snapshot');
  }
}

/** Opens the dialog for a row of the list of recordings. */
export const openMeetingFilm = (world, recording) => openFilm(world, recording);

/** The menu while it is open. */
export function menu(world) {
  const { room, ui, printout } = world;
  const hasPicture = Boolean(room.view(ui.active.value).painted.value);
  const n = printout.entries.value.length;
  const act = (run) => (event) => {
    const isNamed = event.currentTarget.closest('.snapshots').querySelector('input')?.checked ?? false; // off each time the menu opens
    event.currentTarget.closest('.anchor').querySelector('button').focus(); // the item goes
    ui.popover.value = '';
    run(world, isNamed);
  };
  return html`<div class="popover snapshots"><div class="menu" role="menu" aria-label=${say.snapshot} @keydown=${menuKeys}>
      <button role="menuitem" ?disabled=${!hasPicture} @click=${act(save)}>${icon('image')}<span>${say.save}</span></button>
      <button role="menuitem" ?disabled=${!hasPicture} @click=${act(add)}>${icon('camera')}<span>${say.add}</span></button>
      <button role="menuitem" @click=${act((opened) => openFilm(opened))}>${icon('reset')}<span>${say.filmOf}</span></button>
      <button role="menuitem" @click=${act(openPrintout)}>${icon('print')}<span>${say.report}</span><span class="tag">${n}</span></button></div>
      ${room.seesIdentity.value && shownPatient(room.plan.value, room.scene.value) ? html`<label class="snapshot-named"><input type="checkbox"> ${say.withIdentity}</label>` : nothing}
      <p class="note">${say.about}</p></div>`;
}

// ---- pictures that come back ------------------------------------------------------------------------------------------

export async function show(world, record) {
  const { room, ui, otherPlan } = world;
  const { restore, toldOfMerge } = await records();
  if (record.plan.id !== room.planId.value) {
    otherPlan.value = record;
    ui.popover.value = 'other-plan';
  } else if (!room.canChange.value) {
    ui.notify('warn', say.notYet, 'snapshot');
  } else {
    const but = toldOfMerge(restore(world, record));
    ui.notify(but ? 'warn' : 'ok', but ? say.asInPictureBut({ but }) : say.asInPicture, 'snapshot');
  }
}

/** Shows the first of the files that were dropped. */
export async function showFirst(world, [first]) {
  const record = first && (await (await records()).recordOfFile(first.file));
  if (record) await show(world, record);
  else world.ui.notify('warn', say.onlySnapshots, 'snapshot');
}

/** Makes a room on the plan of a picture and goes there, where the picture is shown. */
export async function openSnapshot(api, record, enter) {
  const { id } = await api.makeRoom(record.plan.id);
  sessionStorage.setItem(pendingKey(id), JSON.stringify(record));
  enter(id);
}

/** Opens a picture that was dropped on the start page. @returns {Promise<boolean>} false: it is no picture */
export async function openDroppedSnapshot(api, file, enter) {
  const record = await (await records()).recordOfFile(file);
  if (!record) return false;
  await openSnapshot(api, record, enter).catch((error) => {
    throw new Error(say.showsPlan({ plan: record.plan.name, why: error.message }));
  });
  return true;
}

/** Says that a picture belongs to another plan, and offers to open that. */
export function otherPlanDialog({ room, ui, api, enter, otherPlan }) {
  const record = otherPlan.value;
  if (ui.popover.value !== 'other-plan' || !record) return nothing;
  const close = () => {
    ui.popover.value = '';
  };
  const open = () => {
    close();
    openSnapshot(api, record, enter).catch((error) =>
      ui.notify('err', say.planWhy({ plan: record.plan.name, why: error.message }), 'snapshot'),
    );
  };
  const plans = { plan: record.plan.name, id: html`<code>${record.plan.id}</code>`, shown: room.plan.value?.name ?? room.planId.value };
  return html`<section class="card other-plan" role="dialog" tabindex="-1" aria-label=${say.pictureOfOther}>
    <p>${say.otherPlanIs({ ...plans, other: html`<b>${say.showsOther}</b>` })}</p>
    <div class="buttons"><button class="primary" @click=${open}>${say.open({ plan: record.plan.id })}</button>
      <button @click=${close}>${say.stay}</button></div></section>`;
}
