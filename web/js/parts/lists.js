// Copies of lists with one entry changed. The language's own with() and toSpliced() are younger than the browsers that the page promises to work in.

/** A copy with another value at an index, 0 <= index < list.length. */
export const replaced = (list, index, value) => list.map((other, n) => (n === index ? value : other));
/** A copy without the entry at an index. */
export const without = (list, index) => list.filter((_, n) => n !== index);
