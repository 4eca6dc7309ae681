// Popovers of the start page's banner: one is open at a time; a press beside it closes it, and so does Escape, which gives the focus back to its button.

/** @param {import('../../../lib/signals-core.js').Signal<string>} popover '' | 'upload' | 'look' | 'join' @param {() => void} close what else it shows @returns {() => void} stops */
export function listenPopovers(popover, close, target = globalThis) {
  const opened = () => document.querySelector('.banner .anchor:has(> .popover:not([hidden]))');
  const shut = () => {
    popover.value = '';
    close();
  };
  const onPress = (event) => {
    const anchor = opened();
    if (anchor && !anchor.contains(event.target)) shut();
  };
  const onKey = (event) => {
    const anchor = event.key === 'Escape' && opened();
    if (!anchor) return;
    if (anchor.contains(document.activeElement)) anchor.querySelector('button').focus();
    shut();
  };
  target.addEventListener('pointerdown', onPress);
  target.addEventListener('keydown', onKey);
  return () => {
    target.removeEventListener('pointerdown', onPress);
    target.removeEventListener('keydown', onKey);
  };
}
