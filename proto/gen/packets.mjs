// Generates from proto/packets.json: packets_gen.h and packets_gen.c (structs, field tables and limits of every packet between
// daemon and renderer), the section of the reference page, and the HTTP routes of the questions.
import { declaration, enumDeclaration, lower, member, notice, objectInitializer, textBytes, upper } from './names.mjs';

const id = {
  name: 'id',
  type: 'integer',
  min: 0,
  max: 9000000000000000,
  required: true,
  about: 'Comes back in the answer; unique among those not answered.',
};
const partTypes = { document: 'DOCUMENT', list: 'LIST', problem: 'PROBLEM', matrix: 'MATRIX' };
const isPart = (field) => field.type in partTypes;
const structOf = (packet) => `packet_${lower(packet.name)}`;
const constant = (packet) => `PACKET_${upper(packet.name)}`;

/** Every packet of the description: the listed ones, and one for each question. */
export function allPackets(packets) {
  const questions = packets.questions.map((question) => ({
    ...question,
    to: 'renderer',
    json: question.snapshot ? 'document' : 'facts',
    answer: 'answer',
    question,
  }));
  return [...packets.packets, ...questions].map((packet) => ({
    ...packet,
    fields: [...(packet.answer ? [id] : []), ...packet.fields],
    shown: packet.snapshot ? packets.snapshot.fields : [],
  }));
}

/** The longest side of a frame is that of the largest view. */
export function checkPackets(packets, scene) {
  const frame = packets.packets.find((packet) => packet.name === 'frame'),
    size = scene.documents.view.fields.find((field) => field.name === 'size_px');
  for (const name of ['width_px', 'height_px'])
    if (frame.fields.find((field) => field.name === name).max !== size.max)
      throw new Error(`packets.json: the max of ${name} is not that of a view's size_px`);
  for (const question of packets.questions) {
    const ids = [...(question.path ?? '').matchAll(/\{(\w+)\}/g)].map((match) => match[1]);
    if (
      question.path &&
      question.handler !== 'own' &&
      (ids.length > 2 || (ids[1] ?? null) !== (question.fields.find((field) => field.in === 'path')?.name ?? null))
    )
      throw new Error(
        `packets.json: the path of ${question.name} may have the plan's id and one field's that says "in": "path"; more only a handler of its own can read`,
      );
  }
  const names = allPackets(packets).map((packet) => packet.name);
  if (new Set(names).size !== names.length) throw new Error('packets.json: two packets have one name');
}

function declarationOf(field) {
  switch (field.type) {
    case 'document':
    case 'list':
      return `    const cJSON *${field.name}; /* ${field.about} */\n`;
    case 'problem':
      return `    struct problem ${field.name}; /* ${field.about} */\n`;
    case 'matrix':
      return `    float ${field.name}[16]; /* ${field.about} */\n`;
    default:
      return declaration(field, 'packet');
  }
}

const declarations = (fields) => fields.map(declarationOf).join('');

export function packetsHeader(packets) {
  const all = allPackets(packets);
  const limits = Object.entries(packets.limits)
    .map(([name, [bytes, about]]) => `    PACKET_MAX_${upper(name)} = ${bytes}, /* bytes: ${about} */`)
    .join('\n');
  let text = `#pragma once\n${notice}#include <stddef.h>\n#include <stdint.h>\n\n#include "core/math/vec.h"\n#include "server/wire/fields.h"\n\nenum {\n${limits}\n};\n\n`;
  for (const [name, description] of Object.entries(packets.enums)) text += enumDeclaration(name, description, 'packet');
  text += `/* ${packets.snapshot.about} */\nstruct packet_snapshot {\n${declarations(packets.snapshot.fields)}};\n\n`;
  for (const packet of all) {
    const shown = packet.snapshot ? '    struct packet_snapshot shown;\n' : '';
    const fields = declarations(packet.fields) + shown;
    text += `/* To the ${packet.to}: ${packet.about} */\nstruct ${structOf(packet)} {\n${fields || '    char none; /* it has no fields */\n'}};\n\n`;
  }
  text += `enum packet_type {\n${all.map((p) => `    ${constant(p)},`).join('\n')}\n    PACKET_N_TYPES\n};\n\n`;
  text +=
    '/* One packet: its type, and the fields of that type. What is marked as a document points into json. */\nstruct packet {\n    enum packet_type type;\n' +
    `    union {\n${all.map((p) => `        struct ${structOf(p)} ${lower(p.name)};`).join('\n')}\n    };\n` +
    '    cJSON *json;   /* as it was read; owned. NULL in a packet that is to be written */\n    uint8_t *blob; /* owned by a packet that was read; NULL when n_blob is 0 */\n    size_t n_blob;\n};\n\n';
  text += `/* X(CONSTANT, name) for every question. */\n#define PACKET_QUESTIONS(X) \\\n${packets.questions.map((q) => `    X(${constant(q)}, ${lower(q.name)})`).join(' \\\n')}\n`;
  return text;
}

