// The oldest browsers that the page promises to work in, and the oldest node for tests and scripts (Debian 12's). The README says so, esbuild is told so
// (deploy/page.mjs), and tests/oldest.mjs holds the sources to it: esbuild rewrites syntax, but adds no function that a browser lacks.
export const browsers = { chrome: '107', firefox: '121', safari: '16.4' };
export const node = { nodejs: '18.19.0' };
