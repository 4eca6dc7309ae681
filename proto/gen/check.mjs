// Checks a description before anything is written from it: every limit is there, every name is known, and what C cannot
// have (an object inside itself) is refused with a sentence. Also replaces the field kind "plane" by the object it is.
const simpleTypes = ['bool', 'number', 'integer', 'enum', 'color', 'id', 'text', 'vec3', 'direction', 'size', 'json'];
const types = [...simpleTypes, 'object', 'list', 'map', 'patch', 'plane'];
const maxFields = 64; // server/wire/fields_read.c keeps the fields it has seen in 64 bits
const maxDepth = 12; // of objects in a document; JSON_MAX_DEPTH of server/wire/json.h has room for a message around it
const documentDepth = 2; // a message and its "patch"

/** The object that stands for a field of type "plane". */
const plane = {
  about: 'A plane through the patient.',
  fields: [
    {
      name: 'origin_mm',
      type: 'vec3',
      unit: 'mm',
      space: 'lps',
      min: -100000,
      max: 100000,
      default: [0, 0, 0],
      about: 'A point of the plane.',
    },
    {
      name: 'normal',
      type: 'direction',
      space: 'lps',
      min: -1000,
      max: 1000,
      default: [0, 0, 1],
      about: 'Square to the plane; any length but 0.',
    },
  ],
};

function need(is, where, sentence) {
  if (!is) throw new Error(`${where}: ${sentence}`);
}

