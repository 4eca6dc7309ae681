// Finds comments that begin in the middle: their first word is Of, By, As, What, Who, Whose, From, or "The same", so that a reader must look elsewhere for
// the subject. Say what the thing is or does: "Distance of the eye ...", "Returns the row ...", "Like x, for y". Prints PATH:LINE: BEGINNING.
//
//   node tests/comments.mjs FILE...
import { readFileSync } from 'node:fs';

const first = String.raw`(?:Of|By|As|What|Who|Whose|From|The same)\b`;
// /* */ anywhere, and // unless it goes on a line of // above it; neither in a string
const begins = new RegExp(String.raw`(?<=^|[\s;,{}()])(?:/\*+\s*(?:\n\s*\*\s+)?|//[ /!]*)(${first}[^\n]{0,60})`, 'gm');

let n = 0;
for (const path of process.argv.slice(2)) {
  const text = readFileSync(path, 'utf8');
  for (const found of text.matchAll(begins)) {
    const before = text.slice(0, found.index).split('\n');
    const isLine = found[0].startsWith('//');
    if (isLine && /^\s*\/\//.test(before.at(-2) ?? '') && !before.at(-1).trim()) continue;
    if (isLine && (before.at(-1).match(/['"`]/g) ?? []).length % 2) continue;
    console.log(`${path}:${before.length}: ${found[1]}`);
    n++;
  }
}
process.exitCode = n ? 1 : 0;
