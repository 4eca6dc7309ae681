// State of the room page. Panels draw from its signals and call its methods; the connection's messages change it.
import { batch, computed, signal } from '../../lib/signals-core.js';
import { readDocument } from '../wire/check.js';
import { mergePatch } from '../wire/merge.js';
import { Control } from './control.js';
import { acceptedPairs } from './accepted.js';
import { Following } from './following.js';
import { Items } from './items.js';
import { views as allViews } from './layout.js';
import { Latency } from './latency.js';
import { authored, isOfMarks, isOwn, ownPart } from './marks.js';
import { readPlan } from './plan.js';
import { Pointers } from './pointers.js';
import { Replica } from './replica.js';
import { Saved } from './saved.js';
import { Sending } from './sending.js';
import { ViewState } from './view.js';
import { say } from './words.js';

export class RoomState {
  #connection;
  #clock;
  #sending;
  #scene = new Replica(null);
  #sharedScene = signal(null); // the room's scene with our pending changes
  #restored = false;
  #isLoaded = false; // since the last welcome: the server has a scene
  #latency = new Latency();
  #seat = null; // {member, secret, name, user} whose changes are kept; user as the server names it, '' without sign-in

  /**
   * @param {string} id
   * @param {object} world passed in, so that tests can use fakes
   * @param {import('../net/connection.js').Connection} world.connection
   * @param {{now: () => number}} world.clock
   * @param {(callback: () => void) => void} world.schedule calls back before the next paint
   * @param {(callback: () => void) => void} [world.sendSoon] calls back when changes are to be sent
   * @param {(kind: 'ok'|'warn'|'err', text: string, topic?: string, action?: {word: string, act: () => void}) => void} world.notify
   */
  constructor(id, { connection, clock, schedule, sendSoon = schedule, notify }) {
    this.id = id;
    this.#connection = connection;
    this.#clock = clock;
    this.notify = notify;
    /** @type {(of: 'scene'|number, patch: object, document: object, isMark?: boolean) => void} told each change of this person before it is applied; isMark: of marks of the room */
    this.recorder = () => {};
    /** @type {() => void} told when this member follows again after having been on their own */
    this.returned = () => {};
    /** @type {(name: string, run: () => void) => void} runs changes of several views that are one act of this person */
    this.together = (name, run) => run();

    // connecting | open | lost | ended; when an answer is overdue, quietSince: time of the last sign of the server; dueSince: of the answer
    this.link = signal({ state: 'connecting', retryAt: 0, quietSince: 0, dueSince: 0, reason: '' });
    this.lostAtEnd = signal(false); // changes and notes were not answered when the room ended
    this.member = signal('');
    this.isLeft = signal(false); // its page is gone
    this.members = signal([]);
    this.planId = signal('');
    this.name = signal(''); // of the room; '': none was given
    this.plan = signal(null);
    this.revision = signal(0);
    this.isScenePending = signal(false);
    this.renderer = signal({ state: 'starting', phase: '', percent: 0, problem: null });
    this.gl = signal('');
    this.seesIdentity = signal(false); // whether this member may ask whom the plan is of
    this.latencyMs = this.#latency.medianMs; // input to paint
    this.pingMs = signal(null);
    this.wall = signal(null); // what walls show: the newest message wall
    this.views = allViews.map(({ kind, ...more }, index) => new ViewState(index + 1, kind, more));
    // Changes made while the connection is lost are kept, and sent when it is back.
    // Before the list of members has come, nobody knows whether a change is the room's or this member's own.
    this.canChange = computed(
      () => ['open', 'lost'].includes(this.link.value.state) && this.#sharedScene.value !== null && this.members.value.length > 0,
    );
    this.#sending = new Sending({
      connection,
      clock,
      schedule: sendSoon,
      views: this.views,
      scene: this.#scene,
      refused: () => this.#tooLarge(),
    });
    this.pointers = new Pointers(this, { clock, schedule, send: (message) => connection.send(message) });
    this.items = new Items((message) => (this.#sending.isHeld ? 0 : this.#sending.act(message)));
    /** Which acceptances count, as the server says; the items of kind acceptance hold the rest. */
    this.files = signal(null); // {changed_ms, read_ms} while the plan's files are not what is shown
    this.acceptances = signal({ known: false, items: [] });
    this.accepted = computed(() => acceptedPairs(this.items.rows.value, this.acceptances.value.items));
    /** Key of the things that numbers and pictures depend on beside the fields of dose: the shown image decides what fits, and people what is used all the same. */
    this.fitKey = computed(() => [this.scene.value?.image?.id ?? '', ...this.acceptances.value.items].join(' '));
    this.saved = new Saved(this);
    this.following = new Following(this, (message) => this.#sending.act(message));
    this.control = new Control(this, (message) => this.#connection.send(message));
    /** The newest of the messages recording (while one runs), replay and replay.at; null: none. Acts: features/recordings/recordings.js. */
    this.recording = {
      running: signal(null),
      replay: signal(null),
      at: signal(null),
      members: signal([]),
      say: (type, more) => this.#connection.send({ type, ...more }),
    };
    /** The scene that this member sees: the room's with, for a member on their own, the override of their views. */
    this.scene = computed(() => {
      const [scene, override] = [this.#sharedScene.value, this.following.override.value];
      return scene && override ? mergePatch(scene, override) : scene;
    });

    connection.addEventListener('message', (event) => this.#take(event.detail));
    connection.addEventListener('lost', (event) => this.#lose(event.detail.retryMs));
    connection.addEventListener('renewing', () => this.#keepChanges());
    connection.addEventListener('paused', () => this.#pause());
    connection.addEventListener('quiet', (event) =>
      this.#setLink('open', { quietSince: event.detail.since, dueSince: event.detail.dueSince }),
    );
    connection.addEventListener('heard', () => this.#setLink('open'));
    connection.addEventListener('ended', (event) =>
      batch(() => {
        const isLost = this.#scene.isPending || this.views.some((view) => view.isOpen.value && view.isPending);
        this.lostAtEnd.value = this.items.end() || isLost;
        this.#setLink('ended', event.detail);
      }),
    );
  }

  /** The room's scene with this member's pending changes, without the override of who is on their own. */
  get sharedScene() {
    return this.#sharedScene.value;
  }

  /** @returns {ViewState} */
  view(number) {
    return this.views[number - 1];
  }

  // ---- actions of the user ----------------------------------------------------------------------------------------

  /** Whether marks that are made now are the room's: see marks.js. */
  get sharesMarks() {
    return this.following.isPresenting.value || (this.following.isFollowing.value && this.control.may('scene'));
  }

  /** The end of ids of this member's marks. */
  get markSuffix() {
    return this.following.isPresenting.value ? '' : `-${this.member.value}`;
  }

  /** Whether a change of the scene is the room's: everything of the presenter, of who follows what changes marks of their own. */
  isForRoom(patch) {
    return this.following.isPresenting.value || (this.sharesMarks && isOwn(patch, this.member.value));
  }

  /**
   * Changes the scene: the presenter's change is everybody's, and so is that of marks of one's own; with any other a member leaves the presenter and sees it alone.
   * view: the pane it was done in; at: time of the input event, for measurements; isBack: marks of the room change, also for who is on their own meanwhile.
   */
  patchScene(patch, { view = 0, at = this.#clock.now(), isBack = false } = {}) {
    if (!this.canChange.value) return;
    if (this.isForRoom(patch) || (isBack && this.control.may('scene') && isOwn(patch, this.member.value))) {
      const change = authored(patch, this.#sharedScene.value, this.identity?.name ?? '');
      this.recorder('scene', change, this.scene.value, isOfMarks(patch));
      this.#scene.queue(change);
      this.#showScene();
      this.#sending.plan({ sceneView: view, at });
    } else {
      this.following.leave();
      this.recorder('scene', patch, this.scene.value);
      this.following.patchOwn(patch);
      this.#sending.plan({ view, at });
    }
  }

  /** Whether showOwn() changes anything: who follows shares the presenter's pictures. */
  get canShowOwn() {
    return this.canChange.value && (this.following.isPresenting.value || !this.following.isFollowing.value);
  }

  /** Shows something for as long as it is wanted, by the override of the own views: no change of the scene and no step of undo. */
  showOwn(patch) {
    if (!this.canShowOwn) return;
    this.following.patchOwn(patch);
    this.#sending.plan();
  }

  /** Changes a view: the presenter's are the room's; any other member leaves the presenter and changes their own. */
  patchView(number, patch, { at = this.#clock.now(), isStep = true } = {}) {
    if (this.canChange.value) this.#patchViews([[number, patch]], at, this.following.leave(), isStep);
  }

  /** Changes several views by one act. isStep: undo takes it back. @param {[number, object][]} changes view and patch; the first is the one acted in */
  patchViews(changes, { at = this.#clock.now(), isStep = true } = {}) {
    if (changes.length < 2) return void (changes.length && this.patchView(...changes[0], { at, isStep }));
    if (!this.canChange.value) return;
    const isLeaving = this.following.leave();
    this.together(changes.map(([number]) => number).join(), () => batch(() => this.#patchViews(changes, at, isLeaving, isStep)));
  }

  #patchViews(changes, at, isLeaving, isStep) {
    changes.forEach(([number, patch], index) => {
      const change = isLeaving ? this.following.adapted(number, patch) : patch;
      if (isStep) this.recorder(number, change, this.view(number).document.value);
      this.view(number).queue(change);
      this.#sending.plan({ view: number, at: index ? 0 : at });
    });
  }

  /** Opens a view of this size, or changes the size of an open one. */
  showView(number, sizePx) {
    const view = this.view(number);
    const isSame = view.ownSize?.[0] === sizePx[0] && view.ownSize[1] === sizePx[1];
    if (view.isOpen.value && isSame) return;
    view.ownSize = sizePx;
    if (view.isOpen.value) return void this.#resize(view);
    view.restart(this.following.documentToOpen(view));
    view.isOpen.value = true;
    this.#openView(view);
  }

  #resize(view) {
    if (this.following.isFollowing.value && !this.following.isPresenting.value) {
      // the shared picture keeps the presenter's size; the server needs ours for when we leave
      this.#sending.act({ type: 'view.patch', view: view.number, patch: { size_px: view.ownSize } });
      return;
    }
    view.queue({ size_px: view.ownSize });
    this.#sending.plan();
  }

  hideView(number) {
    const view = this.view(number);
    if (!view.isOpen.value) return;
    view.isOpen.value = false;
    view.restart(view.document.value);
    this.#connection.send({ type: 'view.close', view: number });
  }

  /** Notes a picture that has come, before it is decoded. */
  frameCame(header) {
    this.views[header.view - 1]?.receive(header);
  }

  /** Acknowledges a picture that was painted or could not be, so that the server continues. Returns the answered inputs. */
  frameShown(header, isDrawn = true) {
    this.#connection.send({ type: 'frame.shown', view: header.view, sequence: header.sequence });
    if (!isDrawn) return [];
    const answered = this.view(header.view).paint(header, this.#clock.now());
    if (this.#restored && this.renderer.value.state === 'ready') {
      this.#restored = false;
      this.notify('ok', say.restored, 'renderer');
    }
    return answered;
  }

  /** Takes times from an input to the painted picture, for the status bar. */
  measured(timesMs) {
    this.#latency.add(timesMs);
  }

  /** Takes another name, which the others see at once. */
  rename(name) {
    this.#connection.rename(name);
  }

  /** Chooses what the room's walls show. @param {'four'|'worked-in'|'presenter'} layout */
  layOutWalls(layout) {
    this.#connection.send({ type: 'wall.layout', layout });
  }

  /** Tries to connect at once. */
  reconnect() {
    this.#connection.retryNow();
  }

  #openView(view) {
    const input = this.#sending.act({
      type: 'view.open',
      view: view.number,
      document: this.following.documentToOpen(view),
      follow: this.following.isFollowing.value,
    });
    if (input) view.expect(input, 0, this.#clock.now());
  }

  // ---- messages of the server -----------------------------------------------------------------------------------------

  #take(message) {
    const handlers = {
      welcome: () => this.#welcome(message),
      plan: () => {
        if (message.revision !== this.revision.value) this.saved.changed();
        this.#loaded(message);
      },
      renderer: () => this.#rendererChanged(message),
      scene: () => {
        this.saved.changed();
        this.#scene.accept(message.patch, message.input);
        this.#reach(message);
        this.revision.value = message.revision;
        this.#showScene();
      },
      view: () => this.#viewChanged(message),
      missing: () => {
        const view = this.view(message.view);
        if (view && Array.isArray(message.regions))
          view.missing.value = { n: message.n, reasons: Object.fromEntries(message.regions.map(({ region, reason }) => [region, reason])) };
      },
      item: () => {
        this.saved.changed();
        this.items.changed(message, this.member.value);
      },
      saved: () => this.saved.told(message),
      files: () => {
        this.files.value = message.changed_ms ? message : null;
      },
      members: () => {
        if (Array.isArray(message.members)) this.#membersChanged(message.members);
      },
      'pointer.at': () => this.pointers.moved(message),
      look: () => this.pointers.looked(message),
      wall: () => {
        this.wall.value = message;
      },
      control: () => this.control.changed(message),
      acceptances: () => {
        this.acceptances.value = { known: message.known, items: message.items };
      },
      recording: () => {
        this.recording.running.value = message.state === 'running' ? message : null;
      },
      replay: () => {
        this.recording.replay.value = message;
      },
      'replay.members': () => {
        this.recording.members.value = message.members;
      },
      'replay.at': () => {
        this.recording.at.value = message;
        if (message.state === 'left') this.recording.replay.value = null;
      },
      room: () => {
        this.name.value = message.name;
      },
      pong: () => {
        this.pingMs.value = Math.round(this.#clock.now() - message.time_ms);
      },
      problem: () => this.#refused(message),
      bye: () => {},
    };
    batch(() => handlers[message.type]?.());
  }

  #welcome(message) {
    this.#setLink('open');
    this.#sending.hold();
    this.pointers.restart();
    this.saved.restart();
    this.files.value = null;
    this.recording.running.value = this.recording.replay.value = null;
    this.recording.members.value = [];
    this.member.value = message.member;
    this.identity = { member: message.member, secret: message.secret, name: message.name };
    this.planId.value = message.plan_id;
    this.name.value = '';
    this.gl.value = message.gl;
    this.seesIdentity.value = message.sees_identity;
    this.#isLoaded = false;
    this.#loaded(message);
    this.items.replace(message.items ?? [], message.member);
    for (const view of this.views) {
      if (!this.following.isFollowing.value) view.restart(view.document.value); // the whole document goes with view.open
      if (view.isOpen.value) this.#openView(view);
    }
  }

  /** True when another person came back than the one who gave what is kept: nothing of it is sent, and the room stands still until that one is back. */
  #isOther(members) {
    const { identity } = this;
    const row = members.find(({ id }) => id === identity.member);
    const user = row?.user ?? '';
    if (row && this.#seat && user !== this.#seat.user) {
      this.identity = this.#seat;
      this.member.value = this.#seat.member;
      this.#connection.pause(this.#seat);
      return true;
    }
    if (row) this.#seat = { ...identity, user };
    return false;
  }

  #membersChanged(members) {
    if (this.#sending.isHeld && this.#isOther(members)) return;
    if (this.following.membersChanged(members))
      for (const view of this.views)
        if (view.isOpen.value && String(view.document.value.size_px) !== String(view.ownSize)) this.#resize(view);
    if (this.#sending.isHeld) {
      if (!this.following.isPresenting.value) this.#dropKept();
      this.#sending.release();
      this.items.resend();
    }
    this.#shareOwn();
  }

  /** Not before the server can apply an override to its scene, and not while the list of members may be an old one. */
  #shareOwn() {
    if (this.#isLoaded && !this.#sending.isHeld) this.following.shareOwn();
  }

  /** Somebody else presents since, or nobody: changes that were kept for the room while the connection was lost are lost. */
  #dropKept() {
    const marks = this.control.may('scene') ? ownPart(this.#scene.queued, this.member.value) : null;
    const isLost =
      (this.#scene.isPending && !isOwn(this.#scene.queued ?? {}, this.member.value)) ||
      (this.following.isFollowing.value && this.views.some((view) => view.isPending));
    this.#scene.reset(this.#scene.base);
    if (marks) this.#scene.queue(marks);
    if (this.following.isFollowing.value) for (const view of this.views) if (view.isPending) view.drop();
    this.#showScene();
    const { presenter } = this.following;
    if (isLost) this.notify('err', presenter.value ? say.lostPresented(presenter.value) : say.lostNotPresenting);
  }

  #loaded(message) {
    if (message.gl) this.gl.value = message.gl;
    if (message.plan) this.plan.value = readPlan(message.plan);
    if (message.scene) {
      this.#isLoaded = true;
      this.#scene.replace(message.scene);
      for (const view of this.views) view.sceneChanged(message.revision, this.#clock.now());
      this.#showScene();
      this.renderer.value = { state: 'ready', phase: '', percent: 100, problem: null };
    }
    this.revision.value = message.revision;
    this.#shareOwn();
  }

  /** Tells the views whether the change of the scene reaches them. An input in a pane that it does not reach is answered by another one. */
  #reach({ revision, input, unchanged }) {
    const isSame = (view) => Array.isArray(unchanged) && unchanged.includes(view.number);
    // a patch that changes nothing is answered with the revision as it was
    if (revision !== this.revision.value) for (const view of this.views) view.sceneChanged(revision, this.#clock.now(), isSame(view));
    if (!input) return;
    const expected = this.views
      .filter(isSame)
      .map((view) => view.release(input))
      .find(Boolean);
    const other = expected && this.views.find((view) => view.isOpen.value && !isSame(view));
    other?.expect(input, expected.at, expected.sentAt);
  }

  #rendererChanged({ state, phase, percent, problem }) {
    const before = this.renderer.value.state;
    this.renderer.value = { state, phase, percent, problem };
    if (state === 'restarting' && before !== 'restarting') {
      this.#restored = true;
      this.notify('warn', say.restarting, 'renderer');
    }
  }

  #viewChanged({ view: number, document, follow }) {
    const view = this.view(number);
    if (!view?.isOpen.value || !this.following.viewFollows(view, follow)) return;
    // The server sends complete documents; an incomplete one throws here.
    const whole = readDocument('view', document);
    view.replace(follow || !view.ownSize ? whole : { ...whole, size_px: view.ownSize });
  }

  #refused({ to, view, input, problem }) {
    if (to.startsWith('item.') && this.items.refused(input, problem)) return; // whoever gave the command tells it
    this.#scene.refuse(input);
    if (this.view(view)) this.view(view).refuse(input);
    if (to === 'follow') this.following.refused();
    if (this.scene.value) this.#showScene();
    if (problem?.type === '/problems/not-presenter' && this.following.isOvertaken(to)) {
      const presenter = this.following.presenter.value;
      if (to === 'present') this.notify('ok', presenter ? say.hasTakenOver(presenter) : say.nobodyHasTakenOver, 'following');
      else if (to === 'scene.patch' || (to === 'view.patch' && this.following.hasLostControl))
        this.notify('warn', presenter ? say.notMade(presenter) : say.notMadeNobody, 'following');
      return;
    }
    if (to === '' && this.view(view)) this.view(view).refuseToDraw(problem?.detail || say.noReason);
    if (to === 'control.request' && problem?.retry_after_ms) {
      const [name, n] = [this.following.presenter.value?.name, Math.ceil(problem.retry_after_ms / 1000)];
      return void this.notify('warn', name ? say.askAgain({ name, n }) : say.askPresenterAgain({ n }), 'following');
    }
    const refused = to ? say.refusedMessage({ message: to }) : say.refusedAny;
    this.notify('err', problem?.detail ? this.control.named(problem.detail) : refused);
  }

  #lose(retryMs) {
    batch(() => {
      this.#setLink('lost', { retryAt: this.#clock.now() + retryMs });
      this.pingMs.value = null;
      this.#keepChanges();
    });
  }

  /** The sign-in has ended: what is shown stands still, and what was changed is kept for the time after the next one. */
  #pause() {
    batch(() => {
      this.#setLink('paused');
      this.#keepChanges();
    });
  }

  /** Keeps changes that the server has not answered, to be sent again after the next welcome. */
  #keepChanges() {
    this.items.recall();
    this.#scene.recall();
    for (const view of this.views) view.recall();
    this.#sending.hold();
  }

  #tooLarge() {
    this.#showScene();
    this.notify('err', say.tooLarge);
  }

  #setLink(state, more = {}) {
    this.link.value = { state, retryAt: 0, quietSince: 0, dueSince: 0, reason: '', ...more };
  }

  #showScene() {
    batch(() => {
      this.#sharedScene.value = this.#scene.value;
      this.isScenePending.value = this.#scene.isPending;
    });
  }
}
