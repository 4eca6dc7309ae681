// State of this page alone: tool, layout, selection, unfolded panels. Nothing of it is sent; the browser keeps the layout.
import { batch, computed, effect, signal } from '../../lib/signals-core.js';
import { arrange } from './arrangement.js';
import { Hotkeys } from './hotkeys.js';
import { Layout } from './layout.js';
import { splittersOf } from './splits.js';

const toastMs = 6000;

export class UiState {
  #clock;
  #nextToast = 1;

  /** @param {{now: () => number, setTimeout: Function}} clock @param {object|null} storage of the browser */
  constructor(clock, storage = null) {
    this.#clock = clock;
    this.panes = new Layout(storage);
    this.keys = new Hotkeys(storage);
    this.tool = signal('crosshair'); // crosshair | window | pan | zoom | measure | beam
    this.measureKind = signal('distance'); // what the tool measures
    this.draft = signal(null); // the measure that is being drawn: {view, kind, points, at: where the pointer is}
    this.maximised = signal(0); // a view; 0: none
    this.active = signal(1); // a view
    this.beamMover = signal('slice'); // what the slider of a beam's-eye pane moves: slice | clip | eye
    this.beforeBeam = 1; // the 3-D view whose place the beam's eye took last
    this.selection = signal({ kind: 'view', id: '' }); // what was clicked last: view | image | volume | region | dose | beam | kept | tracks | track | curve | clip | oblique | measure | measures
    this.track = signal(null); // the particle track that was clicked last: the server's answer
    this.note = signal(''); // id of the note, or of the reply, that is open in the inspector
    this.newNote = signal(null); // what a note that is being written is about: {point_mm} or {region}
    this.region = computed(() => (this.selection.value.kind === 'region' ? this.selection.value.id : ''));
    this.tab = signal('probe'); // probe | selection | plan | notes; in a sheet also dvh
    this.window = signal({ width: 1600, height: 1000, isCoarse: false });
    this.isTreeOpen = signal(true); // in a wide window; otherwise the sections are behind the rail or in a sheet
    this.isInspectorOpen = signal(true);
    this.section = signal(''); // open beside the rail
    this.isPinned = signal(false); // that section pushes the panes aside
    this.sheet = signal(''); // '' | tree | inspector
    this.sheetSection = signal(''); // shown in the sheet; '' the first
    this.folded = signal(new Set(['planes', 'clip'])); // sections of the tree that are folded
    this.picking = signal(null); // while a plane is made in the panes: {kind: 'points' or 'line', id of the plane, points, from, to, view}
    this.clips = []; // clip planes that key C has turned off
    this.row = signal(''); // row of the tree that takes the focus
    this.isDrawerOpen = signal(false); // histograms and profile of the dose
    this.isDrawerRight = signal(false); // beside the panes, not below them
    this.filter = signal(''); // part of the names that the tree lists
    this.transferPoint = signal(0); // chosen point of the transfer function
    this.turnLock = signal(''); // the axis that drags in 3-D turn about: L | P | S; '' as they go
    this.popover = signal(''); // name of the open popover
    this.toasts = signal([]);
    this.now = signal(clock.now()); // updated a few times a second, for ages on badges
    this.arrangement = computed(() =>
      arrange(this.window.value, {
        layout: this.panes.layout.value,
        two: this.panes.two.value,
        four: this.panes.four.value,
        isTreeOpen: this.isTreeOpen.value,
        section: this.section.value,
        isPinned: this.isPinned.value,
        sheet: this.sheet.value,
        drawer: this.isDrawerOpen.value ? (this.isDrawerRight.value ? 'right' : 'bottom') : '',
        isInspectorOpen: this.isInspectorOpen.value,
        active: this.active.value,
        maximised: this.maximised.value,
      }),
    );
    this.splitters = computed(() => splittersOf(this.panes.splits.value, this.arrangement.value, this.window.value));
    effect(() => {
      if (this.tool.value !== 'measure') this.draft.value = null;
    });
    this.isTouch = computed(() => ['tablet', 'phone'].includes(this.arrangement.value.size));
    this.visible = computed(() => this.arrangement.value.visible);
  }

