// One tab stop for a row or column of buttons: inside it the arrow keys, Home and End move the focus.

/** A keydown listener of the element around the buttons. In a toolbar the keys only move; in tabs and segments they choose too. */
export function roving(event) {
  const buttons = [...event.currentTarget.querySelectorAll('button:not([disabled])')].filter(
    (button) => button.getClientRects().length > 0,
  );
  const at = buttons.indexOf(event.target.closest('button'));
  const next = {
    ArrowRight: at + 1,
    ArrowDown: at + 1,
    ArrowLeft: at - 1,
    ArrowUp: at - 1,
    Home: 0,
    End: buttons.length - 1,
  }[event.key];
  if (next === undefined || at < 0 || event.altKey || event.ctrlKey || event.metaKey) return;
  const button = buttons[(next + buttons.length) % buttons.length];
  button.focus();
  if (event.currentTarget.getAttribute('role') !== 'toolbar') button.click();
  event.preventDefault();
}

/** A keydown listener of a menu: up and down move the focus from item to item, around the end. */
export function menuKeys(event) {
  const by = { ArrowDown: 1, ArrowUp: -1 }[event.key];
  if (!by) return;
  const items = [...event.currentTarget.querySelectorAll('button:not([disabled])')];
  items[(items.indexOf(document.activeElement) + by + items.length) % items.length]?.focus();
  event.preventDefault();
  event.stopPropagation();
}
