// Makes the page light to load: node deploy/page.mjs FOLDER, after deploy/web.sh has filled FOLDER.
//   page/NAME-HASH.js .css .woff2   the modules and the style sheets that a page names, each joined into one file, and the font;
//                                   modules that are imported on demand (import('...')), and what only they need, are files of their own
//   index.html, display.html        name those instead, from the root, as it is served at /rooms/ID too; the page of separate modules stays as modules.html, for debugging
//   licences.txt                    of the libraries and the font
//   FILE.gz FILE.br                 beside each text file that gets smaller
// The files in page/ carry a hash of their contents in their names, so the daemon lets browsers keep them for ever.
import { mkdirSync, readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { createHash } from 'node:crypto';
import { basename, dirname, join } from 'node:path';
import { brotliCompressSync, constants, gzipSync } from 'node:zlib';
import { build } from 'esbuild';
import { browsers } from './promised.mjs';

const folder = process.argv[2];
const read = (name) => readFileSync(join(folder, name), 'utf8');
const notice = '/*! The licences of lit-html, signals-core and uPlot are in licences.txt */';

/** Makes one file of a module and all that it imports at once, and one of each module that is imported on demand, which takes from the first what both
 *  need. esbuild alone would cut what they share into many small files, each of them a request that is compressed by itself.
 *  The names carry one hash of everything: files that belong together are never mixed with older ones. @param {string} named what the first file is called @returns {Promise<{main: string}>} */
async function joinModules(entry, named) {
  const {
    metafile: { outputs },
    outputFiles,
  } = await build({
    ...shared,
    entryPoints: [{ in: entry, out: named }],
    entryNames: '[name]-[hash]',
    chunkNames: '[name]-[hash]',
    splitting: true,
    format: 'esm',
    write: false,
  });
  const textOf = new Map(outputFiles.map(({ path, text }) => [basename(path), text]));
  const parts = new Map(Object.entries(outputs).map(([name, output]) => [basename(name), output]));
  const hash = createHash('sha256')
    .update([...textOf].sort().flat().join('\n'))
    .digest('hex')
    .slice(0, 8)
    .toUpperCase();
  const plain = (name) => name.replace(/-[A-Z0-9]{8}\.js$/, '');
  const isTwice = (name) => [...parts.keys()].filter((other) => plain(other) === plain(name)).length > 1;
  /** With its folder where two modules of different folders have one name. */
  const finalName = (name) => `${isTwice(name) ? `${basename(dirname(parts.get(name).entryPoint))}_` : ''}${plain(name)}-${hash}.js`;

  /** A part after all that it imports at once. */
  const withImports = (name) => [
    ...parts
      .get(name)
      .imports.filter(({ kind }) => kind === 'import-statement')
      .flatMap(({ path }) => withImports(basename(path))),
    name,
  ];
  const start = [...parts.keys()].find((name) => parts.get(name).entryPoint === entry);
  const first = [...new Set(withImports(start))];
  const taking = /import(?:\{([^}]*)\}from)?"\.\/([^"]+)";/g;
  /** "exported as local, ..." of a statement that takes something from a part of the first file. */
  const wordsOf = (words) =>
    words.split(',').map((word) => {
      const [exported, local = exported] = word.split(' as ');
      return { exported, local };
    });
  /** The exports that other parts take from the first file: for each of its parts, the names there and in the joined file. */
  const taken = new Map(first.map((name) => [name, new Map()]));
  const shortName = new Map();
  let n = 0;
  for (const [name, text] of textOf)
    if (!first.includes(name))
      for (const [, words, from] of text.matchAll(taking))
        if (words && taken.has(from))
          for (const { exported } of wordsOf(words))
            if (!taken.get(from).has(exported)) taken.get(from).set(exported, `p${(n++).toString(36)}`);
  const exportsOf = (names) => [...names].map(([exported, long]) => `${exported} as ${long}`).join(', ');
  const whole = [...taken]
    .map(([name, names]) => (names.size ? `export { ${exportsOf(names)} } from './${name}';` : `import './${name}';`))
    .join('\n');

  /** The text of a part that is loaded later: what it takes from the first file it takes under the names that file has for it. */
  const fromFirst = (text) =>
    text.replace(taking, (statement, words, name) => {
      if (!first.includes(name)) return statement;
      if (!words) return ''; // it is there already
      const named = wordsOf(words).map(({ exported, local }) => `${shortName.get(taken.get(name).get(exported))} as ${local}`);
      return `import{${named.join(',')}}from"./${finalName(start)}";`;
    });

  const plugin = (isFirst) => ({
    name: 'parts',
    setup({ onLoad, onResolve }) {
      onResolve({ filter: /./ }, ({ path, kind }) => {
        const name = basename(path);
        if (kind === 'dynamic-import') return { path: `./${finalName(name)}`, external: true };
        if (name === finalName(start)) return { path: `./${name}`, external: true };
        return { path: name, namespace: 'part' };
      });
      onLoad({ filter: /./, namespace: 'part' }, ({ path }) => ({
        contents: path === 'whole' ? whole : isFirst ? textOf.get(path) : fromFirst(textOf.get(path)),
      }));
    },
  });
  const ready = { ...shared, format: 'esm', banner: { js: notice } };
  const lazy = [...parts.keys()].filter((name) => parts.get(name).entryPoint && name !== start);
  const { outputFiles: joined } = await build({
    ...ready,
    entryPoints: [{ in: 'whole', out: finalName(start).replace(/\.js$/, '') }],
    plugins: [plugin(true)],
    write: false,
  });
  // exports keep the short names that they have inside: some hundred names less to send, and sorted they take half of the bytes
  const [{ path, text: mainText }] = joined;
  const list = mainText.match(/export\s*\{([^}]*)\};?\s*$/);
  if (!list) throw new Error('the joined modules do not end with what they export');
  for (const word of list[1].split(',')) {
    const [local, name = local] = word.trim().split(' as ');
    shortName.set(name, local);
  }
  mkdirSync(dirname(path), { recursive: true });
  writeFileSync(path, `${mainText.slice(0, list.index)}export{${[...new Set(shortName.values())].sort().join(',')}};\n`);
  await build({
    ...ready,
    entryPoints: lazy.map((name) => ({ in: name, out: finalName(name).replace(/\.js$/, '') })),
    chunkNames: 'shared-[hash]',
    splitting: true,
    plugins: [plugin(false)],
  });
  return { main: `page/${finalName(start)}` };
}

