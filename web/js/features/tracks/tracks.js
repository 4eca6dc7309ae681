// Particle tracks of the scene: which classes and segments are shown, and the patches that change it.

/** The field of the scene for a class of the file, "neutron_high" for "neutron-high". */
const fieldOf = (id) => id.replace('-', '_');

/** True if the class is among those that are drawn, tracks being visible or not. */
export const isChosenClass = (scene, id) => scene.tracks.classes[fieldOf(id)];
/** True if it is drawn. */
export const isShownClass = (scene, id) => scene.tracks.visible && isChosenClass(scene, id);

/** The patch that draws a class, and tracks with it, or hides it. */
export const classPatch = (id, isShown) => ({ tracks: { classes: { [fieldOf(id)]: isShown }, ...(isShown && { visible: true }) } });

/** The segments of the files that the scene's range takes: {first, count, most: of segments from the first on}. */
export function rangeOf(plan, { tracks }) {
  const first = Math.min(tracks.first, plan.nTracks);
  const most = plan.nTracks - first;
  return { first, most, count: Math.min(tracks.count ?? most, most) };
}

/** The patch for so many segments from the first on; all of them are no limit. */
export const countPatch = (plan, scene, count) => {
  const { most } = rangeOf(plan, scene);
  const whole = Math.min(Math.max(Math.round(count), 0), most);
  return { tracks: { count: whole === most ? null : whole } };
};

/** True if range and energies leave nothing out. A limit that is none is null, or missing until the server has told. */
export const isWhole = ({ tracks }) =>
  tracks.first === 0 && ['count', 'energy_low_mev', 'energy_high_mev'].every((limit) => (tracks[limit] ?? null) === null);