const typeNames = { bool: 'BOOL', number: 'NUMBER', integer: 'INTEGER', enum: 'ENUM', id: 'ID', text: 'TEXT', vec3: 'VEC3' };

function fieldRow(field, packet, path) {
  if (!typeNames[field.type]) throw new Error(`packets.json: field ${field.name} has the unknown type ${field.type}`);
  const struct = `struct ${structOf(packet)}`;
  const parts = [
    `.name = "${field.name}"`,
    `.type = FIELD_${typeNames[field.type]}`,
    `.offset = offsetof(${struct}, ${path}${member(field)})`,
  ];
  if (field.nullable) parts.push('.is_nullable = true', '.has_flag = true', `.has_offset = offsetof(${struct}, ${path}has_${field.name})`);
  if (field.required) parts.push('.is_required = true');
  if (field.min !== undefined) parts.push(`.min = ${field.min}`);
  if (field.max !== undefined) parts.push(`.max = ${field.max}`);
  if (field.type === 'enum') parts.push(`.words = &packet_${field.enum}_words`);
  if (field.type === 'text') parts.push(`.text_bytes = ${textBytes(field)}`);
  return `    { ${parts.join(', ')} },`;
}

const partRow = (field, packet, path) =>
  `    { "${field.name}", PACKET_PART_${partTypes[field.type]}, offsetof(struct ${structOf(packet)}, ${path}${field.name}), ${Boolean(field.required)} },`;

const placed = (packet) => [...packet.fields.map((field) => [field, '']), ...packet.shown.map((field) => [field, 'shown.'])];

function table(packet) {
  const name = structOf(packet),
    plain = placed(packet).filter(([field]) => !isPart(field)),
    parts = placed(packet).filter(([field]) => isPart(field));
  const list = (type, suffix, rows) => (rows.length ? `static const struct ${type} ${name}_${suffix}[] = {\n${rows.join('\n')}\n};\n` : '');
  const own = packet.fields.filter((field) => !isPart(field));
  return (
    `static const struct ${name} ${name}_default = ${own.length ? objectInitializer({ fields: own }, 'packet', {}) : '{ 0 }'};\n` +
    list(
      'field',
      'fields',
      plain.map(([field, path]) => fieldRow(field, packet, path)),
    ) +
    list(
      'packet_part',
      'parts',
      parts.map(([field, path]) => partRow(field, packet, path)),
    ) +
    `static const struct field_object ${name}_object = { "${packet.name}", ${plain.length ? `${name}_fields` : 'NULL'}, ${plain.length}, sizeof(struct ${name}), &${name}_default };\n\n`
  );
}

/** HTTP parameters of a question: one each, but for a vec3 whose coordinates are parameters of their own. */
const parametersOf = (question) =>
  question.fields
    .filter((field) => field.in !== 'path')
    .map((field) => ({ field, names: field.query ? Object.keys(field.query) : [field.name] }));

/** The field that the second id of the path gives. */
const pathField = (question) => {
  const field = question.fields.find((field) => field.in === 'path');
  return field ? `"${field.name}"` : 'NULL';
};

function questionTable(question) {
  const name = `packet_${lower(question.name)}`,
    rows = parametersOf(question).map(({ field, names }) => `    { "${field.name}", { ${names.map((n) => `"${n}"`).join(', ')} } },`);
  return (
    (rows.length ? `static const struct packet_parameter ${name}_parameters[] = {\n${rows.join('\n')}\n};\n` : '') +
    `static const struct packet_question ${name}_question = { ${question.path ? `"${question.path}"` : 'NULL'}, ${pathField(question)}, ${question.handler === 'own'}, ${Boolean(question.slow)}, ${rows.length ? `${name}_parameters` : 'NULL'}, ${rows.length} };\n\n`
  );
}

