// The button of the banner that opens the area to drop a plan on, and the list of uploads.
import { html, nothing } from '../../../lib/lit-html.js';
import { classMap } from '../../../lib/directives/class-map.js';
import { repeat } from '../../../lib/directives/repeat.js';
import { filesOfDrop, filesOfInput } from '../../net/dropped.js';
import { bodyOf } from '../../net/tar.js';
import { bytes, number } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { variables } from '../../parts/mount.js';
import { say } from './later_words.js';

function take(uploads, files) {
  uploads.error.value = files.length ? '' : say.noFile;
  uploads.popover.value = '';
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

/** Its card also stands while something is dragged over the page, and while nothing could be read of what was chosen. */
export function uploadButton(uploads, limit) {
  const { popover, isOver, error } = uploads;
  const isShown = popover.value === 'upload' || isOver.value || error.value !== '';
  const toggle = () => {
    error.value = '';
    popover.value = isShown ? '' : 'upload';
  };
  return html`<span class="anchor"><button aria-expanded=${isShown} @click=${toggle}>${icon('upload')}<span>${say.upload}</span></button><div class="popover upload-card" ?hidden=${!isShown}>${dropZone(uploads, limit)}</div></span>`;
}

function dropZone(uploads, limit) {
  const chosen = (event) => {
    take(uploads, filesOfInput(event.target.files));
    event.target.value = '';
  };
  const choose = (event) => event.currentTarget.parentElement.querySelector('input').click();
  const picker = (word, input) => html`<span class="anchor"><button @click=${choose}>${word}</button>${input}</span>`;
  return html`<section class=${classMap({ 'drop-zone': true, over: uploads.isOver.value })} aria-label=${say.upload}>
    <span class="sign">${icon('upload', 24)}</span><div><p>${say.dropIs({ drop: html`<b>${say.dropHere}</b>` })}</p>
      <p class="note">${limit ? say.formatsAtMost({ size: bytes(limit) }) : say.formats}</p>
      <div class="buttons">${picker(say.chooseFiles, html`<input type="file" multiple tabindex="-1" aria-label=${say.filesOf} @change=${chosen}>`)}
        ${picker(say.chooseFolder, html`<input type="file" webkitdirectory tabindex="-1" aria-label=${say.folderOf} @change=${chosen}>`)}</div>
      ${uploads.error.value ? html`<p class="err" role="alert">${icon('error')} ${uploads.error.value}</p>` : nothing}</div></section>`;
}

const words = ({ state, job, sent, bytes: size }) => {
  if (state === 'sending') return sent < size ? say.sending : say.sent;
  return job?.phase ? `${job.phase[0].toUpperCase()}${job.phase.slice(1)}` : say.waiting;
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
    <label>${say.nameOnServer} <input name="name" maxlength="60" autocomplete="off"
      placeholder=${`upload-${day}`} aria-describedby=${`naming-${upload.key}`}></label>
    <button class="primary" type="submit">${icon('upload')}<span>${say.send}</span></button>
    <button type="button" @click=${() => uploads.cancel(upload.key)}>${icon('close')}<span>${say.cancel}</span></button>
    <p class="note" id=${`naming-${upload.key}`}>${say.nameIsSeen}</p></form></li>`;
}

function row(uploads, upload) {
  if (upload.state === 'asking') return asking(uploads, upload);
  const percent = upload.state === 'sending' ? (100 * upload.sent) / Math.max(upload.bytes, 1) : (upload.job?.percent ?? 0);
  const hasFailed = upload.state === 'failed';
  const [dismiss, cancel] = [() => uploads.dismiss(upload.key), () => uploads.cancel(upload.key)];
  return html`<li class="plan upload" data-upload=${upload.key}><div class="plan-row"><span class="thumb">${icon(hasFailed ? 'error' : 'upload')}</span><div class="title">
        <b>${upload.name}</b><code>${say.anUpload}</code></div><div class="person"><span>${bytes(upload.bytes)}</span></div>
      <div class="states plan-state">${hasFailed ? html`<span class="err">${icon('error')} ${say.refused}</span>` : html`<b>${say.uploading}</b>`}</div>
      <div class="end buttons-of">${hasFailed ? html`<button @click=${dismiss}>${say.dismiss}</button>` : html`<button @click=${cancel}>${icon('close')}<span>${say.cancel}</span></button>`}</div></div>
    ${
      hasFailed
        ? html`<div class="refusal" role="alert">${icon('error')}<div><p>${upload.error}</p><p class="place">${say.nothingKept}</p></div></div>`
        : html`<div class="progress" role="progressbar" aria-label=${say.uploadOf({ name: upload.name })} aria-valuemin="0" aria-valuemax="100" aria-valuenow=${Math.round(percent)}>
        <i class="bar" ${variables({ '--fill': `${percent}%` })}></i><b>${number(percent)} %</b><span class="phase">${icon('phase')} ${words(upload)}</span></div>`
    }</li>`;
}

export const uploadRows = (uploads) =>
  html`${repeat(
    uploads.rows.value,
    ({ key }) => key,
    (upload) => row(uploads, upload),
  )}`;
