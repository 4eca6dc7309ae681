// Keys of the page: commands act on the active pane from anywhere but text fields, selects and dialogs.
const texts = 'input:not([type=range]):not([type=checkbox]):not([type=radio]), textarea, [contenteditable]';
const dialogs = '[role="dialog"], [role="alertdialog"], [role="menu"], dialog';
const withKeys = 'button, a, input, summary, [tabindex], [role="treeitem"]'; // arrows, Enter and Space are theirs

/** Where a key was pressed: `isText` text is written there, `isTaken` a field or dialog has all keys, `isOwn` it has arrows, Enter and Space. */
function placeOf({ target }) {
  const isIn = (selector) => Boolean(target.closest?.(selector));
  const isText = isIn(texts);
  return { isText, isTaken: isText || isIn('select') || isIn(dialogs), isOwn: isIn(withKeys) };
}

/**
 * A pane that has the focus takes its keys first (pane.js); what it leaves comes here.
 * @param {EventTarget} target the window @param {{ui, room, undo, panes: () => object[]}} world
 * @param {() => boolean} isCovered a dialog lies over the panes @returns {() => void} stops it
 */
export function listenKeys(target, { ui, room, undo, panes }, isCovered) {
  const onKey = (event) => {
    if (event.key === 'Escape') return void ui.escape(() => room.pointers.stop() || room.following.return());
    const { isText, isTaken, isOwn } = placeOf(event);
    if (event.defaultPrevented || isText) return;
    const command = ui.keys.commandOf(event);
    if (command === 'help') ui.toggle('help');
    else if (command === 'undo' || command === 'redo') undo[command]();
    else if (isTaken || isCovered() || event.target.closest?.('.picture')) return;
    else if (!panes()[ui.active.peek() - 1]?.actions.key(event, !isOwn)) return;
    event.preventDefault();
  };
  target.addEventListener('keydown', onKey);
  return () => target.removeEventListener('keydown', onKey);
}
