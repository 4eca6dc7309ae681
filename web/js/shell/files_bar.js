// The red bar of a plan whose files have changed on the disk since they were read, and its way out. Loaded when they have.
import { html } from '../../lib/lit-html.js';
import { icon } from '../parts/icons.js';
import { say } from './later_words.js';

const time = (ms) => new Date(ms).toLocaleTimeString([], { hour: '2-digit', minute: '2-digit' });

/** Closes and opens the plan: all its rooms are sent it as it is then. */
async function readAnew({ room, ui }) {
  const plan = `/api/v1/plans/${encodeURIComponent(room.planId.peek())}`;
  for (const act of ['close', 'open']) {
    const answer = await fetch(`${plan}/${act}`, { method: 'POST' }).catch(() => null);
    if (!answer?.ok) return void ui.notify('err', say.notReadAnew, 'files');
  }
}

export function filesBar(world) {
  const files = world.room.files.value;
  const changed = html`<b>${say.filesChanged({ time: time(files.changed_ms) })}</b>`;
  return html`<div class="fit-bar err" role="alert"><span class="err">${icon('error')}</span><p>${say.filesRead({ changed, time: time(files.read_ms) })}</p>
    <button @click=${() => void readAnew(world)}>${say.readAnew}</button></div>`;
}
