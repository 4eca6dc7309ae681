// The table ‘What fits what’ of the Plan tab, and the parts of other patients.
import { html, nothing } from '../../../lib/lit-html.js';
import { partOf } from './fits.js';
import { comparison, isCompared, toggleComparison } from '../patient/patient_card.js';
import { onePersonForm } from '../patient/statement.js';
import { partsOfOthers, patientOf, shownPatient } from '../../room/identity.js';
import { shownImage } from '../../room/plan.js';
import { icon } from '../../parts/icons.js';
import { say } from './later_words.js';

const names = { image: say.image, dose: say.dose, beam: say.beam, region: say.region };
const within = { image: say.inImage, dose: say.inDose, beam: say.inBeam, region: say.inRegion };
/** A cell of the table: its text, and how it is marked. */
const [same, other] = [
  [say.same, 'ok'],
  [say.differs, 'err'],
];
const relations = {
  same,
  registered: [say.byRegistration, 'ok'],
  unstated: [say.notStated, ''],
  absent: same,
  plan: same,
  unit: same,
  per: same,
  apart: [say.apart, 'err'],
  frame: other,
  patient: other,
};

/** Each part against the shown image: frame, patient, plan, in words. */
export function fitsTable({ room }) {
  const [plan, scene] = [room.plan.value, room.scene.value];
  const image = shownImage(plan, scene);
  const key = `image:${image?.id}`;
  const rows = plan.fits.filter((fit) => fit.with === key);
  if (!image || !rows.length) return nothing;
  const cells = ({ thing, relation, reason }) => {
    const { word, name, part, kind } = partOf(plan, thing);
    const isOther = part && plan.patients[part.patient] && plan.patients[image.patient] && part.patient !== image.patient;
    const isStated = part && plan.patients[part.patient] && plan.patients[image.patient];
    const label = plan.treatmentPlans[part?.plan]?.label;
    const facts = [
      relations[relation] ?? [relation, ''],
      !isStated ? [say.notStated, ''] : isOther ? other : same,
      label === undefined && relation === 'absent' ? [say.notHere, 'err'] : [label ?? '–', ''],
    ];
    const of = kind === 'image' ? name : name ? say.partQuoted({ kind: word, name }) : word;
    return html`<tr title=${reason}><th scope="row">${of}</th>${facts.map(([text, mark]) => html`<td class=${mark}>${text}</td>`)}</tr>`;
  };
  const columns = [say.columnPart, say.columnFrame, say.columnPatient, say.columnPlan];
  return html`<section class="block"><h3>${say.fitsWhat} <span class="dim">${say.allAgainst({ image: partOf(plan, key).name })}</span></h3>
    <table class="fit-table"><thead><tr>${columns.map((word) => html`<th scope="col">${word}</th>`)}</tr></thead><tbody>${rows.map(cells)}</tbody></table></section>`;
}

/** The red bar: parts of several patients. */
export function otherPatientsBar(world) {
  const { room } = world;
  const [plan, scene] = [room.plan.value, room.scene.value];
  const others = plan && scene ? partsOfOthers(plan, scene) : [];
  if (!others.length) return nothing;
  const byPatient = [...new Set(others.map(({ masked }) => masked))].map((masked) => {
    const own = others.filter((part) => part.masked === masked);
    const kinds = [...new Set(own.map(({ kind, name }) => (kind === 'image' ? name : within[kind])))];
    const parts = kinds.length > 1 ? say.partsAnd({ parts: kinds.slice(0, -1).join(', '), last: kinds.at(-1) }) : kinds[0];
    return say.partsOf({ parts, patient: masked });
  });
  const label = plan.treatmentPlans.find(({ patient }) => plan.patients[patient] === shownPatient(plan, scene))?.label;
  const facts = { patient: shownPatient(plan, scene).masked, parts: byPatient.join('; '), plan: label };
  return html`<div class="fit-bar err" role="alert"><span class="err">${icon('error')}</span>
    <p><b>${say.severalPatients({ n: plan.patients.length })}</b> ${label ? say.shownOfPlanNot(facts) : say.shownNot(facts)}</p>
    ${
      room.seesIdentity.value
        ? html`<button aria-expanded=${isCompared(world)} @click=${() => void toggleComparison(world)}>${isCompared(world) ? say.maskThem : say.compareIdentities}</button>${comparison(world)}${isCompared(world) ? onePersonForm(world) : nothing}`
        : nothing
    }</div>`;
}

/** The rows of the tree's last section. */
export function otherPatients({ room }) {
  return partsOfOthers(room.plan.value, room.scene.value).map(({ kind, name, masked }) => {
    const words = kind === 'image' ? name : say.partQuoted({ kind: names[kind], name });
    const label = say.neverUsed({ part: words, patient: masked });
    return html`<li class="row off not-this-patient" role="treeitem" aria-level="2" aria-selected="false" aria-label=${label}>
      ${icon('eyeOff')}<span class="name">${words}</span> <span class="tail">${masked}</span></li>`;
  });
}

export { patientOf };
