// The images in the tree, and the row of the volume.
import { html } from '../../../lib/lit-html.js';
import { isOfOther } from '../../room/identity.js';
import { blendedImage } from '../../room/image_look.js';
import { shownImage } from '../../room/plan.js';
import { number, windowText } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { eye, name, treeRow } from '../../parts/tree_row.js';
import { imageName, showImage } from './image_shown.js';
import { volumeRow } from './volume_row.js';
import { say } from './words.js';

export function imageRows(world) {
  const { room } = world;
  const plan = room.plan.value;
  const scene = room.scene.value;
  const shown = shownImage(plan, scene);
  const blended = blendedImage(plan, scene);
  const rows = plan.images
    .filter((image) => !isOfOther(plan, scene, image))
    .map((image) => {
      const isShown = image === shown;
      const show = (event) => showImage(world, image, event);
      const words = imageName(plan, image);
      const tail =
        isShown && scene
          ? windowText(scene.image.window, '')
          : image === blended
            ? say.overIt({ percent: number(scene.image.blend.opacity * 100) })
            : '';
      return treeRow(
        world,
        {
          kind: 'image',
          id: image.id,
          words: [words, tail],
          title: say.voxels({ size: image.size.join(' × ') }),
          isOn: isShown,
          toggle: show,
          choose: show,
        },
        html`
      ${plan.images.length > 1 ? eye(isShown, say.show({ image: words }), say.showThis, !room.canChange.value, show) : icon('image')}${name(words)}
      <span class="tail">${tail}</span>`,
      );
    });
  return html`${rows}${volumeRow(world)}`;
}
