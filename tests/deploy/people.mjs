// Services that know the people, for tests: an identity provider (OpenID Connect, the npm package oidc-provider), and a stand-in for oauth2-proxy with the few
// addresses of it that the samples use. Names are made up; there are no passwords.
import { randomBytes } from 'node:crypto';
import { createServer } from 'node:http';
import { resolve } from 'node:path';
import { pathToFileURL } from 'node:url';

/** @type {Record<string, {name: string, groups: string[]}>} */
export const people = {
  ann: { name: 'Änn Łukasz Example', groups: ['clinicians', 'beamroom-admins'] },
  eve: { name: 'Eve Example', groups: ['physicists'] },
};

const listen = (server, port) =>
  new Promise((done) => {
    server.listen(port, '127.0.0.1', () => done(server.address().port));
  });

/** Addresses of oauth2-proxy: /oauth2/auth answers 202 with who it is or 401; /oauth2/start?rd=PATH signs ann in, at once, and goes on to PATH;
 *  /oauth2/sign_out ends it. end() ends all sessions, as their time would. */
export async function startSignIn() {
  const sessions = new Map();
  const asked = [];
  const server = createServer((request, answer) => {
    const url = new URL(request.url, 'http://localhost');
    const session = /(?:^|; )_oauth2_proxy=([0-9a-f]+)/.exec(request.headers.cookie ?? '')?.[1];
    const user = sessions.get(session);
    if (url.pathname === '/oauth2/auth') {
      asked.push(request.headers);
      answer.statusCode = user ? 202 : 401;
      if (user) {
        answer.setHeader('X-Auth-Request-User', user);
        answer.setHeader('X-Auth-Request-Preferred-Username', user);
        answer.setHeader('X-Auth-Request-Groups', people[user].groups.join(','));
      }
    } else if (url.pathname === '/oauth2/start') {
      const id = randomBytes(16).toString('hex');
      sessions.set(id, 'ann');
      answer.writeHead(302, {
        'Set-Cookie': `_oauth2_proxy=${id}; Path=/; Secure; HttpOnly; SameSite=Lax`,
        Location: url.searchParams.get('rd') ?? '/',
      });
    } else if (url.pathname === '/oauth2/sign_out') {
      sessions.delete(session);
      answer.writeHead(302, {
        'Set-Cookie': '_oauth2_proxy=; Path=/; Max-Age=0; Secure; HttpOnly',
        Location: url.searchParams.get('rd') ?? '/',
      });
    } else answer.statusCode = 404;
    answer.end();
  });
  const port = await listen(server, 0);
  return {
    port,
    asked,
    end: () => sessions.clear(),
    stop: () =>
      new Promise((done) => {
        server.close(done);
        server.closeAllConnections();
      }),
  };
}

/** An identity provider whose sign-in page takes any name of `people`. wait(S): its sessions are S seconds older.
 *  @param {string} back the address that the proxy wants people sent back to */
export async function startProvider(back) {
  // make test-proxies installs it there
  const load = (file) => import(pathToFileURL(resolve('build/deploy/node_modules/oidc-provider/lib', file)));
  const [{ Provider }, { default: Memory }] = await Promise.all([load('index.js'), load('adapters/memory_adapter.js')]);
  const sessions = new Map();
  class Kept extends Memory {
    async upsert(id, payload, expires) {
      if (this.model === 'Session') sessions.set(id, payload);
      await super.upsert(id, payload, expires);
    }
  }
  const server = createServer();
  const port = await listen(server, 0);
  const provider = new Provider(`http://127.0.0.1:${port}`, {
    adapter: Kept,
    clients: [
      {
        client_id: 'beamroom',
        client_secret: 'secret-of-the-test',
        redirect_uris: [back],
        response_types: ['code'],
        grant_types: ['authorization_code'],
      },
    ],
    claims: { openid: ['sub'], profile: ['name', 'preferred_username', 'groups'] },
    conformIdTokenClaims: false,
    findAccount: (_, id) => ({
      accountId: id,
      claims: () => ({ sub: id, preferred_username: id, name: people[id]?.name, groups: people[id]?.groups }),
    }),
    cookies: { keys: ['of the test'] },
    pkce: { required: () => false },
    features: { devInteractions: { enabled: true } },
  });
  server.on('request', provider.callback());
  return {
    port,
    wait: (seconds) => {
      for (const session of sessions.values()) if (session.loginTs) session.loginTs -= seconds;
    },
    stop: () =>
      new Promise((done) => {
        server.close(done);
        server.closeAllConnections();
      }),
  };
}
