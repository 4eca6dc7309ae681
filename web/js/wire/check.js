// Checks messages and documents against the tables generated from proto/ and fills in the defaults of fields that are
// left out. The server refuses the same messages with the same codes.
import { enums, messages, objects } from '../../gen/wire.js';
import { isObject } from './merge.js';

const protoTables = { enums, objects };
const leastDirection = 1e-9; // a shorter vector has no direction
const idPattern = /^[a-z0-9-]{1,63}$/;
const colorPattern = /^#[0-9a-f]{6}$/i;

/** A message or document that was refused. */
export class WireError extends Error {
  /** @param {string} code "type", "range", ... as in proto/problems.json @param {string} pointer RFC 6901 @param {string} detail a sentence */
  constructor(code, pointer, detail) {
    super(`${pointer || 'message'}: ${detail}`);
    this.code = code;
    this.pointer = pointer;
  }
}

export const isId = (text) => typeof text === 'string' && idPattern.test(text);

const kindOf = (value) => (value === null ? 'null' : Array.isArray(value) ? 'a list' : `a ${typeof value}`);
const escapePointer = (name) => name.replaceAll('~', '~0').replaceAll('/', '~1');

function need(is, value, expected, pointer) {
  if (!is) throw new WireError('type', pointer, `found ${kindOf(value)}, expected ${expected}`);
}

function checkRange(value, field, pointer) {
  const low = field.min ?? -Infinity;
  const high = field.max ?? Infinity;
  if (!(value >= low && value <= high)) throw new WireError('range', pointer, `${value} is not in ${low} to ${high}`);
}

function checkCount(n, field, pointer) {
  if (n > field.max_items) throw new WireError('count', pointer, `more than ${field.max_items} entries`);
}

function checkList(value, length, field, pointer) {
  const whole = field.type === 'size';
  const words = `a list of ${length} ${whole ? 'whole ' : ''}numbers`;
  need(Array.isArray(value) && value.length === length, value, words, pointer);
  value.forEach((item, index) => {
    need(Number.isFinite(item) && (!whole || Number.isInteger(item)), item, whole ? 'a whole number' : 'a number', `${pointer}/${index}`);
    checkRange(item, field, `${pointer}/${index}`);
  });
  return value;
}

/** The object behind a field of type object, list or map. */
const readInner = (value, field, pointer, tables) => readObject(tables.objects[field.object], value, pointer, tables);

const controlPattern = /[\x00-\x1f\x7f]/;
/** Readers by type of field: return the checked value, or throw a WireError. tables: words of enums and fields of objects. */
const readers = {
  bool: (value, field, pointer) => (need(typeof value === 'boolean', value, 'true or false', pointer), value),
  number: (value, field, pointer) => (need(Number.isFinite(value), value, 'a number', pointer), checkRange(value, field, pointer), value),
  integer: (value, field, pointer) => (
    need(Number.isInteger(value), value, 'a whole number', pointer), checkRange(value, field, pointer), value
  ),
  enum: (value, field, pointer, tables) => {
    need(typeof value === 'string', value, 'a word', pointer);
    const words = tables.enums[field.enum];
    if (!words.includes(value)) throw new WireError('enum', pointer, `found "${value.slice(0, 40)}", expected one of ${words.join(', ')}`);
    return value;
  },
  color: (value, field, pointer) => {
    need(typeof value === 'string', value, 'a colour', pointer);
    if (!colorPattern.test(value)) throw new WireError('pattern', pointer, 'expected a colour like #e0a0a0');
    return value.toLowerCase();
  },
  id: (value, field, pointer) => {
    need(typeof value === 'string', value, 'an id', pointer);
    if (!isId(value) && (value !== '' || field.required)) throw new WireError('pattern', pointer, 'expected 1 to 63 of a-z, 0-9 and -');
    return value;
  },
  text: (value, field, pointer) => {
    need(typeof value === 'string', value, 'text', pointer);
    if ([...value].length > field.max) throw new WireError('length', pointer, `longer than ${field.max} characters`);
    if (controlPattern.test(value)) throw new WireError('pattern', pointer, 'holds a control character');
    return value;
  },
  vec3: (value, field, pointer) => checkList(value, 3, field, pointer),
  direction: (value, field, pointer) => {
    checkList(value, 3, field, pointer);
    if (!(Math.hypot(...value) > leastDirection)) throw new WireError('range', pointer, 'no length, expected a direction');
    return value;
  },
  size: (value, field, pointer) => checkList(value, 2, field, pointer),
  json: (value, field, pointer) => (need(typeof value === 'object', value, 'an object', pointer), value),
  patch: (value, field, pointer) => (need(isObject(value), value, 'an object', pointer), value),
  object: readInner,
  list: (value, field, pointer, tables) => {
    need(Array.isArray(value), value, 'a list', pointer);
    checkCount(value.length, field, pointer);
    const items = value.map((item, index) => readInner(item, field, `${pointer}/${index}`, tables));
    const key = field.ascending;
    if (key && items.some((item, index) => index > 0 && item[key] < items[index - 1][key]))
      throw new WireError('order', pointer, `not in ascending order of ${key}`);
    return items;
  },
  map: (value, field, pointer, tables) => {
    need(isObject(value), value, 'an object', pointer);
    const entries = Object.entries(value);
    checkCount(entries.length, field, pointer);
    return Object.fromEntries(
      entries.map(([name, item]) => {
        const at = `${pointer}/${escapePointer(name)}`;
        if (!isId(name)) throw new WireError('pattern', at, 'expected an id of 1 to 63 of a-z, 0-9 and -');
        return [name, readInner(item, field, at, tables)];
      }),
    );
  },
};

