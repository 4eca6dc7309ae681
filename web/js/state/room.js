// State of the room page. Panels draw from its signals and call its methods; the connection's messages change it.
import { batch, computed, signal } from '../../lib/signals-core.js';
import { readDocument } from '../wire/check.js';
import { readPlan } from './plan.js';
import { Replica } from './replica.js';
import { ViewState } from './view.js';

const kinds = ['3d', 'axial', 'sagittal', 'coronal'];

export class RoomState {
  #connection;
  #clock;
  #schedule;
  #scene = new Replica();
  #sceneOrigin = { view: 0, at: 0 };
  #viewOrigin = new Map();
  #nextInput = 1;
  #isScheduled = false;
  #restored = false;

  /**
   * @param {string} id
   * @param {object} world passed in, so that tests can use fakes
   * @param {import('../net/connection.js').Connection} world.connection
   * @param {{now: () => number}} world.clock
   * @param {(callback: () => void) => void} world.schedule calls back before the next paint
   * @param {(kind: 'ok'|'warn'|'err', text: string) => void} world.notify
   */
  constructor(id, { connection, clock, schedule, notify }) {
    this.id = id;
    this.#connection = connection;
    this.#clock = clock;
    this.#schedule = schedule;
    this.notify = notify;
    /** @type {(of: 'scene'|number, patch: object, document: object) => void} told each change of this person before it is applied */
    this.recorder = () => {};

    this.link = signal({ state: 'connecting', retryAt: 0, reason: '' }); // connecting | open | lost | ended
    this.member = signal('');
    this.members = signal([]);
    this.planId = signal('');
    this.plan = signal(null);
    this.scene = signal(null);
    this.revision = signal(0);
    this.revisionAt = signal(0);
    this.isScenePending = signal(false);
    this.renderer = signal({ state: 'starting', phase: '', percent: 0, problem: null });
    this.gl = signal('');
    this.latencyMs = signal(null);
    this.views = kinds.map((kind, index) => new ViewState(index + 1, kind));
    this.canChange = computed(() => this.link.value.state === 'open' && this.scene.value !== null);

    connection.addEventListener('message', (event) => this.#take(event.detail));
    connection.addEventListener('lost', (event) => this.#lose(event.detail.retryMs));
    connection.addEventListener('ended', (event) => {
      this.link.value = { state: 'ended', retryAt: 0, reason: event.detail.reason };
      this.latencyMs.value = null;
    });
  }

  /** @returns {ViewState} */
  view(number) {
    return this.views[number - 1];
  }

  nameOf(member) {
    return this.members.value.find((other) => other.id === member)?.name ?? 'another member';
  }

  /** True while this member is in the room. */
  isHere(member) {
    return this.members.value.some((other) => other.id === member && other.connected !== false);
  }

  // ---- actions of the user ----------------------------------------------------------------------------------------

  /** Changes the scene for everybody. view: the pane it was done in; at: time of the input event, for measurements. */
  patchScene(patch, { view = 0, at = this.#clock.now() } = {}) {
    if (!this.canChange.value) return;
    this.recorder('scene', patch, this.scene.value);
    this.#scene.queue(patch);
    this.#sceneOrigin = { view, at };
    this.#showScene();
    this.#plan();
  }

  /** Changes a view; a view that follows changes the shared one. */
  patchView(number, patch, { at = this.#clock.now() } = {}) {
    const view = this.view(number);
    if (this.link.value.state !== 'open') return;
    this.recorder(number, patch, view.document.value);
    view.queue(patch);
    this.#viewOrigin.set(number, at);
    this.#plan();
  }

  /** Opens a view of this size, or changes the size of an open one. */
  showView(number, sizePx) {
    const view = this.view(number);
    if (view.isOpen.value) {
      const [width, height] = view.document.value.size_px ?? [];
      if (width === sizePx[0] && height === sizePx[1]) return;
      if (this.link.value.state === 'open') this.patchView(number, { size_px: sizePx });
      else view.restart({ ...view.document.value, size_px: sizePx }); // opens with this size once connected
      return;
    }
    view.isOpen.value = true;
    view.restart({ ...view.document.value, size_px: sizePx });
    this.#openView(view);
  }

  hideView(number) {
    const view = this.view(number);
    if (!view.isOpen.value) return;
    view.isOpen.value = false;
    view.restart(view.document.value);
    this.#connection.send({ type: 'view.close', view: number });
  }

  follow(number, isFollowing) {
    const view = this.view(number);
    if (this.link.value.state !== 'open' || view.isFollowing.value === isFollowing) return;
    const input = this.#nextInput++;
    const now = this.#clock.now();
    batch(() => {
      view.isFollowing.value = isFollowing;
      view.leftAt.value = isFollowing ? 0 : now;
      view.leftFrom.value = isFollowing ? '' : view.movedBy.value;
      view.movedBy.value = '';
    });
    this.#connection.send({ type: 'view.follow', view: number, follow: isFollowing, input });
  }

  /** Acknowledges a picture that was painted or could not be, so that the server continues. Returns the answered inputs. */
  frameShown(header, isDrawn = true) {
    this.#connection.send({ type: 'frame.shown', view: header.view, sequence: header.sequence });
    if (!isDrawn) return [];
    const answered = this.view(header.view).paint(header, this.#clock.now());
    if (this.#restored && this.renderer.value.state === 'ready') {
      this.#restored = false;
      this.notify('ok', 'Picture restored', 'renderer');
    }
    return answered;
  }

  /** Tries to connect at once. */
  reconnect() {
    this.#connection.retryNow();
  }

  // ---- sending: at most one patch of each kind per animation frame --------------------------------------------------

  #plan() {
    if (this.#isScheduled) return;
    this.#isScheduled = true;
    this.#schedule(() => {
      this.#isScheduled = false;
      this.#flush();
    });
  }

  #flush() {
    const now = this.#clock.now();
    for (const view of this.views) {
      const patch = view.take(this.#nextInput);
      if (!patch) continue;
      if (view.isOpen.value && this.#connection.send({ type: 'view.patch', view: view.number, patch, input: this.#nextInput }))
        view.expect(this.#nextInput, this.#viewOrigin.get(view.number) ?? now, now);
      this.#nextInput += 1;
    }
    const patch = this.#scene.take(this.#nextInput);
    if (!patch) return;
    const input = this.#nextInput++;
    if (!this.#connection.send({ type: 'scene.patch', patch, input })) return;
    const { view, at } = this.#sceneOrigin;
    if (view && this.view(view).isOpen.value) this.view(view).expect(input, at, now);
  }

  #openView(view) {
    const input = this.#nextInput++;
    const message = { type: 'view.open', view: view.number, document: view.document.value, follow: view.isFollowing.value, input };
    if (this.#connection.send(message)) view.expect(input, this.#clock.now(), this.#clock.now());
  }

  // ---- messages of the server -----------------------------------------------------------------------------------------

  #take(message) {
    const handlers = {
      welcome: () => this.#welcome(message),
      plan: () => this.#loaded(message),
      renderer: () => this.#rendererChanged(message),
      scene: () => {
        this.#scene.accept(message.patch, message.input);
        for (const view of this.views) view.change();
        this.#setRevision(message.revision);
        this.#showScene();
      },
      view: () => this.#viewChanged(message),
      missing: () => {
        const view = this.view(message.view);
        if (view && Array.isArray(message.regions))
          view.missing.value = { n: message.n, reasons: Object.fromEntries(message.regions.map(({ region, reason }) => [region, reason])) };
      },
      members: () => {
        if (Array.isArray(message.members)) this.members.value = message.members;
      },
      pong: () => {
        this.latencyMs.value = Math.round(this.#clock.now() - message.time_ms);
      },
      problem: () => this.#refused(message),
      bye: () => {},
    };
    batch(() => handlers[message.type]?.());
  }

  #welcome(message) {
    this.link.value = { state: 'open', retryAt: 0, reason: '' };
    this.member.value = message.member;
    this.identity = { member: message.member, secret: message.secret, name: message.name };
    this.planId.value = message.plan_id;
    this.gl.value = message.gl;
    this.#loaded(message);
    for (const view of this.views) {
      view.restart(view.document.value);
      if (view.isOpen.value) this.#openView(view);
    }
  }

  #loaded(message) {
    if (message.gl) this.gl.value = message.gl;
    if (message.plan) this.plan.value = readPlan(message.plan);
    if (message.scene) {
      this.#scene.reset(message.scene);
      for (const view of this.views) view.change();
      this.#showScene();
      this.renderer.value = { state: 'ready', phase: '', percent: 100, problem: null };
    }
    this.#setRevision(message.revision);
  }

  #rendererChanged({ state, phase, percent, problem }) {
    const before = this.renderer.value.state;
    this.renderer.value = { state, phase, percent, problem };
    if (state === 'restarting' && before !== 'restarting') {
      this.#restored = true;
      this.notify('warn', 'Renderer restarting. The last picture stays until the new one is here.', 'renderer');
    }
  }

  #viewChanged({ view: number, document, follow, by }) {
    const view = this.view(number);
    if (!view) return;
    // The server sends complete documents; an incomplete one throws here.
    view.replace(readDocument('view', document));
    view.isFollowing.value = follow;
    view.movedBy.value = follow && by !== this.member.value ? by : '';
  }

  #refused({ to, view, input, problem }) {
    this.#scene.refuse(input);
    if (this.view(view)) this.view(view).refuse(input);
    if (this.scene.value) this.#showScene();
    if (to === '' && this.view(view)) this.view(view).refuseToDraw(problem?.detail || 'The server gave no reason.');
    this.notify('err', problem?.detail || `The server refused ${to || 'a message'}.`);
  }

  #lose(retryMs) {
    batch(() => {
      this.link.value = { state: 'lost', retryAt: this.#clock.now() + retryMs, reason: '' };
      this.latencyMs.value = null;
    });
  }

  #setRevision(revision) {
    if (revision !== this.revision.value) this.revisionAt.value = this.#clock.now();
    this.revision.value = revision;
  }

  #showScene() {
    batch(() => {
      this.scene.value = this.#scene.value;
      this.isScenePending.value = this.#scene.isPending;
    });
  }
}