  /**
   * @param {'ok'|'warn'|'err'} kind @param {string} topic a newer message replaces an older one on the same topic
   * @param {{word: string, keys?: (hotkeys: Hotkeys) => string, act: () => void}} [action] a button in the message @param {number} [ms] how long it is shown
   */
  notify = (kind, text, topic = text, action = null, ms = toastMs) => {
    const toast = { id: this.#nextToast++, kind, text, topic, action };
    this.toasts.value = [...this.toasts.value.filter((other) => other.topic !== topic).slice(-2), toast];
    this.#clock.setTimeout(() => this.dismiss(toast.id), ms);
  };

  dismiss(id) {
    this.toasts.value = this.toasts.value.filter((toast) => toast.id !== id);
  }

  toggle(name) {
    this.popover.value = this.popover.value === name ? '' : name;
  }

  /** Selects what was clicked in a picture. Opens no panel: the picture would move away under the pointer. isShown: turns to its tab. */
  select(kind, id = '', isShown = true) {
    batch(() => {
      this.selection.value = { kind, id };
      if (isShown) this.tab.value = 'selection';
    });
  }

  /** Selects what was clicked in a list and shows it in the inspector. */
  choose(kind, id = '') {
    batch(() => {
      this.select(kind, id);
      this.showTab('selection');
    });
  }

  showTab(tab) {
    batch(() => {
      this.tab.value = tab;
      if (this.isTouch.value) this.sheet.value = 'inspector';
      else this.isInspectorOpen.value = true;
    });
  }

  /** Opens a section beside the rail, or closes it when it is open. */
  openSection(id) {
    this.section.value = this.section.value === id ? '' : id;
  }

  openSheet(sheet) {
    this.sheet.value = this.sheet.value === sheet ? '' : sheet;
  }

  /** Opens or closes the drawer with the plots of dose, for fingers the sheet with them. */
  toggleDrawer() {
    if (!this.isTouch.value) this.isDrawerOpen.value = !this.isDrawerOpen.value;
    else if (this.sheet.value === 'inspector' && this.tab.value === 'dvh') this.sheet.value = '';
    else this.showTab('dvh');
  }

  /** @param {string} id of `layouts` in layout.js */
  setLayout(id) {
    batch(() => {
      this.maximised.value = 0;
      this.panes.choose(id);
    });
    if (!this.visible.value.includes(this.active.value)) this.active.value = this.visible.value[0];
  }

  /** The pane of one view shows another one from now on. */
  showInPlaceOf(from, to) {
    batch(() => {
      this.panes.place(this.arrangement.value.size === 'phone' ? 'single' : this.panes.layout.value, from, to);
      if (this.maximised.value) this.maximised.value = to;
      this.active.value = to;
    });
  }

  /** Folds the tree or a section in it. */
  fold(id, isFolded) {
    const folded = new Set(this.folded.value);
    if (isFolded) folded.add(id);
    else folded.delete(id);
    this.folded.value = folded;
  }

  maximise(number) {
    this.active.value = number;
    this.maximised.value = this.maximised.value ? 0 : number;
  }

  /** Closes one thing per call: what is being drawn, the making of a plane, tool, popover, what the page has to close (returns whether it had), toast, floating section, sheet or maximised pane. */
  escape(close = () => false) {
    if (this.draft.value) this.draft.value = null;
    else if (this.picking.value) this.picking.value = null;
    else if (this.tool.value !== 'crosshair') this.tool.value = 'crosshair';
    else if (this.popover.value) this.popover.value = '';
    else if (close()) return;
    else if (this.toasts.value.length) this.dismiss(this.toasts.value.at(-1).id);
    else if (this.arrangement.value.overlay === 'floats') this.section.value = '';
    else if (this.arrangement.value.sheet) this.sheet.value = '';
    else this.maximised.value = 0;
  }
}
