// A uPlot in an element of a template: html`<div ${plot(spec)}></div>`. It has the size of its element, and goes with it.
import { pageFactor } from '../../../parts/page_look.js';
import { nothing } from '../../../../lib/lit-html.js';
import { Directive, directive } from '../../../../lib/directive.js';
import UPlot from '../../../../lib/uplot.js';
import { visibleText } from '../../../parts/visible_text.js';

/** @param {number} size px of the canvas */
export const fontOf = (size, weight = 400) => `${weight} ${size}px "Inter Variable", system-ui, sans-serif`;
export const [axisInk, gridInk, faintInk, ink] = ['#929ba6', '#1f242b', '#39414b', '#eceef1'];

/**
 * @typedef {object} PlotSpec
 * @property {string} key another key makes another plot: what axes and series depend on
 * @property {() => object} options axes, scales and series of uPlot
 * @property {number[][]} data
 * @property {string} marks what else is drawn depends on this: another one draws it again
 * @property {(chart: UPlot, pen: CanvasRenderingContext2D, px: number) => void} [below] draws under the curves; px: device pixels of one CSS pixel
 * @property {(chart: UPlot, pen: CanvasRenderingContext2D, px: number) => void} [above] draws over them
 * @property {(place: {value: number, x: number, y: number, yValue: number}|null) => void} [pointed] the value of the first axis under the pointer, and the place in the plot; null: not there
 * @property {(place: {value: number, yValue: number}, event: MouseEvent) => void} [clicked]
 */

class PlotDirective extends Directive {
  #chart = null;
  #element = null;
  #spec = null;
  #observer = null;

  render() {
    return nothing;
  }

  /** @param {unknown[]} values the PlotSpec */
  update({ element }, [spec]) {
    const before = this.#spec;
    this.#spec = spec;
    if (!this.#element) {
      this.#element = element;
      this.#observer = new ResizeObserver(() => this.#fit());
      this.#observer.observe(element);
    } else if (before.key !== spec.key) this.#make();
    else if (this.#chart && before.data !== spec.data) this.#chart.setData(spec.data);
    else if (before.marks !== spec.marks) this.#chart?.redraw(false);
    return this.render();
  }

  #fit() {
    const { clientWidth: width, clientHeight: height, isConnected } = this.#element;
    if (!isConnected) return this.#drop(true);
    if (width < 40 || height < 40) return this.#drop();
    if (this.#chart) this.#chart.setSize({ width, height });
    else this.#make();
  }

  #drop(isForGood = false) {
    this.#chart?.destroy();
    this.#chart = null;
    if (isForGood) this.#observer.disconnect();
  }

