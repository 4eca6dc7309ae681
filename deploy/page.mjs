// Makes the page light to load: node deploy/page.mjs FOLDER, after deploy/web.sh has filled FOLDER.
//   page/NAME-HASH.js .css .woff2   the modules and the style sheets that index.html names, each joined into one file, and the font
//   index.html                      names those instead; the page of separate modules stays as modules.html, for debugging
//   licences.txt                    of the libraries and the font
//   FILE.gz FILE.br                 beside each text file that gets smaller
// The files in page/ carry a hash of their contents in their names, so the daemon lets browsers keep them for ever.
import { readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { brotliCompressSync, constants, gzipSync } from 'node:zlib';
import { build } from 'esbuild';

const folder = process.argv[2];
const read = (name) => readFileSync(join(folder, name), 'utf8');
const browsers = ['chrome107', 'firefox115', 'safari16.4'];
const notice = '/*! The licences of lit-html and signals-core are in licences.txt */';

const source = read('index.html');
const sheets = [...source.matchAll(/^ *<link rel="stylesheet" href="([^"]+)" \/>\n/gm)];
const script = source.match(/^ *<script type="module" src="([^"]+)"><\/script>\n/m);
if (!sheets.length || !script) throw new Error('index.html names no style sheets or no module in the form that deploy/page.mjs knows');

const shared = { absWorkingDir: join(process.cwd(), folder), bundle: true, minify: true, target: browsers, metafile: true, legalComments: 'none', logLevel: 'warning', outdir: 'page' };
const code = await build({ ...shared, entryPoints: [{ in: script[1], out: 'main' }], entryNames: '[name]-[hash]', format: 'esm', banner: { js: notice } });
const style = await build({ ...shared, entryNames: '[name]-[hash]', assetNames: '[name]-[hash]', loader: { '.woff2': 'file' },
  entryPoints: [{ in: 'page.css', out: 'main' }], plugins: [{ name: 'sheets', setup({ onLoad, onResolve }) {
    onResolve({ filter: /^page\.css$/ }, () => ({ path: 'page.css', namespace: 'sheets' }));
    onLoad({ filter: /.*/, namespace: 'sheets' }, () => ({ contents: sheets.map(([, href]) => `@import "./${href}";`).join('\n'), loader: 'css', resolveDir: join(process.cwd(), folder) }));
  } }] });
const made = [code, style].flatMap(({ metafile }) => Object.keys(metafile.outputs));
const only = (ending) => made.filter((name) => name.endsWith(ending)).map((name) => name.replaceAll('\\', '/'));

// The one list of what is loaded first.
const [[main], [css]] = [only('.js'), only('.css')];
const first = [`<link rel="modulepreload" href="${main}" />`, ...only('.woff2').map((font) => `<link rel="preload" href="${font}" as="font" type="font/woff2" crossorigin />`),
  `<link rel="stylesheet" href="${css}" />`, `<script type="module" src="${main}"></script>`];
let page = source;
for (const [line] of sheets) page = page.replace(line, '');
page = page.replace(script[0], first.map((line) => `    ${line}\n`).join(''));
writeFileSync(join(folder, 'modules.html'), source);
writeFileSync(join(folder, 'index.html'), page);

const licences = readdirSync(join(folder, 'lib')).filter((name) => name.startsWith('LICENSE.')).sort();
writeFileSync(join(folder, 'licences.txt'), licences.map((name) => `${name.slice('LICENSE.'.length)}\n\n${read(`lib/${name}`).trim()}\n`).join(`\n${'-'.repeat(80)}\n\n`));

const isText = /\.(html|css|m?js|json|svg|txt|webmanifest)$/;
const leastGain = 64; // bytes; less is not worth a second file
for (const entry of readdirSync(folder, { recursive: true, withFileTypes: true })) {
  if (!entry.isFile() || !isText.test(entry.name)) continue;
  const path = join(entry.parentPath ?? entry.path, entry.name);
  const bytes = readFileSync(path);
  const packed = { gz: gzipSync(bytes, { level: 9 }), br: brotliCompressSync(bytes, { params: { [constants.BROTLI_PARAM_SIZE_HINT]: bytes.length } }) };
  for (const [ending, smaller] of Object.entries(packed)) if (smaller.length + leastGain <= bytes.length) writeFileSync(`${path}.${ending}`, smaller);
}
