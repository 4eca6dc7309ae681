// The inspector's Selection of a beam: its geometry, planned and drafted, what lies in its aperture, how it is drawn; and of a draft that was kept.
import { html, nothing } from '../../../lib/lit-html.js';
import { live } from '../../../lib/directives/live.js';
import { classMap } from '../../../lib/directives/class-map.js';
import { beamFacts } from './beam_facts.js';
import { beamName, chosenBeam, lookOf, lookPatch } from './beams.js';
import { isDraftOn } from './beam_ui.js';
import { waitReason } from '../../room/waits.js';
import { changeBeam, choose, openBeamsEye, resetDraft, selectedBeam, startDraft, useKept } from './beam_actions.js';
import { placeBlock } from './beam_place.js';
import { regionBlocks } from './beam_regions.js';
import { angle, coordinates, keptName, mm } from './beam_words.js';
import { checkbox, numberField } from '../../parts/fields.js';
import { icon } from '../../parts/icons.js';
import { say } from './later_words.js';

export function beamBlock(world, isDisabled) {
  const { room, ui } = world;
  const [plan, scene] = [room.plan.value, room.scene.value];
  const beam = selectedBeam(world);
  const chosen = chosenBeam(plan, scene);
  const isChosen = beam === chosen;
  const isDraft = isChosen && isDraftOn(room);
  if (!beam && !isDraft)
    return html`<section class="block"><h3>${icon('target')} ${ui.selection.value.id ? say.beam : say.newDraft}</h3>
    <p class="note">${say.noBeamIs}</p>
    <div class="buttons"><button class="primary" ?disabled=${isDisabled} @click=${(event) => startDraft(world, event)}>${say.draftNew}</button></div></section>`;
  const { result, error, isOld } = beamFacts(world, isChosen ? '' : beam.id).answer.value;
  const facts = result && result.is_draft === isDraft ? result : null;
  const why = error || (facts ? '' : waitReason(room));
  return html`<section class="block beam-block"><h3>${icon('target')} <span>${beam ? say.beamNamed({ beam: beamName(beam) }) : say.draftBeam}</span>${isChosen && plan.beams.length > 1 ? html` <span class="dim">${say.chosen}</span>` : nothing}</h3>
      ${geometry(world, beam, isDraft, facts, isOld)}${why ? html`<p class="note why" role="status">${icon('warning', 12)} ${why}</p>` : nothing}
      <div class="buttons"><button title=${world.ui.keys.tip(say.eyeIs, 'beamEye')} @click=${() => eyeOf(world, beam, isChosen)}>${say.eye}</button>
        ${isChosen ? nothing : html`<button title=${say.chooseIs} ?disabled=${isDisabled} @click=${(event) => choose(world, beam.id, event)}>${say.choose}</button>`}
        ${
          !isChosen
            ? nothing
            : isDraft
              ? html`<button ?disabled=${isDisabled} @click=${(event) => resetDraft(world, event)}>${beam ? say.reset : say.putAway}</button>`
              : html`<button ?disabled=${isDisabled} @click=${(event) => startDraft(world, event)}>${say.draftNew}</button>`
        }</div></section>
    ${isChosen ? placeBlock(world, isDisabled, facts) : nothing}${regionBlocks(world, facts, isOld)}${beam ? lookBlock(world, beam, isDisabled) : nothing}`;
}

/** The view shows the chosen beam: another one that is looked along is chosen first. */
function eyeOf(world, beam, isChosen) {
  if (!isChosen) choose(world, beam.id, { timeStamp: performance.now() });
  openBeamsEye(world);
}

// ---- geometry -----------------------------------------------------------------------------------------------------------

/** A value that is not there, with the reason. */
const missing = (why) => html`<span class="dim" title=${why}>${why}</span>`;
const place = (point) => html`<span class="beam-point">${coordinates(point).map((word) => html`<span>${word}</span>`)}</span>`;

const sources = { 'treatment-plan': say.ofTreatmentPlan, 'plan-folder': say.ofPlanFolder, draft: say.ofDraft };

/** The plan's or the draft's; a ring that is drawn in a picture is neither. */
function apertureWords({ isDraft, facts, line }) {
  if (!facts.aperture_mm) return missing(facts.outline ? facts.outline.kind : say.notKnown);
  return isDraft && line.aperture_mm ? say.ownAperture({ diameter: mm(facts.aperture_mm) }) : mm(facts.aperture_mm);
}

/** Rows of [name, value of a line's facts, tooltip, whether it is left out]. line: with entry_mm, target_mm of the scene or the plan; facts: of the question, null until they are here. */
const rows = [
  [say.targetMm, ({ line }) => place(line.target_mm)],
  [say.entryMm, ({ line }) => place(line.entry_mm), say.entryIs],
  [say.angles, ({ facts }) => facts.sera && `${angle(facts.sera.phi_deg)}, ${angle(facts.sera.theta_deg)}`, say.anglesAre],
  [
    say.gantry,
    ({ facts }) => facts.iec && `${angle(facts.iec.gantry_deg)}, ${angle(facts.iec.couch_deg)}`,
    'IEC 61217',
    ({ facts }) => !facts.iec,
  ],
  [say.length, ({ facts }) => mm(facts.length_mm)],
  [say.gap, ({ facts }) => (Number.isFinite(facts.gap_mm) ? mm(facts.gap_mm) : missing(facts.skin_reason || say.misses)), say.gapIs],
  [
    say.depth,
    ({ facts }) => (Number.isFinite(facts.depth_mm) ? mm(facts.depth_mm) : missing(facts.skin_reason || say.misses)),
    say.depthIs,
  ],
  [say.aperture, apertureWords, say.diameter],
  [say.source, ({ facts }) => sources[facts.source] ?? facts.source],
  [say.radiation, ({ facts }) => facts.radiation, undefined, ({ facts }) => !facts.radiation],
];

