// Measures in one pane: drawn by pointer and keys, their points dragged, those of the pane's plane shown.
import { circle, freeId, halfVoxelMm, isIn, listed, mostMeasures, mostPoints, pointsOf, pointsToDraw, withPoint } from './measures.js';
import { nearestIn, planeOfView } from '../../room/obliques.js';
import { crosshair, shownImage } from '../../room/plan.js';
import { isInSpace } from '../../room/kinds.js';
import { measureOverlay } from './measure_overlay.js';
import { toPicture } from '../../parts/vec.js';
import { measureName, valueTexts } from './measure_words.js';
import { say } from './drawn_words.js';

const [mousePx, fingerPx] = [10, 22]; // how far from a point a press still takes it
const samePx = 4;
const linePx = 6; // how far from a line a click still chooses the measure

export class PaneMeasures {
  #world;
  #view;
  #box;
  #pointAt;
  #pressed = null; // where a press began that draws
  #grabbed = null; // {id, index}: the point that is dragged
  #isDrag = false;
  #last = null; // where the pointer is, CSS px

  /** @param {object} world {room, ui, ellipses} @param {() => object} box of the picture @param {(x, y) => number[]|null} pointAt */
  constructor(world, view, box, pointAt) {
    this.#world = world;
    this.#view = view;
    this.#box = box;
    this.#pointAt = pointAt;
  }

