// A sender whose body comes too slowly. In a file of its own: it takes a minute, beside the others.
import assert from 'node:assert/strict';
import { connect } from 'node:net';
import { after, before, test } from 'node:test';
import { startDaemon } from './daemon.mjs';

let daemon;
before(async () => {
  daemon = await startDaemon({ args: ['--stub'] });
});
after(() => daemon?.stop());

test('a body of one byte a second is refused with 408 after a minute', { timeout: 180000 }, async () => {
  const { hostname, port } = new URL(daemon.url),
    socket = connect({ host: hostname, port: Number(port) });
  let text = '';
  socket.setEncoding('latin1');
  socket.write('POST /api/v1/rooms HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: 1000000\r\n\r\n');
  const timer = setInterval(() => socket.write(' '), 1000);
  const answered = await new Promise((done) => {
    const late = setTimeout(done, 120000, false);
    socket.on('data', (more) => {
      text += more;
      if (text.includes('\r\n\r\n')) {
        clearTimeout(late);
        done(true);
      }
    });
    socket.on('error', () => {
      clearTimeout(late);
      done(false);
    });
  });
  clearInterval(timer);
  socket.destroy();
  assert.ok(answered, 'it is still open after two minutes, or was closed without an answer');
  assert.match(text, /^HTTP\/1\.1 408 [\s\S]*application\/problem\+json/);
});
