// Histograms, depth profile and limits of the dose that the scene shows: asked for while somebody looks at them, and again when dose,
// weights or line change.
import { computed, signal } from '../../../lib/signals-core.js';
import { mergePatch } from '../../wire/merge.js';
import { readDvh, readProfile } from './dose_answers.js';
import { Answer } from '../../parts/answer.js';
import { plotPoints } from './dose_dvh.js';
import { linesOf } from './dose_profile.js';
import { ownRegions } from '../../room/identity.js';

/** Fields of the dose on which no number depends. */
const looks = ['grid', 'levels', 'wash', 'lines', 'surfaces', 'coverage', 'error', 'interpolation', 'weights_name'];
const [mostBins, allBins, mostIds] = [512, 60000, 2000]; // of a curve, of an answer; characters
const numbersOf = (dose) => Object.fromEntries(Object.entries(dose ?? {}).filter(([name]) => !looks.includes(name)));

export const restMs = 200;

/** An answer that is asked for once what it depends on rests. @param {() => {key: string, ask: (aborted: AbortSignal) => Promise<object>}|null} wanted reactive */
function live(wanted, clock) {
  const now = computed(wanted);
  const answer = new Answer({ key: () => now.value?.key ?? '', ask: (_, aborted) => now.peek().ask(aborted), clock, restMs });
  answer.start();
  return answer;
}

export class DoseCurves {
  #room;
  #api;
  #dvh;
  #profile;
  #limits;
  #irradiation;

  /** @param {{room: import('../../room/room.js').RoomState, api: object, clock: object}} world */
  constructor({ room, api, clock }) {
    this.#room = room;
    this.#api = api;
    // what is looked at, and how
    this.isDvhShown = signal(false);
    this.isProfileShown = signal(false);
    this.areLimitsShown = signal(false);
    this.quantity = signal(''); // of the histograms; '' that of the scene
    this.isDifferential = signal(false);
    this.unit = signal('percent'); // percent | cm3
    this.tissue = signal(''); // the region whose weights the histograms have; '' each region's own
    this.hidden = signal(new Set()); // regions without a curve, of those that the scene shows
    this.line = signal(''); // key of a line; '' the first
    this.reference = signal(''); // key of a group of reference curves that stand beside the profile; '' none
    this.level = signal(null); // the V of the table: a dose; null: half of the axis

    this.lines = computed(() => linesOf(room.plan.value, room.scene.value));
    this.chosenLine = computed(() => this.lines.value.find(({ key }) => key === this.line.value) ?? this.lines.value[0] ?? null);
    /** The regions that the scene shows. */
    this.regions = computed(() =>
      (room.plan.value && room.scene.value ? ownRegions(room.plan.value, room.scene.value) : []).filter(
        ({ id, voxels }) => voxels > 0 && room.scene.value.regions[id]?.visible,
      ),
    );
    /** Those among them that have curves. */
    this.shownRegions = computed(() => this.regions.value.filter(({ id }) => !this.hidden.value.has(id)));

    this.#dvh = live(() => (this.isDvhShown.value ? this.#histograms() : null), clock);
    this.#profile = live(() => (this.isProfileShown.value ? this.#along() : null), clock);
    this.#limits = live(() => (this.areLimitsShown.value ? this.#kept() : null), clock);

    this.#irradiation = live(() => (this.areLimitsShown.value ? this.#until() : null), clock);

    const read = (asked, as) =>
      computed(() => ({ ...asked.state.value, result: asked.state.value.result && as(asked.state.value.result) }));
    this.dvh = read(this.#dvh, readDvh);
    this.profile = read(this.#profile, readProfile);
    this.limits = this.#limits.state;
    this.irradiation = this.#irradiation.state;
    /** The curves that are drawn: of the regions chosen, of the dose shown and of the one it is compared with. */
    this.curves = computed(() => {
      const ids = new Set(this.shownRegions.value.map(({ id }) => id));
      return (this.dvh.value.result?.curves ?? []).filter(({ region, cm3 }) => ids.has(region) && cm3 > 0);
    });
    this.points = computed(() => plotPoints(this.curves.value, { isDifferential: this.isDifferential.value, unit: this.unit.value }));
    this.pointedDose = signal(null); // where the pointer is in the histograms: {value, yValue, x, y}
    this.pointedDepth = signal(null); // in the profile
    this.editing = signal(null); // a limit that is being written: {id, '' a new one; values, error}
    this.importError = signal(''); // why a file of limits was not read
    this.isTable = signal({ dvh: false, profile: false }); // the table instead of the plot
  }

  stop() {
    for (const asked of [this.#dvh, this.#profile, this.#limits, this.#irradiation]) asked.stop();
  }

  /** True while the server knows the scene that this page shows. */
  get #isReady() {
    const { plan, scene, renderer, isScenePending } = this.#room;
    return Boolean(plan.value && scene.value?.dose) && renderer.value.state === 'ready' && !isScenePending.value;
  }

  /** The question for the shown scene with another dose or quantity. @param {object} more patch of scene.dose */
  #question(name, keyed, more, parameters = {}) {
    const { planId, scene, following } = this.#room;
    if (!this.#isReady || !planId.value) return null;
    const own = following.override.value ?? {};
    const view = { override: Object.keys(more).length ? mergePatch(own, { dose: more }) : own };
    const plan = planId.value;
    if (!this.#room.plan.value.doses.length) return null;
    const key = JSON.stringify([plan, name, this.#room.fitKey.value, numbersOf(mergePatch(scene.value.dose, more)), keyed, parameters]);
    return { key, ask: (aborted) => this.#api.ofScene(plan, name, this.#room.id, view, parameters, aborted) };
  }

  #histograms() {
    const regions = this.regions.value.map(({ id }) => id);
    const bins = Math.max(16, Math.min(mostBins, Math.floor(allBins / (2 * Math.max(1, regions.length)))));
    const levels = this.#room.scene.value?.dose?.levels; // of which targets have their conformity
    return regions.length
      ? this.#question(
          'dvh',
          [regions, levels],
          {},
          {
            quantity: this.quantity.value,
            ...(this.tissue.value && { tissue: this.tissue.value }),
            bins,
            ...(regions.join().length <= mostIds ? { regions: regions.join() } : {}),
          },
        )
      : null;
  }

  #along() {
    const line = this.chosenLine.value;
    if (!line) return null;
    const place = line.kind === 'beam' ? { beam: line.id } : { from: line.from.join(), to: line.to.join() };
    const question = this.#question('profile', null, {}, place);
    const isFromEntry = line.kind === 'beam';
    return question && { ...question, ask: (aborted) => question.ask(aborted).then((answer) => ({ ...answer, isFromEntry })) };
  }

  /** Which univels of a region count in everything that is said of it: the scene's choice. @returns {'own'|'whole'|''} */
  get population() {
    const { population } = this.#room.scene.value?.dose ?? {};
    return ['own', 'whole'].includes(population) ? population : (this.dvh.value.result?.curves[0]?.population ?? '');
  }

  #kept() {
    const constraints = this.#room.scene.value?.constraints ?? {};
    return Object.keys(constraints).length ? this.#question('constraints', constraints, {}) : null;
  }

  /** How long to irradiate until each limit is reached. */
  #until() {
    const { constraints = {}, irradiation = {} } = this.#room.scene.value ?? {};
    return Object.keys(constraints).length ? this.#question('irradiation', [constraints, irradiation], {}) : null;
  }
}
