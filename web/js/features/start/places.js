// The places of the start page: today, all plans, folders, uploads, folders that are no plans.
import { html, svg } from '../../../lib/lit-html.js';
import { number } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { say } from './later_words.js';

const folderSign = html`<svg class="icon" width="16" height="16" viewBox="0 0 16 16" fill="none" stroke="currentColor" stroke-width="1.3" aria-hidden="true">${svg`<path d="M1.500 3.500h4.500l1.500 2h7v7.500h-13z"/>`}</svg>`;

/** The place that an address names: the question behind the start page's path. @returns {{kind: string, id: string}} id: of a folder */
export function placeOfAddress(search) {
  const asked = new URLSearchParams(search);
  const kind = asked.get('place');
  if (kind === 'folder' && /^[0-9a-f]{16}$/.test(asked.get('folder') ?? '')) return { kind, id: asked.get('folder') };
  return { kind: ['all', 'uploads', 'no-plans'].includes(kind) ? kind : 'today', id: '' };
}

/** The address of a place. */
export const addressOfPlace = ({ kind, id }) =>
  `/${kind === 'today' ? '' : `?${new URLSearchParams({ place: kind, ...(id && { folder: id }) })}`}`;

/** @param {object} state @param {import('./meetings.js').MeetingsState} meetings */
export function places(state, meetings) {
  const { folders, n_all, n_uploads, n_no_plans } = state.found.value;
  const item = (kind, sign, word, n, id = '') => {
    const isShown = state.place.value.kind === kind && state.place.value.id === id;
    return html`<li><button aria-current=${isShown ? 'page' : 'false'} data-place=${id ? `${kind} ${word}` : kind} @click=${() => state.show({ place: { kind, id } })}>
      ${sign}<span class="word" title=${word}>${word}</span><span class="n">${n ? number(n) : ''}</span></button></li>`;
  };
  const group = (word, items) => (items.length ? html`<h2>${word}</h2><ul>${items}</ul>` : '');
  return html`<nav class="places" aria-label=${say.places}>
    <ul>${item('today', icon('people'), say.today, meetings.today.value.length)}${item('all', icon('layers'), say.allPlans, n_all)}</ul>
    ${group(
      say.folders,
      folders.map(({ id, name, n }) => item('folder', folderSign, name, n, id)),
    )}
    ${group(say.mine, n_uploads ? [item('uploads', icon('upload'), say.uploads, n_uploads)] : [])}
    ${group(say.records, [html`<li><a href="/records" data-place="records">${icon('print')}<span class="word">${say.keptRecords}</span></a></li>`])}
    ${group(say.always, n_no_plans ? [item('no-plans', folderSign, say.noPlans, n_no_plans)] : [])}</nav>`;
}
