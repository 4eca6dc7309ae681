// Turns pointer and keyboard input on a pane into changes of camera, crosshair, slice and window.
import * as cameras from '../view/camera.js';
import { fromPicture } from '../view/vec.js';
import { crosshair, crosshairPatch, shownImage, windowPresets } from '../state/plan.js';
import { homeCamera } from '../view/home.js';

const degreesPerPixel = 0.4;
const keyDegrees = 5;
const keyZoom = 1.15;
const wheelZoom = 1.12;
const dragZoomPerPixel = 0.006;

const looks = { 1: ['anterior', 'posterior'], 3: ['left', 'right'], 7: ['superior', 'inferior'] };

export class PaneActions {
  #room;
  #ui;
  #api;
  #number;

  /** @param {import('../state/room.js').RoomState} room @param {import('../state/ui.js').UiState} ui */
  constructor(room, ui, api, number) {
    this.#room = room;
    this.#ui = ui;
    this.#api = api;
    this.#number = number;
    this.box = { x: 0, y: 0, width: 1, height: 1 }; // position and size of the picture in the pane, CSS px
  }

  get view() {
    return this.#room.view(this.#number);
  }

  get is3d() {
    return this.view.kind === '3d';
  }

  get camera() {
    const home = homeCamera(this.#room.plan.value, this.view.kind);
    return cameras.completeCamera(this.view.document.value.camera, home);
  }

  get #size() {
    return [this.box.width, this.box.height];
  }

  // ---- pointer ------------------------------------------------------------------------------------------------------

  start = (mode, { x, y }) => {
    this.#ui.active.value = this.#number;
    if (mode === 'primary' && !this.is3d && this.#ui.tool.value === 'crosshair') this.#crosshairAt(x, y);
  };

  move = (mode, { x, y, dx, dy, at }) => {
    const tool = mode === 'primary' ? this.#ui.tool.value : mode;
    if (tool === 'pan') this.pan(dx, dy, at);
    else if (tool === 'zoom') this.zoom(Math.exp(-dy * dragZoomPerPixel), null, at);
    else if (this.is3d) this.orbit(-dx * degreesPerPixel, dy * degreesPerPixel, at);
    else if (tool === 'window') this.dragWindow(dx, dy, at);
    else this.#crosshairAt(x, y, at);
  };

  end = () => {};

  tap = ({ x, y, shift }) => {
    if (this.is3d && shift) this.#pick(x, y);
  };

  doubleTap = ({ touch, at }) => {
    if (touch) this.reset(at);
    else this.#ui.maximise(this.#number);
  };

  longPress = ({ x, y, at }) => {
    if (this.is3d) this.#pick(x, y);
    else this.#crosshairAt(x, y, at);
    this.#ui.tab.value = 'probe';
  };

  wheel = ({ x, y, steps, ctrl, at }) => {
    if (this.is3d || ctrl) this.zoom(wheelZoom ** -steps, [x, y], at);
    else this.stepSlice(-steps, at);
  };

  pinch = ({ x, y, dx, dy, factor, at }) => {
    const panned = this.#panned(this.camera, dx, dy);
    this.#set(this.#zoomed(panned, factor, [x, y]), at);
  };

  // ---- camera -------------------------------------------------------------------------------------------------------

  orbit(yawDeg, pitchDeg, at) {
    this.#set(cameras.orbit(this.camera, yawDeg, pitchDeg), at);
  }

  pan(dx, dy, at) {
    this.#set(this.#panned(this.camera, dx, dy), at);
  }

  zoom(factor, point, at) {
    this.#set(this.#zoomed(this.camera, factor, point), at);
  }

  reset(at) {
    this.#room.following.leave(); // before: the home camera is none that was seen in the shared view
    this.#set(homeCamera(this.#room.plan.value, this.view.kind), at);
  }

  lookFrom(name, at) {
    this.#set(cameras.lookFrom(this.camera, name), at);
  }

  setProjection(projection) {
    this.#set(cameras.project(this.camera, projection));
  }

  #panned(camera, dx, dy) {
    return this.is3d ? cameras.pan(camera, dx, dy, this.#size) : cameras.panSlice(camera, this.view.kind, dx, dy, this.#size);
  }

  #zoomed(camera, factor, point) {
    if (this.is3d) return cameras.zoom(camera, factor);
    const { x, y, width, height } = this.box;
    const fromMiddle = point ? [point[0] - x - width / 2, point[1] - y - height / 2] : [0, 0];
    return cameras.zoomSlice(camera, this.view.kind, factor, fromMiddle, this.#size);
  }

  #set(camera, at) {
    if (!this.#room.plan.value || JSON.stringify(camera) === JSON.stringify(this.camera)) return;
    this.#room.patchView(this.#number, { camera }, { at });
  }

  // ---- crosshair and slices -------------------------------------------------------------------------------------------

  #fraction(x, y) {
    return [(x - this.box.x) / this.box.width, (y - this.box.y) / this.box.height];
  }

