// Where the labels of isodose lines stand in slice panes: asked of the server for each picture at rest, shown while that picture is.
import { effect, signal } from '../../../lib/signals-core.js';
import { isInSpace } from '../../room/kinds.js';
import { Asker } from '../../parts/asker.js';

export const labelPx = 10.5; // CSS px: size of the font

/** Names the picture that labels belong to. */
const pictureOf = (header) => `${header.scene_revision} ${header.clip_from_lps_mm}`;

export class DoseLabels {
  #room;
  #api;
  #known; // by view number: signal {picture, levels}

  /** @param {import('../../room/room.js').RoomState} room @param {object} api of net/api.js */
  constructor(room, api) {
    this.#room = room;
    this.#api = api;
    this.#known = new Map(room.views.map(({ number }) => [number, signal(null)]));
  }

  /** The labels of the picture that a view shows, by level; [] while there are none. @returns {{id: string, color: string, text: string, labels: object[]}[]} */
  of(view) {
    const known = this.#known.get(view.number).value;
    const header = view.painted.value;
    return known && header && known.picture === pictureOf(header) ? known.levels : [];
  }

  /** @returns {() => void} stops asking */
  start(clock) {
    const stops = this.#room.views.map((view) => this.#follow(view, clock));
    return () => {
      for (const stop of stops) stop();
    };
  }

  #follow(view, clock) {
    const room = this.#room;
    const known = this.#known.get(view.number);
    const wanted = () => {
      const header = view.painted.value;
      const isShown =
        header?.is_still &&
        view.isOpen.value &&
        !isInSpace(view.kind) &&
        room.plan.value?.doses.length &&
        room.scene.value?.dose.lines.visible;
      return isShown ? pictureOf(header) : '';
    };
    const asker = new Asker(async () => {
      const picture = wanted();
      if (!picture || known.peek()?.picture === picture) return;
      const textPx = labelPx * Math.min(globalThis.devicePixelRatio || 1, 2); // as the size of the picture
      const answer = await this.#api.isolines(room.planId.peek(), room.id, view.document.peek(), textPx).catch(() => null); // the lines say it too: by their colours, in the legend
      known.value = { picture, levels: answer?.levels ?? [] };
    }, clock);
    const stop = effect(() => {
      const picture = wanted();
      if (picture && known.peek()?.picture !== picture) asker.want();
    });
    return () => {
      stop();
      asker.stop();
    };
  }
}
