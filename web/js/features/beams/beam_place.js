// Where a draft is set by numbers: entry and target, angles, skin gap, through the crosshair, the shortest path. The server places it; nothing of the plan changes.
import { html, nothing } from '../../../lib/lit-html.js';
import { endCompare, isDraftOn, movedPoint } from './beam_ui.js';
import { shownLine } from './beams.js';
import { replaced } from '../../parts/lists.js';
import { crosshair } from '../../room/plan.js';
import { setLine } from './beam_actions.js';
import { startMoving } from './beam_move.js';
import { numberField } from '../../parts/fields.js';
import { icon } from '../../parts/icons.js';
import { say } from './later_words.js';

const tenths = (value) => (Number.isFinite(value) ? Math.round(value * 10) / 10 || 0 : '');
const leastApertureMm = 0.1; // scene.json
const mostApertureMm = 2000;

/** Once the server has this person's changes of the scene, which the question is about. */
const toldToServer = ({ isScenePending }) =>
  new Promise((done) => {
    const stop = isScenePending.subscribe((isPending) => {
      if (!isPending)
        queueMicrotask(() => {
          stop();
          done();
        });
    });
  });

/** Asks where the beam is to be, and puts the draft there. The newest question wins. */
let asked = 0;
async function ask(world, event, parameters) {
  const { room, ui, api } = world;
  const number = ++asked;
  const at = { timeStamp: event.timeStamp };
  endCompare(room);
  await toldToServer(room);
  try {
    const override = room.following.override.peek();
    const { entry_mm, target_mm, why } = await api.ofScene(
      room.planId.peek(),
      'beam/place',
      room.id,
      override ? { override } : {},
      parameters,
    );
    if (number !== asked) return;
    if (!entry_mm || !target_mm) ui.notify('warn', why || say.noPosition, 'beam');
    else setLine(world, { entry_mm, target_mm }, at);
  } catch (error) {
    if (number === asked) ui.notify('err', error.message, 'beam');
  }
}

/** The tool with this point; pressed again it is off. */
function moveButton(world, part, words, isDisabled) {
  const { ui } = world;
  const isOn = ui.tool.value === 'beam' && movedPoint.value === part;
  const toggle = () => (isOn ? void (ui.tool.value = 'crosshair') : startMoving(world, part));
  return html`<button class=${isOn ? 'on' : ''} aria-pressed=${isOn} title=${say.moveIs} ?disabled=${isDisabled} @click=${toggle}>${words}</button>`;
}

/** @param {object|null} facts the answer to the question beam; null: not here yet */
export function placeBlock(world, isDisabled, facts) {
  const { room } = world;
  const line = shownLine(room.plan.value, room.scene.value);
  if (!line) return nothing;
  const isDraft = isDraftOn(room);
  const point = (part, name, inMm) =>
    html`<dt>${name}</dt><dd class="beam-fields">${['L', 'P', 'S'].map((letter, axis) =>
      numberField(inMm({ letter }), tenths(line[`${part}_mm`][axis]), letter, isDisabled, (value, event) =>
        setLine(world, { [`${part}_mm`]: replaced(line[`${part}_mm`], axis, value) }, event),
      ),
    )}</dd>`;
  const { phi_deg: phi, theta_deg: theta } = facts?.sera ?? {};
  const turn = (angles) => (value, event) => ask(world, event, { mode: 'angles', phi_deg: phi, theta_deg: theta, ...angles(value) });
  return html`<section class="block beam-place"><h3 class="beam-head">${say.position} <span class="dim">${isDraft ? say.ofDraft2 : say.beginsDraft}</span></h3>
    <div class="beam-moved-point"><div class="segment" role="group" aria-label=${say.moveByDragging}>${[
      ['target', say.moveTarget],
      ['entry', say.moveEntry],
    ].map(([part, words]) => moveButton(world, part, words, isDisabled))}</div></div>
    <dl>${point('target', say.target, say.targetIn)}${point('entry', say.entry, say.entryIn)}
      <dt title=${say.turnsAbout}>${say.angles}</dt><dd class="beam-fields">${numberField(
        say.phiDegrees,
        tenths(phi),
        '°',
        isDisabled || !facts?.sera,
        turn((value) => ({ phi_deg: Math.min(Math.max(value, 0), 180) })),
      )}${numberField(
        say.thetaDegrees,
        tenths(theta),
        '°',
        isDisabled || !facts?.sera,
        turn((value) => ({ theta_deg: value % 360 })),
      )}</dd>
      <dt title=${say.gapMoves}>${say.gap}</dt><dd class="beam-fields">${numberField(say.gapMm, tenths(facts?.gap_mm), 'mm', isDisabled || !facts, (value, event) => ask(world, event, { mode: 'gap', gap_mm: value }))}</dd>
      <dt title=${say.diameter}>${say.aperture}</dt><dd class="beam-fields">${numberField(say.apertureMm, tenths(line.aperture_mm), 'mm', isDisabled, (value, event) => setLine(world, { aperture_mm: Math.min(Math.max(value, leastApertureMm), mostApertureMm) }, event))}</dd></dl>
    <div class="buttons"><button ?disabled=${isDisabled} title=${say.throughCrosshairIs} @click=${(event) => ask(world, event, { mode: 'through', point_lps_mm: crosshair(room.scene.value).join() })}>${icon('crosshair')}${say.throughCrosshair}</button>
      <button ?disabled=${isDisabled} title=${say.shortestIs} @click=${(event) => ask(world, event, { mode: 'shortest' })}>${say.shortest}</button></div></section>`;
}
