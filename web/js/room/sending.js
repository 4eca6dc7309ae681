// Sends the changes of a room's page, those of some milliseconds in one patch, each with an input number.

export class Sending {
  #connection;
  #clock;
  #schedule;
  #views;
  #scene;
  #refused;
  #nextInput = 1;
  #isScheduled = false;
  #inputAt = new Map(); // view -> time of the newest input event in its pane
  #sceneOrigin = { view: 0, at: 0 };
  /** True while changes are kept: without a connection, and after one until the server has said who presents. */
  isHeld = true;

  /**
   * @param {object} world
   * @param {import('../net/connection.js').Connection} world.connection
   * @param {import('./view.js').ViewState[]} world.views @param {import('./replica.js').Replica} world.scene
   * @param {() => void} world.refused called after a change that could not be sent was taken back
   */
  constructor({ connection, clock, schedule, views, scene, refused }) {
    this.#connection = connection;
    this.#clock = clock;
    this.#schedule = schedule;
    this.#views = views;
    this.#scene = scene;
    this.#refused = refused;
  }

  /** Sends a message at once, after the changes that are queued. Returns its input number; 0 without a connection. */
  act(message) {
    if (!this.isHeld) this.#flush();
    const input = this.#nextInput++;
    return this.#connection.send({ ...message, input }) ? input : 0;
  }

  /** Sends the queued changes soon. view, sceneView: the pane of the input event, for measurements. */
  plan({ view = 0, sceneView = 0, at = 0 } = {}) {
    if (view) this.#inputAt.set(view, at);
    if (sceneView) this.#sceneOrigin = { view: sceneView, at };
    if (this.#isScheduled) return;
    this.#isScheduled = true;
    this.#schedule(() => {
      this.#isScheduled = false;
      if (!this.isHeld) this.#flush();
    });
  }

  /** Keeps changes from now on. The times of their inputs are forgotten: waiting for a connection is no latency. */
  hold() {
    this.isHeld = true;
    this.#inputAt.clear();
    this.#sceneOrigin = { view: 0, at: 0 };
  }

  /** Sends what was kept. */
  release() {
    this.isHeld = false;
    this.plan();
  }

  #flush() {
    const now = this.#clock.now();
    for (const view of this.#views) {
      if (!view.isOpen.value) continue;
      const input = this.#nextInput;
      const patch = view.take(input);
      if (!patch) continue;
      this.#nextInput += 1;
      const at = this.#inputAt.get(view.number) ?? 0;
      if (this.#connection.send({ type: 'view.patch', view: view.number, patch, input, ...(!at && { acted: false }) }))
        view.expect(input, at, now);
      else this.#takeBack(view, input);
    }
    this.#inputAt.clear();
    const input = this.#nextInput;
    const patch = this.#scene.take(input);
    if (!patch) return;
    this.#nextInput += 1;
    const { view, at } = this.#sceneOrigin;
    const origin = this.#views.find(({ number, isOpen }) => number === view && isOpen.value);
    if (!this.#connection.send({ type: 'scene.patch', patch, ...(origin && { view }), input }))
      return void this.#takeBack(this.#scene, input);
    this.#sceneOrigin = { view: 0, at: 0 };
    origin?.expect(input, at, now);
  }

  /** The message is too large, as a lost connection holds all changes back. */
  #takeBack(document, input) {
    document.refuse(input);
    this.#refused();
  }
}
