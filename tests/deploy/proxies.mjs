// Each proxy with its sample configuration of deploy/, as Debian's own configuration loads it, with ports, certificates and folders replaced.
// A start takes {home, socket: the daemon's, daemon: port, signIn: port of who knows the people} and gives {port, child, log, reload, stop}.
import { execFileSync } from 'node:child_process';
import { chmodSync, cpSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { userInfo } from 'node:os';
import { join } from 'node:path';
import { folderIn, freePort, makeCertificate, NAME, replaced, startProgram } from './world.mjs';

const CERTIFICATES = (cert, key) => [
  ['/etc/ssl/certs/beamroom.pem', cert],
  ['/etc/ssl/private/beamroom.key', key],
];

/** The certificate is renewed and the proxy told. */
const reloader = (home, program, tell) => () => {
  makeCertificate(home, 'renewed');
  tell(program.child);
};

/** The user of these tests. */
export const me = userInfo().username;
/** Apache and nginx stay root in one process alone, the others are this user's. */
const worker = me === 'root' ? 'www-data' : me;

/** Debian's /etc/nginx, with places of its own. */
async function startNginx({ home, socket, signIn }) {
  const port = await freePort();
  const { cert, key } = makeCertificate(home);
  const [etc, run] = [join(home, 'nginx'), folderIn(home, 'run')];
  cpSync('/etc/nginx', etc, { recursive: true, verbatimSymlinks: true });
  rmSync(join(etc, 'sites-enabled'), { recursive: true, force: true });
  const words = [
    ['/run/beamroom/http.sock', socket],
    ['listen 443 ssl;', `listen 127.0.0.1:${port} ssl;`],
    ['listen [::]:443 ssl;', ''],
    ['listen 80;', `listen 127.0.0.1:${await freePort()};`],
    ['listen [::]:80;', ''],
    ...CERTIFICATES(cert, key),
  ];
  if (signIn) {
    writeFileSync(join(etc, 'beamroom-signin.conf'), replaced('nginx-signin.conf', [['127.0.0.1:4180', `127.0.0.1:${signIn}`]]));
    words.push(['# include /etc/nginx/beamroom-signin.conf;', `include ${etc}/beamroom-signin.conf;`]);
  }
  writeFileSync(join(etc, 'conf.d/beamroom.conf'), replaced('nginx.conf', words));
  const main = readFileSync(join(etc, 'nginx.conf'), 'utf8');
  const moved = main.replaceAll('/etc/nginx/', `${etc}/`).replaceAll('/var/log/nginx/', `${run}/`).replace('/run/nginx.pid', `${run}/pid`);
  writeFileSync(join(etc, 'nginx.conf'), moved);
  const program = await startProgram('nginx', ['-e', `${run}/error.log`, '-c', join(etc, 'nginx.conf'), '-g', 'daemon off;'], { port });
  const log = () => program.log() + readFileSync(`${run}/error.log`, 'utf8');
  return { ...program, log, port, reload: reloader(home, program, (child) => child.kill('SIGHUP')) };
}

/** A file for Caddy, behind the options that give it other ports and a folder of its own. */
const startCaddy =
  (sample) =>
  async ({ home, socket, signIn }) => {
    const [port, plain, admin] = [await freePort(), await freePort(), await freePort()];
    const { cert, key } = makeCertificate(home);
    const file = join(home, 'Caddyfile');
    const words = [
      ['/run/beamroom/http.sock', socket],
      ['/etc/caddy/beamroom.pem', cert],
      ['/etc/caddy/beamroom.key', key],
    ];
    if (signIn) words.push(['127.0.0.1:4180', `127.0.0.1:${signIn}`]);
    const options = `{\n\tadmin 127.0.0.1:${admin}\n\thttp_port ${plain}\n\thttps_port ${port}\n\tdefault_bind 127.0.0.1\n}\n`;
    writeFileSync(file, options + replaced(sample, words));
    const env = { XDG_DATA_HOME: home, XDG_CONFIG_HOME: home, HOME: home };
    const program = await startProgram('caddy', ['run', '--config', file, '--adapter', 'caddyfile'], { port, env });
    // as the unit of Debian's package reloads
    const tell = () =>
      execFileSync('caddy', ['reload', '--config', file, '--adapter', 'caddyfile', '--address', `127.0.0.1:${admin}`, '--force'], {
        env: { ...process.env, ...env },
        stdio: 'pipe',
      });
    return { ...program, port, reload: reloader(home, program, tell) };
  };

const startHaproxy =
  (further = []) =>
  async ({ home, daemon }) => {
    const port = await freePort();
    const { both } = makeCertificate(home);
    const file = join(home, 'haproxy.cfg');
    const words = [
      ['server daemon 127.0.0.1:8080', [...further, `server daemon 127.0.0.1:${daemon}`].join('\n    ')],
      ['bind :80', `bind 127.0.0.1:${await freePort()}`],
      ['bind :443', `bind 127.0.0.1:${port}`],
      ['/etc/haproxy/beamroom.pem', both],
    ];
    writeFileSync(file, replaced('haproxy.cfg', words));
    const program = await startProgram('haproxy', ['-W', '-f', file], { port });
    return { ...program, port, reload: reloader(home, program, (child) => child.kill('SIGUSR2')) };
  };

const CACHE = '/var/cache/apache2/mod_auth_openidc/cache';

/** Debian's /etc/apache2, with the modules that the sample's first lines name, and the folder of sessions as docs/admin.md makes it. */
async function startApache({ home, socket, signIn, port }) {
  const { cert, key } = makeCertificate(home);
  const [etc, run] = [join(home, 'apache2'), folderIn(home, 'apache-run')];
  cpSync('/etc/apache2', etc, { recursive: true, verbatimSymlinks: true });
  rmSync(join(etc, 'sites-enabled'), { recursive: true, force: true });
  chmodSync(run, 0o777);
  const cache = join(home, 'sessions');
  const [makesCache] = /^install -d .* \/var\/cache\/.*$/m.exec(readFileSync('docs/admin.md', 'utf8'));
  const [command, ...words] = makesCache.replaceAll('www-data', worker).replace(CACHE, cache).split(' ');
  execFileSync(command, words, { stdio: 'pipe' });
  const sample = replaced('apache-oidc.conf', [
    [`#   ${makesCache}\n`, ''],
    ['/run/beamroom/http.sock', socket],
    ['<VirtualHost *:443>', `<VirtualHost 127.0.0.1:${port}>`],
    ['<VirtualHost *:80>', '<VirtualHost 127.0.0.1:1>'],
    ['https://login.example.org/', `http://127.0.0.1:${signIn}/`],
    [`https://${NAME}/oidc/back`, `https://${NAME}:${port}/oidc/back`],
    ['replace-by-the-secret-of-this-client', 'secret-of-the-test'],
    [CACHE, cache],
    ...CERTIFICATES(cert, key),
  ]);
  const [, modules] = /^# +a2enmod (.*)$/m.exec(sample);
  const variables = { APACHE_CONFDIR: etc, APACHE_RUN_DIR: run, APACHE_LOCK_DIR: run, APACHE_LOG_DIR: run, APACHE_PID_FILE: `${run}/pid` };
  const env = { ...process.env, ...variables, APACHE_RUN_USER: 'www-data', APACHE_RUN_GROUP: 'www-data' };
  execFileSync('a2enmod', ['-q', ...modules.trim().split(/ +/)], { env, stdio: 'pipe' });
  folderIn(etc, 'sites-enabled');
  writeFileSync(join(etc, 'sites-enabled/beamroom.conf'), sample);
  writeFileSync(join(etc, 'ports.conf'), `Listen 127.0.0.1:${port}\n`);
  const program = await startProgram('apache2', ['-d', etc, '-f', join(etc, 'apache2.conf'), '-D', 'FOREGROUND'], { port, env });
  const log = () => program.log() + readFileSync(`${run}/error.log`, 'utf8');
  return { ...program, log, port, reload: reloader(home, program, (child) => child.kill('SIGUSR1')) };
}

/** The proxies, and what is known to differ. needs: its program. user: who connects to
 *  the daemon's socket; without one, its port is used. signsIn: 'proxy' (oauth2-proxy's ways) or 'oidc' (of its own). cutsByReload: it
 *  closes WebSockets then, and the page comes back. */
export const proxies = {
  nginx: { needs: '/usr/sbin/nginx', start: startNginx, user: worker },
  'nginx with auth_request': { needs: '/usr/sbin/nginx', start: startNginx, user: worker, signsIn: 'proxy' },
  Caddy: { needs: '/usr/bin/caddy', start: startCaddy('Caddyfile'), user: me, speaksH2: true, cutsByReload: true },
  'Caddy with forward_auth': {
    needs: '/usr/bin/caddy',
    start: startCaddy('Caddyfile.forward-auth'),
    user: me,
    signsIn: 'proxy',
    speaksH2: true,
    cutsByReload: true,
  },
  HAProxy: { needs: '/usr/sbin/haproxy', start: startHaproxy(), speaksH2: true },
  'HAProxy with http-reuse always': { needs: '/usr/sbin/haproxy', start: startHaproxy(['http-reuse always']), speaksH2: true },
  'Apache with mod_auth_openidc': {
    needs: '/usr/lib/apache2/modules/mod_auth_openidc.so',
    start: startApache,
    user: worker,
    signsIn: 'oidc',
  },
};
