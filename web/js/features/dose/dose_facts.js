// Asks the server about the dose that the scene shows: its scale, its values at the crosshair and at pinned probes. One question of
// each kind at a time, and the newest scene next, so that a slider that moves is never behind by more than one answer.
import { computed, effect, signal } from '../../../lib/signals-core.js';
import { Asker } from '../../parts/asker.js';
import { DoseLabels } from './dose_labels.js';
import { crosshair } from '../../room/plan.js';

const at = ([x, y, z]) => ({ x, y, z });

export class DoseFacts {
  #room;
  #api;

  /** @param {import('../../room/room.js').RoomState} room @param {object} api of net/api.js */
  constructor(room, api) {
    this.#room = room;
    this.#api = api;
    /** {result, error, isOld}: the answer to the question dose */
    this.scale = signal({ result: null, error: '', isOld: false });
    /** the same of dose_probe at the crosshair */
    this.here = signal({ result: null, error: '', isOld: false });
    /** the same of coverage and gamma, while they are shown */
    this.coverage = signal({ result: null, error: '', isOld: false });
    this.gamma = signal({ result: null, error: '', isOld: false });
    this.labels = new DoseLabels(room, api);
    /** by pin: {at, result, error} */
    this.pins = signal({});
    /** 100 % in the quantity's unit; null: not known */
    this.reference = computed(() => (this.isOfScene(this.scale.value.result) ? this.scale.value.result.reference.value : null));
  }

  /** True for an answer about the dose and the quantity that the scene shows; a change that is not answered yet has none. */
  isOfScene(answer) {
    const { id, quantity } = this.#room.scene.value?.dose ?? {};
    return Boolean(answer) && answer.quantity === quantity && answer.id === (id || this.#room.plan.value?.doses[0]?.id);
  }

  /** @returns {() => void} stops asking */
  start(clock) {
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
    const askers = [
      this.#follow(
        clock,
        () => style.value,
        this.scale,
        () => this.#ask('dose', {}),
      ),
      this.#follow(
        clock,
        () => style.value && place.value && `${style.value} ${place.value}`,
        this.here,
        () => this.#ask('dose/probe', at(place.peek().split(' '))),
      ),
      this.#followPins(clock, style, pinned),
      this.#follow(
        clock,
        () => covered.value,
        this.coverage,
        () => this.#ask('coverage', {}),
      ),
      this.#follow(
        clock,
        () => compared.value,
        this.gamma,
        () => this.#ask('gamma', {}),
      ),
      this.labels.start(clock),
    ];
    return () => {
      for (const stop of askers) stop();
    };
  }

  /** Asks when the key changes, and once more when the server has the change. */
  #follow(clock, key, answer, ask) {
    let settled = '';
    const asker = new Asker(async () => {
      const wanted = key();
      const isSettled = !this.#room.isScenePending.peek();
      if (!wanted) return;
      const tell = (facts) => {
        if (key() === wanted) answer.value = { result: null, error: '', isOld: !isSettled, ...facts };
      };
      await ask().then(
        (result) => tell({ result }),
        (error) => tell({ error: error.message }),
      );
      if (isSettled) settled = wanted;
    }, clock);
    const stop = effect(() => {
      const wanted = key();
      void this.#room.isScenePending.value; // runs again when the daemon has confirmed the scene
      if (!wanted || wanted === settled) return;
      const before = answer.peek();
      if (!before.isOld) answer.value = { ...before, isOld: true };
      asker.want();
    });
    return () => {
      stop();
      asker.stop();
    };
  }

  #followPins(clock, style, pinned) {
    let asked = '';
    const asker = new Asker(async () => {
      const key = `${style.peek()} ${pinned.peek()}`;
      const isSettled = !this.#room.isScenePending.peek();
      const known = {};
      for (const [id, { at_mm: mm }] of Object.entries(JSON.parse(pinned.peek()))) {
        known[id] = await this.#ask('dose/probe', at(mm)).then(
          (result) => ({ at: mm, result, error: '' }),
          (error) => ({ at: mm, result: null, error: error.message }),
        );
      }
      this.pins.value = known;
      if (isSettled) asked = key;
    }, clock);
    const stop = effect(() => {
      const key = `${style.value} ${pinned.value}`;
      const isPending = this.#room.isScenePending.value;
      if (pinned.value === '{}') {
        if (Object.keys(this.pins.peek()).length) this.pins.value = {};
      } else if (style.value && !isPending && key !== asked) asker.want();
    });
    return () => {
      stop();
      asker.stop();
    };
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
