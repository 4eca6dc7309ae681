// scene.h and scene.c: plain structs for core, without JSON.
import { declaration, enumDeclaration, notice, objectInitializer } from './names.mjs';

export function sceneHeader(scene) {
  let text = `#pragma once\n${notice}#include <stdbool.h>\n#include <stddef.h>\n#include <stdint.h>\n\n#include "core/math/vec.h"\n\n`;
  for (const [name, description] of Object.entries(scene.enums)) text += enumDeclaration(name, description, 'scene');
  const mapped = new Set();
  for (const group of [scene.objects, scene.documents])
    for (const object of Object.values(group)) for (const f of object.fields) if (f.type === 'map') mapped.add(f.object);
  for (const [name, object] of Object.entries(scene.objects)) {
    text += `/* ${object.about} */\nstruct scene_${name} {\n${object.fields.map((f) => declaration(f, 'scene')).join('')}};\n\n`;
    if (mapped.has(name)) text += `struct scene_${name}_entry {\n    char id[64];\n    struct scene_${name} value;\n};\n\n`;
    text += `extern const struct scene_${name} scene_${name}_default;\n\n`;
  }
  for (const [name, document] of Object.entries(scene.documents)) {
    text += `/* ${document.about} */\nstruct ${name} {\n${document.fields.map((f) => declaration(f, 'scene')).join('')}};\n\n`;
    text += `extern const struct ${name} ${name}_default;\n`;
    text += `/* Frees what the document owns; the struct itself is the caller's. */\nvoid ${name}_finish(struct ${name} *${name});\n\n`;
  }
  return text;
}

export function sceneSource(scene) {
  let text = `${notice}#include "scene.h"\n\n#include <stdlib.h>\n\n`;
  for (const [name, object] of Object.entries(scene.objects))
    text += `const struct scene_${name} scene_${name}_default = ${objectInitializer(object, 'scene', scene.objects)};\n`;
  for (const [name, document] of Object.entries(scene.documents)) {
    text += `const struct ${name} ${name}_default = ${objectInitializer(document, 'scene', scene.objects)};\n\n`;
    const owned = document.fields.filter((f) => f.type === 'map' || f.type === 'patch');
    const frees = owned.map((f) => f.type === 'map'
      ? `    free(${name}->${f.name});\n    ${name}->${f.name} = NULL;\n    ${name}->n_${f.name} = 0;\n`
      : `    free(${name}->${f.name}_json);\n    ${name}->${f.name}_json = NULL;\n`).join('');
    text += `void ${name}_finish(struct ${name} *${name})\n{\n${frees}}\n\n`;
  }
  return text;
}
