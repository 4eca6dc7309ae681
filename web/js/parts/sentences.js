// Sentences that a person reads stand in a table of each folder (words.js; later_words.js for what is loaded later), in English; languages/ has other languages.
import { language, texts } from '../languages/index.js';

const rules = new Intl.PluralRules(language);
const inOrder = ['zero', 'one', 'two', 'few', 'many', 'other'];
const forms = inOrder.filter((form) => rules.resolvedOptions().pluralCategories.includes(form));

/**
 * A text may have places: "{name}" takes a value, "{n|row|rows}" the form for that number, in the order of the language's plurals (CLDR: zero one two few
 * many other). Texts without places are strings, others functions of their values; given a template for a place, such a function returns a list that
 * lit-html draws, else a string.
 * @template {Record<string, string>} T
 * @param {string} group "shell", "dose", as languages/ has it @param {T} english by key
 * @returns {{[K in keyof T]: any}}
 */
export function sentences(group, english) {
  const own = { __proto__: null, ...texts[group] }; // a key may be valueOf
  return Object.fromEntries(Object.entries(english).map(([key, text]) => [key, sentence(own[key] ?? text)]));
}

/**
 * Puts the server's sentences into the page's language. In the server's JSON a sentence stands beside its code and values ("detail", "detail_code",
 * "detail_values"; proto/sentences.json), and languages/ has texts of the group "server" by code. Sentences that the language lacks stay English.
 * @template T @param {T} json is changed @returns {T}
 */
export function told(json) {
  if (texts.server && json && typeof json === 'object')
    for (const [key, value] of Object.entries(json)) {
      const text = key.endsWith('_code') && Object.hasOwn(texts.server, value) && texts.server[value];
      const name = key.slice(0, -5);
      if (!text) told(value);
      else {
        const say = sentence(text);
        json[name] = typeof say === 'string' ? say : say(told(json[`${name}_values`])); // a value may be a sentence itself
      }
    }
  return json;
}

function sentence(text) {
  const pieces = text.split(/\{([^}]*)\}/); // text, place, text, …
  if (pieces.length === 1) return text;
  return (values) => {
    const all = pieces.map((piece, n) => (n % 2 ? filled(piece, values) : piece));
    return all.some(isDrawn) ? all : all.join('');
  };
}

/** Whether lit-html has to draw it: a template, a list, or its `nothing`, which is a symbol. No value at all is no text. */
const isDrawn = (one) => (typeof one === 'object' && one !== null) || typeof one === 'symbol';

function filled(place, values) {
  const [name, ...words] = place.split('|');
  return words.length ? (words[forms.indexOf(rules.select(values[name]))] ?? words.at(-1)) : values[name];
}
