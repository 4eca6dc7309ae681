// A reader of EBML of our own: size, length and frames of a film.
import assert from 'node:assert/strict';

/** The elements of EBML in bytes[at..end): RFC 8794, sections 4 and 5. */
function* elements(bytes, at, end) {
  const number = (from, n) => bytes.subarray(from, from + n).reduce((value, byte) => value * 256 + byte, 0);
  while (at < end) {
    const nId = Math.clz32(bytes[at]) - 23;
    const nSize = Math.clz32(bytes[at + nId]) - 23;
    const from = at + nId + nSize;
    const size = (bytes[at + nId] & (0xff >> nSize)) * 256 ** (nSize - 1) + number(at + nId + 1, nSize - 1);
    at = from + size;
    assert.ok(at <= end, 'an element ends inside its parent');
    yield { id: number(from - nId - nSize, nId), from, end: at, value: size <= 8 ? number(from, size) : 0 };
  }
}

/** Size, length and number of frames of a film: RFC 9559, section 5. */
export function webm(bytes) {
  const found = { nFrames: 0 };
  const inside = [0x18538067, 0x1549a966, 0x1654ae6b, 0xae, 0xe0, 0x1f43b675]; // segment, info, tracks, entry, video, cluster
  const read = (from, end) => {
    for (const { id, from: first, end: last, value } of elements(bytes, from, end)) {
      if (inside.includes(id)) read(first, last);
      if (id === 0x4489) found.ms = last - first === 8 ? bytes.readDoubleBE(first) : bytes.readFloatBE(first);
      if (id === 0xb0) found.width = value;
      if (id === 0xba) found.height = value;
      if (id === 0x86) found.codec = bytes.toString('latin1', first, last);
      if (id === 0xa3) found.nFrames++;
    }
  };
  read(0, bytes.length);
  return found;
}
