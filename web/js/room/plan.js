// The plan as the panels need it, made from the server's description. Never changed afterwards.

import { say } from './words.js';
const axisNames = ['L', 'P', 'S'];

/** Voxel spacing in mm along each patient axis, taken from the grid axis closest to it. */
function spacingAlong(rows) {
  return axisNames.map((_, axis) => Math.max(...rows[axis].slice(0, 3).map(Math.abs)) || 1);
}

/** The inverse of three rows of 3 x 4: voxel indices from patient mm, as rows of the same form. Null if there is none. */
function invert(rows) {
  const [a, b, c] = [0, 1, 2].map((column) => rows.map((row) => row[column]));
  const cross = ([x, y, z], [u, v, w]) => [y * w - z * v, z * u - x * w, x * v - y * u];
  const dot = (p, q) => p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
  const determinant = dot(a, cross(b, c));
  const origin = rows.map((row) => row[3]);
  if (!(Math.abs(determinant) > 0)) return null;
  return [cross(b, c), cross(c, a), cross(a, b)].map((normal) => {
    const row = normal.map((value) => value / determinant);
    return [...row, -dot(row, origin)];
  });
}

const applied = (rows, [x, y, z]) => rows.map((row) => row[0] * x + row[1] * y + row[2] * z + row[3]);

function readImage(image) {
  const { grid } = image;
  return {
    id: image.id,
    name: image.name ?? '',
    modality: image.modality || say.image,
    unit: image.unit ?? '',
    patient: image.patient ?? null,
    frame: image.frame ?? null,
    plan: image.plan ?? null,
    low: image.low ?? 0,
    high: image.high ?? 1,
    window: image.window,
    isInverted: image.is_inverted ?? false,
    size: grid.size,
    bounds: grid.bounds_mm,
    stepMm: spacingAlong(grid.lps_mm_from_ijk),
    lpsFromIjk: grid.lps_mm_from_ijk,
    ijkFromLps: invert(grid.lps_mm_from_ijk),
  };
}

/** Regions of one name and several structure sets have the set's behind it everywhere; fileName: as in the file. */
const toldApart = (region) => ({ ...region, fileName: region.name, name: region.set ? `${region.name}, ${region.set}` : region.name });

/** Regions in file order, but every region after the one that contains it. */
function inOrder(regions) {
  const known = new Set(regions.map((region) => region.id));
  const rows = [];
  const seen = new Set();
  const visit = (region, depth) => {
    if (seen.has(region.id)) return;
    seen.add(region.id);
    rows.push({ ...region, depth });
    for (const child of regions) if (child.parent === region.id) visit(child, depth + 1);
  };
  for (const region of regions) if (!region.parent || !known.has(region.parent)) visit(region, 0);
  for (const region of regions) visit(region, 0);
  return rows;
}

/** The classes that have segments, and how their lines are drawn. @returns {{id: string, n: number, color?: string, dash?: number[]|null, hasCross?: boolean}[]} */
function readTracks({ classes = {}, looks = [] } = {}) {
  return Object.entries(classes)
    .filter(([, n]) => n > 0)
    .map(([id, n]) => {
      const { color, dash_px: dash, has_cross: hasCross } = looks.find((look) => look.class === id) ?? {};
      return { id, n, color, dash, hasCross };
    });
}

/** @param {object} document GET /api/v1/plans/{id} of a loaded plan */
export function readPlan(document) {
  const images = (document.images ?? []).map(readImage);
  return {
    id: document.id,
    name: document.name || document.id,
    note: document.note ?? '',
    isPhantom: Boolean(document.is_phantom),
    images,
    regions: inOrder((document.regions ?? []).map(toldApart)),
    hierarchy: document.hierarchy ?? 'none',
    doses: document.doses ?? [],
    beams: document.beams ?? [],
    curves: document.curves ?? [],
    nTracks: document.tracks?.segments ?? 0,
    trackClasses: readTracks(document.tracks),
    fits: document.fits ?? [],
    patients: document.patients ?? [],
    statement: document.statement ?? null,
    shownPatient: document.shown_patient ?? null,
    shownPlan: document.shown_plan ?? null,
    treatmentPlans: document.treatment_plans ?? [],
    report: readReport(document.report),
    loadMs: document.load_ms ?? null,
    bounds: document.bounds_mm ?? { low: [-100, -100, -100], high: [100, 100, 100] },
    home: document.home ?? {},
  };
}

/** @returns {{lines: {severity: string, code: string, where: string, sentence: string}[], dropped: number}} */
export function readReport(report) {
  const order = ['error', 'warning', 'note'];
  const lines = [...(report?.lines ?? [])].sort((a, b) => order.indexOf(a.severity) - order.indexOf(b.severity));
  return { lines, dropped: report?.dropped ?? 0 };
}

const severities = { error: say.errors, warning: say.warnings, note: say.notes };

function counted(lines, wanted) {
  const numbers = wanted.map((severity) => [severity, lines.filter((line) => line.severity === severity).length]);
  return numbers.flatMap(([severity, n]) => (n ? [severities[severity]({ n })] : [])).join(', ');
}

/** "3 warnings, 2 notes", "no remarks" */
export function reportSummary({ lines }) {
  return counted(lines, ['error', 'warning', 'note']) || say.noRemarks;
}

/** The first image that is not of another patient, as the server takes it; null: none. */
export function firstImage(plan) {
  const shown = plan?.shownPatient ?? null;
  return plan?.images.find(({ patient = null }) => patient === null || shown === null || patient === shown) ?? null;
}

