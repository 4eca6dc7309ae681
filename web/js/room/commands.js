// The commands that keys give, with the keys that they have until a person changes them: the one table for keys, their list, tooltips and tests. Pure.

/** In the order of the list (shell/help.js). Keys as comboOf() names them. @type {Record<string, string[]>} */
export const commands = {
  zoomIn: ['+', '='],
  zoomOut: ['-'],
  rollLeft: [','],
  rollRight: ['.'],
  fit: ['G'],
  reset: ['R', 'Space'],
  beamEye: ['B'],
  window: ['W'],
  zoom: ['Z'],
  measure: ['M'],
  clips: ['C'],
  caps: ['K'],
  drawer: ['V'],
  wash: ['D'],
  lines: ['I'],
  tracks: ['T'],
  pin: ['Q'],
  point: ['P'],
  askToLook: ['Shift+P'],
  nextCase: ['Shift+N'],
  note: ['N'],
  follow: ['F'],
  undo: ['Ctrl+Z'],
  redo: ['Ctrl+Shift+Z', 'Ctrl+Y'],
  help: ['?'],
};

const alone = ['', 'Control', 'Shift', 'Alt', 'AltGraph', 'Meta', 'Dead', 'Unidentified', 'Process'];

/**
 * "W", "Shift+P", "Ctrl+Z", "Space", "?": what is pressed, the same on every keyboard. Digits count by their place, as do letters that are not Latin; any
 * other sign counts without the keys that it takes to write it.
 * @param {KeyboardEvent} event @returns {string} '' for a key that only goes with others
 */
export function comboOf(event) {
  const { key = '', code = '' } = event;
  if (alone.includes(key)) return '';
  const isAltGraph = Boolean(event.getModifierState?.('AltGraph'));
  const digit = isAltGraph ? undefined : /^Digit(\d)$/.exec(code)?.[1];
  const isLetter = key.length === 1 && key.toLowerCase() !== key.toUpperCase();
  const letter = /^[a-z]$/i.test(key) ? key : (/^Key([A-Z])$/.exec(code)?.[1] ?? key);
  const isSign = !digit && !isLetter && key.length === 1 && key !== ' ';
  const name = digit ?? (isLetter ? letter.toUpperCase() : key === ' ' ? 'Space' : key);
  const isWith = (is) => is && !(isSign && isAltGraph);
  return [isWith(event.ctrlKey || event.metaKey) && 'Ctrl', isWith(event.altKey) && 'Alt', event.shiftKey && !isSign && 'Shift', name]
    .filter(Boolean)
    .join('+');
}

/** A single sign: a key that speech or a bump may write (WCAG 2.1.4). */
export const isSingle = (combo) => combo !== ' ' && [...combo.replace(/^Shift\+(?=.)/, '')].length === 1;
