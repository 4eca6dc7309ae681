// Names those of the modules that do not parse: node --experimental-vm-modules parse.mjs FILE...
import { readFileSync } from 'node:fs';
import { SourceTextModule } from 'node:vm';

for (const file of process.argv.slice(2)) {
  try {
    new SourceTextModule(readFileSync(file, 'utf8'), { identifier: file });
  } catch (error) {
    if (!(error instanceof SyntaxError)) throw error;
    console.log(file);
    process.exitCode = 1;
  }
}
