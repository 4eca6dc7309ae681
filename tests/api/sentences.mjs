// Holds what the server says to proto/sentences.json: the English sentence is the text of its code, filled with the values that stand beside it.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { placesOf, sentencesOf } from '../../proto/gen/sentences.mjs';

const mostBytes = { detail: 319, sentence: 399, reason: 479 }; // what the server keeps of a sentence; the rest is cut off
const texts = new Map();
for (const { code, text } of sentencesOf(JSON.parse(readFileSync(new URL('../../proto/sentences.json', import.meta.url), 'utf8'))))
  texts.set(code, [...(texts.get(code) ?? []), text]);

const withoutZeros = (digits) => (digits.includes('.') ? digits.replace(/\.?0+$/, '') : digits);

/** printf's %.Ng. */
function general(number, precision) {
  const [digits, exponent] = number.toExponential(precision - 1).split('e');
  const power = Number(exponent);
  if (power >= -4 && power < precision) return withoutZeros(number.toFixed(precision - 1 - power));
  return `${withoutZeros(digits)}e${power < 0 ? '-' : '+'}${String(Math.abs(power)).padStart(2, '0')}`;
}

function shown({ format, type, precision }, value) {
  if (type === 'TEXT')
    return Buffer.from(value)
      .subarray(0, precision < 0 ? undefined : precision)
      .toString();
  if (type === 'GENERAL') return general(value, precision < 0 ? 6 : precision || 1);
  if (type === 'FIXED') return value.toFixed(precision < 0 ? 6 : precision);
  const [, width, letter] = /^%0?(\d*)(\w+)$/.exec(format);
  const digits = /^x$/i.test(letter) ? value.toString(16) : String(value);
  return (letter === 'X' ? digits.toUpperCase() : digits).padStart(Number(width), '0');
}

/** @returns {string} the English sentence of a text of proto/sentences.json */
export function filled(text, values) {
  const places = placesOf(text).values();
  return text
    .replaceAll('%%', '\0')
    .replace(/\{([a-z][a-z0-9_]*)(?: %[^}]*)?\}/g, (_, name) => shown(places.next().value, values[name]))
    .replaceAll('\0', '%');
}

/** Fails where a sentence in the JSON has a code, and is not the code's. @returns {any} the JSON */
export function heldToSentences(json) {
  if (!json || typeof json !== 'object') return json;
  for (const [key, value] of Object.entries(json)) {
    const name = key.endsWith('_code') ? key.slice(0, -5) : '';
    if (!(name in json))
      heldToSentences(value); // values too, which may hold sentences
    else if (typeof value === 'string' && typeof json[name] === 'string') {
      const english = (texts.get(value) ?? []).map((text) => filled(text, json[`${name}_values`] ?? {}));
      const is = (one) =>
        one === json[name] || (Buffer.byteLength(json[name]) >= mostBytes[name] - 3 && one.startsWith(json[name].slice(0, -3)));
      assert.ok(
        english.some(is),
        `${value} ${JSON.stringify(json[`${name}_values`])}: "${json[name]}" is none of ${JSON.stringify(english)}`,
      );
    }
  }
  return json;
}
