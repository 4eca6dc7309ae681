// Starts the page: gives the browser's socket, clock and decoder to the modules and shows the page that the address names.
import { signal } from '../lib/signals-core.js';
import { Connection } from './net/connection.js';
import { placeOf, roomPath } from './net/address.js';
import { isPersonal, keptFor } from './net/kept.js';
import { makeApi } from './net/api.js';
import { Seats } from './net/seats.js';
import { Hooks } from './hooks.js';
import { roomPage } from './shell/room_page.js';
import { OwnName } from './room/own_name.js';
import { styled } from './parts/lazy.js';
import { keepLook } from './parts/page_look.js';
import { Redraw } from './parts/redraw.js';
import { Decoder } from './pane/decoder.js';
import { keepTextVisible } from './parts/visible_text.js';
import { language } from './languages/index.js';

document.documentElement.lang = language;
keepTextVisible(document.documentElement);
keepLook(storage());

/** The browser's storage between visits; null where it keeps nothing. */
function storage() {
  try {
    return localStorage;
  } catch {
    return null;
  }
}

const clock = {
  now: () => performance.now(),
  setTimeout: (callback, ms) => setTimeout(callback, ms),
  clearTimeout: (timer) => clearTimeout(timer),
};
const redraw = new Redraw((callback) => requestAnimationFrame(callback), clock);
const { decode } = new Decoder({
  makeWorker: () => new Worker('/js/pane/decode_worker.js'),
  decodeHere: (picture, type) => createImageBitmap(new Blob([picture], { type })),
});
const hooks = new Hooks(clock);
/** features/session/session.js, where people sign in; null elsewhere. */
const session = signal(null);
/** The room whose welcome has come: {room, connection}. */
let entered = null;
const api = makeApi(async (path, init) => {
  const answer = await fetch(path, session.peek()?.ofGuest(init) ?? init);
  if (answer.status === 401) void begun.then(() => (session.peek() ? session.peek().refused() : signIn()));
  return answer;
});
let user = ''; // who is signed in
const told = api.call('GET', 'session').then(
  (facts) => {
    user = facts.identity?.user ?? '';
    return facts;
  },
  () => null,
);
const begun = told.then(async (facts) => {
  if (!facts || !(facts.sign_in.length || facts.open_to_everybody)) return;
  const { Session } = await import('./features/session/session.js');
  session.value = new Session(facts, { api, ownName, entered: () => entered && { ...entered, ...remembered(entered.room) }, signIn });
  const { id } = placeOf(location);
  const { link, member } = remembered(id);
  if (facts.sign_in.length && !facts.identity && !link && !member) signIn(); // nothing lets anybody in
});
/** Asks who this is; what this page shows opens afterwards. */
function signIn() {
  const { pathname, hash } = location;
  if (!pathname.startsWith('/signin')) go(`/signin?return=${encodeURIComponent(pathname)}${hash}`, true);
}
/** Goes to another place of the page. @param {string} path @param {boolean} isInstead back does not lead here again */
function go(path, isInstead = false) {
  history[isInstead ? 'replaceState' : 'pushState'](null, '', path);
  void route();
}
/** Goes to a room. @param {string} plan its plan, '' if not known @param {string} link token of the link that lets in
 *  @param {object} [seat] {member, secret, from}: a seat that was made there for who comes from the room `from` */
function enter(room, plan = '', link = '', isInstead = false, { from, ...seat } = {}) {
  const { isGuest, user: of } = from ? remembered(from) : {};
  remember(room, {
    ...(plan && { plan }),
    ...(link && { link, isNew: true }),
    ...seat,
    ...(isGuest && { isGuest }),
    ...(of && { user: of }),
  });
  go(roomPath(room), isInstead);
}
const ownName = new OwnName(storage());
let thumbnails = null; // of the start page, kept while rooms are visited

const seats = new Seats(() => new BroadcastChannel('beamroom seats'));
/** A reload has the place of a page that is gone. */
const isReload = performance.getEntriesByType?.('navigation')[0]?.type === 'reload';

const inMemory = new Map(); // what a browser that keeps nothing forgets at a reload

/** Facts that this tab keeps of a room, for who is signed in (net/kept.js). */
function remembered(room) {
  let kept;
  try {
    kept = JSON.parse(sessionStorage.getItem(`room ${room}`));
  } catch {
    kept = inMemory.get(room);
  }
  return keptFor(kept ?? {}, user);
}

function remember(room, part) {
  const whole = { ...remembered(room), ...part };
  try {
    sessionStorage.setItem(`room ${room}`, JSON.stringify(whole));
  } catch {
    inMemory.set(room, whole);
  }
}

/** A random word of this browser, by which the room counts the tabs of one person; '' where the browser keeps nothing. */
function person() {
  const key = 'beamroom person';
  try {
    const kept = localStorage.getItem(key);
    if (/^[0-9a-f]{32}$/.test(kept)) return kept;
    const made = [...crypto.getRandomValues(new Uint8Array(16))].map((byte) => byte.toString(16).padStart(2, '0')).join('');
    localStorage.setItem(key, made);
    return made;
  } catch {
    return '';
  }
}

