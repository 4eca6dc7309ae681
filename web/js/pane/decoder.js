// Decodes pictures in a worker: createImageBitmap() takes a Blob, and making one blocks its thread until another process of the browser has
// answered, which takes longer than painting the picture. What the worker cannot decode, or not yet, is decoded here.

export class Decoder {
  #makeWorker;
  #decodeHere;
  #worker = null;
  #isStarted = false;
  #isReady = false;
  #next = 1;
  #waiting = new Map(); // id -> {picture, type, resolve}

  /**
   * @param {object} world
   * @param {() => Worker} world.makeWorker of decode_worker.js
   * @param {(picture: Uint8Array, type: string) => Promise<ImageBitmap>} world.decodeHere
   */
  constructor({ makeWorker, decodeHere }) {
    this.#makeWorker = makeWorker;
    this.#decodeHere = decodeHere;
  }

  /** @param {Uint8Array} picture @param {string} type of media @returns {Promise<ImageBitmap>} */
  decode = (picture, type) => {
    this.#start();
    if (!this.#isReady) return this.#decodeHere(picture, type);
    return new Promise((resolve) => {
      const id = this.#next++;
      this.#waiting.set(id, { picture, type, resolve });
      this.#worker.postMessage({ id, picture, type }); // a copy: should the worker fail, the picture is still here
    });
  };

  #start() {
    if (this.#isStarted) return;
    this.#isStarted = true;
    try {
      this.#worker = this.#makeWorker();
    } catch {
      return; // a browser that allows none
    }
    this.#worker.addEventListener('message', ({ data }) => this.#take(data));
    for (const event of ['error', 'messageerror']) this.#worker.addEventListener(event, () => this.#fail());
  }

  #take({ isReady, id, bitmap }) {
    if (isReady) return void (this.#isReady = true);
    const { picture, type, resolve } = this.#waiting.get(id);
    this.#waiting.delete(id);
    resolve(bitmap ?? this.#decodeHere(picture, type));
  }

  #fail() {
    this.#isReady = false;
    this.#worker.terminate();
    for (const { picture, type, resolve } of this.#waiting.values()) resolve(this.#decodeHere(picture, type));
    this.#waiting.clear();
  }
}