/** The image that the scene shows. */
export function shownImage(plan, scene) {
  const id = scene?.image?.id;
  return plan?.images.find((image) => image.id === id) ?? firstImage(plan);
}

/** The crosshair: the point where the three slices meet. @returns {[number, number, number]} LPS mm */
export function crosshair(scene) {
  const { sagittal, coronal, axial } = scene.image.slices;
  return [sagittal.position_mm, coronal.position_mm, axial.position_mm];
}

/** The centre of the image's voxel at a point, of the nearest one outside: core/volume/volume.h, grid_nearest_centre_lps_mm. */
function voxelCentre({ size, lpsFromIjk, ijkFromLps }, point) {
  const ijk = applied(ijkFromLps, point).map((index, axis) => Math.min(Math.max(Math.floor(index + 0.5), 0), size[axis] - 1));
  return applied(lpsFromIjk, ijk);
}

/**
 * The patch that moves the crosshair to a point: to the centre of the shown image's voxel there, so that slices and outlines
 * are those of voxels. With isFree, or without an image, to the point itself, clamped to the image or plan, to 0.1 mm.
 */
export function crosshairPatch(plan, image, point, { isFree = false } = {}) {
  const { low, high } = image?.bounds ?? plan.bounds;
  const rounded = (value, parts) => Math.round(value * parts) / parts || 0; // no -0
  const position =
    image?.ijkFromLps && !isFree
      ? voxelCentre(image, point).map((value) => rounded(value, 1e4))
      : point.map((value, axis) => rounded(Math.min(Math.max(value, low[axis]), high[axis]), 10));
  const [sagittal, coronal, axial] = position.map((position_mm) => ({ position_mm }));
  return { image: { slices: { sagittal, coronal, axial } } };
}

/** True if low values of the image are white: as the scene says, else as the image itself does. */
export const isLowWhite = (image, scene) => (scene.image.low_values === 'own' ? image.isInverted : scene.image.low_values === 'white');

/** The name of an image; ids tell two of the same name apart. */
export function imageName(plan, image) {
  const nameOf = ({ name, modality, id }) => name || (plan.images.length > 1 ? `${modality} ${id}` : modality);
  const isAlike = plan.images.some((other) => other.id !== image.id && nameOf(other) === nameOf(image));
  return isAlike ? `${nameOf(image)} (${image.id})` : nameOf(image);
}

/** The patch that hides all regions but one or, when only that one is shown, shows all again. */
export function soloPatch(regions, scene, id) {
  const isAlone = regions.every((region) => Boolean(scene.regions[region.id]?.visible) === (region.id === id));
  return { regions: Object.fromEntries(regions.map((region) => [region.id, { visible: isAlone || region.id === id }])) };
}

/** True for a region that the daemon takes for a target, by its type or its name. */
export const isTarget = ({ is_target: is = false }) => is;

/** The patch that shows the regions that pass the test and hides the others. */
export const showPatch = (regions, test) => ({
  regions: Object.fromEntries(regions.map((region) => [region.id, { visible: test(region) }])),
});

/** "1 error, 2 warnings"; '' when there is neither. */
export function troubles({ lines }) {
  return counted(lines, ['error', 'warning']);
}

const trackClasses = {
  'neutron-high': say.neutronHigh,
  'neutron-medium': say.neutronMedium,
  'neutron-low': say.neutronLow,
  'gamma-high': say.gammaHigh,
  'gamma-medium': say.gammaMedium,
  'gamma-low': say.gammaLow,
  lost: say.lost,
  'beam-line': say.beamLine,
};
/** "Neutron high" for the class of tracks "neutron-high". */
export const className = (id) => trackClasses[id] ?? id;

const components = {
  total: say.componentTotal,
  boron: say.boronWithin,
  nitrogen: say.nitrogenWithin,
  fast: say.componentFast,
  gamma: say.gammaWithin,
  other: say.componentOther,
  'blood-boron': say.componentBloodBoron,
  'weighted-total': say.componentWeightedTotal,
  'fast-fluence': say.componentFastFluence,
  'epithermal-fluence': say.componentEpithermalFluence,
  'thermal-fluence': say.componentThermalFluence,
};
/** "Gy per fraction, total" for a dose; unknown parts are left out. */
export function doseWords(dose) {
  const unit = dose.unit || say.noUnit;
  const quantities = dose.components.map(({ quantity: id, per_ppm: perPpm, boron_ppm: ppm }) => {
    const quantity = components[id] ?? id;
    return perPpm ? say.perPpm({ quantity }) : Number.isFinite(ppm) ? say.withBoron({ quantity, n: ppm }) : quantity;
  });
  return [dose.per ? say.unitPer({ unit, what: dose.per.replace(/^per /, '') }) : unit, ...quantities].join(', ');
}

/** A sentence when a dose may be shifted against the image; '' otherwise. */
export function frameWords({ frame_of_reference: frame }) {
  if (frame === 'differs') return say.otherFrame;
  return frame === 'unknown' ? say.unknownFrame : '';
}

/** "gantry 90°, 120 mm" for a beam. */
export function beamWords(beam) {
  const { delivery: d } = beam;
  const [n, end] = [d?.gantry_deg ?? null, d?.gantry_stop_deg ?? null];
  const gantry = n !== null && (end !== null && end !== n ? say.gantryTo({ n, end }) : say.gantry({ n }));
  return [d?.radiation?.toLowerCase(), gantry, beam.aperture_mm && say.aperture({ n: beam.aperture_mm })].filter(Boolean).join(', ');
}
