// Fits on the page: the parts that a scene uses, what the bar asks about, the marks, sums that cannot be, whose plan it is.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../../page.mjs';

const {
  byWordOf,
  factOf,
  inNumbersOf,
  joinReason,
  leftOffPatch,
  nLetters,
  partName,
  questionsOf,
  regionsOf,
  selectedUse,
  selectionOf,
  usesOf,
  voidRows,
} = await load('features/fits/fits.js');
const { acceptedPairs, pairKey } = await load('room/accepted.js');
const { approvalOf, identityOf, isOfOther, ownRegions, partsOfOthers, shownPatient, shownTreatmentPlan } = await load('room/identity.js');
const { Undo } = await load('room/undo.js');
const { stepTitle } = await load('shell/undo_words.js');
const { mergePatch } = await load('wire/merge.js');

const fit = (thing, relation, needs, other = 'image:mr') => ({
  thing,
  with: other,
  relation,
  needs,
  reason: `${thing} is not used with ${other}: ${relation}.`,
});
const plan = {
  images: [
    { id: 'mr', name: 'MR', patient: 0 },
    { id: 'ct', name: 'CT', patient: 1 },
  ],
  regions: [
    { id: 'brain', source: 1 },
    { id: 'ptv', source: 2 },
    { id: 'eye', source: null },
  ],
  doses: [
    { id: 'own', name: 'Field 1', unit: 'Gy', per: 'plan', patient: 0, plan: 1 },
    { id: 'boost', name: 'Boost', unit: 'cGy', per: 'plan', patient: 0, plan: 0 },
    { id: 'bnct', name: 'BNCT', unit: 'Gy(w)', per: 'plan' },
    { id: 'frac', name: '', unit: 'Gy', per: 'fraction' },
    { id: 'raw', name: 'raw', unit: '', per: 'plan' },
    { id: 'other', name: 'Sum', unit: 'Gy', per: 'plan', patient: 1 },
  ],
  beams: [{ id: 'b1', name: 'B1' }],
  patients: [{ masked: 'A. V. …417' }, { masked: 'K. M. …902' }],
  treatmentPlans: [
    { label: 'BNCT-1', approval: 'UNAPPROVED' },
    { label: 'BNCT-2', approval: 'APPROVED' },
  ],
  shownPatient: null,
  shownPlan: 1,
  fits: [
    fit('dose:own', 'same', 'nothing'),
    fit('dose:boost', 'frame', 'acceptance'),
    fit('regions:2', 'plan', 'acceptance'),
    fit('beam:b1', 'apart', 'acceptance'),
    fit('dose:other', 'patient', 'never'),
    fit('dose:boost', 'same', 'nothing', 'image:ct'),
    fit('dose:own', 'frame', 'acceptance', 'image:ct'),
    fit('dose:boost', 'plan', 'acceptance', 'dose:own'),
  ],
};
const scene = (dose = {}, more = {}) => ({
  image: { id: 'mr', blend: { id: '' } },
  regions: { brain: { visible: true }, ptv: { visible: true }, eye: { visible: true } },
  beam: { looks: {} },
  tracks: { visible: false },
  dose: {
    id: 'boost',
    sum: {},
    compare: { id: '', mode: 'none' },
    wash: { visible: true },
    lines: { visible: true },
    surfaces: { visible: false },
    coverage: { visible: false },
    ...dose,
  },
  ...more,
});
const row = (id, thing, other = 'image:mr') => [
  id,
  { id, kind: 'acceptance', author_name: 'Ann', created_ms: 0, body: { thing, with: other, reason: 'other', words: 'compared by eye' } },
];
const none = new Map();

