// To change X, look in Y: the index of the whole, made from the README.md of each folder and the first sentence of each file.
//
//   node docs/where.mjs OUT          writes it as one page; `make where` writes build/where.md
//   node docs/where.mjs - WORD...    prints what has all of these words; `make where WORDS="isodose level"`
import { readFileSync, writeFileSync } from 'node:fs';
import { basename, dirname, extname, join } from 'node:path';
import { filesOf, namedIn } from '../tests/readmes.mjs';

const top = join(dirname(new URL(import.meta.url).pathname), '..');
const comments = {
  '/*': /\/\*+\s*([\s\S]*?)\*\//,
  '//': /((?:^\/\/[^\n]*\n)+)/m,
  '#': /((?:^#(?!!|\s*include)[^\n]*\n)+)/m,
};
const commentOf = (path) => ({ '.js': '//', '.mjs': '//', '.sh': '#', '.py': '#', '.conf': '#', '.txt': '#' })[extname(path)] ?? '/*';

/** The first sentence of the first comment of a file; '' if it has none. */
function sentenceOf(path) {
  if (['.json', '.md', '.html', '.sql'].includes(extname(path))) return '';
  const found = comments[commentOf(path)].exec(readFileSync(join(top, path), 'utf8').slice(0, 4000));
  const text = (found?.[1] ?? '')
    .replace(/^\s*(\*|\/\/|#)? ?/gm, '')
    .replace(/\s+/g, ' ')
    .trim();
  return /^(.*?[.;])(?= [A-Z]|$)/.exec(text)?.[1].slice(0, 300) ?? text.slice(0, 300);
}

/** @returns {{folder: string, about: string, rows: {words: string, paths: string[]}[]}[]} of each README.md */
function folders(files) {
  return files
    .filter((path) => basename(path) === 'README.md')
    .map((readme) => {
      const text = readFileSync(join(top, readme), 'utf8');
      const about = text.split('\n\n')[1]?.replace(/\s+/g, ' ') ?? '';
      const rows = [...text.matchAll(/^\| (.+?) \| (.+?) \|$/gm)].map(([, words, names]) => ({
        words,
        paths: namedIn(top, files, readme, names),
      }));
      return { folder: dirname(readme), about, rows: rows.filter(({ paths }) => paths.length) };
    });
}

const files = filesOf(top);
const [out = 'build/where.md', ...words] = process.argv.slice(2);
const told = folders(files);
const sentences = files.map((path) => ({ path, text: sentenceOf(path) })).filter(({ text }) => text);

if (words.length) {
  const wanted = words.join(' ').toLowerCase().split(/\s+/).filter(Boolean);
  const hasAll = (text) => wanted.every((word) => text.toLowerCase().includes(word));
  const rows = told.flatMap(({ rows: list }) => list).filter((row) => hasAll(`${row.words} ${row.paths.join(' ')}`));
  for (const row of rows) console.log(`${row.words}\n    ${row.paths.join('  ')}`);
  for (const { path, text } of sentences.filter((one) => hasAll(`${one.path} ${one.text}`))) console.log(`${path}: ${text}`);
  if (!rows.length && !sentences.some((one) => hasAll(`${one.path} ${one.text}`)))
    console.log('Nothing has these words. Fewer or other words find more.');
} else {
  const page = ['# To change X, look in Y', 'Made by `make where` from the README.md of each folder and the first sentence of each file.'];
  for (const { folder, about, rows } of told) {
    page.push(`## ${folder}`, about);
    if (rows.length)
      page.push(
        [
          '| to change | look in |',
          '|---|---|',
          ...rows.map((row) => `| ${row.words} | ${row.paths.map((path) => `\`${path}\``).join(', ')} |`),
        ].join('\n'),
      );
    const own = sentences.filter(({ path }) => dirname(path) === folder);
    if (own.length) page.push(own.map(({ path, text }) => `- \`${basename(path)}\`: ${text}`).join('\n'));
  }
  writeFileSync(out, `${page.join('\n\n')}\n`);
}