function geometry(world, beam, isDraft, facts, isOld) {
  const { line } = world.room.scene.value.beam.draft;
  const columns = [
    ...(isDraft ? [{ isDraft: true, name: say.draft, line, facts }] : []),
    ...(beam ? [{ isDraft: false, name: say.planned, line: beam, facts: isDraft ? facts?.planned : facts }] : []),
  ];
  const cell = (value, column, at) =>
    html`<td class=${classMap({ old: isOld && at > 1, planned: isDraft && !column.isDraft })}>${value(column)}</td>`;
  const shown = rows.filter(([, , , isLeftOut]) => !isLeftOut || columns.some((column) => column.facts && !isLeftOut(column)));
  const about = [
    beam?.delivery?.machine && [say.machine, beam.delivery.machine],
    facts?.iec?.patient_position && [say.patientPosition, facts.iec.patient_position],
  ].filter(Boolean);
  return html`<table class="beam-table"><thead><tr><th scope="col"><span class="hidden">${say.geometry}</span></th>${columns.map(({ name }) => html`<th scope="col">${name}</th>`)}</tr></thead>
    <tbody>${shown.map(([name, value, title], at) => html`<tr><th scope="row" title=${title ?? nothing}>${name}</th>${columns.map((column) => (at < 2 || column.facts ? cell(value, column, at) : html`<td class="dim">…</td>`))}</tr>`)}</tbody></table>
    ${about.length ? html`<dl class="beam-about">${about.map(([name, value]) => html`<dt>${name}</dt><dd>${value}</dd>`)}</dl>` : nothing}`;
}

// ---- how it is drawn ----------------------------------------------------------------------------------------------------

function lookBlock(world, beam, isDisabled) {
  const { room } = world;
  const scene = room.scene.value;
  const look = lookOf(scene, beam.id);
  const set = (fields, event) => changeBeam(world, (_, now) => lookPatch(now, beam.id, fields), event);
  return html`<section class="block"><h3>${say.drawn} <span class="dim">${say.drawnIn}</span></h3>
    <div class="beam-look">${checkbox(say.line, look.visible, isDisabled, (on, event) => set({ visible: on }, event))}${checkbox(say.opening, look.opening, isDisabled, (on, event) => set({ opening: on }, event), say.openingIs)}
      <input type="color" aria-label=${say.colourOf({ beam: beamName(beam) })} .value=${live(look.color)} ?disabled=${isDisabled} @change=${(event) => set({ color: event.target.value }, event)}></div>
    <dl><dt title=${say.opacityIs}>${say.opacity}</dt><dd>${numberField(
      say.opacityPercent,
      Math.round(scene.beam.opacity * 100),
      '%',
      isDisabled,
      (value, event) => changeBeam(world, () => ({ beam: { opacity: Math.min(Math.max(value, 0), 100) / 100 } }), event),
    )}</dd></dl></section>`;
}

// ---- a draft that was kept ----------------------------------------------------------------------------------------------

export function keptBlock(world, isDisabled) {
  const { ui, room } = world;
  const { id } = ui.selection.value;
  const line = room.scene.value.beam.kept[id];
  if (!line) return nothing;
  const change = (fields) => (event) => changeBeam(world, () => ({ beam: { kept: { [id]: fields(event) } } }), event);
  const remove = (event) => {
    change(() => null)(event);
    ui.select('beam', '');
  };
  return html`<section class="block beam-block"><h3>${icon('marker')} ${keptName(id, line)} <span class="dim">${say.keptDraft}</span></h3>
    <dl><dt>${say.name}</dt><dd><input class="clip-name" maxlength="40" aria-label=${say.keptNameIs} placeholder=${keptName(id)} .value=${live(line.name ?? '')} ?disabled=${isDisabled} @change=${change((event) => ({ name: event.target.value.trim().slice(0, 40) }))}></dd>
      <dt>${say.targetMm}</dt><dd>${place(line.target_mm)}</dd><dt>${say.entryMm}</dt><dd>${place(line.entry_mm)}</dd>${line.aperture_mm ? html`<dt>${say.aperture}</dt><dd>${mm(line.aperture_mm)}</dd>` : nothing}</dl>
    <div class="buttons"><button ?disabled=${isDisabled} title=${say.draftItIs} @click=${(event) => useKept(world, id, event)}>${say.draftIt}</button><button ?disabled=${isDisabled} @click=${remove}>${icon('trash')}${say.delete}</button></div></section>`;
}
