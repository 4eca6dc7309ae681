// Particle tracks in Selection: counts, how they are drawn, limits, playing, files, lost particles; and the segment that was clicked.
import { html, nothing } from '../../../lib/lit-html.js';
import { live } from '../../../lib/directives/live.js';
import { className } from '../../room/plan.js';
import { trackFacts } from './track_facts.js';
import { durations } from './track_play.js';
import { countPatch, isChosenClass, isShownClass, isWhole, rangeOf } from './tracks.js';
import { waitReason } from '../../room/waits.js';
import { checkbox, numberField, typed } from '../../parts/fields.js';
import { count, millimetres, number, position, significant } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { flyButton, lostBlock, placeWords } from './track_lost.js';
import { trackSwatch } from './track_rows.js';

const bounded = (value, low, high) => Math.min(Math.max(value, low), high);
const energyWords = (mev) =>
  mev === null
    ? 'not given'
    : mev < 1e-3
      ? `${significant(mev * 1e6)} eV`
      : mev < 1
        ? `${significant(mev * 1e3)} keV`
        : `${significant(mev)} MeV`;

/** For the tracks, or one class of them. */
export function trackBlock(world, isDisabled, change) {
  const facts = trackFacts(world);
  const { result, error } = facts.want();
  return html`${counts(world, facts, result, error || waitReason(world.room))}${error ? html`<p class="note why" role="status">${icon('warning', 12)} ${error}</p>` : nothing}
    ${playBlock(world, facts, isDisabled, change)}${lookBlock(world, isDisabled, change)}${result ? html`${energyBlock(world, result, isDisabled, change)}${filesBlock(result)}${lostBlock(world, result)}` : nothing}`;
}

function counts({ room, ui }, facts, result, why) {
  const [plan, scene] = [room.plan.value, room.scene.value];
  const { visible } = scene.tracks;
  const words = !visible
    ? 'hidden'
    : isWhole(scene) && plan.trackClasses.every(({ id }) => isChosenClass(scene, id))
      ? 'all shown'
      : result && facts.isNew
        ? `${number(result.shown)} shown`
        : why
          ? 'not counted'
          : '…';
  return html`<section class="block"><h3>${icon('tracks')} Particle tracks <span class="dim">${count(plan.nTracks, 'segment')}, <span id="track-shown">${words}</span></span></h3>
    <table class="track-counts"><thead><tr><th scope="col">Class</th><th scope="col">Segments</th><th scope="col">Share</th></tr></thead>
      <tbody>${plan.trackClasses.map((one) => html`<tr class=${[one.id === ui.selection.value.id ? 'total' : '', isShownClass(scene, one.id) ? '' : 'track-off'].join(' ')}><th scope="row">${trackSwatch(one)}${className(one.id)}</th><td>${number(one.n)}</td><td>${number((100 * one.n) / plan.nTracks, 1)} %</td></tr>`)}</tbody></table></section>`;
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
  return html`<section class="block"><h3>Order of the files</h3>
    <div class="track-play"><button class="icon-button" aria-label=${isOn ? 'Pause' : 'Play'} title=${isOn ? 'Pause' : 'Draw the segments one after the other'} ?disabled=${isDisabled} @click=${() => (isOn ? play.pause() : play.start())}>
        <svg viewBox="0 0 16 16" width="16" height="16" aria-hidden="true"><path fill="currentColor" d=${isOn ? 'M4 3h3v10H4zM9 3h3v10H9z' : 'M4.500 2.500v11l9-5.500z'}/></svg></button>
      <input type="range" min="0" max=${most} step="1" .value=${live(String(shown))} aria-label="Segments drawn" aria-valuetext=${`${number(shown)} of ${number(most)}`} ?disabled=${isDisabled} @input=${(event) => set(event.target.valueAsNumber, event)}>
      <select aria-label="Time for all segments" @change=${(event) => {
        play.seconds.value = Number(event.target.value);
      }}>${durations.map((s) => html`<option value=${s} .selected=${live(s === play.seconds.value)}>in ${s} s</option>`)}</select></div>
    <dl><dt>From segment</dt><dd>${numberField('From segment', first, '', isDisabled, (value, event) => change({ tracks: { first: bounded(Math.round(value), 0, plan.nTracks) } }, event))}</dd>
      <dt>Segments drawn</dt><dd>${numberField('Number of segments drawn', shown, '', isDisabled, set)} <span class="dim">of ${number(most)}</span></dd></dl></section>`;
}

