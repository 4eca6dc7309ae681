// Lists files with their paths from a drop on the page or a file dialog, including those in dropped folders.

import { say } from './words.js';

const mostFiles = 100000;

const entries = (reader) =>
  new Promise((resolve, reject) => {
    reader.readEntries(resolve, reject);
  });
const fileOf = (entry) =>
  new Promise((resolve, reject) => {
    entry.file(resolve, reject);
  });

async function walk(entry, files) {
  if (files.length > mostFiles) throw new Error(say.tooManyFiles({ n: mostFiles }));
  if (entry.isFile) {
    files.push({ path: entry.fullPath.replace(/^\//, ''), file: await fileOf(entry) });
    return;
  }
  const reader = entry.createReader();
  for (let some = await entries(reader); some.length; some = await entries(reader)) for (const inner of some) await walk(inner, files);
}

/** @param {DataTransfer} data @returns {Promise<{path: string, file: File}[]>} in order of path */
export async function filesOfDrop(data) {
  // an item from another program, such as an archive in a mail, is a file without an entry; both must be read before the first await
  const dropped = [...data.items]
    .filter((item) => item.kind === 'file')
    .map((item) => ({ entry: item.webkitGetAsEntry?.(), file: item.getAsFile() }));
  const files = [];
  for (const { entry, file } of dropped) {
    if (entry) await walk(entry, files);
    else if (file) files.push({ path: file.name, file });
  }
  return files.sort((a, b) => (a.path < b.path ? -1 : 1));
}

/** @param {FileList} list of an input element; with the paths in the folder when a folder was chosen */
export const filesOfInput = (list) => [...list].map((file) => ({ path: file.webkitRelativePath || file.name, file }));
