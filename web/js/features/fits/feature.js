// Parts of the page for plans whose parts do not fit: not loaded by a first visit, as most plans fit.
import { known, Lazy, styled } from '../../parts/lazy.js';

const panels = new Lazy(async () => (await Promise.all([import('./later.js'), styled('js/features/fits/fit.css')]))[0]);

/** Exports of later.js; null for a plan whose parts all fit, and until it is loaded. */
export const ofFits = (room) => (room.plan.value?.fits.some(({ needs }) => needs !== 'nothing') ? known(panels) : null);
