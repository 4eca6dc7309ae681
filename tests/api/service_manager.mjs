// A socket like a service manager's, which a daemon tells that it is ready, that it lives and that it stops.
import { spawn } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { createInterface } from 'node:readline';
import { until } from './daemon.mjs';

/** @returns {Promise<{path: string, lines: () => string[], stop: () => void}>} lines: the datagrams that it received */
export async function startManager() {
  const folder = mkdtempSync(join(tmpdir(), 'beamroom-notify-')),
    path = join(folder, 'notify');
  const child = spawn('python3', [
    '-uc',
    'import socket,sys\ns=socket.socket(socket.AF_UNIX,socket.SOCK_DGRAM)\ns.bind(sys.argv[1])\nprint("bound")\nwhile True: print(s.recv(4096).decode())',
    path,
  ]);
  const lines = [];
  createInterface({ input: child.stdout }).on('line', (line) => lines.push(line));
  await until(() => lines.length, Boolean);
  return {
    path,
    lines: () => lines.slice(1),
    stop: () => {
      child.kill();
      rmSync(folder, { recursive: true, force: true });
    },
  };
}
