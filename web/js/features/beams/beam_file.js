// A draft beam as a JSON file. Pure.
import { beamName, chosenBeam, movedFrom } from './beams.js';

const frame = {
  axes: 'LPS',
  about: 'Patient coordinates: L to the left, P to posterior, S to superior.',
  units: { length: 'mm', angle: 'degree' },
};

const lineOf = ({ entry_mm, target_mm, aperture_mm }) => ({
  entry_lps_mm: entry_mm,
  target_lps_mm: target_mm,
  length_mm: Math.hypot(...entry_mm.map((mm, axis) => mm - target_mm[axis])),
  aperture_mm: aperture_mm ?? null,
});

/** Facts of a line from the answer of the question beam; null where they are not known. */
const facts = (answer) =>
  answer
    ? {
        sera: answer.sera ?? null,
        iec: answer.iec ?? null,
        skin_lps_mm: answer.skin_lps_mm ?? null,
        gap_mm: answer.gap_mm ?? null,
        depth_mm: answer.depth_mm ?? null,
      }
    : null;

/**
 * @param {object} plan @param {object} scene that has the draft @param {string} planId
 * @param {object|null} answer to the question beam, of this very draft
 */
export function draftDocument(plan, scene, planId, answer) {
  const planned = chosenBeam(plan, scene);
  const { line } = scene.beam.draft;
  const moved = movedFrom(planned, line);
  return {
    format: 'beamroom-draft-beam',
    version: 1,
    about: 'A draft. The dose of the plan belongs to the planned beam. For research; not for treatment.',
    plan: { id: planId, name: plan.name },
    frame,
    draft: { name: line.name, ...lineOf({ ...line, aperture_mm: line.aperture_mm ?? planned?.aperture_mm }), ...facts(answer) },
    planned: planned && { id: planned.id, name: beamName(planned), ...lineOf(planned), ...facts(answer?.planned) },
    moved: moved && { target_mm: moved.targetMm, direction_deg: moved.directionDeg },
  };
}
