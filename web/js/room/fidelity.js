// The fidelity of the picture on the screen: one of seven states, each with its words. Pure functions.

import { say } from './words.js';
const staleMs = 1000;
const deadMs = 5000; // an answer that is due for so long
/** Best to worst. */
export const order = ['full', 'live', 'reduced', 'stale', 'link', 'disconnected', 'paused'];

function why(header) {
  const reasons = [];
  if (header.scale_percent < 100) reasons.push(say.sizeIs({ n: header.scale_percent }));
  if (header.quality > 0 && header.quality < 60) reasons.push(say.qualityIs({ n: header.quality }));
  if (header.is_coarse) reasons.push(say.coarse);
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
    return badge('disconnected', seconds ? say.tryingIn({ n: seconds }) : say.trying);
  }
  if (link.state === 'paused') return badge('paused', say.paused, say.signInEnded);
  if (link.state === 'ended') return badge('disconnected', say.disconnected, link.reason);
  if (link.quietSince && now - link.dueSince >= deadMs) return badge('disconnected', say.disconnected, say.noAnswer);
  if (link.quietSince) return badge('link', say.link({ n: Math.floor((now - link.quietSince) / 1000) }), say.quiet);
  if (!header) return null;
  if (renderer === 'failed' || renderer === 'closed') return badge('stale', say.stale, say.notLoaded);
  if (renderer !== 'ready') return badge('stale', say.stale, say.startedAgain);
  if (refusal) return badge('stale', say.stale, say.cannotDraw({ reason: refusal }));
  const since = Math.min(staleSince || Infinity, behindSince || Infinity);
  if (now - since > staleMs) return badge('stale', say.staleFor({ n: Math.floor((now - since) / 1000) }), say.notNewest);
  if (header.is_still && header.scale_percent === 100 && !header.is_coarse)
    return header.is_lossless ? badge('full', say.lossless) : badge('full', say.full);
  const reasons = why(header);
  if (reasons.length) {
    const text = reasons.join(', ');
    return badge('reduced', say.reduced, say.whileMoving({ reasons: `${text[0].toUpperCase()}${text.slice(1)}` }));
  }
  return badge('live', fps > 1 ? say.liveFps({ n: fps }) : say.live);
}

/** The badge of all panes together: the worst of them. */
export function worst(badges) {
  return badges.filter(Boolean).reduce((a, b) => (a && order.indexOf(a.state) >= order.indexOf(b.state) ? a : b), null);
}
