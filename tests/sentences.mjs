// Holds proto/sentences.json to the C code: every sentence that one of the calls below is given is a row of the list, and every row is said somewhere.
// Prints what is wrong, a line each, and ends with 1 if there is anything. A new sentence gets a row: the code that it keeps, and names for its places.
//
//   node tests/sentences.mjs [FOLDER]     the project, or another tree with the same rules
import { readdirSync, readFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { sentencesOf } from '../proto/gen/sentences.mjs';

const top = process.argv[2] ?? join(dirname(fileURLToPath(import.meta.url)), '..');
/** The calls that say a sentence, which of their arguments is its format, what stands before it, and in which files. */
const says = {
  problems: [
    [/\bproblem_set\(/g, 4],
    [/\brefuse\(/g, 3, '%s ', /wire\/fields_read\.c$/],
  ],
  report: [
    [/\breport_add\(/g, 4],
    [/\breport_line_say\(/g, 1],
  ],
  fits: [
    [/\bSAY\(/g, 1, '', /core\/plan\/fit_words\.c$/],
    [/\bSAY_ALL\(/g, 0, '', /core\/plan\/fit_words\.c$/],
    [/\bSAY_ALL\(/g, 1, '', /core\/plan\/fit_words\.c$/],
  ],
};
const passesOn = new Set(['"%s"']); // a sentence that was written elsewhere

function* filesOf(folder) {
  for (const entry of readdirSync(folder, { withFileTypes: true }))
    if (entry.isDirectory()) yield* filesOf(join(folder, entry.name));
    else if (/\.(c|cc)$/.test(entry.name)) yield join(folder, entry.name);
}

/** The arguments of a call, from behind its bracket. @returns {string[]} */
function argumentsFrom(text, begin) {
  const all = [];
  let depth = 1;
  let from = begin;
  for (let at = begin; depth > 0 && at < text.length; at++) {
    const quote = text[at];
    if (quote === '"' || quote === "'") {
      for (at++; text[at] !== quote; at++) if (text[at] === '\\') at++;
    } else if ('([{'.includes(quote)) depth++;
    else if (')]}'.includes(quote)) depth--;
    if (depth === 0 || (depth === 1 && quote === ',')) {
      all.push(text.slice(from, at));
      from = at + 1;
    }
  }
  return all;
}

/** The texts in an argument, each of adjacent strings and PRI words; a conditional has two. @returns {string[]} as JSON of what printf is given, with %PRI… */
function formatsIn(argument) {
  const runs = argument.match(/(?:"(?:[^"\\]|\\.)*"\s*(?:PRI\w+\s*)?)+/g) ?? [];
  return runs.map((run) => {
    const pieces = [...run.matchAll(/"((?:[^"\\]|\\.)*)"|(PRI\w+)/g)].map(([, text, word]) => word ?? text.replaceAll("\\'", "'"));
    return `"${pieces.join('')}"`;
  });
}

const { about, ...groups } = JSON.parse(readFileSync(join(top, 'proto/sentences.json'), 'utf8'));
let n = 0;
const wrong = (words) => {
  console.log(words);
  n++;
};
const files = ['core', 'server'].flatMap((folder) => [...filesOf(join(top, folder))]).map((path) => [path, readFileSync(path, 'utf8')]);
for (const [group, calls] of Object.entries(says)) {
  const listed = new Map(sentencesOf({ [group]: groups[group] }).map(({ code, format }) => [format.replace(/" (PRI\w+) "/g, '$1'), code]));
  const said = new Set();
  for (const [call, formatAt, before = '', where = /./] of calls)
    for (const [path, text] of files.filter(([one]) => where.test(one)))
      for (const found of text.matchAll(call)) {
        const given = argumentsFrom(text, found.index + found[0].length);
        for (const own of formatsIn(given[formatAt] ?? '')) {
          const format = `"${before}${own.slice(1)}`;
          said.add(format);
          if (listed.has(format) || passesOn.has(format)) continue;
          const line = text.slice(0, found.index).split('\n').length;
          wrong(`${path.slice(top.length + 1)}:${line}: ${format} is not in proto/sentences.json, ${group}`);
        }
      }
  for (const [format, code] of listed) if (!said.has(format)) wrong(`proto/sentences.json, ${group}: nothing says ${code}, ${format}`);
}
// Only reasons without places are listed; such a one may stand anywhere in the code.
const code = files.map(([, text]) => text.replace(/"\s*\n\s*"/g, '')).join('');
for (const [name, text] of groups.reasons ?? [])
  if (!code.includes(`"${text}"`)) wrong(`proto/sentences.json, reasons: nothing says ${name}, "${text}"`);
process.exitCode = n ? 1 : 0;
