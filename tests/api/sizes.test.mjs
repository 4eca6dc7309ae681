// Followers with small windows are sent the presenter's picture reduced: the same render, the same bytes for all of a class.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { call, openPlan, startDaemon } from './daemon.mjs';
import { Client } from './ws_client.mjs';

const [width, height] = [801, 601]; // no multiples of 2 or 4

/** Width and height in the frame header of a JPEG (ITU T.81, B.2.2). */
function jpegSize(bytes) {
  let at = 2;
  while (bytes[at + 1] !== 0xc0) at += 2 + bytes.readUInt16BE(at + 2);
  return [bytes.readUInt16BE(at + 7), bytes.readUInt16BE(at + 5)];
}

/** Where a patient point lies in the picture of a frame, in pixels of it. */
function place({ matrix: m, width: across, height: down }, [x, y, z]) {
  const row = (r) => m[r] * x + m[4 + r] * y + m[8 + r] * z + m[12 + r];
  return [((row(0) / row(3) + 1) / 2) * across, ((1 - row(1) / row(3)) / 2) * down];
}

test('who follows in a small window is sent the same render in fewer pixels', { timeout: 120000 }, async (t) => {
  const daemon = await startDaemon({ args: ['--gl', 'soft'] });
  t.after(() => daemon.stop());
  await openPlan(daemon.url, 'phantom');
  const room = (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id;
  const enter = async (size_px) => {
    const client = await Client.enter(daemon.url, room);
    t.after(() => client.cut());
    await client.message('members');
    client.send({ type: 'view.open', view: 1, follow: true, document: { kind: '3d', size_px } });
    await client.frame((frame) => frame.isStill);
    return client;
  };
  const turn = (client, x, input) =>
    client.send({
      type: 'view.patch',
      view: 1,
      input,
      patch: { camera: { position_mm: [x, -800, 100], target_mm: [0, 0, 0], up: [0, 0, 1] } },
    });

  const ann = await enter([width, height]);
  turn(ann, 300, 1);
  const alone = await ann.frame(({ isStill, input }) => isStill && input === 1);
  assert.deepEqual(jpegSize(alone.picture), [width, height]);

  // panes of another shape than the picture: what counts is as how many pixels it is shown, letterboxed
  const others = [];
  for (const size of [
    [800, 600],
    [400, 900],
    [1200, 300],
    [200, 900],
    [640, 150],
  ])
    others.push(await enter(size));
  const from = others.map(({ frames }) => frames.length);
  turn(ann, -200, 2);
  await ann.frame(({ isStill, input }) => isStill && input === 2);
  turn(ann, 300, 3); // the camera that she was alone with
  const whole = await ann.frame(({ isStill, input }) => isStill && input === 3);
  assert.ok(whole.picture.equals(alone.picture), 'the whole picture is the same byte for byte, whoever follows');
  assert.equal(whole.divisor, 1);
  const seen = await Promise.all(
    others.map((client, i) => client.frame((frame) => frame.isStill && frame.renderUs === whole.renderUs, from[i])),
  );
  assert.deepEqual(
    seen.map(({ divisor }) => divisor),
    [1, 2, 2, 4, 4],
  );
  for (const frame of seen) {
    assert.deepEqual([frame.width, frame.height], [Math.ceil(width / frame.divisor), Math.ceil(height / frame.divisor)]);
    assert.deepEqual(jpegSize(frame.picture), [frame.width, frame.height]);
    assert.ok(frame.isShared && frame.isFullColor && frame.scale === 100);
    for (const point of [
      [0, 0, 0],
      [60, -40, 80],
      [-70, 90, -60],
    ]) {
      const [x, y] = place(frame, point),
        [wholeX, wholeY] = place(whole, point);
      assert.ok(
        Math.hypot(x * frame.divisor - wholeX, y * frame.divisor - wholeY) < 1e-3,
        `${point} at ${[x, y]}, in the whole at ${[wholeX, wholeY]}`,
      );
    }
  }
  assert.ok(seen[0].picture.equals(whole.picture));
  assert.ok(seen[1].picture.equals(seen[2].picture), 'of one class, the same bytes');
  assert.ok(seen[3].picture.equals(seen[4].picture));
  assert.ok(seen[4].payloadBytes < seen[2].payloadBytes && seen[2].payloadBytes < whole.payloadBytes);

  // a window that grows: what is there, in more pixels, and nothing is drawn
  const n = others[4].frames.length;
  others[4].send({ type: 'view.patch', view: 1, patch: { size_px: [401, 301] } });
  const larger = await others[4].frame(() => true, n);
  assert.ok(larger.picture.equals(whole.picture), 'shown as 401 x 301, whose double is more than the whole has');
  assert.equal(larger.renderUs, whole.renderUs);
});
