// Colours of isodoses and of the scales of differences and gamma, as people without red or green cones see them.
// Vision: Machado, Oliveira, Fernandes, IEEE Trans. Vis. Comput. Graph. 15 (2009) 1291, table of severity 1, applied in linear RGB.
// Colour difference: CIEDE2000 as Sharma, Wu, Dalal, Color Res. Appl. 30 (2005) 21 state it, held to the pairs of their table 1.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';

const presets = JSON.parse(readFileSync('proto/dose_presets.json', 'utf8'));
const safe = presets.level_tables.find(({ name }) => name === 'Colour-vision-safe');
const toldApart = 10;

const visions = {
  normal: [1, 0, 0, 0, 1, 0, 0, 0, 1],
  protanopia: [0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998],
  deuteranopia: [0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.01182, 0.04294, 0.968881],
};

/** Linear light of an sRGB byte, IEC 61966-2-1. */
const light = (byte) => {
  const c = byte / 255;
  return c > 0.04045 ? ((c + 0.055) / 1.055) ** 2.4 : c / 12.92;
};
/** CIE L*a*b* with white D65 of a colour "#rrggbb" as a vision shows it. */
function labOf(color, [m00, m01, m02, m10, m11, m12, m20, m21, m22]) {
  const [r, g, b] = [1, 3, 5].map((at) => light(Number.parseInt(color.slice(at, at + 2), 16)));
  const shown = [m00 * r + m01 * g + m02 * b, m10 * r + m11 * g + m12 * b, m20 * r + m21 * g + m22 * b].map((v) =>
    Math.max(0, Math.min(1, v)),
  );
  const xyz = [
    [0.4124564, 0.3575761, 0.1804375, 0.95047],
    [0.2126729, 0.7151522, 0.072175, 1],
    [0.0193339, 0.119192, 0.9503041, 1.08883],
  ].map(([x, y, z, white]) => (x * shown[0] + y * shown[1] + z * shown[2]) / white);
  const [fx, fy, fz] = xyz.map((t) => (t > (6 / 29) ** 3 ? t ** (1 / 3) : t / (3 * (6 / 29) ** 2) + 4 / 29));
  return [116 * fy - 16, 500 * (fx - fy), 200 * (fy - fz)];
}

const degrees = (radians) => (radians * 180) / Math.PI;
const cosDeg = (angle) => Math.cos((angle * Math.PI) / 180);
const sinDeg = (angle) => Math.sin((angle * Math.PI) / 180);
const ratio7 = (c) => Math.sqrt(c ** 7 / (c ** 7 + 6103515625));

/** CIEDE2000 with kL = kC = kH = 1, in the steps of Sharma et al. */
function deltaE(one, two) {
  const cBar = (Math.hypot(one[1], one[2]) + Math.hypot(two[1], two[2])) / 2;
  const stretch = 1 + 0.5 * (1 - ratio7(cBar));
  const [p, q] = [one, two].map(([l, a, b]) => {
    const turned = degrees(Math.atan2(b, stretch * a));
    return { l, c: Math.hypot(stretch * a, b), h: turned < 0 ? turned + 360 : turned };
  });
  let dh = q.h - p.h;
  if (p.c * q.c === 0) dh = 0;
  else if (dh > 180) dh -= 360;
  else if (dh < -180) dh += 360;
  let h = p.h + q.h;
  if (p.c * q.c !== 0) {
    if (Math.abs(p.h - q.h) <= 180) h /= 2;
    else h = h < 360 ? (h + 360) / 2 : (h - 360) / 2;
  }
  const l = (p.l + q.l) / 2 - 50;
  const c = (p.c + q.c) / 2;
  const t = 1 - 0.17 * cosDeg(h - 30) + 0.24 * cosDeg(2 * h) + 0.32 * cosDeg(3 * h + 6) - 0.2 * cosDeg(4 * h - 63);
  const lightness = (q.l - p.l) / (1 + (0.015 * l * l) / Math.sqrt(20 + l * l));
  const chroma = (q.c - p.c) / (1 + 0.045 * c);
  const hueDifference = (2 * Math.sqrt(p.c * q.c) * sinDeg(dh / 2)) / (1 + 0.015 * c * t);
  const rotation = -2 * ratio7(c) * sinDeg(60 * Math.exp(-(((h - 275) / 25) ** 2)));
  return Math.sqrt(lightness ** 2 + chroma ** 2 + hueDifference ** 2 + rotation * chroma * hueDifference);
}

