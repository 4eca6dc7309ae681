// A TCP proxy that can stop to forward without closing anything: packets of both directions get lost, as in a tunnel.
import { connect, createServer } from 'node:net';

/** @param {string} url of the daemon @returns {Promise<{url: string, black: (on: boolean) => void, stop: () => Promise<void>}>} */
export async function startProxy(url) {
  const { hostname, port } = new URL(url);
  const sockets = new Set();
  let isBlack = false;
  const forward = (from, to) => {
    from.on('data', (bytes) => {
      if (!from.isLost && !isBlack) to.write(bytes);
      else from.isLost = to.isLost = true; // bytes are missing: nothing that follows would make sense
    });
    from.on('error', () => {});
    from.on('close', () => {
      if (!from.isLost) to.destroy();
    });
  };
  const server = createServer((client) => {
    const daemon = connect(Number(port), hostname);
    for (const socket of [client, daemon]) {
      sockets.add(socket);
      socket.on('close', () => sockets.delete(socket));
      socket.isLost = isBlack;
    }
    forward(client, daemon);
    forward(daemon, client);
  });
  await new Promise((resolve) => {
    server.listen(0, '127.0.0.1', resolve);
  });
  return {
    url: `http://127.0.0.1:${server.address().port}`,
    black: (on) => {
      isBlack = on;
    },
    stop: () =>
      new Promise((resolve) => {
        for (const socket of sockets) socket.destroy();
        server.close(resolve);
      }),
  };
}
