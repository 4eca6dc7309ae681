// problem_gen.h and problem_gen.c of problems.json: the types of problems with their words, titles and HTTP statuses.
import { notice, upper } from './names.mjs';

const constant = (problem) => `PROBLEM_${upper(problem.word)}`;

export function problemHeader(description) {
  const rows = description.problems.map((p) => `    ${constant(p)}, /* ${p.status} ${p.title} */`).join('\n');
  return (
    `#pragma once\n${notice}\nenum problem_type {\n    PROBLEM_NONE,\n${rows}\n    PROBLEM_N_TYPES\n};\n\n` +
    'struct problem_words {\n    const char *word, *title;\n    int status; /* HTTP */\n};\nextern const struct problem_words problem_types[PROBLEM_N_TYPES];\n'
  );
}

export function problemSource(description) {
  const rows = description.problems
    .map((p) => `    [${constant(p)}] = { ${JSON.stringify(p.word)}, ${JSON.stringify(p.title)}, ${p.status} },`)
    .join('\n');
  return `${notice}#include "problem_gen.h"\n\nconst struct problem_words problem_types[PROBLEM_N_TYPES] = {\n    [PROBLEM_NONE] = { "none", "No problem", 200 },\n${rows}\n};\n`;
}