  #crosshairAt(x, y, at) {
    const header = this.view.painted.value;
    const scene = this.#room.scene.value;
    if (!header || !scene) return;
    this.#moveCrosshair(fromPicture(header.clip_from_lps_mm, this.#fraction(x, y), crosshair(scene)), at);
  }

  #moveCrosshair(point, at) {
    const { scene, plan } = this.#room;
    const before = crosshair(scene.value);
    const patch = crosshairPatch(plan.value, shownImage(plan.value, scene.value), point);
    const { sagittal, coronal, axial } = patch.image.slices;
    if (sagittal.position_mm === before[0] && coronal.position_mm === before[1] && axial.position_mm === before[2]) return;
    this.#room.patchScene(patch, { view: this.#number, at });
  }

  async #pick(x, y) {
    const header = this.view.painted.value;
    const { size_px: size } = this.view.document.value;
    if (!header || !size) return;
    const [u, v] = this.#fraction(x, y);
    try {
      const { hits } = await this.#api.pick(this.#room.planId.value, this.#room.id, this.view.document.value, u * size[0], v * size[1]);
      if (hits.length) this.#moveCrosshair(hits[0].point_lps_mm);
    } catch (error) {
      this.#ui.notify('err', error.message);
    }
  }

  get #axis() {
    return cameras.planes[this.view.kind].axis;
  }

  /** Moves by whole slices of the image; the camera stays. */
  stepSlice(steps, at) {
    const { plan, scene } = this.#room;
    if (!scene.value) return;
    const step = shownImage(plan.value, scene.value)?.stepMm[this.#axis] ?? 1;
    this.setSlice(crosshair(scene.value)[this.#axis] + steps * step, at);
  }

  setSlice(positionMm, at) {
    const point = crosshair(this.#room.scene.value);
    point[this.#axis] = positionMm;
    this.#moveCrosshair(point, at);
  }

  // ---- window and level -------------------------------------------------------------------------------------------------

  dragWindow(dx, dy, at) {
    const { window } = this.#room.scene.value.image;
    const step = Math.max(window.width, 1) / 250;
    this.setWindow({ center: window.center - dy * step, width: Math.max(window.width + dx * step, 1) }, at);
  }

  setWindow({ center, width }, at) {
    const round = (value) => Math.round(value * 10) / 10;
    this.#room.patchScene({ image: { window: { center: round(center), width: round(width) } } }, { view: this.#number, at });
  }

  // ---- keys of the focused pane -------------------------------------------------------------------------------------------

  /** @param {KeyboardEvent} event @returns {boolean} whether the key was used */
  key(event) {
    if (event.altKey || event.metaKey || event.ctrlKey) return false;
    const at = event.timeStamp;
    const act = this.#keyAction(event, at);
    if (!act || !this.#room.canChange.value) return false;
    act();
    return true;
  }

  #keyAction({ key, code, shiftKey }, at) {
    const preset = windowPresets(shownImage(this.#room.plan.value, this.#room.scene.value)).find((other) => other.key === key);
    const look = /^Numpad[137]$/.test(code) && this.is3d ? looks[code.at(-1)][shiftKey ? 1 : 0] : null;
    if (look) return () => this.lookFrom(look, at);
    if (preset && code.startsWith('Digit')) return () => this.setWindow(preset, at);
    const arrows = this.is3d
      ? { ArrowLeft: () => this.orbit(keyDegrees, 0, at), ArrowRight: () => this.orbit(-keyDegrees, 0, at),
          ArrowUp: () => this.orbit(0, -keyDegrees, at), ArrowDown: () => this.orbit(0, keyDegrees, at) }
      : { ArrowUp: () => this.stepSlice(1, at), ArrowRight: () => this.stepSlice(1, at),
          ArrowDown: () => this.stepSlice(-1, at), ArrowLeft: () => this.stepSlice(-1, at),
          PageUp: () => this.stepSlice(10, at), PageDown: () => this.stepSlice(-10, at) };
    const common = {
      '+': () => this.zoom(keyZoom, null, at), '=': () => this.zoom(keyZoom, null, at), '-': () => this.zoom(1 / keyZoom, null, at),
      r: () => this.reset(at), ' ': () => this.reset(at),
      f: () => this.#room.following.toggle(),
      w: () => this.#toggleTool('window'), z: () => this.#toggleTool('zoom'),
      Enter: () => this.#ui.maximise(this.#number),
    };
    return arrows[key] ?? common[key.length === 1 ? key.toLowerCase() : key] ?? null;
  }

  #toggleTool(tool) {
    this.#ui.tool.value = this.#ui.tool.value === tool ? 'crosshair' : tool;
  }
}

/** Position and size of a picture in a pane: as large as fits, aspect ratio kept. */
export function fitBox([paneWidth, paneHeight], [width, height]) {
  const k = Math.min(paneWidth / width, paneHeight / height);
  const box = { width: width * k, height: height * k };
  return { x: (paneWidth - box.width) / 2, y: (paneHeight - box.height) / 2, ...box };
}
