// Makes the pictures of the guide and its list of keys from the page itself: make guide-pictures. A name of a tour makes those of that tour alone:
//   node docs/guide/pictures.mjs [TOUR...]     with BEAMROOM_BIN, BEAMROOM_WEB and BEAMROOM_DEMO
import { mkdtempSync, readdirSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { guidePlans, walk } from '../../tests/web/guide_tours.mjs';
import { missing, startWorld } from '../../tests/web/browser.mjs';

if (missing) throw new Error(`${missing} is not there`);
const folder = dirname(new URL(import.meta.url).pathname);
const quality = 47; // of the JPEG files: text stays readable, and all together stay below 1.5 MB
const plans = mkdtempSync(join(tmpdir(), 'beamroom-guide-'));
guidePlans(plans);
const world = await startWorld({ plans: [plans] });
try {
  await walk(world, {
    names: process.argv.slice(2),
    between: (name) => console.log(name),
    shot: (part, name) =>
      part.screenshot({ path: join(folder, `${name}.jpg`), type: 'jpeg', quality, scale: 'device', animations: 'disabled' }),
    keys: (rows) => {
      const cell = (text) => text.replaceAll('|', '\\|');
      const lines = rows.map(([key, what]) => `| ${cell(key)} | ${cell(what)} |`);
      const head =
        '# Keys and mouse\n\nAs the page lists them under ?, where the first ones can be changed. Keys act on the pane with the light header, from anywhere but text fields,\nlists of choice and dialogs. Made by `make guide-pictures`.\n';
      writeFileSync(join(folder, 'keys.md'), `${head}\n| key | what it does |\n|---|---|\n${lines.join('\n')}\n`);
    },
  });
} finally {
  await world.stop();
  rmSync(plans, { recursive: true });
}
const bytes = readdirSync(folder)
  .filter((name) => name.endsWith('.jpg'))
  .reduce((sum, name) => sum + statSync(join(folder, name)).size, 0);
console.log(`${Math.round(bytes / 1000)} kB of pictures`);
