// The page while the renderer cannot be started: it says why, and when it tries again. Skips without a browser.
import assert from 'node:assert/strict';
import { chmodSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { test } from 'node:test';
import { bin, call } from '../api/daemon.mjs';
import { full, missing, startWorld } from './browser.mjs';

test('a renderer that stops again and again: every pane says why and counts down to the next try, over the last picture', {
  skip: missing && `${missing} is missing`,
}, async () => {
  const folder = mkdtempSync(join(tmpdir(), 'beamroom-restart-'));
  const broken = join(folder, 'broken'),
    renderer = join(folder, 'renderer.sh');
  writeFileSync(
    renderer,
    `#!/bin/sh\ncase "$*" in *--socket-fd*) [ -e ${broken} ] && kill -9 $$;; esac\nexec ${resolve(bin, 'beamroom-render')} "$@"\n`,
  );
  chmodSync(renderer, 0o755);
  const world = await startWorld({ args: ['--renderer', renderer, '--plan-idle-close', '1'] });
  try {
    const room = await world.newRoom();
    const page = await world.newPage(`rooms/${room}`);
    await full(page);
    writeFileSync(broken, '');
    await call(`${world.daemon.url}/api/v1/plans/phantom/close`, 'POST');
    await page.locator('.pane .cover', { hasText: 'the plan was closed' }).first().waitFor();
    await call(`${world.daemon.url}/api/v1/plans/phantom/open`, 'POST');
    for (const seconds of [4, 3]) // the third pause, and a second later
      await page
        .locator('.pane .cover', { hasText: `The renderer stopped (signal 9); it is started again in ${seconds} s.` })
        .first()
        .waitFor();
    assert.equal(await page.locator('.pane .cover', { hasText: 'it is started again in' }).count(), await page.locator('.pane').count());
    rmSync(broken);
    await full(page);
    assert.equal(await page.locator('.pane .cover', { hasText: 'started again' }).count(), 0);
    assert.deepEqual(world.errors, []);
  } finally {
    await world.stop();
    rmSync(folder, { recursive: true, force: true });
  }
});
