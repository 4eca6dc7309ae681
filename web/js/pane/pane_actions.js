// Turns pointer and keyboard input on a pane into changes of camera, crosshair, slice and window.
import { beamShown } from '../room/beam_line.js';
import { features } from '../features/index.js';
import { layouts } from '../room/layout.js';
import { originAt, planeOfView, positionOf, stepAcross } from '../room/obliques.js';
import { isSingle } from '../room/commands.js';
import { crosshair, crosshairPatch, shownImage } from '../room/plan.js';
import { Pointed } from '../room/pointed.js';
import { isInSpace, isTilted } from '../room/kinds.js';
import { PaneCamera } from './pane_camera.js';
import { PanePick } from './pane_pick.js';
import { PaneTools } from './pane_tools.js';
import { PaneWindow } from './pane_window.js';

const degreesPerPixel = 0.4;
const keyDegrees = 5;
const keyZoom = 1.15;
const wheelZoom = 1.12;
const dragZoomPerPixel = 0.006;

const looks = { 1: ['anterior', 'posterior'], 3: ['left', 'right'], 7: ['superior', 'inferior'] };

export class PaneActions {
  #world;
  #room;
  #ui;
  #number;
  #pick;
  #isPicking = false; // the crosshair follows the pointer in 3-D; one question at a time
  #nextPick = null;

