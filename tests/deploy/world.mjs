// Ground of the tests of the proxies' sample configurations: certificates, a daemon, a sample with its ports and paths replaced, programs that
// are started and ended, clients that reach it all under the name of the sample.
import { execFileSync, spawn } from 'node:child_process';
import { chmodSync, existsSync, mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { Agent, request } from 'node:https';
import { createServer, connect as connectPlainly } from 'node:net';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { connect } from 'node:tls';
import { parseStrict } from '../api/strict_json.mjs';

/** The name that each sample has for the server. */
export const NAME = 'beamroom.example.org';
/** Where the clients of these tests come from: another address than the proxy's own. */
export const CLIENT = '127.0.0.3';

/** A port of 127.0.0.1 that nobody listens on. */
export const freePort = () =>
  new Promise((done) => {
    const server = createServer();
    server.listen(0, '127.0.0.1', () => {
      const { port } = server.address();
      server.close(() => done(port));
    });
  });

/** A folder that proxies, which do not stay root, can reach. */
export function makeHome(name) {
  const home = mkdtempSync(join(tmpdir(), `beamroom-deploy-${name}-`));
  chmodSync(home, 0o755);
  return home;
}

/** Writes a certificate for the name, its key, and both in one file as HAProxy wants them. */
export function makeCertificate(home, about = 'first') {
  const [cert, key, both] = ['beamroom.pem', 'beamroom.key', 'both.pem'].map((file) => join(home, file));
  execFileSync(
    'openssl',
    [
      ...[
        'req',
        '-x509',
        '-newkey',
        'ec',
        '-pkeyopt',
        'ec_paramgen_curve:P-256',
        '-nodes',
        '-days',
        '30',
        '-subj',
        `/O=${about}/CN=${NAME}`,
      ],
      ...['-addext', `subjectAltName=DNS:${NAME}`, '-keyout', key, '-out', cert],
    ],
    { stdio: 'pipe' },
  );
  writeFileSync(both, readFileSync(cert, 'utf8') + readFileSync(key, 'utf8'));
  for (const file of [cert, key, both]) chmodSync(file, 0o644);
  return { cert, key, both };
}

/** A sample of deploy/ with words replaced. Each of them must stand there: a sample that changes is seen. @param {[string, string | number][]} words */
export function replaced(sample, words) {
  return words.reduce(
    (text, [word, by]) => {
      if (!text.includes(word)) throw new Error(`${sample} has no ${JSON.stringify(word)}`);
      return text.replaceAll(word, String(by));
    },
    readFileSync(resolve('deploy', sample), 'utf8'),
  );
}

const answers = (port) =>
  new Promise((done) => {
    const socket = connectPlainly(port, '127.0.0.1');
    socket.on('connect', () => done(true));
    socket.on('error', () => done(false));
    socket.on('close', () => socket.destroy());
    socket.unref();
  });

/** Starts a program and waits until it listens on the port. log() is all that it said. */
export async function startProgram(command, args, { port, env = {}, cwd } = {}) {
  const child = spawn(command, args, { cwd, env: { ...process.env, ...env }, stdio: ['ignore', 'pipe', 'pipe'] });
  let log = '';
  for (const stream of [child.stdout, child.stderr])
    stream.on('data', (text) => {
      log += text;
    });
  const ended = new Promise((done) => {
    child.on('exit', done);
    child.on('error', (error) => {
      log += error.message;
      done(-1);
    });
  });
  let isOver = false;
  ended.then(() => {
    isOver = true;
  });
  for (const end = Date.now() + 30000; !(await answers(port)); await new Promise((next) => setTimeout(next, 50)))
    if (isOver || Date.now() > end) {
      child.kill('SIGKILL');
      throw new Error(`${command} does not listen on ${port}: ${log}`);
    }
  return {
    child,
    log: () => log,
    async stop() {
      child.kill('SIGTERM');
      const late = setTimeout(() => child.kill('SIGKILL'), 5000);
      await ended;
      clearTimeout(late);
    },
  };
}

/** The largest memory of a process and of all that it started, in MiB, so far. */
export function peakMib(pid) {
  const read = (path) => {
    try {
      return readFileSync(path, 'latin1');
    } catch {
      return '';
    }
  };
  const own = Number(/VmHWM:\s*(\d+)/.exec(read(`/proc/${pid}/status`))?.[1] ?? 0) / 1024;
  const tasks = existsSync(`/proc/${pid}/task`) ? readdirSync(`/proc/${pid}/task`) : [];
  const children = tasks.flatMap((task) => read(`/proc/${pid}/task/${task}/children`).trim().split(' ').filter(Boolean).map(Number));
  return children.reduce((sum, child) => sum + peakMib(child), own);
}

/** Rows of a daemon's audit, oldest first, as another process sees them. */
export const auditOf = (data) =>
  JSON.parse(
    execFileSync('python3', [
      '-c',
      "import json, sqlite3, sys; db = sqlite3.connect('file:%s/beamroom.db?mode=ro' % sys.argv[1], uri=True, timeout=30); print(json.dumps([r[0] for r in db.execute('SELECT row FROM audit ORDER BY n')]))",
      data,
    ]),
  ).map(parseStrict);

/** A TLS connection to the proxy, as a client elsewhere opens it. @param {object} how further options of tls.connect */
export function openSecurely(port, { from = CLIENT, ...how } = {}) {
  return new Promise((done, failed) => {
    const socket = connect({ host: '127.0.0.1', port, localAddress: from, servername: NAME, rejectUnauthorized: false, ...how });
    socket.once('error', failed);
    socket.once('secureConnect', () => {
      socket.off('error', failed);
      socket.on('error', () => {});
      done(socket);
    });
  });
}

/** Calls through the proxy, over connections that are kept, with cookies that are kept. */
export class Caller {
  #agent;
  #port;
  cookies = new Map();
  constructor(port, { from = CLIENT, keepAlive = true } = {}) {
    this.#port = port;
    this.#agent = new Agent({ keepAlive, localAddress: from, rejectUnauthorized: false, servername: NAME });
  }
  get host() {
    return `${NAME}:${this.#port}`;
  }
  get cookie() {
    return [...this.cookies].map(([name, value]) => `${name}=${value}`).join('; ');
  }
  /** @param {{method?: string, body?: unknown, headers?: object, stream?: import('node:stream').Readable}} how @returns {Promise<{status: number, headers: object, text: string, json: any, address: string}>} */
  call(path, { method = 'GET', body, headers = {}, stream } = {}) {
    return new Promise((done, failed) => {
      const sent = request(
        {
          host: '127.0.0.1',
          port: this.#port,
          agent: this.#agent,
          method,
          path,
          headers: {
            Host: this.host,
            ...(this.cookies.size && { Cookie: this.cookie }),
            ...(body !== undefined && { 'Content-Type': 'application/json' }),
            ...headers,
          },
        },
        (answer) => {
          for (const line of answer.headers['set-cookie'] ?? []) {
            const [, name, value] = /^([^=]+)=([^;]*)/.exec(line);
            if (value) this.cookies.set(name, value);
            else this.cookies.delete(name);
          }
          const parts = [];
          answer.on('data', (part) => parts.push(part));
          answer.on('error', failed);
          answer.on('end', () => {
            const text = Buffer.concat(parts).toString('utf8');
            const isJson = /json/.test(answer.headers['content-type'] ?? '');
            done({ status: answer.statusCode, headers: answer.headers, text, json: isJson && text ? parseStrict(text) : undefined });
          });
        },
      );
      sent.on('error', failed);
      if (stream) stream.pipe(sent);
      else sent.end(body === undefined ? undefined : JSON.stringify(body));
    });
  }
  end() {
    this.#agent.destroy();
  }
}

/** An archive of the demo plan, and beside it in the archive a file of many MB that no plan needs; made once. @returns {string} its path */
export function bigArchive(home, demo, megabytes) {
  const file = join(home, 'big.zip');
  execFileSync('python3', [
    '-c',
    `
import os, sys, zipfile
with zipfile.ZipFile(sys.argv[1], 'w', zipfile.ZIP_STORED, allowZip64=True) as z:
    for at, _, names in os.walk(sys.argv[2]):
        for name in names:
            path = os.path.join(at, name)
            z.write(path, 'big/' + os.path.relpath(path, sys.argv[2]))
    with z.open(zipfile.ZipInfo('big/letter.bin'), 'w', force_zip64=True) as letter:
        block = os.urandom(1 << 20)
        for _ in range(int(sys.argv[3])):
            letter.write(block)
`,
    file,
    demo,
    String(megabytes),
  ]);
  return file;
}

/** Removes what a test made. */
export const dropHome = (home) => home && rmSync(home, { recursive: true, force: true });
/** Makes a folder inside a home. */
export function folderIn(home, name) {
  const path = join(home, name);
  mkdirSync(path, { recursive: true });
  chmodSync(path, 0o755);
  return path;
}
