// Shown over the page: toasts, the list of keys.
import { html, nothing } from '../../lib/lit-html.js';
import { repeat } from '../../lib/directives/repeat.js';
import { effect } from '../../lib/signals-core.js';
import { keyMark } from '../parts/fields.js';
import { icon } from '../parts/icons.js';
import { later } from '../parts/lazy.js';
import { say } from './words.js';

const signs = { ok: 'check', warn: 'warning', err: 'error' };

export const toasts = ({ ui }) =>
  html`${repeat(
    ui.toasts.value,
    (toast) => toast.id,
    ({ id, kind, text, action }) => html`
  <div class="toast" role=${kind === 'err' ? 'alert' : 'status'}><span class=${kind}>${icon(signs[kind])}</span><span>${text}</span>
    ${
      action
        ? html`<button class="toast-act" @click=${() => {
            ui.dismiss(id);
            action.act();
          }}>${action.word}${keyMark(action.keys?.(ui.keys))}</button>`
        : nothing
    }
    <button class="icon-button small" aria-label=${say.dismiss} @click=${() => ui.dismiss(id)}>${icon('close', 12)}</button><i></i></div>`,
  )}`;

const list = later(() => import('./help.js'), 'js/shell/help.css', 'js/shell/look.css');

export const help = (world) =>
  world.ui.popover.value !== 'help'
    ? void list.loaded.peek()?.forget()
    : html`<section class="card help" role="dialog" tabindex="-1" aria-label=${say.keysAndMouse}>
  <div class="card-head"><h2>${say.keysAndMouse}</h2><span class="grow"></span><button class="icon-button" aria-label=${say.close} @click=${() => world.ui.toggle('help')}>${icon('close')}</button></div>
  ${list.draw((loaded) => loaded.keyList(world))}</section>`;

/** While the report to print is open, what it covers takes no focus. @returns {() => void} stops */
export const coverPage = (host, ui) =>
  effect(() => {
    const isOpen = ui.popover.value === 'printout';
    for (const part of host.querySelectorAll('.room > :not(.floating)')) part.inert = isOpen;
  });
