// Reads the text that the daemon puts into annotated PNG files: chunks, their checksums and compressed international text
// (PNG specification, 3rd edition, sections 5.3, 11.3.3.4, D). The file may be hostile: everything is bounded.

import { say } from './later_words.js';
/** The fault of a picture, in a sentence. */
class Damage extends Error {}
const signature = [0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a];
const maxTextBytes = 4 << 20; // a scene of 1024 regions has 0.2 MB
/** The daemon sends no larger picture. */
export const maxFileBytes = 84934656;

const crcTable = Uint32Array.from({ length: 256 }, (_, n) => {
  let c = n;
  for (let bit = 0; bit < 8; bit++) c = c & 1 ? 0xedb88320 ^ (c >>> 1) : c >>> 1;
  return c >>> 0;
});

export function crc32(bytes) {
  let c = 0xffffffff;
  for (const byte of bytes) c = crcTable[(c ^ byte) & 255] ^ (c >>> 8);
  return (c ^ 0xffffffff) >>> 0;
}

export const isPng = (bytes) => bytes.length >= signature.length && signature.every((byte, at) => bytes[at] === byte);

/** At most maxTextBytes come out, whatever the stream says. */
async function inflate(bytes) {
  const reader = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate')).getReader();
  const parts = [];
  let n = 0;
  for (let part = await reader.read(); !part.done; part = await reader.read()) {
    n += part.value.length;
    if (n > maxTextBytes) {
      reader.cancel().catch(() => {});
      throw new Damage(say.tooLong);
    }
    parts.push(part.value);
  }
  return new Blob(parts).arrayBuffer();
}

async function readText(data) {
  const [isCompressed, method] = data;
  const language = data.indexOf(0, 2);
  const translated = language < 0 ? -1 : data.indexOf(0, language + 1);
  if (translated < 0 || isCompressed > 1 || method !== 0) throw new Damage(say.damaged);
  const text = data.subarray(translated + 1);
  if (!isCompressed && text.length > maxTextBytes) throw new Damage(say.tooLong);
  const plain = isCompressed ? await inflate(text) : text;
  return new TextDecoder('utf-8', { fatal: true }).decode(plain);
}

/**
 * The text of the first iTXt chunk with this keyword.
 * @param {Uint8Array} bytes @param {string} keyword ASCII
 * @returns {Promise<string|null>} null: no PNG, or none with such a text; throws an Error with a sentence when it is damaged
 */
export async function textOfPng(bytes, keyword) {
  if (!isPng(bytes)) return null;
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const key = [...new TextEncoder().encode(keyword), 0];
  for (let at = signature.length; at + 12 <= bytes.length; ) {
    const length = view.getUint32(at);
    if (length > bytes.length - at - 12) break;
    const type = String.fromCharCode(...bytes.subarray(at + 4, at + 8));
    const data = bytes.subarray(at + 8, at + 8 + length);
    if (type === 'IEND') return null;
    if (type === 'iTXt' && key.every((byte, index) => data[index] === byte)) {
      if (crc32(bytes.subarray(at + 4, at + 8 + length)) !== view.getUint32(at + 8 + length)) throw new Damage(say.damaged);
      try {
        return await readText(data.subarray(key.length));
      } catch (error) {
        throw error instanceof Damage ? error : new Damage(say.damaged);
      }
    }
    at += 12 + length;
  }
  throw new Damage(say.cutOff);
}
