// Colours of regions in 3-D: their own colour, the image, or the dose. Pure.

/** Representations that are made of triangles; others have their own colour alone. */
const withTriangles = ['surface', 'univels', 'nurbs', 'fan'];

const words = {
  none: ['Own', 'Its own colour'],
  image: ['Image', 'By the image at each point, with its window'],
  dose: ['Dose', 'Its own colour, and over it the wash of the dose at each point'],
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
  if (!withTriangles.includes(representation)) return 'Only surfaces, univels, splines and fans show it: this one has its own colour.';
  const { wash, compare } = scene.dose;
  if (texture === 'dose' && !wash.visible && !['difference', 'gamma'].includes(compare.mode))
    return 'The wash is off: nothing of the dose shows.';
  return '';
}
