// Reads JSON strictly: a name twice in one object is an error, as readers differ on it (RFC 8259). As a program it checks files.
import { readFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';

const token = /[{}[\],:]|"(?:[^"\\]|\\.)*"|[^\s{}[\],:"]+/g;

/** JSON.parse that throws a SyntaxError, with the place, for an object with the same name twice. */
export function parseStrict(text) {
  const value = JSON.parse(text); // checks the syntax; the rest only looks at names
  const open = []; // {names, name} for each enclosing object, {index} for each array
  let last = '';
  for (const [word] of String(text).matchAll(token)) {
    const inner = open.at(-1);
    if (word === '{') open.push({ names: new Set() });
    else if (word === '[') open.push({ index: 0 });
    else if (word === '}' || word === ']') open.pop();
    else if (word === ',' && inner.names === undefined) inner.index++;
    else if (word === ':') {
      inner.name = JSON.parse(last);
      if (inner.names.has(inner.name)) throw new SyntaxError(`/${open.map((o) => o.name ?? o.index).join('/')} stands twice`);
      inner.names.add(inner.name);
    }
    last = word;
  }
  return value;
}

if (import.meta.url === pathToFileURL(process.argv[1] ?? '').href) {
  for (const file of process.argv.slice(2)) {
    try {
      parseStrict(readFileSync(file, 'utf8'));
    } catch (error) {
      console.log(`${file}: ${error.message}`);
      process.exitCode = 1;
    }
  }
}
