// The questions of a stranger in docs/testing.md, held to the project: node tests/ways.mjs [FILE]; prints what does not lead where it says, and fails then.
//
// A row is "| question | way | file |". A way through `make where WORDS="…"` has to print the file, one through a document has to be a path that names it.
import { execFileSync } from 'node:child_process';
import { existsSync, readFileSync } from 'node:fs';

const document = process.argv[2] ?? 'docs/testing.md';
const readme = readFileSync('README.md', 'utf8');
const [, section = ''] = readFileSync(document, 'utf8').split("## A stranger's questions");
const rows = [...section.matchAll(/^\| (.+?) \| (.+?) \| `([^`]+)` \|$/gm)];
const faults = rows.length < 5 ? [`${document}: fewer than five questions`] : [];
if (!readme.includes('make where')) faults.push('README.md does not tell of `make where`');
for (const [, question, way, file] of rows) {
  const [, words] = /make where WORDS="([^"]+)"/.exec(way) ?? [];
  const [, path] = /\(\.\.\/([^)#]+)\)/.exec(way) ?? [];
  if (!existsSync(file)) faults.push(`${document}: "${question}" leads to ${file}, which is not there`);
  if (words) {
    const said = execFileSync(process.execPath, ['docs/where.mjs', '-', words], { encoding: 'utf8' });
    if (!said.includes(file)) faults.push(`${document}: "${question}": make where WORDS="${words}" does not name ${file}`);
  } else if (path && !readme.includes(`(${path})`)) faults.push(`${document}: "${question}": README.md has no link to ${path}`);
  else if (!path) faults.push(`${document}: "${question}" has no way that can be followed`);
}
if (faults.length) console.log(faults.join('\n'));
process.exitCode = faults.length ? 1 : 0;
