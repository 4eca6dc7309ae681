// Presets of beam, dose and volume as a menu and as rows of the tree: each one click, one step of undo, and words that say what it has changed.
import { html } from '../../../lib/lit-html.js';
import { applyPreset, presetsOf } from './beam_combinations.js';
import { presetItem } from './preset_menu.js';
import { icon } from '../../parts/icons.js';
import { name as nameOf } from '../../parts/tree_row.js';
import { say } from './preset_words.js';

/** A button for each preset; of one that the plan cannot have the reason is beside its name. @param {(run: () => void) => (event: Event) => void} act what a click does */
export function presetItems(world, act = (run) => run) {
  const { room } = world;
  const [plan, scene] = [room.plan.value, room.scene.value];
  if (!plan || !scene) return '';
  const isOff = !room.canChange.value;
  return html`<div class="menu beam-presets" role="group" aria-label=${say.together}>${presetsOf(plan, scene).map(
    ({
      id,
      name,
      icon: picture,
      about,
      why,
    }) => html`<button ?disabled=${isOff || Boolean(why)} title=${why ? say.aboutHere({ about, why }) : about}
    @click=${(event) => act(() => applyPreset(world, id, event.timeStamp))(event)}>${icon(picture)}<span>${name}</span>${why ? html`<span class="tail">${why}</span>` : ''}</button>`,
  )}</div>`;
}

/** The presets in the tree. */
export function presetRows(world) {
  const { room } = world;
  return presetsOf(room.plan.value, room.scene.value).map(({ id, name, icon: picture, about, why }) =>
    presetItem(
      world,
      {
        id,
        words: [name, why].filter(Boolean).join(', '),
        title: why ? say.aboutHere({ about, why }) : about,
        indent: 1,
        isOff: !room.canChange.value || Boolean(why),
        act: (event) => applyPreset(world, id, event.timeStamp),
      },
      html`${icon(picture)}${nameOf(name)} <span class="tail">${why}</span>`,
    ),
  );
}
