// Widths of the tree and the inspector, height of the drawer, shares of the panes, as a person has dragged them. Pure; CSS px and shares of 1.

const px = { tree: [200, 420], inspector: [280, 480], drawer: [140, Infinity] };
const standard = { tree: 272, inspector: 320, drawer: 220, columns: 0.5, large: 2.1 / 3.1, rows: 0.5 };
const leastShare = 0.2;
const leastPane = 300; // px: what tree and inspector leave to a pane, dragged
const railPx = 48;
const clamp = (value, low, high) => Math.min(Math.max(value, low), Math.max(low, high));

/** Parts of a splitter's name by the layout of the panes; '' none. large: the first pane of one large and three small ones. */
const columnsOf = { '2x2': 'columns', '2x1': 'columns', '1+3': 'large' };
const rowsOf = { '2x2': 'rows', '1x2': 'rows' };

/** Splits that the browser kept; entries that are none are left out. */
export const readSplits = (kept) =>
  Object.fromEntries(Object.entries(kept ?? {}).filter(([name, value]) => Object.hasOwn(standard, name) && Number.isFinite(value)));

/**
 * The splitters that this arrangement has, by name: which value they set, where it stands and between what.
 * @param {Record<string, number>} chosen what a person dragged; the others stand where they always do
 * @param {{size, tree, inspector, drawer, layout}} arrangement of arrangement.js @param {{width: number, height: number}} window @param {number} mainPx height of the panes with the drawer
 * @returns {{name: string, key: string, isAcross: boolean, value: number, low: number, high: number, isChosen: boolean}[]} isAcross: it moves up and down
 */
export function splittersOf(chosen, { size, tree, inspector, drawer, layout }, window, mainPx = window.height) {
  if (size === 'tablet' || size === 'phone') return [];
  const isOpen = { tree: tree === 'tree', inspector: inspector === 'pushes', drawer: drawer === 'bottom' };
  const nColumns = { '2x2': 2, '2x1': 2, '1+3': 2, row: 3, row4: 4 }[layout] ?? 1;
  const widthOf = (name) => (isOpen[name] ? clamp(chosen[name] ?? standard[name], ...px[name]) : 0);
  const found = [];
  for (const name of ['tree', 'inspector']) {
    if (!isOpen[name]) continue;
    const other = name === 'tree' ? widthOf('inspector') || railPx : widthOf('tree') || railPx;
    const [low, high] = px[name];
    const most = Math.max(standard[name], Math.min(high, window.width - other - nColumns * leastPane));
    found.push({ name, key: name, isAcross: false, value: clamp(chosen[name] ?? standard[name], low, most), low, high: most });
  }
  if (isOpen.drawer) {
    const [low] = px.drawer;
    const high = Math.max(low, Math.floor(mainPx / 2));
    found.push({ name: 'drawer', key: 'drawer', isAcross: true, value: clamp(chosen.drawer ?? standard.drawer, low, high), low, high });
  }
  const share = (name, key, isAcross) => {
    const value = clamp(chosen[key] ?? standard[key], leastShare, 1 - leastShare);
    found.push({ name, key, isAcross, value, low: leastShare, high: 1 - leastShare });
  };
  if (columnsOf[layout]) share('columns', columnsOf[layout], false);
  if (rowsOf[layout]) share('rows', rowsOf[layout], true);
  return found.map((one) => ({ ...one, isChosen: chosen[one.key] !== undefined }));
}

/** The style variables of these splitters; those that nobody dragged have none. @returns {Record<string, string>} */
export function splitVariables(splitters) {
  const all = {
    '--tree': '',
    '--inspector': '',
    '--drawer': '',
    '--columns': '',
    '--columns-rest': '',
    '--column-at': '',
    '--rows': '',
    '--rows-rest': '',
    '--row-at': '',
  };
  for (const { name, value, isChosen } of splitters)
    if (name === 'columns' || name === 'rows') {
      const one = name === 'columns' ? '--column-at' : '--row-at';
      all[one] = String(value);
      if (isChosen) Object.assign(all, { [`--${name}`]: `${value}fr`, [`--${name}-rest`]: `${1 - value}fr` });
    } else if (isChosen) all[`--${name}`] = `${Math.round(value)}px`;
  return all;
}
