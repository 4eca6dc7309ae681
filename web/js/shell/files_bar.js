// The red bar of a plan whose files have changed on the disk since they were read, and its way out.
import { html, nothing } from '../../lib/lit-html.js';
import { icon } from '../parts/icons.js';
import { styled } from '../parts/lazy.js';

const time = (ms) => new Date(ms).toLocaleTimeString([], { hour: '2-digit', minute: '2-digit' });

/** Closes and opens the plan: all its rooms are sent it as it is then. */
async function readAnew({ room, ui }) {
  const plan = `api/v1/plans/${encodeURIComponent(room.planId.peek())}`;
  for (const act of ['close', 'open']) {
    const answer = await fetch(`${plan}/${act}`, { method: 'POST' }).catch(() => null);
    if (!answer?.ok) return void ui.notify('err', 'The plan could not be read anew: the server refused or does not answer.', 'files');
  }
}

export function filesBar(world) {
  const files = world.room.files.value;
  if (!files) return nothing;
  void styled('js/features/fits/fit.css');
  return html`<div class="fit-bar err" role="alert"><span class="err">${icon('error')}</span><p><b>The plan’s files changed on the disk at ${time(files.changed_ms)}.</b> Shown is what was read at ${time(files.read_ms)}. Nothing is decided or signed until it is read anew.</p>
    <button @click=${() => void readAnew(world)}>Read anew</button></div>`;
}
