// The fidelity of the picture on the screen: one of six states, each with its words. Pure functions.

const staleMs = 1000;
const deadMs = 5000; // an answer that is due for so long
/** Best to worst. */
export const order = ['full', 'live', 'reduced', 'stale', 'link', 'disconnected'];

const words = { full: 'Full', live: 'Live', reduced: 'Reduced', stale: 'Stale', disconnected: 'Disconnected' };

function why(header) {
  const reasons = [];
  if (header.scale_percent < 100) reasons.push(`size ${header.scale_percent} %`);
  if (header.quality > 0 && header.quality < 60) reasons.push(`quality ${header.quality}`);
  if (header.is_coarse) reasons.push('coarse surfaces');
  return reasons;
}

/**
 * @param {object} facts
 * @param {{state: string, retryAt: number, quietSince: number, dueSince: number}} facts.link
 * @param {string} facts.renderer state of the renderer
 * @param {import('../wire/frame.js').FrameHeader|null} facts.header of the picture on the screen
 * @param {number} facts.staleSince since when an answer is due @param {number} facts.behindSince since when a newer picture is; each 0: none is
 * @param {number} facts.fps @param {number} facts.now
 * @returns {{state: string, text: string, why: string} | null} null before the first picture
 */
export function fidelity({ link, renderer, header, staleSince, behindSince, fps, now, refusal = '' }) {
  const badge = (state, text, reason = '') => ({ state, text, why: reason });
  if (link.state === 'lost') {
    const seconds = Math.max(0, Math.ceil((link.retryAt - now) / 1000));
    return badge('disconnected', seconds ? `Disconnected, trying again in ${seconds} s` : 'Disconnected, trying again');
  }
  if (link.state === 'ended') return badge('disconnected', 'Disconnected', link.reason);
  if (link.quietSince && now - link.dueSince >= deadMs)
    return badge('disconnected', 'Disconnected', 'The server has not answered for 5 s. What you change is kept and sent.');
  if (link.quietSince)
    return badge(
      'link',
      `Link? ${Math.floor((now - link.quietSince) / 1000)} s`,
      'Nothing was heard from the server for so long. What you change is kept and sent.',
    );
  if (!header) return null;
  if (renderer === 'failed' || renderer === 'closed')
    return badge('stale', 'Stale', 'The plan is not loaded; this is the last picture of it.');
  if (renderer !== 'ready') return badge('stale', 'Stale', 'The renderer is being started again; this is the last picture it made.');
  if (refusal) return badge('stale', 'Stale', `The view cannot be drawn as it is now: ${refusal}`);
  const since = Math.min(staleSince || Infinity, behindSince || Infinity);
  if (now - since > staleMs)
    return badge('stale', `Stale ${Math.floor((now - since) / 1000)} s`, 'The picture does not show the newest change yet.');
  if (header.is_still && header.scale_percent === 100 && !header.is_coarse)
    return header.is_lossless ? badge('full', 'Full, lossless still') : badge('full', 'Full');
  const reasons = why(header);
  if (reasons.length) {
    const text = reasons.join(', ');
    return badge('reduced', words.reduced, `${text[0].toUpperCase()}${text.slice(1)} while moving. The full picture follows at rest.`);
  }
  return badge('live', fps > 1 ? `Live, ${fps} fps` : words.live);
}

/** The badge of all panes together: the worst of them. */
export function worst(badges) {
  return badges.filter(Boolean).reduce((a, b) => (a && order.indexOf(a.state) >= order.indexOf(b.state) ? a : b), null);
}
