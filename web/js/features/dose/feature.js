// Dose: levels, lines, wash, surfaces, comparison, weights, pinned probes, plots. Little of it is part of a first visit: many plans do without.
import { html, nothing } from '../../../lib/lit-html.js';
import { icon } from '../../parts/icons.js';
import { known, later } from '../../parts/lazy.js';
import { DoseFacts } from './dose_facts.js';
import { doseTools } from './dose_tools.js';
import { ChartLoader, hasCharts } from './plots/chart_loader.js';
import { say } from './words.js';

const panels = later(() => import('./later_rows.js'));
const drawn = later(() => import('./later_drawn.js'), 'js/features/dose/dose.css', 'js/features/dose/legend.css');

/** Exports of later_rows.js; null for a plan without doses, and until it is loaded. */
const ofDose = (room) => (room.plan.value?.doses.length ? known(panels) : null);

/** Pins the values at the crosshair. */
async function pinHere(world, at) {
  if (!drawn.loaded.peek()) await drawn.load();
  drawn.loaded.peek()?.pinHere(world, at);
}

/** Exports of later_drawn.js; null while nothing of a dose is switched on and nothing is pinned, and until it is loaded. */
function ofDrawnDose(room) {
  const scene = room.scene.value;
  if (!room.plan.value?.doses.length || !scene?.dose) return null;
  const { wash, lines, surfaces, coverage, compare } = scene.dose;
  const isOn =
    wash.visible ||
    lines.visible ||
    surfaces.visible ||
    coverage.visible ||
    compare.mode !== 'none' ||
    Object.keys(scene.probes).length > 0;
  return isOn ? known(drawn) : null;
}

/** The action of a key of dose; without a dose it says so. */
const withDose = (act) => (world, at) => {
  const { room, ui } = world;
  if (!room.plan.value?.doses.length) ui.notify('ok', say.noDose, 'dose');
  const rows = ofDose(room);
  if (rows) act(world, at, rows);
};
const toggle = (part) => withDose(({ room, ui }, at, rows) => rows.toggleDose(room, ui, part, at));

/** @type {import('../index.js').Feature} */
export const dose = {
  make(world) {
    world.doses = new DoseFacts(world.room, world.api, world.clock, world.labelPx);
    world.charts = new ChartLoader(world);
  },
  start(world) {
    const stop = world.doses.start();
    return () => {
      stop();
      world.charts.stop();
    };
  },
  sections: [
    {
      id: 'doses',
      name: say.section,
      icon: 'dose',
      place: 4,
      has: (plan) => plan.doses.length,
      note: (world) => ofDose(world.room)?.doseNote(world) ?? '',
      rows: (world) => ofDose(world.room)?.doseRows(world),
    },
  ],
  kinds: { dose: 'doses', quantity: 'doses', dosing: 'doses', level: 'doses', legend: '' },
  blocks: later(() => import('./later_blocks.js'), 'js/features/dose/dose.css', 'js/features/dose/legend.css'),
  isSoon: true,
  tabs: [{ id: 'dvh', name: say.dvh, inSheet: hasCharts, draw: ({ charts }) => charts.draw('sheet') }],
  keys: { wash: toggle('wash'), lines: toggle('lines'), pin: withDose(pinHere) },
  drawer: { has: hasCharts, draw: ({ charts }) => charts.draw('drawer') },
  strip: {
    show: (world, size) => doseTools(world, (part, at) => ofDose(world.room)?.toggleDose(world.room, world.ui, part, at), size),
  },
  legend: (world) => ofDrawnDose(world.room)?.doseLegend(world),
  bannerName: (world) => ofDose(world.room)?.doseBasis(world, 'below'),
  bannerFacts: (world) => ofDose(world.room)?.doseBasis(world, 'aside'),
  planParts: ({ room, charts }) => (room.plan.value.doses.length ? charts.draw('limits') : nothing),
  probeTool: (world) =>
    ofDose(world.room)
      ? html`<button class="icon-button" title=${world.ui.keys.tip(say.pinIs, 'pin')} aria-label=${say.pin} ?disabled=${!world.room.canChange.value} @click=${(event) => pinHere(world, event.timeStamp)}>${icon('marker')}</button>`
      : nothing,
  probe: (world) => html`${ofDose(world.room)?.doseAtCrosshair(world)}${ofDrawnDose(world.room)?.pinsBlock(world)}`,
  here: (world) => ofDose(world.room)?.doseHere(world),
  pane: (world, view) => ({
    layer: ({ scene, plane, tolerance, header, box, pane }) => {
      const shown = ofDrawnDose(world.room);
      return html`${shown?.lineLabels({ world, view, header, box })}${shown?.pinMarks({ scene, plane, tolerance, header, box, pane })}`;
    },
  }),
};
