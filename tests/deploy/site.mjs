// A daemon with a plan and a room, a proxy in front of it, and who knows the people: what each test of a proxy begins with.
import { execFileSync } from 'node:child_process';
import { chmodSync } from 'node:fs';
import { connect } from 'node:net';
import { join } from 'node:path';
import { startDaemon, until } from '../api/daemon.mjs';
import { startBrowser } from '../web/browser.mjs';
import { people, startProvider, startSignIn } from './people.mjs';
import { me, proxies } from './proxies.mjs';
import { Caller, dropHome, folderIn, freePort, makeHome, NAME } from './world.mjs';

export const PASSWORD = 'correct horse battery';

export class Site {
  async start(name) {
    const { start, signsIn, user } = proxies[name];
    Object.assign(this, { signsIn, user });
    this.home = makeHome(name.replace(/\W+/g, '-'));
    const port = await freePort();
    if (signsIn === 'proxy') this.people = await startSignIn();
    if (signsIn === 'oidc') this.people = await startProvider(`https://${NAME}:${port}/oidc/back`);
    const run = folderIn(this.home, 'beamroom');
    chmodSync(run, 0o777); // the daemon does not stay root, so it cannot give the socket to a group either
    this.socket = join(run, 'http.sock');
    const listens = user ? ['--listen', `unix:${this.socket},mode=0666`, '--proxy-user', user] : [];
    const doors = signsIn ? ['proxy', '--grant', '* @clinicians planner'] : ['local', '--trusted-proxy', '127.0.0.1'];
    this.daemon = await startDaemon({ args: ['--public-name', NAME, '--sign-in', ...doors, ...listens] });
    const daemon = Number(new URL(this.daemon.url).port);
    this.proxy = await start({ home: this.home, socket: this.socket, daemon, signIn: this.people?.port, port });
    this.port = this.proxy.port;
    this.host = `${NAME}:${this.port}`;
    this.caller = new Caller(this.port);
    await this.signIn();
    const { plans } = await until(
      async () => (await this.caller.call('/api/v1/plans')).json,
      (answer) => answer.plans.length > 0,
    );
    this.plan = plans[0].id;
    const opened = await this.caller.call(`/api/v1/plans/${this.plan}/open`, { method: 'POST' });
    await this.jobEnds(opened.json);
    this.room = await this.newRoom();
  }
  /** Waits for a job's end. */
  jobEnds({ id }) {
    return until(
      async () => (await this.caller.call(`/api/v1/jobs/${id}`)).json,
      ({ state }) => state !== 'running' && state !== 'queued',
    );
  }
  async newRoom() {
    return (await this.caller.call('/api/v1/rooms', { method: 'POST', body: { plan: this.plan } })).json.id;
  }
  /** A browser that finds the name here, and nobody in it. */
  async newContext() {
    if (!this.browser) {
      const { chromium } = await import('playwright-core');
      this.server = await startBrowser([`--host-resolver-rules=MAP ${NAME} 127.0.0.1`, '--no-proxy-server']);
      this.browser = await chromium.connect(this.server.wsEndpoint());
    }
    const context = await this.browser.newContext({ ignoreHTTPSErrors: true, viewport: { width: 1200, height: 800 } });
    context.setDefaultTimeout(60000);
    return context;
  }
  /** A page at an address, with what went wrong on it. context: else that of whom the caller is signed in as. */
  async visit(path, { context } = {}) {
    if (!context) context = this.context ??= await this.newContext();
    const page = await context.newPage();
    const errors = [];
    page.on('pageerror', (error) => errors.push(error.message));
    page.on('response', (answer) => answer.status() >= 400 && errors.push(`${answer.status()} ${answer.url()}`));
    await page.goto(`https://${this.host}${path}`);
    return { page, errors };
  }
  /** Ann signs in on the page of who knows her, where that wants something of her; it leads back. */
  async passProvider(page) {
    if (!this.signsIn) {
      await page.fill('input[name=user]', 'ann');
      await page.fill('input[name=password]', PASSWORD);
      await page.click('.sign-in-form button');
    }
    if (this.signsIn !== 'oidc') return;
    await page.fill('input[name=login]', 'ann');
    await page.fill('input[name=password]', 'any');
    await page.click('button[type=submit]');
    await page.click('button[type=submit]'); // she agrees that the proxy learns who she is
  }
  /** The caller is ann from here on, and so is the page of visit(). */
  async signIn() {
    if (!this.signsIn) {
      const [, token] = new RegExp(`https://${NAME}/signin/first#(\\S+)`).exec(this.daemon.log());
      const first = { token, user: 'ann', name: people.ann.name, password: PASSWORD };
      const made = await this.caller.call('/api/v1/session/first', {
        method: 'POST',
        body: first,
        headers: { Origin: `https://${this.host}` },
      });
      if (made.status !== 204) throw new Error(`no first user: ${made.text}`);
    }
    const { page } = await this.visit(this.signsIn ? '/signin/proxy?return=/healthz' : '/signin?return=/healthz');
    await this.passProvider(page);
    await page.waitForURL(`https://${this.host}/healthz`);
    for (const { name, value } of await this.context.cookies(`https://${this.host}/`)) this.caller.cookies.set(name, value);
    await page.close();
  }
  /** Bytes to the daemon itself, past the proxy, as from the proxy. */
  async sendPast(bytes) {
    if (this.user && this.user !== me) {
      const send =
        'import socket, sys, time; s = socket.socket(socket.AF_UNIX); s.connect(sys.argv[1]); s.sendall(sys.stdin.buffer.read()); s.settimeout(10); s.recv(65536)';
      execFileSync('setpriv', ['--reuid', this.user, '--clear-groups', '/usr/bin/python3', '-c', send, this.socket], { input: bytes });
      return;
    }
    const { hostname, port } = new URL(this.daemon.url);
    const socket = this.user ? connect(this.socket) : connect(Number(port), hostname);
    socket.write(bytes);
    await new Promise((done) => {
      socket.once('data', done);
      socket.once('close', done);
    });
    socket.destroy();
  }
  async stop() {
    this.caller?.end();
    await this.browser?.close();
    await this.server?.close();
    await this.proxy?.stop();
    await this.daemon?.stop();
    await this.people?.stop();
    dropHome(this.home);
  }
}
