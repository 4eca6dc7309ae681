// Regions that the pictures leave out, in words.
import { nameSome } from '../parts/format.js';
import { say } from './words.js';

/** '' where nothing is left out. @param {object} world of wall_page.js */
export function missingOf({ room }) {
  const ids = new Set(room.views.flatMap((view) => (view.isOpen.value ? Object.keys(view.missing.value.reasons) : [])));
  const names = room.plan.value.regions.filter(({ id }) => ids.has(id)).map(({ name }) => name);
  return names.length ? say.leftOut({ regions: nameSome(names) }) : '';
}
