// The right that each route and each message needs: checks that every one names it, and writes rights_gen.h and rights_gen.c, the table
// that server/auth/access.c and the API read, and the section of the reference page.
import { notice, upper } from './names.mjs';

const wordsOf = (rows) => rows.map(([word]) => word);

/** A row of rights.json, as an object. member: the right of a member of a room that it stands for there. */
const rightOf = ([word, role, scope, about, member]) => ({ word, role, scope, about, member });

function need(is, where, sentence) {
  if (!is) throw new Error(`${where}: ${sentence}`);
}

function checkNeeds(thing, where, { rights, subjects }) {
  const needs = thing.needs;
  need(
    Array.isArray(needs) && needs.length === 2,
    where,
    'does not say what it needs: "needs": [right, subject], by the words of rights.json',
  );
  need(wordsOf(rights).includes(needs[0]), where, `needs the unknown right "${needs[0]}"`);
  need(wordsOf(subjects).includes(needs[1]), where, `needs a right on the unknown subject "${needs[1]}"`);
}

/** Whether the subject is what the address names: its first id is a room, so the subject is a room. */
function checkSubject({ method, path, needs: [right, subject] }) {
  const where = `${method} ${path}`;
  const named = /^\/[^{]*\{(\w+)\}/.exec(path)?.[1];
  const isOfAddress = ['plan', 'room', 'meeting', 'job', 'record', 'saved'];
  const isDoor = named === 'meeting' && right === 'free'; // by the token of a link in the body
  if (isOfAddress.includes(named) && !isDoor) need(subject === named, where, `is about a ${named}, so that is the subject of its right`);
  else need(!isOfAddress.includes(subject), where, `its address names no ${subject}`);
  need(right === 'free' ? subject === 'none' : true, where, 'what is free needs a right on "none"');
  need(subject !== 'none' || ['free', 'signed-in'].includes(right), where, `the right "${right}" is one on something`);
}

/** The rights (rights.json), with the routes, messages and questions, each of which says what it needs. routes: of http.json and of the questions. */
export function checkedRights(description, routes, messages) {
  const { rights, roles, scopes } = description;
  for (const { word, role, scope, about } of rights.map(rightOf)) {
    need(wordsOf(roles).includes(role), word, `unknown role "${role}"`);
    need(wordsOf(scopes).includes(scope), word, `unknown scope "${scope}"`);
    need(typeof about === 'string' && about !== '', word, 'needs a sentence');
  }
  const ofMembers = wordsOf(messages.enums.right.values);
  const rank = (role) => wordsOf(roles).indexOf(role === 'wall' ? 'observer' : role); // a wall is nobody's role on a plan
  for (const { word, role, member } of rights.map(rightOf)) {
    need(!member || ofMembers.includes(member), word, `stands for the unknown right "${member}" of members`);
    if (ofMembers.includes(word))
      for (const [given, , has] of messages.enums.member_role.values)
        need(
          has.includes(word) === rank(given) >= rank(role),
          word,
          `a member of role ${given} has it, and a person of that role has not, or the other way round`,
        );
  }
  for (const message of messages.messages)
    if (message.from === 'client') {
      checkNeeds(message, message.name, description);
      need(
        message.needs[1] === 'room' && ofMembers.includes(message.needs[0]),
        message.name,
        'a message needs a right of a member on the room',
      );
    } else need(message.needs === undefined, message.name, 'a message from the server needs no right');
  for (const route of routes) {
    const where = `${route.method} ${route.path}`;
    need(route.right === undefined, where, '"right" is the first word of "needs"');
    checkNeeds(route, where, description);
    checkSubject(route);
    if (route.needs[1] === 'room')
      need(memberRight(description, messages, route.needs[0]), where, `"${route.needs[0]}" is no right in a room`);
    need(
      route.message === undefined || messages.messages.find(({ name }) => name === route.message)?.needs[0] === route.needs[0],
      where,
      `does what the message "${route.message}" does, and needs its right`,
    );
  }
  return { ...description, routes };
}

/** The right of a member that this one stands for in a room. */
export function memberRight({ rights }, { enums }, word) {
  if (wordsOf(enums.right.values).includes(word)) return word;
  return rights.map(rightOf).find((right) => right.word === word)?.member;
}

/** The routes of rooms, each with the right of a member that it needs. */
export const roomRoutes = (checked, messages) =>
  checked.routes
    .filter(({ needs }) => needs[1] === 'room')
    .map(({ method, path, needs }) => ({ method, path, right: memberRight(checked, messages, needs[0]) }));

const enumOf = (prefix, rows, about) =>
  `/* ${about} */\nenum access_${prefix} {\n${rows.map(([word, ...rest]) => `    ACCESS_${prefix === 'right' ? '' : `${upper(prefix)}_`}${upper(word)}, /* ${rest.at(prefix === 'right' ? 2 : 0)} */`).join('\n')}\n    ACCESS_N_${upper(prefix)}S\n};\n\n`;

export const rightsHeader = ({ rights, roles, subjects }) =>
  `#pragma once\n${notice}\n` +
  enumOf('role', roles, 'What a person is on a subject; each has what those before it have.') +
  enumOf('right', rights, 'What a route or a message needs.') +
  enumOf('subject_kind', subjects, 'On what it is needed.') +
  `/* Of each right: its word, the role that has it, and the scope (enum identity_scope) of a token that has it. */
struct access_right_row {
    const char *word;
    enum access_role role;
    unsigned scope;
};
extern const struct access_right_row access_rights[ACCESS_N_RIGHTS];
extern const char *const access_role_words[ACCESS_N_ROLES];

/* Every route, also those of questions; the last one has no method. */
struct access_route {
    const char *method, *path; /* as in proto/http.json */
    enum access_right right;
    enum access_subject_kind subject;
};
extern const struct access_route access_routes[];
`;

export function rightsSource({ rights, roles, routes }) {
  const rows = rights
    .map(rightOf)
    .map(
      ({ word, role, scope }) => `    [ACCESS_${upper(word)}] = { "${word}", ACCESS_ROLE_${upper(role)}, IDENTITY_SCOPE_${upper(scope)} },`,
    );
  const list = routes.map(
    ({ method, path, needs: [right, subject] }) =>
      `    { "${method}", "${path}", ACCESS_${upper(right)}, ACCESS_SUBJECT_KIND_${upper(subject)} },`,
  );
  return (
    `${notice}#include "rights_gen.h"\n\n#include <stddef.h>\n\n#include "server/wire/identity.h"\n\n` +
    `const struct access_right_row access_rights[ACCESS_N_RIGHTS] = {\n${rows.join('\n')}\n};\n` +
    `const char *const access_role_words[ACCESS_N_ROLES] = { ${wordsOf(roles)
      .map((word) => `"${word}"`)
      .join(', ')} };\n` +
    `const struct access_route access_routes[] = {\n${list.join('\n')}\n    { NULL, NULL, ACCESS_FREE, ACCESS_SUBJECT_KIND_NONE },\n};\n`
  );
}

/** The section of the reference page. */
export function rightsSection({ about, rights, roles, subjects, routes }, escape) {
  const list = (rows) => `<ul>${rows.map(([word, text]) => `<li><code>${escape(word)}</code>: ${escape(text)}</li>`).join('')}</ul>\n`;
  const table = (head, rows) =>
    `<table><thead><tr>${head.map((word) => `<th>${word}</th>`).join('')}</tr></thead><tbody>\n${rows
      .map((row) => `<tr>${row.map((cell) => `<td>${escape(cell)}</td>`).join('')}</tr>`)
      .join('\n')}\n</tbody></table>\n`;
  return (
    `<h2 id="rights">Rights</h2>\n<p>${escape(about)}</p>\n<h3>Roles</h3>\n${list(roles)}` +
    table(
      ['Right', 'From role', 'Token scope', 'Meaning'],
      rights.map(rightOf).map(({ word, role, scope, about: text }) => [word, role, scope, text]),
    ) +
    `<h3>Subjects</h3>\n${list(subjects)}<h3>Calls</h3>\n` +
    table(
      ['Call', 'Right', 'Subject'],
      routes.map(({ method, path, needs }) => [`${method} ${path}`, ...needs]),
    )
  );
}
