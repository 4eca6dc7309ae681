// The treatment plans of a folder: which is shown, and the patch that shows another with its dose, beams, regions and prescription. Pure.
import { choosePatch as doseChoice, shownDose } from '../../room/dose.js';
import { unitFactor } from '../../room/dose_units.js';
import { chosenBeam, choosePatch as beamChoice, lookOf } from '../beams/beams.js';

/** The doses of a treatment plan, the one that is shown first in front. */
export const dosesOf = (plan, treatment) => plan.doses.filter(({ plan: of }) => plan.treatmentPlans[of] === treatment);
const beamsOf = (plan, treatment) => plan.beams.filter(({ plan: of }) => plan.treatmentPlans[of] === treatment);
const regionsOf = (plan, { structs }) => (structs === null ? [] : plan.regions.filter((region) => region.structs === structs));

/** The regions of the other structure set take the place of those of the same name. */
function regionsPatch(plan, scene, from, to) {
  const [old, own] = [regionsOf(plan, from), regionsOf(plan, to)];
  if (!own.length || from.structs === to.structs) return {};
  const others = plan.regions.filter(({ structs }) => structs !== null && structs !== to.structs);
  const isShown = (region) => {
    const like = old.find(({ fileName }) => fileName === region.fileName);
    return like ? Boolean(scene.regions[like.id]?.visible) : true;
  };
  const looks = [...others.map(({ id }) => [id, false]), ...own.map((region) => [region.id, isShown(region)])];
  const changed = looks.filter(([id, visible]) => Boolean(scene.regions[id]?.visible) !== visible);
  return changed.length ? { regions: Object.fromEntries(changed.map(([id, visible]) => [id, { visible }])) } : {};
}

/** Beams of the plan are drawn if some of the other plan's were; one of them is the chosen one. */
function beamPatch(plan, scene, to) {
  const own = beamsOf(plan, to);
  const strangers = plan.beams.filter((beam) => beam.plan !== null && !own.includes(beam));
  if (!own.length && !strangers.length) return {};
  const isAny = strangers.some(({ id }) => lookOf(scene, id).visible);
  const looks = Object.fromEntries([
    ...strangers.filter(({ id }) => lookOf(scene, id).visible).map(({ id }) => [id, { visible: false }]),
    ...(isAny ? own : []).map(({ id }) => [id, scene.beam.looks[id] ? { visible: true } : { ...lookOf(scene, id), visible: true }]),
  ]);
  const chosen = own.includes(chosenBeam(plan, scene)) || !own.length ? {} : beamChoice(plan, scene, own[0].id).beam;
  const beam = { ...chosen, ...(Object.keys(looks).length && { looks }) };
  return Object.keys(beam).length ? { beam } : {};
}

/** The other plan's prescription in place of this one's, its region in place of the same of this structure set; anything else that is 100 % stays. */
function referencePatch(plan, scene, from, to, dose) {
  const { kind, region, value } = scene.dose.reference;
  const factor = unitFactor('Gy', dose.unit);
  if (kind === 'value' && from.prescription_gy > 0 && to.prescription_gy > 0 && factor) {
    const isPrescribed = Math.abs(value - from.prescription_gy * (unitFactor('Gy', shownDose(plan, scene)?.unit) ?? NaN)) < 1e-6 * value;
    if (isPrescribed) return { reference: { value: to.prescription_gy * factor } };
  }
  const old = regionsOf(plan, from).find(({ id }) => id === region);
  const like = old && from.structs !== to.structs && regionsOf(plan, to).find(({ fileName }) => fileName === old.fileName);
  return like ? { reference: { region: like.id } } : {};
}

/** Shows another treatment plan: one patch, so one step to undo. null: it has no dose, by which the shown plan is known. */
export function planPatch(plan, scene, from, to) {
  const [dose] = dosesOf(plan, to);
  if (!dose) return null;
  const chosen = doseChoice(plan, scene, dose);
  const beams = to.beam_doses?.includes(dose.id) ? to.beam_doses.filter((id) => id !== dose.id) : []; // together the plan's
  const old = Object.keys(scene.dose.sum).map((id) => [id, null]); // the other plan's summands
  const sum = Object.fromEntries([...old, ...beams.map((id) => [id, { factor: 1 }])]);
  const compare = scene.dose.compare.mode === 'none' ? {} : { compare: { mode: 'none' } };
  const reference = referencePatch(plan, scene, from, to, dose).reference;
  return {
    ...chosen,
    ...beamPatch(plan, scene, to),
    ...regionsPatch(plan, scene, from, to),
    dose: {
      ...chosen.dose,
      ...compare,
      ...(Object.keys(sum).length && { sum }),
      ...(beams.length && scene.dose.factor !== 1 && { factor: 1 }), // each beam counts once
      ...(reference && { reference: { ...chosen.dose?.reference, ...reference } }),
    },
  };
}
