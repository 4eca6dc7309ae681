// A message of each kind that a page sends, with a value in each field that is required: what is needed to see whether it is refused for want of a right.
import { readFileSync } from 'node:fs';

const read = (name) => JSON.parse(readFileSync(new URL(`../../proto/${name}.json`, import.meta.url), 'utf8'));
const messages = read('messages');
const { rights } = read('rights');

/** The messages of proto/messages.json that a member sends. */
export const sent = messages.messages.filter(({ from, name }) => from === 'client' && name !== 'hello');
/** The right of a member that a right stands for in a room: rights.json has it last, where it is another. */
export const rightOfMember = (word) => rights.find(([right]) => right === word)[4] ?? word;

/** A value that the field takes. */
function valueOf(field) {
  switch (field.type) {
    case 'integer':
    case 'number':
      return field.min;
    case 'bool':
      return field.default ?? true;
    case 'enum':
      return messages.enums[field.enum].values[0][0];
    case 'vec3':
    case 'direction':
      return [1, 1, 1];
    case 'text':
    case 'id':
      return 'x';
    default:
      return {};
  }
}

export const messageOf = ({ name, fields }) => ({
  type: name,
  ...Object.fromEntries(fields.filter(({ required }) => required).map((field) => [field.name, valueOf(field)])),
});

/** Sends the message and waits for what comes of it. Resolves to whether it was refused for want of a right. @param {import('./ws_client.mjs').Client} client */
export async function isRefused(client, message) {
  const from = client.messages.length;
  const time = Math.floor(performance.now() * 1000);
  client.send(messageOf(message));
  client.send({ type: 'ping', time_ms: time }); // answered in order
  await client.message('pong', ({ time_ms }) => time_ms === time, from);
  return client.messages
    .slice(from)
    .some(({ type, to, problem }) => type === 'problem' && to === message.name && problem.code === 'role' && problem.status === 403);
}
