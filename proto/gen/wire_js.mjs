// wire.js: the description as data; web/js/wire/check.js reads it.
export function wireScript(scene, messages) {
  const enums = {};
  for (const group of [scene.enums, messages.enums])
    for (const [name, description] of Object.entries(group)) enums[name] = description.values.map(([word]) => word);
  const objects = {};
  for (const group of [scene.objects, scene.documents]) for (const [name, object] of Object.entries(group)) objects[name] = object.fields;
  const table = {};
  for (const message of messages.messages) table[message.name] = { from: message.from, fields: message.fields };
  return '// Generated from proto/; change it there.\n' +
    `export const protocol = ${messages.version};\n` +
    `export const maxClientBytes = ${messages.max_client_bytes};\n` +
    `export const enums = ${JSON.stringify(enums, null, 1)};\n` +
    `export const objects = ${JSON.stringify(objects, null, 1)};\n` +
    `export const messages = ${JSON.stringify(table, null, 1)};\n`;
}
