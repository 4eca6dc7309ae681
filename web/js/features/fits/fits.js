// Which parts of the plan the scene uses together, and by whose word: the server's judgement of each pair (fits of the plan) and the acceptances of the room. Pure.
import { pairKey } from '../../room/accepted.js';
import { isOn as isDoseOn, shownDose } from '../../room/dose.js';
import { imageName, shownImage } from '../../room/plan.js';
import { say } from './later_words.js';

/** Relations, the worst first; and the two words that mark what is used all the same. */
const marks = {
  patient: say.markPatient,
  frame: say.markFrame,
  apart: say.markApart,
  plan: say.markPlan,
  unit: say.markUnit,
  per: say.markPer,
  absent: say.markAbsent,
};
const order = Object.keys(marks);
/** Each kind alone, and within a sentence. */
const words = {
  image: [say.image, say.inImage],
  regions: [say.regions, say.inRegions],
  dose: [say.dose, say.inDose],
  beam: [say.beam, say.inBeam],
  tracks: [say.tracks, say.inTracks],
};
const lists = { image: 'images', dose: 'doses', beam: 'beams' };

export const reasons = [
  ['registered-elsewhere', say.registeredElsewhere, say.asRegisteredElsewhere],
  ['same-session', say.sameSession, say.asSameSession],
  ['compared-on-anatomy', say.comparedOnAnatomy, say.asComparedOnAnatomy],
  ['other', say.other, say.asOther],
];
const reasonOf = (id) =>
  reasons.find(([known]) => known === id) ?? [id, id, ({ words: own }) => say.reasonWords({ reason: id, words: own })];
export const reasonName = (id) => reasonOf(id)[1];
/** The reason of an acceptance and what the person wrote, after "Because". */
export const reasonWords = ({ reason, words: own }) => reasonOf(reason)[2]({ words: own });
export const minLetters = 10;

/** Counts letters like the server: letters and digits of ASCII, and every character beyond it. */
export const nLetters = (text) => [...text].filter((letter) => /[0-9A-Za-z]/.test(letter) || letter >= '\u00c0').length;

export const isRank = (relation) => order.indexOf(relation);
export const markWords = (relation) => marks[relation] ?? say.markOther;

/** Acceptances that do not count any more, or not yet. */
export const voidRows = (rows, counting) => [...rows.values()].filter(({ kind, id }) => kind === 'acceptance' && !counting.includes(id));

const isOfSource =
  ({ thing }) =>
  (region) =>
    region.source === undefined || `regions:${region.source ?? 0}` === thing;
const regionWords = ([first, ...others]) =>
  !first ? '' : others.length ? say.regionAndMore({ region: first.name, n: others.length }) : first.name || first.id;

/** "dose:boost" as {kind, id, word, lower: the word within a sentence, name}. */
export function partOf(plan, key) {
  const [kind, id = ''] = key.split(/:(.*)/);
  const regions = kind === 'regions' ? plan.regions.filter((region) => isOfSource({ thing: key })(region)) : [];
  const part = kind === 'regions' ? regions[0] : plan[lists[kind]]?.find((one) => one.id === id);
  const image = kind === 'image' && part && imageName(plan, part);
  return {
    key,
    kind,
    id,
    word: words[kind]?.[0] ?? kind,
    lower: words[kind]?.[1] ?? kind,
    name: kind === 'regions' ? regionWords(regions) : image || part?.name || (kind === 'tracks' ? '' : id),
    part: part ?? null,
  };
}

/** Dose “Boost”, Regions, MR */
export const partName = (plan, key) => {
  const { kind, word, name } = partOf(plan, key);
  return kind === 'image' ? name : name ? say.partNamed({ kind: word, name }) : word;
};

export { pairKey };

export const fitOf = (plan, thing, other) => plan?.fits.find((fit) => pairKey(fit.thing, fit.with) === pairKey(thing, other)) ?? null;

/** @typedef {{thing: string, with: string, kind: string, id: string, relation: string, reason: string, needs: string, state: 'used'|'not-used'|'by-word', by: object|null}} Use */

function useOf(fit, accepted) {
  const by = fit.needs === 'acceptance' ? (accepted.get(pairKey(fit.thing, fit.with)) ?? null) : null;
  const [kind, id = ''] = fit.thing.split(/:(.*)/);
  return { ...fit, kind, id, by, state: fit.needs === 'nothing' ? 'used' : by ? 'by-word' : 'not-used' };
}

const compare = (a, b) => (isRank(a.relation) + 1 || 99) - (isRank(b.relation) + 1 || 99);

/** Every part with the shown image, and doses that are added or compared with the dose shown; the worst first. @returns {Use[]} */
export function usesOf(plan, scene, accepted) {
  if (!plan || !scene) return [];
  const image = `image:${shownImage(plan, scene)?.id}`;
  const dose = `dose:${shownDose(plan, scene)?.id}`;
  const joined = [...Object.keys(scene.dose.sum), ...(scene.dose.compare.mode === 'none' ? [] : [scene.dose.compare.id])].map(
    (id) => `dose:${id}`,
  );
  const isAlone = (fit) => fit.thing === fit.with; // in a plan without images
  const concerns = (fit) => fit.with === image || isAlone(fit) || (fit.with === dose && joined.includes(fit.thing));
  return plan.fits
    .filter(concerns)
    .map((fit) => useOf(fit, accepted))
    .sort(compare);
}

