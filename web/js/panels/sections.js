// The sections of the tree: a row of the table for each. A section without rows is not shown; to add one, add a row.
import { html, nothing } from '../../lib/lit-html.js';
import { blendedImage } from '../state/image_look.js';
import { beamWords, className, doseWords, frameWords, shownImage } from '../state/plan.js';
import { clipNote, clipRows, hasClips } from './clip_rows.js';
import { count, number, windowText } from './format.js';
import { icon } from './icons.js';
import { imageName, showImage } from './image.js';
import { hasMeasures, measureRows } from './measure.js';
import { obliqueNote, obliqueRows } from './oblique_rows.js';
import { regionRows } from './region_rows.js';
import { eye, name, treeRow } from './tree_row.js';
import { volumeRow } from './volume.js';

const hierarchyWords = { file: 'hierarchy from file', derived: 'hierarchy derived', none: '' };

/** @type {{id: string, name: string, icon: string, has: (plan, scene) => boolean, note: (world) => string, rows: (world) => unknown}[]} */
const table = [
  { id: 'images', name: 'Images', icon: 'image', has: (plan) => plan.images.length, note: () => '', rows: images },
  { id: 'planes', name: 'Planes', icon: 'plane', has: hasClips, note: obliqueNote, rows: obliqueRows },
  { id: 'regions', name: 'Regions', icon: 'layers', has: (plan) => plan.regions.length, note: ({ room }) => hierarchyWords[room.plan.value.hierarchy] ?? '', rows: regionRows },
  { id: 'doses', name: 'Doses', icon: 'dose', has: (plan) => plan.doses.length, note: (world) => (shownGrid(world) ? 'grid shown' : ''), rows: doses },
  { id: 'beams', name: 'Beams', icon: 'target', has: (plan) => plan.beams.length + plan.curves.length, note: () => '', rows: beams },
  { id: 'tracks', name: 'Tracks', icon: 'tracks', has: (plan) => plan.nTracks, note: ({ room }) => count(room.plan.value.nTracks, 'segment'), rows: tracks },
  { id: 'clip', name: 'Clip', icon: 'clip', has: hasClips, note: clipNote, rows: clipRows },
  { id: 'measures', name: 'Measures', icon: 'measure', has: hasMeasures, note: () => '', rows: measureRows },
];

/** The sections of this plan, and of what the scene has besides. */
export const sectionsOf = (plan, scene) => (plan ? table.filter((section) => section.has(plan, scene)) : []);

/** The section in which a row for this selection is. */
export const sectionOfKind = { image: 'images', volume: 'images', region: 'regions', dose: 'doses', beam: 'beams', curve: 'beams', tracks: 'tracks', clip: 'clip', oblique: 'planes', measure: 'measures' };

function images(world) {
  const { room } = world;
  const plan = room.plan.value;
  const scene = room.scene.value;
  const shown = shownImage(plan, scene);
  const blended = blendedImage(plan, scene);
  const rows = plan.images.map((image) => {
    const isShown = image === shown;
    const show = (event) => showImage(world, image, event);
    const words = imageName(plan, image);
    const tail = isShown && scene ? windowText(scene.image.window, '') : image === blended ? `${number(scene.image.blend.opacity * 100)} % over it` : '';
    return treeRow(world, { kind: 'image', id: image.id, words: [words, tail], title: `${image.size.join(' × ')} voxels`, isOn: isShown, toggle: show, choose: show }, html`
      ${plan.images.length > 1 ? eye(isShown, `Show ${words}`, 'Show this image', !room.canChange.value, show) : icon('image')}${name(words)}
      <span class="tail">${tail}</span>`);
  });
  return html`${rows}${volumeRow(world)}`;
}

const shownGrid = ({ room }) => {
  const { dose } = room.scene.value ?? { dose: {} };
  const { doses: all } = room.plan.value;
  return dose.grid ? all.find(({ id }) => id === dose.id) ?? all[0] : null;
};

/** The doses, each with a button that shows its grid over the picture. */
function doses(world) {
  const { room, ui } = world;
  const shown = shownGrid(world);
  const mark = (dose) => (dose.frame_of_reference === 'differs' ? html`<span class="refused warn" role="img" aria-label=${frameWords(dose)} title=${frameWords(dose)}>${icon('warning')}</span>` : nothing);
  return room.plan.value.doses.map((dose) => {
    const isOn = dose === shown;
    const words = dose.name || dose.id;
    const toggle = (event) => room.patchScene({ dose: { id: dose.id, grid: !isOn } }, { view: ui.active.value, at: event.timeStamp });
    return treeRow(world, { kind: 'dose', id: dose.id, words: [words, dose.unit], more: [doseWords(dose)], title: doseWords(dose), isOn, toggle }, html`
      ${eye(isOn, `Show the grid of ${words}`, 'Show or hide the box of its grid', !room.canChange.value, toggle)}${name(words)} ${mark(dose)} <span class="tail">${dose.unit}</span>`);
  });
}

function beams(world) {
  const { beams: all, curves } = world.room.plan.value;
  const row = (kind, picture) => (part) => {
    const words = part.name || part.id;
    const about = kind === 'beam' ? beamWords(part) : 'reference curve';
    return treeRow(world, { kind, id: part.id, words: [words, about], title: about }, html`${icon(picture)}${name(words)} <span class="tail clipped">${about}</span>`);
  };
  return html`${all.map(row('beam', 'target'))}${curves.map(row('curve', 'curve'))}`;
}

function tracks(world) {
  const { trackClasses } = world.room.plan.value;
  const classes = trackClasses.length ? trackClasses : [{ id: 'tracks', n: world.room.plan.value.nTracks }];
  return classes.map(({ id, n }) => treeRow(world, { kind: 'tracks', id, words: [className(id), number(n)], more: ['segments'], title: count(n, 'segment') }, html`
    ${icon('tracks')}${name(className(id))} <span class="tail">${number(n)}</span>`));
}
