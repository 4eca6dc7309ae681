// Modules that are loaded when the plots of dose are first wanted: the drawer, its form in a sheet, the table of limits, and their part of the report to print.
import { effect } from '../../../../lib/signals-core.js';
import { DoseCurves } from '../dose_curves.js';
import { limitsBlock } from './chart_limits.js';
import { irradiationBlock } from './irradiation.js';
import { drawer, sheet } from './chart_drawer.js';
import { Highlight } from './chart_highlight.js';
import { basisTable } from './chart_basis.js';
import { printed } from './chart_printed.js';

/** @param {object} room_world that of room_page.js */
export function makeCharts(room_world) {
  const { room, ui, api, clock } = room_world;
  const curves = new DoseCurves({ room, api, clock });
  const world = { ...room_world, curves, highlight: new Highlight(room), memo: memory() };
  const stop = effect(() => {
    const { drawer: place, sheet: open, inspector } = ui.arrangement.value;
    const tab = ui.tab.value;
    const isPrinted = ui.popover.value === 'printout';
    const isSheet = open === 'inspector' && tab === 'dvh';
    const areCurvesShown = place !== '' || isSheet || isPrinted;
    curves.isDvhShown.value = areCurvesShown;
    curves.isProfileShown.value = areCurvesShown;
    curves.areLimitsShown.value = isPrinted || (tab === 'plan' && (open === 'inspector' || ['pushes', 'floats'].includes(inspector)));
    if (!areCurvesShown) world.highlight.end();
  });
  return {
    drawer: () => drawer(world),
    sheet: () => sheet(world),
    limits: () => [limitsBlock(world), irradiationBlock(world)],
    basis: () => basisTable(world),
    printed: () => printed(world),
    stop() {
      stop();
      world.highlight.end();
      curves.stop();
    },
  };
}

/** Keeps the last value by name until one of what it is made from is another one. */
function memory() {
  const kept = new Map();
  return (name, from, make) => {
    const known = kept.get(name);
    if (known?.from.every((value, at) => value === from[at])) return known.value;
    const value = make();
    kept.set(name, { from, value });
    return value;
  };
}
