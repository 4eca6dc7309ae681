// Reading the list of report codes from the C header, for the reference page.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { reportCodes } from '../../../../proto/gen/report_codes.mjs';

test('every code of the list is read, over line ends and joined strings', () => {
  const header = '#define REPORT_CODES(X) \\\n X("b.one", "It \\"is\\" so.", "Do " "it.") \\\n X("a.two", "M", \\\n   "R, (really)")\n';
  assert.deepEqual(reportCodes(header), [
    { code: 'a.two', meaning: 'M', remedy: 'R, (really)' },
    { code: 'b.one', meaning: 'It "is" so.', remedy: 'Do it.' },
  ]);
});

test('a code that cannot be read is an error, not a gap', () => {
  assert.throws(() => reportCodes('X("a.one", "M", "R")\nX("b.two", "M")\n'), /1 of 2/);
});

test('the real list has a meaning and a remedy for each code, and no code twice', () => {
  const codes = reportCodes(readFileSync(new URL('../../../../core/report/report_codes.h', import.meta.url), 'utf8'));
  assert.ok(codes.length > 60);
  assert.equal(new Set(codes.map((c) => c.code)).size, codes.length);
  for (const c of codes) assert.ok(c.meaning.endsWith('.') && c.remedy.endsWith('.'), c.code);
});
