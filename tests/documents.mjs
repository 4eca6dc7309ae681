// Holds the documents to the project: node tests/documents.mjs [FOLDER]
//   THIRD-PARTY.md has a row for each package of deploy/packages, package.json, tests/deploy/package.json and tests/firefox/package.json, and none for others; of npm's with the licence they state
//   the version stands in the Makefile, and everywhere else as there
//   README.md has at most 6,000 bytes and names the browsers of deploy/promised.mjs
//   docs/admin.md names each setting of deploy/beamroomd.conf
//   each file of docs/decisions has its four headings, at most 40 lines, and a row in the README.md there
//   every path that README.md, CONTRIBUTING.md, THIRD-PARTY.md and docs/**/*.md name exists
// Prints one line a fault, "FILE:LINE: SENTENCE", and exits with 1 if there is one.
import { execFileSync } from 'node:child_process';
import { existsSync, readFileSync } from 'node:fs';
import { basename, dirname, join, normalize, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';

const root = process.argv[2] ?? '.';
const read = (name) => readFileSync(join(root, name), 'utf8');
const json = (name) => JSON.parse(read(name));
const isGit = existsSync(join(root, '.git'));
const listed = isGit
  ? execFileSync('git', ['-C', root, 'ls-files', '-co', '--exclude-standard'], { encoding: 'utf8', maxBuffer: 1 << 26 })
  : execFileSync('find', ['.', '-type', 'f', '-printf', '%P\\n'], { cwd: root, encoding: 'utf8', maxBuffer: 1 << 26 });
const files = listed.split('\n').filter((name) => name && existsSync(join(root, name)));
const folders = new Set(
  files.flatMap((name) =>
    name
      .split('/')
      .slice(0, -1)
      .map((_, i, parts) => parts.slice(0, i + 1).join('/')),
  ),
);
const faults = [];
const lineOf = (text, index) => text.slice(0, index).split('\n').length;

/** Names in `...` of a table's second column, with the line's number. */
function packageRows(text) {
  return text.split('\n').flatMap((line, i) => {
    const cells = line.split('|').map((cell) => cell.trim());
    if (cells.length < 5 || !cells[2].startsWith('`')) return [];
    return [...cells[2].matchAll(/`([^`]+)`/g)].map(([, name]) => ({ name, line: i + 1, cells }));
  });
}

function thirdParty() {
  const rows = packageRows(read('THIRD-PARTY.md'));
  const groups = [...read('deploy/packages').matchAll(/^(?:build|run|test|ci|bench|deploy|firefox)="([^"]*)"/gm)];
  const debian = groups.flatMap(([, names]) => names.split(/\s+/).filter(Boolean)).map((entry) => entry.split(':').at(-1));
  const { dependencies = {}, devDependencies = {} } = json('package.json');
  const npm = {
    ...dependencies,
    ...devDependencies,
    ...json('tests/deploy/package.json').devDependencies,
    ...json('tests/firefox/package.json').devDependencies,
  };
  const needed = new Set([...debian, ...Object.keys(npm)]);
  const named = new Set(rows.map(({ name }) => name));
  if (groups.length !== 7) faults.push(`deploy/packages:1: ${groups.length} of seven groups could be read`);
  for (const name of needed) if (!named.has(name)) faults.push(`THIRD-PARTY.md:1: no row for ${name}`);
  for (const { name, line, cells } of rows) {
    if (!needed.has(name)) faults.push(`THIRD-PARTY.md:${line}: ${name} stands neither in deploy/packages nor in a package.json`);
    if (Object.hasOwn(dependencies, name) && !cells.includes(dependencies[name]))
      faults.push(`THIRD-PARTY.md:${line}: ${name} is version ${dependencies[name]}`);
    const stated = ['', 'build/deploy', 'build/firefox']
      .map((top) => join(root, top, 'node_modules', name, 'package.json'))
      .find(existsSync);
    if (!Object.hasOwn(npm, name) || !stated) continue;
    const { license } = JSON.parse(readFileSync(stated, 'utf8'));
    if (!cells.some((cell) => cell === license)) faults.push(`THIRD-PARTY.md:${line}: ${name} states the licence ${license}`);
  }
}

function versions() {
  const version = /^VERSION := (\S+)$/m.exec(read('Makefile'))?.[1];
  const own = json('package.json'),
    lock = json('package-lock.json');
  const places = {
    'package.json': own.version,
    'package-lock.json': lock.version,
    'package-lock.json, packages': lock.packages[''].version,
    'CHANGELOG.md': /^## (\d+\.\d+\.\d+)/m.exec(read('CHANGELOG.md'))?.[1],
  };
  for (const [place, said] of Object.entries(places))
    if (said !== version) faults.push(`${place}:1: version ${said}; the Makefile has ${version}`);
  for (const [place, said] of [
    ['package.json', own.license],
    ['package-lock.json', lock.packages[''].license],
  ])
    if (said !== 'Apache-2.0') faults.push(`${place}:1: licence ${said}`);
  for (const name of files.filter((file) => file.startsWith('deploy/')))
    if (/Beamroom \d+\.\d+\.\d+/.test(read(name))) faults.push(`${name}:1: names a version, which stands in the Makefile alone`);
}

async function readme() {
  const text = read('README.md');
  const { browsers } = await import(pathToFileURL(resolve(root, 'deploy/promised.mjs')));
  if (Buffer.byteLength(text) > 6000) faults.push(`README.md:1: ${Buffer.byteLength(text)} bytes; at most 6,000`);
  for (const [name, version] of Object.entries(browsers)) {
    if (!new RegExp(`\\b${name}\\b[^\\d,]* ${version.replaceAll('.', '\\.')}\\b`, 'i').test(text))
      faults.push(`README.md:1: does not promise ${name} ${version} as deploy/promised.mjs does`);
  }
}

const tops = new Set(files.map((name) => name.split('/')[0]));
const isSource = /\.(c|h|cc|hh|inc|frag|vert|glsl|js|mjs|css|sh)$/;
/** Whether a word in `...` names a path of the project: its first part is a file or folder at the top, or it ends as our sources do. */
const isPath = (word) =>
  /^[\w.*<>/-]+$/.test(word) &&
  !word.startsWith('/') &&
  !word.startsWith('.c') &&
  !/(^|\/)x\.test\.mjs$/.test(word) &&
  ((word.includes('/') && tops.has(word.split('/')[0])) || isSource.test(word));
const pattern = (word) =>
  new RegExp(
    `(^|/)${word
      .replace(/[.]/g, '\\.')
      .replace(/\*\*/g, '.+')
      .replace(/\*/g, '[^/]*')
      .replace(/<[^>]*>/g, '[^/]+')}$`,
  );
/** Names in full must be there from the top; a file's bare name, or a name with *, anywhere. */
function exists(word) {
  const name = word.replace(/\/$/, '');
  if (/[*<]/.test(name) || !name.includes('/'))
    return files.some((file) => pattern(name).test(file)) || [...folders].some((folder) => pattern(name).test(folder));
  return files.includes(name) || folders.has(name);
}

function paths() {
  const texts = files.filter((name) => /^(README|CONTRIBUTING|THIRD-PARTY)\.md$|^docs\/.*\.md$/.test(name));
  for (const name of texts) {
    const text = read(name);
    for (const match of text.matchAll(/`([^`\n]+)`/g)) {
      const word = match[1].replace(/:\d+$/, '');
      if (!isPath(word) || word.startsWith('build/') || word.startsWith('node_modules/')) continue;
      const found = exists(word);
      if (!found) faults.push(`${name}:${lineOf(text, match.index)}: ${match[1]} is not there`);
    }
    for (const match of text.matchAll(/\]\(([^)\s#]+)(?:#[^)]*)?\)/g)) {
      if (/^[a-z]+:/.test(match[1])) continue;
      const target = normalize(join(dirname(name), match[1])).replace(/\/$/, '');
      if (!files.includes(target) && !folders.has(target))
        faults.push(`${name}:${lineOf(text, match.index)}: the link to ${match[1]} leads nowhere`);
    }
  }
}

function settings() {
  const admin = read('docs/admin.md');
  for (const [, , name] of read('deploy/beamroomd.conf').matchAll(/^(# )?([a-z-]+) = /gm))
    if (!admin.includes(`\`${name}\``)) faults.push(`docs/admin.md:1: the setting ${name} is not named`);
}

function decisions() {
  const list = files.includes('docs/decisions/README.md') ? read('docs/decisions/README.md') : '';
  for (const name of files.filter((file) => /^docs\/decisions\/\d/.test(file))) {
    const text = read(name);
    const headings = [...text.matchAll(/^## (.*)$/gm)].map(([, words]) => words).join(', ');
    if (headings !== 'Context, Decision, Figures, Consequences') faults.push(`${name}:1: its headings are ${headings}`);
    if (text.split('\n').length > 41) faults.push(`${name}:1: more than 40 lines`);
    if (!list.includes(`(${basename(name)})`)) faults.push(`${name}:1: not in docs/decisions/README.md`);
  }
}

thirdParty();
versions();
settings();
decisions();
await readme();
paths();
for (const fault of faults) console.log(fault);
process.exitCode = faults.length ? 1 : 0;
