// gl_shaders.h and gl_shaders.c: the shaders of core/render/gl/shaders as text, and the names of their uniforms.
import { readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
const notice = '/* Generated from core/render/gl/shaders; change it there. */\n';

// { name: 'smooth_vert', text }, of every .vert and .frag; a line #include "file" becomes that file.
export function readShaders(folder) {
  const read = (name) => readFileSync(join(folder, name), 'utf8').replace(/^#include "(.*)"$/gm, (_, file) => read(file).trimEnd());
  return readdirSync(folder)
    .filter((name) => /\.(vert|frag)$/.test(name))
    .sort()
    .map((name) => ({ name: name.replace('.', '_'), text: read(name) }));
}

function uniformNames(shaders) {
  const names = shaders.flatMap(({ text }) => [...text.matchAll(/^uniform \w+ (\w+)(\[\d+\])?;/gm)].map((match) => match[1]));
  return [...new Set(names)].sort();
}

export function shadersHeader(shaders) {
  const uniforms = uniformNames(shaders)
    .map((name) => ` \\\n    X(${name})`)
    .join('');
  const texts = shaders.map(({ name }) => `extern const char gl_shader_${name}[];\n`).join('');
  return (
    `#pragma once\n${notice}\n/* Every name that some shader has a uniform of. */\n#define GL_UNIFORMS(X)${uniforms}\n\n` +
    `/* Without #version; ends with a zero. */\n${texts}`
  );
}

// Numbers, as a string literal of C may not be as long as a shader.
function bytes(text) {
  const all = [...Buffer.from(text, 'utf8'), 0];
  if (all.some((byte) => byte > 126)) throw new Error('a shader is written in ASCII');
  const rows = [];
  for (let at = 0; at < all.length; at += 24) rows.push(`    ${all.slice(at, at + 24).join(', ')},`);
  return rows.join('\n');
}

export function shadersSource(shaders) {
  return (
    `${notice}#include "gl_shaders.h"\n` +
    shaders.map(({ name, text }) => `\nconst char gl_shader_${name}[] = {\n${bytes(text)}\n};\n`).join('')
  );
}
