// Reads binary WebSocket messages: the header in front of each picture (proto/frame.md), and the picture.

const magic = 0x524d5242;
const version = 1;
const headerBytes = 112;
const mediaTypes = { 1: 'image/jpeg', 2: 'image/png' };

/**
 * @typedef {object} FrameHeader
 * @property {string} media_type
 * @property {boolean} is_still @property {boolean} is_lossless @property {boolean} is_full_color
 * @property {boolean} is_shared @property {boolean} is_coarse
 * @property {number} quality @property {number} scale_percent as drawn
 * @property {number} view @property {number} sequence @property {number} scene_revision @property {number} input_id
 * @property {number} width_px @property {number} height_px @property {number} render_us @property {number} encode_us
 * @property {number} pixels_per_mm 0 in perspective; of the view's full size
 * @property {number[]} full_px of the view's full size
 * @property {Float32Array} clip_from_lps_mm column-major
 */

/**
 * Header and picture of a binary message; throws a RangeError that names the wrong field.
 * @param {ArrayBuffer} message
 * @returns {{header: FrameHeader, picture: Uint8Array}}
 */
export function readFrame(message) {
  const size = message.byteLength;
  if (size < headerBytes) throw new RangeError(`frame of ${size} bytes, expected at least ${headerBytes}`);
  const data = new DataView(message);
  const u8 = (at) => data.getUint8(at);
  const u16 = (at) => data.getUint16(at, true);
  const u32 = (at) => data.getUint32(at, true);
  if (u32(0) !== magic) throw new RangeError(`frame starts with 0x${u32(0).toString(16)}, expected 0x${magic.toString(16)}`);
  if (u16(4) !== version) throw new RangeError(`frame version ${u16(4)}, expected ${version}`);
  const start = u16(6);
  if (start < headerBytes || start > size) throw new RangeError(`frame header of ${start} bytes, expected ${headerBytes} to ${size}`);
  if (start + u32(40) !== size) throw new RangeError(`picture of ${u32(40)} bytes, expected ${size - start}`);
  const mediaType = mediaTypes[u8(8)];
  if (!mediaType) throw new RangeError(`frame codec ${u8(8)}, expected 1 or 2`);
  if (u8(11) < 10 || u8(11) > 100) throw new RangeError(`frame scale ${u8(11)} %, expected 10 to 100`);
  if (u16(28) === 0 || u16(30) === 0) throw new RangeError(`frame of ${u16(28)} x ${u16(30)} pixels`);
  const matrix = Float32Array.from({ length: 16 }, (_, index) => data.getFloat32(48 + 4 * index, true));
  if (!matrix.every(Number.isFinite)) throw new RangeError('frame matrix is not finite');
  const flags = u8(9);
  const divisor = flags & 64 ? 4 : flags & 32 ? 2 : 1;
  return {
    header: {
      media_type: mediaType,
      is_still: (flags & 1) !== 0,
      is_lossless: (flags & 2) !== 0,
      is_full_color: (flags & 4) !== 0,
      is_shared: (flags & 8) !== 0,
      is_coarse: (flags & 16) !== 0,
      quality: u8(10),
      scale_percent: u8(11),
      view: u32(12),
      sequence: u32(16),
      scene_revision: u32(20),
      input_id: u32(24),
      width_px: u16(28),
      height_px: u16(30),
      full_px: [28, 30].map((at) => (u16(at) * divisor * 100) / u8(11)),
      render_us: u32(32),
      encode_us: u32(36),
      pixels_per_mm: u32(44) / 1000,
      clip_from_lps_mm: matrix,
    },
    picture: new Uint8Array(message, start),
  };
}
