// Writes the code of trial.json, a description of the tests' own, into the folder named on the command line, by the
// generator of proto/: trial.h, trial.c (structs) and trial_gen.h, trial_gen.c (field tables).
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { checkedDocuments } from '../../proto/gen/check.mjs';
import { notice } from '../../proto/gen/names.mjs';
import { sceneHeader, sceneSource } from '../../proto/gen/scene_c.mjs';
import { tablesHeader, tablesSource } from '../../proto/gen/wire_c.mjs';

const trial = checkedDocuments(JSON.parse(readFileSync(new URL('trial.json', import.meta.url), 'utf8')));
const out = process.argv[2];
mkdirSync(out, { recursive: true });
const write = (name, text) => writeFileSync(join(out, name), text);

write('trial.h', sceneHeader(trial, 'trial'));
write('trial.c', sceneSource(trial, 'trial'));
write('trial_gen.h', `#pragma once\n${notice}#include "trial.h"\n#include "server/wire/fields.h"\n\n${tablesHeader(trial, 'trial')}`);
write('trial_gen.c', `${notice}#include "trial_gen.h"\n\n#include <stddef.h>\n\n${tablesSource(trial, 'trial')}`);
