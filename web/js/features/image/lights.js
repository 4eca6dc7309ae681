// Part of the inspector's Selection of the 3-D picture: the lights of the scene.
import { html, nothing } from '../../../lib/lit-html.js';
import { live } from '../../../lib/directives/live.js';
import { numberField, segment } from '../../parts/fields.js';
import { say } from './later_words.js';

/** Numbers of the light, as proto/scene.json has them: name, words, least, most, step of the slider, unit, shown = value times factor. */
const rows = [
  ['azimuth_deg', say.azimuth, -180, 180, 1, '°', 1],
  ['elevation_deg', say.elevation, -90, 90, 1, '°', 1],
  ['intensity', say.intensity, 0, 2, 0.01, '%', 100],
  ['ambient', say.ambient, 0, 1, 0.01, '%', 100],
];
const usual = { frame: 'viewer', azimuth_deg: 31.2, elevation_deg: 34.6, intensity: 1, ambient: 0.3 };

export function lightsBlock({ room }, isDisabled, change) {
  const { lights } = room.scene.value;
  if (!lights) return nothing;
  const set = (name, value, event) => change({ lights: { [name]: value } }, event);
  const isUsual = Object.keys(usual).every((name) => lights[name] === usual[name]);
  const row = ([name, words, low, high, step, unit, factor]) => {
    const shown = Math.round(lights[name] * factor * 10) / 10;
    const enter = (value, event) => set(name, Math.min(Math.max(value / factor, low), high), event);
    return html`<dt>${words}</dt><dd class="pair"><input type="range" min=${low} max=${high} step=${step} .value=${live(String(lights[name]))} aria-label=${words} ?disabled=${isDisabled}
      @input=${(event) => set(name, event.target.valueAsNumber, event)}>${numberField(say.lightNumber({ name: words }), shown, unit, isDisabled, enter)}</dd>`;
  };
  return html`<section class="block lights"><h3>${say.lights}</h3>
    <dl class="image-rows"><dt>${say.lightFixed}</dt><dd>${segment(
      say.lightFixed,
      [
        ['viewer', say.toViewer, say.toViewerIs],
        ['patient', say.toPatient, say.toPatientIs],
      ],
      lights.frame,
      isDisabled,
      (frame, event) => set('frame', frame, event),
    )}</dd>${rows.map(row)}</dl>
    <div class="buttons"><button ?disabled=${isDisabled || isUsual} title=${say.lightsUsualIs} @click=${(event) => change({ lights: usual }, event)}>${say.lightsUsual}</button></div></section>`;
}
