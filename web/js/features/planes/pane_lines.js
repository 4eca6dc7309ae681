// In a slice pane: the lines in which clip planes and oblique planes cut the slice, and the handles that move and turn them.
import { html, nothing, svg } from '../../../lib/lit-html.js';
import { repeat } from '../../../lib/directives/repeat.js';
import { clipName, clipRow, clipWords, enabledClips, keepsWords, movedClip, positionOfClip, rangeOfClip } from '../clip/clip.js';
import {
  angleBetween,
  heightOver,
  nearestIn,
  obliqueName,
  originAt,
  planeOfNormal,
  planeOfView,
  positionOf,
  reachOf,
  roundedOrigin,
  turned,
} from '../../room/obliques.js';
import { isInSpace } from '../../room/kinds.js';
import { handleBox, heightsOver, keptPart, lineOf, namePlace, onLine, takenIn } from './plane_lines.js';
import { fromPicture, subtract } from '../../parts/vec.js';
import { clipChips } from './clip_chips.js';
import { clipPosition } from '../clip/clip_rows.js';
import { icon } from '../../parts/icons.js';
import { variables } from '../../parts/mount.js';
import { pickingLayer } from './pane_picking.js';
import { number } from '../../parts/format.js';
import { sliderKey } from '../../parts/slider_keys.js';
import { say } from './words.js';
import { boxOf, placeOf } from '../../parts/page_look.js';

const namesFrom = 240; // px of width
const [turnPart, degrees] = [0.93, Math.PI / 180];
const partOf = {
  axial_high: 0.1,
  axial_low: 0.22,
  coronal_high: 0.1,
  coronal_low: 0.22,
  sagittal_high: 0.1,
  sagittal_low: 0.22,
  beam: 0.34,
  free: 0.34,
}; // where on a line its handle is, so that two of an axis stand apart
const clampOrigin = (origin) => roundedOrigin(origin.map((value) => Math.min(Math.max(value, -1e5), 1e5)));

/**
 * @typedef {object} Line a plane that cuts the slice
 * @property {'clip'|'oblique'} kind @property {string} id @property {string} name @property {string} text its position in words
 * @property {{origin, normal}} plane clip: its normal to what is cut off @property {number} position along its axis, mm
 * @property {{low, high}} range @property {number} sign of the position along the normal @property {number} part where its handle is
 * @property {(position: number) => object} moved the patch @property {((origin, normal) => object)|null} turnedTo the patch
 */

export class PaneLines {
  #room;
  #ui;
  #view;
  #place;
  #along = new Map(); // the direction in which each line ran last
  #held = null; // the drag: its line as it was, and where it was taken

  /** @param {() => {box: {x, y, width, height}, pane: number[]}} place of the picture in the pane, CSS px */
  constructor(room, ui, view, place) {
    this.#room = room;
    this.#ui = ui;
    this.#view = view;
    this.#place = place;
  }

