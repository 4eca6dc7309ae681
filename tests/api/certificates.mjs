// Certificates for tests of TLS, made by openssl; and a client that says what was agreed on.
import { execFileSync } from 'node:child_process';
import { join } from 'node:path';
import { connect } from 'node:tls';

/** Nobody has signed these. */
process.env.NODE_TLS_REJECT_UNAUTHORIZED = '0';
const listeners = process.listeners('warning');
process.removeAllListeners('warning'); // node warns of it at the first connection
process.on('warning', (warning) => {
  if (!/NODE_TLS_REJECT_UNAUTHORIZED/.test(warning.message)) for (const listener of listeners) listener(warning);
});

const openssl = (...args) => execFileSync('openssl', args, { stdio: ['ignore', 'pipe', 'pipe'] });

/** Writes a certificate and its key, NAME.pem and NAME.key. @param {'ec' | 'rsa'} kind @returns {{cert: string, key: string}} */
export function makeCertificate(folder, name, kind = 'ec') {
  const [cert, key] = [join(folder, `${name}.pem`), join(folder, `${name}.key`)];
  const how = kind === 'ec' ? ['ec', '-pkeyopt', 'ec_paramgen_curve:P-256'] : ['rsa:2048'];
  openssl(
    ...['req', '-x509', '-newkey', ...how, '-nodes', '-keyout', key, '-out', cert, '-days', '30', '-subj', `/CN=${name}`],
    ...['-addext', `subjectAltName=DNS:${name},DNS:localhost,IP:127.0.0.1`],
  );
  return { cert, key };
}

/** Writes the key behind a passphrase. */
export const encryptKey = (key, file) => openssl('pkey', '-in', key, '-aes256', '-passout', 'pass:test', '-out', file);

/** Shakes hands. @returns {Promise<{socket: import('node:tls').TLSSocket, name: string, version: string, cipher: string, alpn: string | false}>} */
export function shakeHands(url, { from = '127.0.0.1', ...options } = {}) {
  const { hostname, port } = new URL(url);
  return new Promise((done, failed) => {
    const socket = connect({ host: hostname, port: Number(port), localAddress: from, rejectUnauthorized: false, ...options });
    socket.on('error', failed);
    socket.once('secureConnect', () => {
      socket.on('error', () => {});
      done({
        socket,
        name: socket.getPeerCertificate().subject.CN,
        version: socket.getProtocol(),
        cipher: socket.getCipher().standardName,
        alpn: socket.alpnProtocol,
      });
    });
  });
}

/** Sends a request on such a connection; the answer's text when it ends with this. */
export function ask(socket, request, ending) {
  return new Promise((done) => {
    let text = '';
    const take = (bytes) => {
      text += bytes.toString('latin1');
      if (!text.endsWith(ending)) return;
      socket.off('data', take);
      socket.off('close', end);
      done(text);
    };
    const end = () => done(text);
    socket.on('data', take);
    socket.on('close', end);
    socket.write(request);
  });
}

/** A certificate with a key that is too short. */
export const makeWeak = ({ cert, key }) =>
  openssl('req', '-x509', '-newkey', 'rsa:1024', '-nodes', '-keyout', key, '-out', cert, '-days', '30', '-subj', '/CN=weak');
