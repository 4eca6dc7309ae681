// One pane: header, picture with its overlay, slice slider.
import { followMark } from './follow_mark.js';
import { html, nothing } from '../../lib/lit-html.js';
import { classMap } from '../../lib/directives/class-map.js';
import { live } from '../../lib/directives/live.js';
import { computed, effect, signal } from '../../lib/signals-core.js';
import { features, partsOf } from '../features/index.js';
import { fidelity } from '../room/fidelity.js';
import { heightOver, positionOf, reachOf, stepAcross } from '../room/obliques.js';
import { crosshair, isLowWhite, shownImage } from '../room/plan.js';
import { isInSpace, isTilted, isTurnable } from '../room/kinds.js';
import { letters } from './letters.js';
import { axesOf, overlay } from './overlay.js';
import { Painter } from './painter.js';
import { PointerReader } from './pointer.js';
import { millimetres, number, windowText } from '../parts/format.js';
import { icon } from '../parts/icons.js';
import { known, later } from '../parts/lazy.js';
import { mount, variables } from '../parts/mount.js';
import { orientation } from './orientation_menu.js';
import { PaneActions, fitBox } from './pane_actions.js';
import { paneKind } from './pane_kind.js';
import { spoken } from './pointed_words.js';
import { whereWords } from './where.js';
import { say } from './words.js';
import { boxOf, pixelRatio } from '../parts/page_look.js';

export const card = later(() => import('./read_out.js'));
const resizeMs = 120;
const maxSide = 4096;

export class Pane {
  #world;
  #room;
  #ui;
  #view;
  #probed;
  #size = signal([0, 0]);
  #resizeTimer = 0;
  #stops = [];
  #lastCaption = '';

  /** @param {HTMLElement} host @param {object} world that of the room page @param {import('../room/view.js').ViewState} view */
  constructor(host, world, view) {
    const { room, ui, probed, decode, redraw, onPainted } = world;
    this.#world = world;
    this.#room = room;
    this.#ui = ui;
    this.#view = view;
    this.#probed = probed;
    this.host = host;
    const place = () => this.place;
    const make = (pane) =>
      features.flatMap((feature) => feature.pane?.(Object.assign(Object.create(world), { host, place, ...pane }), view) ?? []);
    this.actions = new PaneActions(world, view.number, make);
    this.badge = computed(() =>
      fidelity({
        link: room.link.value,
        renderer: room.renderer.value.state,
        header: view.painted.value,
        staleSince: view.staleSince.value,
        behindSince: view.behindSince.value,
        fps: view.fps.value,
        now: ui.now.value,
        refusal: view.refusal.value,
      }),
    );
    this.#stops.push(mount(host, () => this.#draw(), redraw));
    this.#stops.push(mount(host.querySelector(`#caption-${view.number}`), () => html`${this.#caption()}`, redraw));
    const body = host.querySelector('.picture');
    this.painter = new Painter(host.querySelector('canvas'), {
      decode,
      schedule: (callback) => redraw.schedulePicture(host, callback),
      onPainted: (header, isDrawn) => {
        if (isDrawn) redraw.painted(host);
        onPainted(header, isDrawn);
      },
    });
    const pointer = new PointerReader(body, this.actions);
    this.#stops.push(...this.#readOut(body.querySelector('.pointed')));
    body.addEventListener('keydown', (event) => {
      if (this.actions.key(event)) event.preventDefault();
    });
    const observer = new ResizeObserver(() => this.#measure(body));
    observer.observe(body);
    this.#measure(body);
    this.#stops.push(
      () => pointer.stop(),
      () => observer.disconnect(),
      () => this.painter.stop(),
    );
  }

