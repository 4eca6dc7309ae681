// Connections that send bytes of one's own, for tests of the daemon's front.
import assert from 'node:assert/strict';
import { connect } from 'node:net';
import { call, startDaemon, until } from './daemon.mjs';

export const HOST = 'Host: localhost\r\n',
  FIRST = `GET /healthz HTTP/1.1\r\n${HOST}\r\n`;
export const statuses = (text) => [...text.matchAll(/HTTP\/1\.1 (\d{3}) [A-Z]/g)].map((found) => Number(found[1]));

/** Opens a connection that sends bytes; ended resolves with how it ended: 'end' by the server, an error code, or 'open' after ms. */
export function open(url, bytes, { from = '127.0.0.1', ms = 15000 } = {}) {
  const { hostname, port } = new URL(url);
  const socket = connect({ host: hostname, port: Number(port), localAddress: from });
  const connection = { socket, text: '' };
  socket.setEncoding('latin1');
  connection.answered = new Promise((done) => {
    socket.on('data', (text) => {
      connection.text += text;
      if (statuses(connection.text).length) done();
    });
    socket.on('close', done);
  });
  connection.ended = new Promise((done) => {
    const timer = setTimeout(() => {
      socket.destroy();
      done('open');
    }, ms);
    socket.on('error', (error) => {
      clearTimeout(timer);
      done(error.code);
    });
    socket.on('close', () => {
      clearTimeout(timer);
      done('end');
    });
  });
  socket.write(bytes);
  return connection;
}

/** Opens n connections by make and keeps them open, a few at a time, fewer than may wait for their request heads; the status of each. */
export async function openEach(n, make) {
  const all = [];
  while (all.length < n) {
    const some = Array.from({ length: Math.min(20, n - all.length) }, (_, i) => make(all.length + i));
    all.push(...some);
    await Promise.all(some.map((c) => c.answered));
  }
  const list = all.map((c) => statuses(c.text)[0]);
  return {
    list,
    n: (status) => list.filter((one) => one === status).length,
    drop: () => {
      for (const c of all) c.socket.destroy();
    },
  };
}

/** Starts a daemon and waits until it has found its plan. */
export async function startWithPlan(args = []) {
  const daemon = await startDaemon({ args: ['--stub', ...args] });
  await until(
    () => call(`${daemon.url}/api/v1/plans/phantom`),
    (answer) => answer.status === 200,
  );
  return daemon;
}

/** Everything received until the server closes the connection; fails when it does not. */
export async function exchange(url, bytes, options) {
  const connection = open(url, bytes, options);
  assert.equal(await connection.ended, 'end', `how ${JSON.stringify(bytes.slice(0, 80))} ended, after ${connection.text.slice(0, 200)}`);
  return connection.text;
}
