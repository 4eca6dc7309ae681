// Names, declarations and initial values in C for the fields and enums of a description.
export const upper = (text) => text.replace(/[^a-z0-9]+/gi, '_').toUpperCase();
export const lower = (text) => text.replace(/[^a-z0-9]+/gi, '_').toLowerCase();
export const notice = '/* Generated from proto/; change it there. */\n';

/** C declaration of a field in a struct. prefix begins the names of the enums and objects of the field's description. */
export function declaration(field, prefix) {
  const has = field.nullable && field.type !== 'json' ? `    bool has_${field.name};\n` : '';
  const about = ` /* ${field.about} */`;
  const line = (text) => `${has}    ${text};${about}\n`;
  switch (field.type) {
    case 'bool':
      return line(`bool ${field.name}`);
    case 'number':
      return line(`double ${field.name}`);
    case 'integer':
      return line(`int64_t ${field.name}`);
    case 'enum':
      return line(`enum ${prefix}_${field.enum} ${field.name}`);
    case 'color':
      return line(`uint32_t ${field.name}_rgb`); // 0xrrggbb
    case 'id':
      return line(`char ${field.name}[64]`);
    case 'text':
      return line(`char ${field.name}[${textBytes(field)}]`);
    case 'vec3':
    case 'direction':
      return line(`struct vec3 ${field.name}`);
    case 'size':
      return line(`int ${field.name}[2]`);
    case 'object':
      return line(`struct ${prefix}_${field.object} ${field.name}`);
    case 'list':
      return `    size_t n_${field.name};\n    struct ${prefix}_${field.object} *${field.name};${about}\n`;
    case 'map':
      return `    size_t n_${field.name};\n    struct ${prefix}_${field.object}_entry *${field.name};${about}\n`;
    case 'patch':
      return line(`char *${field.name}_json`); // owned text, NULL: none
    case 'json':
      return line(`cJSON *${field.name}`);
    default:
      throw new Error(`field ${field.name}: unknown type ${field.type}`);
  }
}

export const member = (field) => field.name + ({ color: '_rgb', patch: '_json' }[field.type] ?? '');
export const textBytes = (field) => field.max * 4 + 1; // UTF-8

/** C initializer of a field's default. objects: descriptions by name. */
export function initializer(field, prefix, objects) {
  const value = field.default;
  switch (field.type) {
    case 'bool':
      return String(Boolean(value));
    case 'number':
    case 'integer':
      return String(value ?? field.min ?? 0);
    case 'enum':
      return value === undefined ? '0' : `${upper(prefix)}_${upper(field.enum)}_${upper(value)}`;
    case 'color':
      return `0x${value.slice(1)}`;
    case 'id':
    case 'text':
      return JSON.stringify(value ?? '');
    case 'vec3':
    case 'direction':
      return `{ ${(value ?? [0, 0, 0]).join(', ')} }`;
    case 'size':
      return `{ ${(value ?? [0, 0]).join(', ')} }`;
    case 'object':
      return objectInitializer(objects[field.object], prefix, objects);
    case 'list':
    case 'map':
    case 'patch':
    case 'json':
      return 'NULL';
    default:
      throw new Error(field.type);
  }
}

export function objectInitializer(object, prefix, objects) {
  return `{ ${object.fields.map((f) => `.${member(f)} = ${initializer(f, prefix, objects)}`).join(', ')} }`;
}

export function enumDeclaration(name, description, prefix) {
  const values = description.values.map(([word, about]) => `    ${upper(prefix)}_${upper(name)}_${upper(word)}, /* ${about} */`);
  return `/* ${description.about} */\nenum ${prefix}_${name} {\n${values.join('\n')}\n};\n\n`;
}
