// The room's state on the server's disk, in the status bar; while nothing can be written, a line over the panes as well.
import { html, nothing } from '../../lib/lit-html.js';
import { icon } from '../parts/icons.js';
import { say } from './words.js';

const words = {
  saved: [say.saved, say.savedIs],
  saving: [say.saving, say.savingIs],
  failing: [say.failing, say.failingIs],
  unkept: [say.unkept, say.unkeptIs],
};

export function savedMark({ saved, link }) {
  const [word, about] = words[saved.state.value] ?? [];
  return word && link.value.state === 'open'
    ? html`<span class=${`pace ${saved.problem.value ? 'err' : 'dim'}`} id="saved" data-saved=${saved.state.value} title=${about}>${word}</span>`
    : nothing;
}

export function savedLine({ room: { saved } }) {
  const problem = saved.problem.value;
  return problem
    ? html`<div class="toast" id="saved-problem" role="alert"><span class="err">${icon('error')}</span><span>${problem}</span></div>`
    : nothing;
}