  get #scene() {
    return this.#world.room.scene.value;
  }

  get #plane() {
    return this.#scene && !isInSpace(this.#view.kind)
      ? planeOfView(this.#scene, this.#view.document.value, this.#world.room.plan.value)
      : null;
  }

  get #isTool() {
    return this.#world.ui.tool.value === 'measure' && !isInSpace(this.#view.kind);
  }

  get #draft() {
    const { value } = this.#world.ui.draft;
    return value?.view === this.#view.number ? value : null;
  }

  /** The measures that this pane shows: [id, measure][]. */
  get #shown() {
    const { room } = this.#world;
    const entries = Object.entries(this.#scene?.measures ?? {}).filter(([, { visible, points }]) => visible && points.length);
    const plane = this.#plane;
    if (!plane) return entries;
    const half = halfVoxelMm(shownImage(room.plan.value, this.#scene), plane.normal);
    return entries.filter(([, measure]) => isIn(pointsOf(measure), plane, half));
  }

  #pixel(point) {
    const header = this.#view.painted.value;
    const at = header && toPicture(header.clip_from_lps_mm, point);
    const box = this.#box();
    return at && { x: box.x + at[0] * box.width, y: box.y + at[1] * box.height };
  }

  #isChosen(id) {
    const { value } = this.#world.ui.selection;
    return value.kind === 'measure' && value.id === id;
  }

  // ---- picture ------------------------------------------------------------------------------------------------------------------

  layer({ header, box, pane }) {
    const is3d = isInSpace(this.#view.kind);
    const measures = this.#shown.map(([id, measure]) => ({
      id,
      kind: measure.kind,
      points: pointsOf(measure),
      isChosen: this.#isChosen(id),
      hasHandles: this.#isTool || this.#isChosen(id),
      texts: [...(measure.name ? [measureName(id, measure)] : []), ...valueTexts(this.#world, id, measure)],
    }));
    const draft = this.#draft;
    if (draft) {
      const points = this.#completed(draft, draft.at ? [...draft.points, draft.at] : draft.points);
      measures.push({
        id: 'draft',
        kind: draft.kind,
        points,
        isChosen: true,
        hasHandles: true,
        texts: valueTexts(this.#world, '', { kind: draft.kind, points: listed(points) }),
      });
    }
    return measures.length
      ? measureOverlay({ measures, is3d, matrix: header.clip_from_lps_mm, box, pane, mark: this.#pixel(crosshair(this.#scene)) })
      : null;
  }

  /** An ellipse is a circle until its points are dragged. */
  #completed({ kind }, points) {
    return kind === 'ellipse' && points.length === 2 ? circle(points, this.#plane.normal) : points;
  }

  // ---- pointer: each returns whether it was for measures ------------------------------------------------------------------------

  start(mode, { x, y }) {
    this.#pressed = null;
    this.#grabbed = null;
    this.#isDrag = false;
    this.#last = { x, y };
    if (mode !== 'primary' || isInSpace(this.#view.kind) || !this.#world.room.canChange.value) return false;
    this.#grabbed = this.#draft ? null : this.#nearPoint(x, y);
    if (!this.#grabbed && this.#isTool) this.#pressed = { x, y };
    if (this.#grabbed) this.#world.ui.select('measure', this.#grabbed.id);
    return Boolean(this.#grabbed || this.#pressed);
  }

  move(mode, { x, y, at }) {
    if (mode !== 'primary' || (!this.#grabbed && !this.#pressed)) return false;
    this.#last = { x, y };
    if (this.#grabbed) this.#dragPoint(x, y, at);
    else {
      if (!this.#isDrag && !this.#draft) this.#add(this.#pressed.x, this.#pressed.y, at);
      this.#preview(x, y);
    }
    this.#isDrag = true;
    return true;
  }

  end(at) {
    if (this.#pressed) {
      const { x, y } = this.#last;
      this.#pressed = null;
      this.#add(x, y, at);
    }
    this.#grabbed = null;
  }

  /** A finger that is lifted begins its press only then: pointer.js. */
  tap({ x, y, shift, at }) {
    if (shift) return false;
    const wasPressed = this.#pressed;
    this.#pressed = null;
    if (wasPressed) this.#add(x, y, at);
    if (this.#isTool) return true;
    const id = this.#nearLine(x, y);
    if (id) this.#world.ui.select('measure', id, false);
    return Boolean(id);
  }

  doubleTap({ x, y, at }) {
    if (!this.#isTool) return false;
    this.#pressed = null;
    if (this.#draft?.kind === 'polyline') {
      this.#add(x, y, at);
      this.#finish(at);
    }
    return true;
  }

  hover({ x, y }) {
    if (this.#draft) this.#preview(x, y);
    return this.#isTool;
  }

  /** Enter sets a point at the crosshair, Backspace takes the last one back. @param {number[]} mark where the crosshair was when the key was pressed */
  key({ key }, at, mark = crosshair(this.#scene)) {
    if (!this.#isTool || !['Enter', 'Backspace'].includes(key)) return null;
    if (key === 'Enter') return () => this.#addPoint(nearestIn(this.#plane, mark), at);
    return this.#draft
      ? () => this.#set(this.#draft.points.length > 1 ? { ...this.#draft, points: this.#draft.points.slice(0, -1) } : null)
      : null;
  }

  // ---- drawing --------------------------------------------------------------------------------------------------------------------

  #set(draft) {
    this.#world.ui.draft.value = draft;
  }

  #placed(x, y) {
    const [point, plane] = [this.#pointAt(x, y), this.#plane];
    return point && plane && nearestIn(plane, point);
  }

  #preview(x, y) {
    const point = this.#placed(x, y);
    if (point) this.#set({ ...this.#draft, at: point });
  }

  #add(x, y, at) {
    const point = this.#placed(x, y);
    if (point) this.#addPoint(point, at);
  }

  #addPoint(point, at) {
    const { ui } = this.#world;
    const draft = this.#draft ?? { view: this.#view.number, kind: ui.measureKind.value, points: [] };
    const [last, now] = [draft.points.length ? this.#pixel(draft.points.at(-1)) : null, this.#pixel(point)];
    const isSame = last && now && Math.hypot(last.x - now.x, last.y - now.y) <= samePx;
    if (isSame) {
      if (draft.kind === 'polyline' && draft.points.length > 1) this.#finish(at);
      return;
    }
    this.#set({ ...draft, points: [...draft.points, point], at: null });
    if (this.#draft.points.length >= Math.min(pointsToDraw(draft.kind), mostPoints)) this.#finish(at);
  }

  #finish(at) {
    const { room, ui } = this.#world;
    const draft = this.#draft;
    this.#set(null);
    if (!draft || draft.points.length < 2) return;
    const id = freeId(this.#scene.measures, room.sharesMarks, room.markSuffix);
    if (Object.keys(this.#scene.measures).length >= mostMeasures) return void ui.notify('warn', say.full({ n: mostMeasures }), 'measures');
    room.patchScene(newMeasure(id, draft.kind, this.#completed(draft, draft.points), shownImage(room.plan.value, this.#scene)), {
      view: this.#view.number,
      at,
    });
    ui.select('measure', id);
  }

  // ---- points that are there --------------------------------------------------------------------------------------------------------

  #dragPoint(x, y, at) {
    const { room } = this.#world;
    const { id, index } = this.#grabbed;
    const measure = this.#scene.measures[id];
    const point = this.#placed(x, y);
    if (!measure || !point) return;
    room.patchScene(
      { measures: { [id]: { points: listed(withPoint(measure.kind, pointsOf(measure), index, point)) } } },
      { view: this.#view.number, at },
    );
  }

  /** With the tool the points of all measures, without it those of the chosen one. */
  #nearPoint(x, y) {
    let best = { px: this.#world.ui.window.value.isCoarse ? fingerPx : mousePx, found: null };
    for (const [id, measure] of this.#shown.filter(([other]) => this.#isTool || this.#isChosen(other)))
      for (const [index, point] of pointsOf(measure).entries()) {
        const at = this.#pixel(point);
        const px = at ? Math.hypot(at.x - x, at.y - y) : Infinity;
        if (px < best.px) best = { px, found: { id, index } };
      }
    return best.found;
  }

  /** The measure whose points or straight lines run through a place. */
  #nearLine(x, y) {
    if (isInSpace(this.#view.kind)) return '';
    return (
      this.#shown.find(([, measure]) => {
        const places = pointsOf(measure)
          .map((point) => this.#pixel(point))
          .filter(Boolean);
        const ends =
          measure.kind === 'ellipse' ? places.slice(1).map((end) => [places[0], end]) : places.slice(1).map((end, at) => [places[at], end]);
        return ends.some(([a, b]) => fromSegment(a, b, { x, y }) <= linePx);
      })?.[0] ?? ''
    );
  }
}

/** The patch that makes a measure; written whole, so that undo finds it as it was made. */
export const newMeasure = (id, kind, points, image) => ({
  measures: { [id]: { kind, name: '', visible: true, image: image?.id ?? '', points: listed(points) } },
});

function fromSegment(a, b, { x, y }) {
  const [dx, dy] = [b.x - a.x, b.y - a.y];
  const part = Math.min(Math.max(((x - a.x) * dx + (y - a.y) * dy) / (dx * dx + dy * dy || 1), 0), 1);
  return Math.hypot(a.x + part * dx - x, a.y + part * dy - y);
}
