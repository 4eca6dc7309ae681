// Measurements for tests and benchmarks: window.beamroom. It changes nothing.
//   beamroom.stats()   {input_to_paint_ms: [...], frames, frames_of: {view: n}, fps: {view: n}, headers: {view: FrameHeader}, documents: {view: document}, badges: {view: word}}
//   beamroom.clear()   forgets the measured times

const capacity = 5000;

export class Hooks {
  #clock;
  #times = [];
  #frames = 0;
  #framesOf = new Map(); // by view
  #room = null;
  #panes = [];

  constructor(clock) {
    this.#clock = clock;
    globalThis.beamroom = {
      stats: () => this.#stats(),
      clear: () => {
        this.#times = [];
      },
    };
  }

  enter(room, panes) {
    this.#room = room;
    this.#panes = panes;
    this.#times = [];
    this.#frames = 0;
    this.#framesOf.clear();
  }

  /** Records that a picture was drawn that answers these inputs, and tells the times in ms when the browser has painted it. */
  painted(header, answered, measured = () => {}) {
    this.#frames += 1;
    this.#framesOf.set(header.view, (this.#framesOf.get(header.view) ?? 0) + 1);
    if (!answered.length) return;
    const { port1, port2 } = new MessageChannel();
    port1.onmessage = () => {
      const now = this.#clock.now();
      const times = answered.map(({ at }) => now - at);
      this.#times.push(...times);
      measured(times);
      this.#times.splice(0, this.#times.length - capacity);
      port1.close();
    };
    port2.postMessage(0); // arrives after this animation frame has been painted
  }

  #stats() {
    const by = (pick) => Object.fromEntries((this.#room?.views ?? []).map((view, index) => [view.number, pick(view, index)]));
    return {
      input_to_paint_ms: [...this.#times],
      frames: this.#frames,
      frames_of: by((view) => this.#framesOf.get(view.number) ?? 0),
      fps: by((view) => view.fps.value),
      headers: by((view) => view.painted.value),
      documents: by((view) => view.document.value),
      badges: by((_, index) => this.#panes[index].badge.value?.state ?? ''),
    };
  }
}
