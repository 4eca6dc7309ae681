// Reads the codes of load reports from core/report/report_codes.h, X("code", "meaning", "what to do"), for the reference
// page.
const words = '((?:"(?:[^"\\\\]|\\\\.)*"\\s*)+)';
const entry = new RegExp(`X\\(\\s*${words},\\s*${words},\\s*${words}\\)`, 'g');

/** One string of adjacent C string literals. */
const joined = (literals) => [...literals.matchAll(/"((?:[^"\\]|\\.)*)"/g)].map(([, text]) => JSON.parse(`"${text}"`)).join('');

export function reportCodes(header) {
  const codes = [...header.replace(/\\\n/g, ' ').matchAll(entry)].map(([, code, meaning, remedy]) => ({
    code: joined(code),
    meaning: joined(meaning),
    remedy: joined(remedy),
  }));
  const expected = (header.match(/\bX\("/g) ?? []).length;
  if (codes.length !== expected || codes.length === 0)
    throw new Error(`report_codes.h: ${codes.length} of ${expected} codes could be read`);
  return codes.sort((a, b) => (a.code < b.code ? -1 : 1));
}
