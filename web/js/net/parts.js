// Reads the parts of a display's stream, multipart/x-mixed-replace (proto/http.json).

const boundary = '--beamroom\r\n';
const maxHead = 8192;
const maxBody = 64 << 20;

/** Index of the bytes of a text; -1: not there. */
function find(bytes, text) {
  for (let at = 0; at + text.length <= bytes.length; at++) {
    let n = 0;
    while (n < text.length && bytes[at + n] === text.charCodeAt(n)) n += 1;
    if (n === text.length) return at;
  }
  return -1;
}

const latin1 = (bytes) => String.fromCharCode(...bytes);

export class Parts {
  #bytes = new Uint8Array();
  #head = null; // {fields, n}: of the part whose body is coming

  /**
   * Takes bytes as they come. Returns the parts that are complete now; throws a RangeError that names what is wrong.
   * @param {Uint8Array} bytes
   * @returns {{fields: Record<string, string>, body: Uint8Array}[]} fields: by lower-case name
   */
  push(bytes) {
    const joined = new Uint8Array(this.#bytes.length + bytes.length);
    joined.set(this.#bytes);
    joined.set(bytes, this.#bytes.length);
    this.#bytes = joined;
    const parts = [];
    for (let part = this.#next(); part; part = this.#next()) parts.push(part);
    return parts;
  }

  #take(n) {
    const taken = this.#bytes.slice(0, n);
    this.#bytes = this.#bytes.subarray(n);
    return taken;
  }

  #next() {
    this.#head ??= this.#readHead();
    if (!this.#head || this.#bytes.length < this.#head.n + 2) return null;
    const { fields, n } = this.#head;
    this.#head = null;
    const body = this.#take(n);
    if (latin1(this.#take(2)) !== '\r\n') throw new RangeError('a part of the stream is longer than it says');
    return { fields, body };
  }

  #readHead() {
    const start = latin1(this.#bytes.subarray(0, boundary.length));
    if (!boundary.startsWith(start)) throw new RangeError('a part of the stream does not begin with its boundary');
    const end = find(this.#bytes.subarray(0, maxHead), '\r\n\r\n');
    if (end < 0) {
      if (this.#bytes.length >= maxHead) throw new RangeError(`the head of a part has more than ${maxHead} bytes`);
      return null;
    }
    const lines = latin1(this.#take(end + 4).subarray(boundary.length))
      .trim()
      .split('\r\n');
    const fields = Object.fromEntries(
      lines.map((line) => [line.slice(0, line.indexOf(':')).toLowerCase(), line.slice(line.indexOf(':') + 1).trim()]),
    );
    const n = /^\d{1,9}$/.test(fields['content-length'] ?? '') ? Number(fields['content-length']) : NaN;
    if (!(n > 0 && n <= maxBody)) throw new RangeError(`a part of ${fields['content-length']} bytes, expected 1 to ${maxBody}`);
    return { fields, n };
  }
}

/** Header of a part's picture, from its fields, as the painter and the letters take it. */
export function pictureHeader(fields) {
  const [width, height] = (fields['beamroom-size'] ?? '').split('x').map(Number);
  const matrix = (fields['beamroom-clip-from-lps'] ?? '').split(' ').map(Number);
  if (!(width > 0 && height > 0) || matrix.length !== 16 || !matrix.every(Number.isFinite))
    throw new RangeError('a part of the stream says neither size nor camera of its picture');
  return {
    media_type: 'image/jpeg',
    view: 0,
    sequence: Number(fields['beamroom-picture']),
    width_px: width,
    height_px: height,
    clip_from_lps_mm: Float32Array.from(matrix),
    missing: fields['beamroom-missing'] ?? '',
    kind: fields['beamroom-view'] ?? '',
  };
}
