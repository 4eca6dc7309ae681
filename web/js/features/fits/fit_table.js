// The table ‘What fits what’ of the Plan tab, and the parts of other patients.
import { html, nothing } from '../../../lib/lit-html.js';
import { partOf } from './fits.js';
import { partsOfOthers, patientOf, shownPatient } from '../../room/identity.js';
import { shownImage } from '../../room/plan.js';
import { icon } from '../../parts/icons.js';

const names = { image: 'Image', dose: 'Dose', beam: 'Beam', region: 'Region' };
const relationWords = {
  same: 'same',
  registered: 'by registration',
  unstated: 'not stated',
  absent: 'same',
  plan: 'same',
  unit: 'same',
  per: 'same',
  apart: 'apart',
  frame: 'other',
  patient: 'other',
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
    const patient = !part || !plan.patients[part.patient] || !plan.patients[image.patient] ? 'not stated' : isOther ? 'other' : 'same';
    const of = plan.treatmentPlans[part?.plan]?.label ?? (relation === 'absent' ? 'not here' : '–');
    const isBad = (text) =>
      ['other', 'apart', 'not here'].includes(text) ? 'err' : text === 'same' || text === 'by registration' ? 'ok' : '';
    const frame = relationWords[relation] ?? relation;
    return html`<tr title=${reason}><th scope="row">${kind === 'image' ? name : [word, name && `‘${name}’`].filter(Boolean).join(' ')}</th><td class=${isBad(frame)}>${frame}</td><td class=${isBad(patient)}>${patient}</td><td class=${isBad(of)}>${of}</td></tr>`;
  };
  return html`<section class="block"><h3>What fits what <span class="dim">all against ${partOf(plan, key).name}</span></h3>
    <table class="fit-table"><thead><tr><th scope="col">part</th><th scope="col">frame</th><th scope="col">patient</th><th scope="col">plan</th></tr></thead><tbody>${rows.map(cells)}</tbody></table></section>`;
}

/** The red bar: parts of several patients. */
export function otherPatientsBar({ room }) {
  const [plan, scene] = [room.plan.value, room.scene.value];
  const others = plan && scene ? partsOfOthers(plan, scene) : [];
  if (!others.length) return nothing;
  const byPatient = [...new Set(others.map(({ masked }) => masked))].map((masked) => {
    const kinds = [
      ...new Set(
        others.filter((part) => part.masked === masked).map(({ kind, name }) => (kind === 'image' ? name : names[kind].toLowerCase())),
      ),
    ];
    return `${kinds.length > 1 ? `${kinds.slice(0, -1).join(', ')} and ${kinds.at(-1)}` : kinds[0]} of ${masked}`;
  });
  const label = plan.treatmentPlans.find(({ patient }) => plan.patients[patient] === shownPatient(plan, scene))?.label;
  return html`<div class="fit-bar err" role="alert"><span class="err">${icon('error')}</span><p><b>This folder holds parts of ${plan.patients.length} patients.</b> Shown: ${shownPatient(plan, scene).masked}${label ? `, the patient of plan ${label}` : ''}. Not used: ${byPatient.join('; ')}.</p></div>`;
}

/** The rows of the tree's last section. */
export function otherPatients({ room }) {
  return partsOfOthers(room.plan.value, room.scene.value).map(({ kind, name, masked }) => {
    const words = kind === 'image' ? name : `${names[kind]} ‘${name}’`;
    return html`<li class="row off not-this-patient" role="treeitem" aria-level="2" aria-selected="false" aria-label=${`${words} ${masked}, never used`}>${icon('eyeOff')}<span class="name">${words}</span> <span class="tail">${masked}</span></li>`;
  });
}

export { patientOf };