  /** In the head of the pane: what the clip planes keep whose lines it has. */
  head() {
    const { pane } = this.#place();
    const [plan, scene] = [this.#room.plan.value, this.#room.scene.value];
    if (isInSpace(this.#view.kind) || !this.#view.painted.value || !scene?.clip || !plan || pane[0] < 2) return nothing;
    const clips = this.#shown(plan, scene).filter(({ kind, cut }) => kind === 'clip' && cut);
    return clipChips(clips, (id) => this.#ui.choose('clip', id));
  }

  /** Below the letters: what is cut off, dimmed, and the lines. Above them: the handles. */
  draw() {
    const { box, pane } = this.#place();
    const [plan, scene] = [this.#room.plan.value, this.#room.scene.value];
    if (isInSpace(this.#view.kind) || !this.#view.painted.value || !scene?.clip || !plan || pane[0] < 2)
      return { lines: nothing, handles: nothing };
    const shown = this.#shown(plan, scene);
    const cut = shown.filter((line) => line.cut);
    return {
      lines: html`<svg class="overlay clip-lines" aria-hidden="true">${this.#dimmed(
        shown.filter(({ kind }) => kind === 'clip'),
        box,
      )}${cut.map((line) => drawnLine(line))}${pane[0] >= namesFrom ? this.#names(cut, pane, scene) : nothing}</svg>`,
      handles: html`${
        cut.length
          ? html`<div class="clip-handles">${repeat(
              cut,
              ({ kind, id }) => `${kind} ${id}`,
              (line) => html`${this.#handle(line)}${line.turnAt ? this.#turnHandle(line) : nothing}`,
            )}</div>`
          : nothing
      }${pickingLayer({ room: this.#room, ui: this.#ui }, this.#view, box)}`,
    };
  }

  /** The planes with their lines in this picture. */
  #shown(plan, scene) {
    const { box } = this.#place();
    const header = this.#view.painted.value;
    return this.#lines(plan, scene).map((line) => {
      const heights = heightsOver(line.plane, header.clip_from_lps_mm, this.#slice(scene).origin, box);
      const cut = lineOf(heights, box, this.#along.get(line.id));
      if (cut) this.#along.set(line.id, cut.along);
      return {
        ...line,
        heights,
        cut,
        at: cut && onLine(cut, line.part),
        turnAt: cut && line.turnedTo && onLine(cut, turnPart),
        isChosen: this.#isChosen(line),
      };
    });
  }

  /** @returns {Line[]} */
  #lines(plan, scene) {
    const clips = enabledClips(plan, scene).map(({ id, origin, normal }) => {
      const position = positionOfClip(plan, scene, id);
      return {
        kind: 'clip',
        id,
        name: clipName(id),
        label: keepsWords(id)
          ? say.clipHandle({ plane: clipWords(id), keeps: keepsWords(id) })
          : say.clipHandleAny({ plane: clipWords(id) }),
        text: clipPosition(clipRow(id), position),
        plane: { origin, normal },
        position,
        range: rangeOfClip(plan, scene, id),
        sign: /_low$|^beam$/.test(id) ? -1 : 1,
        part: partOf[id],
        moved: (mm) => movedClip(plan, scene, id, mm),
        turnedTo: id === 'free' ? (origin_mm, normal) => ({ clip: { free: { origin_mm, normal } } }) : null,
      };
    });
    return [...clips, ...this.#obliques(plan, scene)];
  }

  /** Those that are shown in 3-D or in a pane, and the chosen one; not this pane's own. */
  #obliques(plan, scene) {
    const inPanes = this.#room.views
      .filter((view) => view.kind === 'oblique' && view.isOpen.value)
      .map((view) => view.document.value.plane);
    const own = this.#view.kind === 'oblique' ? this.#view.document.value.plane : '';
    const chosen = this.#ui.selection.value;
    return Object.entries(scene.image.obliques ?? {})
      .filter(([id, { visible }]) => id !== own && (visible || inPanes.includes(id) || (chosen.kind === 'oblique' && chosen.id === id)))
      .map(([id, oblique], n) => {
        const plane = planeOfNormal(oblique.origin_mm, oblique.normal);
        const name = obliqueName(id, oblique);
        const change = (fields) => ({ image: { obliques: { [id]: fields } } });
        const range = reachOf(plane.normal, plan.bounds);
        return {
          kind: 'oblique',
          id,
          name,
          words: name,
          label: name,
          text: `${positionOf(plane).toFixed(1).replace('-', '−')} mm`,
          plane,
          position: positionOf(plane),
          range,
          sign: 1,
          part: 0.28 + 0.07 * n,
          moved: (mm) => change({ origin_mm: originAt(plane, Math.min(Math.max(mm, range.low), range.high)) }),
          turnedTo: (origin_mm, normal) => change({ origin_mm, normal }),
        };
      });
  }

  #slice(scene) {
    return planeOfView(scene, this.#view.document.value, this.#room.plan.value);
  }

  #isChosen({ kind, id }) {
    const { selection } = this.#ui;
    return selection.value.kind === kind && selection.value.id === id;
  }

  #dimmed(clips, box) {
    if (!clips.length) return nothing;
    const kept = keptPart(
      clips.map(({ heights }) => heights),
      box,
    );
    const path = (points) => (points.length > 2 ? `M${points.map(([x, y]) => `${x.toFixed(1)} ${y.toFixed(1)}`).join('L')}Z` : '');
    const whole = [
      [box.x, box.y],
      [box.x + box.width, box.y],
      [box.x + box.width, box.y + box.height],
      [box.x, box.y + box.height],
    ];
    return svg`<path class="clip-dim" fill-rule="evenodd" d=${path(whole) + path(kept)} />`;
  }

  #names(cut, pane, scene) {
    const taken = [...takenIn(pane), ...cut.flatMap(({ at, turnAt }) => [handleBox(at), ...(turnAt ? [handleBox(turnAt)] : [])])];
    return cut.map((line) => {
      if (line.kind === 'clip') return nothing; // their words stand in the head
      const place = namePlace(line.cut, line.words, pane, taken);
      if (!place) return nothing;
      taken.push(place);
      return svg`<text class="halo caption" x=${place.x + 2} y=${place.y + 12}>${line.words}</text>`;
    });
  }

  // ---- handles ----------------------------------------------------------------------------------------------------------

  #handle(line) {
    const [x, y] = line.at;
    const angle = Math.atan2(line.cut.over[1], line.cut.over[0]) / degrees;
    const isClip = line.kind === 'clip';
    return html`<i class=${`clip-handle${line.isChosen ? ' chosen' : ''}`} role="slider" tabindex="0" data-plane=${line.id} aria-label=${isClip ? line.label : say.planeHandle({ plane: line.label })}
      aria-valuemin=${line.range.low} aria-valuemax=${line.range.high} aria-valuenow=${Math.round(line.position * 10) / 10 || 0} aria-valuetext=${line.text} title=${say.handleIs({ plane: line.name, position: line.text })}
      ${variables({ '--x': `${x}px`, '--y': `${y}px` })} @pointerdown=${(event) => this.#hold(event, line)} @pointermove=${(event) => this.#drag(event)} @pointerup=${() => {
        this.#held = null;
      }} @pointercancel=${() => {
        this.#held = null;
      }}
      @keydown=${(event) => this.#key(event, line, 'move')} @focus=${() => this.#focus(line)}><svg viewBox="-32 -32 64 64" width="64" height="64" aria-hidden="true"><g transform=${`rotate(${angle.toFixed(2)})`}>
        ${isClip ? svg`<path class="clip-arrow under" d="M-17 0h-11M-24 -4l-4 4 4 4" /><path class="clip-arrow" d="M-17 0h-11M-24 -4l-4 4 4 4" />` : nothing}
        <rect x="-13" y="-8" width="26" height="16" rx="6" /><path class="clip-grips" d="M-4 -4v8M0 -4v8M4 -4v8" /></g></svg></i>`;
  }

  #turnHandle(line) {
    const [x, y] = line.turnAt;
    const angle = Math.round(Math.atan2(line.cut.from[1] - line.cut.to[1], line.cut.to[0] - line.cut.from[0]) / degrees);
    return html`<i class=${`clip-handle clip-turn${line.isChosen ? ' chosen' : ''}`} role="slider" tabindex="0" data-turn=${line.id} aria-label=${line.kind === 'clip' ? say.turnFree : say.turn({ plane: line.name })}
      aria-valuemin="-180" aria-valuemax="180" aria-valuenow=${angle} aria-valuetext=${say.turnedBy({ n: number(angle) })} title=${say.turnIs({ plane: line.name })}
      ${variables({ '--x': `${x}px`, '--y': `${y}px` })} @pointerdown=${(event) => this.#hold(event, line, true)} @pointermove=${(event) => this.#drag(event)} @pointerup=${() => {
        this.#held = null;
      }} @pointercancel=${() => {
        this.#held = null;
      }}
      @keydown=${(event) => this.#key(event, line, 'turn')} @focus=${() => this.#focus(line)}><span>${icon('reset', 12)}</span></i>`;
  }

