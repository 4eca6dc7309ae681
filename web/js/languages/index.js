// The languages of the page besides English, and the one of this browser. To add one: a file here (as sentences() has the keys), and a row.

/** Loads each, by its subtag of BCP 47. @type {Record<string, () => Promise<{default: Texts}>>} */
const languages = {};

/** @typedef {Record<string, Record<string, string>>} Texts by folder of the page, then by key; what is missing stays English */

const wanted = (globalThis.navigator?.languages ?? []).map((tag) => tag.split('-')[0].toLowerCase());
const found = wanted.find((tag) => tag === 'en' || Object.hasOwn(languages, tag)) ?? 'en';

/** Its texts; an English page where it cannot be loaded. */
const own = found === 'en' ? null : await languages[found]().catch(() => null);

export const language = own ? found : 'en';
export const texts = own?.default ?? {};
