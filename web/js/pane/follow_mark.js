// In the header of each pane: whether it shows the shared view or an own one.
import { html, nothing } from '../../lib/lit-html.js';
import { icon } from '../parts/icons.js';
import { say } from './words.js';

/** Nothing for a member who is alone. */
export function followMark(room) {
  const isOwn = !room.following.isFollowing.value;
  if (!isOwn && room.members.value.filter(({ connected }) => connected !== false).length < 2) return nothing;
  const about = isOwn ? say.ownView : room.following.isPresenting.value ? say.sharedSeen : say.sharedView;
  return html`<span class="follow-mark" role="img" data-own=${isOwn} title=${about} aria-label=${about}>${icon(isOwn ? 'person' : 'people', 12)}</span>`;
}