  /** The card at the pointer: drawn apart from the pane, and gone with the picture that it is about. */
  #readOut(host) {
    const { pointed } = this.actions;
    const onKey = ({ key }) => key === 'Escape' && pointed.hide();
    addEventListener('keydown', onKey);
    return [
      () => removeEventListener('keydown', onKey),
      mount(host, () => (pointed.shown.value ? known(card)?.readOut({ room: this.#room, pointed }, host) : nothing)),
      effect(() => {
        const header = this.#view.painted.value;
        if (header) pointed.picture(`${header.scene_revision} ${header.clip_from_lps_mm}`);
      }),
      effect(() => {
        if (this.#ui.active.value !== this.#view.number) pointed.hide();
      }),
      () => pointed.hide(),
    ];
  }

  stop() {
    clearTimeout(this.#resizeTimer);
    for (const stop of this.#stops) stop();
  }

  /** Opens, resizes or closes the server's view when the pane is shown, resized or hidden. */
  #measure(body) {
    const { width, height } = boxOf(body);
    this.#size.value = [width, height];
    clearTimeout(this.#resizeTimer);
    if (!this.#view.isOpen.value) this.#ask();
    else this.#resizeTimer = setTimeout(() => this.#ask(), resizeMs);
  }

  #ask() {
    const [width, height] = this.#size.value;
    if (width < 2 || height < 2) return void this.#room.hideView(this.#view.number);
    const ratio = pixelRatio();
    const pixels = (side) => Math.min(Math.max(Math.round(side * ratio), 16), maxSide);
    this.#room.showView(this.#view.number, [pixels(width), pixels(height)]);
  }

  get #box() {
    const header = this.#view.painted.value;
    const pane = this.#size.value;
    return header && pane[0] > 1 ? fitBox(pane, [header.width_px, header.height_px]) : { x: 0, y: 0, width: pane[0], height: pane[1] };
  }

  /** The picture on the screen, its place in the pane, the pane's size. */
  get place() {
    return { header: this.#view.painted.value, box: this.#box, pane: this.#size.value };
  }

  #draw() {
    const { name, number: n } = this.#view;
    const isMaximised = this.#ui.maximised.value === n;
    this.actions.box = this.#box;
    const { parts } = this.actions;
    const lines = parts.flatMap((part) => part.lines?.() ?? []);
    const tools = this.actions.tools.draw(this.place);
    return html`
      <header class=${classMap({ 'pane-head': true, active: this.#ui.active.value === n })}>
        ${paneKind({ room: this.#room, ui: this.#ui }, this.#view)}<span class="where">${tools.where ?? this.#whereInHead()}</span>${parts.map((part) => part.head?.())}${tools.head ?? nothing}<span class="grow"></span>
        ${followMark(this.#room)}${this.#badgeButton()}
        <button class="icon-button small" @click=${() => this.#ui.maximise(n)} aria-pressed=${isMaximised}
          title=${isMaximised ? say.showAll : say.maximiseIs} aria-label=${(isMaximised ? say.restore : say.maximise)({ view: name })}>
          ${icon(isMaximised ? 'restore' : 'maximise')}</button>
      </header>
      <div class="pane-body">
        <div class=${classMap({ picture: true, stale: this.badge.value?.state === 'stale', lost: this.badge.value?.state === 'disconnected' })}
          tabindex="0" role="group" aria-label=${say.picture({ view: name })} aria-describedby=${`caption-${n}`} id=${`picture-${n}`}
          @focus=${() => {
            this.#ui.active.value = n;
          }}>
          <canvas width="16" height="16"></canvas>
          ${lines.map((part) => part.lines)}<svg class="overlay" aria-hidden="true">${this.#overlay()}${tools.overlay}</svg>${lines.map((part) => part.handles)}${this.#pins()}${tools.handles}
          <svg class="overlay pointers" aria-hidden="true"></svg><div class="pointed"></div>
          ${this.#cover()}
        </div>
        ${orientation({ room: this.#room, ui: this.#ui }, this.actions, this.#size.value)}
        ${tools.slider ?? this.#slider()}
      </div>${tools.foot ?? nothing}
      <p class="hidden" id=${`caption-${n}`} aria-live="polite"></p>`;
  }

  /** The words of where.js, with the parts marked that a narrow pane leaves out. */
  #whereInHead() {
    const where = whereWords(this.#room, this.#view, this.actions);
    const at = isTurnable(this.#view.kind) ? where.indexOf(', ') + 2 : 0;
    const to = where.endsWith(' mm') ? where.length - 3 : where.length;
    return html`<span class="roomy">${where.slice(0, at)}</span>${where.slice(at, to)}<span class="roomy">${where.slice(to)}</span>`;
  }

  #badgeButton() {
    const badge = this.badge.value;
    if (!badge) return nothing;
    const name = `badge-${this.#view.number}`;
    return html`<span class="anchor"><button class=${`badge ${badge.state}`} data-badge=${badge.state} ?disabled=${!badge.why}
        aria-expanded=${this.#ui.popover.value === name} @click=${() => this.#ui.toggle(name)}>${icon(badge.state, 12)}<span>${badge.text}</span></button>
      ${badge.why && this.#ui.popover.value === name ? html`<div class="popover badge-why" role="status"><b class=${badge.state}>${icon(badge.state, 12)} ${badge.text}</b><p>${badge.why}</p></div>` : nothing}</span>`;
  }

  #overlay() {
    const view = this.#view;
    const header = view.painted.value;
    const scene = this.#room.scene.value;
    const pane = this.#size.value;
    if (!header || !scene || pane[0] < 2) return nothing;
    const box = this.#box;
    const plan = this.#room.plan.value;
    const image = shownImage(plan, scene);
    const plane = isInSpace(view.kind) ? null : this.actions.plane;
    const tolerance = plane && stepAcross(plane.normal, image?.stepMm ?? [1, 1, 1]) / 2;
    const layers = this.actions.parts.map((part) => part.layer?.({ scene, plane, tolerance, header, box, pane }));
    return html`${layers}${overlay({
      kind: view.kind,
      ground: scene.space?.background,
      header,
      box,
      pane,
      isOffPlane: isTilted(view.kind) && Math.abs(heightOver(plane, crosshair(scene))) > tolerance,
      axes: axesOf(scene, plan),
      point: image || plan?.regions.length ? crosshair(scene) : null, // without image and regions there is nothing to point at
      pxPerMm: (header.pixels_per_mm * box.width) / header.full_px[0],
      windowText: image ? windowText(scene.image.window, image.unit, isLowWhite(image, scene)) : plan?.regions.length ? say.noImage : '',
    })}`;
  }

  /** Pins on the picture; their place is worked out where there is one. */
  #pins() {
    const { scene, plan } = this.#room;
    if (!scene.value) return nothing;
    const place = () => {
      const plane = isInSpace(this.#view.kind) ? null : this.actions.plane;
      const tolerance = plane && stepAcross(plane.normal, shownImage(plan.value, scene.value)?.stepMm ?? [1, 1, 1]) / 2;
      return { header: this.#view.painted.value, box: this.#box, pane: this.#size.value, plane, tolerance };
    };
    return this.actions.parts.map((part) => part.pins?.(place));
  }

  #cover() {
    const { state, phase, percent, problem } = this.#room.renderer.value;
    if (state === 'failed' || state === 'closed')
      return html`<div class="cover"><div class="refusal">${icon('error')}<div><b>${say.notShown}</b><p>${problem?.detail ?? say.noReason}</p></div></div></div>`;
    if (state === 'restarting' && problem)
      return html`<div class="cover"><div class="refusal" role="status">${icon('warning')}<div><b>${say.noNewPicture}</b><p>${phase[0]?.toUpperCase()}${phase.slice(1)}.</p></div></div></div>`;
    const { value: refusal } = this.#view.refusal;
    if (refusal && state === 'ready')
      return html`<div class="cover"><div class="refusal" role="status">${icon('error')}<div><b>${say.notDrawnView}</b><p>${refusal}</p>
        <p class="place">${this.#view.painted.value ? say.lastDrawnAgain : say.drawnAgain}</p></div></div></div>`;
    if (this.#view.painted.value) return this.#emptyWords();
    if (state === 'ready') return this.#emptyWords();
    return html`<div class="cover"><div class="loading" role="progressbar" aria-valuenow=${Math.round(percent)} aria-valuemin="0" aria-valuemax="100">
      <span>${phase || (state === 'starting' ? say.starting : say.loading)}</span><b>${number(percent)} %</b>
      <i class="bar" ${variables({ '--fill': `${percent}%` })}></i></div></div>`;
  }

  #emptyWords() {
    const plan = this.#room.plan.value;
    if (!plan || plan.images.length || plan.regions.length) return nothing;
    return html`<div class="cover quiet"><p>${isInSpace(this.#view.kind) ? say.nothingToDraw : say.nothingToCut}</p></div>`;
  }

  #slider() {
    const { kind } = this.#view;
    const { scene, plan } = this.#room;
    if (isInSpace(kind)) return nothing;
    if (!scene.value || !plan.value) return html`<div class="slice-slider"></div>`; // its place, so that the picture keeps its size
    const { plane } = this.actions;
    const letter = letters(plane.normal);
    const image = shownImage(plan.value, scene.value);
    const { low, high } = reachOf(plane.normal, image?.bounds ?? plan.value.bounds);
    const position = positionOf(plane);
    return html`<label class="slice-slider" title=${say.sliceIs}><input type="range" aria-label=${say.slice({ view: this.#view.name, letter })}
      min=${low} max=${high} step="0.1" .value=${live(String(position))} ?disabled=${!this.#room.canChange.value}
      aria-valuetext=${`${letter} ${millimetres(position)}`}
      @input=${(event) => this.actions.setSlice(event.target.valueAsNumber, event.timeStamp)}
      @keydown=${(event) => this.#sliderKey(event)}></label>`;
  }

  #sliderKey(event) {
    const steps = { ArrowUp: 1, ArrowRight: 1, ArrowDown: -1, ArrowLeft: -1, PageUp: 10, PageDown: -10 }[event.key];
    if (!steps) return;
    event.preventDefault();
    this.actions.stepSlice(steps, event.timeStamp);
  }

  /** "Axial, S −64.9 mm, brain, CT 38 HU": announced once picture and values are there, not thirty times a second. */
  #caption() {
    const { result, isOld } = this.#probed.value;
    if (!this.#view.painted.value?.is_still || isOld) return this.#lastCaption;
    const facts =
      this.#ui.active.value === this.#view.number && result
        ? [...spoken(result, this.#room.plan.value, this.#room.scene.value), ...partsOf('here', this.#world)]
        : [];
    this.#lastCaption = [this.#view.name, whereWords(this.#room, this.#view, this.actions), ...facts].filter(Boolean).join(', ');
    return this.#lastCaption;
  }
}
