// Recording the meeting, the list of recordings, and how a replay is moved: part of the popover of the room chip.
import { html, nothing } from '../../../lib/lit-html.js';
import { effect, signal } from '../../../lib/signals-core.js';
import { dayTime } from '../../parts/format.js';

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
    window.open(`#/rooms/${made.id}`, '_blank');
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

const row = ({ id, state, started_ms, length_ms, by_name }, { room, api, ui, list }) => {
  const name = `the recording of ${dayTime(started_ms)}`;
  return html`<li><span></span><span class="roster-who"><span class="clipped">${dayTime(started_ms)}</span>
    <span class="dim">${[timeOf(length_ms), `by ${by_name}`, state === 'cut' ? 'cut off' : state === 'full' ? 'ended full' : ''].filter(Boolean).join(' · ')}</span></span>
    <span class="roster-buttons"><button aria-label=${`Play ${name}`} title="In a room of its own, in a new tab" @click=${() => play(room, api, ui, id)}>Play</button>
    ${room.control.may('control') ? html`<button aria-label=${`Delete ${name}`} @click=${() => remove(room, api, ui, list, id)}>Delete</button>` : nothing}</span></li>`;
};

/** In a room that plays a recording. */
function transport({ recording, control }) {
  const { started_ms, length_ms, marks, plan_changed, report } = recording.replay.value;
  const at = recording.at.value ?? { state: 'waiting', t_ms: 0, rate: 1 };
  const isPlaying = at.state === 'playing';
  const title = html`<h3 class="replay-title">Replay of a meeting of ${dayTime(started_ms)}</h3>
    ${at.state === 'failed' ? html`<p class="warn" role="status">The recording cannot be read here. What is shown is not what the meeting saw at this time.</p>` : nothing}
    ${plan_changed ? html`<p class="warn">The plan has changed since the meeting: pictures and numbers may differ.</p>${report.map(({ detail }) => html`<p class="dim">${detail}</p>`)}` : nothing}`;
  if (!control.may('scene')) return html`${title}<p class="dim">${timeOf(at.t_ms)} of ${timeOf(length_ms)}</p>`;
  return html`${title}<div class="replay-transport" role="group" aria-label="Replay">
    <button @click=${() => (isPlaying ? recording.say('replay.pause') : recording.say('replay.play', { rate: at.rate }))}>${isPlaying ? 'Pause' : 'Play'}</button>
    <input type="range" min="0" max=${length_ms} step="1000" .value=${String(Math.round(at.t_ms))} list="replay-marks" aria-label="Time of the meeting" aria-valuetext=${`${timeOf(at.t_ms)} of ${timeOf(length_ms)}`} @change=${(event) => recording.say('replay.seek', { t_ms: Number(event.target.value) })}>
    <datalist id="replay-marks">${marks.map(([t_ms, kind, name]) => html`<option value=${t_ms} label=${kind === 'note' ? `Note by ${name}` : `${name || 'Nobody'} presents`}></option>`)}</datalist>
    <span>${timeOf(at.t_ms)} / ${timeOf(length_ms)}</span>
    <label>Rate <select @change=${(event) => recording.say('replay.play', { rate: Number(event.target.value) })}>${rates.map((rate) => html`<option value=${rate} ?selected=${rate === at.rate}>${rate}×</option>`)}</select></label>
    <button title="The room becomes an ordinary one, from what it shows now" @click=${() => recording.say('replay.leave')}>Leave the replay</button></div>
    ${marks.length ? html`<details><summary>${marks.length} marks</summary><ul>${marks.map(([t_ms, kind, name]) => html`<li><button @click=${() => recording.say('replay.seek', { t_ms })}>${timeOf(t_ms)}</button><span>${kind === 'note' ? `Note by ${name}` : `${name || 'Nobody'} presents`}</span></li>`)}</ul></details>` : nothing}`;
}

const then = ({ presenting, connected }) =>
  [presenting ? 'presented' : '', connected === false ? 'was away' : ''].filter(Boolean).join(', ') || 'was there';

/** People in the meeting at the time that is shown. */
const people = ({ recording: { members } }, avatar) =>
  members.value.length
    ? html`<h3 class="replay-title">In the meeting at this time</h3>
  <ul aria-label="In the meeting at this time">${members.value.map(
    (member) => html`<li data-was=${member.id} data-away=${member.connected === false}>${avatar(member)}
    <span class="roster-who"><span class="clipped" title=${member.name}>${member.name}</span><span class="dim">${[member.role, then(member)].filter(Boolean).join(' · ')}</span></span></li>`,
  )}</ul>`
    : nothing;

/** @param {object} world {room, ui, api} @param {(member: object) => object} avatar of a member, as in the list above */
export function recordings({ room, ui, api }, avatar) {
  const { recording, following } = room;
  if (recording.replay.value) return html`${transport(room)}${people(room, avatar)}`;
  if (!api) return nothing;
  const list = listOf(room, api, ui);
  const rows = (list.value ?? []).filter(({ state }) => state !== 'running');
  const isOurs = following.isPresenting.value;
  return html`<div class="room-actions">${
    recording.running.value
      ? isOurs || room.control.may('control')
        ? html`<button title="Everybody is told" @click=${() => recording.say('recording.stop')}>End recording</button>`
        : nothing
      : isOurs
        ? html`<button title="Scene, shared views, pointers and notes can be replayed later; everybody sees that it is recorded" @click=${() => recording.say('recording.start')}>Record meeting</button>`
        : nothing
  }</div>
    ${rows.length ? html`<h3 class="dim">Recordings</h3><ul aria-label="Recordings">${rows.map((one) => row(one, { room, api, ui, list }))}</ul>` : nothing}`;
}
