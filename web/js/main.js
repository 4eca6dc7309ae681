// Starts the page: gives the browser's socket, clock and decoder to the modules and shows the page that the address names.
import { Connection } from './net/connection.js';
import { makeApi } from './net/api.js';
import { sendPlan } from './net/upload.js';
import { Hooks } from './hooks.js';
import { roomPage } from './shell/room_page.js';
import { OwnName } from './room/own_name.js';
import { Thumbnails } from './features/start/thumbnails.js';
import { Redraw } from './parts/redraw.js';
import { Decoder } from './pane/decoder.js';
import { keepTextVisible } from './parts/visible_text.js';
import { isId } from './wire/check.js';
import { language } from './languages/index.js';

document.documentElement.lang = language;
keepTextVisible(document.documentElement);

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
  makeWorker: () => new Worker('js/pane/decode_worker.js'),
  decodeHere: (picture, type) => createImageBitmap(new Blob([picture], { type })),
});
const hooks = new Hooks(clock);
const api = makeApi((...request) => fetch(...request));
const enter = (room, plan) => {
  location.hash = address(room, plan);
};
/** "#/rooms/ID/PLAN", and "?link=TOKEN" behind it until the link has let this person in: the plan is there for the time after the room, which then can be opened again. */
const address = (room, plan) => `#/rooms/${room}${plan ? `/${plan}` : ''}`;
const ownName = new OwnName(storage());
const thumbnails = new Thumbnails(api, URL);

const send = ({ publicName, ...task }) => sendPlan({ ...task, url: api.uploadUrl(publicName), makeRequest: () => new XMLHttpRequest() });

/** The member that this tab was in the room before a reload. */
function remembered(room) {
  try {
    return JSON.parse(sessionStorage.getItem(`room ${room}`)) ?? {};
  } catch {
    return {};
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

function connect(room, invitation) {
  const url = new URL(`api/v1/rooms/${room}/ws`, location.href);
  url.protocol = url.protocol.replace('http', 'ws');
  url.hash = '';
  const { member = '', secret = '', link: before = '' } = remembered(room);
  const link = (invitation || before).slice(0, 64);
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
    sessionStorage.setItem(`room ${room}`, JSON.stringify({ member: detail.member, secret: detail.secret, link }));
    history.replaceState(null, '', address(room, detail.plan_id));
  });
  return connection;
}

let leave = () => {};
let nRoutes = 0;

async function route() {
  const [path, query = ''] = location.hash.split('?');
  const [, place, id, plan = ''] = path.split('/');
  const invitation = new URLSearchParams(query).get('link') ?? new URLSearchParams(location.search).get('link') ?? '';
  if (location.hash.startsWith('#picture-')) return; // the skip link's target, not a page
  leave();
  leave = () => {};
  nRoutes += 1;
  const host = document.querySelector('#page');
  if (place === 'rooms' && isId(id))
    leave = roomPage(host, id, {
      api,
      connect: (room) => connect(room, invitation),
      clock,
      redraw,
      decode,
      hooks,
      enter,
      ownName,
      storage: storage(),
      isBack: Boolean(remembered(id).member),
      plan: isId(plan) ? plan : '',
    });
  else if (place === 'p' && isId(id)) {
    const n = nRoutes;
    const { permalinkPage } = await import('./features/bookmarks/permalink.js');
    if (n === nRoutes) leave = permalinkPage(host, id, { api, enter: (room, of) => location.replace(address(room, of)) }); // going back does not make another room
  } else {
    const n = nRoutes;
    const { startPage } = await import('./features/start/start_page.js'); // a file of its own: who opens a room by its link does not load it
    if (n === nRoutes) leave = startPage(host, { api, clock, enter, send, ownName, thumbnails });
  }
}

addEventListener('hashchange', route);
route();
