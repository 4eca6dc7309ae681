// Files and printouts that the page makes by itself. The server is told first and records each in the audit; what it has not acknowledged is not made.
import { ofMember } from '../net/api.js';
import { csvText } from '../parts/csv.js';
import { say } from './later_words.js';

const busyMs = 500;
const mostBusy = 240; // two minutes: the revision of a large plan's files is being found out
let isPrinting = false;

/** Resolves when it is recorded. @param {string} what a word of proto/http.json's exports @param {string} name of the file or printout */
export async function tell({ api, room, clock }, what, name) {
  for (let n = 0; ; n++) {
    try {
      return await api.call('POST', `rooms/${room.id}/exports`, { body: { what, name }, more: ofMember(room.identity) });
    } catch (problem) {
      if (problem.type !== '/problems/busy' || n >= mostBusy) throw problem;
      await new Promise((done) => clock.setTimeout(done, busyMs));
    }
  }
}

async function made(world, what, name, make) {
  try {
    await tell(world, what, name);
    make();
  } catch (problem) {
    world.ui.notify('err', say.notSaved({ reason: problem.message }), 'export');
  }
}

/** Lets the browser save a file. @param {Blob} blob */
export function saveBlob(name, blob) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000); // a browser may begin to save it later
}

/** @param {string} text as it is now, whenever the server answers */
export const exportFile = (world, what, name, text, type) => made(world, what, name, () => saveBlob(name, new Blob([text], { type })));

/** @param {(string|number|null)[][]} rows */
export const exportRows = (world, what, name, rows) => exportFile(world, what, name, csvText(rows), 'text/csv');

/** Prints the sheets that are open. The browser's own menu prints them, too: that is told when it begins. @param {string} name what the sheets are of */
export function printable(world, what, name) {
  globalThis.onbeforeprint = () => {
    if (!isPrinting && document.querySelector('.printout')) void tell(world, what, name).catch(() => {});
  };
  return () =>
    made(world, what, name, () => {
      isPrinting = true;
      globalThis.print();
      isPrinting = false;
    });
}

/** A time in the name of a file: 20261128T031400Z. */
const fileTime = (ms) => new Date(ms).toISOString().replace(/[-:]|\.\d+/g, '');

/** The view as a picture with letters, scale and caption; the server records it. isNamed: with the patient's name, of who may read it. */
export async function savePicture({ api, room, ui }, view, document, isNamed) {
  try {
    const name = `${room.planId.value}-${view.kind}-${fileTime(Date.now())}.png`; // when it was asked for
    saveBlob(name, await api.snapshot(room, document, isNamed));
  } catch (problem) {
    ui.notify('err', say.noSnapshot({ reason: problem.message }), 'snapshot');
  }
}
