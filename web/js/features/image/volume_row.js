// The row of the tree for the image as a volume in the 3-D picture.
import { html, nothing } from '../../../lib/lit-html.js';
import { shownImage } from '../../room/plan.js';
import { visiblePatch } from './volume_patches.js';
import { eye, name, treeRow } from '../../parts/tree_row.js';
import { say } from './words.js';

export function volumeRow(world) {
  const { room, ui } = world;
  const [plan, scene] = [room.plan.value, room.scene.value];
  const image = shownImage(plan, scene);
  const volume = scene?.image.volume;
  if (!image || !volume) return nothing;
  const toggle = (event) =>
    room.patchScene(visiblePatch(plan, room.scene.value, !volume.visible), { view: ui.active.value, at: event.timeStamp });
  const tail = say[volume.method];
  return treeRow(
    world,
    { kind: 'volume', id: '', words: [say.volume, tail], title: say.volumeOf({ image: image.modality }), isOn: volume.visible, toggle },
    html`
    ${eye(volume.visible, say.showVolume, say.showVolumeIs, !room.canChange.value, toggle)}${name(say.volume)} <span class="tail">${tail}</span>`,
  );
}
