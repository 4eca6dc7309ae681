// How this person has arranged the panes: the layout, which view stands in which pane, what moves together. Kept by the browser.
import { effect, signal } from '../../lib/signals-core.js';
import { readSplits } from './splits.js';
import { say } from './words.js';

const key = 'beamroom panes';

/** Every view of a room by its number; a pane shows one of them. `nameWithin` is the name within a sentence, `number` that of the view document. */
export const views = [
  { kind: '3d', name: '3-D', nameWithin: '3-D' },
  { kind: 'axial', name: say.axial, nameWithin: say.axialWithin },
  { kind: 'sagittal', name: say.sagittal, nameWithin: say.sagittalWithin },
  { kind: 'coronal', name: say.coronal, nameWithin: say.coronalWithin },
  { kind: 'oblique', name: say.oblique, nameWithin: say.obliqueWithin },
  { kind: '3d', name: '3-D 2', nameWithin: '3-D 2', number: 2 },
  { kind: 'beam', name: say.beam, nameWithin: say.beamWithin },
  { kind: 'beam-slice', name: say.beamSlice, nameWithin: say.beamSliceWithin },
];
export const obliqueView = 5;
export const beamView = 7;
export const beamSliceView = 8;
const standard = { two: [1, 2], four: [1, 2, 3, 4] };

/** In the order of the strip and of the keys Shift + 1 to 7, the last in plans with a beam. @type {{id: string, name: string, icon: string, layout: string, two?: number[]}[]} */
export const layouts = [
  { id: 'row', name: say.row, icon: 'row', layout: 'row' },
  { id: '2x2', name: say.four, icon: 'grid', layout: '2x2' },
  { id: '1+3', name: say.oneThree, icon: 'oneThree', layout: '1+3' },
  { id: '2x1', name: say.two, icon: 'two', layout: '2x1', two: [1, 2] },
  { id: 'oblique', name: say.twoOblique, icon: 'twoOblique', layout: '2x1', two: [1, obliqueView] },
  { id: 'single', name: say.one, icon: 'single', layout: 'single' },
  { id: 'beam', name: say.twoBeam, icon: 'twoBeam', layout: '2x1', two: [beamView, beamSliceView] },
];

/** The panes' views after the pane that shows one view is to show another: where that one stands already, they change places. */
export const placed = (cells, from, to) => cells.map((view) => (view === from ? to : view === to ? from : view));

/** The layout of its own that two views have. */
const pairOf = (two) => layouts.find((other) => other.id !== '2x1' && other.two?.join() === two.join())?.id;

/** Which of the layouts that is; '' for one without a button. */
export function layoutId(layout, two) {
  if (layout === '1x2' || layout === '2x1') return pairOf(two) ?? '2x1';
  return layout === 'row4' ? '1+3' : layout;
}

const isCells = (cells, n) =>
  Array.isArray(cells) &&
  cells.length === n &&
  new Set(cells).size === n &&
  cells.every((view) => Number.isInteger(view) && view >= 1 && view <= views.length);

export class Layout {
  /** @param {{getItem: Function, setItem: Function}|null} storage null where the browser keeps nothing */
  constructor(storage = null) {
    const kept = read(storage);
    this.layout = signal(['', ...layouts.map(({ layout }) => layout)].includes(kept.layout) ? kept.layout : ''); // '' as suits the window
    this.two = signal(isCells(kept.two, 2) ? kept.two : standard.two);
    this.four = signal(isCells(kept.four, 4) ? kept.four : standard.four);
    this.isZoomLinked = signal(kept.isZoomLinked === true); // slice panes share mm per pixel and where the crosshair stands
    this.areCamerasLinked = signal(kept.areCamerasLinked === true); // the two 3-D views turn together
    this.isBeamTogether = signal(kept.isBeamTogether !== false); // beam slice and clip plane slide together
    this.splits = signal(readSplits(kept.splits)); // by the keys of splits.js
    effect(() =>
      write(storage, {
        layout: this.layout.value,
        two: this.two.value,
        four: this.four.value,
        isZoomLinked: this.isZoomLinked.value,
        areCamerasLinked: this.areCamerasLinked.value,
        isBeamTogether: this.isBeamTogether.value,
        splits: this.splits.value,
      }),
    );
  }

  /** @param {string} id of `layouts` */
  choose(id) {
    const { layout, two } = layouts.find((other) => other.id === id);
    if (two && !(id === '2x1' && !pairOf(this.two.value))) this.two.value = two; // two panes keep what was put into them
    this.layout.value = layout;
  }

  /** The pane of the arrangement shown that has this view is to show another. @param {string} layout of the arrangement */
  place(layout, from, to) {
    const cells = layout === '2x1' || layout === '1x2' ? this.two : this.four;
    cells.value = cells.value.includes(from) ? placed(cells.value, from, to) : cells.value;
  }
}

function read(storage) {
  try {
    const kept = JSON.parse(storage?.getItem(key) ?? '{}');
    return kept && typeof kept === 'object' ? kept : {};
  } catch {
    return {};
  }
}

function write(storage, kept) {
  try {
    storage?.setItem(key, JSON.stringify(kept));
  } catch {
    // a browser that keeps nothing starts with the standard next time
  }
}
