// Panes along the beam: the beam's-eye view, whose camera is locked to it, and the slice across it.
import { html, nothing } from '../../../lib/lit-html.js';
import { live } from '../../../lib/directives/live.js';
import { firstAlong, movers, placeOf, rangeAlong, regionAt, slidPatch } from './beam_along.js';
import { cameraAsSeen, eyeAlong, fittedEye, ringPatch, usualRingMm, zoomedEye } from './beam_eye.js';
import { beamFacts } from './beam_facts.js';
import { beamShown } from '../../room/beam_line.js';
import { stepAcross } from '../../room/obliques.js';
import { shownImage } from '../../room/plan.js';
import { beamFoot } from './beam_foot.js';
import { showInstead, spaceInstead } from './beam_view.js';
import { ringHandle, ringNumbers, ringWords } from './beam_ring.js';
import { alongBeam } from '../../parts/format.js';
import { say } from './pane_words.js';

const wheelZoom = 1.12;
const keyZoom = 1.15;
const dragZoomPerPixel = 0.006;
const lock = html`<svg class="icon" viewBox="0 0 16 16" width="12" height="12" aria-hidden="true"><rect x="3" y="7" width="10" height="7" rx="1.500"/><path d="M5 7V5a3 3 0 0 1 6 0v2"/></svg>`;
const ringPicture = html`<svg class="icon" viewBox="0 0 16 16" width="16" height="16" aria-hidden="true"><circle cx="8" cy="8" r="5.500"/><circle cx="11.9" cy="4.1" r="1.800" fill="currentColor"/></svg>`;

/** Makes the handler of such a pane's pointer, keys and drawing. @param {object} pane {room, ui, api, view, actions} @returns {import('../../pane/pane_tools.js').PaneHandler} */
export function makePane(pane) {
  const clock = { setTimeout: (...args) => setTimeout(...args), clearTimeout: (timer) => clearTimeout(timer) };
  const facts = beamFacts({ ...pane, clock });
  return new (pane.view.kind === 'beam' ? BeamEye : BeamSlice)(pane, facts);
}

/** Parts common to both: the place of the slice, and sliding. */
class AlongBeam {
  /** @param {object} pane {room, ui, view, actions} @param {import('./beam_facts.js').BeamFacts} facts */
  constructor(pane, facts) {
    this.pane = pane;
    this.facts = facts;
  }

  /** The regions on the way; none until the server has answered. */
  get bands() {
    return this.facts.answer.value.result?.bands ?? [];
  }

  get beam() {
    const { room } = this.pane;
    return beamShown(room.plan.value, room.scene.value);
  }

  get range() {
    const { room } = this.pane;
    return rangeAlong(room.plan.value, room.scene.value, this.beam, this.bands);
  }

  /** Moves to a place along the beam what the slider moves; in a slice pane the slice. */
  slide(mm, at, mover = 'slice') {
    const { room, ui, view } = this.pane;
    if (!this.beam || !Number.isFinite(mm)) return;
    const { low, high } = this.range;
    if (mover === 'eye') return void this.change({ beam: { along_mm: Math.round(mm * 10) / 10 || 0 } }, at);
    room.patchScene(slidPatch(room.scene.value, mover, ui.panes.isBeamTogether.value, mm, { low, high }), { view: view.number, at });
  }

  slideBy(mm, at, mover = 'slice') {
    const { room, view } = this.pane;
    const eye = mover === 'eye' && this.beam ? eyeAlong(room.plan.value, this.beam, view.document.value) : 0;
    this.slide(placeOf(room.scene.value, mover, eye) + mm, at, mover);
  }

  /** Keys [ and ]: 1 mm, with Shift 10 mm. */
  slideKey({ key, code, shiftKey }, at, mover) {
    const by = key === '[' || key === '{' || code === 'BracketLeft' ? -1 : key === ']' || key === '}' || code === 'BracketRight' ? 1 : 0;
    return by ? () => this.slideBy(by * (shiftKey ? 10 : 1), at, mover) : null;
  }