test('the bar asks about what is shown and does not fit, the worst first, and not about what nobody shows', () => {
  const uses = usesOf(plan, scene(), none);
  assert.deepEqual(
    questionsOf(plan, scene(), uses).map(({ thing }) => thing),
    ['dose:boost', 'regions:2'],
  );
  const off = scene({ wash: { visible: false }, lines: { visible: false } }, { regions: { ptv: { visible: false } } });
  assert.deepEqual(questionsOf(plan, off, usesOf(plan, off, none)), []);
  const beam = scene({}, { beam: { looks: { b1: { visible: true } } } });
  assert.deepEqual(
    questionsOf(plan, beam, usesOf(plan, beam, none)).map(({ thing }) => thing),
    ['dose:boost', 'beam:b1', 'regions:2'],
  );
});

test('another image asks anew at once, and an acceptance is for its pair alone', () => {
  const rows = new Map([row('i-1', 'dose:boost')]);
  const accepted = acceptedPairs(rows, ['i-1']);
  assert.deepEqual(
    questionsOf(plan, scene(), usesOf(plan, scene(), accepted)).map(({ thing }) => thing),
    ['regions:2'],
  );
  assert.deepEqual(
    byWordOf(plan, scene(), usesOf(plan, scene(), accepted)).map(({ thing, by }) => [thing, by.id]),
    [['dose:boost', 'i-1']],
  );
  const ct = scene({ id: 'own' }, { image: { id: 'ct', blend: { id: '' } } });
  assert.deepEqual(
    questionsOf(plan, ct, usesOf(plan, ct, accepted)).map(({ thing, with: other }) => [thing, other]),
    [['dose:own', 'image:ct']],
  );
});

test('an acceptance that the server does not count is void: nothing is used by it', () => {
  const rows = new Map([row('i-1', 'dose:boost')]);
  assert.equal(acceptedPairs(rows, []).size, 0);
  assert.deepEqual(
    voidRows(rows, []).map(({ id }) => id),
    ['i-1'],
  );
  assert.deepEqual(voidRows(rows, ['i-1']), []);
  assert.equal(acceptedPairs(rows, ['i-1', 'i-gone']).size, 1, 'one that the page has not heard of yet');
  assert.ok(
    acceptedPairs(new Map([row('i-2', 'image:mr', 'dose:boost')]), ['i-2']).has(pairKey('dose:boost', 'image:mr')),
    'whichever is named first',
  );
});

test('what belongs to another patient is never asked about', () => {
  const shown = scene({ id: 'other' });
  const uses = usesOf(plan, shown, acceptedPairs(new Map([row('i-1', 'dose:other')]), ['i-1']));
  assert.equal(uses[0].thing, 'dose:other');
  assert.equal(uses[0].state, 'not-used');
  assert.ok(!questionsOf(plan, shown, uses).some(({ thing }) => thing === 'dose:other'));
});

test('leaving a part off hides that part alone', () => {
  const uses = usesOf(plan, scene(), none);
  const after = (use, shown) => mergePatch(shown, leftOffPatch(plan, shown, use));
  const [dose, regions] = questionsOf(plan, scene(), uses);
  assert.equal(after(dose, scene()).dose.wash.visible, false);
  assert.deepEqual(
    Object.entries(after(regions, scene()).regions).map(([id, { visible }]) => [id, visible]),
    [
      ['brain', true],
      ['ptv', false],
      ['eye', true],
    ],
  );
  const summed = scene({ id: 'own', sum: { boost: { factor: 1 } } });
  assert.deepEqual(
    after(
      usesOf(plan, summed, none).find(({ thing }) => thing === 'dose:boost'),
      summed,
    ).dose.sum,
    {},
  );
  const compared = scene({ id: 'own', compare: { id: 'boost', mode: 'lines' } });
  assert.equal(
    after(
      usesOf(plan, compared, none).find(({ thing }) => thing === 'dose:boost'),
      compared,
    ).dose.compare.mode,
    'none',
  );
});

