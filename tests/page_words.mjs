// Finds what a person reads outside of the tables of words: node tests/page_words.mjs [ROOT]; prints each, and fails then. Strings that only look like
// words, and files whose sentences are not in a table yet, stand in tests/page_words.txt. Of the tables: each key is read somewhere, none that is read is
// missing, each place gets a value, and no module that is loaded at once imports one of what is loaded later.
import { existsSync, readFileSync, readdirSync } from 'node:fs';
import { basename, dirname, join, normalize } from 'node:path';
import { ancestor } from 'acorn-walk';
import { parse } from 'acorn';
import { pathToFileURL } from 'node:url';

const top = 'web/js';
const entry = `${top}/main.js`;
const mechanism = `${top}/parts/sentences.js`;
const readAttributes = ['title', 'aria-label', 'aria-description', 'aria-valuetext', 'aria-roledescription', 'placeholder', 'alt', 'label'];
const units =
  /\b(mm|cm|dm|Gy|HU|px|keV|MeV|eV|ppm|ug|ml|kg|min|ms|kB|MB|GB|SUV|Beamroom|CT|MR|PET|DICOM|RTSTRUCT|SEG|NIfTI|NRRD|CSV|PNG|JSON|PDF|GLB|PLY|STL|NURBS|IsoE|fps|[LRAPSI]{2,3}|RBE|CBE|OER)\b|&\w+;/g;

/** "path", "path text": files and strings. @returns {{files: Set<string>, strings: Map<string, string[]>}} */
function readAllowed(text) {
  const lines = text.split('\n').filter((line) => line && !line.startsWith('#'));
  const strings = new Map();
  for (const line of lines.filter((one) => one.includes(': '))) {
    const at = line.indexOf(': ');
    strings.set(line.slice(0, at), [...(strings.get(line.slice(0, at)) ?? []), line.slice(at + 2)]);
  }
  return { files: new Set(lines.filter((line) => !line.includes(': '))), strings };
}

const scriptsIn = (root, folder) =>
  readdirSync(join(root, folder), { withFileTypes: true }).flatMap((one) =>
    one.isDirectory() ? scriptsIn(root, `${folder}/${one.name}`) : one.name.endsWith('.js') ? [`${folder}/${one.name}`] : [],
  );

