// Stops one thread of a daemon, as a debugger does it: to a test it hangs.
import { spawn } from 'node:child_process';
import { readdirSync, readFileSync } from 'node:fs';
import { until } from './daemon.mjs';

const program = `
import ctypes, os, select, sys
libc = ctypes.CDLL(None)
libc.ptrace.argtypes = [ctypes.c_ulong, ctypes.c_ulong, ctypes.c_void_p, ctypes.c_void_p]
tid, wall = int(sys.argv[1]), 0x40000000
if libc.ptrace(0x4206, tid, None, None) or libc.ptrace(0x4207, tid, None, None): sys.exit(77) # PTRACE_SEIZE, PTRACE_INTERRUPT
os.waitpid(tid, wall)
print('held', flush=True)
while not select.select([sys.stdin], [], [], 0.05)[0]:
    if os.waitpid(tid, wall | os.WNOHANG)[0]: sys.exit(0) # its process has ended, which the debugger must be told
libc.ptrace(17, tid, None, None) # PTRACE_DETACH
`;

/** The id of the thread with this name. */
export async function threadNamed(pid, name) {
  const found = () => readdirSync(`/proc/${pid}/task`).find((tid) => readFileSync(`/proc/${pid}/task/${tid}/comm`, 'utf8') === `${name}\n`);
  return until(found, Boolean, 5000);
}

/** Stops a thread until release; null where a process may not stop another's threads. It also goes on when the test ends. */
export async function holdThread(tid) {
  const holder = spawn('python3', ['-c', program, tid], { stdio: ['pipe', 'pipe', 'inherit'] });
  const isHeld = await new Promise((done) => {
    holder.stdout.once('data', () => done(true));
    holder.once('exit', () => done(false));
  });
  return isHeld ? { release: () => holder.stdin.end() } : null;
}
