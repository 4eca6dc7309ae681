// Parts of the page for plans whose parts do not fit: not loaded by a first visit, as most plans fit.
import { html } from '../../../lib/lit-html.js';
import { partsOfOthers } from '../../room/identity.js';
import { number } from '../../parts/format.js';
import { known, later } from '../../parts/lazy.js';
import { say } from './words.js';

const panels = later(() => import('./later.js'), 'js/features/fits/fit.css');

/** Exports of later.js; null for a plan whose parts all fit, and until it is loaded. */
export const ofFits = (room) => (room.plan.value?.fits.some(({ needs }) => needs !== 'nothing') ? known(panels) : null);

/** @type {import('../index.js').Feature} */
export const fits = {
  sections: [
    {
      id: 'others',
      name: say.section,
      icon: 'error',
      place: 10,
      has: (plan, scene) => partsOfOthers(plan, scene).length,
      note: ({ room }) => {
        const n = partsOfOthers(room.plan.value, room.scene.value).length;
        return say.neverDrawn({ count: number(n), n });
      },
      rows: (world) => ofFits(world.room)?.otherPatients(world),
    },
  ],
  aboveBlock: (world) => ofFits(world.room)?.fitBlock(world),
  bar: (world) => html`${ofFits(world.room)?.otherPatientsBar(world)}${ofFits(world.room)?.fitBar(world)}`,
  planParts: (world) => ofFits(world.room)?.fitsTable(world),
  pane: (world) => ({ head: () => ofFits(world.room)?.wordMark(world) }),
};
