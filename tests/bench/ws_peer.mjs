// Sends the same bytes to many, by the npm package ws (as playwright-core brings it): the other side of bench_crowd.
// Prints its port. Each line on its input, "BYTES RATE", begins to send a message of so many bytes at that rate to everybody who has
// shown all but one of those sent; "0 0" ends it.
import { createInterface } from 'node:readline';
import { createRequire } from 'node:module';
const { wsServer: WebSocketServer } = createRequire(import.meta.url)('../../node_modules/playwright-core/lib/utilsBundle.js');

const server = new WebSocketServer({ port: 0, host: '127.0.0.1', perMessageDeflate: false });
const clients = new Set();
let timer,
  sequence = 0;
server.on('connection', (socket) => {
  const client = { socket, unshown: 0 };
  clients.add(client);
  socket.on('message', (text) => {
    client.unshown -= JSON.parse(text).sequence > 0;
  });
  socket.on('close', () => clients.delete(client));
});
server.on('listening', () => console.log(server.address().port));
createInterface({ input: process.stdin })
  .on('line', (line) => {
    const [bytes, rate] = line.split(' ').map(Number);
    clearInterval(timer);
    if (bytes) {
      timer = setInterval(() => {
        const picture = Buffer.alloc(bytes, 0xa5);
        picture.writeUInt32LE(1, 12);
        picture.writeUInt32LE(++sequence, 16);
        for (const client of clients) {
          if (client.unshown >= 2) continue;
          client.unshown++;
          client.socket.send(picture);
        }
      }, 1000 / rate);
    }
    console.log('ok');
  })
  .on('close', () => process.exit(0));
