// The tool that moves entry or target of the chosen beam, or of its draft, in panes of every kind: by dragging and by keys. A drag is one step of undo.
import { html, nothing, svg } from '../../../lib/lit-html.js';
import { repeat } from '../../../lib/directives/repeat.js';
import { classMap } from '../../../lib/directives/class-map.js';
import { movedInPicture, shownLine } from './beams.js';
import { movedPoint } from './beam_ui.js';
import { heightOver } from '../../room/obliques.js';
import { isInSpace } from '../../room/kinds.js';
import { add, pictureAxes, scale, toPicture } from '../../parts/vec.js';
import { setLine } from './beam_actions.js';
import { coordinates } from './beam_words.js';
import { variables } from '../../parts/mount.js';
import { addTool } from '../../pane/pane_tools.js';
import { say } from './later_words.js';
import { boxOf } from '../../parts/page_look.js';

const words = { target: say.targetOfBeam, entry: say.entryOfBeam };
const inPlaneMm = 2; // farther from the slice a point is drawn faint
const takePx = 22; // a press this near to a point takes that one
const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/** Turns the tool on, in Selection with its beam. */
export function startMoving({ ui }, part = movedPoint.peek()) {
  movedPoint.value = part;
  ui.tool.value = 'beam';
}

class PaneMove {
  #pane;
  #held = null; // the drag: {part, from: the point, matrix and box of the picture, place: where it was taken, px of the window}

  /** @param {{room, ui, view, actions}} pane */
  constructor(pane) {
    this.#pane = pane;
  }

  get #line() {
    const { plan, scene } = this.#pane.room;
    return plan.value && scene.value?.beam ? shownLine(plan.value, scene.value) : null;
  }

  get #matrix() {
    return this.#pane.view.painted.value?.clip_from_lps_mm ?? null;
  }

  #pixel(point) {
    const at = toPicture(this.#matrix, point);
    const { box } = this.#pane.actions;
    return at && [box.x + at[0] * box.width, box.y + at[1] * box.height];
  }

  /** The chosen point last: it is on top. @returns {{part: string, point: number[], at: number[]}[]} those that are before the eye */
  get #points() {
    const line = this.#line;
    if (!line || !this.#matrix) return [];
    const order = movedPoint.value === 'target' ? ['entry', 'target'] : ['target', 'entry'];
    return order.map((part) => ({ part, point: line[`${part}_mm`], at: this.#pixel(line[`${part}_mm`]) })).filter(({ at }) => at);
  }

  // ---- pointer ----------------------------------------------------------------------------------------------------------

  start(mode, { x, y }) {
    this.#held = null;
    const points = this.#points;
    if (mode !== 'primary' || !points.length || !this.#pane.room.canChange.value) return false;
    const near = points.findLast(({ at }) => Math.hypot(x - at[0], y - at[1]) <= takePx);
    if (near) movedPoint.value = near.part;
    const part = movedPoint.value;
    this.#held = { part, from: this.#line[`${part}_mm`], matrix: this.#matrix, box: this.#pane.actions.box, place: this.#placeOf(x, y) };
    return true;
  }

  /** In the window: the pane may move under the pointer when the bar of the draft comes. */
  #placeOf(x, y) {
    const { left, top } = boxOf(document.querySelector(`#picture-${this.#pane.view.number}`));
    return [x + left, y + top];
  }

  /** Moves by the picture as it was when the drag began: a view that moves with its beam shows other places later. */
  move(mode, { x, y, at }) {
    if (!this.#held) return false;
    const { part, from, matrix, box, place } = this.#held;
    const now = this.#placeOf(x, y);
    this.#set(part, movedInPicture(matrix, from, [(now[0] - place[0]) / box.width, (now[1] - place[1]) / box.height]), at);
    return true;
  }

  end() {
    this.#held = null;
  }

  tap({ shift }) {
    return !shift && this.#points.length > 0; // chooses a point at most: start()
  }

  // ---- keys -------------------------------------------------------------------------------------------------------------

  /** Arrows move the chosen point by 1 mm along the picture's axes, with Shift by 10. */
  key({ key, shiftKey, ctrlKey }, at) {
    const [right, up] = steps[key] ?? [];
    if (right === undefined || ctrlKey || !this.#points.length) return null;
    return () => {
      const mm = shiftKey ? 10 : 1;
      const axes = pictureAxes(this.#matrix);
      this.#set(
        movedPoint.value,
        add(this.#line[`${movedPoint.value}_mm`], add(scale(axes.right, right * mm), scale(axes.up, up * mm))),
        at,
      );
    };
  }

  #set(part, point, at) {
    setLine(this.#pane, { [`${part}_mm`]: point }, { timeStamp: at }, this.#pane.view.number);
  }

  // ---- handles ----------------------------------------------------------------------------------------------------------

  draw() {
    const points = this.#points;
    return {
      handles: points.length
        ? html`<div class=${classMap({ 'beam-handles': true, on: this.#pane.room.canChange.value })}>${repeat(
            points,
            ({ part }) => part,
            (one) => this.#handle(one),
          )}</div>`
        : nothing,
    };
  }

  #isOff(point) {
    const { view, actions } = this.#pane;
    return !isInSpace(view.kind) && Math.abs(heightOver(actions.plane, point)) > inPlaneMm;
  }

  #handle({ part, point, at: [x, y] }) {
    const { room, ui, view } = this.#pane;
    const text = words[part]({ place: coordinates(point).join(', ') });
    const focus = () => {
      movedPoint.value = part;
      ui.active.value = view.number;
    };
    return html`<i class=${classMap({ 'beam-handle': true, chosen: movedPoint.value === part, off: this.#isOff(point) })} role="button" tabindex="0" data-part=${part} aria-label=${text} aria-disabled=${!room.canChange.value}
      title=${say.handle({ point: text })} ${variables({ '--x': `${x}px`, '--y': `${y}px` })} @focus=${focus}><svg viewBox="-22 -22 44 44" width="44" height="44" aria-hidden="true">${[
        'under',
        'ink',
      ].map((layer) =>
        part === 'target'
          ? svg`<g class=${layer}><circle r="7" /><path d="M-11 0h4M7 0h4M0 -11v4M0 7v4" /></g>`
          : svg`<g class=${layer}><path d="M0 -8L8 0L0 8L-8 0Z" /></g>`,
      )}<circle class="dot" r="1.8" /></svg></i>`;
  }
}

// Panes in which the tool is on already make theirs at once, so the class comes before.
addTool('beam', (pane) => new PaneMove(pane));
