// The sections of the tree: a row of the table for each. A section without rows is not shown; to add one, add a row.
import { html } from '../../lib/lit-html.js';
import { blendedImage } from '../room/image_look.js';
import { isOfOther, ownRegions, partsOfOthers } from '../room/identity.js';
import { shownImage } from '../room/plan.js';
import { bookmarkNote, bookmarkRows, hasBookmarks } from '../features/bookmarks/feature.js';
import { hasBeams, ofBeams } from '../features/beams/feature.js';
import { clipNote, clipRows, hasClips } from '../features/clip/clip_rows.js';
import { ofDose } from '../features/dose/feature.js';
import { ofFits } from '../features/fits/feature.js';
import { count, number, windowText } from '../parts/format.js';
import { icon } from '../parts/icons.js';
import { imageName, showImage } from '../features/image/image_shown.js';
import { hasMeasures, measureRows } from '../features/measures/measure_rows.js';
import { obliqueNote, obliqueRows } from '../features/planes/oblique_rows.js';
import { regionRows } from '../features/regions/region_rows.js';
import { ofTracks } from '../features/tracks/feature.js';
import { eye, name, treeRow } from '../parts/tree_row.js';
import { volumeRow } from '../features/image/volume_row.js';

const hierarchyWords = { file: 'hierarchy from file', derived: 'hierarchy derived', none: '' };

/** @type {{id: string, name: string, icon: string, has: (plan, scene) => boolean, note: (world) => string, rows: (world) => unknown}[]} */
const table = [
  { id: 'images', name: 'Images', icon: 'image', has: (plan) => plan.images.length, note: () => '', rows: images },
  { id: 'planes', name: 'Planes', icon: 'plane', has: hasClips, note: obliqueNote, rows: obliqueRows },
  {
    id: 'regions',
    name: 'Regions',
    icon: 'layers',
    has: (plan, scene) => (scene ? ownRegions(plan, scene) : plan.regions).length,
    note: ({ room }) => hierarchyWords[room.plan.value.hierarchy] ?? '',
    rows: regionRows,
  },
  {
    id: 'doses',
    name: 'Doses',
    icon: 'dose',
    has: (plan) => plan.doses.length,
    note: (world) => ofDose(world.room)?.doseNote(world) ?? '',
    rows: (world) => ofDose(world.room)?.doseRows(world),
  },
  {
    id: 'beams',
    name: 'Beams',
    icon: 'target',
    has: hasBeams,
    note: (world) => ofBeams(world.room)?.beamNote(world) ?? '',
    rows: (world) => ofBeams(world.room)?.beamRows(world),
  },
  {
    id: 'tracks',
    name: 'Tracks',
    icon: 'tracks',
    has: (plan) => plan.nTracks,
    note: (world) => ofTracks(world.room)?.trackNote(world) ?? '',
    rows: (world) => ofTracks(world.room)?.trackRows(world),
  },
  { id: 'clip', name: 'Clip', icon: 'clip', has: hasClips, note: clipNote, rows: clipRows },
  { id: 'measures', name: 'Measures', icon: 'measure', has: hasMeasures, note: () => '', rows: measureRows },
  { id: 'saved', name: 'Saved views', icon: 'bookmark', has: hasBookmarks, note: bookmarkNote, rows: bookmarkRows },
  {
    id: 'others',
    name: 'Not this patient',
    icon: 'error',
    has: (plan, scene) => partsOfOthers(plan, scene).length,
    note: ({ room }) => `${count(partsOfOthers(room.plan.value, room.scene.value).length, 'part')}, never drawn`,
    rows: (world) => ofFits(world.room)?.otherPatients(world),
  },
];

/** The sections of this plan, and of what the scene has besides. */
export const sectionsOf = (plan, scene) => (plan ? table.filter((section) => section.has(plan, scene)) : []);

/** The section in which a row for this selection is. */
export const sectionOfKind = {
  image: 'images',
  volume: 'images',
  region: 'regions',
  dose: 'doses',
  quantity: 'doses',
  dosing: 'doses',
  level: 'doses',
  beam: 'beams',
  kept: 'beams',
  preset: 'beams',
  curve: 'beams',
  tracks: 'tracks',
  track: 'tracks',
  clip: 'clip',
  oblique: 'planes',
  measure: 'measures',
  bookmark: 'saved',
};

function images(world) {
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
            ? `${number(scene.image.blend.opacity * 100)} % over it`
            : '';
      return treeRow(
        world,
        {
          kind: 'image',
          id: image.id,
          words: [words, tail],
          title: `${image.size.join(' × ')} voxels`,
          isOn: isShown,
          toggle: show,
          choose: show,
        },
        html`
      ${plan.images.length > 1 ? eye(isShown, `Show ${words}`, 'Show this image', !room.canChange.value, show) : icon('image')}${name(words)}
      <span class="tail">${tail}</span>`,
      );
    });
  return html`${rows}${volumeRow(world)}`;
}
