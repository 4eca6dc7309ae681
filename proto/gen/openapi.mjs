// openapi.json of http.json and scene.json: the HTTP API in OpenAPI 3.1; and openapi.c, the same bytes for the daemon to
// serve.
function schemaOf(field, objects) {
  const about = { description: field.about };
  const nullable = (schema) => (field.nullable ? { oneOf: [schema, { type: 'null' }], ...about } : { ...schema, ...about });
  const range = { ...(field.min !== undefined && { minimum: field.min }), ...(field.max !== undefined && { maximum: field.max }) };
  switch (field.type) {
    case 'bool':
      return nullable({ type: 'boolean', default: field.default });
    case 'number':
      return nullable({ type: 'number', ...range, default: field.default });
    case 'integer':
      return nullable({ type: 'integer', ...range, default: field.default });
    case 'enum':
      return nullable({ type: 'string', enum: objects.enums[field.enum].values.map(([word]) => word), default: field.default });
    case 'color':
      return nullable({ type: 'string', pattern: '^#[0-9a-fA-F]{6}$', default: field.default });
    case 'id':
      return nullable({ type: 'string', pattern: '^[a-z0-9-]{0,63}$' });
    case 'text':
      return nullable({ type: 'string', maxLength: field.max });
    case 'vec3':
    case 'direction':
      return nullable({ type: 'array', items: { type: 'number', ...range }, minItems: 3, maxItems: 3 });
    case 'size':
      return nullable({ type: 'array', items: { type: 'integer', ...range }, minItems: 2, maxItems: 2, default: field.default });
    case 'object':
      return field.nullable ? nullable({ $ref: `#/components/schemas/${field.object}` }) : { $ref: `#/components/schemas/${field.object}` };
    case 'list':
      return { type: 'array', items: { $ref: `#/components/schemas/${field.object}` }, maxItems: field.max_items, ...about };
    case 'map':
      return {
        type: 'object',
        additionalProperties: { $ref: `#/components/schemas/${field.object}` },
        maxProperties: field.max_items,
        ...about,
      };
    default:
      return { type: 'object', ...about };
  }
}

/** The media types of an answer: a kind of its own, or the name of a schema in answers.json; files have that of their JSON form as well. */
const mediaOf = (kind, answers, name) => {
  const json = (schema) => ({ 'application/json': { schema } });
  const form = json(name ? { $ref: `#/components/schemas/answer.${name}` } : { type: 'object' });
  if (kind === 'json') return form;
  if (kind === 'image')
    return {
      'image/png': { schema: { type: 'string', format: 'binary' } },
      'image/jpeg': { schema: { type: 'string', format: 'binary' } },
    };
  if (kind === 'surface')
    return {
      ...form,
      ...Object.fromEntries(
        ['model/stl', 'application/octet-stream', 'model/gltf-binary'].map((type) => [
          type,
          { schema: { type: 'string', format: 'binary' } },
        ]),
      ),
    };
  if (kind === 'curves') return { ...form, 'text/csv': { schema: { type: 'string' } } };
  if (kind === 'scene') return json({ $ref: '#/components/schemas/scene' });
  if (`answer.${kind}` in answers) return json({ $ref: `#/components/schemas/answer.${kind}` });
  return { [kind]: { schema: { type: 'string' } } };
};

/** The fields of the message that a call stands for, but its number. */
const fieldsOf = (messages, name) => messages.messages.find((one) => one.name === name).fields.filter((field) => field.name !== 'input');

