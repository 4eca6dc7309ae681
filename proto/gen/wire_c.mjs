// Field tables for server/wire/fields.h: of documents (scene and view), and of messages with their structs (wire_gen.h
// and wire_gen.c).
import { declaration, enumDeclaration, lower, member, notice, objectInitializer, textBytes, upper } from './names.mjs';

const structOf = (message) => `message_${lower(message.name)}`;

/** Declarations of the tables of a checked description of documents. */
export function tablesHeader(description, prefix) {
  let text = '';
  for (const name of Object.keys(description.enums)) text += `extern const struct field_words ${prefix}_${name}_words;\n`;
  for (const name of Object.keys(description.references)) text += `extern const struct field_reference ${prefix}_${name}_reference;\n`;
  for (const name of Object.keys(description.objects)) text += `extern const struct field_object ${prefix}_${name}_object;\n`;
  for (const name of Object.keys(description.documents)) text += `extern const struct field_object ${name}_object;\n`;
  return text;
}

const rightsHeader = `
/* Rights of each role: 1 << right for each one that it has. */
extern const unsigned wire_role_rights[];
/* The routes of rooms, each with its right; the last one has no method. */
struct wire_room_route {
    const char *method, *path;
    enum wire_right right;
};
extern const struct wire_room_route wire_room_routes[];
`;

function rightsSource({ enums }, roomRoutes) {
  const bit = (right) => `1U << WIRE_RIGHT_${upper(right)}`;
  const roles = enums.member_role.values.map(
    ([role, , rights]) => `    [WIRE_MEMBER_ROLE_${upper(role)}] = ${rights.map(bit).join(' | ')},`,
  );
  const routes = roomRoutes.map(({ method, path, right }) => `    { "${method}", "${path}", WIRE_RIGHT_${upper(right)} },`);
  return (
    `\nconst unsigned wire_role_rights[] = {\n${roles.join('\n')}\n};\n` +
    `const struct wire_room_route wire_room_routes[] = {\n${routes.join('\n')}\n    { NULL, NULL, WIRE_RIGHT_LOOK },\n};\n`
  );
}

export function wireHeader(scene, messages) {
  let text = `#pragma once\n${notice}#include <stdint.h>\n\n#include "scene.h"\n#include "server/wire/fields.h"\n\n`;
  text += `enum { WIRE_PROTOCOL = ${messages.version}, WIRE_MAX_CLIENT_BYTES = ${messages.max_client_bytes} };\n\n`;
  for (const [name, description] of Object.entries(messages.enums)) {
    text += enumDeclaration(name, description, 'wire');
    text += `extern const struct field_words wire_${name}_words;\n\n`;
  }
  text += `${tablesHeader(scene, 'scene')}\n`;
  for (const message of messages.messages)
    text += `/* ${message.from}: ${message.about} */\nstruct ${structOf(message)} {\n${message.fields.map((f) => declaration(f, 'wire')).join('')}};\n\n`;
  text += `enum message_type {\n${messages.messages.map((m) => `    MESSAGE_${upper(m.name)},`).join('\n')}\n    MESSAGE_N_TYPES\n};\n\n`;
  text += `struct message {\n    enum message_type type;\n    union {\n${messages.messages.map((m) => `        struct ${structOf(m)} ${lower(m.name)};`).join('\n')}\n    };\n};\n\n`;
  text += `struct message_description {\n    const char *name;\n    bool is_from_client;\n    size_t offset; /* of its struct in struct message */\n    const struct field_object *object;\n${messages.enums.right ? '    enum wire_right right; /* of a message from the page */\n' : ''}};\n`;
  text += 'extern const struct message_description message_descriptions[MESSAGE_N_TYPES];\n';
  if (messages.enums.member_role) text += rightsHeader;
  return text;
}

const typeNames = {
  bool: 'BOOL',
  number: 'NUMBER',
  integer: 'INTEGER',
  enum: 'ENUM',
  color: 'COLOR',
  id: 'ID',
  text: 'TEXT',
  vec3: 'VEC3',
  direction: 'DIRECTION',
  size: 'SIZE',
  object: 'OBJECT',
  list: 'LIST',
  map: 'MAP',
  patch: 'PATCH',
  json: 'JSON',
};

