// Calls of the HTTP API (proto/http.json) that the page uses. Every failure is a Problem with a sentence.
import { told } from '../parts/sentences.js';
import { say } from './words.js';

const thumbnailPx = [192, 116]; // twice the size on the page

/** An RFC 9457 problem, or a request that did not reach the server. */
export class Problem extends Error {
  /** @param {{type?: string, status?: number, detail?: string, title?: string}} problem */
  constructor(problem) {
    super(problem.detail || problem.title || say.noReason);
    this.type = problem.type ?? '';
    this.status = problem.status ?? 0;
    this.code = problem.code ?? '';
  }
}

/** The header that says who makes a call. */
export const ofMember = ({ member, secret }) => ({ 'Beamroom-Member': `${member} ${secret}` });

/** @param {typeof fetch} fetch @param {string} base */
export function makeApi(fetch, base = '/api/v1') {
  async function call(method, path, options = {}, tries = 3) {
    const { body, signal, isPicture = false, more = {} } = options;
    let response;
    try {
      response = await fetch(`${base}/${path}`, {
        method,
        signal,
        headers: body === undefined ? more : { 'Content-Type': 'application/json', ...more },
        body: body === undefined ? undefined : JSON.stringify(body),
      });
    } catch (error) {
      if (error.name === 'AbortError') throw error;
      throw new Problem({ detail: say.noAnswer });
    }
    const isJson = /json/.test(response.headers.get('Content-Type') ?? '');
    const answer = isJson ? told(await response.json().catch(() => null)) : null;
    if (answer?.code === 'rate' && tries > 0) {
      await new Promise((done) => setTimeout(done, answer.retry_after_ms));
      return call(method, path, options, tries - 1);
    }
    if (!response.ok) throw new Problem({ status: response.status, ...(answer ?? { detail: say.answered(response) }) });
    return isPicture ? response.blob() : answer;
  }
  const id = encodeURIComponent;
  return {
    version: (signal) => call('GET', 'version', { signal }),
    plans: (signal) => call('GET', 'plans', { signal }),
    plan: (plan, signal) => call('GET', `plans/${id(plan)}`, { signal }),
    openPlan: (plan) => call('POST', `plans/${id(plan)}/open`, { body: {} }),
    removePlan: (plan, { keepsRecords = false, by = '' } = {}) =>
      call('DELETE', `plans/${id(plan)}?by=${id(by)}${keepsRecords ? '&records=keep' : ''}`),
    uploadUrl: (name) => (name ? `${base}/plans?name=${id(name)}` : `${base}/plans`),
    job: (job, signal) => call('GET', `jobs/${id(job)}`, { signal }),
    cancelJob: (job) => call('DELETE', `jobs/${id(job)}`),
    thumbnail: (plan) =>
      call('POST', `plans/${id(plan)}/render`, {
        isPicture: true,
        body: { view: { kind: '3d', size_px: thumbnailPx }, format: 'jpeg', quality: 85, only_loaded: true },
      }),
    rooms: (signal) => call('GET', 'rooms', { signal }),
    makeRoom: (plan) => call('POST', 'rooms', { body: { plan } }),
    /** Any other call, of parts that are loaded later. */
    call,
    /** A room of its own that begins with a saved view. @param {string} token of its link */
    makeRoomOfBookmark: (token) => call('POST', 'rooms', { body: { saved: token } }),
    bookmark: (room, bookmark) => call('GET', `rooms/${id(room)}/bookmarks/${id(bookmark)}`),
    bookmarkPicture: (room, bookmark) => call('GET', `rooms/${id(room)}/bookmarks/${id(bookmark)}/picture`, { isPicture: true }),
    room: (room) => call('GET', `rooms/${id(room)}`),
    /** @param {{member: string, secret: string}} identity of who makes it @param {{role: string, expires_s: number, one_use: boolean}} link @returns {Promise<{token: string}>} */
    makeLink: (room, identity, link) => call('POST', `rooms/${id(room)}/links`, { body: link, more: ofMember(identity) }),
    probe: (plan, [x, y, z], signal) => call('GET', `plans/${id(plan)}/probe?x=${x}&y=${y}&z=${z}`, { signal }),
    pick: (plan, room, view, px, py, prefer = '') => {
      const preferred = prefer ? `&prefer=${id(prefer)}` : '';
      return call('GET', `plans/${id(plan)}/pick?room=${id(room)}&view=${id(JSON.stringify(view))}&px=${px}&py=${py}${preferred}`);
    },
    /** A question about the scene of a room with a view's override: dvh, profile, constraints, dose/probe. */
    ofScene: (plan, question, room, view, parameters, signal) =>
      call('GET', `plans/${id(plan)}/${question}?${new URLSearchParams({ room, view: JSON.stringify(view), ...parameters })}`, { signal }),
    /** Where the labels of a slice pane's isodose lines stand on its picture. */
    isolines: (plan, room, view, textPx, signal) =>
      call('GET', `plans/${id(plan)}/dose/isolines?room=${id(room)}&view=${id(JSON.stringify(view))}&text_px=${textPx}&choice=true`, {
        signal,
      }),
    histogram: (plan, image) => call('GET', `plans/${id(plan)}/images/${id(image)}/histogram`),
    ellipse: (plan, image, [centre, a, b]) => call('GET', `plans/${id(plan)}/images/${id(image)}/ellipse?center=${centre}&a=${a}&b=${b}`),
    surface: (plan, region, query, signal) =>
      call('GET', `plans/${id(plan)}/regions/${id(region)}/surface?${new URLSearchParams(query)}`, { signal }),
    surfaceUrl: (plan, region, query) => `${base}/plans/${id(plan)}/regions/${id(region)}/surface?${new URLSearchParams(query)}`,
    /** The annotated picture as a PNG. @returns {Promise<Blob>} */
    snapshot: (room, view, isNamed = false, more = '') =>
      call(
        'GET',
        `rooms/${id(room.id)}/snapshot?view=${id(JSON.stringify(view))}&format=png&annotations=true${isNamed ? '&identity=true' : ''}${more}`,
        {
          isPicture: true,
          more: ofMember(room.identity),
        },
      ),
  };
}
