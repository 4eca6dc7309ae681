// wire.js: the descriptions as data for the page; web/js/wire/check.js reads them.
// Without the sentences "about", which are half of the text, units, spaces and names of list items, of which the page reads nothing, and the words "undo",
// which are in undo_words.js.
const unread = ['about', 'undo', 'unit', 'space', 'names', 'removable'];
const wordsOf = (enums) => Object.fromEntries(Object.entries(enums).map(([name, { values }]) => [name, values.map(([word]) => word)]));

/** Words of enums and fields of objects, of a checked description of documents. */
export function tables({ enums, objects, documents }) {
  return {
    enums: wordsOf(enums),
    objects: Object.fromEntries(Object.entries({ ...objects, ...documents }).map(([name, { fields }]) => [name, fields])),
  };
}

const isFact = (part) => typeof part === 'string' || Array.isArray(part); // not an object or message of that name
const text = (value) => JSON.stringify(value, (key, part) => (unread.includes(key) && isFact(part) ? undefined : part), 1);

export function wireScript(scene, messages) {
  const { enums, objects } = tables(scene);
  Object.assign(enums, wordsOf(messages.enums));
  const table = {};
  for (const message of messages.messages) table[message.name] = { from: message.from, fields: message.fields };
  return (
    '// Generated from proto/; change it there.\n' +
    `export const protocol = ${messages.version};\n` +
    `export const maxClientBytes = ${messages.max_client_bytes};\n` +
    `export const roles = ${text(Object.fromEntries((messages.enums.member_role?.values ?? []).map(([role, , rights]) => [role, rights])))};\n` +
    `export const enums = ${text(enums)};\n` +
    `export const objects = ${text(objects)};\n` +
    `export const messages = ${text(table)};\n`
  );
}
