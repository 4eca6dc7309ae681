// RFC 7396 merge patches on plain JSON values. Nothing here changes its arguments.

/** @param {unknown} value @returns {value is Record<string, unknown>} */
export const isObject = (value) => typeof value === 'object' && value !== null && !Array.isArray(value);

// A field of a JSON document may be called "__proto__": plain assignment would change the prototype instead.
const put = (object, name, value) => Object.defineProperty(object, name, { value, enumerable: true, configurable: true, writable: true });
const get = (object, name) => (Object.hasOwn(object, name) ? object[name] : undefined);

/** The document after the patch; null removes a field. */
export function mergePatch(target, patch) {
  if (!isObject(patch)) return patch;
  const result = isObject(target) ? { ...target } : {};
  for (const [name, value] of Object.entries(patch)) {
    if (value === null) delete result[name];
    else put(result, name, mergePatch(get(result, name), value));
  }
  return result;
}

/** One patch that does what first and then second do; null stays, for it still has to remove. */
export function joinPatches(first, second) {
  if (!isObject(first) || !isObject(second)) return second;
  const result = { ...first };
  for (const [name, value] of Object.entries(second)) put(result, name, joinPatches(get(result, name), value));
  return result;
}