export function openapi(http, scene, answers, messages, version) {
  const schemas = {
    problem: {
      type: 'object',
      description: 'RFC 9457',
      required: ['type', 'title', 'status', 'detail'],
      properties: {
        type: { type: 'string' },
        title: { type: 'string' },
        status: { type: 'integer' },
        detail: { type: 'string' },
        detail_code: { type: 'string', description: 'Which sentence detail is; the reference lists them.' },
        detail_values: { type: 'object', description: 'The values of its places, by their names.' },
        instance: { type: 'string' },
        pointer: { type: 'string' },
        code: { type: 'string' },
        retry_after_ms: { type: 'integer' },
      },
    },
  };
  for (const group of [scene.objects, scene.documents])
    for (const [name, object] of Object.entries(group))
      schemas[name] = {
        type: 'object',
        description: object.about,
        additionalProperties: false,
        properties: Object.fromEntries(object.fields.map((f) => [f.name, schemaOf(f, scene)])),
      };
  Object.assign(schemas, answers);
  const paths = {};
  for (const route of http.routes) {
    const parameters = [...route.path.matchAll(/\{(\w+)\}/g)].map(([, name]) => ({
      name,
      in: 'path',
      required: true,
      schema: { type: 'string', pattern: '^[a-z0-9-]{1,63}$' },
    }));
    for (const [name, [type, about]] of Object.entries(route.query ?? {}))
      parameters.push({ name, in: 'query', required: about.includes('required'), description: about, schema: { type } });
    for (const [name, about] of Object.entries(route.headers ?? {}))
      parameters.push({ name, in: 'header', required: about.includes('required'), description: about, schema: { type: 'string' } });
    const responses = {};
    for (const [status, kind] of Object.entries(route.answers))
      responses[status] = { description: route.about, ...(kind && { content: mediaOf(kind, answers, route.schema) }) };
    responses.default = {
      description: `A problem: ${route.problems.join(', ') || 'internal'}.`,
      content: { 'application/problem+json': { schema: { $ref: '#/components/schemas/problem' } } },
    };
    const operation = {
      summary: route.about,
      parameters,
      responses,
      ...(route.needs && { 'x-needs': { right: route.needs[0], subject: route.needs[1] } }),
      ...(route.message && { 'x-message': route.message }),
    };
    if (route.body === 'scene')
      operation.requestBody = { required: true, content: { 'application/merge-patch+json': { schema: { type: 'object' } } } };
    else if (Array.isArray(route.body))
      operation.requestBody = {
        required: true,
        content: Object.fromEntries(route.body.map((type) => [type, { schema: { type: 'string', format: 'binary' } }])),
      };
    else if (route.body)
      operation.requestBody = {
        required: true,
        content: {
          'application/json': {
            schema: {
              type: 'object',
              additionalProperties: false,
              required: Object.entries(route.body)
                .filter(([, [, about]]) => about.includes('required'))
                .map(([name]) => name),
              properties: Object.fromEntries(
                Object.entries(route.body).map(([name, [type, about]]) => [name, { type, description: about }]),
              ),
            },
          },
        },
      };
    else if (route.message && route.method !== 'DELETE') {
      const fields = fieldsOf(messages, route.message);
      const schema = {
        type: 'object',
        additionalProperties: false,
        required: fields.filter(({ required }) => required).map(({ name }) => name),
        properties: Object.fromEntries(fields.map((field) => [field.name, schemaOf(field, messages)])),
      };
      operation.requestBody = { required: true, content: { 'application/json': { schema } } };
    }
    (paths[route.path] ??= {})[route.method.toLowerCase()] = operation;
  }
  return {
    openapi: '3.1.0',
    info: { title: 'Beamroom', version, description: `${http.about} ${http.ids}` },
    paths,
    components: { schemas },
  };
}

/** The document as a C array: a string literal of this length is more than ISO C lets a compiler promise. */
export function openapiSource(document) {
  const bytes = Buffer.from(JSON.stringify(document));
  const rows = [];
  for (let at = 0; at < bytes.length; at += 24) rows.push(`    ${[...bytes.subarray(at, at + 24)].join(',')},`);
  return (
    `/* Generated from proto/; change it there. */\n#include <stddef.h>\n\nextern const unsigned char openapi_json[];\nextern const size_t openapi_json_bytes;\n` +
    `const unsigned char openapi_json[] = {\n${rows.join('\n')}\n};\nconst size_t openapi_json_bytes = sizeof openapi_json;\n`
  );
}
