// The row of the tree for the image as a volume in the 3-D picture.
import { html, nothing } from '../../../lib/lit-html.js';
import { shownImage } from '../../room/plan.js';
import { visiblePatch } from './transfer.js';
import { eye, name, treeRow } from '../../parts/tree_row.js';

export const methods = [
  ['ray', 'Ray', 'Light is absorbed along each line of sight, by the transfer function'],
  ['slices', 'Slices', 'Parallel slices, blended from back to front'],
  ['mip', 'Maximum', 'The largest value on each line of sight'],
  ['average', 'Average', 'The mean value on each line of sight'],
];

export function volumeRow(world) {
  const { room, ui } = world;
  const [plan, scene] = [room.plan.value, room.scene.value];
  const image = shownImage(plan, scene);
  const volume = scene?.image.volume;
  if (!image || !volume) return nothing;
  const toggle = (event) =>
    room.patchScene(visiblePatch(plan, room.scene.value, !volume.visible), { view: ui.active.value, at: event.timeStamp });
  const tail = methods.find(([id]) => id === volume.method)[1].toLowerCase();
  return treeRow(
    world,
    { kind: 'volume', id: '', words: ['Volume', tail], title: `${image.modality} as a volume in 3-D`, isOn: volume.visible, toggle },
    html`
    ${eye(volume.visible, 'Show the volume', 'Show the image as a volume in 3-D', !room.canChange.value, toggle)}${name('Volume')} <span class="tail">${tail}</span>`,
  );
}
