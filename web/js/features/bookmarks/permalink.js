// The page of a permalink: makes a new room from a saved view and goes there, or says why it cannot.
import { html } from '../../../lib/lit-html.js';
import { signal } from '../../../lib/signals-core.js';
import { beginWith } from './feature.js';
import { icon } from '../../parts/icons.js';
import { styled } from '../../parts/lazy.js';
import { mount } from '../../parts/mount.js';
import { say } from './later_words.js';

/**
 * @param {HTMLElement} host @param {string} token @param {object} world {api, enter: goes to the room in place of this page}
 * @returns {() => void} leaves the page
 */
export function permalinkPage(host, token, { api, enter }) {
  const problem = signal(null);
  let isLeft = false;
  const open = async () => {
    problem.value = null;
    try {
      const room = await api.makeRoomOfBookmark(token);
      if (isLeft) return;
      beginWith(room.id);
      enter(room.id, room.plan);
    } catch (error) {
      problem.value = error;
    }
  };
  void styled('js/features/bookmarks/bookmark.css').catch(() => {});
  const unmount = mount(
    host,
    () =>
      html`<main class="permalink">${problem.value ? refused(problem.value, open) : html`<p class="empty" role="status">${say.opening}</p>`}</main>`,
  );
  document.title = say.pageTitle;
  void open();
  return () => {
    isLeft = true;
    unmount();
    document.title = 'Beamroom';
  };
}

function refused(problem, again) {
  const isGone = problem.type === '/problems/not-found';
  return html`<section class="card" role="alert">${icon(isGone ? 'bookmark' : 'error', 20)}<div><h1>${isGone ? say.gone : say.notNow}</h1>
    <p>${isGone ? say.goneIs : problem.message}</p>
    <div class="buttons">${isGone ? '' : html`<button class="primary" @click=${again}>${say.again}</button>`}
      <a class="button" href="/">${say.plans}</a></div></div></section>`;
}
