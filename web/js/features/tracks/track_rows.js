// Particle tracks in the tree: a row for all, a row with a check-box for each class; and the chosen segment in 3-D panes.
import { html, nothing, svg } from '../../../lib/lit-html.js';
import { live } from '../../../lib/directives/live.js';
import { className } from '../../room/plan.js';
import { classPatch, isShownClass, isWhole } from './tracks.js';
import { number } from '../../parts/format.js';
import { toggleTracks } from './feature.js';
import { eye, name, treeRow } from '../../parts/tree_row.js';
import { say } from './later_words.js';

const how = (ui, event) => ({ view: ui.active.value, at: event.timeStamp });

/** A line as pictures draw it: colour, dashes, and the cross at the end of lost ones. */
export function trackSwatch({ color, dash, hasCross }) {
  return html`<svg class="track-swatch" viewBox="0 0 26 12" width="26" height="12" aria-hidden="true"><path d="M1 6h${hasCross ? 18 : 24}" stroke=${color} stroke-dasharray=${dash ? dash.join(' ') : nothing} stroke-width="2" fill="none"/>
    ${hasCross ? svg`<path d="m17 2 8 8m0-8-8 8" stroke=${color} stroke-width="1.5" fill="none"/>` : nothing}</svg>`;
}

export function trackNote({ room }) {
  const { tracks } = room.scene.value;
  if (!tracks.visible) return say.off;
  return isWhole(room.scene.value) ? '' : say.aPart;
}

export function trackRows(world) {
  return html`${allRow(world)}${world.room.plan.value.trackClasses.map((one) => classRow(world, one))}`;
}

function allRow(world) {
  const { room, ui } = world;
  const { visible } = room.scene.value.tracks;
  const total = number(room.plan.value.nTracks);
  const toggle = (event) => toggleTracks(world, event.timeStamp);
  return treeRow(
    world,
    {
      kind: 'tracks',
      id: '',
      words: [say.tracks, total],
      more: [say.segmentsMore],
      title: ui.keys.tip(say.inSpace, 'tracks'),
      isOn: visible,
      toggle,
    },
    html`
    ${eye(visible, say.showTracks, ui.keys.tip(visible ? say.hideKey : say.showKey, 'tracks'), !room.canChange.value, toggle)}${name(say.tracks)} <span class="tail">${total}</span>`,
  );
}

function classRow(world, one) {
  const { room, ui } = world;
  const { id, n } = one;
  const isOn = isShownClass(room.scene.value, id);
  const words = className(id);
  const ofClass = say.ofClass({ name: words, count: number(n), n });
  const toggle = (event) => room.patchScene(classPatch(id, !isShownClass(room.scene.value, id)), how(ui, event));
  return treeRow(
    world,
    { kind: 'tracks', id, words: [words, number(n)], more: [say.segmentsMore], title: ofClass, depth: 1, isOn, toggle },
    html`
    <input type="checkbox" class="track-check" tabindex="-1" aria-label=${say.show({ name: words })} .checked=${live(isOn)}
      ?disabled=${!room.canChange.value} @click=${(event) => event.stopPropagation()} @change=${toggle}>
    ${trackSwatch(one)}${name(words)} <span class="tail">${number(n)}</span>`,
  );
}

/** The chosen segment over the picture of a view into space, as far as it lies before the eye. @param {{header: object, box: {x: number, y: number, width: number, height: number}}} place */
export function chosenTrack({ room, ui }, { header, box }) {
  const track = ui.selection.value.kind === 'track' && ui.track.value;
  if (!track || !room.scene.value.tracks.visible) return nothing;
  const m = header.clip_from_lps_mm;
  const clip = ([x, y, z]) => [0, 1, 3].map((row) => m[row] * x + m[4 + row] * y + m[8 + row] * z + m[12 + row]);
  let [a, b] = [track.from_lps_mm, track.to_lps_mm].map(clip);
  const nearest = 1e-3;
  if (a[2] < nearest && b[2] < nearest) return nothing;
  const cut = (p, q) => p.map((value, i) => value + ((q[i] - value) * (nearest - p[2])) / (q[2] - p[2]));
  if (a[2] < nearest) a = cut(a, b);
  if (b[2] < nearest) b = cut(b, a);
  const [from, to] = [a, b].map(([x, y, w]) => [box.x + ((x / w + 1) / 2) * box.width, box.y + ((1 - y / w) / 2) * box.height]);
  return svg`<g class="track-chosen">${['under', 'ink'].map((layer) => svg`<line class=${layer} x1=${from[0]} y1=${from[1]} x2=${to[0]} y2=${to[1]} />${[from, to].map(([x, y]) => svg`<circle class=${layer} cx=${x} cy=${y} r="4" />`)}`)}</g>`;
}
