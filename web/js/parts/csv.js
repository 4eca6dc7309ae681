// Comma-separated values as of RFC 4180.

import { say } from './later_words.js';
import { visibleText } from './visible_text.js';

/** A text that a spreadsheet would take for a formula gets an apostrophe in front. */
const guarded = (text) => (/^[=+@\t]/.test(text) ? `'${text}` : text);
const cell = (value) => {
  if (typeof value === 'number') return Number.isFinite(value) ? String(Number(value.toPrecision(7))) : '';
  const text = guarded(visibleText(String(value ?? ''))); // a spreadsheet would obey marks of writing direction
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
};

/** @param {(string|number|null)[][]} rows numbers with seven figures, what is not known as an empty field */
export const csvText = (rows) => rows.map((row) => `${row.map(cell).join(',')}\r\n`).join('');

/** The rows of a text, each with the number of its line; lines without anything are left out. Throws an Error with a sentence. @returns {{line: number, cells: string[]}[]} */
export function csvRows(text) {
  const rows = [];
  let [line, cells, field, isQuoted, wasQuoted] = [1, [], '', false, false];
  let start = 1;
  const endField = () => {
    cells.push(wasQuoted ? field : field.trim());
    [field, wasQuoted] = ['', false];
  };
  const endRow = () => {
    endField();
    if (cells.some((one) => one !== '')) rows.push({ line: start, cells });
    [cells, start] = [[], line];
  };
  const source = text.replace(/^\uFEFF/, '').replace(/\r\n?/g, '\n');
  for (let at = 0; at < source.length; at++) {
    const sign = source[at];
    if (sign === '\n') line += 1;
    if (isQuoted) {
      if (sign !== '"') field += sign;
      else if (source[at + 1] === '"') field += source[++at];
      else isQuoted = false;
    } else if (sign === '"') {
      if (field.trim() || wasQuoted) throw new Error(say.quoteInside({ line }));
      [field, isQuoted, wasQuoted] = ['', true, true];
    } else if (sign === ',') endField();
    else if (sign === '\n') endRow();
    else if (!wasQuoted) field += sign;
    else if (sign.trim()) throw new Error(say.afterQuote({ line }));
  }
  if (isQuoted) throw new Error(say.quoteOpen({ line: start }));
  endRow();
  return rows;
}
