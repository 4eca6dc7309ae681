// Turns pointer and keyboard input on a pane into changes of camera, crosshair, slice and window.
import * as cameras from '../view/camera.js';
import { crosshair, crosshairPatch, shownImage } from '../state/plan.js';
import { Pointed } from '../state/pointed.js';
import { homeCamera } from '../view/home.js';
import { PanePick } from './pane_pick.js';
import { PaneWindow } from './pane_window.js';

const degreesPerPixel = 0.4;
const keyDegrees = 5;
const keyZoom = 1.15;
const keyPanPx = 24;
const wheelZoom = 1.12;
const dragZoomPerPixel = 0.006;

const looks = { 1: ['anterior', 'posterior'], 3: ['left', 'right'], 7: ['superior', 'inferior'] };

export class PaneActions {
  #room;
  #ui;
  #number;
  #pick;
  #isPicking = false; // the crosshair follows the pointer in 3-D; one question at a time
  #nextPick = null;

  /** @param {import('../state/room.js').RoomState} room @param {import('../state/ui.js').UiState} ui */
  constructor(room, ui, api, number, histograms) {
    this.#room = room;
    this.#ui = ui;
    this.#number = number;
    this.box = { x: 0, y: 0, width: 1, height: 1 }; // position and size of the picture in the pane, CSS px
    this.window = new PaneWindow(room, histograms, number);
    this.#pick = new PanePick(room, api, this.view, () => this.box);
    this.pointed = new Pointed((x, y) => this.#pick.factsAt(x, y));
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

  start = () => {
    this.#ui.active.value = this.#number;
    this.pointed.hide();
  };

  move = (mode, { x, y, dx, dy, alt, at }) => {
    const tool = mode === 'primary' ? this.#ui.tool.value : mode;
    if (tool === 'pan') this.pan(dx, dy, at);
    else if (tool === 'zoom') this.zoom(Math.exp(-dy * dragZoomPerPixel), null, at);
    else if (this.is3d) this.orbit(-dx * degreesPerPixel, dy * degreesPerPixel, at);
    else if (tool === 'window') this.window.drag(dx, dy, at);
    else this.#crosshairAt(x, y, at, alt);
  };

  end = () => {};

  tap = ({ x, y, shift, alt, at }) => {
    if (shift) {
      if (this.is3d) this.#crosshairToSeen(x, y, at);
      return;
    }
    if (!this.is3d && this.#ui.tool.value === 'crosshair') this.#crosshairAt(x, y, at, alt);
    this.#selectAt(x, y);
  };

  doubleTap = ({ touch, at }) => {
    if (touch) this.reset(at);
    else this.#ui.maximise(this.#number);
  };

  /** Probes there: crosshair and values in a card beside the finger. Opens no panel, as the picture would move away. */
  longPress = async ({ x, y, at }) => {
    this.#ui.active.value = this.#number;
    this.#ui.tab.value = 'probe';
    this.pointed.hide();
    try {
      const hit = this.is3d ? await this.#crosshairToSeen(x, y, at) : null;
      if (!this.is3d) this.#crosshairAt(x, y, at);
      const facts = this.is3d ? hit && await this.#pick.factsOf(hit) : await this.#pick.factsAt(x, y);
      if (facts) this.pointed.hold(x, y, facts);
    } catch (error) {
      this.#ui.notify('err', error.message);
    }
  };

  hover = ({ x, y, shift, alt, at }) => {
    if (!shift) return this.pointed.hover(x, y);
    this.pointed.hide();
    if (!this.#room.canChange.value) return;
    if (this.is3d) this.#followPointer(x, y, at);
    else this.#crosshairAt(x, y, at, alt);
  };

  leave = () => {
    if (!this.pointed.shown.peek()?.isHeld) this.pointed.hide();
  };

  wheel = ({ x, y, steps, ctrl, at }) => {
    if (this.is3d || ctrl) this.zoom(wheelZoom ** -steps, [x, y], at);
    else this.stepSlice(-steps, at);
  };

  pinch = ({ x, y, dx, dy, factor, at }) => {
    this.pointed.hide();
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

  /** isFree: anywhere, not only on the middles of voxels. */
  #crosshairAt(x, y, at, isFree = false) {
    const point = this.#pick.pointAt(x, y);
    if (point) this.#moveCrosshair(point, at, isFree);
  }

  #moveCrosshair(point, at, isFree = false) {
    const { scene, plan } = this.#room;
    const before = crosshair(scene.value);
    const patch = crosshairPatch(plan.value, shownImage(plan.value, scene.value), point, { isFree });
    const { sagittal, coronal, axial } = patch.image.slices;
    if (sagittal.position_mm === before[0] && coronal.position_mm === before[1] && axial.position_mm === before[2]) return;
    this.#room.patchScene(patch, { view: this.#number, at });
  }

  /** Moves the crosshair to what is seen in 3-D, to the selected region where that can be seen. Returns the hit. */
  async #crosshairToSeen(x, y, at) {
    try {
      const hit = await this.#pick.seenAt(x, y, this.#ui.region.value);
      if (hit) this.#moveCrosshair(hit.point_lps_mm, at);
      return hit;
    } catch (error) {
      this.#ui.notify('err', error.message);
      return null;
    }
  }

  /** The same for a pointer that moves: one question at a time, and then the newest place. */
  async #followPointer(x, y, at) {
    this.#nextPick = [x, y, at];
    if (this.#isPicking) return;
    this.#isPicking = true;
    while (this.#nextPick) {
      const place = this.#nextPick;
      this.#nextPick = null;
      await this.#crosshairToSeen(...place);
    }
    this.#isPicking = false;
  }

  /** Selects the region that is seen at a place; the crosshair stays. */
  async #selectAt(x, y) {
    try {
      const hit = await this.#pick.seenAt(x, y);
      if (hit) this.#ui.select(hit.region === null ? 'image' : 'region', hit.region ?? shownImage(this.#room.plan.value, this.#room.scene.value)?.id, this.is3d);
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

  // ---- keys of the focused pane -------------------------------------------------------------------------------------------

  /** @param {KeyboardEvent} event @returns {boolean} whether the key was used */
  key(event) {
    if (event.altKey || event.metaKey) return false;
    const at = event.timeStamp;
    const act = event.ctrlKey ? this.#panKey(event.key, at) : this.#keyAction(event, at);
    if (!act || !this.#room.canChange.value) return false;
    this.pointed.hide();
    act();
    return true;
  }

  #panKey(key, at) {
    const [dx, dy] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[key] ?? [];
    return dx === undefined ? null : () => this.pan(dx * keyPanPx, dy * keyPanPx, at);
  }

  #keyAction({ key, code, shiftKey }, at) {
    const look = /^Numpad[137]$/.test(code) && this.is3d ? looks[code.at(-1)][shiftKey ? 1 : 0] : null;
    if (look) return () => this.lookFrom(look, at);
    if (/^[1-5]$/.test(key) && code.startsWith('Digit') && this.window.image) return () => this.window.setPreset(key, at);
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
