// The combinations of the thesis on Sera3d as one change each: what they need, which patches they are, what they say they change. LPS, mm.
import { batch } from '../../../lib/signals-core.js';
import { isObject, joinPatches, mergePatch } from '../../wire/merge.js';
import { add, cross, dot, length, scale, subtract, unit } from '../../parts/vec.js';
import { beamShown } from '../../room/beam_line.js';
import { isWeighted, shownDose } from '../../room/dose.js';
import { crosshair, isTarget } from '../../room/plan.js';
import { say } from './preset_words.js';

const usualApertureMm = 100; // of the ring, where the plan says none
const [throughTarget, aroundTarget, underSurface] = [0.35, [0.25, 0.4], 0.5]; // opacities: of a target that is cut through; of the outermost and of other regions before a target; of a target in an isodose surface
const slant = 0.8; // tangent of the angle between the beam and the line of sight onto its slice
const tenths = (mm) => Math.round(mm * 10) / 10 || 0; // no -0

/** @typedef {{words: string, patch: object}} Part words '': nothing that a person needs to be told */

// ---- parts --------------------------------------------------------------------------------------------------------------

const targetsOf = (plan) => plan.regions.filter((region) => isTarget(region) && region.center_mm);
const nameOf = (part) => part.name || part.id;
const listed = ([one, two, ...more]) => {
  if (!two) return one ? nameOf(one) : '';
  return more.length ? say.nTargets({ n: more.length + 2 }) : say.twoTargets({ one: nameOf(one), two: nameOf(two) });
};

/** Where the targets are: the middle of the first one, else where the slices meet. */
const middleOf = (plan, scene) => targetsOf(plan)[0]?.center_mm ?? crosshair(scene);

/** The targets with this opacity, and no other region. */
function onlyTargets(plan, opacity) {
  const targets = targetsOf(plan);
  const others = plan.regions.filter((region) => !targets.includes(region));
  return [
    {
      words: (opacity < 1 ? say.transparent : say.shown)({ targets: listed(targets) }),
      patch: { regions: Object.fromEntries(targets.map(({ id }) => [id, { visible: true, opacity }])) },
    },
    { words: say.othersHidden, patch: { regions: Object.fromEntries(others.map(({ id }) => [id, { visible: false }])) } },
  ];
}

/** The ids of the regions that one lies in. */
function outerOf(plan, region) {
  const ids = new Set();
  for (let at = region; at?.parent && !ids.has(at.parent); at = plan.regions.find(({ id }) => id === at.parent)) ids.add(at.parent);
  return ids;
}

/** The targets whole, what they lie in and what else is shown transparent. */
function targetsInside(plan, scene) {
  const targets = targetsOf(plan);
  const outer = new Set(targets.flatMap((target) => [...outerOf(plan, target)]));
  const around = plan.regions.filter(
    (region) => targets.length && !targets.includes(region) && (scene.regions[region.id]?.visible || outer.has(region.id)),
  );
  const clear = ({ id, depth }) => [id, { visible: true, opacity: Math.min(scene.regions[id].opacity, aroundTarget[Math.min(depth, 1)]) }];
  return [
    {
      words: say.shown({ targets: listed(targets) }),
      patch: {
        regions: Object.fromEntries(targets.map(({ id }) => [id, { visible: true, opacity: outer.has(id) ? aroundTarget[1] : 1 }])),
      },
    }, // one in another is seen
    { words: say.aroundTransparent, patch: { regions: Object.fromEntries(around.map(clear)) } },
  ];
}

const off = (names, fields) => Object.fromEntries(names.map((name) => [name, fields]));
const axes = ['axial', 'coronal', 'sagittal'];
const clips = ['axial_low', 'axial_high', 'coronal_low', 'coronal_high', 'sagittal_low', 'sagittal_high', 'beam', 'free'];

const noSlices = (scene) => ({
  words: say.slicesHidden,
  patch: { image: { slices: off(axes, { visible: false }), obliques: off(Object.keys(scene.image.obliques ?? {}), { visible: false }) } },
});
const noVolume = { words: say.volumeHidden, patch: { image: { volume: { visible: false } } } };
const noPatientClips = {
  words: say.clipsOff,
  patch: {
    clip: off(
      clips.filter((id) => id !== 'beam'),
      { enabled: false },
    ),
  },
}; // one across the beam belongs to it
const noClips = { words: say.clipsOff, patch: { clip: off(clips, { enabled: false }) } };
const noBeamSlice = { words: say.beamSliceHidden, patch: { beam: { slice: { visible: false } } } };
const noSurfaces = { words: say.surfacesHidden, patch: { dose: { surfaces: { visible: false } } } };

// ---- beams and cameras --------------------------------------------------------------------------------------------------

/** The home camera of 3-D turned to look from a direction. */
function cameraFrom({ home }, back) {
  const { position_mm: position, target_mm: target } = home['3d'];
  const up = Math.abs(back[2]) > 0.99 ? [0, -1, 0] : [0, 0, 1];
  return { position_mm: add(target, scale(back, length(subtract(position, target)))), target_mm: target, up };
}

