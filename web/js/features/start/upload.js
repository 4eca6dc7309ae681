// The area to drop a plan on, and the list of uploads.
import { html, nothing } from '../../../lib/lit-html.js';
import { classMap } from '../../../lib/directives/class-map.js';
import { repeat } from '../../../lib/directives/repeat.js';
import { filesOfDrop, filesOfInput } from '../../net/dropped.js';
import { bodyOf } from '../../net/tar.js';
import { bytes, number } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { variables } from '../../parts/mount.js';

function take(uploads, files) {
  uploads.error.value = files.length ? '' : 'There is no file in it.';
  if (files.length) uploads.offer(bodyOf(files));
}

/** Accepts drops anywhere on the page. openPicture: true if the one file that was dropped is a snapshot. @returns {() => void} stops */
export function listenDrops(uploads, openPicture = async () => false, target = globalThis) {
  const isFiles = (event) => event.dataTransfer?.types.includes('Files');
  const over = (event) => {
    if (!isFiles(event)) return;
    event.preventDefault();
    uploads.isOver.value = true;
  };
  const leave = (event) => {
    if (!event.relatedTarget) uploads.isOver.value = false;
  };
  const drop = (event) => {
    if (!isFiles(event)) return;
    event.preventDefault();
    uploads.isOver.value = false;
    const handle = async (files) => {
      if (files.length !== 1 || !(await openPicture(files[0].file))) take(uploads, files);
    };
    filesOfDrop(event.dataTransfer)
      .then(handle)
      .catch((error) => {
        uploads.error.value = error.message;
      });
  };
  target.addEventListener('dragover', over);
  target.addEventListener('dragleave', leave);
  target.addEventListener('drop', drop);
  return () => {
    target.removeEventListener('dragover', over);
    target.removeEventListener('dragleave', leave);
    target.removeEventListener('drop', drop);
  };
}

export function dropZone(uploads, limit) {
  const chosen = (event) => {
    take(uploads, filesOfInput(event.target.files));
    event.target.value = '';
  };
  const choose = (event) => event.currentTarget.parentElement.querySelector('input').click();
  const picker = (word, input) => html`<span class="anchor"><button @click=${choose}>${word}</button>${input}</span>`;
  return html`<section class=${classMap({ 'drop-zone': true, over: uploads.isOver.value })} aria-label="Upload">
    <span class="sign">${icon('upload', 24)}</span><div><p><b>Drop a plan here</b>: a folder, its files, or a zip or tar of it</p>
      <p class="note">DICOM-RT, SERA, NIfTI, NRRD${limit ? `, at most ${bytes(limit)}` : ''}. It stays on this server; remove names from files before you send them.</p>
      <div class="buttons">${picker('Choose files', html`<input type="file" multiple tabindex="-1" aria-label="Files of a plan" @change=${chosen}>`)}
        ${picker('Choose a folder', html`<input type="file" webkitdirectory tabindex="-1" aria-label="Folder of a plan" @change=${chosen}>`)}</div>
      ${uploads.error.value ? html`<p class="err" role="alert">${icon('error')} ${uploads.error.value}</p>` : nothing}</div></section>`;
}

const words = ({ state, job, sent, bytes: size }) => {
  if (state === 'sending') return sent < size ? 'Sending' : 'Sent, waiting for the server';
  return job?.phase ? `${job.phase[0].toUpperCase()}${job.phase.slice(1)}` : 'Waiting';
};

/** Asks for the name that everybody will see, as local files are often called after the patient. */
function asking(uploads, upload) {
  const submit = (event) => {
    event.preventDefault();
    uploads.send(upload.key, new FormData(event.target).get('name'));
  };
  const day = new Date().toISOString().slice(0, 10);
  return html`<li class="plan upload" data-upload=${upload.key}><form class="naming" @submit=${submit}>
    <p class="what"><b>${upload.name}</b> <span>${bytes(upload.bytes)}</span></p>
    <label>Name on this server <input name="name" maxlength="60" autocomplete="off" placeholder=${`upload-${day}`} aria-describedby=${`naming-${upload.key}`}></label>
    <button class="primary" type="submit">${icon('upload')}<span>Send</span></button><button type="button" @click=${() => uploads.cancel(upload.key)}>${icon('close')}<span>Cancel</span></button>
    <p class="note" id=${`naming-${upload.key}`}>Everybody who opens this page sees it, also in addresses: no patient's name. Left empty, it is the day.</p></form></li>`;
}

function row(uploads, upload) {
  if (upload.state === 'asking') return asking(uploads, upload);
  const percent = upload.state === 'sending' ? (100 * upload.sent) / Math.max(upload.bytes, 1) : (upload.job?.percent ?? 0);
  const hasFailed = upload.state === 'failed';
  return html`<li class="plan upload" data-upload=${upload.key}><div class="plan-row"><span class="thumb">${icon(hasFailed ? 'error' : 'upload')}</span><div class="title"><b>${upload.name}</b><code>upload</code></div><div class="parts"></div>
      <div class="end size">${bytes(upload.bytes)}</div><div class="plan-state">${hasFailed ? html`<span class="err">${icon('error')} Refused</span>` : html`<b>Uploading</b>`}</div>
      <div class="end buttons-of">${hasFailed ? html`<button @click=${() => uploads.dismiss(upload.key)}>Dismiss</button>` : html`<button @click=${() => uploads.cancel(upload.key)}>${icon('close')}<span>Cancel</span></button>`}</div></div>
    ${
      hasFailed
        ? html`<div class="refusal" role="alert">${icon('error')}<div><p>${upload.error}</p><p class="place">Nothing was kept.</p></div></div>`
        : html`<div class="progress" role="progressbar" aria-label=${`Upload of ${upload.name}`} aria-valuemin="0" aria-valuemax="100" aria-valuenow=${Math.round(percent)}>
        <i class="bar" ${variables({ '--fill': `${percent}%` })}></i><b>${number(percent)} %</b><span class="phase">${icon('phase')} ${words(upload)}</span></div>`
    }</li>`;
}

export const uploadRows = (uploads) =>
  html`${repeat(
    uploads.rows.value,
    ({ key }) => key,
    (upload) => row(uploads, upload),
  )}`;
