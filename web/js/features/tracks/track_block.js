// Particle tracks in Selection: counts, how they are drawn, limits, playing, files, lost particles; and the segment that was clicked.
import { html, nothing } from '../../../lib/lit-html.js';
import { live } from '../../../lib/directives/live.js';
import { className } from '../../room/plan.js';
import { trackFacts } from './track_facts.js';
import { durations } from './track_play.js';
import { countPatch, isChosenClass, isShownClass, isWhole, rangeOf } from './tracks.js';
import { waitReason } from '../../room/waits.js';
import { checkbox, numberField, typed } from '../../parts/fields.js';
import { millimetres, number, position, significant } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { say } from './later_words.js';
import { flyButton, lostBlock, placeWords } from './track_lost.js';
import { trackSwatch } from './track_rows.js';

const bounded = (value, low, high) => Math.min(Math.max(value, low), high);
const energyWords = (mev) =>
  mev === null
    ? say.notGiven
    : mev < 1e-3
      ? `${significant(mev * 1e6)} eV`
      : mev < 1
        ? `${significant(mev * 1e3)} keV`
        : `${significant(mev)} MeV`;

/** For the tracks, or one class of them. */
export function trackBlock(world, isDisabled, change) {
  const facts = trackFacts(world);
  const { result, error } = facts.want();
  return html`${counts(world, facts, result, error || waitReason(world.room))}
    ${error ? html`<p class="note why" role="status">${icon('warning', 12)} ${error}</p>` : nothing}
    ${playBlock(world, facts, isDisabled, change)}${lookBlock(world, isDisabled, change)}
    ${result ? html`${energyBlock(world, result, isDisabled, change)}${filesBlock(result)}${lostBlock(world, result)}` : nothing}`;
}

function counts({ room, ui }, facts, result, why) {
  const [plan, scene] = [room.plan.value, room.scene.value];
  const { visible } = scene.tracks;
  const words = !visible
    ? say.hidden
    : isWhole(scene) && plan.trackClasses.every(({ id }) => isChosenClass(scene, id))
      ? say.allShown
      : result && facts.isNew
        ? say.shown({ count: number(result.shown), n: result.shown })
        : why
          ? say.notCounted
          : '…';
  const shown = html`<span id="track-shown">${words}</span>`;
  const line = (one) => {
    const kind = [one.id === ui.selection.value.id ? 'total' : '', isShownClass(scene, one.id) ? '' : 'track-off'].join(' ');
    return html`<tr class=${kind}><th scope="row">${trackSwatch(one)}${className(one.id)}</th><td>${number(one.n)}</td>
        <td>${number((100 * one.n) / plan.nTracks, 1)} %</td></tr>`;
  };
  return html`<section class="block"><h3>${icon('tracks')} ${say.tracks}
    <span class="dim">${say.segmentsShown({ count: number(plan.nTracks), n: plan.nTracks, shown })}</span></h3>
    <table class="track-counts"><thead><tr><th scope="col">${say.class}</th><th scope="col">${say.segments}</th><th scope="col">${say.share}</th></tr></thead>
      <tbody>${plan.trackClasses.map(line)}</tbody></table></section>`;
}

// ---- playing ------------------------------------------------------------------------------------------------------------

function playBlock({ room }, { play }, isDisabled, change) {
  const [plan, scene] = [room.plan.value, room.scene.value];
  const { first, count: shown, most } = rangeOf(plan, scene);
  const isOn = play.isOn.value;
  const set = (n, event) => {
    play.pause();
    change(countPatch(plan, scene, n), event);
  };
  const setFirst = (value, event) => change({ tracks: { first: bounded(Math.round(value), 0, plan.nTracks) } }, event);
  return html`<section class="block"><h3>${say.order}</h3>
    <div class="track-play"><button class="icon-button" aria-label=${isOn ? say.pause : say.play}
        title=${isOn ? say.pause : say.oneAfterOther} ?disabled=${isDisabled} @click=${() => (isOn ? play.pause() : play.start())}>
        <svg viewBox="0 0 16 16" width="16" height="16" aria-hidden="true"><path fill="currentColor" d=${isOn ? 'M4 3h3v10H4zM9 3h3v10H9z' : 'M4.500 2.500v11l9-5.500z'}/></svg></button>
      <input type="range" min="0" max=${most} step="1" .value=${live(String(shown))} aria-label=${say.drawn}
        aria-valuetext=${say.drawnOf({ count: number(shown), all: number(most) })} ?disabled=${isDisabled} @input=${(event) => set(event.target.valueAsNumber, event)}>
      <select aria-label=${say.timeForAll} @change=${(event) => {
        play.seconds.value = Number(event.target.value);
      }}>${durations.map((s) => html`<option value=${s} .selected=${live(s === play.seconds.value)}>${say.inSeconds({ n: s })}</option>`)}</select></div>
    <dl><dt>${say.fromSegment}</dt><dd>${numberField(say.fromSegment, first, '', isDisabled, setFirst)}</dd>
      <dt>${say.drawn}</dt>
      <dd>${numberField(say.numberDrawn, shown, '', isDisabled, set)} <span class="dim">${say.ofAll({ all: number(most) })}</span></dd></dl></section>`;
}