  /** "44.3 mm from source end, tumor" */
  words(mm) {
    const region = this.pane.room.plan.value?.regions.find(({ id }) => id === regionAt(this.bands, mm));
    return region?.name ? say.alongIn({ place: alongBeam(mm), region: region.name }) : alongBeam(mm);
  }
}

class BeamSlice extends AlongBeam {
  #isShown = false;

  /** A slice that was never moved lies at the entry, before the patient: who presents sees it at the target. */
  #begin() {
    const { room, view } = this.pane;
    if (view.isOpen.value === this.#isShown) return;
    this.#isShown = view.isOpen.value;
    const along_mm = firstAlong(room.scene.value.beam, this.beam);
    if (this.#isShown && room.following.isPresenting.value && along_mm !== room.scene.value.beam.slice.along_mm)
      queueMicrotask(() => room.patchScene({ beam: { slice: { along_mm } } }, { view: view.number }));
  }

  setSlice(mm, at) {
    this.slide(mm, at);
    return true;
  }

  /** Towards the target and beyond is forwards. */
  stepSlice(steps, at) {
    const { room, actions } = this.pane;
    this.slideBy(steps * stepAcross(actions.plane.normal, shownImage(room.plan.value, room.scene.value)?.stepMm ?? [1, 1, 1]), at);
    return true;
  }

  key(event, at) {
    return this.slideKey(event, at, 'slice');
  }

  draw({ header, box, pane }) {
    const { room, actions, view } = this.pane;
    const { beam } = this;
    if (!beam || !room.scene.value) return {};
    this.#begin();
    const { low, high } = this.range;
    const mm = room.scene.value.beam.slice.along_mm;
    const steps = { ArrowUp: 1, ArrowRight: 1, ArrowDown: -1, ArrowLeft: -1, PageUp: 10, PageDown: -10 };
    const onKey = (event) => {
      if (!steps[event.key]) return;
      event.preventDefault();
      actions.stepSlice(steps[event.key], event.timeStamp);
    };
    const numbers =
      header && pane[0] > 1 && ringNumbers({ header, box, pane, beam, ring: null }, view.document.value.beam?.crosshair !== false);
    return {
      where: this.words(mm),
      overlay: numbers,
      slider: html`<label class="slice-slider" title=${say.alongKeys}><input type="range" aria-label=${say.viewAlong({ view: view.name })} min=${low} max=${high} step="0.1" .value=${live(String(mm))}
      ?disabled=${!room.canChange.value} aria-valuetext=${this.words(mm)} @input=${(event) => this.slide(event.target.valueAsNumber, event.timeStamp)} @keydown=${onKey}></label>`,
    };
  }
}

const ringHead = ({ ring, beside }) =>
  html`<span class="beam-aperture" title=${`${ring}, ${beside}`}><b>${ring}</b><span class="dim">,&nbsp;${beside}</span></span>`;

class BeamEye extends AlongBeam {
  get #mover() {
    const { ui } = this.pane;
    const list = movers(ui.panes.isBeamTogether.value);
    return list.some(([id]) => id === ui.beamMover.value) ? ui.beamMover.value : 'slice';
  }

  /** The eye and the ring are the room's, or of who is on their own: a patch that is worked out from the shared picture would not fit another pane. */
  change(patch, at) {
    const { room, view } = this.pane;
    if (!this.beam || !room.canChange.value) return;
    room.following.leave();
    room.patchView(view.number, typeof patch === 'function' ? patch(room.plan.value, this.beam, view.document.value) : patch, { at });
  }

  zoom(factor, at) {
    this.change((plan, beam, document) => zoomedEye(plan, beam, document, factor), at);
  }

  /** @param {number|null} mm */
  setRing(mm, at) {
    this.change((plan, beam, document) => ringPatch(plan, beam, document, mm), at);
  }

