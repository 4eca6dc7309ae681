// The text of each page of a PDF file as Chromium prints it: streams by Flate, fonts of one-byte or (Type 0) two-byte glyphs
// with ToUnicode maps, ActualText instead of some (ISO 32000-1, 7.3, 9.4, 9.10.3, 14.9.4). No general reader of PDF.
import { inflateSync } from 'node:zlib';

function objectsOf(text) {
  const objects = new Map();
  for (const [, number, body] of text.matchAll(/(?:^|\n)(\d+) 0 obj\s([\s\S]*?)\nendobj/g)) objects.set(Number(number), body);
  return objects;
}

function streamOf(body) {
  const start = body.indexOf('stream\n') + 7;
  const bytes = Buffer.from(body.slice(start, body.lastIndexOf('\nendstream')), 'latin1');
  return (/\/Filter\s*\/FlateDecode/.test(body) ? inflateSync(bytes) : bytes).toString('latin1');
}

const units = (hex, digits = 4) => (hex.match(new RegExp(`.{${digits}}`, 'g')) ?? []).map((unit) => parseInt(unit, 16));

/** Reads the map from glyphs to text. */
function mapOf(cmap) {
  const map = new Map();
  for (const [, block] of cmap.matchAll(/beginbfchar([\s\S]*?)endbfchar/g))
    for (const [, from, to] of block.matchAll(/<([0-9a-f]+)>\s*<([0-9a-f]+)>/gi))
      map.set(parseInt(from, 16), String.fromCharCode(...units(to)));
  for (const [, block] of cmap.matchAll(/beginbfrange([\s\S]*?)endbfrange/g))
    for (const [, low, high, to] of block.matchAll(/<([0-9a-f]+)>\s*<([0-9a-f]+)>\s*<([0-9a-f]+)>/gi))
      for (let glyph = parseInt(low, 16); glyph <= parseInt(high, 16); glyph++)
        map.set(glyph, String.fromCharCode(units(to)[0] + glyph - parseInt(low, 16)));
  return map;
}

/** @param {Buffer} pdf @returns {string[]} by page, without spaces between the parts of a line */
export function textOfPages(pdf) {
  const objects = objectsOf(pdf.toString('latin1'));
  const pages = [...objects.values()].filter((body) => /\/Type\s*\/Page\b/.test(body));
  return pages.map((page) => {
    const fonts = new Map();
    for (const [, name, number] of page.matchAll(/\/(F\d+)\s+(\d+) 0 R/g)) {
      const unicode = objects.get(Number(number))?.match(/\/ToUnicode\s+(\d+) 0 R/);
      if (unicode)
        fonts.set(name, {
          map: mapOf(streamOf(objects.get(Number(unicode[1])))),
          digits: /\/Type0\b/.test(objects.get(Number(number))) ? 4 : 2,
        });
    }
    const content = streamOf(objects.get(Number(page.match(/\/Contents\s+(\d+) 0 R/)[1])));
    let font = { map: new Map(), digits: 2 };
    let isReplaced = false; // glyphs until EMC stand for an ActualText
    let text = '';
    for (const [, name, literal, hex, glyphs, end] of content.matchAll(
      /\/(F\d+)\s+[\d.]+\s+Tf|\/ActualText\s*(?:\(((?:[^\\)]|\\.)*)\)|<([0-9A-Fa-f]+)>)|<([0-9A-Fa-f]+)>\s*Tj|\b(EMC)\b/g,
    )) {
      if (name) font = fonts.get(name) ?? font;
      else if (end) isReplaced = false;
      else if (glyphs && !isReplaced)
        text += units(glyphs, font.digits)
          .map((glyph) => font.map.get(glyph) ?? '')
          .join('');
      else if (literal !== undefined || hex) {
        isReplaced = true;
        text += literal?.replace(/\\(.)/g, '$1') ?? String.fromCharCode(...units(hex.replace(/^FEFF/i, '')));
      }
    }
    return text;
  });
}
