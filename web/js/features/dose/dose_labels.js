// Where the labels of isodose lines stand in slice panes: asked of the server for each picture at rest, shown while that picture is.
import { isInSpace } from '../../room/kinds.js';
import { Answer } from '../../parts/answer.js';
import { pixelRatio } from '../../parts/page_look.js';

export const labelPx = 10.5; // CSS px: size of the font

/** Names the picture that labels belong to. */
const pictureOf = (header) => `${header.scene_revision} ${header.clip_from_lps_mm} ${header.full_px}`;

export class DoseLabels {
  #room;
  #api;
  #answers; // by view number
  #px;

  /** @param {import('../../room/room.js').RoomState} room @param {object} api of net/api.js @param {object} clock @param {number} px size of the font */
  constructor(room, api, clock, px = labelPx) {
    this.#room = room;
    this.#api = api;
    this.#px = px;
    this.#answers = new Map(room.views.map((view) => [view.number, this.#live(view, clock)]));
  }

  /** The labels of the picture that a view shows, by level; [] while there are none. @returns {{id: string, color: string, text: string, labels: object[]}[]} */
  of(view) {
    const answer = this.#answers.get(view.number);
    const { result } = answer.state.value; // none where it was refused: the lines say it too, by their colours, in the legend
    const header = view.painted.value;
    return result && header && answer.of === pictureOf(header) ? result : [];
  }

  /** @returns {() => void} stops asking */
  start() {
    const stops = [...this.#answers.values()].map((answer) => answer.start());
    return () => {
      for (const stop of stops) stop();
    };
  }

  #live(view, clock) {
    const room = this.#room;
    const key = () => {
      const header = view.painted.value;
      const isShown =
        header?.is_still &&
        view.isOpen.value &&
        !isInSpace(view.kind) &&
        room.plan.value?.doses.length &&
        room.scene.value?.dose.lines.visible;
      return isShown ? pictureOf(header) : '';
    };
    const ask = async () => {
      const ratio = Math.max(view.document.peek().pixel_ratio ?? 1, pixelRatio());
      const textPx = this.#px * ratio; // as the size of the picture
      const { levels } = await this.#api.isolines(room.planId.peek(), room.id, view.document.peek(), textPx);
      return levels;
    };
    return new Answer({ key, ask, clock });
  }
}