/** True of letters other than units, and letters that stand alone (L R A P S I, keys, axes). */
export const isRead = (text) => /\p{L}\p{L}/u.test(text.replace(units, ' '));
/** A name for the program (a class, a field, an icon) is one word without a capital at its beginning. */
const isSentence = (text) => isRead(text) && (/\p{L}\p{L}+[,:;.]? [\p{L}({]/u.test(text) || /^\p{Lu}\p{Ll}+([ .,:…]|$)/u.test(text.trim()));

/** Where the pieces of a template and its values stand. @returns {{texts: [string, number][], values: string[]}} read texts with their offsets; of each value its attribute, '' for text */
function placesOf(quasis) {
  const texts = [];
  const values = [];
  let [state, attribute, quote, name] = ['text', '', '', ''];
  for (const { value, start } of quasis) {
    const html = value.raw;
    let from = 0;
    const take = (to) => (state === 'text' || readAttributes.includes(attribute)) && texts.push([html.slice(from, to), start + from]);
    for (let at = 0; at < html.length; at++) {
      const c = html[at];
      if (state === 'text' && c === '<' && /[a-z/!]/i.test(html[at + 1] ?? '')) {
        take(at);
        [state, name, attribute] = ['tag', '', ''];
      } else if (state === 'tag') {
        if (c === '>') [state, from] = ['text', at + 1];
        else if (c === '=') [attribute, name, state, quote, from] = [name, '', 'value', '', at + 1];
        else name = /[\s/<]/.test(c) ? '' : name + c;
      } else if (state === 'value') {
        if (!quote && (c === '"' || c === "'")) [quote, from] = [c, at + 1];
        else if (quote ? c === quote : /[\s>]/.test(c)) {
          take(at);
          [state, attribute, from] = [c === '>' ? 'text' : 'tag', '', at + 1];
        }
      }
    }
    if (state !== 'tag') take(html.length);
    values.push(state === 'value' ? attribute : state === 'tag' ? '(tag)' : '');
  }
  return { texts, values };
}

const skipped =
  /^(\$|matchMedia|startsWith|endsWith|includes|split|join|querySelector|querySelectorAll|closest|matches|import|setAttribute|getAttribute|styled|error|warn|debug)$/;
/** True of a text that never reaches a person: a key of an event, a selector, a name that is compared, an error of the program. */
function isForProgram(parents) {
  const [own, parent, above] = parents;
  if (parent.type === 'BinaryExpression' && parent.operator !== '+') return true;
  if (parent.type === 'Property' && parent.key === own) return true;
  if (/^beamroom /.test(own.value ?? '')) return true; // what the browser keeps
  if (parent.type === 'MemberExpression' || parent.type === 'SwitchCase' || parent.source === own) return true;
  if (parents.some(({ callee }) => skipped.test(callee?.property?.name ?? callee?.name ?? ''))) return true;
  return parent.type === 'ArrayExpression' && above?.type === 'MemberExpression'; // ['one', 'two'].includes(…)
}

/** Through values alone (a ? b : c, a + b, a ?? b, a piece of a text), not through an argument. */
const isValue = (parents, end) => {
  for (let at = 0; parents[at] !== end; at++) {
    const { type, operator, test } = parents[at + 1];
    if (!/^(Conditional|Logical|Binary)Expression$|^TemplateLiteral$/.test(type) || test === parents[at]) return false;
    if (type === 'BinaryExpression' && operator !== '+') return false;
  }
  return true;
};

/** @returns {{line: number, text: string}[]} what a person reads in a file */
function readIn(source, tree) {
  const found = [];
  const lineOf = (offset) => source.slice(0, offset).split('\n').length;
  const say = (offset, text) => found.push({ line: lineOf(offset), text: text.trim().replace(/\s+/g, ' ') });
  const attributes = new Map(); // of a value in a template, its attribute
  const isTemplate = (node) => node.type === 'TaggedTemplateExpression' && /^(html|svg)$/.test(node.tag.name);
  ancestor(tree, {
    TaggedTemplateExpression(node) {
      if (!isTemplate(node)) return;
      const { texts, values } = placesOf(node.quasi.quasis);
      for (const [text, at] of texts) if (isRead(text)) say(at + text.search(/\S/), text);
      for (const [n, value] of node.quasi.expressions.entries()) attributes.set(value, values[n]);
    },
  });
  const literal = (node, text, ancestors) => {
    if (!isRead(text)) return;
    const parents = [...ancestors].reverse();
    if (isForProgram(parents)) return;
    const value = parents.find((one) => attributes.has(one));
    const template = parents.findIndex(isTemplate);
    const attribute = value && parents.indexOf(value) < template ? attributes.get(value) : null;
    const isShown = attribute === '' || readAttributes.includes(attribute);
    if (attribute !== null && !isShown && !/^[@.]/.test(attribute) && isValue(parents, value)) return;
    if ((isShown && isValue(parents, value)) || isSentence(text)) say(node.start, text);
  };
  ancestor(tree, {
    Literal: (node, _, ancestors) => typeof node.value === 'string' && literal(node, node.value, ancestors),
    TemplateLiteral(node, _, ancestors) {
      if (ancestors.at(-2)?.type === 'TaggedTemplateExpression' && isTemplate(ancestors.at(-2))) return;
      const whole = node.quasis.map(({ value }) => value.cooked).join('{}');
      literal(node, whole, ancestors);
    },
  });
  return found;
}

/** Faults of the way a text is read, where that can be seen: a text without places is no function, one with places gets a value for each. */
function misread(text, ancestors) {
  let at = ancestors.length - 1;
  while (/^(Conditional|Logical)Expression$/.test(ancestors[at - 1]?.type) && ancestors[at - 1].test !== ancestors[at]) at--;
  const call = ancestors[at - 1];
  if (call?.type !== 'CallExpression' || call.callee !== ancestors[at]) return '';
  const places = new Set([...text.matchAll(/\{([^}|]*)[^}]*\}/g)].map(([, name]) => name));
  if (!places.size) return 'has no places, and is called';
  const [values] = call.arguments;
  if (values?.type !== 'ObjectExpression' || values.properties.some(({ type }) => type !== 'Property')) return '';
  const lacking = [...places].filter((name) => !values.properties.some(({ key }) => (key.name ?? key.value) === name));
  return lacking.length ? `gets no value for ${lacking.join(', ')}` : '';
}

/** The table of a file that has one: by key its line and its text. @returns {{group: string, keys: Map<string, number>, english: Map<string, string>}|null} */
function tableOf(tree) {
  let table = null;
  ancestor(tree, {
    CallExpression({ callee, arguments: [group, english] }) {
      if (callee.name !== 'sentences' || english?.type !== 'ObjectExpression') return;
      const rows = english.properties.map(({ key, value, loc }) => ({
        key: key.name ?? key.value,
        text: value.value,
        line: loc.start.line,
      }));
      table = {
        group: group.value,
        keys: new Map(rows.map(({ key, line }) => [key, line])),
        english: new Map(rows.map(({ key, text }) => [key, text])),
      };
    },
  });
  return table;
}

/** The scripts of a tree, parsed, their tables, and what is left out. */
function readPage(root) {
  const scripts = scriptsIn(root, top).map((path) => {
    const source = readFileSync(join(root, path), 'utf8');
    return { path, source, tree: parse(source, { ecmaVersion: 'latest', sourceType: 'module', locations: true }) };
  });
  const found = scripts.filter(({ path }) => path !== mechanism).map(({ path, tree }) => [path, tableOf(tree)]);
  const rules = join(root, 'tests/page_words.txt');
  return {
    scripts: new Map(scripts.map((script) => [script.path, script])),
    tables: new Map(found.filter(([, table]) => table)),
    allowed: readAllowed(existsSync(rules) ? readFileSync(rules, 'utf8') : ''),
  };
}

