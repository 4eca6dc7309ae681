// Formats numbers for people: a true minus, thin spaces between thousands, one space before a unit.

import { say } from './words.js';

const thin = '\u2009';
const minus = '\u2212';

/** @param {number} value @param {number} digits after the point */
export function number(value, digits = 0) {
  if (!Number.isFinite(value)) return '–';
  const [whole, rest] = Math.abs(value).toFixed(digits).split('.');
  const grouped = whole.length > 4 ? whole.replace(/\B(?=(\d{3})+$)/g, thin) : whole;
  const isZero = !/[1-9]/.test(whole + (rest ?? ''));
  return `${value < 0 && !isZero ? minus : ''}${grouped}${rest ? `.${rest}` : ''}`;
}

/** With a sign unless it is zero: "+0.31", "−0.04", "0.00". */
export function signed(value, digits) {
  const text = number(value, digits);
  return value > 0 && /[1-9]/.test(text) ? `+${text}` : text;
}

const raised = { '-': '⁻', 0: '⁰', 1: '¹', 2: '²', 3: '³', 4: '⁴', 5: '⁵', 6: '⁶', 7: '⁷', 8: '⁸', 9: '⁹' };

/** Three significant figures: "0.0447", "10.0", "1.23 × 10¹⁰". Before the point all figures stay. */
export function significant(value) {
  if (!Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  const [digits, power] = value.toExponential(2).split('e'); // rounds first: 9.996 has the size of 10
  const size = Number(power);
  if (size < -4 || size > 6) return `${digits.replace('-', minus)} × 10${[...String(size)].map((sign) => raised[sign]).join('')}`;
  return number(value, Math.max(0, 2 - size));
}

export const millimetres = (value) => `${number(value, 1)} mm`;

/** A place along a beam: "44.3 mm from source end", "4.4 m before source end". core/annotate/describe_beam.c says the same. */
export function alongBeam(mm) {
  const distance = Math.abs(mm) < 1000 ? millimetres(Math.abs(mm)) : `${number(Math.abs(mm) / 1000, 1)} m`;
  return mm <= -0.05 ? say.beforeSourceEnd({ distance }) : say.fromSourceEnd({ distance });
}

/** "L 24.9  P 38.4  S \u221264.9 mm" */
export const position = ([left, posterior, superior]) => `L ${number(left, 1)}  P ${number(posterior, 1)}  S ${number(superior, 1)} mm`;

/** A value of an image and its unit: whole numbers as they are (139, \u22121 024 HU), others by three significant figures. */
export const imageValue = (value, unit) => ({ text: Number.isInteger(value) ? number(value) : significant(value), unit: unitText(unit) });

/** "6.6 MB", "519 kB"; a dash for nothing, as of a plan that cannot be read. */
export function bytes(n) {
  if (!Number.isFinite(n) || n <= 0) return '–';
  if (n < 1e3) return `${number(n)} B`;
  if (n < 1e6) return `${number(n / 1e3, n < 99950 ? 1 : 0)} kB`;
  return n < 1e9 ? `${number(n / 1e6, 1)} MB` : `${number(n / 1e9, 1)} GB`;
}

/** "67.2 cm³", with as many figures as a list needs. */
export function volume(cm3) {
  if (cm3 > 0 && cm3 < 0.005) return '< 0.01 cm³';
  return `${number(cm3, cm3 < 9.995 ? 2 : cm3 < 99.95 ? 1 : 0)} cm³`;
}

/** 2026-11-23 13:46, by the clock of this browser: no order of day and month to be mistaken. */
export const dayTime = (ms) => new Date(ms).toLocaleString('sv', { dateStyle: 'short', timeStyle: 'short' });
export const seconds = (ms) => (ms < 1000 ? `${number(ms)} ms` : `${number(ms / 1000, 1)} s`);

export const count = (n, word) => `${number(n)} ${word}${n === 1 ? '' : 's'}`;

// Codes of DICOM: PS3.3 C.8.9.1 (Units), C.11.1.1.2 (Rescale Type). core/annotate/words.c has the same table; tests/data/unit_words.json holds both.
const unitCodes = new Map(
  Object.entries({
    CNTS: say.counts,
    CPS: `${say.counts}/s`,
    PROPCNTS: say.relativeCounts,
    PROPCPS: `${say.relativeCounts}/s`,
    NONE: '',
    CM2: 'cm²',
    CM2ML: say.suv({ unit: 'cm²/mL' }),
    PCNT: '%',
    PCT: '%',
    BQML: 'Bq/mL',
    GML: say.suv({ unit: 'g/mL' }),
    MGML: 'mg/mL',
    MGMINML: 'mg/min/mL',
    UMOLML: 'µmol/mL',
    UMOLMINML: 'µmol/min/mL',
    MLG: 'mL/g',
    MLML: 'mL/mL',
    MLMING: 'mL/min/g',
    MLMINML: 'mL/min/mL',
    '1CM': '1/cm',
    STDDEV: say.standardDeviations,
    HU_MOD: say.modifiedUnit({ unit: 'HU' }),
    SUV: 'SUV',
  }),
);

/** "1/cm²" for a unit as files write it, "1/cm2"; "Gy(w)" for a weighted dose under its older names; "Bq/mL" for a code; an unknown code in quotation marks. */
export const unitText = (unit) =>
  unitCodes.get(unit) ??
  (/^[A-Z0-9_]{3,}$/.test(unit) ? `“${unit}”` : unit)
    .replace(/\bGy[- ]?Eq\b|\bGyw\b/gi, 'Gy(w)')
    .replace(/\b([cm]?m)([23])\b/g, (_, metre, power) => `${metre}${power === '2' ? '²' : '³'}`);

/** "Physical total, Gy"; without a comma where one is empty. */
export const listed = (...words) => words.filter(Boolean).join(', ');

/** "C 40  W 400 HU", the form of a window everywhere on the page; a narrow window has the digits that tell its greys apart. */
export const windowText = ({ center, width, gamma = 1 }, unit, isInverted = false) => {
  const digits = width < 10 ? Math.min(2 - Math.floor(Math.log10(width)), 20) : 0;
  const [c, w] = width < 1e-4 ? [significant(center), significant(width)] : [number(center, digits), number(width, digits)];
  const words = unit ? unitText(unit) : '';
  const window = `C ${c}  W ${w}${words && ` ${words}`}${gamma === 1 ? '' : ` γ ${Number(gamma.toFixed(2))}`}`;
  return isInverted ? say.windowInverted({ window }) : window;
};

/** "R1" for "Reviewer 1", "AL" for "Ada Lovelace". */
export function initials(name) {
  const words = name.trim().split(/\s+/);
  const letters = words.length > 1 ? words[0][0] + words.at(-1)[0] : words[0].slice(0, 2);
  return letters.toUpperCase();
}

/** "liver and colon", "liver, colon and 21 more" */
export function nameSome(names, shown = 3) {
  if (names.length <= 1) return names[0] ?? '';
  if (names.length <= shown) return say.and({ names: names.slice(0, -1).join(', '), last: names.at(-1) });
  return say.andMore({ names: names.slice(0, shown - 1).join(', '), n: names.length - shown + 1 });
}
