// State of the start page: the plans and rooms, the jobs that load plans, the report of the chosen plan.
import { present } from './after_room.js';
import { batch, computed, signal } from '../../lib/signals-core.js';
import { Problem } from '../net/api.js';
import { readReport } from './plan.js';
import { say } from './words.js';

const listMs = 4000;
const typingMs = 120; // after the last key, before the server is asked
export const pagePlans = 50;
const jobMs = 150;

/** True for a problem of the server as a whole, such as too many open plans, and not of the plan. */
export const isOfServer = (problem) => ['/problems/busy', '/problems/limit'].includes(problem?.type);

export { present };

export class PlansState {
  #api;
  #clock;
  #enter;
  #timer = 0;
  #isStopped = false;
  #newest = 0;
  #nLists = 0;
  #seen;

  /** @param {object} world {api, clock, enter: (room: string, plan: string) => void, seen: is told of each new list of plans, place: the one to begin with} */
  constructor({ api, clock, enter, seen = () => {}, place = { kind: 'today', id: '' } }) {
    this.#seen = seen;
    this.#api = api;
    this.#clock = clock;
    this.#enter = enter;
    this.plans = signal(null); // those of the page that is shown; null until the first answer
    this.found = signal({ total: 0, of: 0, next: null, folders: [], n_all: 0, n_uploads: 0, n_no_plans: 0 });
    this.folder = computed(() => this.found.value.folders.find(({ id }) => id === this.place.value.id)); // the one that is shown
    this.rooms = signal([]);
    this.version = signal(null);
    this.error = signal('');
    this.jobs = signal({}); // by plan: {id, state, phase, percent, problem, isOpening}
    this.refusals = signal({}); // by plan: a sentence
    this.notice = signal(''); // what the server as a whole cannot do at the moment
    this.chosen = signal('');
    this.report = signal(null); // {plan, loadMs, lines, dropped} of the chosen plan; null without one
    this.place = signal(place); // today | all | folder | uploads | no-plans; id: the folder's
    this.sort = signal('used'); // used | name | approved
    this.search = signal('');
    this.cursors = signal(['']); // of the pages up to the one that is shown
    this.isOld = signal(false); // the list is another one than was asked for last
    this.unfolded = signal(''); // the plan whose older rooms are shown
    this.isNaming = signal(false);
    this.deleting = signal(null); // {plan, rooms: those on it, null while unknown} while the user has yet to confirm a deletion
  }

