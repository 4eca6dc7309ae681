// The blocks of Selection for an image, the image as a volume, and the 3-D picture.
import { imageBlock } from './image.js';
import { pictureBlock } from './picture.js';
import { volumeBlock } from './volume.js';

export const blocks = { view: pictureBlock, image: imageBlock, volume: volumeBlock };
