// Recording the meeting, the list of recordings, and how a replay is moved: part of the popover of the room chip.
import { html, nothing } from '../../../lib/lit-html.js';
import { effect, signal } from '../../../lib/signals-core.js';
import { roomPath } from '../../net/address.js';
import { dayTime, listed } from '../../parts/format.js';
import { say } from './later_words.js';

const rates = [1, 2, 4, 8];
const lists = new WeakMap(); // of each room: signal of the rows of GET recordings; null: not known yet

const two = (n) => String(n).padStart(2, '0');
/** @param {number} ms as h:mm:ss */
export const timeOf = (ms) => `${Math.floor(ms / 3600000)}:${two(Math.floor(ms / 60000) % 60)}:${two(Math.floor(ms / 1000) % 60)}`;

function listOf(room, api, ui) {
  if (lists.has(room)) return lists.get(room);
  const list = signal(null);
  lists.set(room, list);
  let newest = 0;
  list.ask = async () => {
    const number = ++newest;
    try {
      const answer = await api.call('GET', `rooms/${room.id}/recordings`);
      if (number === newest) list.value = answer.recordings;
    } catch (problem) {
      ui.notify('err', problem.message);
    }
  };
  effect(() => {
    void room.recording.running.value; // one has begun or ended
    void list.ask();
  });
  return list;
}

async function play(room, api, ui, id) {
  try {
    const made = await api.call('POST', 'rooms', { body: { recording: { room: room.id, id } } });
    window.open(roomPath(made.id), '_blank');
  } catch (problem) {
    ui.notify('err', problem.message);
  }
}

async function remove(room, api, ui, list, id) {
  try {
    await api.call('DELETE', `rooms/${room.id}/recordings/${id}`, {
      more: { 'Beamroom-Member': `${room.identity.member} ${room.identity.secret}` },
    });
  } catch (problem) {
    ui.notify('err', problem.message);
  }
  void list.ask();
}

async function film(world, recording) {
  try {
    const { openMeetingFilm } = await import('../report/later_snapshots.js');
    await openMeetingFilm(world, recording);
  } catch {
    world.ui.notify('err', say.filmNotLoaded);
  }
}

const row = (recording, { world, list }) => {
  const { room, api, ui } = world;
  const { id, state, started_ms, length_ms, by_name } = recording;
  const time = dayTime(started_ms);
  const facts = [timeOf(length_ms), say.by({ name: by_name }), state === 'cut' ? say.cut : state === 'full' ? say.full : ''];
  const drop = () => remove(room, api, ui, list, id);
  return html`<li><span></span><span class="roster-who"><span class="clipped">${time}</span>
    <span class="dim">${facts.filter(Boolean).join(' · ')}</span></span>
    <span class="roster-buttons">
    <button aria-label=${say.playOf({ time })} title=${say.playIs} @click=${() => play(room, api, ui, id)}>${say.play}</button>
    ${room.control.mayExport && room.control.may('scene') ? html`<button aria-label=${say.filmOf({ time })} title=${say.filmIs} @click=${() => film(world, recording)}>${say.film}</button>` : nothing}
    ${room.control.may('control') ? html`<button aria-label=${say.deleteOf({ time })} @click=${drop}>${say.delete}</button>` : nothing}</span></li>`;
};

const markWords = (kind, name) => (kind === 'note' ? say.noteBy({ name }) : name ? say.presents({ name }) : say.nobodyPresents);

/** In a room that plays a recording. */
function transport({ recording, control }) {
  const { started_ms, length_ms, marks, plan_changed, report } = recording.replay.value;
  const at = recording.at.value ?? { state: 'waiting', t_ms: 0, rate: 1 };
  const isPlaying = at.state === 'playing';
  const title = html`<h3 class="replay-title">${say.replayOf({ time: dayTime(started_ms) })}</h3>
    ${at.state === 'failed' ? html`<p class="warn" role="status">${say.failed}</p>` : nothing}
    ${plan_changed ? html`<p class="warn">${say.planChanged}</p>${report.map(({ detail }) => html`<p class="dim">${detail}</p>`)}` : nothing}`;
  const atOfAll = say.timeOfAll({ time: timeOf(at.t_ms), all: timeOf(length_ms) });
  if (!control.may('scene')) return html`${title}<p class="dim">${atOfAll}</p>`;
  const line = ([t_ms, kind, name]) =>
    html`<li><button @click=${() => recording.say('replay.seek', { t_ms })}>${timeOf(t_ms)}</button><span>${markWords(kind, name)}</span></li>`;
  return html`${title}<div class="replay-transport" role="group" aria-label=${say.replay}>
    <button @click=${() => (isPlaying ? recording.say('replay.pause') : recording.say('replay.play', { rate: at.rate }))}>${isPlaying ? say.pause : say.play}</button>
    <input type="range" min="0" max=${length_ms} step="1000" .value=${String(Math.round(at.t_ms))} list="replay-marks"
      aria-label=${say.timeOf} aria-valuetext=${atOfAll} @change=${(event) => recording.say('replay.seek', { t_ms: Number(event.target.value) })}>
    <datalist id="replay-marks">${marks.map(([t_ms, kind, name]) => html`<option value=${t_ms} label=${markWords(kind, name)}></option>`)}</datalist>
    <span>${timeOf(at.t_ms)} / ${timeOf(length_ms)}</span>
    <label>${say.rate} <select @change=${(event) => recording.say('replay.play', { rate: Number(event.target.value) })}>
      ${rates.map((rate) => html`<option value=${rate} ?selected=${rate === at.rate}>${rate}×</option>`)}</select></label>
    <button title=${say.leaveIs} @click=${() => recording.say('replay.leave')}>${say.leave}</button></div>
    ${marks.length ? html`<details><summary>${say.marks({ n: marks.length })}</summary><ul>${marks.map(line)}</ul></details>` : nothing}`;
}

const then = ({ presenting, connected }) => listed(presenting && say.presented, connected === false && say.wasAway) || say.wasThere;

/** People in the meeting at the time that is shown. */
const people = ({ recording: { members } }, avatar) =>
  members.value.length
    ? html`<h3 class="replay-title">${say.inMeeting}</h3>
  <ul aria-label=${say.inMeeting}>${members.value.map(
    (member) => html`<li data-was=${member.id} data-away=${member.connected === false}>${avatar(member)}
    <span class="roster-who"><span class="clipped" title=${member.name}>${member.name}</span><span class="dim">${[member.role, then(member)].filter(Boolean).join(' · ')}</span></span></li>`,
  )}</ul>`
    : nothing;

/** @param {object} world of the page @param {(member: object) => object} avatar of a member, as in the list above */
export function recordings(world, avatar) {
  const { room, ui, api } = world;
  const { recording, following } = room;
  if (recording.replay.value) return html`${transport(room)}${people(room, avatar)}`;
  if (!api) return nothing;
  const list = listOf(room, api, ui);
  const rows = (list.value ?? []).filter(({ state }) => state !== 'running');
  const isOurs = following.isPresenting.value;
  return html`<div class="room-actions">${
    recording.running.value
      ? isOurs || room.control.may('control')
        ? html`<button title=${say.endIs} @click=${() => recording.say('recording.stop')}>${say.end}</button>`
        : nothing
      : isOurs
        ? html`<button title=${say.recordIs} @click=${() => recording.say('recording.start')}>${say.record}</button>`
        : nothing
  }</div>
    ${rows.length ? html`<h3 class="dim">${say.recordings}</h3><ul aria-label=${say.recordings}>${rows.map((one) => row(one, { world, list }))}</ul>` : nothing}`;
}
