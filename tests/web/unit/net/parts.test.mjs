// The parts of a display's stream as the page reads them.
import { describe, it } from 'node:test';
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { web } from '../../../api/daemon.mjs';

const { Parts, pictureHeader } = await import(join(web, 'js/net/parts.js'));
const bytes = (text) => Uint8Array.from(text, (letter) => letter.charCodeAt(0));
const stream =
  '--beamroom\r\nContent-Type: image/jpeg\r\nContent-Length: 7\r\nBeamroom-Picture: 1\r\n\r\na\r\n\r\n-b\r\n--beamroom\r\ncontent-length: 3\r\n\r\nxyz\r\n--beamroom\r\n';
const texts = (parts) => parts.map(({ fields, body }) => [fields['content-length'], String.fromCharCode(...body)]);

describe('the parts of a stream', () => {
  it('are the same however the bytes come', () => {
    for (const step of [1, 2, 3, 7, 50, stream.length]) {
      const parts = new Parts(),
        got = [];
      for (let at = 0; at < stream.length; at += step) got.push(...parts.push(bytes(stream.slice(at, at + step))));
      assert.deepEqual(
        texts(got),
        [
          ['7', 'a\r\n\r\n-b'],
          ['3', 'xyz'],
        ],
        `${step} at a time`,
      );
      assert.equal(got[0].fields['beamroom-picture'], '1');
    }
  });

  it('are refused when they are not what they say', () => {
    for (const [text, words] of [
      ['HTTP/1.1', /boundary/],
      ['--beamroom\r\nContent-Type: x\r\n\r\n', /part of undefined bytes/],
      ['--beamroom\r\nContent-Length: 99999999\r\n\r\n', /99999999 bytes/],
      ['--beamroom\r\nContent-Length: -1\r\n\r\n', /-1 bytes/],
      ['--beamroom\r\nContent-Length: 1\r\n\r\nabcd', /longer than it says/],
      [`--beamroom\r\nX: ${'y'.repeat(9000)}`, /more than 8192 bytes/],
    ])
      assert.throws(() => new Parts().push(bytes(text)), words);
  });

  it('say size and camera of their pictures', () => {
    const matrix = Array.from({ length: 16 }, (_, index) => index / 4 - 1);
    const header = pictureHeader({ 'beamroom-picture': '12', 'beamroom-size': '320x240', 'beamroom-clip-from-lps': matrix.join(' ') });
    assert.deepEqual([header.sequence, header.width_px, header.height_px, [...header.clip_from_lps_mm]], [12, 320, 240, matrix]);
    assert.throws(() => pictureHeader({ 'beamroom-size': '320x240', 'beamroom-clip-from-lps': '1 2 3' }), /camera/);
    assert.throws(() => pictureHeader({ 'beamroom-clip-from-lps': matrix.join(' ') }), /size/);
  });
});