// ---- how they are drawn -----------------------------------------------------------------------------------------------------

function lookBlock({ room }, isDisabled, change) {
  const { width_px: width, depth_cue: cue, clipped } = room.scene.value.tracks;
  const set = (patch, event) => change({ tracks: patch }, event);
  return html`<section class="block"><h3>Drawing</h3>
    <dl><dt>Width</dt><dd class="pair"><input type="range" min="1" max="8" step="0.5" .value=${live(String(width))} aria-label="Width of the lines" ?disabled=${isDisabled} @input=${(event) => set({ width_px: event.target.valueAsNumber }, event)}>
      ${numberField('Width of the lines in pixels', width, 'px', isDisabled, (value, event) => set({ width_px: bounded(value, 1, 8) }, event))}</dd></dl>
    <div class="checks">${checkbox('Darker far away', cue, isDisabled, (on, event) => set({ depth_cue: on }, event), 'Lines that are farther away are darker')}
      ${checkbox('Cut by clip planes', clipped, isDisabled, (on, event) => set({ clipped: on }, event))}</div></section>`;
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
  ) => html`<span class="field"><input type="number" step="any" min="0" max="1e6" .value=${typed(String(tracks[key] ?? ''))} placeholder=${Number(placeholder.toPrecision(3))} aria-label=${label} ?disabled=${isDisabled}
    @change=${({ target, timeStamp }) => !target.validity.badInput && change({ tracks: { [key]: target.value === '' ? null : bounded(target.valueAsNumber, 0, 1e6) } }, { timeStamp })}><span>MeV</span></span>`;
  const others = segments - energies.segments;
  return html`<section class="block"><h3>Energy <span class="dim">${energyWords(energies.low_mev)} to ${energyWords(energies.high_mev)}</span></h3>
    <dl><dt>From</dt><dd>${field('energy_low_mev', 'Lowest energy in MeV', energies.low_mev)}</dd><dt>To</dt><dd>${field('energy_high_mev', 'Highest energy in MeV', energies.high_mev)}</dd></dl>
    ${others ? html`<p class="note">${count(others, 'segment')} without an energy ${others === 1 ? 'is' : 'are'} not limited.</p>` : nothing}</section>`;
}

function filesBlock({ files }) {
  return html`<section class="block"><h3>${files.length > 1 ? 'Files' : 'File'}</h3>
    <dl class="track-files">${files.map(({ path, segments, unit }) => html`<dt title=${path}>${path}</dt><dd>${count(segments, 'segment')}, in ${unit}</dd>`)}</dl></section>`;
}

// ---- the segment that was clicked --------------------------------------------------------------------------------------------

export function segmentBlock(world) {
  const { room, ui } = world;
  const track = ui.track.value;
  const one = room.plan.value.trackClasses.find(({ id }) => id === track?.class);
  if (!one) return nothing;
  const place = (mm, region) =>
    html`<dd><span>${position(mm)}</span><br><span class="dim">${placeWords(room.plan.value, region)}</span></dd>`;
  return html`<section class="block"><h3>${icon('tracks')} Track ${number(track.segment)} <span class="dim">${className(track.class)}</span></h3>
    <dl class="track-one"><dt>Class</dt><dd>${trackSwatch(one)} ${className(track.class)}</dd><dt>Energy</dt><dd>${energyWords(track.energy_mev)}</dd><dt>Length</dt><dd>${millimetres(track.length_mm)}</dd>
      <dt>From</dt>${place(track.from_lps_mm, track.from_region)}<dt>To</dt>${place(track.to_lps_mm, track.to_region)}
      ${track.file === null ? nothing : html`<dt>File</dt><dd>${track.file}, segment ${number(track.file_segment)}</dd>`}</dl>
    <div class="buttons">${flyButton(world, track.from_lps_mm, 'Fly to its start')}${flyButton(world, track.to_lps_mm, 'Fly to its end')}<button @click=${() => ui.choose('tracks', '')}>All tracks</button></div></section>`;
}

export const blocks = { tracks: trackBlock, track: segmentBlock };
