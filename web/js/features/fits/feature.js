// What stands on the page where parts of a plan do not fit: no part of what a first visit loads, as most plans fit.
import { known, Lazy, styled } from '../../parts/lazy.js';

const panels = new Lazy(async () => (await Promise.all([import('./later.js'), styled('js/features/fits/fit.css')]))[0]);

/** What later.js exports; null for a plan whose parts all fit, and until it is loaded. */
export const ofFits = (room) => (room.plan.value?.fits.some(({ needs }) => needs !== 'nothing') ? known(panels) : null);
