// An isodose level in Selection, and the tables of levels to begin with.
import { html, nothing } from '../../../lib/lit-html.js';
import { live } from '../../../lib/directives/live.js';
import { convertedLevel, levelPatch, maxLevels } from './level_list.js';
import { coloursNow, coloursPatch, levelColours } from './level_colors.js';
import { levelTables, tableOf, tablePatch } from './dose_tables.js';
import { addLevel, levelContext, levelParts, levelWords, otherText } from './dose_levels.js';
import { checkbox, numberField, segment } from '../../parts/fields.js';
import { icon } from '../../parts/icons.js';
import { say } from './later_words.js';

const how = (ui, event) => ({ view: ui.active.value, at: event.timeStamp });

export function tableSelect({ room, ui }, { tabindex }) {
  const scene = room.scene.value;
  const now = tableOf(scene);
  const change = (event) => {
    const table = levelTables.find(({ name }) => name === event.target.value);
    if (table) room.patchScene(tablePatch(scene, table), how(ui, event));
  };
  return html`<select class="dose-select" aria-label=${say.table} title=${now ? say.levelsAre({ table: now.name, source: now.source }) : say.tables} tabindex=${tabindex} ?disabled=${!room.canChange.value} @change=${change}>
    <option value="" ?selected=${!now} .selected=${live(!now)} disabled>${say.presets}</option>
    ${levelTables.map(({ name, source }) => html`<option value=${name} title=${source} ?selected=${now?.name === name} .selected=${live(now?.name === name)}>${name}</option>`)}</select>`;
}

/** Colours of all levels. */
export function coloursSelect({ room, ui, doses }, { tabindex }) {
  const scene = room.scene.value;
  const reference = doses.reference.value;
  const now = coloursNow(scene, reference);
  const n = Object.keys(scene.dose.levels).length;
  const change = (event) => {
    const patch = coloursPatch(scene, reference, event.target.value);
    if (patch) room.patchScene(patch, how(ui, event));
  };
  return html`<select class="dose-select" aria-label=${say.levelColoursOf} title=${levelColours.find(([id]) => id === now)?.[2] ?? say.coloursAre} tabindex=${tabindex} ?disabled=${!room.canChange.value || !n} @change=${change}>
    <option value="" .selected=${live(!now)} disabled>${say.coloursOwn}</option>
    ${levelColours.map(([id, name, about, most]) => html`<option value=${id} title=${about} ?disabled=${n > most} .selected=${live(now === id)}>${n > most ? say.coloursTooMany({ name, n: most }) : name}</option>`)}</select>`;
}

/** A level in Selection: everything about it. */
export function levelBlock(world, isDisabled, changeScene) {
  const { scene, reference, unit } = levelContext(world);
  const { ui } = world;
  const { id } = ui.selection.value;
  const level = scene.dose.levels[id];
  if (!level) return html`<p class="empty">${say.gone}</p>`;
  const change = (patch, event) => changeScene(levelPatch(id, patch), event);
  const turn = (to, event) => {
    const converted = convertedLevel(level, to, reference);
    change(converted ?? { unit: to }, event);
  };
  const remove = (event) => {
    changeScene(levelPatch(id, null), event);
    ui.choose('dosing', 'levels');
  };
  const other =
    level.unit === 'percent' ? `${otherText(level, reference)} ${unit}` : say.percentOf({ percent: otherText(level, reference) });
  return html`<section class="block"><h3>${icon('dose')} ${say.level({ level: levelWords(level, unit) })} <span class="dim">${other}</span></h3>
    <dl><dt>${say.value}</dt><dd class="dose-pair">${numberField(say.levelValue, Number(level.value.toPrecision(6)), '', isDisabled, (value, event) => value >= 0 && change({ value }, event))}
        ${segment(
          say.levelUnit,
          [
            ['percent', '%'],
            ['dose', unit],
          ],
          level.unit,
          isDisabled,
          turn,
        )}</dd>
      <dt>${say.colour}</dt><dd><input type="color" class="dose-swatch" .value=${live(level.color)} aria-label=${say.colour} ?disabled=${isDisabled} @input=${(event) => change({ color: event.target.value }, event)}></dd>
      <dt>${say.surfaceOpacity}</dt><dd class="pair"><input type="range" min="0" max="100" step="1" .value=${live(String(Math.round(level.opacity * 100)))} aria-label=${say.surfaceOpacityIs} ?disabled=${isDisabled}
        @input=${(event) => change({ opacity: event.target.valueAsNumber / 100 }, event)}>${numberField(say.opacityPercent, Math.round(level.opacity * 100), '%', isDisabled, (value, event) => change({ opacity: Math.min(Math.max(value, 0), 100) / 100 }, event))}</dd></dl>
    <div class="checks">${checkbox(say.shown, level.visible, isDisabled, (visible, event) => change({ visible }, event))}
      ${levelParts.map(([part, , about]) => checkbox(about, level[part], isDisabled, (on, event) => change({ [part]: on }, event)))}</div>
    <div class="buttons"><button ?disabled=${isDisabled || Object.keys(scene.dose.levels).length >= maxLevels} @click=${(event) => addLevel(world, event)}>${icon('plus')}${say.addLevel}</button>
      <button ?disabled=${isDisabled} @click=${remove}>${icon('trash')}${say.remove}</button></div></section>
    ${hint(scene, level)}`;
}

/** Why the level may be on and yet not be seen. */
function hint(scene, level) {
  const { lines, wash, surfaces } = scene.dose;
  const off = [
    [level.line, lines, say.offLines],
    [level.wash, wash, say.offWash],
    [level.surface, surfaces, say.offSurfaces],
  ]
    .filter(([on, part]) => on && !part.visible)
    .map(([, , words]) => words);
  return level.visible && off.length ? html`<p class="note dose-hint">${say.off({ parts: off.join(', ') })}</p>` : nothing;
}
