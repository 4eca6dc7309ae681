// The README.md of each folder, held to the folder: every path it names exists, every source file of the folder is named in it exactly once, and
// it is short. Prints what is wrong, a line each, and ends with 1 if there is anything.
//
//   node tests/readmes.mjs [FOLDER]     the project, or another tree with the same rules
//
// Names stand in backquotes, from the README's folder or from the root. A name stands for all files with its stem: `mesh.h` for mesh.c too. A pattern
// (`dvh_kernels*.c`) stands for what it matches and no other name has. A small folder without a README.md is told of in the one above.
import { execFileSync } from 'node:child_process';
import { existsSync, readFileSync, statSync } from 'node:fs';
import { basename, dirname, extname, join } from 'node:path';
import { pathToFileURL } from 'node:url';

const roots = ['core', 'server', 'web', 'proto', 'tests', 'deploy', 'docs'];
const mostLines = 30;
const isNumberedRow = /^\| \[\d+\]\(/; // one for each decision: their list grows, and does not count
const sources = /\.(c|h|cc|hh|inc|js|mjs|css|html|sh|py|sql|glsl|frag|vert|md|json|yaml|txt|conf|service|in)$|^[^.]+$|\.[1-8]$/;
const isPathWord = /[^/]\.(c|h|cc|hh|inc|js|mjs|css|html|sh|py|sql|glsl|frag|vert|md)$/; // other words with a dot may be the name of a format
/** Data and what is made is told of by the README above it, not file by file. */
const isData = (path) => /(^|\/)(corpus|fixtures|data|figures|licenses)\//.test(path) || basename(path) === 'README.md';

/** @param {string} top @returns {string[]} its files, as git knows them or will */
export function filesOf(top) {
  const text = execFileSync('git', ['ls-files', '-co', '--exclude-standard', '--', ...roots], {
    cwd: top,
    encoding: 'utf8',
    maxBuffer: 1 << 26,
  });
  return text
    .split('\n')
    .filter((path) => path && existsSync(join(top, path)))
    .sort();
}

/** Files that are told of together: of C, and of shaders, those with one stem. */
const kinds = [
  ['.c', '.h', '.cc', '.hh', '.inc'],
  ['.glsl', '.vert', '.frag'],
];
const stemOf = (path) => {
  const kind = kinds.find((extensions) => extensions.includes(extname(path)));
  return kind ? path.slice(0, path.length - extname(path).length) + kind[0] : path;
};
const matcher = (pattern) =>
  new RegExp(`^${pattern.replace(/[.+?^$()[\]{}|\\]/g, '\\$&').replace(/\*\*\/|\*/g, (stars) => (stars === '*' ? '[^/]*' : '(.*/)?'))}$`);

/** The paths and patterns that a README names, with their lines. @returns {{word: string, line: number}[]} */
const wordsOf = (text) =>
  text
    .split('\n')
    .flatMap((line, at) =>
      [...line.matchAll(/`([^`\s]+)`|\]\(([^)#:\s]+)\)/g)].map(([, code, link]) => ({ word: code ?? link, line: at + 1 })),
    );

/** The files that a README's name stands for. @returns {string[]|null} paths; null for a word that is no path */
function pathsOf(top, files, folder, word) {
  if (word.includes('*')) {
    const tests = [join(folder, word), word].map(matcher);
    return files.filter((path) => tests.some((test) => test.test(path)));
  }
  const path = [join(folder, word), word].map((one) => one.replace(/\/$/, '')).find((one) => existsSync(join(top, one)));
  return path ? [path] : null;
}

/** The paths that stand in a part of a README. */
export const namedIn = (top, files, readme, text) => wordsOf(text).flatMap(({ word }) => pathsOf(top, files, dirname(readme), word) ?? []);

/** @param {string} top of a tree @returns {string[]} what is wrong */
export function findings(top) {
  const files = filesOf(top);
  const readmes = new Set(files.filter((path) => basename(path) === 'README.md'));
  const own = files.filter((path) => sources.test(basename(path)) && !isData(path));
  const homeOf = (path) => {
    for (let folder = dirname(path); folder !== '.'; folder = dirname(folder))
      if (readmes.has(`${folder}/README.md`)) return `${folder}/README.md`;
    return '';
  };
  const said = [];
  for (const folder of new Set(own.filter((path) => !homeOf(path)).map(dirname)))
    said.push(`${folder}/ has no README.md, nor has a folder above it`);

  for (const readme of readmes) {
    const text = readFileSync(join(top, readme), 'utf8');
    const folder = dirname(readme);
    const mine = own.filter((path) => homeOf(path) === readme);
    const nLines = text
      .trimEnd()
      .split('\n')
      .filter((line) => !isNumberedRow.test(line)).length;
    if (nLines > mostLines) said.push(`${readme} has ${nLines} lines; at most ${mostLines}`);
    const exact = new Map(); // path to lines
    const patterns = [];
    for (const { word, line } of wordsOf(text)) {
      const found = pathsOf(top, files, folder, word);
      if (word.includes('*')) {
        if (!found.length && (word.includes('/') || isPathWord.test(word)))
          said.push(`${readme}:${line} names ${word}, which nothing matches`);
        const stems = new Set(found.filter((path) => mine.includes(path)).map(stemOf));
        if (stems.size) patterns.push({ stems, line });
        continue;
      }
      const [path] = found ?? [];
      if (!path) {
        if (isPathWord.test(word) || (word.includes('/') && roots.some((root) => word.startsWith(`${root}/`))))
          said.push(`${readme}:${line} names ${word}, which does not exist`);
        continue;
      }
      if (!statSync(join(top, path)).isFile() || !mine.includes(path)) continue;
      exact.set(path, [...(exact.get(path) ?? []), line]);
    }
    for (const [stem, lines] of exact)
      if (lines.length > 1) said.push(`${stem} is named ${lines.length} times in ${readme}: lines ${lines.join(', ')}`);
    const stems = new Set([...exact.keys()].map(stemOf));
    const times = (path) => (stems.has(stemOf(path)) ? 1 : patterns.filter((pattern) => pattern.stems.has(stemOf(path))).length);
    for (const sub of new Set(mine.map((path) => dirname(path)))) {
      const here = mine.filter((path) => dirname(path) === sub);
      const unnamed = here.filter((path) => times(path) === 0);
      if (sub !== folder && unnamed.length === here.length && here.length > 1)
        said.push(`${sub}/ has no README.md, and ${readme} names none of its ${here.length} files`);
      else said.push(...unnamed.map((path) => `${path} is not named in ${readme}`));
      said.push(...here.filter((path) => times(path) > 1).map((path) => `${path} is matched by ${times(path)} patterns in ${readme}`));
    }
  }
  return said;
}

if (import.meta.url === pathToFileURL(process.argv[1]).href) {
  const said = findings(process.argv[2] ?? '.');
  if (said.length) console.log(said.join('\n'));
  process.exitCode = said.length ? 1 : 0;
}