  #make() {
    this.#drop();
    const { clientWidth: width, clientHeight: height } = this.#element;
    if (width < 40 || height < 40) return;
    const { axes, ...options } = this.#spec.options();
    const layer = (name) => (chart) => {
      chart.ctx.save();
      this.#spec[name]?.(chart, chart.ctx, UPlot.pxRatio);
      chart.ctx.restore();
    };
    this.#chart = new UPlot(
      {
        width,
        height,
        legend: { show: false },
        padding: [8, 12, 0, 0],
        cursor: {
          move: (_, left, top) => [left / pageFactor(), top / pageFactor()],
          y: false,
          drag: { x: false, y: false, setScale: false },
          points: { show: false },
          bind: { dblclick: () => null },
        },
        hooks: { drawAxes: [layer('below')], draw: [layer('above')], setCursor: [(chart) => this.#spec.pointed?.(placeOf(chart))] },
        axes: axes.map((axis) => ({
          stroke: axisInk,
          font: fontOf(11),
          grid: { stroke: gridInk, width: 1 },
          ticks: { show: false },
          border: { show: true, stroke: faintInk, width: 1 },
          ...axis,
        })),
        pxAlign: 0, // curves are not rounded to whole pixels
        ...options,
      },
      this.#spec.data,
      this.#element,
    );
    const { over } = this.#chart;
    over.addEventListener('click', (event) => {
      const place = this.#chart && placeOf(this.#chart);
      if (place) this.#spec.clicked?.(place, event);
    });
    over.addEventListener('pointerleave', () => this.#spec.pointed?.(null));
  }
}

function placeOf(chart) {
  const { left, top } = chart.cursor;
  if (!(left >= 0) || !(top >= 0)) return null;
  return {
    value: chart.posToVal(left, 'x'),
    yValue: chart.posToVal(top, 'y'),
    x: left + chart.over.offsetLeft,
    y: top + chart.over.offsetTop,
  };
}

export const plot = directive(PlotDirective);

/** Words in a plot, with a halo so that they can be read on curves. */
export function write(pen, px, text, x, y, { color = ink, align = 'left', weight = 400 } = {}) {
  pen.font = fontOf(Math.round(11 * px), weight);
  [pen.textAlign, pen.textBaseline, pen.lineJoin, pen.lineWidth, pen.strokeStyle, pen.fillStyle] = [
    align,
    'middle',
    'round',
    3 * px,
    '#14171b',
    color,
  ];
  pen.setLineDash([]);
  pen.strokeText(visibleText(text), x, y);
  pen.fillText(visibleText(text), x, y);
  return pen.measureText(text).width;
}

/** A dotted line from top to bottom. */
export function dotted(chart, pen, px, x) {
  const { top, height } = chart.bbox;
  [pen.strokeStyle, pen.lineWidth] = [ink, px];
  pen.setLineDash([2 * px, 3 * px]);
  pen.beginPath();
  pen.moveTo(x, top);
  pen.lineTo(x, top + height);
  pen.stroke();
  pen.setLineDash([]);
}

/** A slanted hatching between two edges over the same places. @param {number[]} xs @param {number[]} lows @param {number[]} highs */
export function hatched(pen, px, xs, lows, highs, color) {
  pen.save();
  pen.beginPath();
  xs.forEach((x, at) => (at ? pen.lineTo(x, highs[at]) : pen.moveTo(x, highs[at])));
  for (let at = xs.length - 1; at >= 0; at--) pen.lineTo(xs[at], lows[at]);
  pen.closePath();
  pen.clip();
  [pen.strokeStyle, pen.lineWidth, pen.globalAlpha] = [color, px, 0.55];
  const [top, bottom] = [Math.min(...highs), Math.max(...lows)];
  pen.beginPath();
  for (let x = xs[0] - (bottom - top); x < xs[xs.length - 1]; x += 7 * px) {
    pen.moveTo(x, bottom);
    pen.lineTo(x + bottom - top, top);
  }
  pen.stroke();
  pen.restore();
  [pen.strokeStyle, pen.lineWidth] = [color, px];
  pen.setLineDash([3 * px, 3 * px]);
  pen.beginPath();
  xs.forEach((x, at) => (at ? pen.lineTo(x, highs[at]) : pen.moveTo(x, highs[at])));
  pen.stroke();
  pen.setLineDash([]);
}

export function dot(pen, px, x, y, color) {
  [pen.fillStyle, pen.strokeStyle, pen.lineWidth] = [color, '#14171b', 1.5 * px];
  pen.beginPath();
  pen.arc(x, y, 3.5 * px, 0, 2 * Math.PI);
  pen.fill();
  pen.stroke();
}

/** A region's colour as it can be read on the dark panel: dark ones are lightened. */
export function legible(color) {
  const rgb = [1, 3, 5].map((at) => Number.parseInt(color.slice(at, at + 2), 16) / 255);
  const light = rgb
    .map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4))
    .reduce((sum, c, at) => sum + c * [0.2126, 0.7152, 0.0722][at], 0);
  const least = 0.2; // relative luminance: 4.5:1 on #14171b
  if (light >= least) return color;
  const part = ((least - light) / (1 - light)) * 1.15;
  return `#${rgb
    .map((c) =>
      Math.round(255 * Math.min(1, c + (1 - c) * Math.sqrt(part)))
        .toString(16)
        .padStart(2, '0'),
    )
    .join('')}`;
}
