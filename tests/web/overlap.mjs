// Where text on the page lies over other text, over a letter or over a control, measured in the browser.

/** @param {import('playwright-core').Page} page @returns {Promise<string[]>} one line for each pair that overlaps by more than a pixel or two */
export const overlaps = (page) =>
  page.evaluate(() => {
    const isVisible = (element) => element.checkVisibility({ opacityProperty: true, visibilityProperty: true });

    /** The part of a box in this element that the element and its ancestors do not clip. */
    const clip = (element, box) => {
      let { left, top, right, bottom } = box;
      for (let at = element; at; at = at.parentElement) {
        const { overflowX, overflowY, clipPath } = getComputedStyle(at);
        const outer = at.getBoundingClientRect();
        if (clipPath !== 'none') return null;
        if (overflowX !== 'visible') [left, right] = [Math.max(left, outer.left), Math.min(right, outer.right)];
        if (overflowY !== 'visible') [top, bottom] = [Math.max(top, outer.top), Math.min(bottom, outer.bottom)];
      }
      [left, right, top, bottom] = [Math.max(left, 0), Math.min(right, innerWidth), Math.max(top, 0), Math.min(bottom, innerHeight)];
      return right - left > 2 && bottom - top > 2 ? { left, top, right, bottom } : null;
    };

    const boxes = [];
    const add = (element, rect, what, inset) => {
      const box = clip(element, { left: rect.left + 1, right: rect.right - 1, top: rect.top + inset, bottom: rect.bottom - inset });
      if (box) boxes.push({ element, what, ...box });
    };
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    const range = document.createRange();
    while (walker.nextNode()) {
      const { parentElement: element, data } = walker.currentNode;
      if (
        !data.trim() ||
        element.closest('svg, script, style, noscript') ||
        !isVisible(element) ||
        getComputedStyle(element).clipPath !== 'none'
      )
        continue;
      range.selectNodeContents(walker.currentNode);
      for (const rect of range.getClientRects()) add(element, rect, `"${data.trim().slice(0, 40)}"`, 2);
    }
    for (const element of document.querySelectorAll('svg text'))
      if (element.textContent.trim() && isVisible(element))
        add(element, element.getBoundingClientRect(), `letter "${element.textContent}"`, 2);
    for (const element of document.querySelectorAll('.overlay .scale .ink, .picture-strip'))
      if (isVisible(element)) add(element, element.getBoundingClientRect(), element.getAttribute('class'), 0);
    for (const element of document.querySelectorAll('button, a.button, input, select, summary'))
      if (isVisible(element))
        add(
          element,
          element.getBoundingClientRect(),
          `${element.localName} ${element.getAttribute('aria-label') ?? element.textContent.trim().slice(0, 30)}`,
          1,
        );

    /** True if something opaque that floats, as a popover or a toast, holds the one and hides the other. */
    const hides = (one, other) => {
      for (let at = one.element; at && !at.contains(other.element); at = at.parentElement) {
        const { position, backgroundColor } = getComputedStyle(at);
        if (['absolute', 'fixed'].includes(position) && !/^rgba\(.*, 0?\.?\d*\)$|transparent/.test(backgroundColor)) return true;
      }
      return false;
    };
    const found = new Set();
    for (const [n, one] of boxes.entries())
      for (const other of boxes.slice(n + 1)) {
        if (one.left >= other.right || other.left >= one.right || one.top >= other.bottom || other.top >= one.bottom) continue;
        if (one.element.contains(other.element) || other.element.contains(one.element) || hides(one, other) || hides(other, one)) continue;
        found.add(
          `${one.what} and ${other.what} at ${Math.round(Math.max(one.left, other.left))}, ${Math.round(Math.max(one.top, other.top))}`,
        );
      }
    return [...found];
  });

/** Choices in a row that reach out of what they stand in, or whose words are cut. @param {import('playwright-core').Page} page @returns {Promise<string[]>} */
export const cutSegments = (page) =>
  page.evaluate(() =>
    [...document.querySelectorAll('.segment')]
      .filter((segment) => segment.checkVisibility({ visibilityProperty: true }))
      .filter((segment) => {
        const [own, outer] = [segment, segment.parentElement].map((element) => element.getBoundingClientRect());
        const isCut = [...segment.querySelectorAll('button')].some((button) => button.scrollWidth > button.clientWidth + 1);
        return isCut || own.left < outer.left - 1 || own.right > outer.right + 1;
      })
      .map((segment) => segment.getAttribute('aria-label')),
  );
