// The basis of all dose numbers, in the banner; and the bar that asks a person before a dose is drawn that may not belong to the image.
import { html, nothing } from '../../lib/lit-html.js';
import { acceptPatch, acceptedWords, basisParts, doseName, isAccepted, isOn, strangers } from '../state/dose.js';
import { icon } from './icons.js';

/** "Gy(w) per 250 kW-min · blood 15 ppm · weights: BPA example · isodose as brain" */
export function doseBasis({ room, ui }, place) {
  const [plan, scene] = [room.plan.value, room.scene.value];
  const basis = plan && scene && basisParts(plan, scene);
  if (!basis) return nothing;
  const rest = [basis.rest[0], ...basis.rest.slice(1).map((part) => part && ` · ${part}`)].join('');
  const mark = acceptedWords(plan, scene);
  return html`<div class=${`dose-basis ${place}`} title=${`${basis.unit}${rest}`}>${place === 'aside' ? html`<span class="dim">Dose basis</span>` : nothing}
    <span class="dose-basis-words">${mark ? html`<span class="warn">${icon('warning', 12)} ${mark} · </span>` : nothing}<b>${basis.unit}</b>${rest}</span></div>`;
}

/** Above the panes, while a dose is switched on that a person has yet to accept. */
export function doseBar({ room, ui }) {
  const [plan, scene] = [room.plan.value, room.scene.value];
  if (!plan || !scene || !isOn(scene)) return nothing;
  const waiting = strangers(plan, scene).filter((dose) => !isAccepted(scene, dose));
  if (!waiting.length) return nothing;
  const [dose] = waiting;
  const change = (patch, event) => room.patchScene(patch, { view: ui.active.value, at: event.timeStamp });
  const hide = (event) => change({ dose: { lines: { visible: false }, wash: { visible: false }, surfaces: { visible: false }, coverage: { visible: false }, compare: { mode: 'none' } } }, event);
  return html`<div class="dose-bar" role="alert"><span class="warn">${icon('warning')}</span><p><b>Dose ${doseName(dose)} is not drawn.</b> ${dose.fit_reason}</p>
    <button ?disabled=${!room.canChange.value} @click=${(event) => change(acceptPatch(waiting, true), event)}>Show it all the same</button>
    <button class="ghost" ?disabled=${!room.canChange.value} @click=${hide}>Leave it off</button></div>`;
}
