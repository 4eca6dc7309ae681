// The words of images in the tree and in panes.
import { sentences } from '../../parts/sentences.js';

export const say = sentences('image', {
  section: 'Images',
  overIt: '{percent} % over it',
  voxels: '{size} voxels',
  show: 'Show {image}',
  showThis: 'Show this image',
  ray: 'ray',
  slices: 'slices',
  mip: 'maximum',
  average: 'average',
  volume: 'Volume',
  volumeOf: '{image} as a volume in 3-D',
  showVolume: 'Show the volume',
  showVolumeIs: 'Show the image as a volume in 3-D',
  colours: 'Colours of images',
});
