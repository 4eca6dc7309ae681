// Asks the server about the dose that the scene shows: its scale, its values at the crosshair and at pinned probes. One question of
// each kind at a time, and the newest scene next, so that a slider that moves is never behind by more than one answer.
import { computed } from '../../../lib/signals-core.js';
import { Answer } from '../../parts/answer.js';
import { DoseLabels } from './dose_labels.js';
import { crosshair } from '../../room/plan.js';

const at = ([x, y, z]) => ({ x, y, z });

export class DoseFacts {
  #room;
  #api;
  #answers;

  /** @param {import('../../room/room.js').RoomState} room @param {object} api of net/api.js @param {object} clock @param {number} [labelPx] */
  constructor(room, api, clock, labelPx) {
    this.#room = room;
    this.#api = api;
    this.#answers = this.#live(clock);
    const { scale, here, coverage, gamma, pins } = this.#answers;
    /** {result, error, isOld}: the answer to the question dose */
    this.scale = scale.state;
    /** the same of dose_probe at the crosshair */
    this.here = here.state;
    /** the same of coverage and gamma, while they are shown */
    this.coverage = coverage.state;
    this.gamma = gamma.state;
    this.labels = new DoseLabels(room, api, clock, labelPx);
    /** by pin: {at, result, error} */
    this.pins = computed(() => pins.state.value.result ?? {});
    /** 100 % in the quantity's unit; null: not known */
    this.reference = computed(() => (this.isOfScene(this.scale.value.result) ? this.scale.value.result.reference.value : null));
  }

  /** True for an answer about the dose and the quantity that the scene shows; a change that is not answered yet has none. */
  isOfScene(answer) {
    const { id, quantity } = this.#room.scene.value?.dose ?? {};
    return Boolean(answer) && answer.quantity === quantity && answer.id === (id || this.#room.plan.value?.doses[0]?.id);
  }

  /** @returns {() => void} stops asking */
  start() {
    const stops = [...Object.values(this.#answers), this.labels].map((one) => one.start());
    return () => {
      for (const stop of stops) stop();
    };
  }

  /** The answers, asked for again when their key changes, and once more when the server has the change. */
  #live(clock) {
    const room = this.#room;
    const isReady = computed(
      () => room.renderer.value.state === 'ready' && Boolean(room.plan.value?.doses.length) && Boolean(room.scene.value),
    );
    const style = computed(() => (isReady.value ? JSON.stringify([scaleStyle(room.scene.value.dose), room.fitKey.value]) : ''));
    const place = computed(() => (isReady.value ? crosshair(room.scene.value).join(' ') : ''));
    const pinned = computed(() => (isReady.value ? JSON.stringify(room.scene.value.probes) : '{}'));
    const covered = computed(() =>
      isReady.value && room.scene.value.dose.coverage.visible ? JSON.stringify([style.value, room.scene.value.dose.coverage]) : '',
    );
    const compared = computed(() =>
      isReady.value && ['gamma', 'difference'].includes(room.scene.value.dose.compare.mode) && room.scene.value.dose.compare.id
        ? JSON.stringify([style.value, room.scene.value.dose.compare])
        : '',
    );
    const answer = (key, ask, more = {}) => new Answer({ key, ask, clock, isSettled: () => !room.isScenePending.value, ...more });
    return {
      scale: answer(
        () => style.value,
        () => this.#ask('dose', {}),
      ),
      here: answer(
        () => style.value && place.value && `${style.value} ${place.value}`,
        () => this.#ask('dose/probe', at(place.peek().split(' '))),
      ),
      pins: answer(this.#pinKey(style, pinned), () => this.#pinned(JSON.parse(pinned.peek())), { clears: true }),
      coverage: answer(
        () => covered.value,
        () => this.#ask('coverage', {}),
      ),
      gamma: answer(
        () => compared.value,
        () => this.#ask('gamma', {}),
      ),
    };
  }

  /** Pins are asked about once the server has the change. */
  #pinKey(style, pinned) {
    let settled = '';
    return () => {
      const [isPending, now] = [
        this.#room.isScenePending.value,
        pinned.value === '{}' ? '' : style.value && `${style.value} ${pinned.value}`,
      ];
      if (!isPending || !now) settled = now;
      return settled;
    };
  }

  async #pinned(pins) {
    const known = {};
    for (const [id, { at_mm: mm }] of Object.entries(pins)) {
      known[id] = await this.#ask('dose/probe', at(mm)).then(
        (result) => ({ at: mm, result, error: '' }),
        (error) => ({ at: mm, result: null, error: error.message }),
      );
    }
    return known;
  }

  /** For a member on their own with their override, so that the answer is of the scene that they see. */
  #ask(question, parameters) {
    const override = this.#room.following.override.peek();
    return this.#api.ofScene(this.#room.planId.peek(), question, this.#room.id, override ? { override } : {}, parameters);
  }
}

/** The style of the dose without fields that only pictures depend on. */
function scaleStyle({ grid, wash, lines, surfaces, coverage, compare, interpolation, error, levels, ...style }) {
  return style;
}
