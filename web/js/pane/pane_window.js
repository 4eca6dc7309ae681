// Window and level of the shown image, as a pane's drag and keys change them.
import { draggedWindow, isCt, roundedWindow, windowPresets } from '../room/image_look.js';
import { shownImage } from '../room/plan.js';

export class PaneWindow {
  #room;
  #number;
  #histograms;

  /** @param {import('../room/room.js').RoomState} room @param {import('../features/image/histograms.js').Histograms} histograms @param {number} number of the view */
  constructor(room, histograms, number) {
    this.#room = room;
    this.#histograms = histograms;
    this.#number = number;
  }

  get image() {
    return shownImage(this.#room.plan.value, this.#room.scene.value);
  }

  drag(dx, dy, at) {
    this.set(draggedWindow(this.image, this.#room.scene.value.image.window, dx, dy), at);
  }

  set(window, at) {
    this.#room.patchScene({ image: { window: roundedWindow(window) } }, { view: this.#number, at });
  }

  /** The preset with this key; one of percentiles only once the histogram is there. */
  async setPreset(key, at) {
    const { image } = this;
    const find = (histogram) => windowPresets(image, histogram).find((other) => other.key === key);
    const preset = find(null) ?? (isCt(image) ? null : find(await this.#histograms.load(this.#room.planId.value, image.id)));
    if (preset && image === this.image) this.set(preset, at);
  }
}
