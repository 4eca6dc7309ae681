// The foot of a beam's-eye pane: the slider along the beam with the regions on the way, what slides, what is seen of it, the ring's diameter.
import { html, nothing, svg } from '../../../lib/lit-html.js';
import { live } from '../../../lib/directives/live.js';
import { clipInFront, firstAlong, movers, ticksOf } from './beam_along.js';
import { usualRingMm } from './beam_eye.js';
import { checkbox, numberField } from '../../parts/fields.js';
import { number } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { variables } from '../../parts/mount.js';
import { say } from './pane_words.js';

const tickPx = 46; // at least between two numbers
const [roomPx, checksPx] = [210, 430]; // of the buttons and the field beside the slider, of the check boxes
const [wideFrom, widestFrom] = [560, 1000]; // px of the pane: what slides is chosen in the slider's row, and all is in one row (js/features/beams/beam.css)

/**
 * @param {object} world {room, ui, view}
 * @param {object} along {beam, ring, range, bands, mover, at, width: of the pane, words(mm), slide(mm, at), slideBy(mm, at), setRing(mm, at), toggleRing(at)}
 */
export function beamFoot({ room, ui, view }, along) {
  const { beam, ring, range, bands, mover, at, width, words, slide, slideBy, setRing, toggleRing } = along;
  const scene = room.scene.value;
  const isOff = !room.canChange.value;
  const isTogether = ui.panes.isBeamTogether.value;
  const { low, high } = range;
  const part = (mm) => `${((mm - low) / (high - low)) * 100}%`;
  const patch = (change, event) => room.patchScene(change, { view: view.number, at: event.timeStamp });
  const value = Math.round(at * 10) / 10 || 0;
  const colour = (id) => scene.regions[id]?.color ?? room.plan.value.regions.find((region) => region.id === id)?.color ?? '#6d7682';
  const step = (
    by,
    name,
    picture,
    key,
  ) => html`<button class="icon-button" aria-label=${name} title=${say.stepKeys({ step: name, key })} ?disabled=${isOff}
    @click=${(event) => slideBy(by * (event.shiftKey ? 10 : 1), event.timeStamp)}>${icon(picture)}</button>`;
  const onKey = (event) => {
    const by = { PageUp: 10, PageDown: -10, ArrowUp: 1, ArrowRight: 1, ArrowDown: -1, ArrowLeft: -1 }[event.key];
    if (!by) return;
    event.preventDefault();
    slideBy(by * (event.shiftKey && Math.abs(by) === 1 ? 10 : 1), event.timeStamp);
  };
  const mainly = html`<select aria-label=${say.slides} title=${say.slidesIs} .value=${live(mover)} @change=${(event) => {
    ui.beamMover.value = event.target.value;
  }}>
      ${movers(isTogether).map(([id, name]) => html`<option value=${id} ?selected=${id === mover}>${name}</option>`)}</select>`;
  return html`<div class="beam-foot" role="group" aria-label=${say.along}>${width < wideFrom ? nothing : mainly}
    <span class="beam-slide">${step(-1, say.back, 'chevronLeft', '[')}
      <span class="beam-rail"><svg class="beam-bands" viewBox=${`${low} 0 ${high - low} 1`} preserveAspectRatio="none" aria-hidden="true"><rect class="beam-none" x=${low} width=${high - low} height="1" />
        ${bands.map(({ region, from_mm: from, to_mm: to }) => svg`<rect x=${from} width=${to - from} height="1" fill=${colour(region)} />`)}</svg>
        <span class="beam-targets" aria-hidden="true"><i ${variables({ '--at': part(beam.length) })}></i></span>
        <input type="range" min=${low} max=${high} step="0.1" .value=${live(String(value))} ?disabled=${isOff} aria-label=${movers(isTogether).find(([id]) => id === mover)[2]} aria-valuetext=${words(value)}
          title=${say.targetAt({ place: words(value), mm: number(beam.length, 1) })} @input=${(event) => slide(event.target.valueAsNumber, event.timeStamp)} @keydown=${onKey}>
        <span class="beam-ticks" aria-hidden="true">${ticksOf(range, Math.max(3, (width - roomPx - (width < wideFrom ? 0 : 130) - (width < widestFrom ? 0 : checksPx)) / tickPx)).map((mm) => html`<b ${variables({ '--at': part(mm) })}>${number(mm)}</b>`)}</span></span>
      ${step(1, say.on, 'chevronRight', ']')}
      ${numberField(say.alongMm, value, 'mm', isOff, (mm, event) => slide(mm, event.timeStamp))}</span>
    <span class="beam-checks">${width < wideFrom ? mainly : nothing}${checkbox(
      html`<span>${say.together({ slide: html`<span class="beam-roomy">${say.slide}</span>` })}</span>`,
      isTogether,
      false,
      (isOn) => {
        ui.panes.isBeamTogether.value = isOn;
      },
      say.togetherIs,
    )}
      ${checkbox(html`<span>${say.clip({ front: html`<span class="beam-roomy">${say.front}</span>` })}</span>`, scene.clip.beam.enabled, isOff, (isOn, event) => patch(clipInFront(scene, beam, isTogether, isOn), event), say.clipIs)}
      ${checkbox(say.showSlice, scene.beam.slice.visible, isOff, (visible, event) => patch({ beam: { slice: visible ? { visible, along_mm: firstAlong(scene.beam, beam) } : { visible } } }, event), say.showSliceIs)}
      <span class="beam-ring-field">${checkbox(say.ring, ring !== null, isOff, (isOn, event) => toggleRing(event.timeStamp), say.ringIs)}${numberField(say.ringMm, ring ?? beam.aperture ?? usualRingMm, 'mm', isOff || ring === null, (mm, event) => setRing(Math.min(Math.max(mm, 0.1), 2000), event.timeStamp))}</span></span></div>`;
}