  #focus({ kind, id }) {
    this.#ui.active.value = this.#view.number;
    this.#ui.select(kind, id, false);
  }

  /** The patient point under the pointer, on the slice shown. */
  #point(event, scene) {
    const { left, top } = boxOf(event.currentTarget.closest('.picture'));
    const { x, y } = placeOf(event);
    const { box } = this.#place();
    return fromPicture(
      this.#view.painted.value.clip_from_lps_mm,
      [(x - left - box.x) / box.width, (y - top - box.y) / box.height],
      this.#slice(scene).origin,
    );
  }

  #hold(event, line, isTurn = false) {
    event.stopPropagation();
    if (event.button > 0 || !this.#room.canChange.value) return;
    event.preventDefault();
    event.currentTarget.setPointerCapture(event.pointerId);
    event.currentTarget.focus({ preventScroll: true });
    this.#ui.select(line.kind, line.id);
    const scene = this.#room.scene.value;
    const point = this.#point(event, scene);
    this.#held = { line, isTurn, point, grab: heightOver(line.plane, point), slice: this.#slice(scene), pivot: this.#pivot(line, scene) };
  }

  /** The pivot of a plane: the point of its line in the slice that is nearest to its origin. */
  #pivot({ plane }, scene) {
    const slice = this.#slice(scene);
    const start = nearestIn(slice, plane.origin);
    const inSlice = subtract(
      plane.normal,
      slice.normal.map((part) => part * plane.normal.reduce((sum, value, axis) => sum + value * slice.normal[axis], 0)),
    );
    const size = inSlice.reduce((sum, part) => sum + part * part, 0);
    return size > 1e-12 ? start.map((value, axis) => value - (inSlice[axis] * heightOver(plane, start)) / size) : start;
  }

  #drag(event) {
    event.stopPropagation(); // no card at the pointer beside the handle
    const held = this.#held;
    if (!held || !event.currentTarget.hasPointerCapture(event.pointerId)) return;
    const point = this.#point(event, this.#room.scene.value);
    const { line, slice, pivot } = held;
    if (held.isTurn)
      this.#change(this.#turn(line, pivot, slice, angleBetween(slice, subtract(held.point, pivot), subtract(point, pivot))), event);
    else this.#change(line.moved(line.position + line.sign * (heightOver(line.plane, point) - held.grab)), event);
  }

  #turn({ plane, turnedTo }, pivot, slice, angleRad) {
    return turnedTo(clampOrigin(pivot), turned(plane.normal, slice.normal, angleRad));
  }

  #key(event, line, what) {
    if (!this.#room.canChange.value) return;
    const to = what === 'move' ? sliderKey(event, line.position, line.range) : sliderKey(event, 0, { low: -180, high: 180 });
    if (to === null || (what === 'turn' && Math.abs(to) === 180)) return;
    event.preventDefault();
    event.stopPropagation();
    const scene = this.#room.scene.value;
    this.#change(what === 'move' ? line.moved(to) : this.#turn(line, this.#pivot(line, scene), this.#slice(scene), to * degrees), event);
  }

  #change(patch, event) {
    this.#room.patchScene(patch, { view: this.#view.number, at: event.timeStamp });
  }
}

/** A dark halo, then the line; dashed for a plane that cuts nothing. */
function drawnLine({ kind, cut: { from, to }, isChosen }) {
  return svg`<g class=${`clip-line ${kind}${isChosen ? ' chosen' : ''}`}>${['under', 'ink'].map((layer) => svg`<line class=${layer} x1=${from[0]} y1=${from[1]} x2=${to[0]} y2=${to[1]} />`)}</g>`;
}
