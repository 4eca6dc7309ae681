// Where panels and panes stand in a window of this size. Pure: the same window and choices give the same arrangement.

export const narrowestPane = 420; // px; panels never make a pane of two columns narrower
const narrowestOfRow = 190; // px, of the two panes beside the active one
const activeOfRow = 1.28; // width of the active pane of a row, in widths of the others
const lowestColumn = 560; // px; panes with less height stand in one row while a sheet is open
const lowestThree = 420; // px; the same without a sheet
const standardCells = { two: [1, 2], four: [1, 2, 3, 4] };
const [railPx, sectionPx, inspectorPx] = [48, 272, 320];
const touchHeights = 60 + 72 + 28; // banner, dock, status
const sheetPx = 328;
const narrowestDrawer = 560; // px, beside the panes
const lowestOfDrawer = 800; // px; in a window with less height panes above the drawer stand in one row

/** @returns {'wide'|'compact'|'tablet'|'phone'} */
export function sizeOf({ width, isCoarse }) {
  if (width < 600) return 'phone';
  if (isCoarse || width < 1100) return 'tablet';
  return width < 1400 ? 'compact' : 'wide';
}

/**
 * @param {{width: number, height: number, isCoarse: boolean}} window
 * @param {object} chosen layout '' (as suits the window), '2x2', '1+3', 'row', '2x1' or 'single'; two, four: the views in the panes of
 *   layouts of two, and of three and four; isTreeOpen; section: open in the overlay;
 *   isPinned; isInspectorOpen; sheet '', 'tree' or 'inspector'; drawer '', 'bottom' or 'right'; active, maximised: views
 * @returns {{size: string, tree: 'tree'|'rail'|'', overlay: ''|'floats'|'pushes', inspector: 'pushes'|'floats'|'folded'|'', sheet: string, drawer: ''|'bottom'|'right', layout: string, visible: number[]}}
 *   layout '1x2': two panes one above the other; 'row4': four in a row; visible: views, in the order of their panes
 */
export function arrange(window, chosen) {
  const size = sizeOf(window);
  if (size === 'tablet' || size === 'phone') return { ...onTouch(size, window, chosen), drawer: '' };
  if (chosen.drawer === 'right' && size === 'wide') return besideDrawer(window, chosen);
  return { ...onDesk(size, window, chosen), drawer: chosen.drawer ? 'bottom' : '' };
}

function onTouch(size, { width, height }, chosen) {
  const panels = { size, tree: '', overlay: '', inspector: '', sheet: chosen.sheet };
  const layout = size === 'phone' ? 'single' : chosen.layout || '1+3';
  const left = height - touchHeights - (chosen.sheet ? sheetPx : 0);
  if (layout === '2x1') return { ...panels, ...panes(width > height ? '2x1' : '1x2', chosen) };
  const isLow = left < (chosen.sheet ? lowestColumn : lowestThree) && width > height;
  return { ...panels, ...panes(isLow && layout !== 'single' ? 'row4' : layout, chosen) };
}

/** The drawer beside the panes has the place of the tree, which goes behind the rail; two panes stand one above the other. */
function besideDrawer({ width }, chosen) {
  const layout = chosen.maximised || chosen.layout === 'single' ? 'single' : '1x2';
  const fits = width - railPx - (chosen.isInspectorOpen ? inspectorPx : railPx) - narrowestPane >= narrowestDrawer;
  const inspector = chosen.isInspectorOpen ? (fits ? 'pushes' : 'floats') : 'folded';
  return {
    size: 'wide',
    tree: 'rail',
    sheet: '',
    inspector,
    overlay: chosen.section ? 'floats' : '',
    drawer: 'right',
    ...panes(layout, chosen),
  };
}

function onDesk(size, { width, height }, chosen) {
  const tree = size === 'wide' && chosen.isTreeOpen ? 'tree' : 'rail';
  const left = tree === 'tree' ? sectionPx : railPx;
  const section = tree === 'rail' && chosen.section ? sectionPx : 0;
  const inspector = chosen.isInspectorOpen ? inspectorPx : railPx;
  const isLow = Boolean(chosen.drawer) && height < lowestOfDrawer;
  const asChosen = chosen.maximised ? 'single' : chosen.layout || '2x2';
  const layout = isLow && ['2x2', '1+3'].includes(asChosen) ? 'row' : asChosen;
  // from 1400 px on both panels fit beside two columns, as they get a little narrower there (room.css)
  const fits = (aside, columns) => (size === 'wide' && !section) || (width - left - aside) / columns >= narrowestPane;
  const fitsRow = (aside) => (width - left - aside) / (2 + activeOfRow) >= narrowestOfRow;
  const columns = ['2x2', '1+3', '2x1'].includes(layout) ? 2 : 1;
  const place = (isPushing) => ({ overlay: section ? (isPushing ? 'pushes' : 'floats') : '' });
  const isRowOrFits = (aside) => (layout === 'row' ? fitsRow(aside) : fits(aside, columns));
  const pushes = { size, tree, sheet: '', inspector: chosen.isInspectorOpen ? 'pushes' : 'folded' };
  const floats = { ...pushes, inspector: chosen.isInspectorOpen ? 'floats' : 'folded' };
  if (section && chosen.isPinned) {
    if (isRowOrFits(section + inspector)) return { ...pushes, ...place(true), ...panes(layout, chosen) };
    if (columns === 2 && layout !== '2x1' && fitsRow(section + inspector)) return { ...pushes, ...place(true), ...panes('row', chosen) };
  }
  if (isRowOrFits(inspector)) return { ...pushes, ...place(false), ...panes(layout, chosen) };
  return { ...floats, ...place(false), ...panes(layout, chosen) };
}

/** A row shows three of the four panes: the last one stays away, or the third one while the last is active. */
function panes(layout, { active, maximised, two = standardCells.two, four = standardCells.four }) {
  if (maximised || layout === 'single') return { layout: 'single', visible: [maximised || active] };
  if (layout === '2x1' || layout === '1x2') return { layout, visible: two };
  if (layout === 'row') return { layout, visible: [four[0], four[1], active === four[3] ? four[3] : four[2]] };
  return { layout, visible: four };
}
