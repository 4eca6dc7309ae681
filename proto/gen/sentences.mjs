// sentences_gen.h and sentences_gen.c of sentences.json: every sentence as the C code says it, with its code and its places.
import { notice } from './names.mjs';

const place = /\{([a-z][a-z0-9_]*)(?: (%[^}]*))?\}/g;
const types = {
  s: 'TEXT',
  d: 'INT',
  u: 'UINT',
  x: 'UINT',
  X: 'UINT',
  ld: 'LONG',
  lu: 'ULONG',
  lld: 'LLONG',
  llu: 'ULLONG',
  zu: 'SIZE',
  PRIu32: 'UINT32',
  PRIu64: 'UINT64',
  f: 'FIXED',
  g: 'GENERAL',
};

/** @returns {{name: string, format: string, type: string, precision: number}[]} the places of a text in their order; precision -1: none is given */
export function placesOf(text) {
  return [...text.matchAll(place)].map(([, name, format = '%s']) => {
    const [, precision, type] = /^%0?\d*(?:\.(\d+))?(\w+)$/.exec(format) ?? [];
    if (!types[type]) throw new Error(`sentences.json: a place of "${text}" has the format ${format}`);
    return { name, format, type: types[type], precision: precision === undefined ? -1 : Number(precision) };
  });
}

/** The text as a string of C: in front of PRIu64 the string ends. */
const formatOf = (text) => JSON.stringify(text.replace(place, (_, name, format = '%s') => format)).replace(/%(PRI\w+)/g, '%" $1 "');

/** All sentences, whatever they are about. Throws where one code has two texts, or one text two codes. */
export function sentencesOf({ about, ...groups }) {
  const rows = Object.values(groups).flat();
  const texts = new Map();
  for (const [code, text] of rows) {
    if (!/^[a-z0-9]+(-[a-z0-9]+)*$/.test(code) || code.length > 47) throw new Error(`sentences.json: "${code}" is no code`);
    const plain = text.replace(place, '{$1}');
    if ((texts.get(code) ?? plain) !== plain) throw new Error(`sentences.json: the code ${code} has two texts`);
    texts.set(code, plain);
  }
  if (new Set(rows.map(([, text]) => formatOf(text))).size !== rows.length) throw new Error('sentences.json: a text is there twice');
  return rows.map(([code, text]) => ({ code, text, format: formatOf(text), places: placesOf(text) }));
}

export function sentencesHeader(description) {
  const most = Math.max(...sentencesOf(description).map(({ places }) => places.length));
  return `#pragma once
${notice}#include <stddef.h>

enum sentence_type {
${[...new Set(Object.values(types))].map((type) => `    SENTENCE_${type},`).join('\n')}
};
enum { SENTENCE_MAX_PLACES = ${most} };
struct sentence_place {
    const char *name;
    enum sentence_type type;
    int precision; /* of the format; -1: not given */
};
struct sentence {
    const char *code, *format;
    int n_places;
    struct sentence_place places[SENTENCE_MAX_PLACES];
};
extern const struct sentence sentences[];
extern const size_t n_sentences;
`;
}

export function sentencesSource(description) {
  const row = ({ code, format, places }) =>
    `    { "${code}",\n      ${format},\n      ${places.length}, { ${places.map((p) => `{ "${p.name}", SENTENCE_${p.type}, ${p.precision} }`).join(', ') || '{ NULL, SENTENCE_TEXT, -1 }'} } },`;
  return `${notice}#include "sentences_gen.h"

#include <inttypes.h>

const struct sentence sentences[] = {
${sentencesOf(description).map(row).join('\n')}
};
const size_t n_sentences = sizeof sentences / sizeof sentences[0];
`;
}

export function sentencesSection({ about, ...groups }, escape) {
  const table = ([group, rows]) =>
    `<h3>${group}</h3>\n<table><thead><tr><th>Code</th><th>Sentence</th></tr></thead><tbody>\n${rows
      .map(([code, text]) => `<tr id="sentence-${code}"><td><code>${code}</code></td><td>${escape(text)}</td></tr>`)
      .join('\n')}\n</tbody></table>\n`;
  return `<h2 id="sentences">Sentences</h2>\n<p>${escape(about)}</p>\n${Object.entries(groups).map(table).join('')}`;
}
