// The presets in a menu and in the tree, where they are folded at first: no part of what a first visit loads.
import { html, nothing } from '../../../lib/lit-html.js';
import { classMap } from '../../../lib/directives/class-map.js';
import { signal } from '../../../lib/signals-core.js';
import { icon } from '../../parts/icons.js';
import { known, later } from '../../parts/lazy.js';
import { variables } from '../../parts/mount.js';
import { name } from '../../parts/tree_row.js';
import { say } from './words.js';

const presets = later(() => import('./preset_items.js'));
const isOpen = signal(false); // the rows of the tree

/** The presets in a menu, where the plan has a beam or a dose. @param {(run: () => void) => (event: Event) => void} act what a click does */
export function presetMenu(world, act) {
  const plan = world.room.plan.value;
  return plan?.beams.length || plan?.doses.length
    ? html`<p class="menu-head">${say.together}</p>${presets.draw(({ presetItems }) => presetItems(world, act))}`
    : nothing;
}

/** A row of the tree that does something. */
export function presetItem({ ui }, { id, words, title = words, isUnfolded = nothing, indent, isOff = false, act }, content) {
  const key = `preset:${id}`;
  const choose = (event) => {
    ui.row.value = key;
    if (!isOff) act(event);
  };
  return html`<li class=${classMap({ row: true, off: isOff, current: ui.row.value === key })} role="treeitem" id=${`row-${key}`} data-key=${key} aria-level=${indent + 2} aria-selected="false"
    aria-expanded=${isUnfolded} aria-disabled=${isOff} aria-label=${words} title=${title} ${variables({ '--indent': String(indent) })} @click=${choose} @row-toggle=${choose}>${content}</li>`;
}

/** The row that unfolds the presets, and they below it. */
export function presetRows(world) {
  const fold = () => {
    isOpen.value = !isOpen.value;
  };
  return html`${presetItem(world, { id: 'all', words: say.together, isUnfolded: isOpen.value, indent: 0, act: fold }, html`${icon(isOpen.value ? 'chevronDown' : 'chevronRight')}${name(say.together)}`)}${isOpen.value ? known(presets)?.presetRows(world) : nothing}`;
}
