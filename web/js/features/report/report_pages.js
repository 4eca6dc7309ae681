// The report to print: chosen snapshots with captions, and figures of the regions. Kept in this tab until it is closed.
import { signal } from '../../../lib/signals-core.js';
import { crosshair } from '../../room/plan.js';
import { shapeQuery } from '../regions/shapes.js';

const mostFigures = 128; // regions whose surfaces are measured

/**
 * @typedef {object} PrintoutEntry
 * @property {number} key @property {string} url of the PNG: a data URL @property {string} caption
 * @property {import('./snapshot_record.js').SnapshotRecord} record
 * @property {object|null} probe the API's answer at the crosshair; null: not known
 */

const dataUrl = (blob) =>
  new Promise((resolve, reject) => {
    const reader = new FileReader();
    reader.onload = () => resolve(reader.result);
    reader.onerror = () => reject(reader.error);
    reader.readAsDataURL(blob);
  });

export class Printout {
  #api;
  #storage;
  #storageKey;
  #nextKey = 1;
  #pending = null;

  /** @param {string} room its id @param {object} api @param {Storage} storage */
  constructor(room, api, storage) {
    this.#api = api;
    this.#storage = storage;
    this.#storageKey = `printout ${room}`;
    this.entries = signal([]); // PrintoutEntry[]
    this.figures = signal([]); // {region, method, result, error}[], of the regions that the snapshots show; error null: not measured, beyond mostFigures
    this.isComplete = signal(true); // all figures are there
    this.isKept = signal(true); // false: too large to be there after the page is loaded again
    try {
      this.entries.value = JSON.parse(storage.getItem(this.#storageKey)) ?? [];
      this.#nextKey = 1 + Math.max(0, ...this.entries.value.map(({ key }) => key));
    } catch {
      /* nothing was kept */
    }
  }

  /** Adds a snapshot of this view, with the values at its crosshair. Throws when there is no picture. */
  async add(room, document) {
    const blob = await this.#api.snapshot(room, document, false, '&crosshair=true');
    const record = await (await import('./snapshot_record.js')).recordOfFile(blob);
    const probe = await this.#api.probe(room.planId.value, crosshair(record.scene)).catch(() => null);
    this.#set([...this.entries.value, { key: this.#nextKey++, url: await dataUrl(blob), caption: '', record, probe }]);
  }

  remove(key) {
    this.#set(this.entries.value.filter((entry) => entry.key !== key));
  }

  /** @param {1|-1} by later or earlier */
  move(key, by) {
    const entries = [...this.entries.value];
    const at = entries.findIndex((entry) => entry.key === key);
    if (!entries[at + by]) return;
    [entries[at], entries[at + by]] = [entries[at + by], entries[at]];
    this.#set(entries);
  }

  /** While a caption is typed; keep() at its end. */
  describe(key, caption) {
    this.entries.value = this.entries.value.map((entry) => (entry.key === key ? { ...entry, caption } : entry));
  }

  #set(entries) {
    this.entries.value = entries;
    this.keep();
  }

  /** Stores the entries, so that they are there after the page is loaded again. */
  keep() {
    try {
      this.#storage.setItem(this.#storageKey, JSON.stringify(this.entries.value));
      this.isKept.value = true;
    } catch {
      this.#storage.removeItem(this.#storageKey);
      this.isKept.value = false;
    }
  }

  /** Measures the surfaces of the regions that the snapshots show, as their newest one draws them. */
  async measure(planId, plan) {
    this.stop();
    const { signal: aborted } = (this.#pending = new AbortController());
    const wanted = plan.regions.flatMap((region) => {
      const entry = this.entries.value.findLast(({ record }) => isShown(record.scene, region));
      return entry && region.voxels > 0 ? [{ region, query: figureQuery(entry.record.scene, region) }] : [];
    });
    this.figures.value = wanted.map(({ region, query }, at) => ({
      region,
      method: query.algorithm ?? query.representation,
      result: null,
      error: at < mostFigures ? '' : null,
    }));
    this.isComplete.value = !wanted.length;
    for (const [at, { region, query }] of wanted.slice(0, mostFigures).entries()) {
      const answer = await this.#api.surface(planId, region.id, query, aborted).then(
        (result) => ({ result }),
        (error) => ({ error: error.message }),
      );
      if (aborted.aborted) return;
      this.figures.value = this.figures.value.map((row, index) => (index === at ? { ...row, ...answer } : row));
    }
    this.isComplete.value = true;
  }

  stop() {
    this.#pending?.abort();
    this.#pending = null;
  }
}

const isShown = (scene, { id }) => Boolean(scene.regions[id]?.visible) && scene.regions[id].opacity > 0;

/** Lines and points have no surface: for those it is the scene's own. */
function figureQuery(scene, { id }) {
  const { representation } = scene.regions[id];
  return shapeQuery(scene, ['outline', 'points', 'solid'].includes(representation) ? 'surface' : representation);
}
