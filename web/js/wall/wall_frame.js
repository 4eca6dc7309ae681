// Header, bars and foot of a wall.
import { html, nothing } from '../../lib/lit-html.js';
import { chosenBeam, isDrafted } from '../features/beams/beams.js';
import { draftBelongs, draftWords } from '../features/beams/beam_words.js';
import { otherPatientsBar } from '../features/fits/fit_table.js';
import { fitBar } from '../features/fits/later.js';
import { nameWords } from '../features/patient/patient_card.js';
import { approvalOf, dateWords, identityOf, shownPatient, shownTreatmentPlan } from '../room/identity.js';
import { worst } from '../room/fidelity.js';
import { roomCalled } from '../room/room_called.js';
import { statedBy } from '../room/stated.js';
import { missingOf } from './missing.js';
import { initials } from '../parts/format.js';
import { icon } from '../parts/icons.js';
import { variables } from '../parts/mount.js';
import { viewOf } from './wall_layout.js';
import { say } from './words.js';

const time = (ms) => new Date(ms).toLocaleTimeString('en-GB');
const bar = (kind, words, more = nothing) =>
  html`<div class=${`wall-bar ${kind}`} role=${kind === 'err' ? 'alert' : 'status'}>${icon(kind === 'err' ? 'error' : 'warning', 20)}<p>${words}</p>${more}</div>`;

/** The patient; below it who has stated that, where the files do not. */
function whom(plan, name) {
  const words = statedBy(plan);
  return words ? html`<span class="wall-whom">${name}<span class="wall-stated">${words}</span></span>` : name;
}

function patient({ room, named }) {
  const [plan, scene] = [room.plan.value, room.scene.value];
  if (!plan) return nothing;
  if (plan.isPhantom) return html`<b class="wall-patient">${say.phantom}</b>`;
  const masked = shownPatient(plan, scene);
  const full = masked && named.value ? identityOf(plan, scene, named.value) : null;
  if (full)
    return html`${whom(plan, html`<b class="wall-patient named">${nameWords(full.name)}</b>`)}<span class="wall-id">${[full.id, dateWords(full.birth_date)].filter(Boolean).join(' · ')}</span>`;
  return masked
    ? whom(plan, html`<b class="wall-patient">${masked.masked}</b>`)
    : html`<span class="wall-unknown">${icon('note', 20)} ${say.unknown}</span>`;
}

function treatment({ room }) {
  const [plan, scene] = [room.plan.value, room.scene.value];
  const shown = plan && shownTreatmentPlan(plan, scene);
  const name = [shown?.label, plan?.name].filter(Boolean)[0] ?? room.planId.value;
  if (!shown) return html`<h1 class="wall-plan">${name || say.wall}</h1>`;
  const [word, kind, picture] = approvalOf(shown);
  return html`<h1 class="wall-plan">${name}</h1><span class=${`wall-approval ${kind}`}>${picture ? icon(picture, 16) : nothing}${word}</span>`;
}

/** Whether what is shown is what the room shows now: the worst of the panes, and of the link. */
export function liveness({ room, ui, panes }) {
  const { link } = room;
  if (link.value.state === 'open' && link.value.quietSince && ui.now.value - link.value.dueSince < 5000)
    return { state: 'link', text: say.link({ n: Math.floor((ui.now.value - link.value.quietSince) / 1000) }) };
  const badge = worst(panes().map((pane, index) => (room.views[index].isOpen.value ? pane.badge.value : null)));
  if (!badge) return { state: 'wait', text: say.noPicture };
  if (badge.state === 'disconnected' || badge.state === 'paused') return { state: 'disconnected', text: say.disconnected };
  return badge.state === 'stale' ? { state: 'stale', text: badge.text } : { state: 'live', text: say.live };
}

function pointing({ room }) {
  const { all, others } = room.pointers;
  const names = others.value.filter(({ id }) => all.value.has(id)).map(({ name }) => name);
  if (!names.length) return nothing;
  return html`<span class="wall-points">${(names.length > 1 ? say.point : say.points)({ names: names.slice(0, 3).join(', ') })}</span><i class="rule"></i>`;
}