  /** @param {object} world that of the room page @param {number} number of the view @param {(pane: object) => object[]} parts makes what the features have in this pane */
  constructor(world, number, parts) {
    const { room, ui, api, histograms } = world;
    this.#world = world;
    this.#room = room;
    this.#ui = ui;
    this.#number = number;
    this.box = { x: 0, y: 0, width: 1, height: 1 }; // position and size of the picture in the pane, CSS px
    this.window = new PaneWindow(room, histograms, number);
    this.cameras = new PaneCamera(room, ui, number, () => this.box);
    this.#pick = new PanePick(room, api, this.view, () => this.box);
    const pane = { box: () => this.box, pointAt: (x, y) => this.#pick.pointAt(x, y) };
    this.parts = parts(pane);
    this.tools = new PaneTools({ room, ui, api, view: this.view, actions: this }, this.parts);
    this.pointed = new Pointed((x, y) => this.#pick.factsAt(x, y));
  }

  get view() {
    return this.#room.view(this.#number);
  }

  get is3d() {
    return isInSpace(this.view.kind);
  }

  get camera() {
    return this.cameras.value;
  }

  /** The plane of a slice pane. */
  get plane() {
    return planeOfView(this.#room.scene.value, this.view.document.value, this.#room.plan.value);
  }

  // ---- pointer ------------------------------------------------------------------------------------------------------

  start = (mode, at) => {
    this.#ui.active.value = this.#number;
    this.pointed.hide();
    this.tools.take('start', mode, at);
  };

  move = (mode, { x, y, dx, dy, alt, at }) => {
    if (this.tools.take('move', mode, { x, y, dx, dy, alt, at })) return;
    const tool = mode === 'primary' ? this.#ui.tool.value : mode;
    if (tool === 'pan') this.cameras.pan(dx, dy, at);
    else if (this.is3d && (tool === 'roll' || (alt && mode === 'primary'))) this.cameras.rollBy(x, y, dx, dy, at);
    else if (tool === 'zoom' || tool === 'roll') this.cameras.zoom(Math.exp(-dy * dragZoomPerPixel), null, at);
    else if (this.is3d) this.cameras.orbit(-dx * degreesPerPixel, dy * degreesPerPixel, at);
    else if (tool === 'window') this.window.drag(dx, dy, at);
    else this.#crosshairAt(x, y, at, alt);
  };

  end = () => {
    this.tools.end(performance.now());
  };

  tap = ({ x, y, shift, alt, at }) => {
    if (this.tools.take('tap', { x, y, shift, alt, at })) return;
    if (shift) {
      if (this.is3d) this.#crosshairToSeen(x, y, at);
      return;
    }
    if (!this.is3d && this.#ui.tool.value === 'crosshair') this.#crosshairAt(x, y, at, alt);
    this.#selectAt(x, y);
  };

  doubleTap = ({ x, y, touch, at }) => {
    if (this.tools.take('doubleTap', { x, y, touch, at })) return;
    if (touch) this.reset(at);
    else this.#ui.maximise(this.#number);
  };

  /** Probes there: crosshair and values in a card beside the finger. Opens no panel, as the picture would move away. */
  longPress = async ({ x, y, at }) => {
    if (this.tools.take('longPress', { x, y, at })) return;
    this.#ui.active.value = this.#number;
    this.#ui.tab.value = 'probe';
    this.pointed.hide();
    try {
      const hit = this.is3d ? await this.#crosshairToSeen(x, y, at) : null;
      if (!this.is3d) this.#crosshairAt(x, y, at);
      const facts = this.is3d ? hit && (await this.#pick.factsOf(hit)) : await this.#pick.factsAt(x, y);
      if (facts) this.pointed.hold(x, y, facts);
    } catch (error) {
      this.#ui.notify('err', error.message);
    }
  };

  hover = ({ x, y, shift, alt, at }) => {
    if (this.tools.take('hover', { x, y, shift, alt, at })) return;
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
    if (this.tools.take('wheel', { x, y, steps, ctrl, at })) return;
    if (this.is3d || ctrl) this.cameras.zoom(wheelZoom ** -steps, [x, y], at);
    else this.stepSlice(-steps, at);
  };

  pinch = ({ x, y, dx, dy, factor, at }) => {
    this.pointed.hide();
    if (!this.tools.take('pinch', { x, y, dx, dy, factor, at })) this.cameras.pinch({ x, y, dx, dy, factor }, at);
  };

  // ---- camera: pane_camera.js ------------------------------------------------------------------------------------------

  reset(at) {
    if (!this.tools.take('reset', at)) this.cameras.reset(at);
  }

  lookFrom(name, at) {
    this.cameras.lookFrom(name, at);
  }

  setProjection(projection, at) {
    this.cameras.setProjection(projection, at);
  }

  // ---- crosshair and slices -------------------------------------------------------------------------------------------

  /** isFree: anywhere, not only on the middles of voxels. */
  #crosshairAt(x, y, at, isFree = false) {
    const point = this.#pick.pointAt(x, y);
    if (point) this.#moveCrosshair(point, at, isFree || isTilted(this.view.kind)); // the voxels' middles do not lie on that plane
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

  /** Picks for a pointer that moves: one question at a time, and then the newest place. */
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

  /** Selects the track, the region, the isodose surface or the beam that is seen at a place; the crosshair stays. */
  async #selectAt(x, y) {
    try {
      const track = this.is3d && this.#room.scene.value.tracks?.visible && (await this.#pick.trackAt(x, y));
      if (track) {
        this.#ui.track.value = track;
        return void this.#ui.select('track', String(track.segment));
      }
      const hit = await this.#pick.seenAt(x, y);
      if (hit?.level) this.#ui.select('level', hit.level, this.is3d);
      else if (hit?.beam != null) this.#ui.select('beam', hit.draft ? '' : hit.beam, this.is3d);
      else if (hit)
        this.#ui.select(
          hit.region === null ? 'image' : 'region',
          hit.region ?? shownImage(this.#room.plan.value, this.#room.scene.value)?.id,
          this.is3d,
        );
    } catch (error) {
      this.#ui.notify('err', error.message);
    }
  }

  /** Moves by whole slices of the image; the camera stays. */
  stepSlice(steps, at) {
    const { plan, scene } = this.#room;
    if (!scene.value || this.tools.take('stepSlice', steps, at)) return;
    const stepMm = shownImage(plan.value, scene.value)?.stepMm ?? [1, 1, 1];
    this.setSlice(positionOf(this.plane) + steps * stepAcross(this.plane.normal, stepMm), at);
  }

  /** An oblique plane moves along its normal and leaves the crosshair where it is. */
  setSlice(positionMm, at) {
    if (this.tools.take('setSlice', positionMm, at)) return;
    const { plane } = this.view.document.value;
    const oblique = this.view.kind === 'oblique' && this.#room.scene.value.image.obliques?.[plane];
    if (oblique)
      return void this.#room.patchScene(
        { image: { obliques: { [plane]: { origin_mm: originAt({ ...this.plane, origin: oblique.origin_mm }, positionMm) } } } },
        { view: this.#number, at },
      );
    const point = crosshair(this.#room.scene.value);
    point[this.plane.normal.indexOf(1)] = positionMm;
    this.#moveCrosshair(point, at);
  }

  // ---- keys of the focused pane -------------------------------------------------------------------------------------------

  /** @param {KeyboardEvent} event @param {boolean} isHere the focus is in the pane, or on nothing that has keys of its own @returns {boolean} whether the key was used */
  key(event, isHere = true) {
    const at = event.timeStamp;
    const { areSinglesOff } = this.#ui.keys;
    const isFixed = !(event.altKey || event.metaKey) && (isHere || isSingle(event.key)) && !(areSinglesOff.value && isSingle(event.key));
    const act = (isFixed ? this.#fixedKey(event, at) : null) ?? this.#command(this.#ui.keys.commandOf(event), event, isHere);
    if (!act || !this.#room.canChange.value) return false;
    this.pointed.hide();
    act();
    return true;
  }

  /** The act of a key that nobody changes: arrows and pages, digits, those of a tool. */
  #fixedKey(event, at) {
    return (
      this.tools.key(event, at) ?? this.#otherKey(event, at) ?? (event.ctrlKey ? this.#panKey(event.key, at) : this.#placedKey(event, at))
    );
  }

  #panKey(key, at) {
    const [dx, dy] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[key] ?? [];
    return dx === undefined ? null : () => this.cameras.panStep(dx, dy, at);
  }

  #placedKey({ key, code, shiftKey }, at) {
    const layout = shiftKey && layouts[/^Digit([1-7])$/.exec(code)?.[1] - 1];
    if (layout && (layout.id !== 'beam' || beamShown(this.#room.plan.value, this.#room.scene.value)))
      return () => this.#ui.setLayout(layout.id);
    const look = /^Numpad[137]$/.test(code) && this.is3d ? looks[code.at(-1)][shiftKey ? 1 : 0] : null;
    if (look) return () => this.cameras.lookFrom(look, at);
    const preset = shiftKey ? '' : /^Digit([1-5])$/.exec(code)?.[1];
    if (preset && this.window.image) return () => this.window.setPreset(preset, at);
    const own = this.is3d
      ? {
          ArrowLeft: () => this.cameras.orbit(keyDegrees, 0, at),
          ArrowRight: () => this.cameras.orbit(-keyDegrees, 0, at),
          ArrowUp: () => this.cameras.orbit(0, -keyDegrees, at),
          ArrowDown: () => this.cameras.orbit(0, keyDegrees, at),
        }
      : {
          ArrowUp: () => this.stepSlice(1, at),
          ArrowRight: () => this.stepSlice(1, at),
          ArrowDown: () => this.stepSlice(-1, at),
          ArrowLeft: () => this.stepSlice(-1, at),
          PageUp: () => this.stepSlice(10, at),
          PageDown: () => this.stepSlice(-10, at),
        };
    return own[key] ?? (key === 'Enter' ? () => this.#ui.maximise(this.#number) : null);
  }

  /** @param {string} command of room/commands.js */
  #command(command, event, isHere) {
    if (!command || (!isHere && event.key === ' ')) return null;
    const at = event.timeStamp;
    const inSpace = { rollLeft: () => this.cameras.roll(keyDegrees, at), rollRight: () => this.cameras.roll(-keyDegrees, at) };
    const own = {
      ...(this.is3d && inSpace),
      zoomIn: () => this.cameras.zoom(keyZoom, null, at),
      zoomOut: () => this.cameras.zoom(1 / keyZoom, null, at),
      reset: () => this.reset(at),
      fit: () => this.cameras.fit(at),
      follow: () => this.#room.following.toggle(),
      drawer: () => this.#ui.toggleDrawer(),
      window: () => this.#toggleTool('window'),
      measure: () => this.#toggleTool('measure'),
      zoom: () => this.#toggleTool('zoom'),
    };
    const act = features.find(({ keys }) => keys?.[command])?.keys[command];
    return own[command] ?? (act ? () => act(this.#world, at, event) : null);
  }

  #otherKey(event, at) {
    for (const { key } of features) {
      const act = key?.(this.#world, event, at);
      if (act) return act;
    }
    return null;
  }

  #toggleTool(tool) {
    this.#ui.tool.value = this.#ui.tool.value === tool ? 'crosshair' : tool;
    if (this.#ui.tool.value === 'measure') this.#ui.select('measures');
  }
}

/** Position and size of a picture in a pane: as large as fits, aspect ratio kept. */
export function fitBox([paneWidth, paneHeight], [width, height]) {
  const k = Math.min(paneWidth / width, paneHeight / height);
  const box = { width: width * k, height: height * k };
  return { x: (paneWidth - box.width) / 2, y: (paneHeight - box.height) / 2, ...box };
}
