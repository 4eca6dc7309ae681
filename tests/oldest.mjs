// Finds functions, classes and CSS that are newer than what deploy/promised.mjs promises: node tests/oldest.mjs
// A name is too new if everything that bears it in MDN's table of browser compatibility is. What the sources define themselves is theirs.
// Without arguments it checks the page and all scripts, then three planted ones; prints each finding and exits with 1 if there is any.
import { readFileSync } from 'node:fs';
import { execFileSync } from 'node:child_process';
import { createRequire } from 'node:module';
import { parse } from 'acorn';
import { full } from 'acorn-walk';
import { browsers, node } from '../deploy/promised.mjs';

const bcd = createRequire(import.meta.url)('@mdn/browser-compat-data');
/** Without these the page works and reads as well: an older browser shows its own scroll bars, its own colours, lets letters be selected. */
const harmless = new Set(['forced-color-adjust', 'scrollbar-width', 'scrollbar-color', 'user-select', 'paint-order']);

const numbers = (version) => version.replace('≤', '').split('.').map(Number);
/** True if version a is b or older. */
function isUpTo(a, b) {
  const [left, right] = [numbers(a), numbers(b)];
  for (let i = 0; i < Math.max(left.length, right.length); i++)
    if ((left[i] ?? 0) !== (right[i] ?? 0)) return (left[i] ?? 0) < (right[i] ?? 0);
  return true;
}
/** True if the engine has it without a flag in the version promised. */
function isThere({ support }, engine, version) {
  const rows = [support[engine]].flat().filter(Boolean);
  return rows.some(
    ({ version_added: added, version_removed: removed, flags, prefix }) =>
      !flags && !prefix && !removed && (added === true || (typeof added === 'string' && added !== 'preview' && isUpTo(added, version))),
  );
}

/** Names of the table with those of their features that bear them. */
function tableOf(parts) {
  const table = { member: new Map(), global: new Map(), whole: new Map() };
  const put = (map, name, compat) => compat && map.set(name, [...(map.get(name) ?? []), compat]);
  for (const part of parts)
    for (const [owner, { __compat: own, ...members }] of Object.entries(part)) {
      put(table.global, owner, own);
      for (const [member, { __compat: compat }] of Object.entries(members)) {
        if (!/^[A-Za-z]\w*$/.test(member)) continue;
        put(table.member, member, compat);
        put(table.whole, `${owner}.${member}`, compat);
      }
    }
  return table;
}
const builtins = tableOf([bcd.javascript.builtins]);
const everything = tableOf([bcd.javascript.builtins, bcd.api]);

/** Places in a script that name something newer. @param {Record<string, string>} engines @param {Set<string>} own names that the sources define */
export function scriptFindings(text, table, engines, own) {
  const found = [];
  const judge = (name, map, at) => {
    const features = map.get(name);
    if (!features) return;
    const lacking = Object.entries(engines).filter(([engine, version]) => !features.some((feature) => isThere(feature, engine, version)));
    if (lacking.length)
      found.push({ line: at.loc.start.line, name, lacking: lacking.map(([engine, version]) => `${engine} ${version}`).join(', ') });
  };
  full(parse(text, { ecmaVersion: 'latest', sourceType: 'module', locations: true, allowHashBang: true }), (at) => {
    if (at.type === 'NewExpression' && at.callee.type === 'Identifier' && !own.has(at.callee.name)) judge(at.callee.name, table.global, at);
    if (at.type === 'CallExpression' && at.callee.type === 'Identifier' && !own.has(at.callee.name))
      judge(at.callee.name, table.global, at);
    if (at.type !== 'MemberExpression' || at.computed || at.property.type !== 'Identifier') return;
    const whole = at.object.type === 'Identifier' ? `${at.object.name}.${at.property.name}` : '';
    if (table.whole.has(whole)) judge(whole, table.whole, at);
    else if (!own.has(at.property.name)) judge(at.property.name, table.member, at);
  });
  return found;
}
/** Names that a script gives to its own methods, properties and functions. */
export function ownNames(text) {
  const names = new Set();
  full(parse(text, { ecmaVersion: 'latest', sourceType: 'module', allowHashBang: true }), (at) => {
    const name =
      at.type === 'MethodDefinition' || at.type === 'PropertyDefinition' || at.type === 'Property'
        ? at.key.name
        : at.type === 'FunctionDeclaration' || at.type === 'ClassDeclaration'
          ? at.id?.name
          : at.type === 'VariableDeclarator'
            ? at.id.name
            : '';
    if (name) names.add(name);
  });
  return names;
}
/** Selectors and properties of a style sheet that are newer. */
export function styleFindings(text, engines) {
  const found = [];
  const plain = text.replace(/\/\*.*?\*\//gs, (comment) => comment.replace(/[^\n]/g, ' '));
  const judge = (name, compat, at) => {
    const lacking = Object.entries(engines).filter(([engine, version]) => !isThere(compat, engine, version));
    if (lacking.length)
      found.push({
        line: plain.slice(0, at).split('\n').length,
        name,
        lacking: lacking.map(([engine, version]) => `${engine} ${version}`).join(', '),
      });
  };
  for (const { 1: name, index } of plain.matchAll(/::?([a-z][a-z-]*)/g))
    if (bcd.css.selectors[name]?.__compat) judge(`:${name}`, bcd.css.selectors[name].__compat, index);
  for (const { 1: name, index } of plain.matchAll(/[{;]\s*([a-z][a-z-]*)\s*:/g))
    if (bcd.css.properties[name]?.__compat && !harmless.has(name)) judge(name, bcd.css.properties[name].__compat, index);
  return found;
}

const listed = (...patterns) =>
  execFileSync('git', ['ls-files', '-co', '--exclude-standard', '--', ...patterns], { encoding: 'utf8' })
    .trim()
    .split('\n');
const read = (path) => readFileSync(path, 'utf8');
const say = (path, { line, name, lacking }) => `${path}:${line}: ${name} is not in ${lacking}`;

const pages = listed('web/js/**/*.js', 'web/*.js');
const scripts = listed('*.mjs');
/** Methods of the libraries: uPlot's. */
const ofLibraries = ['destroy'];
const own = new Set([...ofLibraries, ...[...pages, ...scripts].flatMap((path) => [...ownNames(read(path))])]);
const findings = [
  ...pages.flatMap((path) => scriptFindings(read(path), everything, browsers, own).map((finding) => ({ path, ...finding }))),
  ...[...pages, ...scripts].flatMap((path) => scriptFindings(read(path), builtins, node, own).map((finding) => ({ path, ...finding }))),
  ...listed('web/*.css', 'web/**/*.css').flatMap((path) => styleFindings(read(path), browsers).map((finding) => ({ path, ...finding }))),
];
for (const { path, ...finding } of findings) console.log(say(path, finding));

// Planted functions have to be found.
const planted = [
  scriptFindings('const a = [2, 1].toSorted();', everything, browsers, own),
  scriptFindings('Object.groupBy([], String);', builtins, node, own),
  styleFindings('a { field-sizing: content }', browsers),
];
if (planted.some((found) => found.length !== 1)) console.log(`planted functions were not found: ${JSON.stringify(planted)}`);
process.exitCode = findings.length || planted.some((found) => found.length !== 1) ? 1 : 0;
