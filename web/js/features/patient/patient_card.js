// The card of the patient: shows the full identity to this person alone, for a while. It is kept in this module and nowhere else.
import { html, nothing } from '../../../lib/lit-html.js';
import { effect, signal } from '../../../lib/signals-core.js';
import { ofMember } from '../../net/api.js';
import { identityOf, shownPatient } from '../../room/identity.js';
import { statedBy } from '../../room/stated.js';
import { checkbox } from '../../parts/fields.js';
import { icon } from '../../parts/icons.js';
import { say } from './later_words.js';

const shownMinutes = 15;
const shownMs = shownMinutes * 60 * 1000;
const hiddenMs = 5 * 60 * 1000;

/** {room: whose page, patient: of its plan, name, id, birth}; null: masked. */
const identity = signal(null);
/** All patients of a folder that holds parts of several, side by side: {room, plan, patients}; null: masked. */
const compared = signal(null);
const state = signal({ error: '', isAsked: false });
let timer = null;
let hiddenTimer = null;
let unwatch = () => {};

/** The patient's name as people write it: "Virtanen^Aino" is VIRTANEN, Aino. */
export function nameWords(name) {
  const [group] = name.split('=');
  const [family, given, middle] = group.split('^');
  return [family?.toUpperCase(), [given, middle].filter(Boolean).join(' ')].filter(Boolean).join(', ');
}

function hide() {
  clearTimeout(timer);
  clearTimeout(hiddenTimer);
  unwatch();
  identity.value = null;
  compared.value = null;
}

/** A page that nobody has looked at for five minutes may be looked at by somebody else. */
document.addEventListener('visibilitychange', () => {
  clearTimeout(hiddenTimer);
  if (document.hidden && (identity.peek() || compared.peek())) hiddenTimer = setTimeout(hide, hiddenMs);
});

/** At the end of the sign-in, and with the room, it is masked again. */
function watch(room) {
  unwatch = effect(() => {
    if (room.isLeft.value || room.link.value.state === 'paused') queueMicrotask(hide); // outside of the effect, which it stops
  });
}

/** The identity that this person may read at this moment; null: none, it is masked. */
export function shownIdentity({ room }) {
  const patient = shownPatient(room.plan.value, room.scene.value);
  const known = identity.value;
  return known && patient && known.room === room && known.patient === patient ? known : null;
}

/** The identities of the plan's patients, of which the audit has a row; null with state.error: not told. */
async function ask({ room, api }) {
  const asked = room.plan.peek();
  state.value = { error: '', isAsked: true };
  try {
    const path = `plans/${encodeURIComponent(room.planId.peek())}/identity?room=${room.id}`;
    const { patients } = await api.call('GET', path, { more: ofMember(room.identity) });
    const isSame = room.plan.peek() === asked && patients.length === asked.patients.length;
    state.value = { error: isSame ? '' : say.changed, isAsked: false };
    return isSame ? patients : null;
  } catch (problem) {
    state.value = { error: problem.message, isAsked: false };
    return null;
  }
}

/** Hides what was told after a while, at the latest. */
function keepAWhile(room) {
  timer = setTimeout(hide, shownMs);
  watch(room);
}

async function show(world) {
  const { room } = world;
  const patients = await ask(world);
  const [plan, scene] = [room.plan.peek(), room.scene.peek()];
  const found = patients && identityOf(plan, scene, patients);
  if (patients && !found) state.value = { error: say.changed, isAsked: false };
  hide();
  if (!found) return;
  const { name = '', id = '', birth_date: birth = '' } = found;
  identity.value = { room, patient: shownPatient(plan, scene), name: nameWords(name), id, birth };
  keepAWhile(room);
}

const begun = new WeakSet(); // rooms in which it was shown at once

/** Shows it once in a room, without being asked there: after a while it is masked again, and stays so. */
export function showAtOnce(world) {
  if (begun.has(world.room)) return;
  begun.add(world.room);
  queueMicrotask(() => void show(world)); // not while it is drawn
}

/** Where nobody signs in, the one person at the server may have it so. */
function atOnce({ room, storage, session }) {
  if (session.value || !storage) return nothing;
  const set = (isOn) => {
    begun.add(room);
    storage.setItem('identity.at-once', isOn ? 'yes' : 'no');
  };
  return checkbox(say.atOnce, storage.getItem('identity.at-once') === 'yes', false, set);
}

// ---- several patients ------------------------------------------------------------------------------------------------------

