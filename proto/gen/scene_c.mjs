// Plain C structs for core, without JSON, of a checked description of documents (scene.h and scene.c of scene.json):
// enums, structs, defaults, and functions that free, copy and compare a whole document.
import { declaration, enumDeclaration, member, notice, objectInitializer } from './names.mjs';

const isOwned = (field) => ['list', 'map', 'patch'].includes(field.type);
/** Whether a struct of the object owns memory, itself or in an object in it. */
const owns = (object, objects) => object.fields.some((f) => isOwned(f) || (f.object !== undefined && owns(objects[f.object], objects)));

export function sceneHeader(description, prefix = 'scene') {
  let text = `#pragma once\n${notice}#include <stdbool.h>\n#include <stddef.h>\n#include <stdint.h>\n\n#include "core/math/vec.h"\n\n`;
  for (const [name, words] of Object.entries(description.enums)) text += enumDeclaration(name, words, prefix);
  const groups = [...Object.values(description.objects), ...Object.values(description.documents)];
  const mapped = new Set(groups.flatMap(({ fields }) => fields.filter((f) => f.type === 'map').map((f) => f.object)));
  for (const [name, object] of Object.entries(description.objects)) {
    text += `/* ${object.about} */\nstruct ${prefix}_${name} {\n${object.fields.map((f) => declaration(f, prefix)).join('')}};\n\n`;
    if (mapped.has(name)) text += `struct ${prefix}_${name}_entry {\n    char id[64];\n    struct ${prefix}_${name} value;\n};\n\n`;
    text += `extern const struct ${prefix}_${name} ${prefix}_${name}_default;\n\n`;
  }
  for (const [name, document] of Object.entries(description.documents)) {
    text += `/* ${document.about} */\nstruct ${name} {\n${document.fields.map((f) => declaration(f, prefix)).join('')}};\n\n`;
    text += `extern const struct ${name} ${name}_default;\n`;
    text += `/* Frees what the document owns; the struct itself is the caller's. */\nvoid ${name}_finish(struct ${name} *${name});\n`;
    text += `/* A copy that owns what it points to; to needs no ${name}_finish before. Aborts when there is no memory. */\nvoid ${name}_copy(struct ${name} *to, const struct ${name} *from);\n`;
    text += `/* Equal in every field; entries of lists and maps in the same order. */\nbool ${name}_equal(const struct ${name} *a, const struct ${name} *b);\n\n`;
  }
  return text;
}

/** The path from an element of a list or map to the object in it. */
const valueOf = (field) => (field.type === 'map' ? '.value' : '');

function finishBody(object, prefix, objects) {
  return object.fields
    .map((f) => {
      if (f.type === 'patch') return `    free(object->${f.name}_json);\n    object->${f.name}_json = NULL;\n`;
      if (!f.object) return '';
      const inner = owns(objects[f.object], objects);
      if (f.type === 'object') return inner ? `    ${prefix}_${f.object}_finish(&object->${f.name});\n` : '';
      const each = inner
        ? `    for (size_t i = 0; i < object->n_${f.name}; i++)\n        ${prefix}_${f.object}_finish(&object->${f.name}[i]${valueOf(f)});\n`
        : '';
      return `${each}    free(object->${f.name});\n    object->${f.name} = NULL;\n    object->n_${f.name} = 0;\n`;
    })
    .join('');
}

function copyBody(object, prefix, objects) {
  return (
    '    *to = *from;\n' +
    object.fields
      .map((f) => {
        if (f.type === 'patch') return `    to->${f.name}_json = from->${f.name}_json ? mem_copy_text(from->${f.name}_json) : NULL;\n`;
        if (!f.object) return '';
        const inner = owns(objects[f.object], objects);
        if (f.type === 'object') return inner ? `    ${prefix}_${f.object}_copy(&to->${f.name}, &from->${f.name});\n` : '';
        const array = `to->${f.name}`;
        let text = `    ${array} = from->n_${f.name} ? mem_new(from->n_${f.name} * sizeof *${array}) : NULL; /* at most ${f.max_items} */\n`;
        text += `    for (size_t i = 0; i < from->n_${f.name}; i++)${inner ? ' {' : ''}\n        ${array}[i] = from->${f.name}[i];\n`;
        if (inner) text += `        ${prefix}_${f.object}_copy(&${array}[i]${valueOf(f)}, &from->${f.name}[i]${valueOf(f)});\n    }\n`;
        return text;
      })
      .join('')
  );
}

