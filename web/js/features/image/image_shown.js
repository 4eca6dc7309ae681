// The name of an image, and showing it: for its row in the tree and for Selection.
import { imageName, shownImage } from '../../room/plan.js';
import { showPatchWithVolume } from './volume_patches.js';

export { imageName };

/** Shows an image as it was shown last. */
export function showImage({ room, ui }, image, event) {
  const [plan, scene] = [room.plan.value, room.scene.value];
  if (!room.canChange.value || !scene || image === shownImage(plan, scene)) return;
  room.patchScene(showPatchWithVolume(plan, scene, image), { view: ui.active.value, at: event?.timeStamp });
}
