// Shows characters that do not show, and change how others show, as tags: names of files and people may hold them, so that two
// names look alike or one reads backwards. The rule of captions: core/base/invisible.h.
const tags = {
  0xad: 'SHY',
  0x61c: 'ALM',
  0x180e: 'MVS',
  0x200b: 'ZWSP',
  0x200c: 'ZWNJ',
  0x200d: 'ZWJ',
  0x200e: 'LRM',
  0x200f: 'RLM',
  0x2028: 'LSEP',
  0x2029: 'PSEP',
  0x202a: 'LRE',
  0x202b: 'RLE',
  0x202c: 'PDF',
  0x202d: 'LRO',
  0x202e: 'RLO',
  0x2060: 'WJ',
  0x2061: 'FA',
  0x2062: 'IT',
  0x2063: 'IS',
  0x2064: 'IP',
  0x2066: 'LRI',
  0x2067: 'RLI',
  0x2068: 'FSI',
  0x2069: 'PDI',
  0x206a: 'ISS',
  0x206b: 'ASS',
  0x206c: 'IAFS',
  0x206d: 'AAFS',
  0x206e: 'NADS',
  0x206f: 'NODS',
  0xfeff: 'BOM',
};
const invisible = new RegExp(
  `[${Object.keys(tags)
    .map((code) => `\\u${Number(code).toString(16).padStart(4, '0')}`)
    .join('')}]`,
  'g',
);

/** The text with "«RLO»" for U+202E and the like. @param {string} text */
export function visibleText(text) {
  return text.replace(invisible, (character) => `«${tags[character.charCodeAt(0)]}»`);
}

const attributes = ['title', 'aria-label', 'alt', 'label', 'placeholder'];

/** Writes visible text where a node has other text. */
function show(node) {
  if (node.nodeType === 3) {
    if (node.data.search(invisible) >= 0 && node.parentNode?.localName !== 'textarea') node.data = visibleText(node.data);
    return;
  }
  if (node.nodeType !== 1) return;
  for (const name of attributes) {
    const value = node.getAttribute(name);
    if (value && value.search(invisible) >= 0) node.setAttribute(name, visibleText(value));
  }
  for (const child of node.childNodes) show(child);
}

/** Keeps all text below a node visible, also what comes later: before it is painted, and for readers of the screen. What a person
 * types stays as it is. @param {Node} root */
export function keepTextVisible(root) {
  new MutationObserver((changes) => {
    for (const { target, addedNodes, type } of changes)
      if (type === 'childList') addedNodes.forEach(show);
      else if (type === 'characterData') show(target);
      else
        for (const name of attributes)
          if (target.hasAttribute(name) && target.getAttribute(name).search(invisible) >= 0)
            target.setAttribute(name, visibleText(target.getAttribute(name)));
  }).observe(root, { subtree: true, childList: true, characterData: true, attributes: true, attributeFilter: attributes });
  show(root);
}
