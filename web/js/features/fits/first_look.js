// ‘Look first’ in the form of an acceptance: the active view as it would be with it, a picture for this person alone. The room changes by nothing; the audit
// has a row, as of every use of parts that do not fit.
import { html, nothing } from '../../../lib/lit-html.js';
import { signal } from '../../../lib/signals-core.js';
import { say } from './later_words.js';

const widthPx = 560; // twice that of the inspector
const restMs = 400; // nothing has changed for so long before another picture is asked for
const words = 'a look before it is accepted'; // as the audit has it

/** room and pair: where what is looked at, '' for nothing; key: what the picture shows; url: of the picture. */
const look = signal({ room: null, pair: '', key: '', url: '', error: '' });
let timer = 0;

function set(more) {
  const { url } = look.peek();
  if ('url' in more && url && more.url !== url) URL.revokeObjectURL(url);
  look.value = { ...look.peek(), ...more };
}

export function endLook() {
  clearTimeout(timer);
  if (look.peek().pair) set({ room: null, pair: '', key: '', url: '', error: '' });
}

function viewDocument(view) {
  const [width, height] = view.document.peek().size_px;
  return { ...view.document.peek(), size_px: [widthPx, Math.max(Math.round((widthPx * height) / width), 1)], foot_px: 0 };
}

async function draw({ room, ui, api }, use, key) {
  const acceptances = [{ thing: use.thing, with: use.with, reason: 'other', words }];
  const body = { scene: room.scene.peek(), view: viewDocument(room.view(ui.active.peek())), acceptances };
  try {
    const picture = await api.call('POST', `plans/${encodeURIComponent(room.planId.peek())}/render`, { body, isPicture: true });
    if (look.peek().key === key) set({ url: URL.createObjectURL(picture), error: '' });
  } catch (problem) {
    if (look.peek().key === key) set({ url: '', error: problem.message });
  }
}

/** Asks for the picture anew when what it shows has changed and then rests. */
function follow(world, use) {
  const { room, ui } = world;
  const key = [room.revision.value, ui.active.value, JSON.stringify(room.view(ui.active.value).document.value)].join(' ');
  if (look.peek().key === key) return;
  queueMicrotask(() => {
    if (!look.peek().pair || look.peek().key === key) return;
    set({ key });
    clearTimeout(timer);
    timer = setTimeout(() => void draw(world, use, key), restMs);
  });
}

/** @param {object} world @param {object} use the pair that the form is about @param {boolean} isDisabled */
export function lookFirst(world, use, isDisabled) {
  const pair = `${use.thing} ${use.with}`;
  const { room, pair: shown, url, error } = look.value;
  const isOn = room === world.room && shown === pair;
  if (isOn) follow(world, use);
  const toggle = ({ target }) => (target.checked ? set({ room: world.room, pair, key: '', url: '', error: '' }) : endLook());
  return html`<label class="fit-look"><input type="checkbox" .checked=${isOn} ?disabled=${isDisabled} @change=${toggle}> ${say.lookFirst}</label>
    ${isOn && url ? html`<figure class="fit-looked"><img src=${url} alt=${say.lookOf}><figcaption>${say.forYouAlone}</figcaption></figure>` : nothing}
    ${isOn && !url ? html`<p class=${error ? 'note err' : 'note'} role="status">${error || say.isDrawn}</p>` : nothing}`;
}