function connect(room) {
  const url = new URL(`/api/v1/rooms/${room}/ws`, location.href);
  url.protocol = url.protocol.replace('http', 'ws');
  const { member = '', secret = '', link = '' } = remembered(room);
  const isGone = () =>
    api.room(room).then(
      () => false,
      (problem) => problem.type === '/problems/not-found',
    );
  const connection = new Connection(
    url.href,
    { makeSocket: (address) => new WebSocket(address), clock, isGone },
    { name: ownName.value.value, member, secret, link, person: person() },
  );
  connection.addEventListener('message', ({ detail }) => {
    if (detail.type !== 'welcome') return;
    remember(room, { member: detail.member, secret: detail.secret, isNew: false, plan: detail.plan_id });
    seats.take(room, detail.member);
    void told.then(() => remember(room, { user }));
    entered = { room, connection };
  });
  // the card over the room is for a person; a guest, too, signs in on the page for that
  connection.addEventListener('paused', () => void begun.then(() => (entered && session.peek()?.person.peek()) || signIn()));
  return connection;
}

let leave = () => {};
let nRoutes = 0;
let shown = null; // "PLACE ID"

async function route() {
  const { place, id, plan, link } = placeOf(location);
  if ((place === 'rooms' && (plan || link || location.hash.startsWith('#/'))) || (place === 'meetings' && link)) {
    // the token leaves the address and the history before anything else happens
    remember(id, { ...(plan && { plan }), ...(link && { link, isNew: true }) });
    history.replaceState(null, '', place === 'rooms' ? roomPath(id) : location.pathname);
  }
  if (shown === `${place} ${id}` && !link) return; // another fragment: the skip link's target, not a page
  shown = `${place} ${id}`;
  leave();
  leave = () => {};
  seats.take('', '');
  entered = null;
  const n = ++nRoutes;
  const host = document.querySelector('#page');
  if (place === 'rooms') {
    const before = remembered(id);
    const first = before.member && n === 1 && !isReload && (await seats.isTaken(id, before.member)) ? before : null;
    if (first) remember(id, { member: '', secret: '' }); // a member of its own
    if (n !== nRoutes) return;
    const facts = isPersonal(before) || (before.link && !before.member) ? await told : null;
    if (n !== nRoutes) return;
    // a guest says a name first; a seat waits for its person
    if (facts?.sign_in.length && !facts.identity && (before.user || (facts.guest_links && !before.isGuest))) return signIn();
    leave = roomPage(host, id, {
      api,
      connect,
      clock,
      redraw,
      decode,
      hooks,
      enter,
      ownName,
      session,
      storage: storage(),
      isBack: Boolean(remembered(id).member),
      goOnHere:
        first &&
        (() => {
          remember(id, first);
          location.reload();
        }),
      plan: remembered(id).plan ?? '',
    });
  } else if (place === 'signin') {
    const { signInPage } = await import('./features/session/sign_in_page.js');
    if (n === nRoutes) leave = signInPage(host, id, { api, ownName, remembered, remember });
  } else if (place === 'meetings') {
    const { meetingPage } = await import('./features/meeting/meeting_page.js');
    if (n === nRoutes) leave = meetingPage(host, id, { api, clock, link: remembered(id).link, isMinutes: plan === 'minutes', enter });
  } else if (place === 'records') {
    const { recordsPage } = await import('./features/record/kept_page.js');
    if (n === nRoutes) leave = recordsPage(host, id, { api, clock });
  } else if (place === 'p') {
    const { permalinkPage } = await import('./features/bookmarks/permalink.js');
    if (n === nRoutes) leave = permalinkPage(host, id, { api, enter: (room, of) => enter(room, of, '', true) }); // going back does not make another room
  } else {
    // files of their own: who opens a room by its link does not load them
    const [{ startPage, sendPlan, Thumbnails }] = await Promise.all([
      import('./features/start/start_page.js'),
      styled('js/features/start/start.css'),
      styled('js/features/start/plans.css'),
      styled('js/features/start/meetings.css'),
    ]);
    thumbnails ??= new Thumbnails(api, URL);
    const send = ({ publicName, ...task }) =>
      sendPlan({ ...task, url: api.uploadUrl(publicName), makeRequest: () => new XMLHttpRequest() });
    if (n === nRoutes) leave = startPage(host, { api, clock, enter, send, ownName, session, thumbnails });
  }
}

/** Links to the start page lead there without loading the page anew. */
document.addEventListener('click', (event) => {
  const isPlain = !(event.button || event.ctrlKey || event.metaKey || event.shiftKey || event.altKey || event.defaultPrevented);
  if (!isPlain || !event.target.closest?.('a[href="/"]')) return;
  event.preventDefault();
  go('/');
});
addEventListener('popstate', route); // also when a fragment is typed
void route();
