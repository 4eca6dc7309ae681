// The page of a wall: gives the browser's socket, clock and decoder to the modules, and takes the link from the address.
import { Connection } from './net/connection.js';
import { makeApi, ofMember } from './net/api.js';
import { Redraw } from './parts/redraw.js';
import { Decoder } from './pane/decoder.js';
import { keepTextVisible } from './parts/visible_text.js';
import { language } from './languages/index.js';
import { isId } from './wire/check.js';
import { wallPage } from './wall/wall_page.js';
import { say } from './wall/words.js';

document.documentElement.lang = language;
keepTextVisible(document.documentElement);

const clock = {
  now: () => performance.now(),
  setTimeout: (callback, ms) => setTimeout(callback, ms),
  clearTimeout: (timer) => clearTimeout(timer),
};
const home = location.pathname.split('/').pop(); // the room of the address, at which a wall that is started anew begins
const host = document.querySelector('#wall');
const sleepMs = 3000;

/** The storage of this tab; null where the browser keeps nothing. */
function storageOfTab() {
  try {
    return sessionStorage;
  } catch {
    return null;
  }
}
const storage = storageOfTab();
const [moveKey, meetingKey] = [`wall-at:${home}`, `wall-meeting:${home}`];

/** The token of the link leaves the address, and is kept for a reload of this tab; a browser that keeps nothing leaves it there. */
function takeLink() {
  const key = `wall:${home}`;
  const link = (new URLSearchParams(location.hash.slice(1)).get('link') ?? '').slice(0, 64);
  if (link && storage) {
    storage.setItem(key, link);
    history.replaceState(null, '', location.pathname + location.search);
  }
  return link || (storage?.getItem(key) ?? '');
}

/** The message meeting.case by which this page was left for another case; null: it begins at its address. */
function takeMove() {
  try {
    const move = JSON.parse(storage?.getItem(moveKey) ?? 'null');
    storage?.removeItem(moveKey);
    return move && isId(move.room) ? move : null;
  } catch {
    return null;
  }
}

/** Loads the page anew for the next case, with the seat that waits there: nothing of the case before is left. */
function goTo(message) {
  storage?.setItem(moveKey, JSON.stringify(message));
  location.reload();
}

/** Looks again and again whether the room is awake, by a question that wakes no room; who came by a link has no right to ask, and enters again. */
function waitForPeople(room, link) {
  const ask = async () => {
    const abort = new AbortController();
    const answer = await fetch(`/api/v1/rooms/${room}/stream`, { signal: abort.signal }).catch(() => null);
    const isAwake = answer?.ok || answer?.status === 404 || (answer?.status === 401 && link);
    abort.abort();
    if (isAwake) location.reload();
    else clock.setTimeout(ask, sleepMs);
  };
  clock.setTimeout(ask, sleepMs);
}

function start() {
  const move = takeMove();
  const room = move?.room ?? home;
  const link = takeLink();
  let seat = null; // of the wall: it has no other right than that
  const api = makeApi((path, init = {}) => fetch(path, { ...init, headers: { ...(seat && ofMember(seat)), ...init.headers } }));
  const url = new URL(`/api/v1/rooms/${room}/ws`, location.href);
  url.protocol = url.protocol.replace('http', 'ws');
  url.search = url.hash = '';
  const isGone = () =>
    api.room(room).then(
      () => false,
      (problem) => problem.type === '/problems/not-found',
    );
  const connection = new Connection(
    url.href,
    { makeSocket: (address) => new WebSocket(address), clock, isGone },
    { link, wall: true, ...(move && { member: move.member, secret: move.secret }) },
  );
  connection.addEventListener('message', ({ detail }) => {
    if (detail.type === 'welcome') seat = detail;
    else if (detail.type === 'meeting') storage?.setItem(meetingKey, detail.meeting);
  });
  // a seat that is lost, as after a restart of the server: the wall begins at its address again; one of a meeting, at the case that is now
  connection.addEventListener('ended', ({ detail }) => {
    const meeting = storage?.getItem(meetingKey);
    if (detail.code === 'removed') return;
    if (detail.code === 'asleep') return waitForPeople(room, link);
    if (room !== home) location.reload();
    else if (meeting && link) location.replace(`/meetings/${meeting}#link=${link}`);
  });
  connection.open();
  const redraw = new Redraw((callback) => requestAnimationFrame(callback), clock);
  const { decode } = new Decoder({
    makeWorker: () => new Worker('/js/pane/decode_worker.js'),
    decodeHere: (picture, type) => createImageBitmap(new Blob([picture], { type })),
  });
  const only = new URLSearchParams(location.search).get('view') ?? '';
  globalThis.wall = wallPage(host, room, { api, connection, clock, redraw, decode, storage, card: move, goTo }, only);
}

if (isId(home)) start();
else host.textContent = say.noRoom;