function fieldRow(f, structName, prefix) {
  const parts = [`.name = "${f.name}"`, `.type = FIELD_${typeNames[f.type]}`, `.offset = offsetof(struct ${structName}, ${member(f)})`];
  if (f.nullable) parts.push('.is_nullable = true');
  if (f.nullable && f.type !== 'json') parts.push('.has_flag = true', `.has_offset = offsetof(struct ${structName}, has_${f.name})`);
  if (f.required) parts.push('.is_required = true');
  if (f.min !== undefined) parts.push(`.min = ${f.min}`);
  if (f.max !== undefined) parts.push(`.max = ${f.max}`);
  if (f.type === 'enum') parts.push(`.words = &${prefix}_${f.enum}_words`);
  if (f.object) parts.push(`.object = &${prefix}_${f.object}_object`);
  if (f.names) parts.push(`.names = &${prefix}_${f.names}_reference`);
  if (f.removable) parts.push('.is_removable = true');
  if (f.type === 'list')
    parts.push(
      `.max_items = ${f.max_items}`,
      `.count_offset = offsetof(struct ${structName}, n_${f.name})`,
      `.entry_size = sizeof(struct ${prefix}_${f.object})`,
    );
  if (f.ascending) parts.push(`.ascending = "${f.ascending}"`);
  if (f.type === 'map')
    parts.push(
      `.max_items = ${f.max_items}`,
      `.count_offset = offsetof(struct ${structName}, n_${f.name})`,
      `.entry_size = sizeof(struct ${prefix}_${f.object}_entry)`,
      `.value_offset = offsetof(struct ${prefix}_${f.object}_entry, value)`,
    );
  if (f.type === 'text') parts.push(`.text_bytes = ${textBytes(f)}`);
  return `    { ${parts.join(', ')} },`;
}

function table(tableName, structName, description, prefix, defaults) {
  const rows = description.fields.map((f) => fieldRow(f, structName, prefix)).join('\n');
  return (
    `static const struct field ${tableName}_fields[] = {\n${rows}\n};\n` +
    `const struct field_object ${tableName}_object = { "${description.name ?? tableName}", ${tableName}_fields, ${description.fields.length}, sizeof(struct ${structName}), &${defaults} };\n\n`
  );
}

function words(name, description, prefix) {
  const list = description.values.map(([word]) => `"${word}"`).join(', ');
  return (
    `static const char *const ${prefix}_${name}_list[] = { ${list} };\n` +
    `const struct field_words ${prefix}_${name}_words = { ${prefix}_${name}_list, ${description.values.length} };\n\n`
  );
}

/** Definitions of the tables of a checked description of documents. */
export function tablesSource(description, prefix) {
  let text = '';
  for (const [name, words_] of Object.entries(description.enums)) text += words(name, words_, prefix);
  for (const [name, { list }] of Object.entries(description.references))
    text += `const struct field_reference ${prefix}_${name}_reference = { "${name}", "${list}" };\n\n`;
  for (const [name, object] of Object.entries(description.objects))
    text += table(`${prefix}_${name}`, `${prefix}_${name}`, object, prefix, `${prefix}_${name}_default`);
  for (const [name, document] of Object.entries(description.documents)) text += table(name, name, document, prefix, `${name}_default`);
  return text;
}

export function wireSource(scene, messages, roomRoutes = []) {
  let text = `${notice}#include "wire_gen.h"\n\n#include <stddef.h>\n\n`;
  for (const [name, description] of Object.entries(messages.enums)) text += words(name, description, 'wire');
  text += tablesSource(scene, 'scene');
  for (const message of messages.messages) {
    const name = structOf(message);
    text += `static const struct ${name} ${name}_default = ${objectInitializer(message, 'wire', {})};\n`;
    text += table(name, name, message, 'wire', `${name}_default`).replace(
      /^const struct field_object/m,
      'static const struct field_object',
    );
  }
  const rows = messages.messages.map(
    (m) =>
      `    [MESSAGE_${upper(m.name)}] = { "${m.name}", ${m.from === 'client'}, offsetof(struct message, ${lower(m.name)}), &${structOf(m)}_object${messages.enums.right ? `, WIRE_RIGHT_${upper(m.needs?.[0] ?? 'look')}` : ''} },`,
  );
  text += `const struct message_description message_descriptions[MESSAGE_N_TYPES] = {\n${rows.join('\n')}\n};\n`;
  return messages.enums.member_role ? text + rightsSource(messages, roomRoutes) : text;
}
