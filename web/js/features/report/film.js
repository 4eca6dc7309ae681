// A film of a turn about the scene, or of a recorded meeting: a small form, the progress of its job, and the film to save. The server makes it while the
// page does other things.
import { html, nothing } from '../../../lib/lit-html.js';
import { signal } from '../../../lib/signals-core.js';
import { ofMember } from '../../net/api.js';
import { dayTime } from '../../parts/format.js';
import { checkbox, numberField, segment } from '../../parts/fields.js';
import { icon } from '../../parts/icons.js';
import { shownPatient } from '../../room/identity.js';
import { say } from './later_words.js';

const pollMs = 500;
const sizes = { 640: [640, 480], 1280: [1280, 720], 1920: [1920, 1080] };
const turns = { 360: say.filmWhole, 180: say.filmHalf, 90: say.filmQuarter };
const most = { seconds: 60 };
const first = { degrees: 360, isReversed: false, seconds: 12, fps: 24, width: 640, isNamed: false };
const firstOfMeeting = { isWhole: false, fps: 5, width: 1280, isNamed: false };
const pauseS = 2;
const states = new WeakMap(); // of each room, and of each of its recordings: {order, job, why, path, file}

const stateFor = (path, file, order) => ({ path, file, order: signal(order), job: signal(null), why: signal('') });

function statesOf(room) {
  if (!states.has(room)) states.set(room, new Map([['', stateFor('video', 'turn', first)]]));
  return states.get(room);
}

function stateOf(room, recording) {
  const all = statesOf(room);
  const id = recording?.id ?? '';
  if (!all.has(id)) all.set(id, stateFor(`recordings/${id}/video`, 'meeting', firstOfMeeting));
  return all.get(id);
}

/** The view that turns: the active pane where it is one into space, else the first such pane that is open. */
function turningView({ room, ui }) {
  const active = room.view(ui.active.value);
  const isOne = (view) => view.document.value.kind === '3d';
  return isOne(active) ? active : (room.views.find((view) => view.isOpen.value && isOne(view)) ?? room.views.find(isOne) ?? null);
}

const isOpen = (job) => ['queued', 'running'].includes(job.state);
const isGone = ({ status }) => status >= 400 && status < 500 && status !== 429;
const goneWords = (problem) => (problem.status === 404 ? say.filmGone : problem.message); // the server's are about a job, which people do not know

/** Asks for the job until it has ended, or another one is this state's. What was not answered is asked again. */
async function follow({ api, clock, ui }, state, id) {
  const isOurs = () => state.job.value?.id === id;
  while (isOurs() && isOpen(state.job.value)) {
    await new Promise((done) => clock.setTimeout(done, pollMs));
    let job = null;
    try {
      job = isOurs() ? await api.job(id) : null;
    } catch (problem) {
      if (!isOurs()) return;
      state.why.value = isGone(problem) ? goneWords(problem) : say.filmUnanswered;
      if (isGone(problem)) state.job.value = null;
    }
    if (!job || !isOurs()) continue;
    state.why.value = job.state === 'failed' ? say.filmFailed({ why: job.problem?.detail ?? '' }) : '';
    state.job.value = isOpen(job) || job.state === 'done' ? job : null;
    if (job.state === 'done' && ui.popover.value !== 'film') ui.notify('ok', say.filmMade, 'film');
  }
}

const isNameable = ({ room }) => room.seesIdentity.value && shownPatient(room.plan.value, room.scene.value);

function turnOf(world, { degrees, isReversed, seconds, fps, width }) {
  const document = turningView(world)?.document.value;
  return { view: { ...document, size_px: sizes[width] }, degrees: isReversed ? -degrees : degrees, seconds, fps };
}

const meetingOf = (_world, { isWhole, fps, width }) => ({ pauses_s: isWhole ? 0 : pauseS, fps, size_px: sizes[width] });

async function make(world, state, bodyOf) {
  const { room, api } = world;
  const { isNamed } = state.order.value;
  const body = { ...bodyOf(world, state.order.value), identity: Boolean(isNamed && isNameable(world)) };
  const ordered = { state: 'queued', percent: 0 }; // until the server has given it an id
  const isOurs = () => state.job.value === ordered;
  state.why.value = '';
  state.order.value = { ...state.order.value, isNamed: false }; // asked anew for each film
  state.job.value = ordered;
  try {
    const job = await api.call('POST', `rooms/${room.id}/${state.path}`, { more: ofMember(room.identity), body });
    if (!isOurs()) return void (await api.cancelJob(job.id)); // cancelled meanwhile
    state.job.value = job;
    await follow(world, state, job.id);
  } catch (problem) {
    if (!isOurs()) return;
    state.job.value = null;
    state.why.value = say.filmFailed({ why: problem.message });
  }
}

async function cancel({ api }, state) {
  const job = state.job.value;
  try {
    if (job?.id) await api.cancelJob(job.id);
  } catch (problem) {
    if (!isGone(problem)) {
      state.why.value = say.filmNotCancelled;
      return;
    }
  }
  if (state.job.value === job || (job.id && state.job.value?.id === job.id)) state.job.value = null;
}

