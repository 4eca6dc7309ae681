// Asks the server about a beam: entry, depths, angles, what lies in its aperture. One question at a time, and the newest scene next, so that
// numbers follow a drag by at most one answer and an older answer never replaces a newer one.
import { Answer } from '../../parts/answer.js';
import { mergePatch } from '../../wire/merge.js';
import { isComparing, isDraftOn } from './beam_ui.js';

const known = new WeakMap(); // room -> Map of beam id -> BeamFacts

/** The facts of one beam of the plan; '': of the one that the scene chooses, or of its draft. Asked for while somebody reads them. */
export function beamFacts({ room, api, clock }, id = '') {
  if (!known.has(room)) known.set(room, new Map());
  const all = known.get(room);
  if (!all.has(id)) all.set(id, new BeamFacts(room, api, clock, id));
  return all.get(id);
}

export class BeamFacts {
  #room;
  #api;
  #id;

  constructor(room, api, clock, id) {
    this.#room = room;
    this.#api = api;
    this.#id = id;
    /** {result, error, isOld}: isOld: of what was before, while the newer answer is still to come */
    this.answer = new Answer({
      key: () => this.#key(),
      ask: (key) => this.#ask(JSON.parse(key)[2]),
      clock,
      isSettled: () => !room.isScenePending.value,
      clears: true,
      whileRead: true,
    }).state;
  }

  /** Diameter of the ring of a beam's-eye view that is on the screen, mm; null: the beam's own. */
  #ring() {
    const view = this.#room.views.find(({ kind, isOpen, document }) => kind === 'beam' && isOpen.value && document.value.beam?.aperture_mm);
    return view?.document.value.beam.aperture_mm ?? null;
  }

  /** Everything that the answer depends on. */
  #key() {
    const { plan, scene, renderer, planId } = this.#room;
    if (renderer.value.state !== 'ready' || !plan.value || !scene.value?.beam) return '';
    const { id, draft } = scene.value.beam;
    const drafted = isDraftOn(this.#room) ? draft.line : null;
    if (!this.#id && !drafted && !plan.value.beams.length) return '';
    return JSON.stringify([planId.value, this.#id ? null : [id, drafted], this.#ring()]);
  }

  /** For a member on their own with their override, so that the answer is of the scene that they see; of the draft, also while the planned beam is
   *  looked at. */
  #ask(ring) {
    const override = this.#room.following.override.peek();
    const shown = isComparing(this.#room) ? mergePatch(override ?? {}, { beam: { draft: { shows_planned: false } } }) : override;
    return this.#api.ofScene(this.#room.planId.peek(), 'beam', this.#room.id, shown ? { override: shown } : {}, {
      ...(this.#id ? { beam: this.#id } : {}),
      ...(ring ? { aperture_mm: ring } : {}),
    });
  }
}