test('a part is found by what is selected, a source of regions by each of its regions', () => {
  const uses = usesOf(plan, scene(), none);
  assert.equal(selectedUse(plan, uses, { kind: 'dose', id: 'boost' }).thing, 'dose:boost');
  assert.equal(selectedUse(plan, uses, { kind: 'dose', id: 'own' }), null);
  assert.equal(selectedUse(plan, uses, { kind: 'region', id: 'ptv' }).thing, 'regions:2');
  assert.equal(selectedUse(plan, uses, { kind: 'region', id: 'brain' }), null);
  assert.deepEqual(
    selectionOf(
      plan,
      uses.find(({ thing }) => thing === 'regions:2'),
    ),
    ['region', 'ptv'],
  );
  assert.deepEqual(
    regionsOf(plan, { thing: 'regions:0' }).map(({ id }) => id),
    ['eye'],
  );
  assert.equal(partName(plan, 'dose:boost'), 'Dose “Boost”');
  assert.equal(partName(plan, 'image:mr'), 'MR');
  const alike = {
    ...plan,
    images: [
      { id: 'ct', name: 'CT' },
      { id: 'ct-2', name: 'CT' },
      { id: 'mr', modality: 'MR' },
    ],
  };
  assert.deepEqual(
    alike.images.map(({ id }) => partName(alike, `image:${id}`)),
    ['CT (ct)', 'CT (ct-2)', 'MR mr'],
    'two alike are told by their ids',
  );
});

test('numbers are marked by what enters them, whether it is drawn or not', () => {
  const off = { wash: { visible: false }, lines: { visible: false } };
  const accepted = acceptedPairs(new Map([row('i-1', 'dose:boost'), row('i-2', 'beam:b1')]), ['i-1', 'i-2']);
  const marked = (dose) => inNumbersOf(plan, scene(dose), usesOf(plan, scene(dose), accepted)).map(({ thing }) => thing);
  assert.deepEqual(marked(off), ['dose:boost']);
  assert.deepEqual(marked({ ...off, id: 'own' }), [], 'another dose is chosen');
  assert.deepEqual(marked({ ...off, id: 'own', sum: { boost: { factor: 1 } } }), ['dose:boost'], 'a sum is marked when one part is');
});

test('what is used is described by the fact, not as not used', () => {
  assert.equal(
    factOf('Dose “Boost” is not used with MR: it was computed in another frame of reference. It may be shifted.'),
    'It was computed in another frame of reference. It may be shifted.',
  );
});

test('own words have at least ten letters, counted as the server counts', () => {
  assert.equal(nLetters('a b c !!!'), 3);
  assert.equal(nLetters('頭蓋底を比べて確認した'), 11);
});

test('what cannot be added says why; what is of another plan is compared only; fractions are a matter of the factor', () => {
  const of = (id) => plan.doses.find((dose) => dose.id === id);
  const accepted = acceptedPairs(new Map([row('i-1', 'dose:boost')]), ['i-1']);
  const more = {
    ...plan,
    fits: [...plan.fits, fit('dose:bnct', 'unit', 'never', 'dose:own'), fit('dose:frac', 'per', 'acceptance', 'dose:own')],
  };
  const why = (id, isSum = true, by = accepted) => joinReason(more, scene({ id: 'own' }), of('own'), of(id), isSum, by)?.words ?? '';
  assert.equal(why('boost', false), '');
  assert.equal(why('boost'), 'another plan: compare only');
  assert.equal(
    why('boost', true, acceptedPairs(new Map([row('i-1', 'dose:boost'), row('i-2', 'dose:boost', 'dose:own')]), ['i-1', 'i-2'])),
    '',
  );
  assert.equal(why('boost', false, none), 'does not fit');
  assert.equal(why('bnct'), 'another unit or kind');
  assert.equal(why('frac'), '');
  assert.equal(why('other'), 'does not fit', 'another patient');
});