/** Statements that return false where field differs between the structs a and b. */
function compareField(f, prefix) {
  const x = `a->${member(f)}`;
  const y = `b->${member(f)}`;
  const unequal = {
    id: `strcmp(${x}, ${y}) != 0`,
    vec3: `!(${x}.x == ${y}.x && ${x}.y == ${y}.y && ${x}.z == ${y}.z)`,
    size: `${x}[0] != ${y}[0] || ${x}[1] != ${y}[1]`,
    object: `!${prefix}_${f.object}_equal(&${x}, &${y})`,
    patch: `!${x} != !${y} || (${x} && strcmp(${x}, ${y}) != 0)`,
  };
  unequal.text = unequal.id;
  unequal.direction = unequal.vec3;
  if (f.type === 'list' || f.type === 'map') {
    const ids = f.type === 'map' ? `strcmp(${x}[i].id, ${y}[i].id) != 0 || ` : '';
    return (
      `    if (a->n_${f.name} != b->n_${f.name})\n        return false;\n    for (size_t i = 0; i < a->n_${f.name}; i++)\n` +
      `        if (${ids}!${prefix}_${f.object}_equal(&${x}[i]${valueOf(f)}, &${y}[i]${valueOf(f)}))\n            return false;\n`
    );
  }
  const is = unequal[f.type] ?? `${x} != ${y}`;
  if (f.nullable) return `    if (a->has_${f.name} != b->has_${f.name} || (a->has_${f.name} && (${is})))\n        return false;\n`;
  return `    if (${is})\n        return false;\n`;
}

const equalBody = (object, prefix) => `${object.fields.map((f) => compareField(f, prefix)).join('')}    return true;\n`;

export function sceneSource(description, prefix = 'scene') {
  const { objects } = description;
  let text = `${notice}#include "${prefix}.h"\n\n#include <stdlib.h>\n#include <string.h>\n\n#include "core/base/mem.h"\n\n`;
  for (const [name, object] of Object.entries(objects)) {
    const type = `struct ${prefix}_${name}`;
    text += `const ${type} ${prefix}_${name}_default = ${objectInitializer(object, prefix, objects)};\n\n`;
    if (owns(object, objects)) {
      text += `static void ${prefix}_${name}_finish(${type} *object)\n{\n${finishBody(object, prefix, objects)}}\n\n`;
      text += `static void ${prefix}_${name}_copy(${type} *to, const ${type} *from)\n{\n${copyBody(object, prefix, objects)}}\n\n`;
    }
    text += `static bool ${prefix}_${name}_equal(const ${type} *a, const ${type} *b)\n{\n${equalBody(object, prefix)}}\n\n`;
  }
  for (const [name, document] of Object.entries(description.documents)) {
    const type = `struct ${name}`;
    text += `const ${type} ${name}_default = ${objectInitializer(document, prefix, objects)};\n\n`;
    text += owns(document, objects)
      ? `void ${name}_finish(${type} *${name})\n{\n    ${type} *object = ${name};\n${finishBody(document, prefix, objects)}}\n\n`
      : `void ${name}_finish(${type} *${name})\n{\n    (void)${name};\n}\n\n`;
    text += `void ${name}_copy(${type} *to, const ${type} *from)\n{\n${copyBody(document, prefix, objects)}}\n\n`;
    text += `bool ${name}_equal(const ${type} *a, const ${type} *b)\n{\n${equalBody(document, prefix)}}\n\n`;
  }
  return text;
}
