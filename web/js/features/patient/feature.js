// The patient: masked, and the card with the full identity.
import { approval, patientBlock, patientButton } from './patient.js';

/** @type {import('../index.js').Feature} */
export const patient = { bannerStart: patientButton, bannerFacts: approval, planTop: patientBlock };
