// The page of a display: shows the stream of a room's view, and says at once when it is not what the room shows now.
import { Problem, makeApi } from './net/api.js';
import { Parts, pictureHeader } from './net/parts.js';
import { edgeLetters } from './pane/letters.js';
import { Painter } from './pane/painter.js';
import { keepTextVisible } from './parts/visible_text.js';
import { isId } from './wire/check.js';
import { say } from './display_words.js';

keepTextVisible(document.documentElement);

const lostMs = 5000; // without a part; the server sends one every 2 s
const lateMs = 3500;
const retryMs = 2000;
const firstMs = 20000; // after which a first picture is not only late
const begunAt = performance.now();
const tickMs = 250;
const factsMs = 5000;
const viewNames = {
  '3d': '3-D',
  axial: say.axial,
  coronal: say.coronal,
  sagittal: say.sagittal,
  oblique: say.oblique,
  beam: say.beam,
  'beam-slice': say.beamSlice,
};
const rendererWords = {
  starting: say.opening,
  loading: say.opening,
  restarting: say.restarting,
  failed: say.failed,
  closed: say.closed,
};

let seat = null; // of a display that came by a link
const ask = (path, init = {}) => fetch(path, seat ? { ...init, headers: { ...seat.headers, ...init.headers } } : init);
const api = makeApi(ask);
const room = location.pathname.split('/').pop();
const $ = (selector) => document.querySelector(selector);
const figure = $('figure');
$('header .note').textContent = say.forReview;
$('footer p').textContent = say.alone;

const state = {
  heardAt: 0, // when the last part came; 0: none has
  changedAt: 0, // when the newest picture came, ms since 1970
  number: 0,
  header: null, // of the picture on the screen
  isOld: false, // the server says that the room shows something newer
  problem: null, // why there is no stream
  facts: null, // of GET /rooms/{room}
  plan: '',
};

const makePainter = () =>
  new Painter($('canvas'), {
    decode: (picture, type) => createImageBitmap(new Blob([picture], { type })),
    schedule: (callback) => requestAnimationFrame(callback),
    onPainted: (header, isDrawn) => {
      if (!isDrawn) return;
      state.header = header;
      state.changedAt = Date.now();
      draw();
    },
  });
let painter = makePainter();
let abort = new AbortController(); // of the stream

/** Nobody may look here any more: no picture of a patient stays on the screen. @param {string} why */
function shut(why) {
  abort.abort();
  painter.stop();
  painter = makePainter();
  $('canvas').width = 1; // clears it
  Object.assign(state, { heardAt: 0, header: null, number: 0, facts: null, problem: why });
  draw();
}

/** The picture as large as the screen allows, whole. */
function place() {
  const { clientWidth, clientHeight } = $('main');
  const { width_px, height_px } = state.header;
  const scale = Math.min(clientWidth / width_px, clientHeight / height_px);
  Object.assign(figure.style, { width: `${Math.floor(width_px * scale)}px`, height: `${Math.floor(height_px * scale)}px` });
}

const time = (ms) => new Date(ms).toLocaleTimeString('en-GB');

function words(silentMs) {
  const { facts, header, problem } = state;
  if (problem && silentMs > lateMs) return { notice: problem, kind: header ? 'lost' : 'waiting' };
  if (header && silentMs > lostMs) return { notice: say.lostAt({ time: time(state.changedAt) }), kind: 'lost' };
  if (!header)
    return {
      notice: rendererWords[facts?.renderer] ?? (performance.now() - begunAt < firstMs ? say.waiting : say.noPicture),
      kind: 'waiting',
    };
  if (state.isOld && (!facts || facts.renderer === 'ready')) return { notice: say.newer({ time: time(state.changedAt) }), kind: 'lost' };
  return { notice: facts && facts.renderer !== 'ready' ? (rendererWords[facts.renderer] ?? '') : '', kind: 'lost' };
}

