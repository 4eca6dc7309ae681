// Where the page's modules are, as the browser gets them, for tests to import.
import { existsSync } from 'node:fs';
import { fileURLToPath, pathToFileURL } from 'node:url';

export const root = fileURLToPath(new URL('../../../', import.meta.url));
const web = process.env.BEAMROOM_WEB ?? `${root}build/web`;
if (!existsSync(`${web}/gen/wire.js`)) throw new Error(`${web} is not there: run "make web" first`);

/** @param {string} path inside js/ */
export const load = (path) => import(pathToFileURL(`${web}/js/${path}`).href);

// lit-html asks for it when it is loaded; nothing is drawn here
globalThis.document ??= { createTreeWalker: () => null, createComment: () => null };
