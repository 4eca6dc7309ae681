// Paints frames on a canvas: one is being decoded, the newest other one waits; a frame is acknowledged after it was drawn.

export class Painter {
  #canvas;
  #context;
  #decode;
  #schedule;
  #onPainted;
  #isDecoding = false;
  #waiting = null; // {header, picture}: received while another is being decoded
  #ready = null; // {header, bitmap}: decoded, drawn before the next paint
  #isStopped = false;

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {object} world
   * @param {(picture: Uint8Array, type: string) => Promise<ImageBitmap>} world.decode
   * @param {(callback: () => void) => void} world.schedule calls back before the next paint
   * @param {(header: import('../wire/frame.js').FrameHeader, isDrawn: boolean) => void} world.onPainted
   */
  constructor(canvas, { decode, schedule, onPainted }) {
    this.#canvas = canvas;
    this.#context = canvas.getContext('2d', { alpha: false });
    this.#decode = decode;
    this.#schedule = schedule;
    this.#onPainted = onPainted;
  }

  offer(frame) {
    if (this.#isStopped) return;
    if (this.#isDecoding) this.#waiting = frame;
    else this.#start(frame);
  }

  stop() {
    this.#isStopped = true;
    this.#waiting = null;
    this.#ready?.bitmap.close();
    this.#ready = null;
  }

  async #start({ header, picture }) {
    this.#isDecoding = true;
    let bitmap = null;
    try {
      bitmap = await this.#decode(picture, header.media_type);
    } catch (error) {
      console.warn(`beamroom: picture ${header.sequence} of view ${header.view} cannot be decoded: ${error.message}`);
    }
    this.#isDecoding = false;
    if (this.#isStopped) return void bitmap?.close();
    // A picture that cannot be decoded is acknowledged, too; otherwise the server would wait for ever.
    if (bitmap) this.#show(header, bitmap);
    else this.#onPainted(header, false);
    const next = this.#waiting;
    this.#waiting = null;
    if (next) this.#start(next);
  }

  #show(header, bitmap) {
    const isPlanned = this.#ready !== null;
    this.#ready?.bitmap.close();
    this.#ready = { header, bitmap };
    if (!isPlanned) this.#schedule(() => this.#draw());
  }

  #draw() {
    if (!this.#ready) return;
    const { header, bitmap } = this.#ready;
    this.#ready = null;
    if (this.#canvas.width !== header.width_px) this.#canvas.width = header.width_px;
    if (this.#canvas.height !== header.height_px) this.#canvas.height = header.height_px;
    this.#context.drawImage(bitmap, 0, 0);
    bitmap.close();
    this.#onPainted(header, true);
  }
}