const shared = {
  absWorkingDir: join(process.cwd(), folder),
  bundle: true,
  minify: true,
  target: Object.entries(browsers).map(([name, version]) => name + version),
  metafile: true,
  legalComments: 'none',
  logLevel: 'warning',
  outdir: 'page',
};

/** Joins style sheets into one file, and puts the fonts that they name beside it. @returns {Promise<{css: string, fonts: string[]}>} */
async function joinSheets(sheets, name) {
  const { metafile } = await build({
    ...shared,
    entryNames: `${name}-[hash]`,
    assetNames: '[name]-[hash]',
    loader: { '.woff2': 'file' },
    entryPoints: ['page.css'],
    plugins: [
      {
        name: 'sheets',
        setup({ onLoad, onResolve }) {
          onResolve({ filter: /^page\.css$/ }, () => ({ path: 'page.css', namespace: 'sheets' }));
          onLoad({ filter: /.*/, namespace: 'sheets' }, () => ({
            contents: sheets.map((href) => `@import "./${href}";`).join('\n'),
            loader: 'css',
            resolveDir: join(process.cwd(), folder),
          }));
        },
      },
    ],
  });
  const only = (ending) =>
    Object.keys(metafile.outputs)
      .filter((path) => path.endsWith(ending))
      .map((path) => path.replaceAll('\\', '/'));
  return { css: only('.css')[0], fonts: only('.woff2') };
}

/** Has a page name the joined files, the one list of what is loaded first, instead of its modules and style sheets. @param {string} name of the joined files @returns {Promise<string>} the page as it was */
async function joinPage(file, name) {
  const source = read(file);
  const sheets = [...source.matchAll(/^ *<link rel="stylesheet" href="\/([^"]+)" \/>\n/gm)];
  const script = source.match(/^ *<script type="module" src="\/([^"]+)"><\/script>\n/m);
  if (!sheets.length || !script) throw new Error(`${file} names no style sheets or no module in the form that deploy/page.mjs knows`);
  const { main } = await joinModules(script[1], name);
  const { css, fonts } = await joinSheets(
    sheets.map(([, href]) => href),
    name,
  );
  const first = [
    `<link rel="modulepreload" href="/${main}" />`,
    ...fonts.map((font) => `<link rel="preload" href="/${font}" as="font" type="font/woff2" crossorigin />`),
    `<link rel="stylesheet" href="/${css}" />`,
    `<script type="module" src="/${main}"></script>`,
  ];
  let page = source;
  for (const [line] of sheets) page = page.replace(line, '');
  writeFileSync(join(folder, file), page.replace(script[0], first.map((line) => `    ${line}\n`).join('')));
  return source;
}

writeFileSync(join(folder, 'modules.html'), await joinPage('index.html', 'main'));
await joinPage('display.html', 'wall');

const licences = readdirSync(join(folder, 'lib'))
  .filter((name) => name.startsWith('LICENSE.'))
  .sort();
writeFileSync(
  join(folder, 'licences.txt'),
  licences.map((name) => `${name.slice('LICENSE.'.length)}\n\n${read(`lib/${name}`).trim()}\n`).join(`\n${'-'.repeat(80)}\n\n`),
);

const isText = /\.(html|css|m?js|json|svg|txt|webmanifest)$/;
const leastGain = 64; // bytes; less is not worth a second file
for (const entry of readdirSync(folder, { recursive: true, withFileTypes: true })) {
  if (!entry.isFile() || !isText.test(entry.name)) continue;
  const path = join(entry.parentPath ?? entry.path, entry.name);
  const bytes = readFileSync(path);
  const packed = {
    gz: gzipSync(bytes, { level: 9 }),
    br: brotliCompressSync(bytes, { params: { [constants.BROTLI_PARAM_SIZE_HINT]: bytes.length } }),
  };
  for (const [ending, smaller] of Object.entries(packed))
    if (smaller.length + leastGain <= bytes.length) writeFileSync(`${path}.${ending}`, smaller);
}
