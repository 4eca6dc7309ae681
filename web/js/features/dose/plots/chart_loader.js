// The plots of dose, loaded when they are first wanted: their code, their style and uPlot are no part of what a first visit loads.
import { later } from '../../../parts/lazy.js';

export class ChartLoader {
  #parts;

  constructor(world) {
    this.#parts = later(async () => (await import('./charts.js')).makeCharts(world), 'lib/uplot.css', 'js/features/dose/plots/chart.css');
  }

  /** One part of the plots as a template. @param {'drawer'|'sheet'|'limits'|'basis'|'printed'} name */
  draw(name) {
    return this.#parts.draw((parts) => parts[name]());
  }

  stop() {
    this.#parts.loaded.peek()?.stop();
  }
}

/** True for a plan that has doses to plot. */
export const hasCharts = (plan) => (plan?.doses.length ?? 0) > 0;
