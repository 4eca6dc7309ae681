// A state folder whose disk a test fills and frees: a small file system in memory where the test may mount one, else a limit on the
// size of the daemon's files, which SQLite reports as another failure of the disk.
import { spawnSync } from 'node:child_process';
import { closeSync, mkdtempSync, openSync, rmSync, writeSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

const run = (...command) => spawnSync(command[0], command.slice(1), { encoding: 'utf8' });

export class FullDisk {
  constructor() {
    this.data = mkdtempSync(join(tmpdir(), 'beamroom-full-'));
    this.isMounted = run('mount', '-t', 'tmpfs', '-o', 'size=16m,mode=755', 'beamroom-test', this.data).status === 0;
    /** Why its disk cannot be filled; '': it can. A daemon started by root runs as another user, whose limits root may not set everywhere. */
    this.missing = !this.isMounted && process.getuid() === 0 ? 'root may mount nothing here' : '';
    /** The code of the problem that members are told. */
    this.code = this.isMounted ? 'full' : 'write';
  }

  /** @param {import('node:child_process').ChildProcess} daemon that uses it */
  fill(daemon) {
    if (!this.isMounted) return this.#limit(daemon, 1);
    const file = openSync(join(this.data, 'ballast'), 'w');
    try {
      for (let size = 1 << 20; size; ) {
        try {
          writeSync(file, Buffer.alloc(size));
        } catch (error) {
          if (error.code !== 'ENOSPC') throw error;
          size >>= 1;
        }
      }
    } finally {
      closeSync(file);
    }
  }

  free(daemon) {
    if (this.isMounted) rmSync(join(this.data, 'ballast'));
    else this.#limit(daemon, 'unlimited');
  }

  #limit(daemon, bytes) {
    const { status, stderr } = run('prlimit', '--pid', String(daemon.pid), `--fsize=${bytes}:`);
    if (status !== 0) throw new Error(`prlimit: ${stderr}`);
  }

  /** After its daemon has ended. */
  remove() {
    if (this.isMounted) run('umount', this.data);
    rmSync(this.data, { recursive: true, force: true });
  }
}
