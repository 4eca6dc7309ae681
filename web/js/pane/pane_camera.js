// The camera of one pane: what turns, moves and zooms it, alone or together with other panes.
import { crosshair } from '../room/plan.js';
import { planeOfView } from '../room/obliques.js';
import * as cameras from '../room/camera.js';
import { homeCamera } from '../room/home.js';
import { isInSpace, isTurnable } from '../room/kinds.js';

const keyPanPx = 24;
const lockedAxes = { L: [1, 0, 0], P: [0, 1, 0], S: [0, 0, 1] };

export class PaneCamera {
  #room;
  #ui;
  #number;
  #box;

  /** @param {import('../room/room.js').RoomState} room @param {import('../room/ui.js').UiState} ui @param {() => {x: number, y: number, width: number, height: number}} box of the picture in the pane, CSS px */
  constructor(room, ui, number, box) {
    this.#room = room;
    this.#ui = ui;
    this.#number = number;
    this.#box = box;
  }

  get #view() {
    return this.#room.view(this.#number);
  }

  get is3d() {
    return isInSpace(this.#view.kind);
  }

  /** With the home camera's fields where the document has none. */
  get value() {
    return this.#of(this.#view);
  }

  #of(view) {
    return cameras.completeCamera(view.document.value.camera, homeCamera(this.#room.plan.value, view.kind));
  }

  /** The plane of a slice pane. */
  get plane() {
    return planeOfView(this.#room.scene.value, this.#view.document.value, this.#room.plan.value);
  }

  get #size() {
    const { width, height } = this.#box();
    return [width, height];
  }

  orbit(yawDeg, pitchDeg, at) {
    const axis = lockedAxes[this.#ui.turnLock.value];
    this.set(axis ? cameras.orbitAbout(this.value, axis, yawDeg, pitchDeg) : cameras.orbit(this.value, yawDeg, pitchDeg), at);
  }

  roll(angleDeg, at) {
    if (this.is3d) this.set(cameras.roll(this.value, angleDeg), at);
  }

  /** Rolls as the pointer goes around the picture's middle; x, y: where it is now. */
  rollBy(x, y, dx, dy, at) {
    const box = this.#box();
    const [fromX, fromY] = [x - box.x - box.width / 2, y - box.y - box.height / 2];
    const angle = Math.atan2(fromY, fromX) - Math.atan2(fromY - dy, fromX - dx);
    this.roll((Math.atan2(Math.sin(angle), Math.cos(angle)) * -180) / Math.PI, at);
  }

  pan(dx, dy, at) {
    this.set(this.#panned(this.value, dx, dy), at);
  }

  /** Pans by keys: -1, 0 or 1 to the right and down. */
  panStep(right, down, at) {
    this.pan(right * keyPanPx, down * keyPanPx, at);
  }

  /** @param {number[]|null} point that stays where it is, px in the pane; null: the middle */
  zoom(factor, point, at) {
    this.set(this.#zoomed(this.value, factor, point), at);
  }

  pinch({ x, y, dx, dy, factor }, at) {
    this.set(this.#zoomed(this.#panned(this.value, dx, dy), factor, [x, y]), at);
  }

  reset(at) {
    this.#room.following.leave(); // before: the home camera is none that was seen in the shared view
    this.set(homeCamera(this.#room.plan.value, this.#view.kind), at);
  }

  /** Frames what is selected: a region or a measure; else the whole. */
  fit(at) {
    const box = boxOfSelection(this.#ui.selection.value, this.#room.plan.value, this.#room.scene.value);
    if (!box) return void this.reset(at);
    this.#room.following.leave(); // as reset()
    this.set(this.is3d ? cameras.fit(this.value, box) : cameras.fitSlice(this.value, this.plane, box), at);
  }

  lookFrom(name, at) {
    if (this.is3d) this.set(cameras.lookFrom(this.value, name), at);
  }

  setProjection(projection, at) {
    this.set(cameras.project(this.value, projection), at);
  }

  #panned(camera, dx, dy) {
    return this.is3d ? cameras.pan(camera, dx, dy, this.#size) : cameras.panSlice(camera, this.plane, dx, dy, this.#size);
  }

  #zoomed(camera, factor, point) {
    if (this.is3d) return cameras.zoom(camera, factor);
    const { x, y, width, height } = this.#box();
    const fromMiddle = point ? [point[0] - x - width / 2, point[1] - y - height / 2] : [0, 0];
    return cameras.zoomSlice(camera, this.plane, factor, fromMiddle, this.#size);
  }

  /** Gives this pane the camera, and those that are linked with it theirs. isStep: undo takes it back. */
  set(camera, at, isStep = true) {
    if (!this.#room.plan.value || JSON.stringify(camera) === JSON.stringify(this.value)) return;
    this.#room.patchViews([[this.#number, { camera }], ...this.#linked(camera).map(([number, other]) => [number, { camera: other }])], {
      at,
      isStep,
    });
  }

  /** Makes the linked panes go with this one at once. */
  link(at) {
    this.#room.patchViews(
      this.#linked(this.value).map(([number, camera]) => [number, { camera }]),
      { at },
    );
  }

  #linked(camera) {
    const { panes } = this.#ui;
    const others = this.#room.views.filter(({ number, isOpen }) => number !== this.#number && isOpen.value);
    if (this.is3d)
      return panes.areCamerasLinked.value ? others.filter(({ kind }) => isTurnable(kind)).map(({ number }) => [number, { ...camera }]) : [];
    const scene = this.#room.scene.value;
    if (!panes.isZoomLinked.value || !scene) return [];
    const sizeOf = (view) => view.document.value.size_px ?? view.ownSize ?? [1, 1];
    return others
      .filter(({ kind }) => !isInSpace(kind))
      .map((view) => [
        view.number,
        cameras.linkedSlice(
          camera,
          this.plane,
          sizeOf(this.#view),
          this.#of(view),
          planeOfView(scene, view.document.value, this.#room.plan.value),
          sizeOf(view),
          crosshair(scene),
        ),
      ]);
  }
}

const leastMm = 10; // a box is framed as if it were at least so large

/** The box of the selected region or measure; null: nothing with a place is selected. */
export function boxOfSelection({ kind, id }, plan, scene) {
  const region = kind === 'region' ? plan?.regions.find((other) => other.id === id) : null;
  const points = kind === 'measure' ? (scene?.measures?.[id]?.points ?? []) : [];
  const ends = region?.bounds_mm ? [region.bounds_mm.low, region.bounds_mm.high] : points.map(({ at_mm }) => at_mm);
  if (!ends.length) return null;
  const along = (pick) => [0, 1, 2].map((axis) => pick(...ends.map((end) => end[axis])));
  const [low, high] = [along(Math.min), along(Math.max)];
  const lacking = low.map((value, axis) => Math.max(0, leastMm - (high[axis] - value)) / 2);
  return { low: low.map((value, axis) => value - lacking[axis]), high: high.map((value, axis) => value + lacking[axis]) };
}
