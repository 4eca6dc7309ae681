// wire.js: the descriptions as data for the page; web/js/wire/check.js reads them.
const wordsOf = (enums) => Object.fromEntries(Object.entries(enums).map(([name, { values }]) => [name, values.map(([word]) => word)]));

/** Words of enums and fields of objects, of a checked description of documents. */
export function tables({ enums, objects, documents }) {
  return { enums: wordsOf(enums), objects: Object.fromEntries(Object.entries({ ...objects, ...documents }).map(([name, { fields }]) => [name, fields])) };
}

export function wireScript(scene, messages) {
  const { enums, objects } = tables(scene);
  Object.assign(enums, wordsOf(messages.enums));
  const table = {};
  for (const message of messages.messages) table[message.name] = { from: message.from, fields: message.fields };
  return '// Generated from proto/; change it there.\n' +
    `export const protocol = ${messages.version};\n` +
    `export const maxClientBytes = ${messages.max_client_bytes};\n` +
    `export const enums = ${JSON.stringify(enums, null, 1)};\n` +
    `export const objects = ${JSON.stringify(objects, null, 1)};\n` +
    `export const messages = ${JSON.stringify(table, null, 1)};\n`;
}
