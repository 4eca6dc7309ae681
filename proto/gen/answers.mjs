// JSON Schemas of the API's answers, out of answers.json (which says how it is written), record.json and scene.json. Each answer that a
// route or a question names has one, and each one is named.
const words = {
  text: { type: 'string' },
  id: { type: 'string' },
  number: { type: 'number' },
  integer: { type: 'integer' },
  bool: { type: 'boolean' },
  color: { type: 'string', pattern: '^#[0-9a-f]{6}$' },
  point: { type: 'array', items: { type: 'number' }, minItems: 3, maxItems: 3 },
  span: { type: 'array', items: { type: 'number' }, minItems: 2, maxItems: 2 },
  any: {},
};
const ofOthers = ['scene', 'view', 'camera', 'problem']; // schemas that the document has besides these
const ofFiles = ['json', 'image', 'surface', 'curves', 'scene']; // kinds of answers that openapi.mjs knows

/** @returns {Object<string, object>} "answer.NAME" to its schema. Throws where a name is not known, or is used by nobody. */
export function answerSchemas({ answers }, record, scene, routes) {
  const used = new Set();

  function word(text) {
    const name = text.replace(/\?$/, '');
    if (name !== text) {
      const schema = word(name);
      return typeof schema.type === 'string' ? { ...schema, type: [schema.type, 'null'] } : { oneOf: [schema, { type: 'null' }] };
    }
    if (Object.hasOwn(words, name)) return words[name];
    if (typeof answers[name] === 'string') {
      used.add(name);
      return word(answers[name]);
    }
    if (Object.hasOwn(answers, name)) {
      used.add(name);
      return { $ref: `#/components/schemas/answer.${name}` };
    }
    if (ofOthers.includes(name)) return { $ref: `#/components/schemas/${name}` };
    if (name.includes('|')) return { type: 'string', enum: name.split('|') };
    throw new Error(`answers.json: there is no type "${name}"`);
  }

  /** The fields of an object with those that "<" takes in. */
  function fieldsOf({ '<': others = [], ...own }) {
    for (const name of others) used.add(name);
    return Object.assign({}, ...others.map((name) => fieldsOf(answers[name])), own);
  }

  function schemaOf(type) {
    if (typeof type === 'string') return word(type);
    if (Array.isArray(type)) return { type: 'array', items: schemaOf(type[0]) };
    const fields = fieldsOf(type);
    if ('*' in fields) return { type: 'object', additionalProperties: schemaOf(fields['*']) };
    return {
      type: 'object',
      additionalProperties: false,
      required: Object.keys(fields).filter((name) => !name.endsWith('?')),
      properties: Object.fromEntries(Object.entries(fields).map(([name, field]) => [name.replace(/\?$/, ''), schemaOf(field)])),
    };
  }

  if (!Object.hasOwn(scene.documents, 'scene')) throw new Error('answers.json: scene.json has no document scene');
  const schemas = Object.fromEntries(
    Object.entries(answers)
      .filter(([, type]) => typeof type !== 'string')
      .map(([name, type]) => [`answer.${name}`, schemaOf(type)]),
  );
  const { $schema, ...recordSchema } = record;
  schemas['answer.record'] = recordSchema;
  for (const { method, path, answers: kinds, schema } of routes)
    for (const kind of [...Object.values(kinds), ...(schema ? [schema] : [])]) {
      if (!kind || kind.includes('/') || ofFiles.includes(kind)) continue;
      if (!Object.hasOwn(schemas, `answer.${kind}`)) throw new Error(`${method} ${path}: answers.json has no "${kind}"`);
      used.add(kind);
    }
  used.add('surface');
  for (const name of Object.keys(answers)) if (!used.has(name)) throw new Error(`answers.json: "${name}" is used by nobody`);
  return schemas;
}
