// Values and listeners of a lit-html template, without a browser.

/** @returns {{text: string, functions: Function[]}} its values, and those of templates in it; functions: its listeners, in their order */
export function drawn(template) {
  const [texts, functions] = [[], []];
  const walk = (value) => {
    const [list, , row] = value?._$litDirective$ && Array.isArray(value.values[0]) ? value.values : [];
    if (row)
      walk(list.map(row)); // repeat
    else if (typeof value === 'function') functions.push(value);
    else if (Array.isArray(value)) value.forEach(walk);
    else if (value && typeof value === 'object') Object.values(value.values ?? {}).forEach(walk);
    else if (typeof value !== 'symbol') texts.push(String(value));
  };
  walk(template);
  return { text: texts.join(' '), functions };
}