/** Imports of a script that come at once, with the names there and here. @returns {{path: string, names: [string, string][]}[]} */
const importsOf = ({ path, tree }) =>
  tree.body
    .filter(({ source }) => source)
    .map(({ source, specifiers = [] }) => ({
      path: normalize(join(dirname(path), source.value)),
      names: specifiers.map(({ imported, local }) => [imported?.name ?? '*', local.name]),
    }));

/** The group of a table is its folder; what is loaded later has a name behind it. */
function groupFaults({ tables }) {
  const faults = [];
  const groups = new Map();
  for (const [path, { group }] of tables) {
    const own =
      dirname(path)
        .slice(top.length + 1)
        .replace(/^features\//, '')
        .replaceAll('/', '.') || 'page';
    const isRight = basename(path) === 'words.js' ? group === own : path.endsWith('_words.js') && group.startsWith(`${own}.`);
    if (!isRight) faults.push(`${path}: its group is "${group}", not "${own}" or, for ..._words.js, "${own}.…"`);
    if (groups.has(group)) faults.push(`${path}: ${groups.get(group)} has the group "${group}"`);
    groups.set(group, path);
  }
  return faults;
}

function keyFaults({ scripts, tables }) {
  const faults = [];
  const used = new Map([...tables.keys()].map((path) => [path, new Set()]));
  const look = (script, other, own) => {
    const { keys, english } = tables.get(other);
    ancestor(script.tree, {
      MemberExpression({ object, property, computed, loc }, _, ancestors) {
        if (object.type !== 'Identifier' || object.name !== own) return;
        const why = !computed && keys.has(property.name) ? misread(english.get(property.name), ancestors) : '';
        if (why) faults.push(`${script.path}:${loc.start.line}: "${property.name}" of ${other} ${why}`);
        const read = !computed ? [property.name] : property.type === 'Literal' ? [property.value] : [...keys.keys()];
        for (const key of read) {
          used.get(other).add(key);
          if (!keys.has(key)) faults.push(`${script.path}:${loc.start.line}: ${other} has no "${key}"`);
        }
      },
    });
  };
  for (const script of scripts.values())
    for (const { path, names } of importsOf(script)) if (tables.has(path)) for (const [, own] of names) look(script, path, own);
  for (const [path, { keys }] of tables)
    for (const [key, line] of keys) if (!used.get(path).has(key)) faults.push(`${path}:${line}: nothing reads "${key}"`);
  return faults;
}

function laterFaults({ scripts, tables }) {
  const faults = [];
  const atOnce = new Set();
  const visit = (path, from) => {
    if (tables.get(path)?.group.includes('.')) faults.push(`${from} is loaded at once, and imports ${path}`);
    if (atOnce.has(path) || !scripts.has(path)) return;
    atOnce.add(path);
    for (const { path: other } of importsOf(scripts.get(path))) visit(other, path);
  };
  visit(entry, '');
  return faults;
}

/** Texts that stand outside of tables, without the strings that are left out. @returns {Map<string, {line: number, text: string}[]>} by path */
function outsideOf({ scripts, tables, allowed }) {
  const own = [...scripts.values()].filter(({ path }) => !tables.has(path) && path !== mechanism);
  return new Map(
    own.map(({ path, source, tree }) => [path, readIn(source, tree).filter(({ text }) => !allowed.strings.get(path)?.includes(text))]),
  );
}

function textFaults(page) {
  const { scripts, tables, allowed } = page;
  const rules = 'tests/page_words.txt';
  const faults = [];
  for (const [path, found] of outsideOf(page)) {
    if (!allowed.files.has(path))
      faults.push(...found.map(({ line, text }) => `${path}:${line}: stands outside of a table of words: ${text}`));
    else if (!found.length) faults.push(`${rules}: ${path} has its sentences in a table: take it off`);
  }
  for (const [path, strings] of allowed.strings) {
    const { source = '', tree } = scripts.get(path) ?? {};
    const found = tree ? readIn(source, tree) : [];
    for (const text of strings) if (!found.some((one) => one.text === text)) faults.push(`${rules}: ${path} has no "${text}" any more`);
  }
  for (const path of allowed.files) if (!scripts.has(path) || tables.has(path)) faults.push(`${rules}: ${path} is not there, or a table`);
  return faults;
}

if (import.meta.url === pathToFileURL(process.argv[1]).href) {
  const page = readPage(process.argv[2] ?? '.');
  const faults = [...groupFaults(page), ...keyFaults(page), ...laterFaults(page), ...textFaults(page)];
  if (faults.length) console.log(faults.join('\n'));
  process.exitCode = faults.length ? 1 : 0;
}