function fallback(field, tables) {
  if (field.nullable) return null;
  if (field.type === 'object') return readInner({}, field, '', tables);
  if (field.type === 'list') return [];
  if (field.type === 'map' || field.type === 'patch') return {};
  return field.default ?? null;
}

/** skip: a member that is not a field ("type" of a message). */
function readObject(fields, value, pointer, tables, skip) {
  need(isObject(value), value, 'an object', pointer);
  for (const name of Object.keys(value))
    if (name !== skip && !fields.some((field) => field.name === name))
      throw new WireError('unknown-field', `${pointer}/${escapePointer(name)}`, 'no such field');
  const result = {};
  for (const field of fields) {
    const at = `${pointer}/${field.name}`;
    const given = Object.hasOwn(value, field.name) ? value[field.name] : undefined;
    const isAbsent = given === undefined || given === null; // null means the default
    if (isAbsent && field.required) throw new WireError('required', at, 'missing');
    result[field.name] = isAbsent ? fallback(field, tables) : readers[field.type](given, field, at, tables);
  }
  return result;
}

/** A whole scene or view, checked, with defaults. @param {'scene'|'view'} kind @param tables other than those of proto/ */
export const readDocument = (kind, value, tables = protoTables) => readObject(tables.objects[kind], value, '', tables);

/**
 * A message, checked, with defaults, with its name in type.
 * @param {unknown} value parsed JSON @param {'client'|'server'} from who sent it
 */
export function readMessage(value, from) {
  need(isObject(value), value, 'an object', '');
  const { type } = value;
  if (type === undefined) throw new WireError('required', '/type', 'missing');
  need(typeof type === 'string', type, 'the name of a message', '/type');
  const description = Object.hasOwn(messages, type) ? messages[type] : undefined;
  if (!description || description.from !== from)
    throw new WireError('enum', '/type', `no message of the ${from} is called "${type.slice(0, 40)}"`);
  return { type, ...readObject(description.fields, value, '', protoTables, 'type') };
}

/** A message of the server, checked, with defaults. Fields that only a newer server knows are dropped; null: an unknown message. */
export function readServerMessage(value) {
  need(isObject(value), value, 'an object', '');
  const description = Object.hasOwn(messages, value.type) ? messages[value.type] : undefined;
  if (description?.from !== 'server') return null;
  const known = description.fields.filter((field) => Object.hasOwn(value, field.name)).map((field) => [field.name, value[field.name]]);
  return readMessage({ type: value.type, ...Object.fromEntries(known) }, 'server');
}
