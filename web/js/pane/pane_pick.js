// Picks at a place in a pane's picture: asks the server for the hit that is seen, or for the values at the point.
import { crosshair } from '../room/plan.js';
import { planeOfView } from '../room/obliques.js';
import { isInSpace, isTilted } from '../room/kinds.js';
import { fromPicture } from '../parts/vec.js';

export class PanePick {
  #room;
  #api;
  #view;
  #box;
  #newest = 0;

  /** @param {import('../room/view.js').ViewState} view @param {() => {x: number, y: number, width: number, height: number}} box of the picture in the pane, CSS px */
  constructor(room, api, view, box) {
    this.#room = room;
    this.#api = api;
    this.#view = view;
    this.#box = box;
  }

  #fraction(x, y) {
    const box = this.#box();
    return [(x - box.x) / box.width, (y - box.y) / box.height];
  }

  /** Pixels of the view in its full size; null beside the picture. A reduced picture may reach beyond the view. */
  #pixelAt(x, y) {
    const { size_px: size } = this.#view.document.value;
    const header = this.#view.painted.value;
    if (!header || !size) return null;
    const scale = header.scale_percent / 100;
    const at = this.#fraction(x, y).map((part, i) => (part * header.full_px[i] * scale * size[i]) / Math.round(size[i] * scale));
    return at.every((px, i) => px >= 0 && px < size[i]) ? at : null;
  }

  /** In a slice pane: the patient point at a place, on the slice shown; null before the first picture. */
  pointAt(x, y) {
    const header = this.#view.painted.value;
    const scene = this.#room.scene.value;
    return header && scene ? fromPicture(header.clip_from_lps_mm, this.#fraction(x, y), this.#onPlane(scene)) : null;
  }

  /** The crosshair lies in the three slices; in a tilted pane it may be beside the plane. */
  #onPlane(scene) {
    return isTilted(this.#view.kind) ? planeOfView(scene, this.#view.document.value, this.#room.plan.value).origin : crosshair(scene);
  }

  /** The hit that a person sees at a place; null: none, or a newer question has been asked. */
  async seenAt(x, y, prefer = '') {
    const number = ++this.#newest;
    const hit = await this.#hit(x, y, prefer);
    return number === this.#newest ? hit : null;
  }

  async #hit(x, y, prefer = '') {
    const at = this.#pixelAt(x, y);
    if (!at) return null;
    const { hits } = await this.#api.pick(this.#room.planId.value, this.#room.id, this.#view.document.value, ...at, prefer);
    return hits.find(({ seen }) => seen) ?? null;
  }

  /** The particle track that is seen at a place; null: none, or a newer question has been asked. */
  async trackAt(x, y) {
    const at = this.#pixelAt(x, y);
    if (!at) return null;
    const number = ++this.#newest;
    const track = await this.#api.ofScene(this.#room.planId.value, 'track', this.#room.id, this.#view.document.value, {
      px: at[0],
      py: at[1],
    });
    return number === this.#newest && track.segment !== null ? track : null;
  }

  /** Regions and image values at a place, for the read-out; null where there is nothing. */
  async factsAt(x, y) {
    const [u, v] = this.#fraction(x, y);
    if (u < 0 || v < 0 || u >= 1 || v >= 1) return null;
    if (!isInSpace(this.#view.kind)) {
      const point = this.pointAt(x, y);
      const result = point && (await this.#api.probe(this.#room.planId.value, point));
      return result && (result.regions.length || result.images.length) ? this.#withDose(result) : null;
    }
    const hit = await this.#hit(x, y);
    return hit && this.factsOf(hit);
  }

  /** Facts of a hit: in 3-D the region seen and those it lies in, in a slice the values there. */
  async factsOf({ region, point_lps_mm }) {
    if (region === null) return this.#withDose(await this.#api.probe(this.#room.planId.value, point_lps_mm));
    const regions = [];
    const parentOf = (id) => this.#room.plan.value?.regions.find((other) => other.id === id)?.parent;
    for (let id = region; id && !regions.includes(id); id = parentOf(id)) regions.push(id);
    return this.#withDose({ regions, images: [], point_lps_mm, onSurface: true });
  }

  /** With the dose at the point, while the scene shows it. */
  async #withDose(facts) {
    const { wash, lines, surfaces } = this.#room.scene.value.dose;
    if (!this.#room.plan.value?.doses.length || !(wash.visible || lines.visible || surfaces.visible)) return facts;
    const [x, y, z] = facts.point_lps_mm;
    const { override } = this.#view.document.value;
    const dose = await this.#api
      .ofScene(this.#room.planId.value, 'dose/probe', this.#room.id, override ? { override } : {}, { x, y, z })
      .catch(() => null);
    return { ...facts, dose };
  }
}
