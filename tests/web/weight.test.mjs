// Load of a first visit: number of requests and bytes over the wire; the font.
import assert from 'node:assert/strict';
import { get } from 'node:http';
import { after, before, test } from 'node:test';
import { gunzipSync } from 'node:zlib';
import { missing, startWorld } from './browser.mjs';

let world;
const maxRequests = 40;
const maxBytes = 120e3; // of the page's own code and libraries: all but the font, which is counted by itself
const maxFontBytes = 50e3;

/** Opens an address in a browser that has nothing in its cache. @returns {Promise<{page, requests: {url, bytes, isCached}[]}>} requests grows as long as the page is open */
async function visit(address, isThere) {
  const page = await world.newPage('healthz'); // only to have a page before the first request is counted
  const client = await page.context().newCDPSession(page);
  const byId = new Map();
  const requests = [];
  await client.send('Network.enable');
  client.on('Network.requestWillBeSent', ({ requestId, request: { url } }) => {
    if (!url.startsWith('http')) return;
    const one = { url, bytes: 0, isCached: false };
    requests.push(one);
    byId.set(requestId, one);
  });
  const change = (requestId, part) => Object.assign(byId.get(requestId) ?? {}, part);
  client.on('Network.requestServedFromCache', ({ requestId }) => change(requestId, { isCached: true }));
  client.on('Network.responseReceived', ({ requestId, response }) => {
    if (response.fromDiskCache) change(requestId, { isCached: true });
  });
  client.on('Network.loadingFinished', ({ requestId, encodedDataLength }) => change(requestId, { bytes: encodedDataLength }));
  await page.goto(`${world.daemon.url}/${address}`);
  await isThere(page);
  return { page, requests };
}

const isOfPage = ({ url }) => !url.includes('/api/');
const isFont = ({ url }) => url.endsWith('.woff2');
const sum = (requests) => requests.reduce((total, { bytes }) => total + bytes, 0);

before(async () => {
  if (!missing) world = await startWorld();
});
after(() => world?.stop());

test('a first visit of the start page and of a room stays within its requests and bytes', { skip: missing }, async () => {
  const room = await world.newRoom();
  const cases = [
    ['', (page) => page.getByText('Modified Snyder').first().waitFor()],
    [`rooms/${room}`, (page) => page.locator('#fps').waitFor()],
  ];
  for (const [address, isThere] of cases) {
    const { page, requests } = await visit(address, isThere);
    await page.waitForLoadState('networkidle');
    const own = requests.filter((request) => isOfPage(request) && !isFont(request));
    const fonts = requests.filter(isFont);
    assert.ok(own.length >= 3, 'the page, its code and its style are counted');
    assert.ok(requests.length <= maxRequests, `${requests.length} requests:\n${requests.map(({ url }) => url).join('\n')}`);
    assert.ok(sum(own) <= maxBytes, `${sum(own)} bytes of code`);
    assert.ok(sum(fonts) <= maxFontBytes, `${sum(fonts)} bytes of fonts`);
    console.log(
      `  ${address ? 'room' : 'start page'}: ${requests.length} requests, ${own.length} of them for code (${sum(own)} bytes), fonts ${sum(fonts)} bytes`,
    );
    await page.close();
  }
  assert.deepEqual(world.errors, []);
});

test('a browser that takes gzip alone, as over plain HTTP, stays within the bytes too', { skip: missing }, async () => {
  const ask = (path) =>
    new Promise((done, failed) => {
      get(`${world.daemon.url}/${path}`, { headers: { 'Accept-Encoding': 'gzip' } }, (answer) => {
        const parts = [];
        assert.equal(answer.headers['content-encoding'], 'gzip', path);
        answer.on('data', (part) => parts.push(part));
        answer.on('end', () => done({ bytes: Buffer.concat(parts).length, text: gunzipSync(Buffer.concat(parts)).toString() }));
      }).on('error', failed);
    });
  const page = await ask('');
  const named = new Set([...page.text.matchAll(/(?:href|src)="\/(page\/[^"]+\.(?:js|css))"/g)].map(([, path]) => path));
  assert.ok(named.size >= 2, `${[...named]}`);
  let total = page.bytes;
  for (const path of named) total += (await ask(path)).bytes;
  assert.ok(total <= maxBytes, `${total} bytes`);
});

test('a second visit takes code, style and font from the cache', { skip: missing }, async () => {
  const isListed = (page) => page.locator('.plan').first().waitFor();
  const { page, requests } = await visit('', isListed);
  const [before, onlyOfPage] = [requests.length, ({ url }) => new URL(url).pathname.startsWith('/page/')];
  await page.goto('about:blank');
  await page.goto(`${world.daemon.url}/`);
  await isListed(page);
  const again = requests.slice(before).filter(onlyOfPage);
  assert.equal(again.length, requests.slice(0, before).filter(onlyOfPage).length);
  assert.deepEqual(
    again.filter(({ isCached }) => !isCached),
    [],
  );
  await page.close();
});

test('text is set in the font that comes along, and digits have one width', { skip: missing }, async () => {
  const page = await world.newPage();
  await page.locator('.plan').first().waitFor();
  const found = await page.evaluate(async () => {
    await document.fonts.ready;
    const width = (text) => {
      const span = document.createElement('span');
      span.textContent = text;
      document.body.append(span);
      const { width: px } = span.getBoundingClientRect();
      span.remove();
      return px;
    };
    return {
      loaded: [...document.fonts].map(({ family, status }) => [family.replaceAll('"', ''), status]),
      widths: [...'0123456789'].map((digit) => width(digit.repeat(20))),
    };
  });
  assert.deepEqual(found.loaded, [['Inter Variable', 'loaded']]);
  for (const px of found.widths) assert.ok(Math.abs(px - found.widths[0]) < 0.1, found.widths.join(' '));
  await page.close();
});
