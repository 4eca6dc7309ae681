// Properties of the kinds of views (scene.json).

/** A picture of the scene in space; else a slice pane, which has a plane and a scale. */
export const isInSpace = (kind) => kind === '3d' || kind === 'beam';
/** A 3-D picture whose camera is turned by hand. */
export const isTurnable = (kind) => kind === '3d';
/** A slice pane whose plane may lie beside the crosshair. */
export const isTilted = (kind) => kind === 'oblique' || kind === 'beam-slice';
/** Along or across the beam that the scene chooses. */
export const isOfBeam = (kind) => kind === 'beam' || kind === 'beam-slice';
