// undo_words.js: what a step of undo is called, by the path of the field that it changes, of the "undo" of fields in scene.json.
// A tree by names of fields; '*' stands for every key of a map, '' for the words of a field that has named fields inside.

function treeOf({ object, type, undo }, objects) {
  const inner = object && type !== 'list' ? treeOfFields(objects[object].fields, objects) : {};
  const named = type === 'map' && Object.keys(inner).length ? { '*': inner } : inner;
  return Object.keys(named).length ? { ...(undo && { '': undo }), ...named } : undo;
}

const treeOfFields = (fields, objects) =>
  Object.fromEntries(fields.map((field) => [field.name, treeOf(field, objects)]).filter(([, tree]) => tree));

/** The words of scene and view. Of a checked description of documents. */
export const undoWords = ({ objects, documents }) =>
  Object.fromEntries(Object.entries(documents).map(([name, { fields }]) => [name, treeOfFields(fields, objects)]));

export const undoWordsScript = (scene) =>
  '// Generated from proto/scene.json; change it there.\n' + `export const undoWords = ${JSON.stringify(undoWords(scene), null, 1)};\n`;
