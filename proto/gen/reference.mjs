// reference.html: everything that proto/ describes, as a page for people.
import { packetsSection } from './packets.mjs';
import { rightsSection } from './rights.mjs';
import { sentencesSection } from './sentences.mjs';

const escape = (text) => String(text).replace(/[&<>"]/g, (c) => ({ '&': '&amp;', '<': '&lt;', '>': '&gt;', '"': '&quot;' })[c]);

const aThing = (word) => `${/^[aeiou]/.test(word) ? 'an' : 'a'} ${word}`;

function typeWords(field, enums) {
  switch (field.type) {
    case 'enum':
      return enums[field.enum].values.map(([word]) => `<code>${escape(word)}</code>`).join(' or ');
    case 'object':
      return `<a href="#object-${field.object}">${field.object}</a>`;
    case 'list':
      return `list of <a href="#object-${field.object}">${field.object}</a>, at most ${field.max_items}${field.ascending ? `, in ascending order of ${field.ascending}` : ''}; a patch replaces it whole`;
    case 'map':
      return `map from ${field.names ? `the id of ${aThing(field.names)} of the plan` : 'id'} to <a href="#object-${field.object}">${field.object}</a>, at most ${field.max_items}`;
    case 'id':
      return field.names ? `id of ${aThing(field.names)} of the plan` : 'id';
    case 'vec3':
      return `three numbers${field.unit ? ` (${field.unit})` : ''}, patient LPS`;
    case 'direction':
      return 'three numbers, patient LPS: a direction, of any length but 0';
    case 'size':
      return 'width and height in pixels';
    case 'patch':
      return 'merge patch';
    case 'json':
    case 'document':
      return 'object';
    case 'matrix':
      return '16 numbers';
    default:
      return field.type + (field.unit ? ` (${field.unit})` : '');
  }
}

function rows(fields, enums) {
  return fields
    .map((f) => {
      const range =
        f.min !== undefined && f.max !== undefined ? `${f.min} to ${f.max}` : f.max !== undefined ? `at most ${f.max} characters` : '';
      const fallback = f.required ? 'required' : f.nullable ? 'null' : f.default === undefined ? '' : JSON.stringify(f.default);
      return `<tr><td><code>${escape(f.name)}</code></td><td>${typeWords(f, enums)}</td><td>${escape(range)}</td><td>${escape(fallback)}</td><td>${escape(f.about)}</td></tr>`;
    })
    .join('\n');
}

export const tableOf = (fields, enums) =>
  `<table><thead><tr><th>Field</th><th>Type</th><th>Range</th><th>Default</th><th>Meaning</th></tr></thead><tbody>\n${rows(fields, enums)}\n</tbody></table>\n`;

export function referencePage(scene, messages, packets, problems, codes, sentences, rights) {
  const enums = { ...scene.enums, ...messages.enums };
  let body = '<h1>Beamroom reference</h1>\n<p><a href="/api/v1/openapi.json">OpenAPI description of the HTTP API</a></p>\n';
  body += `<h2>Scene and view</h2>\n<p>${escape(scene.about)}</p>\n`;
  for (const [name, document] of Object.entries(scene.documents))
    body += `<h3 id="document-${name}">${name}</h3>\n<p>${escape(document.about)}</p>\n${tableOf(document.fields, enums)}`;
  for (const [name, object] of Object.entries(scene.objects))
    body += `<h3 id="object-${name}">${name}</h3>\n<p>${escape(object.about)}</p>\n${tableOf(object.fields, enums)}`;
  body += '<h2>Words</h2>\n';
  for (const [name, description] of Object.entries(enums))
    body += `<h3>${name}</h3>\n<p>${escape(description.about)}</p>\n<ul>${description.values.map(([word, about, rights]) => `<li><code>${escape(word)}</code>: ${escape(about)}${rights ? `; rights: ${escape(rights.join(', '))}` : ''}</li>`).join('')}</ul>\n`;
  body += `<h2>WebSocket messages</h2>\n<p>${escape(messages.about)}</p>\n`;
  for (const message of messages.messages)
    body += `<h3 id="message-${escape(message.name)}">${escape(message.name)} <small>from the ${message.from === 'client' ? 'page' : 'server'}</small></h3>\n<p>${escape(message.about)}${message.needs ? ` Right: <code>${message.needs[0]}</code>.` : ''}</p>\n${tableOf(message.fields, enums)}`;
  body += rightsSection(rights, escape);
  body += packetsSection(packets, escape, tableOf);
  body +=
    `<h2 id="problems">Problems</h2>\n<p>${escape(problems.about)}</p>\n<table><thead><tr><th>Type</th><th>Status</th><th>Title</th><th>What to do</th></tr></thead><tbody>\n` +
    problems.problems
      .map(
        (p) =>
          `<tr id="problem-${p.word}"><td><code>/problems/${p.word}</code></td><td>${p.status}</td><td>${escape(p.title)}</td><td>${escape(p.about)}</td></tr>`,
      )
      .join('\n') +
    '\n</tbody></table>\n';
  body +=
    '<h2 id="report">Load report</h2>\n<p>What a plan\'s report may say; each line has one of these codes, a severity (note, warning, error), a sentence with the figures, and the file it is about.</p>\n' +
    '<table><thead><tr><th>Code</th><th>Meaning</th><th>What to do</th></tr></thead><tbody>\n' +
    codes
      .map(
        (c) =>
          `<tr id="report-${escape(c.code)}"><td><code>${escape(c.code)}</code></td><td>${escape(c.meaning)}</td><td>${escape(c.remedy)}</td></tr>`,
      )
      .join('\n') +
    '\n</tbody></table>\n';
  body += sentencesSection(sentences, escape);
  return `<!doctype html>\n<html lang="en">\n<meta charset="utf-8">\n<title>Beamroom reference</title>\n<link rel="icon" href="../icon.svg">\n<link rel="stylesheet" href="../css/reference.css">\n<main>\n${body}</main>\n</html>\n`;
}
