// The page of a meeting's address: by a link, or for whoever it names, it goes into the room of the case that is now, or waits until there is one; or it
// shows the minutes.
import { html, nothing } from '../../../lib/lit-html.js';
import { signal } from '../../../lib/signals-core.js';
import { icon } from '../../parts/icons.js';
import { styled } from '../../parts/lazy.js';
import { mount } from '../../parts/mount.js';
import { say } from './later_words.js';
import { minutesSheet } from './minutes.js';

const againMs = 3000;

/**
 * @param {HTMLElement} host @param {string} id of the meeting
 * @param {object} world {api, clock, link: token of a link, isMinutes, enter: goes to the room} @returns {() => void} leaves the page
 */
export function meetingPage(host, id, { api, clock, link = '', isMinutes, enter }) {
  const problem = signal(null);
  const door = signal(null);
  const minutes = signal(null);
  const path = `meetings/${encodeURIComponent(id)}`;
  let timer = 0;
  let isLeft = false;

  /** Where the meeting is: {name, state, starts_ms, room}. */
  async function ask() {
    if (link) return api.call('POST', `${path}/enter`, { body: { link } });
    const { cases, ...meeting } = await api.call('GET', path);
    return { ...meeting, room: cases.find(({ state }) => state === 'now')?.room };
  }

  const open = async () => {
    problem.value = null;
    try {
      if (isMinutes) minutes.value = await api.call('GET', `${path}/minutes`);
      else door.value = await ask();
    } catch (error) {
      problem.value = error;
    }
    if (isLeft || isMinutes || problem.peek()) return;
    if (door.peek().room && door.peek().role === 'wall') location.replace(`/display/${door.peek().room}#link=${link}`);
    else if (door.peek().room) enter(door.peek().room, '', link, true);
    else if (door.peek().state !== 'over') timer = clock.setTimeout(open, againMs);
  };

  for (const sheet of ['meeting/meeting.css', ...(isMinutes ? ['report/printout.css'] : [])])
    void styled(`js/features/${sheet}`).catch(() => {});
  const unmount = mount(host, () =>
    minutes.value
      ? minutesSheet(minutes.value)
      : html`<main class="case-cover"><section class="case-card" role="status">${words(problem.value, door.value, id, open)}</section></main>`,
  );
  document.title = isMinutes ? say.minutesTitle : say.doorTitle;
  void open();
  return () => {
    isLeft = true;
    clock.clearTimeout(timer);
    unmount();
    document.title = 'Beamroom';
  };
}

function words(problem, door, id, again) {
  const plans = html`<p><a class="button" href="/">${say.toPlans}</a></p>`;
  if (problem?.type === '/problems/not-found')
    return html`${icon('error', 20)}<h1>${say.doorClosed}</h1><p>${say.doorClosedIs}</p>${plans}`;
  if (problem)
    return html`${icon('error', 20)}<h1>${say.notNow}</h1><p>${problem.message}</p><p><button class="primary" @click=${again}>${say.again}</button></p>`;
  if (!door) return html`<p>${say.opening}</p>`;
  if (door.state === 'over')
    return html`<h1>${say.doorOver(door)}</h1>${door.id ? html`<p><a class="button" href=${`/meetings/${id}/minutes`}>${say.minutes}</a></p>` : nothing}${plans}`;
  if (door.state === 'running') return html`<h1>${say.notOpen({ n: door.case })}</h1><p>${say.doorClosedCase}</p>${plans}`;
  const time = door.starts_ms ? new Date(door.starts_ms).toLocaleString([], { dateStyle: 'medium', timeStyle: 'short' }) : '';
  return html`<h1>${say.doorWaits(door)}</h1>${time ? html`<p>${say.doorStarts({ time })}</p>` : nothing}<p class="dim">${say.doorWaitsIs}</p>${plans}`;
}
