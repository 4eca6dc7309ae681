// Beams in the tree: the plan's, its draft, drafts that were kept, reference curves; and the button of the tool that moves them.
import { html, nothing } from '../../../lib/lit-html.js';
import { classMap } from '../../../lib/directives/class-map.js';
import { beamName, chosenBeam, keptName, lookOf, lookPatch } from './beams.js';
import { isDraftOn } from './beam_ui.js';
import { isOfOther } from '../../room/identity.js';
import { beamWords } from '../../room/plan.js';
import { toggleMove } from './feature.js';
import { presetRows } from './preset_menu.js';
import { draftWords } from './beam_words.js';
import { ofFits } from '../fits/feature.js';
import { icon, swatch } from '../../parts/icons.js';
import { eye, name, treeRow } from '../../parts/tree_row.js';

/** "draft" while one stands in for the chosen beam. */
export const beamNote = ({ room }) => (isDraftOn(room) ? 'draft' : '');

export function beamRows(world) {
  const { room } = world;
  const { beams, curves } = room.plan.value;
  return html`${beams.filter((beam) => !isOfOther(room.plan.value, room.scene.value, beam)).map((beam) => beamRow(world, beam))}${draftRow(world)}${Object.entries(room.scene.value.beam.kept).map(([id, line]) => keptRow(world, id, line))}${curves.map((curve) => curveRow(world, curve))}${presetRows(world)}`;
}

function beamRow(world, beam) {
  const { room, ui } = world;
  const [plan, scene] = [room.plan.value, room.scene.value];
  const look = lookOf(scene, beam.id);
  const words = beamName(beam);
  const about = beamWords(beam);
  const tail = beam === chosenBeam(plan, scene) ? 'chosen' : about;
  const toggle = (event) =>
    room.patchScene(lookPatch(room.scene.value, beam.id, { visible: !look.visible }), { view: ui.active.value, at: event.timeStamp });
  return treeRow(
    world,
    {
      kind: 'beam',
      id: beam.id,
      words: [words, ofFits(room)?.rowWords(world, 'beam', beam.id) ?? '', tail],
      more: tail === about ? [] : [about].filter(Boolean),
      title: [words, about].filter(Boolean).join(', '),
      isOn: look.visible,
      toggle,
    },
    html`
    ${eye(look.visible, `Show ${words}`, `${look.visible ? 'Hide' : 'Show'} its line and aperture`, !room.canChange.value, toggle)}${swatch(look.color)}${name(words)} ${ofFits(room)?.rowMark(world, 'beam', beam.id) ?? nothing}<span class="tail clipped">${tail}</span>`,
  );
}

/** The draft, or where one is begun. */
function draftRow(world) {
  const { room } = world;
  const isOn = isDraftOn(room);
  const about = isOn ? draftWords(room.plan.value, room.scene.value) : '…';
  const tail = about.replace('target moved ', '').replace('direction ', '');
  return treeRow(
    world,
    {
      kind: 'beam',
      id: '',
      words: [isOn ? 'Draft' : 'New draft', tail],
      more: isOn ? [about] : [],
      title: isOn ? 'A beam that is being positioned; the plan keeps its own' : 'A new position for a beam; the plan keeps its own',
    },
    html`
    ${icon(isOn ? 'warning' : 'plus')}${name(isOn ? 'Draft' : 'New draft')} <span class=${isOn ? 'tail clipped warn' : 'tail'}>${tail}</span>`,
  );
}

function keptRow(world, id, line) {
  const words = keptName(id, line);
  return treeRow(
    world,
    { kind: 'kept', id, words: [words, 'kept'], title: `${words}: a draft that was kept` },
    html`${icon('marker')}${name(words)} <span class="tail">kept</span>`,
  );
}

function curveRow(world, { id, name: own }) {
  const words = own || id;
  return treeRow(
    world,
    { kind: 'curve', id, words: [words, 'reference curve'], title: 'reference curve' },
    html`${icon('curve')}${name(words)} <span class="tail clipped">reference curve</span>`,
  );
}

/** In the strip above the panes: entry or target of a beam by dragging. */
export function moveTool(world) {
  const { room, ui } = world;
  const isOn = ui.tool.value === 'beam';
  const { overlay, size } = ui.arrangement.value;
  if (overlay === 'pushes' || (!isOn && !room.plan.value.beams.length && !room.scene.value.beam.draft.enabled)) return nothing; // no room for it: Selection has it too
  return html`<button class=${classMap({ tool: true, on: isOn })} tabindex="-1" title="Move entry or target of a beam in any pane; the plan keeps its own" aria-pressed=${isOn} aria-label="Move beam"
    @click=${() => toggleMove(world)}>${icon('target')}${size === 'wide' ? html`<span class="word">Move beam</span>` : nothing}</button>`;
}