/** The file is named as the server names it: by the time of the order, in UTC. */
const fileName = (job, what) => `${job.plan}-${what}-${new Date(job.created_ms).toISOString().replace(/[-:]|\.\d+/g, '')}.webm`;

async function save({ api, room }, state) {
  const job = state.job.value;
  state.why.value = '';
  try {
    const [{ saveBlob }, film] = await Promise.all([
      import('../../room/exports.js'),
      api.call('GET', `jobs/${job.id}/video`, { isPicture: true, more: ofMember(room.identity) }),
    ]);
    saveBlob(fileName(job, state.file), film);
  } catch (problem) {
    state.why.value = goneWords(problem);
  }
}

/** A button goes when the next part is drawn: its focus goes to the dialog. */
const kept = (run) => (event) => {
  event.currentTarget.closest('[role="dialog"]').focus();
  run();
};

const sizesToChoose = Object.entries(sizes).map(([id, [w, h]]) => [id, `${w} × ${h}`]);
const rates = (all) => all.map((n) => [String(n), String(n)]);

/** Fields that both forms end with. */
function common(world, order, set, fps) {
  return html`<span class="lbl">${say.filmRate}</span>${segment(say.filmRate, rates(fps), String(order.fps), false, (id) => set({ fps: Number(id) }))}
      <span class="lbl">${say.filmSize}</span>${segment(say.filmSize, sizesToChoose, String(order.width), false, (id) => set({ width: Number(id) }))}
      ${isNameable(world) ? html`<span></span>${checkbox(say.withIdentity, order.isNamed, false, (isNamed) => set({ isNamed }))}` : nothing}`;
}

const makeButton = (isReady, run) =>
  html`<div class="buttons"><button class="primary" ?disabled=${!isReady} @click=${kept(run)}>${icon('reset')}<span>${say.filmMake}</span></button></div>`;

const setterOf = (state) => (change) => {
  state.order.value = { ...state.order.value, ...change };
};

function form(world, state) {
  const order = state.order.value;
  const set = setterOf(state);
  const hasView = Boolean(turningView(world));
  return html`<div class="film-fields">
      <span class="lbl">${say.filmTurn}</span>${segment(say.filmTurn, Object.entries(turns).reverse(), String(order.degrees), false, (id) => set({ degrees: Number(id) }))}
      <span></span>${checkbox(say.filmReversed, order.isReversed, false, (isReversed) => set({ isReversed }))}
      <span class="lbl">${say.filmLength}</span>${numberField(say.filmLength, order.seconds, 's', false, (seconds) => set({ seconds: Math.min(most.seconds, Math.max(1, seconds)) }))}
      ${common(world, order, set, [12, 24, 30])}</div>
    <p class="note">${hasView ? say.filmAbout({ n: Math.round(order.seconds * order.fps) }) : say.filmNoView}</p>
    ${makeButton(hasView, () => make(world, state, turnOf))}`;
}

function meetingForm(world, state) {
  const order = state.order.value;
  const set = setterOf(state);
  return html`<div class="film-fields">
      <span></span>${checkbox(say.filmShortened({ s: pauseS }), !order.isWhole, false, (isShort) => set({ isWhole: !isShort }))}
      ${common(world, order, set, [2, 5, 10])}</div>
    <p class="note">${say.filmOfMeetingAbout}</p>
    ${makeButton(true, () => make(world, state, meetingOf))}`;
}

function running(world, state) {
  const { percent, state: word } = state.job.value;
  const words = word === 'queued' ? say.filmWaits : say.filmMaking({ percent: Math.round(percent) });
  return html`<p role="status">${words}</p>
    <progress max="100" value=${percent} aria-label=${say.filmProgress}></progress>
    <p class="note">${say.filmGoesOn}</p>
    <div class="buttons"><button @click=${kept(() => cancel(world, state))}>${say.filmCancel}</button></div>`;
}

function done(world, state) {
  const another = () => {
    state.job.value = null;
    state.why.value = '';
  };
  return html`<p role="status">${say.filmMade}</p>
    <div class="buttons"><button class="primary" @click=${() => save(world, state)}>${icon('download')}<span>${say.filmSave}</span></button>
      <button @click=${kept(another)}>${say.filmAnother}</button></div>`;
}

function dialog(world, state, title, ordered) {
  const { ui } = world;
  if (ui.popover.value !== 'film') return nothing;
  const job = state.job.value;
  const close = () => {
    ui.popover.value = '';
  };
  return html`<section class="card other-plan film" role="dialog" tabindex="-1" aria-labelledby="film-head">
    <div class="film-head"><h2 id="film-head">${title}</h2><button class="icon-button" aria-label=${say.filmClose} @click=${close}>${icon('close')}</button></div>
    ${state.why.value ? html`<p class="warn" role="alert">${state.why.value}</p>` : nothing}
    ${job ? (job.state === 'done' ? done(world, state) : running(world, state)) : ordered(world, state)}</section>`;
}

export const filmDialog = (world) => dialog(world, stateOf(world.room), say.film, form);

/** @param {{id: string, started_ms: number}} recording a row of GET recordings */
export const meetingDialog = (recording) => (world) =>
  dialog(world, stateOf(world.room, recording), say.filmOfMeeting({ time: dayTime(recording.started_ms) }), meetingForm);
