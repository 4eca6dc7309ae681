// The status bar of a room: fidelity and speed of the pictures, position of the crosshair.
import { html, nothing } from '../../lib/lit-html.js';
import { worst } from '../room/fidelity.js';
import { crosshair } from '../room/plan.js';
import { partsOf } from '../features/index.js';
import { number } from '../parts/format.js';
import { icon } from '../parts/icons.js';
import { savedMark } from './saved.js';
import { say } from './words.js';

const milliseconds = (ms) => (ms === null ? '–' : `${number(ms)} ms`);

export function status(world) {
  const { room, ui, panes, probed } = world;
  const shown = ui.visible.value;
  const badge = worst(
    panes()
      .filter((_, index) => shown.includes(index + 1))
      .map((pane) => pane.badge.value),
  );
  const scene = room.scene.value;
  const plan = room.plan.value;
  const fps = Math.max(...shown.map((number_) => room.view(number_).fpsAt(ui.now.value)));
  const region = probed.value.result && plan?.regions.find((other) => other.id === probed.value.result.regions[0]);
  const point = scene && crosshair(scene);
  return html`
    ${badge ? html`<span class=${`badge ${badge.state}`} id="badge-all" data-badge=${badge.state}>${icon(badge.state, 12)}<span>${badge.text}</span></span>` : nothing}
    ${room.link.value.state === 'lost' ? html`<button class="ghost" @click=${() => room.reconnect()}>${say.tryNow}</button>` : nothing}
    ${savedMark(room)}
    <span class="pairing pace" title=${say.latencyIs({ ping: milliseconds(room.pingMs.value) })}>${say.latency} <b id="latency">${milliseconds(room.latencyMs.value)}</b></span>
    <span class="pairing pace"><b id="fps">${fps ? `${number(fps)} fps` : say.idle}</b></span>
    <span class="dim wide" id="gl">${room.gl.value}</span>
    ${point && !ui.isTouch.value ? html`<i class="rule"></i><span class="pairing">${say.position} <b>L ${number(point[0], 1)}  P ${number(point[1], 1)}  S ${number(point[2], 1)} mm</b></span><span class="place-name">${[region?.name, ...partsOf('here', world)].filter(Boolean).join(', ')}</span>` : nothing}
    <span class="grow"></span>
    <span class="radiological">${say.radiological}</span><i class="rule"></i>
    <b class="research" title=${say.researchIs}>${say.research}</b>`;
}