export function packetsSource(packets) {
  const all = allPackets(packets);
  let text = `${notice}#include "server/wire/packet.h"\n\n`;
  for (const [name, description] of Object.entries(packets.enums))
    text += `static const struct field_words packet_${name}_words = { (const char *const[]){ ${description.values.map(([word]) => `"${word}"`).join(', ')} }, ${description.values.length} };\n`;
  text += '\n';
  for (const packet of all) text += table(packet) + (packet.question ? questionTable(packet.question) : '');
  const rows = all.map((packet) => {
    const name = structOf(packet),
      parts = placed(packet).filter(([field]) => isPart(field)).length;
    const entries = [
      `.name = "${packet.name}"`,
      `.direction = PACKET_TO_${upper(packet.to)}`,
      `.max_json = PACKET_MAX_${upper(packet.json)}`,
    ];
    if (packet.blob) entries.push(`.max_blob = PACKET_MAX_${upper(packet.blob)}`);
    if (packet.needs_blob) entries.push('.needs_blob = true');
    entries.push(`.offset = offsetof(struct packet, ${lower(packet.name)})`, `.object = &${name}_object`);
    if (parts) entries.push(`.parts = ${name}_parts`, `.n_parts = ${parts}`);
    if (packet.fields.some((field) => field.name === 'id'))
      entries.push('.has_id = true', `.id_offset = offsetof(struct packet, ${lower(packet.name)}.id)`);
    if (packet.answer) entries.push(`.is_request = true`, `.answer = PACKET_${upper(packet.answer)}`);
    if (packet.snapshot) entries.push('.has_snapshot = true', `.snapshot_offset = offsetof(struct packet, ${lower(packet.name)}.shown)`);
    if (packet.question) entries.push(`.question = &${name}_question`);
    return `    [${constant(packet)}] = { ${entries.join(', ')} },`;
  });
  return text + `const struct packet_description packet_descriptions[PACKET_N_TYPES] = {\n${rows.join('\n')}\n};\n`;
}

/** The HTTP calls that ask questions, as proto/http.json describes routes. */
export function questionRoutes(packets) {
  return packets.questions
    .filter((question) => question.path)
    .map((question) => {
      const query = { ...(question.snapshot ? packets.snapshot.query : {}) };
      for (const { field } of parametersOf(question)) {
        if (field.query) for (const [name, about] of Object.entries(field.query)) query[name] = ['number', about];
        else query[field.name] = [field.type === 'number' || field.type === 'integer' ? 'number' : 'string', field.about];
      }
      return {
        method: 'GET',
        path: question.path,
        needs: question.needs,
        about: question.about,
        query,
        answers: { 200: question.answer ?? question.name },
        schema: question.name,
        problems: question.problems,
      };
    });
}

/** The section of the reference page; tableOf(fields, enums) writes a table of fields. */
export function packetsSection(packets, escape, tableOf) {
  let body =
    `<h2 id="packets">Packets between daemon and renderer</h2>\n<p>${escape(packets.about)}</p>\n` +
    '<table><thead><tr><th>Limit</th><th>Bytes</th><th>Of</th></tr></thead><tbody>\n' +
    Object.entries(packets.limits)
      .map(([name, [bytes, about]]) => `<tr><td>${escape(name)}</td><td>${bytes}</td><td>${escape(about)}</td></tr>`)
      .join('\n') +
    '\n</tbody></table>\n';
  for (const packet of allPackets(packets)) {
    const notes = [
      packet.question ? `A question${packet.question.path ? `, over HTTP GET ${packet.question.path}` : ''}.` : packet.when,
      packet.answer ? `Answered with ${packet.answer} or problem.` : '',
      `JSON: ${packet.json}.`,
      packet.blob ? `Blob: ${packet.blob}.` : '',
    ]
      .filter(Boolean)
      .join(' ');
    body +=
      `<h3 id="packet-${escape(packet.name)}">${escape(packet.name)} <small>to the ${packet.to}</small></h3>\n<p>${escape(packet.about)} ${escape(notes)}</p>\n` +
      (packet.fields.length + packet.shown.length ? tableOf([...packet.fields, ...packet.shown], packets.enums) : '');
  }
  return body;
}