/** Looks along the beam, turned aside towards the home camera, so that the slice across it is seen from before. */
function besideBeam(plan, { direction }) {
  const { position_mm: position, target_mm: target } = plan.home['3d'];
  const across = (towards) => subtract(towards, scale(direction, dot(towards, direction)));
  const home = across(unit(subtract(position, target)));
  const aside = length(home) > 0.1 ? home : cross(direction, Math.abs(direction[0]) > 0.9 ? [0, 1, 0] : [1, 0, 0]);
  return cameraFrom(plan, unit(add(scale(direction, -1), scale(unit(aside), slant))));
}

// ---- presets ------------------------------------------------------------------------------------------------------------

/** In two or three words; '' when it is there. */
const lacks = {
  beam: (plan, scene) => (beamShown(plan, scene) ? '' : say.noBeam),
  image: (plan) => (plan.images.length ? '' : say.noImage),
  target: (plan) => (targetsOf(plan).length ? '' : say.noTarget),
  dose: (plan, scene) => (shownDose(plan, scene) ? '' : say.noDose), // one that does not fit is said above the panes
};

/** The level of 90 %: the scene's, or a new one; surfaces of the others off. */
function ninety(scene) {
  const { levels } = scene.dose;
  const known = Object.entries(levels).find(([, { value, unit }]) => value === 90 && unit === 'percent')?.[0];
  const style = { visible: true, surface: true, opacity: 0.4 };
  const others = Object.keys(levels).filter((id) => id !== known && levels[id].surface);
  return {
    ...off(others, { surface: false }),
    [known ?? 'preset-90']: known ? style : { value: 90, unit: 'percent', color: '#ffb52e', line: true, wash: true, ...style },
  };
}

/** Changes towards isodoses like SERA's contours: without jumps at the target's border, in per cent of the maximum in the tissue around it. What a person has chosen stays. */
function asTissueAround(plan, { dose }) {
  const targets = targetsOf(plan);
  const outer = targets.find(({ parent }) => !targets.some(({ id }) => id === parent));
  const around = plan.regions.find(({ id }) => id === outer?.parent);
  if (!around) return [];
  return [
    ...(isWeighted(dose.quantity) && !dose.tissue
      ? [{ words: say.weightsOf({ region: nameOf(around) }), patch: { dose: { tissue: around.id } } }]
      : []),
    ...(dose.reference.kind === 'body'
      ? [{ words: say.hundredIs({ region: nameOf(around) }), patch: { dose: { reference: { kind: 'region-max', region: around.id } } } }]
      : []),
  ];
}

const throughTargetWords = {
  sagittal: say.sagittalTarget,
  coronal: say.coronalTarget,
  axial: say.axialTarget,
};
const throughCrosshairWords = {
  sagittal: say.sagittalCrosshair,
  coronal: say.coronalCrosshair,
  axial: say.axialCrosshair,
};

/** The plane that cuts through the targets along the beam, on the side of the home camera: of the three that square with the patient the one that the beam runs in best. */
function alongClip(plan, scene) {
  const direction = beamShown(plan, scene)?.direction ?? [0, 1, 0];
  const { position_mm: position, target_mm: target } = plan.home['3d'];
  const look = unit(subtract(position, target));
  const best = [0, 1, 2]
    .map((axis) => ({ axis, rank: Math.abs(look[axis]) * (1 - Math.abs(direction[axis])) }))
    .sort((a, b) => b.rank - a.rank)[0].axis;
  const axis = ['sagittal', 'coronal', 'axial'][best];
  const id = `${axis}_${look[best] > 0 ? 'high' : 'low'}`;
  return {
    words: (targetsOf(plan).length ? throughTargetWords : throughCrosshairWords)[axis],
    patch: { clip: { ...noClips.patch.clip, [id]: { enabled: true, cap: true, position_mm: tenths(middleOf(plan, scene)[best]) } } },
  };
}

