// Texts that lie over the picture of a pane, measured in the browser.

/** Words that may: letters, scale, window, labels of lines and of marks, pointers with their cards. */
const allowed = [
  '.overlay .letter',
  '.overlay .scale',
  '.overlay .caption',
  '.dose-line-label',
  '.beam-number',
  '.dose-pin-name',
  '.image-value',
  '.pointers',
  '.read-out',
  '.view-cube',
  '.toast',
];

/** @param {import('playwright-core').Page} page @returns {Promise<string[]>} a line for each text box that intersects a picture and may not */
export const overPictures = (page) =>
  page.evaluate((names) => {
    const pictures = [...document.querySelectorAll('.picture')]
      .map((picture) => ({ view: picture.closest('[data-view]').dataset.view, box: picture.getBoundingClientRect() }))
      .filter(({ box }) => box.width > 2);
    /** The part of a box that no ancestor of this element cuts off. */
    const clipped = (element, { left, top, right, bottom }) => {
      const box = { left, top, right, bottom };
      for (let at = element; at; at = at.parentElement) {
        const { overflowX, overflowY } = getComputedStyle(at);
        const outer = at.getBoundingClientRect();
        if (overflowX !== 'visible') [box.left, box.right] = [Math.max(box.left, outer.left), Math.min(box.right, outer.right)];
        if (overflowY !== 'visible') [box.top, box.bottom] = [Math.max(box.top, outer.top), Math.min(box.bottom, outer.bottom)];
      }
      return box;
    };
    const found = [];
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    const range = document.createRange();
    while (walker.nextNode()) {
      const { parentElement: element, data } = walker.currentNode;
      if (!data.trim() || element.closest([...names, 'script', 'style', 'noscript', '.hidden'].join())) continue;
      if (!element.checkVisibility({ opacityProperty: true, visibilityProperty: true }) || getComputedStyle(element).clipPath !== 'none')
        continue;
      range.selectNodeContents(walker.currentNode);
      for (const rect of [...range.getClientRects()].map((whole) => clipped(element, whole)))
        for (const { view, box } of pictures)
          if (rect.left < box.right - 1 && rect.right > box.left + 1 && rect.top < box.bottom - 1 && rect.bottom > box.top + 1)
            if (rect.right - rect.left > 1 && rect.bottom - rect.top > 1)
              found.push(`"${data.trim().slice(0, 40)}" over the picture of view ${view}`);
    }
    return [...new Set(found)];
  }, allowed);