function checkDefault(field, enums, where) {
  const inside = (value) => value >= field.min && value <= field.max;
  const value = field.default;
  if (value === undefined) {
    need(!['color', 'size', 'direction'].includes(field.type) || field.nullable || field.required, where, 'needs a default');
    need(!['number', 'integer'].includes(field.type) || field.nullable || field.required, where, 'needs a default');
    return;
  }
  need(!['object', 'list', 'map', 'patch', 'json', 'plane'].includes(field.type), where, `a ${field.type} has no default of its own`);
  if (field.type === 'enum')
    need(
      enums[field.enum].values.some(([word]) => word === value),
      where,
      `the default ${value} is not a word of ${field.enum}`,
    );
  if (field.type === 'number') need(inside(value), where, 'the default is out of range');
  if (field.type === 'integer') need(Number.isInteger(value) && inside(value), where, 'the default is out of range or not whole');
  if (field.type === 'color') need(/^#[0-9a-f]{6}$/.test(value), where, 'the default is not #rrggbb');
  const length = { vec3: 3, direction: 3, size: 2 }[field.type];
  if (length)
    need(Array.isArray(value) && value.length === length && value.every(inside), where, `the default is not ${length} numbers in range`);
  if (field.type === 'direction')
    need(
      value.some((number) => number !== 0),
      where,
      'the default has no length',
    );
}

function checkField(field, { enums, references, objects, known, isMessage }, where) {
  need(/^[a-z][a-z0-9_]*$/.test(field.name ?? ''), where, 'a name is a-z, 0-9 and _');
  need(types.includes(field.type), where, `unknown type ${field.type}`);
  need(field.type !== 'json' || isMessage, where, 'only a message has JSON that is not described');
  need(typeof field.about === 'string' && field.about !== '', where, 'needs a sentence "about"');
  need(field.undo === undefined || (typeof field.undo === 'string' && field.undo !== ''), where, '"undo" is words for a person');
  if (['number', 'integer', 'vec3', 'direction', 'size'].includes(field.type))
    need(Number.isFinite(field.min) && Number.isFinite(field.max) && field.min <= field.max, where, 'needs min and max');
  if (field.type === 'text') need(Number.isInteger(field.max) && field.max > 0, where, 'needs max, in characters');
  if (field.type === 'enum') need(enums[field.enum], where, `unknown enum ${field.enum}`);
  if (['object', 'list', 'map'].includes(field.type))
    need(known.has(field.object), where, `${field.object} is not an object that is described above`);
  if (['list', 'map'].includes(field.type)) need(Number.isInteger(field.max_items) && field.max_items > 0, where, 'needs max_items');
  if (field.ascending !== undefined)
    need(
      field.type === 'list' && objects?.[field.object]?.fields.some((inner) => inner.name === field.ascending && inner.type === 'number'),
      where,
      `ascending names a number of the list's object, not ${field.ascending}`,
    );
  if (field.nullable) {
    need([...simpleTypes, 'object', 'plane'].includes(field.type), where, `a ${field.type} cannot be null`);
    need(field.default === undefined, where, 'is null by default, so it has no other default');
  }
  if (field.names !== undefined) {
    need(Object.hasOwn(references, field.names), where, `names "${field.names}", which is not among the references`);
    need(field.type === 'id' || field.type === 'map', where, 'only an id and the keys of a map can name something');
  }
  need(
    !field.removable || (field.type === 'map' && field.names !== undefined),
    where,
    'only entries of a map that names something are removable',
  );
  checkDefault(field, enums, where);
}

function checkFields(fields, context, where) {
  need(fields.length <= maxFields, where, `more than ${maxFields} fields`);
  need(new Set(fields.map(({ name }) => name)).size === fields.length, where, 'a name stands twice');
  for (const field of fields) checkField(field, context, `${where}.${field.name}`);
}

/** Objects that one of these fields leads into, in the deepest way: 1 for a field of an object without objects. */
function depthOf(fields, objects) {
  return Math.max(
    0,
    ...fields.map((field) => {
      if (!field.object) return ['vec3', 'direction', 'size'].includes(field.type) ? 1 : 0;
      return (field.type === 'object' ? 1 : 2) + depthOf(objects[field.object].fields, objects);
    }),
  );
}

const withPlanes = (fields) => fields.map((field) => (field.type === 'plane' ? { ...field, type: 'object', object: 'plane' } : field));
const mapValues = (object, change) => Object.fromEntries(Object.entries(object).map(([name, value]) => [name, change(value)]));

/** A description of documents (scene.json), checked, with planes as objects. Throws an Error that names the field. */
export function checkedDocuments({ enums = {}, objects = {}, references = {}, ...description }) {
  const known = new Set();
  const groups = [...Object.values(objects), ...Object.values(description.documents)];
  const hasPlanes = groups.some(({ fields }) => fields.some(({ type }) => type === 'plane'));
  need(!hasPlanes || !objects.plane, 'plane', 'is the object of the fields of type "plane"');
  for (const [name, object] of Object.entries(objects)) {
    checkFields(object.fields, { enums, references, objects, known }, name);
    known.add(name);
  }
  for (const [name, document] of Object.entries(description.documents)) {
    checkFields(document.fields, { enums, references, objects, known }, name);
    // a view is checked without a plan, but for its override, which is a patch on the scene
    need(document.of_plan || !namesSomething(document, objects), name, 'names something of the plan: only a document "of_plan" may');
  }
  const all = { ...(hasPlanes && { plane }), ...mapValues(objects, (object) => ({ ...object, fields: withPlanes(object.fields) })) };
  const documents = mapValues(description.documents, (document) => ({ ...document, fields: withPlanes(document.fields) }));
  for (const [name, document] of Object.entries(documents))
    need(depthOf(document.fields, all) + documentDepth <= maxDepth, name, `objects in it are more than ${maxDepth - documentDepth} deep`);
  for (const [name, { fields }] of Object.entries({ ...all, ...documents }))
    for (const field of fields)
      need(
        field.type !== 'object' || field.nullable || !all[field.object].fields.some(({ required }) => required),
        `${name}.${field.name}`,
        `${field.object} has a required field, so it cannot be left out: make it nullable, or the entry of a list or map`,
      );
  const used = new Set(
    reachable(
      Object.values(documents).flatMap(({ fields }) => fields),
      all,
    ),
  );
  for (const name of Object.keys(all)) need(used.has(name), name, 'no document has this object');
  return { ...description, enums, references, objects: all, documents };
}

function reachable(fields, objects) {
  return fields.flatMap((field) => (field.object ? [field.object, ...reachable(objects[field.object].fields, objects)] : []));
}

/** Whether a field of the object, or of an object in it, names something of the plan. */
function namesSomething(object, objects) {
  return object.fields.some(
    (field) => field.names !== undefined || (field.object !== undefined && namesSomething(objects[field.object], objects)),
  );
}

/** A description of messages (messages.json), checked. */
export function checkedMessages(description) {
  const rights = description.enums.right?.values.map(([word]) => word);
  for (const message of description.messages) {
    checkFields(message.fields, { enums: description.enums, references: {}, known: new Set(), isMessage: true }, message.name);
    if (rights)
      need(
        message.from === 'client' ? rights.includes(message.needs?.[0]) : message.needs === undefined,
        message.name,
        `a message from the page, and no other, says what it "needs": [right, "room"], the right one of ${rights.join(', ')}`,
      );
  }
  for (const [role, , given = []] of description.enums.member_role?.values ?? [])
    need(given.length > 0 && given.every((right) => rights.includes(right)), role, `a role has rights: some of ${rights.join(', ')}`);
  return description;
}