const table = [
  {
    id: 'beam-slice',
    name: say.beamSlice,
    icon: 'plane',
    needs: ['beam', 'image', 'target'],
    kind: '3d',
    about: say.beamSliceIs,
    make: (plan, scene) => {
      const line = beamShown(plan, scene);
      const along = tenths(dot(subtract(middleOf(plan, scene), line.entry), line.direction));
      const look = line.id
        ? { looks: { [line.id]: { visible: true, ...(scene.beam.looks[line.id] ? {} : { opening: true, color: '#f4f6f8' }) } } }
        : {};
      return {
        parts: [
          { words: say.beamSliceAt({ mm: along }), patch: { beam: { slice: { visible: true, along_mm: along } } } },
          { words: say.beamShown, patch: { beam: look } },
          ...onlyTargets(plan, throughTarget),
          noSlices(scene),
          noVolume,
          noSurfaces,
          noClips,
        ],
        view: { camera: besideBeam(plan, line) },
      };
    },
  },
  {
    id: 'ninety',
    name: say.ninety,
    icon: 'isodose',
    needs: ['dose', 'target'],
    kind: '3d',
    about: say.ninetyIs,
    make: (plan, scene) => ({
      parts: [
        { words: say.surfaceOfNinety, patch: { dose: { surfaces: { visible: true }, levels: ninety(scene) } } },
        ...asTissueAround(plan, scene),
        ...onlyTargets(plan, underSurface),
        noSlices(scene),
        noBeamSlice,
        noVolume,
        noClips,
      ],
      view: {},
    }),
  },
  {
    id: 'washed-volume',
    name: say.washedVolume,
    icon: 'cube',
    needs: ['dose', 'image'],
    kind: '3d',
    about: say.washedVolumeIs,
    make: (plan, scene) => ({
      parts: [
        { words: say.volumeShown, patch: { image: { volume: { visible: true, clipped: true } } } },
        { words: say.washOnIt, patch: { dose: { wash: { visible: true, volume: true } } } },
        alongClip(plan, scene),
        ...(targetsOf(plan).length
          ? onlyTargets(plan, 1)
          : [{ words: say.regionsHidden, patch: { regions: Object.fromEntries(plan.regions.map(({ id }) => [id, { visible: false }])) } }]),
        noSlices(scene),
        noBeamSlice,
        noSurfaces,
      ],
      view: { camera: cameraFrom(plan, unit(subtract(plan.home['3d'].position_mm, plan.home['3d'].target_mm))) },
    }),
  },
  {
    id: 'beams-eye',
    name: say.beamsEye,
    icon: 'target',
    needs: ['beam'],
    kind: 'beam',
    about: say.beamsEyeIs,
    make: (plan, scene) => {
      const aperture = beamShown(plan, scene).aperture ?? usualApertureMm;
      return {
        parts: [
          { words: say.ringOf({ mm: tenths(aperture) }), patch: {} },
          ...targetsInside(plan, scene),
          noSlices(scene),
          noBeamSlice,
          noVolume,
          noPatientClips,
        ],
        view: { beam: { aperture_mm: aperture, crosshair: true, along_mm: null }, camera: { height_mm: tenths(aperture / 0.7) } }, // as beam_eye.js fits it
      };
    },
  },
];

/** The presets of a plan and, of one that it cannot have, why. @returns {{id: string, name: string, icon: string, about: string, why: string}[]} */
export const presetsOf = (plan, scene) =>
  table.map(({ id, name, icon, about, needs }) => ({
    id,
    name,
    icon,
    about,
    why: needs.map((need) => lacks[need](plan, scene)).find(Boolean) ?? '',
  }));

const holds = (now, patch) =>
  isObject(patch) ? Object.entries(patch).every(([name, value]) => holds(now?.[name], value)) : (now ?? null) === (patch ?? null);

/**
 * One preset as a change of scene and view.
 * @returns {{name: string, kind: string, patch: object, view: object, words: string[]}} kind: of the view that shows it; words: what changes, for people
 */
export function presetChange(plan, scene, presetId) {
  const { name, kind, make } = table.find(({ id }) => id === presetId);
  const { parts, view } = make(plan, scene);
  const changing = parts.filter(({ patch }) => !holds(scene, patch) || !Object.keys(patch).length);
  return {
    name,
    kind,
    view,
    patch: changing.reduce((whole, { patch }) => joinPatches(whole, patch), {}),
    words: changing.map(({ words }) => words).filter(Boolean),
  };
}

// ---- applying them ------------------------------------------------------------------------------------------------------

/** The view that shows a preset: one of its kind that is on the screen, the active one first; else the first of its kind, in the place of the active one. */
export function viewFor({ room, ui }, kind) {
  const shown = [ui.active.value, ...ui.visible.value].filter((number) => ui.visible.value.includes(number));
  const number = shown.find((one) => room.view(one).kind === kind) ?? room.views.find((view) => view.kind === kind)?.number ?? 0;
  return { number, instead: shown.includes(number) ? 0 : (shown.find((one) => room.view(one).kind === '3d') ?? shown[0]) };
}

/** A closed view opens with the change. */
function changeView(room, number, patch, at) {
  const view = room.view(number);
  if (view.isOpen.value) return void room.patchView(number, patch, { at });
  room.following.leave();
  view.restart(mergePatch(view.document.value, patch));
}

/** Applies a preset. @param {object} world {room, ui, undo} */
export function applyPreset({ room, ui, undo }, id, at) {
  if (!room.canChange.value) return;
  const { name, kind, patch, view, words } = presetChange(room.plan.value, room.scene.value, id);
  const { number, instead } = viewFor({ room, ui }, kind);
  if (!number) return;
  const isOnScreen = !instead;
  room.together(`preset ${id}`, () =>
    batch(() => {
      if (instead) ui.showInPlaceOf(instead, number);
      else ui.active.value = number;
      if (Object.keys(patch).length) room.patchScene(patch, { view: isOnScreen ? number : 0, at });
      if (Object.keys(view).length) changeView(room, number, view, at);
    }),
  );
  ui.notify('ok', say.changed({ name, changes: words.join(', ') }), 'preset', {
    word: say.undo,
    keys: (hotkeys) => hotkeys.text('undo'),
    act: () => undo.undo(),
  });
}
