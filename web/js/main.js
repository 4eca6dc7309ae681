// Starts the page: gives the browser's socket, clock and decoder to the modules and shows the page that the address names.
import { Connection } from './net/connection.js';
import { makeApi } from './net/api.js';
import { sendPlan } from './net/upload.js';
import { Hooks } from './hooks.js';
import { roomPage } from './panels/room_page.js';
import { startPage } from './panels/start_page.js';
import { isId } from './wire/check.js';

const clock = {
  now: () => performance.now(),
  setTimeout: (callback, ms) => setTimeout(callback, ms),
  clearTimeout: (timer) => clearTimeout(timer),
};
const schedule = (callback) => requestAnimationFrame(callback);
const hooks = new Hooks(clock);
const api = makeApi((...request) => fetch(...request));
const enter = (room) => { location.hash = `#/rooms/${room}`; };

const send = ({ publicName, ...task }) => sendPlan({ ...task, url: api.uploadUrl(publicName), makeRequest: () => new XMLHttpRequest() });

/** The member that this tab was in the room before a reload. */
function remembered(room) {
  try {
    return JSON.parse(sessionStorage.getItem(`room ${room}`)) ?? {};
  } catch {
    return {};
  }
}

function connect(room) {
  const url = new URL(`api/v1/rooms/${room}/ws`, location.href);
  url.protocol = url.protocol.replace('http', 'ws');
  url.hash = '';
  const { member = '', secret = '' } = remembered(room);
  const isGone = () => api.room(room).then(() => false, (problem) => problem.type === '/problems/not-found');
  const connection = new Connection(url.href, { makeSocket: (address) => new WebSocket(address), clock, isGone }, { member, secret });
  connection.addEventListener('message', ({ detail }) => {
    if (detail.type === 'welcome') sessionStorage.setItem(`room ${room}`, JSON.stringify({ member: detail.member, secret: detail.secret }));
  });
  return connection;
}

let leave = () => {};

function route() {
  const [, place, id] = location.hash.split('/');
  if (location.hash.startsWith('#picture-')) return; // the skip link's target, not a page
  leave();
  const host = document.querySelector('#page');
  leave = place === 'rooms' && isId(id)
    ? roomPage(host, id, { api, connect, clock, schedule, decode: (blob) => createImageBitmap(blob), hooks })
    : startPage(host, { api, clock, enter, send });
}

addEventListener('hashchange', route);
route();