  start() {
    this.#list();
    this.#api.version().then(
      (version) => {
        this.version.value = version;
      },
      () => {},
    );
  }

  stop() {
    this.#isStopped = true;
    this.#clock.clearTimeout(this.#timer);
  }

  /** Shows other plans: of a place, found by a text, in an order. @param {{place?: object, search?: string, sort?: string}} what */
  show(what) {
    batch(() => {
      for (const [name, value] of Object.entries(what)) this[name].value = value;
      this.cursors.value = [''];
      this.isOld.value = true;
    });
    this.#clock.clearTimeout(this.#timer);
    this.#timer = this.#clock.setTimeout(() => this.#list(), what.search === undefined ? 0 : typingMs);
  }

  /** Goes to the next page of plans, or back. */
  turn(isNext) {
    const { next } = this.found.value;
    if (isNext ? !next : this.cursors.value.length < 2) return;
    this.cursors.value = isNext ? [...this.cursors.value, next] : this.cursors.value.slice(0, -1);
    void this.#list();
  }

  /** Goes into a room. */
  goOn(room) {
    this.#enter(room.id, room.plan);
  }

  choose(id) {
    this.chosen.value = id;
    this.#readReport();
  }

  /** Loads the plan, then enters a new room with it. */
  async open(id) {
    if (this.jobs.value[id]) return;
    this.choose(id);
    this.#refuse(id, '');
    this.notice.value = '';
    this.#setJob(id, { id: '', state: 'queued', phase: '', percent: 0 });
    try {
      const job = await this.#finish(id, await this.#api.openPlan(id));
      if (!job || this.#isStopped) return;
      const room = await this.#api.makeRoom(id);
      if (!this.#isStopped) this.#enter(room.id, id);
    } catch (error) {
      this.#tell(id, error);
    } finally {
      this.#setJob(id, null);
      this.#list();
    }
  }

  async cancel(id) {
    const job = this.jobs.value[id];
    if (!job?.id) return;
    await this.#api.cancelJob(job.id).catch((error) => this.#refuse(id, error.message));
  }

  /** Shows a plan that was just uploaded. */
  async arrived(id) {
    await this.#list();
    if (this.#isStopped) return;
    if (!this.plans.value?.some((plan) => plan.id === id)) {
      this.show({ place: { kind: 'uploads', id: '' }, search: '' });
      await this.#list();
    }
    this.choose(id);
  }

  /** Asks the user whether a plan is to be deleted, and looks who is in rooms on it. */
  async askToRemove(id) {
    const plan = this.plans.value.find((other) => other.id === id);
    this.deleting.value = { plan, rooms: null };
    const rooms = await this.#api.rooms().then(
      (answer) => answer.rooms,
      () => this.rooms.value,
    );
    if (this.deleting.value?.plan === plan) this.deleting.value = { plan, rooms: rooms.filter((room) => room.plan === id) };
  }

  /** Deletes an uploaded plan with all its files. keepsRecords: said by the person, where something was decided on it; by: their name. */
  async remove(id, { keepsRecords = false, by = '' } = {}) {
    const asked = this.deleting.peek();
    this.deleting.value = null;
    try {
      await this.#api.removePlan(id, { keepsRecords, by });
      if (this.chosen.value === id) this.chosen.value = '';
    } catch (error) {
      if (error.code === 'records' && asked)
        this.deleting.value = { ...asked, records: error.message }; // asked once more
      else this.#refuse(id, error.message);
    }
    await this.#list();
  }

  /** Waits for the end of a job; null when it was cancelled. */
  async #finish(id, job) {
    while (!this.#isStopped) {
      this.#setJob(id, job);
      if (job.state === 'done') return job;
      if (job.state === 'cancelled') return null;
      if (job.state === 'failed') throw new Problem(job.problem ?? { detail: say.notLoadable });
      await new Promise((resolve) => {
        this.#clock.setTimeout(resolve, jobMs);
      });
      job = await this.#api.job(job.id);
    }
    return null;
  }

  #question() {
    const { kind, id } = this.place.value;
    const folder = { folder: id, uploads: 'uploads' }[kind] ?? '';
    return {
      text: this.search.value.trim(),
      folder,
      sort: this.sort.value,
      kind: kind === 'no-plans' ? 'no-plan' : 'plan',
      limit: pagePlans,
      cursor: this.cursors.value.at(-1),
    };
  }

  async #list() {
    this.#clock.clearTimeout(this.#timer);
    const request = ++this.#nLists;
    try {
      const [{ plans, ...found }, { rooms }] = await Promise.all([
        this.#api.call('POST', 'plans/search', { body: this.#question() }),
        this.#api.rooms(),
      ]);
      if (request !== this.#nLists) return; // another question was asked since
      batch(() => {
        this.plans.value = plans;
        this.found.value = found;
        this.rooms.value = rooms;
        this.error.value = '';
        this.isOld.value = false;
      });
      if (!this.#isStopped) this.#seen(plans);
      if (!this.chosen.value && plans.length) this.choose((plans.find((plan) => plan.state === 'ready') ?? plans[0]).id);
      else this.#readReport();
    } catch (error) {
      if (request !== this.#nLists) return;
      this.error.value = error.message;
    }
    if (!this.#isStopped) this.#timer = this.#clock.setTimeout(() => this.#list(), listMs);
  }

  async #readReport() {
    const id = this.chosen.value;
    const plan = this.plans.value?.find((other) => other.id === id);
    const request = ++this.#newest;
    if (plan?.state !== 'ready') {
      this.report.value = null;
      return;
    }
    if (this.report.value?.plan === id) return;
    try {
      const document = await this.#api.plan(id);
      if (request === this.#newest) this.report.value = { plan: id, loadMs: document.load_ms ?? null, ...readReport(document.report) };
    } catch {
      if (request === this.#newest) this.report.value = null; // the list shows the reason
    }
  }

  #setJob(id, job) {
    const { [id]: _, ...others } = this.jobs.value;
    this.jobs.value = job ? { ...others, [id]: job } : others;
  }

  #tell(id, error) {
    if (isOfServer(error)) this.notice.value = error.message;
    else this.#refuse(id, error.message);
  }

  #refuse(id, sentence) {
    const { [id]: _, ...others } = this.refusals.value;
    this.refusals.value = sentence ? { ...others, [id]: sentence } : others;
  }
}
