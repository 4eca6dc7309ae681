// Biological weights by region: presets and which of their rows a region gets by its name, what a region has, what was edited. Pure.
import { dosePresets } from '../../../gen/dose_presets.js';
import { say } from './later_words.js';

/** {name, source, note, tissues: [{tissue, words, boron_ratio, cbe, nitrogen, fast, gamma, other, isoeffective, assumed}]} */
export const weightPresets = dosePresets.weights;
/** {name, tissue, source, repair_source, photon, boron, nitrogen, fast, ...} */
export const isoeffectiveSets = dosePresets.isoeffective;
export const weightFields = ['boron_ratio', 'cbe', 'nitrogen', 'fast', 'gamma', 'other'];
const plain = { boron_ratio: 1, cbe: 1, nitrogen: 1, fast: 1, gamma: 1, other: 1, isoeffective: '' }; // proto/scene.json
const edited = ', edited';
const fromFiles = "from the plan's files"; // core/scene/snapshot.c

/**
 * The row of a preset for a region, as core/scene/first_dose.c: targets have the first kind of tissue, which is tumour; others the
 * first with a word that begins a word of the region's name, else the kind without words.
 */
export function tissueFor(preset, { name, is_target: isTarget }) {
  if (isTarget) return preset.tissues[0];
  const words = name
    .toLowerCase()
    .split(/[^a-z]+/)
    .filter(Boolean);
  const isIn = ({ words: starts }) => starts.some((start) => words.some((word) => word.startsWith(start)));
  return (
    preset.tissues.find((tissue) => tissue.words.length && isIn(tissue)) ?? preset.tissues.find((tissue) => !tissue.words.length) ?? null
  );
}

const numbersOf = (tissue) => ({
  ...Object.fromEntries(weightFields.map((field) => [field, tissue[field]])),
  isoeffective: tissue.isoeffective ?? '',
});

/** All regions get their row of the preset. */
export function presetPatch(plan, scene, preset) {
  const rows = plan.regions.map((region) => [region, tissueFor(preset, region)]);
  const weights = Object.fromEntries(
    rows
      .map(([{ id }, tissue]) => [id, tissue ? numbersOf(tissue) : id in scene.dose.weights ? null : undefined])
      .filter(([, row]) => row !== undefined),
  );
  return { dose: { weights, weights_name: preset.name } };
}

/** The weights that the plan's files give; null: they give none. */
function filesPreset(plan) {
  const given = plan.regions.filter(({ tissue }) => tissue && Object.values(tissue).some(Number.isFinite));
  if (!given.length) return null;
  const rowOf = ({ tissue: t }) => ({
    boron_ratio: t.boron_ratio ?? 1,
    cbe: t.cbe_boron ?? 1,
    nitrogen: t.rbe_nitrogen ?? 1,
    fast: t.rbe_fast ?? 1,
    gamma: t.rbe_gamma ?? 1,
    other: 1,
    isoeffective: '',
  });
  return {
    name: fromFiles,
    source: say.filesSource,
    note: '',
    rows: Object.fromEntries(given.map((region) => [region.id, rowOf(region)])),
  };
}

/** The choices: the presets, and the plan's own weights. */
export const presetsFor = (plan) => [filesPreset(plan), ...weightPresets].filter(Boolean);

export const baseName = (name) => (name.endsWith(edited) ? name.slice(0, -edited.length) : name);
export const isEdited = (scene) => !scene.dose.weights_name || scene.dose.weights_name.endsWith(edited);
/** The preset that the weights come from, edited since or not; null: not known. */
export const presetOf = (plan, scene) => presetsFor(plan).find(({ name }) => name === baseName(scene.dose.weights_name)) ?? null;

export function choosePresetPatch(plan, scene, preset) {
  if (!preset.rows) return presetPatch(plan, scene, preset);
  const gone = Object.keys(scene.dose.weights)
    .filter((id) => !(id in preset.rows))
    .map((id) => [id, null]);
  return { dose: { weights: Object.fromEntries([...Object.entries(preset.rows), ...gone]), weights_name: preset.name } };
}

/** The row of the region that the preset has; null: none. */
export const presetRow = (preset, region) => {
  const tissue = preset && (preset.rows ? preset.rows[region.id] : tissueFor(preset, region));
  return tissue ? numbersOf(tissue) : null;
};

/** The weights that hold in a region: its own, else those of the innermost region around it that has some. @returns {{row: object, from: string}|null} from: the region's id */
export function weightsOf(plan, scene, region) {
  const seen = new Set();
  for (let at = region; at && !seen.has(at.id); at = plan.regions.find(({ id }) => id === at.parent)) {
    const row = scene.dose.weights[at.id];
    if (row) return { row, from: at.id };
    seen.add(at.id);
  }
  return null;
}

/** One number of a region is changed: the region has a row of its own from now on, and the set is edited. */
export function editPatch(plan, scene, region, change) {
  const row = { ...plain, ...weightsOf(plan, scene, region)?.row, ...change };
  const base = baseName(scene.dose.weights_name);
  return { dose: { weights: { [region.id]: row }, weights_name: base ? `${base.slice(0, 80 - edited.length)}${edited}` : '' } };
}
