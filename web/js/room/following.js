// The presenter, and whether this member follows them with all panes or is on their own. Nobody else's picture
// moves when a member leaves: their views become own views, and their changes of the scene the override of these.
import { batch, computed, signal } from '../../lib/signals-core.js';
import { asShown, ownBeam, wholeCamera, widen, widening } from './own_camera.js';
import { mergePatch } from '../wire/merge.js';
import { beamShown } from './beam_line.js';
import { leftBehind } from './marks.js';
import { say } from './words.js';
import { pixelRatio } from '../parts/page_look.js';

const usualSize = [1024, 768]; // of a pane that was never shown
const footPx = 28; // of a slice, where letters, scale and window stand (pane/overlay.js)

/** The parts of a view's document that are of the screen: lines are as wide on any, and fade where words stand. */
function screenOf(document = {}) {
  const ratio = Math.max(1, pixelRatio());
  return { ...((document.pixel_ratio ?? 1) !== ratio && { pixel_ratio: ratio }), foot_px: footPx };
}

export class Following {
  #room;
  #tell;

  /**
   * @param {import('./room.js').RoomState} room
   * @param {(message: object) => void} tell sends a message with an input number; does nothing without a connection
   */
  constructor(room, tell) {
    this.#room = room;
    this.#tell = tell;
    const own = () => room.members.value.find(({ id }) => id === room.member.value);
    this.hasLostControl = false; // this member has presented, and nothing else since then
    this.isFollowing = signal(true); // also true for the presenter, whose views are the shared ones
    this.presenter = computed(() => room.members.value.find(({ presenting }) => presenting) ?? null);
    this.isPresenting = computed(() => own()?.presenting === true);
    this.nFollowers = computed(
      () => room.members.value.filter((other) => other.id !== room.member.value && other.connected !== false && other.following).length,
    );
    /** presenting | following | own | away: follows a presenter who lost the connection | none: nobody presents */
    this.standing = computed(() => {
      if (this.isPresenting.value) return 'presenting';
      if (!this.presenter.value) return room.members.value.length ? 'none' : 'following';
      if (!this.isFollowing.value) return 'own';
      return this.presenter.value.connected === false ? 'away' : 'following';
    });
    /** A merge patch on the scene for the own views; null while the member follows. */
    this.override = computed(() => (this.isFollowing.value ? null : (this.#lead.document.value.override ?? null)));
  }

  /** All own views have the same override; that of a closed view may be older. */
  get #lead() {
    return this.#room.views.find((view) => view.isOpen.value) ?? this.#room.views[0];
  }

  // ---- acts of the user -------------------------------------------------------------------------------------------

  /** Leaves the presenter with all panes at once. Returns whether anything changed. */
  leave() {
    const { scene, plan, views, notify } = this.#room;
    if (!this.isFollowing.value || this.isPresenting.value || !scene.value || !plan.value) return false;
    const slices = Object.fromEntries(Object.entries(scene.value.image.slices).map(([axis, { position_mm }]) => [axis, { position_mm }]));
    const planes = Object.entries(scene.value.image.obliques ?? {}).map(([id, { origin_mm, normal }]) => [id, { origin_mm, normal }]);
    const image = planes.length ? { slices, obliques: Object.fromEntries(planes) } : { slices };
    const beam = beamShown(plan.value, scene.value);
    const override = beam ? { image, beam: { slice: { along_mm: scene.value.beam.slice.along_mm } } } : { image };
    batch(() => {
      for (const view of views) view.restart(this.#ownDocument(view, plan.value, override, beam));
      this.isFollowing.value = false;
    });
    this.hasLostControl = false;
    this.#act(false);
    notify('ok', say.onYourOwn, 'following', { word: say.return, keys: (hotkeys) => hotkeys.orEscape('follow'), act: () => this.return() });
    return true;
  }

  /** Follows again, with all panes. Returns whether anything changed. */
  return() {
    if (this.isFollowing.value || this.isPresenting.value) return false;
    const { patch, n } = leftBehind(this.override.value, this.#room.sharedScene, this.#room.member.value);
    this.#follow();
    this.#room.returned();
    this.#act(true);
    const name = this.presenter.value?.name;
    const words = name ? say.following({ name }) : say.backShared;
    if (n && this.#room.control.may('scene'))
      this.#room.notify('warn', say.stayBehind({ where: words }), 'following', {
        word: n > 1 ? say.giveMarks({ n }) : say.giveMark,
        act: () => this.#room.patchScene(patch),
      });
    else this.#room.notify('ok', words, 'following');
    return true;
  }

  /** Key F. */
  toggle() {
    if (this.isPresenting.value) this.#room.notify('ok', say.youArePresenting, 'following');
    else if (!this.return()) this.leave();
  }

  /** Takes over a room without presenter: the own views become the room's. */
  present() {
    if (!this.presenter.value) this.#tell({ type: 'present' });
  }

  /** Calls everybody back to the presenter's views. */
  showEveryone() {
    if (!this.isPresenting.value) return;
    this.#tell({ type: 'show.everyone' });
    this.#room.notify('ok', say.everybodySees, 'following');
  }

  /** The scene patch as an override of all own views. */
  patchOwn(patch) {
    for (const view of this.#room.views) {
      if (view.isOpen.value) view.queue({ override: patch });
      else view.restart(mergePatch(view.document.value, { override: patch }));
    }
  }

  /** A change of the shared camera that made the member leave, as a change of the own view that has taken its place. */
  adapted(number, patch) {
    const { kind, widening: factor } = this.#room.view(number);
    // a camera of a saved view that says null is the home one, which shows the whole plan in a pane of any size
    return patch.camera && patch.camera.position_mm !== null ? { ...patch, camera: widen(patch.camera, kind, factor) } : patch;
  }

  /** The document with which a view opens. */
  documentToOpen(view) {
    const document = { ...view.document.value, size_px: view.ownSize, ...screenOf(view.document.value) };
    if (this.isFollowing.value) delete document.override;
    else if (this.override.value) document.override = this.override.value;
    return document;
  }

  // ---- messages of the server -------------------------------------------------------------------------------------

  /** Takes the list of members. Returns whether this member became the presenter by it. */
  membersChanged(members) {
    const [wasPresenting, before] = [this.isPresenting.value, this.presenter.value];
    this.#room.members.value = members;
    const own = members.find(({ id }) => id === this.#room.member.value);
    if (!own) return false;
    if (wasPresenting !== own.presenting) this.hasLostControl = wasPresenting;
    if (own.presenting && !wasPresenting) {
      const isAlone = !members.some(({ id, connected }) => id !== own.id && connected !== false);
      if (before || !isAlone) this.#room.notify('ok', isAlone ? say.alone : say.youPresent, 'following');
      return true;
    }
    if (wasPresenting && !own.presenting && this.presenter.value)
      this.#room.notify('warn', say.presentsNow(this.presenter.value), 'following');
    if (before && !this.presenter.value)
      this.#room.notify('warn', say.nobodyPresents, 'following', {
        word: say.takeOver,
        act: () => this.present(),
      });
    return false;
  }

  /**
   * The own views of a presenter become the room's. The server does that by itself with the views that are open when a member
   * is left alone, but a member who comes back presents before their views are open.
   */
  shareOwn() {
    if (!this.isPresenting.value || this.isFollowing.value) return;
    if (this.#room.views.some((view) => view.isOpen.value)) this.#tell({ type: 'present' });
    else this.#follow();
  }

  /** This member was given control or took it: they present the room's views from here on, not their own. */
  gotControl() {
    if (this.isFollowing.value) return;
    this.#follow();
    this.#room.returned();
  }

  /** Takes the follow flag of a view message. Returns false if the message is older than this member's last act. */
  viewFollows(view, follow) {
    if (view.awaited.length) {
      if (view.awaited[0] === follow) view.awaited.shift();
      return !view.awaited.length && follow === this.isFollowing.value;
    }
    if (follow === this.isFollowing.value) return true;
    if (!follow) this.isFollowing.value = false;
    else {
      this.#follow();
      // a presenter who is away did not call: the list of members that says who presents now is still to come
      if (this.presenter.value && this.presenter.value.connected !== false && !this.isPresenting.value) {
        this.#room.returned();
        this.#room.notify('ok', say.showsEverybody(this.presenter.value), 'following');
      }
    }
    return true;
  }

  /** The server refused to let this member leave or return. */
  refused() {
    for (const view of this.#room.views) view.awaited = [];
    if (this.isFollowing.value) return;
    this.#follow();
    if (!this.isPresenting.value) return void this.#room.returned();
    // what was sent as changes of own views has changed the shared ones: they become what this page shows
    for (const view of this.#room.views)
      if (view.isOpen.value)
        this.#tell({ type: 'view.patch', view: view.number, patch: { camera: view.document.value.camera ?? null, override: null } });
  }

  /**
   * Whether a message that only a presenter, or only somebody else, may send was right when it was sent: who presents and who
   * follows had changed on the server meanwhile, and this page has heard of that by now. Nobody did anything wrong then.
   */
  isOvertaken(type) {
    if (type === 'follow') return this.isPresenting.value;
    if (type === 'present') return this.presenter.value !== null && !this.isPresenting.value;
    return ['view.patch', 'scene.patch'].includes(type) && this.isFollowing.value && !this.isPresenting.value;
  }

  #follow() {
    batch(() => {
      for (const view of this.#room.views) {
        const { override, ...document } = view.document.value;
        if (override) view.restart(document);
      }
      this.isFollowing.value = true;
    });
  }

  #act(follow) {
    const open = this.#room.views.filter((view) => view.isOpen.value);
    const views = open.map((view) => ({ view: view.number, document: view.document.value }));
    if (this.#tell(follow ? { type: 'follow', follow } : { type: 'follow', follow, views }))
      for (const view of open) view.awaited.push(follow);
  }

  #ownDocument(view, plan, override, beam) {
    const camera = wholeCamera({ ...view.document.value, kind: view.kind }, plan);
    const shared = asShown(camera, view.document.value.beam);
    const size_px = view.ownSize ?? view.document.value.size_px ?? usualSize;
    view.widening = widening(shared, view.kind, view.document.value.size_px ?? size_px, view.painted.value, size_px);
    const { number, plane } = view.document.value;
    return {
      kind: view.kind,
      ...(number > 1 && { number }),
      ...(view.kind === 'oblique' && plane && { plane }),
      size_px,
      ...screenOf(),
      ...(view.kind === 'beam' && { beam: ownBeam(view.document.value.beam, view.painted.value, beam) }),
      camera: { ...widen(shared, view.kind, view.widening), projection: camera.projection },
      override: mergePatch(view.document.value.override ?? {}, override),
    };
  }
}
