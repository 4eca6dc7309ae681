// Holds a value to a JSON Schema, as far as the API's own description uses them.

/** @returns {string} where and why the value does not fit the schema; '' where it does. */
export function misfit(schema, value, schemas, at = '') {
  if (schema.$ref) return misfit(schemas[schema.$ref.replace('#/components/schemas/', '')] ?? fail(schema.$ref), value, schemas, at);
  if (schema.oneOf) {
    const found = schema.oneOf.map((one) => misfit(one, value, schemas, at));
    return found.includes('') ? '' : found.join('; ');
  }
  if ('const' in schema) return value === schema.const ? '' : `${at} is ${show(value)}, not ${schema.const}`;
  const types = schema.type === undefined ? [] : [schema.type].flat();
  if (types.length > 0 && !types.some((type) => isOf(type, value))) return `${at} is ${show(value)}, not ${types.join(' or ')}`;
  if (value === null) return '';
  if (schema.enum && !schema.enum.includes(value)) return `${at} is ${show(value)}, none of ${schema.enum.join(', ')}`;
  if (typeof value === 'string')
    return schema.pattern && !new RegExp(schema.pattern).test(value) ? `${at} is ${show(value)}, not as ${schema.pattern}` : '';
  if (typeof value === 'number') return value < schema.minimum || value > schema.maximum ? `${at} is ${value}, out of range` : '';
  if (Array.isArray(value)) {
    if (value.length < (schema.minItems ?? 0) || value.length > (schema.maxItems ?? Infinity)) return `${at} has ${value.length} entries`;
    return first(value.entries(), ([i, entry]) => (schema.items ? misfit(schema.items, entry, schemas, `${at}/${i}`) : ''));
  }
  if (typeof value !== 'object') return '';
  for (const name of schema.required ?? []) if (!Object.hasOwn(value, name)) return `${at}/${name} is missing`;
  return first(Object.entries(value), ([name, entry]) => {
    const field = schema.properties && Object.hasOwn(schema.properties, name) ? schema.properties[name] : schema.additionalProperties;
    if (field === false) return `${at}/${name} is not described`;
    return typeof field === 'object' ? misfit(field, entry, schemas, `${at}/${name}`) : '';
  });
}

const show = (value) => JSON.stringify(value)?.slice(0, 80);
const isOf = (type, value) =>
  type === 'null'
    ? value === null
    : type === 'array'
      ? Array.isArray(value)
      : type === 'integer'
        ? Number.isInteger(value)
        : type === 'object'
          ? typeof value === 'object' && value !== null && !Array.isArray(value)
          : typeof value === type;
function first(entries, look) {
  for (const entry of entries) {
    const found = look(entry);
    if (found) return found;
  }
  return '';
}
function fail(name) {
  throw new Error(`there is no schema ${name}`);
}

/** The schema of the JSON answer of a call, by the description that the server gives. @returns {object|null} */
export function schemaOfAnswer(description, method, address, status) {
  for (const [path, operations] of Object.entries(description.paths)) {
    if (!new RegExp(`^${path.replace(/\{\w+\}/g, '[^/]+')}$`).test(address)) continue;
    return operations[method.toLowerCase()]?.responses[status]?.content?.['application/json']?.schema ?? null;
  }
  return null;
}
