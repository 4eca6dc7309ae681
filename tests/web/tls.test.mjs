// The page over https in a real browser: its WebSocket, its addresses, a renewed certificate. --stub: grey pictures.
import assert from 'node:assert/strict';
import { copyFileSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import { makeCertificate } from '../api/certificates.mjs';
import { until } from '../api/daemon.mjs';
import { full, header, missing, startWorld } from './browser.mjs';

describe('the page over https', { skip: missing && `${missing} is not there` }, () => {
  const folder = mkdtempSync(join(tmpdir(), 'beamroom-https-'));
  const used = { cert: join(folder, 'used.pem'), key: join(folder, 'used.key') };
  let world, page, room;
  const use = (name) => {
    const { cert, key } = makeCertificate(folder, name);
    copyFileSync(cert, used.cert);
    copyFileSync(key, used.key);
  };
  before(async () => {
    use('first.example');
    world = await startWorld({ args: ['--stub', '--tls-cert', used.cert, '--tls-key', used.key] });
    room = await world.newRoom();
    page = await world.newPage(`rooms/${room}`, { ignoreHTTPSErrors: true });
    await full(page);
  });
  after(async () => {
    await world?.stop();
    rmSync(folder, { recursive: true, force: true });
  });

  it('shows a room by wss, and nothing was refused', async () => {
    assert.match(page.url(), /^https:/);
    assert.equal(await page.evaluate(() => globalThis.isSecureContext), true);
    assert.deepEqual(world.refused, []);
    assert.deepEqual(world.errors, []);
  });

  it('forms invitations with https', async () => {
    await page.getByRole('button', { name: 'Invite' }).click();
    assert.match(await page.locator('#invite-link').inputValue(), new RegExp(`^${world.daemon.url}/rooms/${room}`));
    await page.keyboard.press('Escape');
  });

  it('goes on when the certificate is renewed', async () => {
    const camera = async () => (await header(page, 1)).clip_from_lps_mm.join();
    const before = await camera();
    use('second.example');
    world.daemon.child.kill('SIGHUP');
    await until(world.daemon.log, (log) => /TLS: certificate of second\.example/.test(log));
    await page.locator('#picture-1').focus();
    await page.keyboard.press('ArrowLeft');
    await until(camera, (now) => now !== before);
    await full(page);
    assert.equal(await page.evaluate(() => globalThis.performance.getEntriesByType('navigation').length), 1, 'it was not loaded again');
  });
});
