// The small live picture of what the presenter works in, beside own views: in a corner of the panes, over none of their letters and scales.
import { html, nothing, svg } from '../../../lib/lit-html.js';
import { computed, effect, signal } from '../../../lib/signals-core.js';
import { isDrafted } from '../beams/beams.js';
import { views } from '../../room/layout.js';
import { crosshair } from '../../room/plan.js';
import { say } from './later_words.js';
import { corners, liveness, watched } from './watching.js';
import { isTilted } from '../../room/kinds.js';
import { edgeLetters } from '../../pane/letters.js';
import { overlay } from '../../pane/overlay.js';
import { Painter } from '../../pane/painter.js';
import { icon } from '../../parts/icons.js';
import { mount, variables } from '../../parts/mount.js';
import { boxOf, pixelRatio, placeOf } from '../../parts/page_look.js';

const number = 9; // of frames and messages
const [widest, narrowest] = [260, 140]; // px
const edge = { side: 30, top: 26, bottom: 32 }; // px inside a pane's picture that its letters, scale and window have
const mostOfPane = 0.6; // of its height

const nameOf = ({ kind, number: ofKind = 1 }) => views.find((view) => view.kind === kind && (view.number ?? 1) === ofKind)?.name ?? kind;

/** The visible pane in a corner of the panes: its box relative to all of them. */
function paneAt(host, corner) {
  const all = boxOf(host);
  const [isBottom, isRight] = [corner.startsWith('bottom'), corner.endsWith('right')];
  const far = ({ left, right, top, bottom }) =>
    Math.hypot(isRight ? all.right - right : left - all.left, isBottom ? all.bottom - bottom : top - all.top);
  const panes = [...host.querySelectorAll('.pane:not([hidden])')].map((pane) => ({ pane, box: boxOf(pane) }));
  return panes.sort((a, b) => far(a.box) - far(b.box))[0] ?? null;
}

/** Where the picture hides least: not over the orientation figure of a 3-D pane, and on a telephone not where messages come. */
function freeCorner(host, size) {
  if (size === 'phone') return 'top-right';
  return paneAt(host, 'bottom-right')?.pane.dataset.kind === '3d' ? 'top-right' : 'bottom-right';
}

/** Height of the head: that of its buttons. */
const headOf = (host) => Math.max(28, parseFloat(getComputedStyle(host).getPropertyValue('--icon-button')) || 0) + 2;

/** Its place in px from the corner of the panes, and the size of the picture; none where a pane has no room for it. */
function place(host, corner, ratio) {
  const found = paneAt(host, corner);
  if (!found) return null;
  const picture = boxOf(found.pane.querySelector('.picture'));
  const all = boxOf(host);
  const room = {
    width: picture.width - 2 * edge.side,
    height: Math.min(picture.height - edge.top - edge.bottom, mostOfPane * picture.height) - headOf(host),
  };
  const width = Math.min(widest, room.width, room.height * ratio);
  if (width < narrowest)
    return { isTight: true, ...inset(corner, picture, all), width: Math.max(narrowest, Math.min(widest, room.width)), height: 0 };
  return { isTight: false, ...inset(corner, picture, all), width: Math.round(width), height: Math.round(width / ratio) };
}

const inset = (corner, picture, all) => ({
  x: corner.endsWith('right') ? all.right - picture.right + edge.side : picture.left - all.left + edge.side,
  y: corner.startsWith('bottom') ? all.bottom - picture.bottom + edge.bottom : picture.top - all.top + edge.top,
});

class Small {
  #world;
  #painted = signal(null); // FrameHeader of the picture on the screen
  #paintedAt = 0;
  #shown = signal({ document: null, isLate: false }); // of the message view
  #missing = signal(0);
  #nWelcomes = signal(0);
  #layout = signal(0); // counts sizes of the panes
  #host = document.createElement('div');
  #panes;
  #told = false; // the server was told that a picture is wanted
  #painter = null;
  #canvas = null;

