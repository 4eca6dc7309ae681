// Beams in the tree: the plan's, its draft, drafts that were kept, reference curves; and the button of the tool that moves them.
import { html, nothing } from '../../../lib/lit-html.js';
import { classMap } from '../../../lib/directives/class-map.js';
import { beamName, chosenBeam, lookOf, lookPatch } from './beams.js';
import { isDraftOn } from './beam_ui.js';
import { beamWords } from '../../room/plan.js';
import { isOfOtherPlan, planGroups } from '../../room/plan_groups.js';
import { toggleMove } from './feature.js';
import { presetRows } from './preset_menu.js';
import { draftFigures, draftWords, keptName } from './beam_words.js';
import { ofFits } from '../fits/feature.js';
import { icon, swatch } from '../../parts/icons.js';
import { eye, name, treeRow } from '../../parts/tree_row.js';
import { say } from './row_words.js';

/** "draft" while one stands in for the chosen beam. */
export const beamNote = ({ room }) => (isDraftOn(room) ? say.draftOn : '');

export function beamRows(world) {
  const { room } = world;
  const { beams, curves } = room.plan.value;
  return html`${planGroups(room.plan.value, room.scene.value, beams).map(({ head, parts }) => html`${group(head)}${parts.map((beam) => beamRow(world, beam))}`)}${ofRoom(world)}${draftRow(world)}${Object.entries(room.scene.value.beam.kept).map(([id, line]) => keptRow(world, id, line))}${curves.map((curve) => curveRow(world, curve))}${presetRows(world)}`;
}

const group = (head) => (head ? html`<li class="row-group" role="presentation">${head}</li>` : nothing);

/** Before the drafts, where plans have groups of their own. */
function ofRoom({ room }) {
  const hasDrafts = isDraftOn(room) || Object.keys(room.scene.value.beam.kept).length > 0;
  return group(hasDrafts && room.plan.value.treatmentPlans.length > 1 ? say.ofRoom : '');
}

function beamRow(world, beam) {
  const { room, ui } = world;
  const [plan, scene] = [room.plan.value, room.scene.value];
  const look = lookOf(scene, beam.id);
  const words = beamName(beam);
  const about = beamWords(beam);
  const tail = beam === chosenBeam(plan, scene) ? say.chosen : isOfOtherPlan(plan, scene, beam) ? say.compareOnly : about;
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
    ${eye(look.visible, say.show({ beam: words }), look.visible ? say.hideLine : say.showLine, !room.canChange.value, toggle)}${swatch(look.color)}${name(words)} ${ofFits(room)?.rowMark(world, 'beam', beam.id) ?? nothing}<span class="tail clipped">${tail}</span>`,
  );
}

/** The draft, or where one is begun. */
function draftRow(world) {
  const { room } = world;
  const isOn = isDraftOn(room);
  const [plan, scene] = [room.plan.value, room.scene.value];
  const tail = isOn ? draftFigures(plan, scene) : '…';
  return treeRow(
    world,
    {
      kind: 'beam',
      id: '',
      words: [isOn ? say.draft : say.newDraft, tail],
      more: isOn ? [draftWords(plan, scene)] : [],
      title: isOn ? say.draftIs : say.newDraftIs,
    },
    html`
    ${icon(isOn ? 'warning' : 'plus')}${name(isOn ? say.draft : say.newDraft)} <span class=${isOn ? 'tail clipped warn' : 'tail'}>${tail}</span>`,
  );
}

function keptRow(world, id, line) {
  const words = keptName(id, line);
  return treeRow(
    world,
    { kind: 'kept', id, words: [words, say.kept], title: say.keptIs({ draft: words }) },
    html`${icon('marker')}${name(words)} <span class="tail">${say.kept}</span>`,
  );
}

function curveRow(world, { id, name: own }) {
  const words = own || id;
  return treeRow(
    world,
    { kind: 'curve', id, words: [words, say.curve], title: say.curve },
    html`${icon('curve')}${name(words)} <span class="tail clipped">${say.curve}</span>`,
  );
}

/** In the strip above the panes: entry or target of a beam by dragging. */
export function moveTool(world) {
  const { room, ui } = world;
  const isOn = ui.tool.value === 'beam';
  const { overlay, size } = ui.arrangement.value;
  if (overlay === 'pushes' || (!isOn && !room.plan.value.beams.length && !room.scene.value.beam.draft.enabled)) return nothing; // no room for it: Selection has it too
  return html`<button class=${classMap({ tool: true, on: isOn })} tabindex="-1" title=${say.moveIs} aria-pressed=${isOn} aria-label=${say.move}
    @click=${() => toggleMove(world)}>${icon('target')}${size === 'wide' ? html`<span class="word">${say.move}</span>` : nothing}</button>`;
}