/** Shows the identities of all patients of the folder, or hides them again. */
export async function toggleComparison(world) {
  if (isCompared(world)) return void hide();
  const patients = await ask(world);
  hide();
  if (!patients) return;
  compared.value = { room: world.room, plan: world.room.plan.peek(), patients };
  keepAWhile(world.room);
}

/** The patients side by side, below the bar that tells of them; nothing while they are masked. */
export function comparison({ room }) {
  const { error } = state.value;
  const known = compared.value;
  if (error) return html`<p class="note err" role="alert">${error}</p>`;
  if (!known || known.room !== room || known.plan !== room.plan.value) return nothing;
  const shown = shownPatient(room.plan.value, room.scene.value);
  const columns = known.patients.map((patient, n) => ({ ...patient, isShown: room.plan.value.patients[n] === shown }));
  const rows = [
    [say.name, ({ name }) => nameWords(name)],
    [say.id, ({ id }) => id],
    [say.issuer, ({ issuer }) => issuer],
    [say.born, ({ birth_date: birth }) => birth],
    [say.sex, ({ sex }) => sex],
  ].filter(([, of]) => columns.some(of));
  const differs = (of) => new Set(columns.map(of)).size > 1;
  return html`<table class="identities"><thead><tr><td></td>${columns.map(({ isShown }) => html`<th scope="col">${isShown ? say.isShown : say.isNotUsed}</th>`)}</tr></thead>
    <tbody>${rows.map(
      ([word, of]) =>
        html`<tr class=${differs(of) ? 'differs' : ''}><th scope="row">${word}</th>${columns.map((one) => html`<td>${of(one) || say.notGiven}</td>`)}</tr>`,
    )}</tbody></table><p class="note">${say.alone({ n: shownMinutes })}</p>`;
}

export const isCompared = ({ room }) => compared.value?.room === room && compared.value.plan === room.plan.value;

// ---- on a wall ------------------------------------------------------------------------------------------------------------

const isOnWalls = signal(false); // that part of the card is open

/** Has the patient named on this wall, or masked again. */
async function nameOnWall({ room, api }, wall, shown) {
  try {
    await api.call('POST', `rooms/${room.id}/members/${wall.id}/identity`, { body: { shown }, more: ofMember(room.identity) });
    state.value = { error: '', isAsked: false };
  } catch (problem) {
    state.value = { error: problem.message, isAsked: false };
  }
}

/** The walls of the room: each is asked about by itself, as a room may have one among colleagues and one in a hall. */
function walls(world) {
  const list = world.room.members.value.filter(({ role, connected }) => role === 'wall' && connected !== false);
  if (!list.length) return html`<p class="note">${say.noWall}</p>`;
  return html`<ul class="patient-walls" aria-label=${say.walls}>${list.map(
    (
      wall,
    ) => html`<li><span>${wall.name}</span><button class=${wall.is_naming ? '' : 'bad'} @click=${() => nameOnWall(world, wall, !wall.is_naming)}>
      ${icon(wall.is_naming ? 'eyeOff' : 'eye')}<span>${wall.is_naming ? say.maskOnWall : say.nameOnWall}</span></button></li>`,
  )}</ul><p class="note warn">${say.everybodyReads}</p>`;
}

export function patientCard(world) {
  const known = shownIdentity(world);
  const { error, isAsked } = state.value;
  const stated = statedBy(world.room.plan.value);
  return html`<div class="popover patient-card"><h3>${say.patient}</h3>
    ${stated ? html`<p class="note patient-stated">${icon('pencil', 12)} ${stated}</p>` : nothing}
    ${
      known
        ? html`<p><b>${known.name}</b></p>
          <dl><dt>${say.id}</dt><dd>${known.id || say.notGiven}</dd><dt>${say.born}</dt><dd>${known.birth || say.notGiven}</dd></dl>
          <div class="buttons"><button @click=${hide}>${icon('eyeOff')}<span>${say.mask}</span></button>${onWall()}</div>`
        : html`<p class="note">${say.masked}</p><div class="buttons">
          <button class="primary" ?disabled=${isAsked} @click=${() => show(world)}>${icon('eye')}<span>${say.show}</span></button>${onWall()}</div>`
    }
    ${isOnWalls.value ? walls(world) : nothing}
    ${atOnce(world)}
    ${error ? html`<p class="note err" role="alert">${error}</p>` : nothing}
    <p class="note">${say.alone({ n: shownMinutes })}</p></div>`;

  function onWall() {
    return html`<button aria-expanded=${isOnWalls.value} @click=${() => {
      isOnWalls.value = !isOnWalls.value;
    }}>${say.onWall}</button>`;
  }
}