  toggleRing(at) {
    const isOn = (this.pane.view.document.value.beam?.aperture_mm ?? null) !== null;
    if (this.beam) this.setRing(isOn ? null : (this.beam.aperture ?? usualRingMm), at);
  }

  /** The pane becomes the 3-D view, and that has this camera: the picture stays. */
  unlock(at) {
    const { room, ui, view } = this.pane;
    if (!this.beam || !room.canChange.value) return;
    room.following.leave();
    const to = spaceInstead({ room, ui });
    const camera = cameraAsSeen(room.plan.value, this.beam, view.document.value);
    if (!room.view(to).isOpen.value) room.showView(to, view.ownSize);
    room.patchView(to, { camera }, { at });
    showInstead(ui, view.number, to);
  }

  #tellLocked() {
    this.pane.ui.notify('ok', say.locked, 'beam-lock', {
      word: say.turnFreely,
      act: () => this.unlock(performance.now()),
    });
    return true;
  }

  move(mode, { dy, at }) {
    const tool = mode === 'primary' ? this.pane.ui.tool.value : mode;
    if (tool !== 'zoom') return this.#tellLocked();
    this.zoom(Math.exp(-dy * dragZoomPerPixel), at);
    return true;
  }

  wheel({ steps, at }) {
    this.zoom(wheelZoom ** -steps, at);
    return true;
  }

  pinch({ factor, at }) {
    this.zoom(factor, at);
    return true;
  }

  reset(at) {
    this.change(fittedEye, at);
    return true;
  }

  key(event, at) {
    const { key, code, ctrlKey } = event;
    if (!ctrlKey) {
      if (key === '+' || key === '=') return () => this.zoom(keyZoom, at);
      if (key === '-') return () => this.zoom(1 / keyZoom, at);
      if (['r', ' ', 'g'].includes(key.toLowerCase())) return () => this.reset(at);
    }
    if (key.startsWith('Arrow') || key === ',' || key === '.' || /^Numpad[137]$/.test(code)) return () => this.#tellLocked();
    return ctrlKey ? null : this.slideKey(event, at, this.#mover);
  }

  draw({ header, box, pane }) {
    const { room, ui, view } = this.pane;
    const { beam } = this;
    if (!beam || !room.scene.value) return {};
    const document = view.document.value;
    const ring = document.beam?.aperture_mm ?? null;
    const isOff = !room.canChange.value;
    const words = beam.isDraft ? say.lockedToDraft : say.lockedToBeam;
    const mover = this.#mover;
    const place = header && pane[0] > 1 ? { header, box, pane, beam, ring } : null;
    return {
      where: html`<button class="beam-lock" ?disabled=${isOff} title=${say.leave} @click=${(event) => this.unlock(event.timeStamp)}><span>${words}</span>${lock}</button>`,
      head: html`<button class="icon-button small beam-ring-toggle" aria-pressed=${ring !== null} aria-label=${say.ringName} ?disabled=${isOff} title=${ring === null ? say.ringOn : say.ringOff}
        @click=${(event) => this.toggleRing(event.timeStamp)}>${ringPicture}</button>${ring === null ? nothing : ringHead(ringWords(ring, beam))}`,
      overlay: place && ringNumbers(place, document.beam?.crosshair !== false),
      handles: place && ring !== null ? ringHandle(place, isOff, (mm, at) => this.setRing(mm, at)) : nothing,
      foot: beamFoot(
        { room, ui, view },
        {
          beam,
          ring,
          range: this.range,
          bands: this.bands,
          mover,
          words: (mm) => this.words(mm),
          at: placeOf(room.scene.value, mover, mover === 'eye' ? eyeAlong(room.plan.value, beam, document) : 0),
          width: pane[0],
          slide: (mm, at) => this.slide(mm, at, mover),
          slideBy: (mm, at) => this.slideBy(mm, at, mover),
          setRing: (mm, at) => this.setRing(mm, at),
          toggleRing: (at) => this.toggleRing(at),
        },
      ),
    };
  }
}