// ---- how they are drawn -----------------------------------------------------------------------------------------------------

function lookBlock({ room }, isDisabled, change) {
  const { width_px: width, depth_cue: cue, clipped } = room.scene.value.tracks;
  const set = (patch, event) => change({ tracks: patch }, event);
  return html`<section class="block"><h3>${say.drawing}</h3>
    <dl><dt>${say.width}</dt><dd class="pair"><input type="range" min="1" max="8" step="0.5" .value=${live(String(width))} aria-label=${say.widthOf}
        ?disabled=${isDisabled} @input=${(event) => set({ width_px: event.target.valueAsNumber }, event)}>
      ${numberField(say.widthPixels, width, 'px', isDisabled, (value, event) => set({ width_px: bounded(value, 1, 8) }, event))}</dd></dl>
    <div class="checks">${checkbox(say.darker, cue, isDisabled, (on, event) => set({ depth_cue: on }, event), say.darkerIs)}
      ${checkbox(say.clipped, clipped, isDisabled, (on, event) => set({ clipped: on }, event))}</div></section>`;
}

// ---- energies and files -----------------------------------------------------------------------------------------------------

/** Only for files that give energies. */
function energyBlock({ room }, { energies, segments }, isDisabled, change) {
  if (!energies.segments) return nothing;
  const { tracks } = room.scene.value;
  const field = (
    key,
    label,
    placeholder,
  ) => html`<span class="field"><input type="number" step="any" min="0" max="1e6" .value=${typed(String(tracks[key] ?? ''))}
    placeholder=${Number(placeholder.toPrecision(3))} aria-label=${label} ?disabled=${isDisabled}
    @change=${({ target, timeStamp }) => !target.validity.badInput && change({ tracks: { [key]: target.value === '' ? null : bounded(target.valueAsNumber, 0, 1e6) } }, { timeStamp })}><span>MeV</span></span>`;
  const others = segments - energies.segments;
  const range = say.energies({ low: energyWords(energies.low_mev), high: energyWords(energies.high_mev) });
  return html`<section class="block"><h3>${say.energy} <span class="dim">${range}</span></h3>
    <dl><dt>${say.from}</dt><dd>${field('energy_low_mev', say.lowest, energies.low_mev)}</dd>
      <dt>${say.to}</dt><dd>${field('energy_high_mev', say.highest, energies.high_mev)}</dd></dl>
    ${others ? html`<p class="note">${say.notLimited({ count: number(others), n: others })}</p>` : nothing}</section>`;
}

function filesBlock({ files }) {
  const entry = ({ path, segments, unit }) =>
    html`<dt title=${path}>${path}</dt><dd>${say.segmentsIn({ count: number(segments), n: segments, unit })}</dd>`;
  return html`<section class="block"><h3>${say.fileOrFiles({ n: files.length })}</h3>
    <dl class="track-files">${files.map(entry)}</dl></section>`;
}

// ---- the segment that was clicked --------------------------------------------------------------------------------------------

export function segmentBlock(world) {
  const { room, ui } = world;
  const track = ui.track.value;
  const one = room.plan.value.trackClasses.find(({ id }) => id === track?.class);
  if (!one) return nothing;
  const place = (mm, region) =>
    html`<dd><span>${position(mm)}</span><br><span class="dim">${placeWords(room.plan.value, region)}</span></dd>`;
  const fileSegment = say.fileSegment({ file: track.file, number: number(track.file_segment) });
  return html`<section class="block"><h3>${icon('tracks')} ${say.track({ number: number(track.segment) })} <span class="dim">${className(track.class)}</span></h3>
    <dl class="track-one"><dt>${say.class}</dt><dd>${trackSwatch(one)} ${className(track.class)}</dd>
      <dt>${say.energy}</dt><dd>${energyWords(track.energy_mev)}</dd><dt>${say.length}</dt><dd>${millimetres(track.length_mm)}</dd>
      <dt>${say.from}</dt>${place(track.from_lps_mm, track.from_region)}<dt>${say.to}</dt>${place(track.to_lps_mm, track.to_region)}
      ${track.file === null ? nothing : html`<dt>${say.file}</dt><dd>${fileSegment}</dd>`}</dl>
    <div class="buttons">${flyButton(world, track.from_lps_mm, say.toStart)}${flyButton(world, track.to_lps_mm, say.toEnd)}
      <button @click=${() => ui.choose('tracks', '')}>${say.all}</button></div></section>`;
}

export const blocks = { tracks: trackBlock, track: segmentBlock };
