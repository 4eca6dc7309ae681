// RFC 7396 merge patches on plain JSON values. No function changes its arguments.

/** @param {unknown} value @returns {value is Record<string, unknown>} */
export const isObject = (value) => typeof value === 'object' && value !== null && !Array.isArray(value);

// A field of a JSON document may be called "__proto__": plain assignment would change the prototype instead.
const put = (object, name, value) => Object.defineProperty(object, name, { value, enumerable: true, configurable: true, writable: true });
const get = (object, name) => (Object.hasOwn(object, name) ? object[name] : undefined);

/** The document with the patch applied; null removes a field, a list is replaced whole. */
export function mergePatch(target, patch) {
  if (!isObject(patch)) return patch;
  const result = isObject(target) ? { ...target } : {};
  for (const [name, value] of Object.entries(patch)) {
    if (value === null) delete result[name];
    else put(result, name, mergePatch(get(result, name), value));
  }
  return result;
}

/**
 * One patch that does what first and then second do. A null stays: it still has to remove the field from the document.
 * One case cannot be said in one patch: an object that follows a null keeps the fields that the null would have removed.
 */
export function joinPatches(first, second) {
  if (!isObject(first) || !isObject(second)) return second;
  const result = { ...first };
  for (const [name, value] of Object.entries(second)) put(result, name, joinPatches(get(result, name), value));
  return result;
}
