// State of the meetings of today on the start page: their agendas, and what their people change of them.
import { batch, computed, signal } from '../../../lib/signals-core.js';
import { say } from './later_words.js';

const listMs = 5000;
const dayMs = 86400000;
const most = 6; // meetings of today whose agendas are shown
const mostFound = 50; // plans to choose from for a new case
const typingMs = 120; // after the last key, before the server is asked

const dayOf = (ms) => new Date(ms).setHours(0, 0, 0, 0);

/** True of a meeting that runs, is to begin today or at no stated time, or was ended today. */
export function isOfToday({ state, starts_ms, ended_ms }, now = Date.now()) {
  if (state === 'running') return true;
  if (state === 'over') return dayOf(ended_ms) === dayOf(now);
  return starts_ms === null || (starts_ms >= dayOf(now) && starts_ms < dayOf(now) + dayMs);
}

/** The newest first: those to come, then those that are over. */
const newest = (a, b) => (b.ended_ms ?? b.starts_ms ?? 0) - (a.ended_ms ?? a.starts_ms ?? 0);

const order = (a, b) => (a.state === 'over') - (b.state === 'over') || (a.starts_ms ?? Infinity) - (b.starts_ms ?? Infinity);

export class MeetingsState {
  #api;
  #clock;
  #enter;
  #timer = 0;
  #typing = 0;
  #nFinds = 0;
  #isStopped = false;
  #n = 0;

  /** @param {object} world {api, clock, enter: (room: string, plan: string) => void} */
  constructor({ api, clock, enter }) {
    this.#api = api;
    this.#clock = clock;
    this.#enter = enter;
    this.all = signal([]);
    this.today = computed(() => this.all.value.filter((meeting) => isOfToday(meeting)).sort(order));
    this.opened = signal([]); // ids of others whose agendas are shown too
    this.shown = computed(() => [
      ...this.today.value.slice(0, most),
      ...this.others.value.filter(({ id }) => this.opened.value.includes(id)),
    ]);
    this.others = computed(() => {
      const ofToday = this.today.value.slice(0, most);
      return this.all.value.filter((meeting) => !ofToday.includes(meeting)).sort(newest);
    });
    this.agendas = signal({}); // by meeting, as GET gives it
    this.error = signal(''); // of what was asked for last
    this.form = signal(null); // {meeting: id, '' of a new one; kind: 'meeting' | 'case' | 'links'} while one is open
    this.plans = signal({ list: null, total: 0 }); // to choose a new case from, of all that this person may see; list null: not answered yet
    this.dragged = signal(''); // the case that is being dragged
    this.said = signal(''); // for readers of the screen: where a case stands now
  }

  start() {
    void this.#list();
  }

  stop() {
    this.#isStopped = true;
    this.#clock.clearTimeout(this.#timer);
    this.#clock.clearTimeout(this.#typing);
  }

  /** Shows the agenda of a meeting of another day, or no longer. */
  fold(id) {
    const isOpen = this.opened.value.includes(id);
    this.opened.value = isOpen ? this.opened.value.filter((other) => other !== id) : [...this.opened.value, id];
    if (!isOpen) void this.#list();
  }

  /** Asks the meeting something, as about its links. */
  call(id, method, path, body) {
    return this.#api.call(method, `meetings/${id}${path}`, { body });
  }

  /** Looks for plans for a new case, whatever the list of plans shows. Plans that another text found are not to choose from meanwhile. */
  find(text, isTyped = false) {
    this.#nFinds += 1;
    this.plans.value = { list: null, total: 0 };
    this.#clock.clearTimeout(this.#typing);
    this.#typing = this.#clock.setTimeout(() => void this.#find(text.trim()), isTyped ? typingMs : 0);
  }

