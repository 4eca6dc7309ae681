// Reads 8-bit RGB and RGBA PNG files without interlacing: enough to check pictures in tests (PNG specification, 3rd edition).
import { inflateSync } from 'node:zlib';

export function readPng(bytes) {
  const at = Buffer.from(bytes);
  if (at.readUInt32BE(0) !== 0x89504e47) throw new Error('not a PNG');
  let width, height, channels;
  const data = [];
  for (let pos = 8; pos < at.length; ) {
    const n = at.readUInt32BE(pos);
    const type = at.toString('latin1', pos + 4, pos + 8);
    if (type === 'IHDR') {
      width = at.readUInt32BE(pos + 8);
      height = at.readUInt32BE(pos + 12);
      if (at[pos + 16] !== 8 || at[pos + 20] !== 0) throw new Error('not 8 bits or interlaced');
      channels = { 2: 3, 6: 4 }[at[pos + 17]];
    } else if (type === 'IDAT') data.push(at.subarray(pos + 8, pos + 8 + n));
    pos += 12 + n;
  }
  const raw = inflateSync(Buffer.concat(data));
  const stride = width * channels;
  const pixels = Buffer.alloc(stride * height);
  for (let y = 0; y < height; y++) {
    const filter = raw[y * (stride + 1)];
    for (let i = 0; i < stride; i++) {
      const left = i >= channels ? pixels[y * stride + i - channels] : 0;
      const up = y ? pixels[(y - 1) * stride + i] : 0;
      const corner = y && i >= channels ? pixels[(y - 1) * stride + i - channels] : 0;
      const p = left + up - corner;
      const [a, b, c] = [Math.abs(p - left), Math.abs(p - up), Math.abs(p - corner)];
      const paeth = a <= b && a <= c ? left : b <= c ? up : corner;
      const guess = [0, left, up, (left + up) >> 1, paeth][filter];
      pixels[y * stride + i] = raw[y * (stride + 1) + 1 + i] + guess;
    }
  }
  return { width, height, at: (x, y) => [...pixels.subarray(y * stride + x * channels, y * stride + x * channels + 3)] };
}

/** Centre and number of the pixels that suit. */
export function centreOf(picture, suits) {
  let n = 0,
    x = 0,
    y = 0;
  for (let row = 0; row < picture.height; row++)
    for (let column = 0; column < picture.width; column++)
      if (suits(picture.at(column, row))) {
        n++;
        x += column;
        y += row;
      }
  return { n, x: x / n, y: y / n };
}