function draw() {
  const silentMs = state.heardAt ? performance.now() - state.heardAt : Infinity;
  const { facts, header, plan } = state;
  const kind = header?.kind;
  const presenter = facts?.members.find(({ presenting }) => presenting);
  const isLost = header && silentMs > lostMs;
  const isSilent = silentMs > lateMs;
  const late = isLost ? 'lost' : isSilent || state.isOld ? 'late' : 'live';
  $('h1').textContent = [plan, say.room({ room }), viewNames[kind]].filter(Boolean).join(' · ');
  document.title = [plan, say.displayOf].filter(Boolean).join(' – ');
  $('.who').textContent = [
    presenter ? say.presenter(presenter) : facts ? say.nobody : '',
    header?.missing ? say.notDrawn({ what: header.missing }) : '',
  ]
    .filter(Boolean)
    .join(' · ');
  $('.clock').textContent = time(Date.now());
  const age = $('.age');
  age.dataset.state = figure.dataset.state = header ? late : '';
  const said = !header
    ? ''
    : isLost
      ? say.lost
      : isSilent
        ? say.link
        : state.isOld
          ? say.old({ time: time(state.changedAt) })
          : say.live({ time: time(state.changedAt) });
  if (age.textContent !== said) age.textContent = said; // a live region: only what is new
  const { notice, kind: how } = words(silentMs);
  const line = $('.notice');
  line.dataset.state = how;
  if (line.textContent !== notice) line.textContent = notice;
  figure.hidden = !header;
  if (!header) return;
  place();
  const letters = edgeLetters(header.clip_from_lps_mm);
  for (const edge of ['top', 'bottom', 'left', 'right']) $(`.letter.${edge}`).textContent = letters[edge];
  $('canvas').setAttribute('aria-label', viewNames[kind] ? say.picture({ view: viewNames[kind], ...letters }) : say.sharedPicture(letters));
}

function take({ fields, body }) {
  const header = pictureHeader(fields);
  state.heardAt = performance.now();
  state.problem = null;
  state.isOld = fields['beamroom-late'] === 'true';
  if (header.sequence === state.number) return; // the same picture once more
  state.number = header.sequence;
  painter.offer({ header, picture: body });
}

/** Shows the stream until it ends. */
async function show() {
  const { signal } = abort;
  state.number = 0;
  const answer = await ask(`/api/v1/rooms/${room}/stream${location.search}`, { signal });
  if (answer.status === 401) return shut(say.needsLink);
  if (!answer.ok) throw new Problem({ status: answer.status, ...(await answer.json().catch(() => ({}))) });
  tellFacts().catch(() => {}); // asked again soon
  const parts = new Parts();
  const reader = answer.body.getReader();
  for (;;) {
    const { done, value } = await reader.read();
    if (signal.aborted) return;
    if (done) throw new Problem({ detail: say.ended });
    parts.push(value).forEach(take);
  }
}

/** Asks who presents and how the renderer is. Asked only while there is a stream: the question would wake a room that sleeps. */
async function tellFacts() {
  state.facts = await api.room(room);
  state.plan ||= (await api.plan(state.facts.plan)).name;
  draw();
}

/** The token of the link leaves the address, and is kept for a reload of this tab. */
function takeLink() {
  const key = `wall:${room}`;
  const link = new URLSearchParams(location.hash.slice(1)).get('link');
  try {
    if (link) sessionStorage.setItem(key, link);
    if (link) history.replaceState(null, '', location.pathname + location.search);
    return link ?? sessionStorage.getItem(key);
  } catch {
    return link; // a browser that keeps nothing: the address has to
  }
}

async function run() {
  const link = takeLink();
  if (link) {
    const { WallSeat } = await import('./wall_seat.js');
    seat = new WallSeat(room, link.slice(0, 64), shut, () => shut(say.needsLink));
  }
  for (;;) {
    if (seat && !seat.isIn) {
      await new Promise((done) => {
        setTimeout(done, tickMs);
      });
      continue;
    }
    abort = new AbortController();
    // a connection that was cut without a word
    const watch = setInterval(() => {
      if (state.number && performance.now() - state.heardAt > 2 * lostMs) abort.abort();
    }, tickMs);
    const facts = setInterval(() => {
      tellFacts().catch(() => {});
    }, factsMs);
    await show().catch((error) => {
      abort.abort();
      state.facts = null;
      if (error instanceof Problem) state.problem = error.message;
    });
    clearInterval(watch);
    clearInterval(facts);
    draw();
    await new Promise((done) => {
      setTimeout(done, retryMs);
    });
  }
}

/** Says in red, where it is so, that this server is open to everybody. Asked until there is an answer. */
async function tellOpen() {
  const facts = await api.version().catch(() => null);
  if (!facts) setTimeout(tellOpen, retryMs);
  else if (facts.open_to_everybody) $('.open').textContent = say.open;
}
void tellOpen();

if (isId(room)) {
  setInterval(draw, tickMs);
  addEventListener('resize', draw);
  draw();
  run();
} else {
  state.problem = say.noRoom;
  draw();
}
