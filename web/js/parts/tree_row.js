// One row of the tree: an ARIA tree item, its eye, its name. Its controls are no tab stops; keys reach them through the row (tree.js).
import { html, nothing } from '../../lib/lit-html.js';
import { classMap } from '../../lib/directives/class-map.js';
import { icon } from './icons.js';
import { variables } from './mount.js';
import { say } from './words.js';

const endLength = 7; // characters of a name that stay when it is cut: often they are the side

/** A name that loses its middle when there is no room for it, never its end. */
export function clipped(text) {
  const at = text.length > endLength + 1 ? text.length - endLength : text.length;
  return html`<span class="clip"><span>${text.slice(0, at)}</span><span>${text.slice(at)}</span></span>`;
}

export const name = (text) => html`<button class="name" tabindex="-1" title=${text}>${clipped(text)}</button>`;

export const eye = (
  isOn,
  label,
  title,
  isDisabled,
  toggle,
) => html`<button class="eye" tabindex="-1" aria-pressed=${isOn} aria-label=${label} title=${title} ?disabled=${isDisabled}
  @click=${(event) => {
    event.stopPropagation();
    toggle(event);
  }}>${icon(isOn ? 'eye' : 'eyeOff')}</button>`;

/**
 * @param {object} of kind and id of what it stands for; words: its name and what stands at its end, as they are on the screen; more: said by screen readers after
 *   them; title; depth; isOn: its eye is open, undefined without an eye; toggle: what Space does; step: what Shift with an arrow does, by 1 or -1; choose: done in
 *   addition when it is chosen
 */
export function treeRow({ ui }, { kind, id, words, more = [], title, depth = 0, isOn, toggle, step, choose }, content) {
  const { selection } = ui;
  const isChosen = selection.value.kind === kind && selection.value.id === id;
  const key = `${kind}:${id}`;
  const onChoose = (event) => {
    choose?.(event);
    ui.row.value = key;
    ui.choose(kind, id);
  };
  const label = [words.filter(Boolean).join(' '), ...more, ...(isOn === undefined ? [] : [isOn ? say.shown : say.hidden])].join(', ');
  // data-region and data-dose: to look rows up, for tests and for style
  return html`<li class=${classMap({ row: true, selected: isChosen, off: isOn === false, current: ui.row.value === key })} role="treeitem" id=${`row-${key}`} data-key=${key}
    data-region=${kind === 'region' ? id : nothing} data-dose=${kind === 'dose' ? id : nothing} aria-level=${depth + 2} aria-selected=${isChosen}
    aria-label=${label} title=${title} ${variables({ '--indent': String(depth) })}
    @click=${onChoose} @row-toggle=${(event) => toggle?.(event.detail)} @row-step=${(event) => step?.(event.detail.by, event.detail.event)}>${content}</li>`;
}
