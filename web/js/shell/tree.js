// The parts of the plan: a tree of sections at the left or, where there is no room for it, one section at a time beside a rail or in a sheet.
import { html, nothing } from '../../lib/lit-html.js';
import { classMap } from '../../lib/directives/class-map.js';
import { icon } from '../parts/icons.js';
import { roving } from '../parts/roving.js';
import { sectionOf, sectionsOf } from './sections.js';
import { treeKeys } from './tree_keys.js';
import { say } from './words.js';

const loading = html`<p class="empty">${say.loading}</p>`;

export function tree(world) {
  const { ui } = world;
  const { tree: place, sheet } = ui.arrangement.value;
  if (sheet === 'tree') return inSheet(world);
  if (place === 'tree') return whole(world);
  return place === 'rail' ? rail(world) : nothing;
}

function whole(world) {
  const { room, ui } = world;
  const plan = room.plan.value;
  return html`<header class="panel-head"><h2>${say.plan}</h2><span class="grow"></span>
      <button class="icon-button" title=${say.fold} aria-label=${say.foldParts} @click=${() => {
        ui.isTreeOpen.value = false;
      }}>${icon('chevronLeft')}</button></header>
    ${
      plan
        ? html`${sectionsOf(plan, room.scene.value).map(({ tools }) => tools?.(world))}<div class="scroll">${list(
            world,
            say.partsOf,
            sectionsOf(plan, room.scene.value).map((section) => folding(world, section)),
            sectionsOf(plan, room.scene.value).filter(({ id }) => !ui.folded.value.has(id)),
            true,
          )}</div>`
        : loading
    }`;
}

/** True if one of the sections has the row that keys act on: with a rail another section may have been opened since. */
function hasRow({ ui }, sections, hasHeads) {
  const [kind] = ui.row.value.split(':');
  return kind === 'section' ? hasHeads : sections.some(({ id }) => sectionOf(kind) === id);
}

/** An element that takes the focus for all of its rows, those of the sections; the row that keys act on is its active descendant. */
const list = (
  world,
  label,
  rows,
  sections,
  hasHeads = false,
) => html`<ul class="rows" role="tree" aria-label=${label} tabindex="0" aria-activedescendant=${world.ui.row.value && hasRow(world, sections, hasHeads) ? `row-${world.ui.row.value}` : nothing}
  @keydown=${(event) => treeKeys(event, world.ui)} @focus=${(event) => begin(event, world.ui)}>${rows}</ul>`;

/** The row that keys act on when the tree gets the focus: the last one, else the first. */
function begin({ currentTarget }, ui) {
  if (!currentTarget.querySelector('.current')) ui.row.value = currentTarget.querySelector('[role="treeitem"]')?.dataset.key ?? '';
}

function folding(world, { id, name, note, rows }) {
  const { ui } = world;
  const isFolded = ui.folded.value.has(id);
  const key = `section:${id}`;
  const fold = () => {
    ui.row.value = key;
    ui.fold(id, !isFolded);
  };
  // rows follow their section instead of standing inside it: a screen reader would read them all as its name
  return html`<li class=${classMap({ section: true, 'section-head': true, 'not-this-patient': id === 'others', folded: isFolded, current: ui.row.value === key })} role="treeitem" aria-level="1" aria-expanded=${!isFolded} aria-selected="false"
      id=${`row-${key}`} data-key=${key} @click=${fold} @row-toggle=${fold}>${icon('chevronDown', 12)}<span>${name}</span><span class="grow"></span><span class="note">${note(world)}</span></li>
    ${isFolded ? nothing : rows(world)}`;
}

function rail(world) {
  const { room, ui } = world;
  const sections = sectionsOf(room.plan.value, room.scene.value);
  const open = sections.find(({ id }) => id === ui.section.value);
  const { size, overlay } = ui.arrangement.value;
  return html`<div class="rail" role="toolbar" aria-orientation="vertical" aria-label=${say.partsOf} @keydown=${roving}>
      ${
        size === 'wide'
          ? html`<button class="icon-button" tabindex="0" title=${say.showParts} aria-label=${say.showParts} @click=${() => {
              ui.isTreeOpen.value = true;
              ui.isDrawerRight.value = false;
            }}>${icon('tree')}</button>`
          : nothing
      }
      ${sections.map(
        (
          { id, name, icon: picture },
          at,
        ) => html`<button class=${classMap({ 'icon-button': true, on: id === open?.id })} tabindex=${at === 0 && size !== 'wide' ? 0 : -1} title=${name} aria-label=${name} aria-expanded=${id === open?.id}
        data-section=${id} @click=${() => ui.openSection(id)}>${icon(picture)}</button>`,
      )}</div>
    ${
      open
        ? html`<div class=${`section-pane ${overlay}`}><header class="panel-head"><h2>${open.name}</h2><span class="note">${open.note(world)}</span><span class="grow"></span>
        <button class=${classMap({ 'icon-button': true, on: ui.isPinned.value })} aria-pressed=${ui.isPinned.value} title=${say.keepBeside} aria-label=${say.pin} @click=${() => {
          ui.isPinned.value = !ui.isPinned.value;
        }}>${icon('pin')}</button>
        <button class="icon-button" title=${say.close} aria-label=${say.closeOf({ section: open.name })} @click=${() => {
          ui.section.value = '';
        }}>${icon('close')}</button></header>
      ${open.tools?.(world)}<div class="scroll">${list(world, open.name, open.rows(world), [open])}</div></div>`
        : nothing
    }`;
}

function inSheet(world) {
  const { room, ui } = world;
  const sections = sectionsOf(room.plan.value, room.scene.value);
  const shown = sections.find(({ id }) => id === ui.sheetSection.value) ?? sections[0];
  return html`<i class="grip"></i><div class="tabs"><div role="tablist" aria-label=${say.partsOf} @keydown=${roving}>${sections.map(
    ({ id, name }) => html`<button role="tab" id=${`part-${id}`} aria-selected=${id === shown.id}
      aria-controls=${id === shown.id ? 'part-panel' : nothing} tabindex=${id === shown.id ? 0 : -1} @click=${({ currentTarget }) => {
        ui.sheetSection.value = id;
        currentTarget.scrollIntoView({ block: 'nearest', inline: 'nearest' });
      }}>${name}</button>`,
  )}</div><span class="grow"></span>
      <button class="icon-button" aria-label=${say.closeSheet} @click=${() => {
        ui.sheet.value = '';
      }}>${icon('chevronDown')}</button></div>
    ${
      shown
        ? html`<div class="sheet-panel" role="tabpanel" id="part-panel" aria-labelledby=${`part-${shown.id}`}>${shown.tools?.(world)}
      <div class="scroll">${list(world, shown.name, shown.rows(world), [shown])}</div></div>`
        : loading
    }`;
}
