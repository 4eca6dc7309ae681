// What was dropped on the page or chosen in its dialog, folders opened, as files with their paths.

const mostFiles = 100000;

const entries = (reader) => new Promise((resolve, reject) => { reader.readEntries(resolve, reject); });
const fileOf = (entry) => new Promise((resolve, reject) => { entry.file(resolve, reject); });

async function walk(entry, files) {
  if (files.length > mostFiles) throw new Error(`More than ${mostFiles} files; drop one plan.`);
  if (entry.isFile) {
    files.push({ path: entry.fullPath.replace(/^\//, ''), file: await fileOf(entry) });
    return;
  }
  const reader = entry.createReader();
  for (let some = await entries(reader); some.length; some = await entries(reader)) for (const inner of some) await walk(inner, files);
}

/** @param {DataTransfer} data @returns {Promise<{path: string, file: File}[]>} in order of path */
export async function filesOfDrop(data) {
  // what comes from another program, as an archive out of a mail, is a file without an entry; both must be asked for before the first wait
  const dropped = [...data.items].filter((item) => item.kind === 'file').map((item) => ({ entry: item.webkitGetAsEntry?.(), file: item.getAsFile() }));
  const files = [];
  for (const { entry, file } of dropped) {
    if (entry) await walk(entry, files);
    else if (file) files.push({ path: file.name, file });
  }
  return files.sort((a, b) => (a.path < b.path ? -1 : 1));
}

/** @param {FileList} list of an input, with folders' paths where it was asked for a folder */
export const filesOfInput = (list) => [...list].map((file) => ({ path: file.webkitRelativePath || file.name, file }));
