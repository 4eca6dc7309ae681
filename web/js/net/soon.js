// When changes are sent: the first at once, after the handler that makes it; those that follow together, some milliseconds later.

const everyMs = 14; // a little more often than the screen shows pictures

/** @param {{now, setTimeout}} clock @returns {(callback: () => void) => void} */
export function soon(clock) {
  let lastAt = -Infinity;
  return (callback) => {
    const call = () => {
      lastAt = clock.now();
      callback();
    };
    const waitMs = lastAt + everyMs - clock.now();
    if (waitMs > 0) clock.setTimeout(call, waitMs);
    else queueMicrotask(call);
  };
}