  async #find(text) {
    const n = this.#nFinds;
    try {
      const { plans, total } = await this.#api.call('POST', 'plans/search', {
        body: { text, kind: 'plan', sort: 'used', limit: mostFound },
      });
      if (n === this.#nFinds && !this.#isStopped) this.plans.value = { list: plans, total };
    } catch (error) {
      if (n !== this.#nFinds) return;
      this.error.value = error.message;
      this.plans.value = { list: [], total: 0, hasFailed: true };
    }
  }

  /** Makes a meeting, or gives it another name and time. @param {string} id '' of a new one @param {{name: string, starts_ms: number|null}} facts */
  async save(id, facts) {
    const isDone = await this.#change(() =>
      id ? this.#api.call('PATCH', `meetings/${id}`, { body: facts }) : this.#api.call('POST', 'meetings', { body: facts }),
    );
    if (isDone) this.form.value = null;
  }

  /** Puts a plan on the agenda, unless the plans to choose from are being looked for. */
  async add(id, plan) {
    if (!this.plans.peek().list) return;
    if (await this.#change(() => this.#api.call('POST', `meetings/${id}/cases`, { body: { plan } }))) this.form.value = null;
  }

  /** Moves a case to before another one; null: to the end. */
  async move(id, moved, before) {
    const isDone = await this.#change(() => this.#api.call('PATCH', `meetings/${id}/cases/${moved}`, { body: { before } }));
    const { cases = [] } = this.agendas.value[id] ?? {};
    if (isDone) this.said.value = say.movedTo({ n: cases.findIndex((other) => other.id === moved) + 1, of: cases.length });
  }

  /** Moves a case by one place. */
  step(meeting, index, by) {
    const { cases, id } = meeting;
    const to = index + by;
    if (to < 0 || to >= cases.length) return;
    void this.move(id, cases[index].id, by < 0 ? cases[to].id : (cases[to + 1]?.id ?? null));
  }

  remove(id, removed) {
    return this.#change(() => this.#api.call('DELETE', `meetings/${id}/cases/${removed}`));
  }

  /** Enters the room of a case that the meeting has not come to. */
  async prepare(id, prepared) {
    if (!(await this.#change(() => this.#api.call('POST', `meetings/${id}/cases/${prepared}/room`, { body: {} })))) return;
    const { room, plan } = this.agendas.value[id].cases.find((one) => one.id === prepared) ?? {};
    if (room) this.#enter(room, plan);
  }

  /** Enters the room of the case of now; who may begin the meeting begins it. */
  async goIn(id) {
    let meeting = this.agendas.value[id];
    const nowOf = ({ cases }) => cases.find(({ state }) => state === 'now');
    if (!nowOf(meeting) && meeting.may.advance) {
      const isDone = await this.#change(() => this.#api.call('POST', `meetings/${id}/case`, { body: { case: 'next', from: null } }));
      if (!isDone) return;
      meeting = this.agendas.value[id];
    }
    const now = nowOf(meeting);
    if (now?.room) this.#enter(now.room, now.plan);
    else if (!this.#isStopped) this.error.value = now ? say.caseIsClosed : say.notBegun;
  }

  /** Shows what the server answers. @returns {Promise<boolean>} false: it refused, which is told */
  async #change(ask) {
    this.#n += 1;
    try {
      const meeting = await ask();
      if (meeting?.cases) {
        const { cases, may: _, owner: _o, ...head } = meeting;
        batch(() => {
          this.agendas.value = { ...this.agendas.value, [meeting.id]: meeting };
          this.all.value = [...this.all.value.filter(({ id }) => id !== meeting.id), { ...head, n_cases: cases.length }];
          this.error.value = '';
        });
      }
      return true;
    } catch (error) {
      this.error.value = error.message;
      return false;
    }
  }

  async #list() {
    this.#clock.clearTimeout(this.#timer);
    const n = this.#n;
    try {
      const { meetings } = await this.#api.call('GET', 'meetings');
      const ofToday = meetings
        .filter((meeting) => isOfToday(meeting))
        .sort(order)
        .slice(0, most);
      const shown = [...ofToday, ...meetings.filter((meeting) => !ofToday.includes(meeting) && this.opened.peek().includes(meeting.id))];
      const agendas = await Promise.all(shown.map(({ id }) => this.#api.call('GET', `meetings/${id}`).catch(() => null)));
      if (n === this.#n && !this.#isStopped)
        batch(() => {
          this.all.value = meetings;
          this.agendas.value = Object.fromEntries(agendas.filter(Boolean).map((meeting) => [meeting.id, meeting]));
        });
    } catch {
      // the page says itself that the server does not answer; who has no meetings sees none
    }
    if (!this.#isStopped) this.#timer = this.#clock.setTimeout(() => void this.#list(), listMs);
  }
}
