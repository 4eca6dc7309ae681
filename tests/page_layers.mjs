// Holds the page's imports to tests/page_layers.txt: node tests/page_layers.mjs [ROOT]; prints each one that breaks a rule, and fails then.
import { existsSync, readFileSync, readdirSync } from 'node:fs';
import { dirname, join, normalize } from 'node:path';
import { full } from 'acorn-walk';
import { parse } from 'acorn';

const root = process.argv[2] ?? '.';
const rules = 'tests/page_layers.txt';
const top = 'web/js';

/** @returns {Map<string, string[]>} folder: what it may import */
function readRules(text) {
  const lines = text.split('\n').map((line) => line.replace(/#.*/, '').trim());
  return new Map(lines.filter(Boolean).map((line) => [line.split(':')[0], line.split(':')[1].split(/\s+/).filter(Boolean)]));
}

const scripts = (folder) =>
  readdirSync(join(root, folder), { withFileTypes: true }).flatMap((entry) =>
    entry.isDirectory() ? scripts(`${folder}/${entry.name}`) : entry.name.endsWith('.js') ? [`${folder}/${entry.name}`] : [],
  );

/** The paths that a script imports, at once or later, with their lines. */
function importsOf(path) {
  const found = [];
  full(parse(readFileSync(join(root, path), 'utf8'), { ecmaVersion: 'latest', sourceType: 'module', locations: true }), (at) => {
    if (at.source?.type === 'Literal') found.push({ line: at.loc.start.line, path: normalize(join(dirname(path), at.source.value)) });
  });
  return found.filter((other) => other.path.startsWith(`${top}/`));
}

/** The folder of a rule: features/NAME, or the first below web/js; '.' for what stands there. */
function layerOf(path) {
  const [first, ...more] = path.slice(top.length + 1).split('/');
  if (!more.length) return '.';
  return first === 'features' && more.length > 1 ? `features/${more[0]}` : first;
}

const allowed = readRules(readFileSync(rules, 'utf8'));
const used = new Set();
const faults = [];
let n = 0;
for (const path of scripts(top))
  for (const { line, path: other } of importsOf(path)) {
    n++;
    const [from, to] = [layerOf(path), layerOf(other)];
    if (!existsSync(join(root, other))) faults.push(`${path}:${line}: ${other} is not there`);
    if (from === to) continue;
    const own = allowed.get(from);
    if (!own && !from.startsWith('features/')) faults.push(`${path}:${line}: ${from} has no line in ${rules}`);
    const named = [...(own ?? []), ...(from.startsWith('features/') ? (allowed.get('features/*') ?? []) : [])];
    used.add(`${from} ${to}`);
    if (!named.includes(to) && !(to.startsWith('features/') && named.includes('features/*')))
      faults.push(`${path}:${line}: ${from} may not import ${to} (${other})`);
  }
if (n < 2) faults.push(`${top}: no imports found`);
if (root === '.')
  for (const [from, others] of allowed)
    for (const to of others)
      if (from.startsWith('features/') && to.startsWith('features/') && !to.includes('*') && !used.has(`${from} ${to}`))
        faults.push(`${rules}: no such import any more: ${from}: ${to}`);
for (const fault of faults) console.log(fault);
process.exitCode = faults.length ? 1 : 0;
