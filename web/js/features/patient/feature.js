// The patient: masked, and the card with the full identity.
import { approval, patientBlock, patientButton, planBar, planName } from './patient.js';

/** @type {import('../index.js').Feature} */
export const patient = { bannerStart: patientButton, bannerPlan: planName, bannerFacts: approval, bar: planBar, planTop: patientBlock };