test('the patient is the shown plan’s, and parts of others are listed, masked', () => {
  assert.equal(shownPatient(plan, scene()).masked, 'A. V. …417');
  assert.equal(shownPatient({ ...plan, shownPatient: 1 }, scene()).masked, 'K. M. …902');
  assert.equal(shownPatient({ ...plan, patients: [] }, scene()), null);
  assert.deepEqual(
    partsOfOthers(plan, scene()).map(({ kind, id, masked }) => [kind, id, masked]),
    [
      ['image', 'ct', 'K. M. …902'],
      ['dose', 'other', 'K. M. …902'],
    ],
  );
  assert.deepEqual(
    plan.images.map((image) => isOfOther(plan, scene(), image)),
    [false, true],
  );
  assert.equal(isOfOther(plan, scene(), {}), false, 'nobody is named');
  assert.equal(shownTreatmentPlan(plan, scene({ id: 'own' })).label, 'BNCT-2');
  assert.equal(shownTreatmentPlan(plan, scene({ id: 'raw' })).label, 'BNCT-2', 'the one that is shown first');
  assert.deepEqual(
    ['APPROVED', 'REJECTED', ''].map((approval) => approvalOf({ approval })[0]),
    ['Approved', 'Rejected', 'approval not stated'],
  );
});

test('of two patients that look alike when masked, the shown one is told by its place; of other files nobody is', () => {
  const masked = 'A. V. …417';
  const alike = { ...plan, patients: [{ masked }, { masked }], shownPatient: 1 };
  const identities = [
    { masked, name: 'Virtanen^Aino', id: '1417' },
    { masked, name: 'Vainio^Aili', id: '2417' },
  ];
  assert.equal(identityOf(alike, scene(), identities).id, '2417');
  assert.equal(identityOf({ ...alike, shownPatient: 0 }, scene(), identities).id, '1417');
  assert.equal(identityOf(alike, scene(), identities.slice(0, 1)), null, 'a shorter list is of other files');
  assert.equal(identityOf(alike, scene(), [...identities, identities[0]]), null, 'a longer one too');
  assert.equal(
    identityOf(alike, scene(), [identities[0], { masked: 'K. M. …902', name: 'Meri^Kai' }]),
    null,
    'somebody else at that place',
  );
  assert.equal(identityOf({ ...alike, patients: [] }, scene(), []), null, 'the files name nobody');
});

test('regions of another patient are in no list of regions', () => {
  const regions = [
    { id: 'brain', patient: 0 },
    { id: 'spine', patient: 1 },
    { id: 'mask', patient: null },
  ];
  assert.deepEqual(
    ownRegions({ ...plan, regions }, scene()).map(({ id }) => id),
    ['brain', 'mask'],
  );
  assert.deepEqual(
    ownRegions({ ...plan, regions, shownPatient: 1 }, scene()).map(({ id }) => id),
    ['spine', 'mask'],
  );
  assert.deepEqual(
    partsOfOthers({ ...plan, regions }, scene())
      .filter(({ kind }) => kind === 'region')
      .map(({ id }) => id),
    ['spine'],
  );
  assert.deepEqual(ownRegions({ ...plan, regions, patients: [] }, scene()).length, 3, 'the files name nobody');
});

test('undo takes an acceptance back, and redo makes it again', async () => {
  const done = [];
  const room = {
    canChange: { value: true },
    following: { isPresenting: { value: true } },
    plan: { value: plan },
    scene: { value: scene() },
    view: () => null,
  };
  const undo = new Undo(room, { clock: { now: () => 0 }, notify: (...words) => done.push(words[1]) });
  undo.noteAct({
    name: 'use of Dose “Boost”',
    undo: async () => {
      done.push('withdrawn');
    },
    redo: async () => {
      done.push('made');
    },
  });
  assert.equal(stepTitle('undo', undo.next.value, room), 'Undo: use of Dose “Boost”');
  undo.undo();
  await null;
  assert.equal(undo.next.value, null);
  undo.redo();
  await null;
  assert.deepEqual(done, ['withdrawn', 'made']);
  undo.noteAct({
    name: 'other',
    undo: async () => {
      throw new Error('gone');
    },
    redo: async () => {},
  });
  undo.undo();
  await new Promise((soon) => setTimeout(soon));
  assert.deepEqual(done, ['withdrawn', 'made', 'The server refused it.']);
});