test('the colour difference of this test is that of the published pairs', () => {
  const blue = [50, 0, -82.7485];
  const pink = [50, 2.5, 0];
  const pairs = [
    [[50, 2.6772, -79.7751], blue, 2.0425],
    [[50, 3.1571, -77.2803], blue, 2.8615],
    [[50, 2.8361, -74.02], blue, 3.4412],
    [[50, -1.3802, -84.2814], blue, 1],
    [[50, -1.1848, -84.8006], blue, 1],
    [[50, -0.9009, -85.5211], blue, 1],
    [[50, 0, 0], [50, -1, 2], 2.3669],
    [[50, -1, 2], [50, 0, 0], 2.3669],
    [[50, 2.49, -0.001], [50, -2.49, 0.0009], 7.1792],
    [[50, 2.49, -0.001], [50, -2.49, 0.001], 7.1792],
    [[50, 2.49, -0.001], [50, -2.49, 0.0011], 7.2195],
    [[50, 2.49, -0.001], [50, -2.49, 0.0012], 7.2195],
    [[50, -0.001, 2.49], [50, 0.0009, -2.49], 4.8045],
    [[50, -0.001, 2.49], [50, 0.001, -2.49], 4.8045],
    [[50, -0.001, 2.49], [50, 0.0011, -2.49], 4.7461],
    [pink, [50, 0, -2.5], 4.3065],
    [pink, [73, 25, -18], 27.1492],
    [pink, [61, -5, 29], 22.8977],
    [pink, [56, -27, -3], 31.903],
    [pink, [58, 24, 15], 19.4535],
    [pink, [50, 3.1736, 0.5854], 1],
    [pink, [50, 3.2972, 0], 1],
    [pink, [50, 1.8634, 0.5757], 1],
    [pink, [50, 3.2592, 0.335], 1],
    [[60.2574, -34.0099, 36.2677], [60.4626, -34.1751, 39.4387], 1.2644],
    [[63.0109, -31.0961, -5.8663], [62.8187, -29.7946, -4.0864], 1.263],
    [[61.2901, 3.7196, -5.3901], [61.4292, 2.248, -4.962], 1.8731],
    [[35.0831, -44.1164, 3.7933], [35.0232, -40.0716, 1.5901], 1.8645],
    [[22.7233, 20.0904, -46.694], [23.0331, 14.973, -42.5619], 2.0373],
    [[36.4612, 47.858, 18.3852], [36.2715, 50.5065, 21.2231], 1.4146],
    [[90.8027, -2.0831, 1.441], [91.1528, -1.6435, 0.0447], 1.4441],
    [[90.9257, -0.5406, -0.9208], [88.6381, -0.8985, -0.7239], 1.5381],
    [[6.7747, -0.2908, -2.4247], [5.8714, -0.0985, -2.2286], 0.6377],
    [[2.0776, 0.0795, -1.135], [0.9033, -0.0636, -0.5514], 0.9082],
  ];
  for (const [one, two, expected] of pairs) {
    assert.ok(Math.abs(deltaE(one, two) - expected) < 5e-5, `${one} and ${two}: ${deltaE(one, two)}, not ${expected}`);
    assert.ok(Math.abs(deltaE(two, one) - expected) < 5e-5, 'the other way round');
  }
});

test('a white stays white and a grey grey with every vision', () => {
  for (const [name, vision] of Object.entries(visions))
    for (const grey of ['#ffffff', '#808080', '#0a0a0a']) {
      const [, a, b] = labOf(grey, vision);
      assert.ok(Math.hypot(a, b) < 0.1, `${name}, ${grey}`);
    }
});

const greys = Array.from({ length: 256 }, (_, byte) => `#${byte.toString(16).padStart(2, '0').repeat(3)}`);

test('the colour-vision-safe levels are told apart from each other and from every grey, with any vision', () => {
  assert.equal(safe.levels.length, 8);
  for (const [name, vision] of Object.entries(visions)) {
    const labs = safe.levels.map(({ color }) => labOf(color, vision));
    const greyLabs = greys.map((grey) => labOf(grey, vision));
    labs.forEach((lab, i) => {
      const { color } = safe.levels[i];
      // any two, not only neighbours: fewer levels than eight are chosen out of the table
      for (let j = 0; j < i; j += 1)
        assert.ok(deltaE(lab, labs[j]) >= toldApart, `${name}: ${color} and ${safe.levels[j].color} differ by ${deltaE(lab, labs[j])}`);
      const nearest = Math.min(...greyLabs.map((grey) => deltaE(lab, grey)));
      assert.ok(nearest >= toldApart, `${name}: ${color} is ${nearest} from a grey`);
    });
  }
});

test('the steps of cividis are not: some are near to grey', () => {
  const lab = labOf('#7d7c78', visions.normal);
  assert.ok(Math.min(...greys.map((grey) => deltaE(lab, labOf(grey, visions.normal)))) < 5);
});

test('the two sides of the scales of differences and gamma are told apart with any vision', () => {
  for (const name of ['difference', 'gamma']) {
    const { stops } = presets.scales.find((scale) => scale.name === name);
    const low = stops.filter(({ at }, i) => at < 0 || (name === 'gamma' && i < 2));
    const high = stops.filter(({ at }, i) => at > 0 && (name === 'difference' || i >= 2));
    for (const [seen, vision] of Object.entries(visions))
      for (const a of low)
        for (const b of high) {
          const d = deltaE(labOf(a.color, vision), labOf(b.color, vision));
          assert.ok(d >= 20, `${name}, ${seen}: ${a.color} and ${b.color} differ by ${d}`);
        }
  }
});