export const regionsOf = (plan, use) => plan.regions.filter(isOfSource(use));

/** True if the scene shows the part, or would if it fitted. */
export function isWanted(plan, scene, { kind, id, ...use }) {
  if (kind === 'dose')
    return (
      isDoseOn(scene) &&
      (shownDose(plan, scene)?.id === id || id in scene.dose.sum || (scene.dose.compare.mode !== 'none' && scene.dose.compare.id === id))
    );
  if (kind === 'beam') return Boolean(scene.beam.looks[id]?.visible);
  if (kind === 'tracks') return Boolean(scene.tracks?.visible);
  if (kind === 'image') return scene.image.blend?.id === id;
  return kind === 'regions' && regionsOf(plan, use).some((region) => scene.regions[region.id]?.visible);
}

/** The uses that the bar asks about: shown, not used, and a person may accept them. */
export const questionsOf = (plan, scene, uses) =>
  uses.filter((use) => use.state === 'not-used' && use.needs === 'acceptance' && isWanted(plan, scene, use));
/** The uses that are shown by a person's word: each picture and number is marked. */
export const byWordOf = (plan, scene, uses) => uses.filter((use) => use.state === 'by-word' && isWanted(plan, scene, use));

/** The uses that enter the numbers of dose by a person's word, drawn or not. */
export function inNumbersOf(plan, scene, uses) {
  const isChosen = ({ kind, id }) =>
    kind !== 'dose' ||
    shownDose(plan, scene)?.id === id ||
    id in scene.dose.sum ||
    (scene.dose.compare.mode !== 'none' && scene.dose.compare.id === id);
  return uses.filter((use) => use.state === 'by-word' && ['dose', 'regions'].includes(use.kind) && isChosen(use));
}

/** "Dose “Boost” is not used with MR: it was …" as what is so: "It was …". */
export function factOf(reason) {
  const fact = reason.slice(reason.indexOf(': ') + (reason.includes(': ') ? 2 : 0));
  return `${fact.slice(0, 1).toUpperCase()}${fact.slice(1)}`;
}

/** The patch that hides a part. */
export function leftOffPatch(plan, scene, { kind, id, ...use }) {
  if (kind === 'beam') return { beam: { looks: { [id]: { visible: false } } } };
  if (kind === 'tracks') return { tracks: { visible: false } };
  if (kind === 'image') return { image: { blend: { id: '' } } };
  if (kind === 'regions') return { regions: Object.fromEntries(regionsOf(plan, use).map((region) => [region.id, { visible: false }])) };
  if (id in scene.dose.sum) return { dose: { sum: { [id]: null } } };
  if (shownDose(plan, scene)?.id !== id) return { dose: { compare: { mode: 'none' } } };
  return {
    dose: {
      lines: { visible: false },
      wash: { visible: false },
      surfaces: { visible: false },
      coverage: { visible: false },
      compare: { mode: 'none' },
    },
  };
}

/** The use of what is selected; null: it fits. */
export function selectedUse(plan, uses, { kind, id }) {
  const region = kind === 'region' && plan.regions.find((one) => one.id === id);
  return (
    uses.find(
      (use) =>
        use.state !== 'used' &&
        (use.kind === 'regions'
          ? Boolean(region) && isOfSource(use)(region)
          : use.kind === (kind === 'track' ? 'tracks' : kind) && (use.kind === 'tracks' || use.id === id)),
    ) ?? null
  );
}

/** The selection for a part. @returns {[string, string]} kind and id */
export function selectionOf(plan, use) {
  if (use.kind === 'regions') return ['region', regionsOf(plan, use)[0]?.id ?? ''];
  return [use.kind, use.kind === 'tracks' ? '' : use.id];
}

// ---- sums and comparisons -------------------------------------------------------------------------------------------------

const joins = {
  patient: say.joinPatient,
  plan: say.joinPlan,
  unit: say.joinUnit,
};

/**
 * Why a dose cannot be put together with the first one, in a few words and in the server's sentence; null: it can. "per" is no reason here: a factor, the
 * number of fractions, makes what is per fraction one of the whole plan, and the server says whether it does. isSum: to be added, else compared.
 */
export function joinReason(plan, scene, first, second, isSum, accepted) {
  const image = shownImage(plan, scene);
  const own = image && fitOf(plan, `dose:${second.id}`, `image:${image.id}`);
  const isOpen = (fit) => fit && fit.needs !== 'nothing' && !(fit.needs === 'acceptance' && accepted.has(pairKey(fit.thing, fit.with)));
  if (isOpen(own)) return { words: say.markOther, reason: own.reason };
  const fit = fitOf(plan, `dose:${second.id}`, `dose:${first.id}`);
  if (!isOpen(fit) || fit.relation === 'per' || (fit.relation === 'plan' && !isSum)) return null;
  return { words: joins[fit.relation] ?? say.markOther, reason: fit.reason };
}