/** @param {object} world of wall_page.js */
export function wallHeader(world) {
  const { room, ui } = world;
  void ui.now.value; // the clock
  const { presenter } = room.following;
  const who = presenter.value;
  const { state, text } = liveness(world);
  const avatar = who
    ? html`<span class="wall-avatar" aria-hidden="true" ${variables({ '--member': who.color })}>${initials(who.name)}</span>`
    : nothing;
  return html`${icon('logo', 24)}${patient(world)}${treatment(world)}<span class="grow"></span>${pointing(world)}
    ${room.recording.running.value ? html`<span class="wall-recorded">${say.recorded}</span><i class="rule"></i>` : nothing}
    ${avatar}<span class="wall-presenter">${who ? (who.connected === false ? say.away : say.presents)(who) : room.recording.replay.value ? say.replay : say.nobody}</span><i class="rule"></i>
    <span class="wall-live" data-state=${state} role="status"><i></i>${text}</span><time class="wall-clock">${time(Date.now())}</time>`;
}

function draft({ room }) {
  const [plan, scene] = [room.plan.value, room.scene.value];
  if (!isDrafted(plan, scene)) return nothing;
  const figures = chosenBeam(plan, scene) ? draftWords(plan, scene) : '';
  const key = (kind, word) => html`<span class=${`wall-key ${kind}`}><i></i>${word}</span>`;
  return bar(
    'draft',
    html`<b>${say.draft}</b> ${say.draftIs({ words: draftBelongs(plan, scene) })}`,
    html`<span class="wall-keys">${key('draft', say.ofDraft)}${chosenBeam(plan, scene) ? key('planned', say.ofPlanned) : nothing}${figures ? html`<span>· ${figures}</span>` : nothing}</span>`,
  );
}

function rejected({ room }) {
  const shown = shownTreatmentPlan(room.plan.value, room.scene.value);
  if ((shown?.approval ?? '').toUpperCase() !== 'REJECTED') return nothing;
  const [date, reviewer] = [dateWords(shown.review_date), shown.reviewer];
  return bar('warn', html`<b>${date && reviewer ? say.rejectedBy({ date, reviewer }) : say.rejected}</b>`);
}

/** The bars of the room's pages, with the sentences that they have there; nothing of them is pressed here. */
export function wallBars(world) {
  const { room, isOpenToEverybody } = world;
  const open = isOpenToEverybody.value ? html`<p class="wall-open" role="note">${say.open}</p>` : nothing;
  if (!room.plan.value || !room.scene.value) return open;
  const files = room.files.value;
  const missing = missingOf(world);
  return html`${open}${files ? bar('err', say.files({ time: time(files.changed_ms) })) : nothing}
    <div class="wall-fits">${otherPatientsBar(world)}${fitBar(world)}</div>${rejected(world)}${missing ? bar('warn', missing) : nothing}${draft(world)}`;
}

const layoutWords = { four: say.fourPanes, 'worked-in': say.onePane, presenter: say.asPresenter };

/** Whom the meeting goes on to, masked; a case that is not open to this wall is counted alone. */
function nextWords({ n_next, next_patient, next_plan }) {
  const who = next_patient === say.phantom ? [next_patient, next_plan].join(' ') : next_patient || next_plan;
  return who ? say.next({ who }) : say.nextCase({ n: n_next });
}

export function wallFoot(world) {
  const { room, meetingTold } = world;
  const meeting = meetingTold.value;
  const told = room.wall.value;
  const layout = layoutWords[told?.layout] ?? '';
  const view = room.view(viewOf(told?.active));
  const presenter = room.following.presenter.value;
  const works = view && presenter ? say.worksIn({ layout, name: presenter.name, view: view.name }) : layout;
  const where = [meeting?.n ? say.meeting(meeting) : roomCalled(world), meeting?.n ? room.name.value : ''].filter(Boolean);
  return html`${where.map((words) => html`<span class="wall-shrinks">${words}</span>`)}${meeting?.n_next ? html`<span class="wall-next">${nextWords(meeting)}</span>` : nothing}<span class="wall-shrinks">${works}</span><span class="grow"></span><span>${say.radiological}</span><b>${say.research}</b>`;
}
