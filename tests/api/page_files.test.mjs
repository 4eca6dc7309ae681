// The files of the page as the daemon sends them: content codings, entity tags, how long browsers may keep them.
import assert from 'node:assert/strict';
import { readFileSync, readdirSync } from 'node:fs';
import { request } from 'node:http';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { brotliDecompressSync, gunzipSync } from 'node:zlib';
import { startDaemon, web } from './daemon.mjs';

let daemon;

before(async () => {
  daemon = await startDaemon();
});
after(() => daemon?.stop());

/** A request with just these headers: fetch would add its own Accept-Encoding, and decode the answer. */
const get = (path, headers = {}, method = 'GET') =>
  new Promise((done, failed) => {
    request(daemon.url + path, { method, headers }, (answer) => {
      const parts = [];
      answer.on('data', (part) => parts.push(part));
      answer.on('end', () => done({ status: answer.statusCode, headers: answer.headers, body: Buffer.concat(parts) }));
    })
      .on('error', failed)
      .end();
  });
const decoded = ({ headers, body }) =>
  (({ gzip: gunzipSync, br: brotliDecompressSync })[headers['content-encoding']] ?? ((bytes) => bytes))(body);
const files = readdirSync(web, { recursive: true, withFileTypes: true })
  .filter((entry) => entry.isFile())
  .map((entry) => join(entry.parentPath ?? entry.path, entry.name).slice(web.length));
const texts = files.filter((path) => /\.(html|css|js|json|svg|txt)$/.test(path));

describe('a text file of the page', () => {
  test('comes in the coding that the request prefers', async () => {
    const cases = [
      // RFC 9110 12.5.3
      [undefined, undefined],
      ['', undefined],
      ['identity', undefined],
      ['gzip', 'gzip'],
      ['br', 'br'],
      ['gzip, deflate, br, zstd', 'br'],
      ['gzip;q=0', undefined],
      ['gzip;q=0, br;q=0.001', 'br'],
      ['gzip;q=1.0, br;q=0.5', 'gzip'],
      ['*', 'br'],
      ['*;q=0', undefined],
      ['br;q=0, *', 'gzip'],
      ['identity;q=1, gzip;q=0.5', undefined],
      ['zstd', undefined],
      ['GZip', 'gzip'],
    ];
    for (const [accepted, coding] of cases) {
      const answer = await get('/index.html', accepted === undefined ? {} : { 'Accept-Encoding': accepted });
      assert.equal(answer.status, 200);
      assert.equal(answer.headers['content-encoding'], coding, `Accept-Encoding: ${accepted}`);
      assert.equal(answer.headers.vary, 'Accept-Encoding');
      assert.equal(Number(answer.headers['content-length']), answer.body.length);
    }
  });

  test('has the same contents in every coding', async () => {
    assert.ok(texts.length > 10);
    for (const path of texts) {
      const source = readFileSync(join(web, path));
      for (const coding of ['identity', 'gzip', 'br']) {
        const answer = await get(path, { 'Accept-Encoding': coding });
        assert.deepEqual(decoded(answer), source, `${path} as ${coding}`);
        assert.match(answer.headers['content-type'], /^(text|application|image)\//);
      }
    }
  });

  test('has an entity tag for each coding, and is sent again only when that one has changed', async () => {
    const tags = new Set();
    for (const coding of ['identity', 'gzip', 'br']) {
      const { etag } = (await get('/', { 'Accept-Encoding': coding })).headers;
      tags.add(etag);
      const again = await get('/', { 'Accept-Encoding': coding, 'If-None-Match': etag });
      assert.deepEqual([again.status, again.body.length, again.headers.etag, again.headers.vary], [304, 0, etag, 'Accept-Encoding']);
      const other = await get('/', { 'Accept-Encoding': coding === 'br' ? 'gzip' : 'br', 'If-None-Match': etag });
      assert.equal(other.status, 200);
    }
    assert.equal(tags.size, 3);
  });

  test('has the same headers for HEAD as for GET', async () => {
    for (const coding of ['identity', 'gzip', 'br']) {
      const [head, whole] = [await get('/', { 'Accept-Encoding': coding }, 'HEAD'), await get('/', { 'Accept-Encoding': coding })];
      assert.equal(head.body.length, 0);
      for (const name of ['content-length', 'content-encoding', 'content-type', 'etag', 'vary', 'cache-control'])
        assert.equal(head.headers[name], whole.headers[name]);
    }
  });

  test('comes whole when a part of it is asked for', async () => {
    const answer = await get('/', { Range: 'bytes=0-9', 'Accept-Encoding': 'gzip' });
    assert.equal(answer.status, 200);
    assert.deepEqual(decoded(answer), readFileSync(join(web, 'index.html')));
  });

  test('has no address of its own for its compressed copies', async () => {
    const copies = files.filter((path) => /\.(gz|br)$/.test(path));
    assert.ok(copies.length > 10);
    for (const path of copies) assert.equal((await get(path)).status, 404, path);
  });
});

describe('the files of the page', () => {
  test('may be kept for ever where their names change with their contents, and are asked for again elsewhere', async () => {
    for (const path of files.filter((name) => !/\.(gz|br|stamp)$|\/LICENSE\./.test(name))) {
      const { status, headers } = await get(path);
      assert.equal(status, 200, path);
      assert.equal(headers['cache-control'], path.startsWith('/page/') ? 'public, max-age=31536000, immutable' : 'no-cache', path);
      if (path.startsWith('/page/')) assert.match(path, /-[0-9A-Z]{8}\.\w+$/);
    }
  });

  test('include a font with its type, which is not compressed again', async () => {
    const font = files.find((path) => /^\/page\/.*\.woff2$/.test(path));
    const { headers, body } = await get(font, { 'Accept-Encoding': 'gzip, br' });
    assert.equal(headers['content-type'], 'font/woff2');
    assert.equal(headers['content-encoding'], undefined);
    assert.equal(headers.vary, undefined);
    assert.ok(body.length <= 50e3, `${body.length} bytes`);
  });
});
