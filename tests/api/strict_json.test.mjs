// The reader of JSON that the API tests use.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { parseStrict } from './strict_json.mjs';

test('a name that stands twice in one object is found, wherever it is and however it is written', () => {
  for (const [text, where] of [
    ['{"home":1,"home":1}', '/home'],
    ['{"a":[0,{"b":{},"c":[],"b":2}]}', '/a/1/b'],
    ['{"a":{"x":1},"b":[{"x":1}],"\\u0061":3}', '/a'],
    ['[{"k":"}"},{"k":"k","j":"\\"k\\":","k":null}]', '/1/k'],
  ])
    assert.throws(() => parseStrict(text), { name: 'SyntaxError', message: `${where} stands twice` }, text);
});

test('what JSON allows is read as it is', () => {
  for (const text of [
    '{"a":{"a":{"a":"a"}},"b":["a","a",{"a":1},{"a":1}]}',
    '"{\\"a\\":1,\\"a\\":2}"',
    '[]',
    ' {"" : -1.5e-3 , "x":[[],{}]} ',
    'null',
  ])
    assert.deepEqual(parseStrict(text), JSON.parse(text));
  assert.throws(() => parseStrict('{"a":1,}'), SyntaxError);
});