  constructor(world) {
    this.#world = world;
    const { room, connection } = world;
    this.#panes = document.querySelector('.panes');
    this.#host.className = 'watch-host';
    this.#panes.parentElement.append(this.#host);
    const abort = new AbortController();
    const on = (type, act) => connection.addEventListener(type, ({ detail }) => act(detail), { signal: abort.signal });
    on('message', (message) => this.#take(message));
    on('frame', (frame) => {
      if (frame.header.view === number) this.#offer(frame);
    });
    const observer = new ResizeObserver(() => {
      this.#layout.value += 1;
    });
    observer.observe(this.#panes);
    this.place = computed(() => this.#place());
    this.stops = [
      () => abort.abort(),
      () => observer.disconnect(),
      () => this.#painter?.stop(),
      mount(this.#host, () => this.#draw()),
      effect(() => this.#tell()),
      effect(() => {
        if (!watched(room)) this.#forget();
      }),
      () => this.#host.remove(),
    ];
  }

  #take({ type, view, document: shown, late, n }) {
    if (type === 'welcome') {
      this.#told = false;
      this.#nWelcomes.value += 1;
    }
    if (view !== number) return;
    if (type === 'missing') this.#missing.value = n;
    if (type !== 'view') return;
    const before = this.#shown.peek().document;
    if (before && nameOf(before) !== nameOf(shown)) this.#painted.value = null; // the picture under the new name is still to come
    this.#shown.value = { document: shown, isLate: late };
  }

  #offer(frame) {
    if (this.#painter) return void this.#painter.offer(frame);
    this.#acknowledge(frame.header); // it came while the picture was being closed
  }

  #acknowledge({ sequence }) {
    this.#world.connection.send({ type: 'frame.shown', view: number, sequence });
  }

  #forget() {
    this.#painted.value = null;
    this.#paintedAt = 0;
    this.#shown.value = { document: null, isLate: false };
    this.#missing.value = 0;
  }

  get #isShown() {
    return watched(this.#world.room) !== null && !this.#world.watching.isClosed.value;
  }

  get #ratio() {
    const [width, height] = this.#shown.value.document?.size_px ?? [4, 3];
    return Math.min(Math.max(width / height, 0.6), 2.2);
  }

  get corner() {
    const { ui, watching } = this.#world;
    return watching.corner.value || freeCorner(this.#panes, ui.arrangement.value.size);
  }

  #place() {
    const { ui } = this.#world;
    void [this.#layout.value, ui.arrangement.value, ui.panes.two.value, ui.panes.four.value];
    return place(this.#panes, this.corner, this.#ratio);
  }

  /** Tells the server the size of the picture, or that none is wanted. */
  #tell() {
    void this.#nWelcomes.value;
    const { link } = this.#world.room;
    const at = this.#isShown && !this.#world.watching.isFolded.value ? this.place.value : null;
    const ratio = pixelRatio();
    const size = at && !at.isTight ? [at.width, at.height].map((side) => Math.max(16, Math.round(side * ratio))) : null;
    if (link.value.state !== 'open' || String(size) === String(this.#told || null)) return;
    if (this.#world.connection.send({ type: 'watch', size_px: size })) this.#told = size ?? false;
  }

  #start(canvas) {
    if (!canvas || canvas === this.#canvas) return;
    this.#painter?.stop();
    this.#canvas = canvas;
    const { decode } = this.#world;
    this.#painter = new Painter(canvas, {
      decode,
      schedule: (callback) => requestAnimationFrame(callback),
      onPainted: (header, isDrawn) => {
        this.#acknowledge(header);
        if (!isDrawn) return;
        this.#paintedAt = Date.now();
        this.#painted.value = header;
      },
    });
  }

  #draw() {
    const { room, watching } = this.#world;
    const who = this.#isShown ? watched(room) : null;
    const at = who && this.place.value;
    if (!at) {
      this.#painter?.stop();
      this.#painter = this.#canvas = null;
      return nothing;
    }
    const isFolded = watching.isFolded.value || at.isTight;
    const header = this.#painted.value;
    const { document: shown, isLate } = this.#shown.value;
    const live = liveness({
      link: room.link.value,
      renderer: room.renderer.value.state,
      isLate,
      paintedAt: header ? this.#paintedAt : 0,
      isAway: who.isAway,
    });
    const words = isFolded
      ? say.presents({ name: who.name })
      : [live.text, who.name, shown ? nameOf(shown) : ''].filter(Boolean).join(' · ');
    queueMicrotask(() => this.#start(this.#host.querySelector('canvas')));
    return html`<section class="watch" data-corner=${this.corner} data-state=${live.state} ?data-folded=${isFolded} aria-label=${say.picture}
      ${variables({ '--x': `${at.x}px`, '--y': `${at.y}px`, '--wide': `${at.width}px`, '--high': `${at.height}px`, ...this.#box() })}>
      <div class="watch-head" @pointerdown=${(event) => this.#drag(event)}>
        <p role="status" title=${[words, live.why].filter(Boolean).join('. ')}>${words}</p>
        <button class="icon-button small" title=${say.move} aria-label=${say.movePicture} @click=${() => this.#next()}>${icon('flip', 12)}</button>
        ${
          at.isTight
            ? nothing
            : html`<button class="icon-button small" aria-expanded=${!isFolded} title=${isFolded ? say.unfold : say.fold}
              aria-label=${isFolded ? say.unfoldPicture : say.foldPicture} @click=${() => {
                watching.isFolded.value = !isFolded;
              }}>${icon(isFolded ? 'chevronLeft' : 'chevronDown', 12)}</button>`
        }
        <button class="icon-button small" title=${say.close} aria-label=${say.closePicture} @click=${() => {
          watching.isClosed.value = true;
        }}>${icon('close', 12)}</button></div>
      ${
        isFolded
          ? nothing
          : html`<button class="watch-picture" title=${say.returnTo({ name: who.name })} @click=${() => room.following.return()}>
        <canvas width="16" height="16" ?hidden=${!header}></canvas>
        <svg class="overlay" aria-hidden="true">${header ? this.#overlay(header, shown, at) : nothing}</svg>
        <span class="hidden">${say.returnToPicture({ name: who.name, picture: this.#spoken(header, shown) })}</span></button>
        ${this.#missing.value ? html`<p class="watch-missing">${icon('warning', 12)} ${say.missing({ n: this.#missing.value })}</p>` : nothing}`
      }
    </section>`;
  }

  /** The box of the panes in their parent. */
  #box() {
    const { offsetLeft: left, offsetTop: top, offsetWidth: width, offsetHeight: height } = this.#panes;
    const parent = this.#panes.parentElement;
    return {
      '--left': `${left}px`,
      '--top': `${top}px`,
      '--right': `${parent.clientWidth - left - width}px`,
      '--bottom': `${parent.clientHeight - top - height}px`,
    };
  }

  #spoken(header, shown) {
    if (!header || !shown) return say.noneYet;
    const { left, right, top, bottom } = edgeLetters(header.clip_from_lps_mm);
    const edges = isDrafted(this.#world.room.plan.value, this.#world.room.sharedScene) ? say.edgesDraft : say.edges;
    return edges({ view: nameOf(shown), left, right, top, bottom });
  }

  #overlay(header, { kind }, { width, height }) {
    const { room } = this.#world;
    const [scene, plan] = [room.sharedScene, room.plan.value];
    const scale = Math.min(width / header.width_px, height / header.height_px);
    const box = { width: header.width_px * scale, height: header.height_px * scale };
    const hasPoint = scene && !isTilted(kind) && (plan?.images.length || plan?.regions.length);
    const draft = isDrafted(plan, scene) ? svg`<text class="halo draft-word" x="6" y="16">${say.draftBeam}</text>` : nothing;
    return svg`${draft}${overlay({ kind, ground: scene?.space?.background, header, box: { ...box, x: (width - box.width) / 2, y: (height - box.height) / 2 }, pane: [width, height], point: hasPoint ? crosshair(scene) : null, pxPerMm: 0, windowText: '' })}`;
  }

  #next() {
    this.#world.watching.corner.value = corners[(corners.indexOf(this.corner) + 1) % corners.length];
  }

  /** Dragged by its head it goes to the corner that it is let go in. */
  #drag(event) {
    if (event.button !== 0 || event.target.closest('button')) return;
    const head = event.currentTarget;
    const card = head.parentElement;
    const from = placeOf(event);
    const abort = new AbortController();
    const on = (type, act) => head.addEventListener(type, act, { signal: abort.signal });
    const end = () => {
      abort.abort();
      card.style.removeProperty('translate');
    };
    head.setPointerCapture(event.pointerId);
    on('pointermove', (move) => {
      const { x, y } = placeOf(move);
      card.style.setProperty('translate', `${x - from.x}px ${y - from.y}px`);
    });
    on('pointerup', () => {
      const [box, all] = [boxOf(card), boxOf(this.#panes)];
      end();
      const vertical = box.top + box.bottom > all.top + all.bottom ? 'bottom' : 'top';
      this.#world.watching.corner.value = `${vertical}-${box.left + box.right > all.left + all.right ? 'right' : 'left'}`;
    });
    on('pointercancel', end);
  }
}

/** @param {object} world {room, ui, connection, decode, watching} @returns {() => void} stops */
export function startPicture(world) {
  const small = new Small(world);
  return () => small.stops.forEach((stop) => stop());
}
