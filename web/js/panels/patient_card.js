// The card of the patient: shows the full identity to this person alone, for a while. It is kept in this module and nowhere else.
import { html, nothing } from '../../lib/lit-html.js';
import { signal } from '../../lib/signals-core.js';
import { shownPatient } from '../state/identity.js';
import { icon } from './icons.js';

const shownMs = 15 * 60 * 1000;
const hiddenMs = 5 * 60 * 1000;

/** {room: whose page, masked, name, id, birth}; null: masked. */
const identity = signal(null);
const state = signal({ error: '', isAsked: false });
let timer = null;
let hiddenTimer = null;

/** The patient's name as people write it: "Virtanen^Aino" is VIRTANEN, Aino. */
export function nameWords(name) {
  const [group] = name.split('=');
  const [family, given, middle] = group.split('^');
  return [family?.toUpperCase(), [given, middle].filter(Boolean).join(' ')].filter(Boolean).join(', ');
}

function hide() {
  clearTimeout(timer);
  clearTimeout(hiddenTimer);
  identity.value = null;
}

/** A page that nobody has looked at for five minutes may be looked at by somebody else. */
document.addEventListener('visibilitychange', () => {
  clearTimeout(hiddenTimer);
  if (document.hidden && identity.peek()) hiddenTimer = setTimeout(hide, hiddenMs);
});
addEventListener('hashchange', hide);

/** What this person may read at this moment; null: nothing, the identity is masked. */
export function shownIdentity({ room }) {
  const patient = shownPatient(room.plan.value, room.scene.value);
  const known = identity.value;
  return known && known.room === room && known.masked === patient?.masked ? known : null;
}

async function show({ room, api }) {
  state.value = { error: '', isAsked: true };
  try {
    const { patients } = await api.call('GET', `plans/${encodeURIComponent(room.planId.peek())}/identity`);
    const masked = shownPatient(room.plan.peek(), room.scene.peek())?.masked;
    const found = patients.find((patient) => patient.masked === masked) ?? patients[0];
    identity.value = found ? { room, masked, name: nameWords(found.name ?? ''), id: found.id ?? '', birth: found.birth_date ?? '' } : null;
    clearTimeout(timer);
    timer = setTimeout(hide, shownMs);
    state.value = { error: found ? '' : 'The files name nobody.', isAsked: false };
  } catch (problem) {
    state.value = { error: problem.message, isAsked: false };
  }
}

export function patientCard(world) {
  const known = shownIdentity(world);
  const { error, isAsked } = state.value;
  return html`<div class="popover patient-card"><h3>Patient</h3>
    ${known ? html`<p><b>${known.name}</b></p><dl><dt>Id</dt><dd>${known.id || 'not given'}</dd><dt>Born</dt><dd>${known.birth || 'not given'}</dd></dl><div class="buttons"><button @click=${hide}>${icon('eyeOff')}<span>Mask it again</span></button></div>`
    : html`<p class="note">Masked, as for everybody.</p><div class="buttons"><button class="primary" ?disabled=${isAsked} @click=${() => show(world)}>${icon('eye')}<span>Show to me</span></button></div>`}
    ${error ? html`<p class="note err" role="alert">${error}</p>` : nothing}
    <p class="note">To you alone, until you leave the room, at most 15 min. The audit keeps who, when and from where.</p></div>`;
}
