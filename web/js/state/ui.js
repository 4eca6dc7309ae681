// State of this page alone: tool, layout, selection, unfolded panels. Nothing of it is stored or sent.
import { computed, signal } from '../../lib/signals-core.js';

const toastMs = 6000;

export class UiState {
  #clock;
  #nextToast = 1;

  /** @param {{now: () => number, setTimeout: Function}} clock */
  constructor(clock) {
    this.#clock = clock;
    this.tool = signal('crosshair'); // crosshair | window | pan | zoom
    this.layout = signal('2x2'); // 2x2 | 1+3 | single
    this.maximised = signal(0);
    this.active = signal(1);
    this.region = signal('');
    this.tab = signal('probe'); // probe | view | report
    this.isTreeOpen = signal(true);
    this.isInspectorOpen = signal(true);
    this.popover = signal(''); // name of the open popover
    this.toasts = signal([]);
    this.now = signal(clock.now()); // updated a few times a second, for ages on badges
    this.visible = computed(() => {
      if (this.maximised.value) return [this.maximised.value];
      return this.layout.value === 'single' ? [this.active.value] : [1, 2, 3, 4];
    });
  }

  /**
   * @param {'ok'|'warn'|'err'} kind @param {string} topic a newer message replaces an older one on the same topic
   * @param {{word: string, keys?: string, act: () => void}} [action] a button in the message
   */
  notify = (kind, text, topic = text, action = null) => {
    const toast = { id: this.#nextToast++, kind, text, topic, action };
    this.toasts.value = [...this.toasts.value.filter((other) => other.topic !== topic).slice(-2), toast];
    this.#clock.setTimeout(() => this.dismiss(toast.id), toastMs);
  };

  dismiss(id) {
    this.toasts.value = this.toasts.value.filter((toast) => toast.id !== id);
  }

  /** Selects what was clicked in a picture. Opens no panel: the picture would move away under the pointer. isShown: turns to its tab. */
  select(kind, id, isShown = true) {
    if (kind === 'region') this.region.value = id;
    if (isShown) this.tab.value = 'probe';
  }

  toggle(name) {
    this.popover.value = this.popover.value === name ? '' : name;
  }

  maximise(number) {
    this.active.value = number;
    this.maximised.value = this.maximised.value ? 0 : number;
  }

  /** Closes one thing per call: tool, popover, what the page has to close (returns whether it had), toast or maximised pane. */
  escape(close = () => false) {
    if (this.tool.value !== 'crosshair') this.tool.value = 'crosshair';
    else if (this.popover.value) this.popover.value = '';
    else if (close()) return;
    else if (this.toasts.value.length) this.dismiss(this.toasts.value.at(-1).id);
    else this.maximised.value = 0;
  }
}
