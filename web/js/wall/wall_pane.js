// One pane of a wall: its picture at its own pixels, and over it what the room's pages draw, larger by the wall's scale; it takes no input.
import { html, nothing, svg } from '../../lib/lit-html.js';
import { computed, signal } from '../../lib/signals-core.js';
import { features } from '../features/index.js';
import { PaneActions, fitBox } from '../pane/pane_actions.js';
import { axesOf, overlay } from '../pane/overlay.js';
import { Painter } from '../pane/painter.js';
import { whereWords } from '../pane/where.js';
import { fidelity } from '../room/fidelity.js';
import { isInSpace, isTilted } from '../room/kinds.js';
import { heightOver, stepAcross } from '../room/obliques.js';
import { crosshair, isLowWhite, shownImage } from '../room/plan.js';
import { windowText } from '../parts/format.js';
import { mount, variables } from '../parts/mount.js';
import { say } from './words.js';

const leastPx = 16; // of a side of a view
const mostPx = 4096;

export class WallPane {
  #world;
  #room;
  #view;
  #size = signal([0, 0]); // of the picture, CSS px of the screen
  #stops = [];

  /** @param {HTMLElement} host @param {object} world of wall_page.js @param {import('../room/view.js').ViewState} view */
  constructor(host, world, view) {
    this.#world = world;
    this.#room = world.room;
    this.#view = view;
    this.host = host;
    const place = () => this.place;
    const make = (pane) =>
      features.flatMap((feature) => feature.pane?.(Object.assign(Object.create(world), { host, place, ...pane }), view) ?? []);
    this.actions = new PaneActions(world, view.number, make);
    this.badge = computed(() =>
      fidelity({
        link: this.#room.link.value,
        renderer: this.#room.renderer.value.state,
        header: view.painted.value,
        staleSince: view.staleSince.value,
        behindSince: view.behindSince.value,
        fps: view.fps.value,
        now: world.ui.now.value,
        refusal: view.refusal.value,
      }),
    );
    this.#stops.push(mount(host, () => this.#draw()));
    this.painter = new Painter(host.querySelector('canvas'), {
      decode: world.decode,
      schedule: (callback) => world.redraw.schedule(callback),
      onPainted: (header, isDrawn) => world.onPainted(header, isDrawn),
    });
    const observer = new ResizeObserver(() => this.measure());
    observer.observe(host.querySelector('.wall-picture'));
    this.#stops.push(
      () => observer.disconnect(),
      () => this.painter.stop(),
    );
  }

  stop() {
    for (const stop of this.#stops) stop();
  }

  /** Takes the picture off the screen. */
  clear() {
    this.painter.stop();
    this.host.querySelector('canvas').width = 1;
    this.#view.painted.value = null;
  }

  /** Asks for the view at the pixels that the pane has; closes it when the pane is hidden. */
  measure() {
    const picture = this.host.querySelector('.wall-picture');
    const size = [picture.clientWidth, picture.clientHeight];
    this.#size.value = size;
    if (size[0] < 2 || size[1] < 2) return void this.#room.hideView(this.#view.number);
    const pixels = (side) => Math.min(Math.max(Math.round(side * this.#world.ratio), leastPx), mostPx);
    this.#room.showView(this.#view.number, size.map(pixels));
  }

  /** Size in the CSS px in which overlays are drawn: those of the screen by the wall's scale. */
  get #pane() {
    return this.#size.value.map((side) => side / this.#world.scale.value);
  }

  get #box() {
    const header = this.#view.painted.value;
    const pane = this.#pane;
    return header && pane[0] > 1 ? fitBox(pane, header.full_px) : { x: 0, y: 0, width: pane[0], height: pane[1] };
  }

  /** Place of the picture, like that of pane/pane.js. */
  get place() {
    return { header: this.#view.painted.value, box: this.#box, pane: this.#pane };
  }

  #draw() {
    const { name, number } = this.#view;
    const { scene, plan } = this.#room;
    this.actions.box = this.#box;
    const { parts } = this.actions;
    const lines = parts.flatMap((part) => part.lines?.() ?? []);
    const tools = this.actions.tools.draw(this.place);
    const [width, height] = this.#size.value;
    const image = shownImage(plan.value, scene.value);
    const state = this.badge.value?.state;
    const isOld = ['stale', 'link', 'disconnected', 'paused'].includes(state);
    const where = tools.where ?? whereWords(this.#room, this.#view, this.actions);
    const text =
      image && !isInSpace(this.#view.kind) ? windowText(scene.value.image.window, image.unit, isLowWhite(image, scene.value)) : '';
    return html`<header class="wall-head"><h2>${name}</h2><span class="wall-where">${where}</span>${parts.map((part) => part.head?.())}<span class="grow"></span><span class="wall-window">${text}</span></header>
      <div class="wall-picture" data-state=${isOld ? state : 'live'} role="img" aria-label=${say.picture({ view: name, where })}>
        <canvas width="16" height="16" ${variables({ '--width': `${width}px`, '--height': `${height}px` })}></canvas>
        <div class="picture" ${variables({ '--scale': String(this.#world.scale.value), '--width': `${this.#pane[0]}px`, '--height': `${this.#pane[1]}px` })} id=${`picture-${number}`}>
          ${lines.map((part) => part.lines)}<svg class="overlay" aria-hidden="true">${this.#overlay()}${tools.overlay}</svg>${this.#pins()}
          <svg class="overlay pointers" aria-hidden="true"></svg></div>${this.#cover()}</div>`;
  }

  /** The plane of a slice with half the distance of two slices; nulls in 3-D. */
  get #slice() {
    const { scene, plan } = this.#room;
    const plane = isInSpace(this.#view.kind) ? null : this.actions.plane;
    const tolerance = plane && stepAcross(plane.normal, shownImage(plan.value, scene.value)?.stepMm ?? [1, 1, 1]) / 2;
    return { plane, tolerance };
  }

  #overlay() {
    const header = this.#view.painted.value;
    const { scene, plan } = this.#room;
    const pane = this.#pane;
    if (!header || !scene.value || !plan.value || pane[0] < 2) return nothing;
    const box = this.#box;
    const { plane, tolerance } = this.#slice;
    const point = crosshair(scene.value);
    const layers = this.actions.parts.map((part) => part.layer?.({ scene: scene.value, plane, tolerance, header, box, pane }));
    return svg`${layers}${overlay({
      kind: this.#view.kind,
      ground: scene.value.space?.background,
      header,
      box,
      pane,
      isOffPlane: isTilted(this.#view.kind) && Math.abs(heightOver(plane, point)) > tolerance,
      axes: axesOf(scene.value, plan.value),
      point: shownImage(plan.value, scene.value) || plan.value.regions.length ? point : null,
      pxPerMm: (header.pixels_per_mm * box.width) / header.full_px[0],
      windowText: '',
    })}`;
  }

  #pins() {
    if (!this.#room.scene.value) return nothing;
    const place = () => ({ ...this.place, ...this.#slice });
    return this.actions.parts.map((part) => part.pins?.(place));
  }

  #cover() {
    const { state, phase, problem } = this.#room.renderer.value;
    const { value: refusal } = this.#view.refusal;
    const words =
      state === 'failed' || state === 'closed'
        ? say.failed({ why: problem?.detail ?? say.noReason })
        : state === 'restarting'
          ? say.restarting
          : refusal
            ? say.notDrawn({ why: refusal })
            : this.#view.painted.value || state === 'ready'
              ? ''
              : say.opening({ phase });
    return words ? html`<p class="wall-cover" role="status">${words}</p>` : nothing;
  }
}
