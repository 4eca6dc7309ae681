// Snapshots, and the report to print.
import { html } from '../../../lib/lit-html.js';
import { signal } from '../../../lib/signals-core.js';
import { Printout } from './report_pages.js';
import { code, listenSnapshots, resumeSnapshot, snapshotMenu } from './snapshots.js';

/** @type {import('../index.js').Feature} */
export const report = {
  make(world) {
    world.printout = new Printout(world.room.id, world.api, globalThis.sessionStorage);
    world.otherPlan = signal(null);
    world.printoutDialog = signal(null);
    world.filmDialog = signal(null);
  },
  start(world) {
    const stops = [listenSnapshots(world), resumeSnapshot(world)];
    return () => stops.forEach((stop) => stop());
  },
  dialogs: ['printout', 'other-plan', 'film'],
  dialog: (world) =>
    html`${code.loaded.value?.otherPlanDialog(world)}${world.printoutDialog.value?.(world)}${world.filmDialog.value?.(world)}`,
  strip: { end: snapshotMenu },
};
