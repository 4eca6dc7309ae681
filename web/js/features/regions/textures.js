// Colours of regions in 3-D: their own colour, the image, or the dose. Pure.
import { say } from './later_words.js';

/** Representations that are made of triangles; others have their own colour alone. */
const withTriangles = ['surface', 'univels', 'nurbs', 'fan'];

const words = {
  none: [say.own, say.ownIs],
  image: [say.image, say.imageIs],
  dose: [say.dose, say.doseIs],
};

/** The choices that the plan has, for a segment. @param {string} now is among them in any case */
export function textures(plan, now) {
  const has = { none: true, image: plan.images.length > 0, dose: plan.doses.length > 0 };
  return Object.keys(words)
    .filter((texture) => has[texture] || texture === now)
    .map((texture) => [texture, ...words[texture]]);
}

/** The texture of all these regions; '' where they differ. */
export function textureOf(scene, regions) {
  const found = new Set(regions.map(({ id }) => scene.regions[id]?.texture ?? 'none'));
  return found.size === 1 ? [...found][0] : '';
}

export const texturePatch = (regions, texture) => ({ regions: Object.fromEntries(regions.map(({ id }) => [id, { texture }])) });

/** A region and all inside it, at any depth. */
export function withInner(plan, region) {
  const found = [region];
  for (const one of found)
    found.push(...plan.regions.filter(({ id, parent }) => parent === one.id && !found.some((other) => other.id === id)));
  return found;
}

/** Why a region that is coloured so does not look it; '' where it does, or is not drawn. */
export function textureNote(scene, region) {
  const { texture = 'none', representation, visible } = scene.regions[region.id] ?? {};
  if (texture === 'none' || !visible) return '';
  if (!withTriangles.includes(representation)) return say.withoutTriangles;
  return isWashOff(scene, region) ? say.washIsOff : '';
}

/** True for a region that the dose would colour, if its wash were shown. */
export function isWashOff(scene, { id }) {
  const { texture, representation, visible } = scene.regions[id] ?? {};
  const { wash, compare } = scene.dose;
  return (
    texture === 'dose' &&
    visible &&
    withTriangles.includes(representation) &&
    !wash.visible &&
    !['difference', 'gamma'].includes(compare.mode)
  );
}
