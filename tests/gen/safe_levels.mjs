// Searches for the isodose colours "Colour-vision-safe" of proto/dose_presets.json: eight colours that are told apart from each other and
// from every grey, by CIEDE2000, with normal vision and without red or green cones. Prints them; nothing else runs it.
//   node tests/gen/safe_levels.mjs [SEED] [STEPS]
// Red to violet from the highest dose down, each within a range of hues of its own, no darker than L* 40, so that it is seen on black.
// The table has seed 4 and 3000 steps. tests/web/unit/features/dose/safe_levels.test.mjs checks the result by code of its own.
// Vision: G. M. Machado, M. M. Oliveira, L. A. F. Fernandes, IEEE Trans. Vis. Comput. Graph. 15 (2009) 1291, severity 1, in linear RGB.
// Colour difference: G. Sharma, W. Wu, E. N. Dalal, Color Res. Appl. 30 (2005) 21.
const visions = [
  [
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
  ],
  [
    [0.152286, 1.052583, -0.204868],
    [0.114503, 0.786281, 0.099216],
    [-0.003882, -0.048116, 1.051998],
  ],
  [
    [0.367322, 0.860646, -0.227968],
    [0.280085, 0.672501, 0.047413],
    [-0.01182, 0.04294, 0.968881],
  ],
];
const linear = (byte) => (byte / 255 <= 0.04045 ? byte / 255 / 12.92 : ((byte / 255 + 0.055) / 1.055) ** 2.4);
const toLab = ([r, g, b]) => {
  const f = (t) => (t > 216 / 24389 ? Math.cbrt(t) : ((24389 / 27) * t + 16) / 116);
  const x = f((0.4124564 * r + 0.3575761 * g + 0.1804375 * b) / 0.95047);
  const y = f(0.2126729 * r + 0.7151522 * g + 0.072175 * b);
  const z = f((0.0193339 * r + 0.119192 * g + 0.9503041 * b) / 1.08883);
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
};
const seen = (rgb, vision) => {
  const light = rgb.map(linear);
  return toLab(vision.map((row) => Math.min(Math.max(row[0] * light[0] + row[1] * light[1] + row[2] * light[2], 0), 1)));
};

const rad = Math.PI / 180;
const hue = (a, b) => (a === 0 && b === 0 ? 0 : (Math.atan2(b, a) / rad + 360) % 360);
function difference([l1, a1, b1], [l2, a2, b2]) {
  const c7 = ((Math.hypot(a1, b1) + Math.hypot(a2, b2)) / 2) ** 7;
  const g = 1.5 - 0.5 * Math.sqrt(c7 / (c7 + 25 ** 7));
  const [c1, c2] = [Math.hypot(g * a1, b1), Math.hypot(g * a2, b2)];
  const [h1, h2] = [hue(g * a1, b1), hue(g * a2, b2)];
  const isGrey = c1 * c2 === 0;
  const turn = isGrey ? 0 : ((h2 - h1 + 540) % 360) - 180;
  const between = isGrey ? h1 + h2 : h1 + turn / 2;
  const [l, c] = [(l1 + l2) / 2, (c1 + c2) / 2];
  const t =
    1 -
    0.17 * Math.cos((between - 30) * rad) +
    0.24 * Math.cos(2 * between * rad) +
    0.32 * Math.cos((3 * between + 6) * rad) -
    0.2 * Math.cos((4 * between - 63) * rad);
  const m7 = c ** 7;
  const place = ((between + 360) % 360) - 275;
  const rotation = -2 * Math.sqrt(m7 / (m7 + 25 ** 7)) * Math.sin(60 * Math.exp(-((place / 25) ** 2)) * rad);
  const dl = (l2 - l1) / (1 + (0.015 * (l - 50) ** 2) / Math.sqrt(20 + (l - 50) ** 2));
  const dc = (c2 - c1) / (1 + 0.045 * c);
  const dh = (2 * Math.sqrt(c1 * c2) * Math.sin((turn / 2) * rad)) / (1 + 0.015 * c * t);
  return Math.sqrt(dl * dl + dc * dc + dh * dh + rotation * dc * dh);
}

const greys = visions.map((vision) => Array.from({ length: 86 }, (_, i) => seen([3 * i, 3 * i, 3 * i], vision)));
/** The least differences: to a grey, of neighbours, of any two. */
function least(colours) {
  const found = { grey: Infinity, near: Infinity, pair: Infinity };
  visions.forEach((vision, v) => {
    const labs = colours.map((rgb) => seen(rgb, vision));
    labs.forEach((lab, i) => {
      for (const grey of greys[v]) found.grey = Math.min(found.grey, difference(lab, grey));
      for (let j = 0; j < i; j += 1) {
        const d = difference(lab, labs[j]);
        found.pair = Math.min(found.pair, d);
        if (j === i - 1) found.near = Math.min(found.near, d);
      }
    });
  });
  return found;
}

const hues = [
  [-14, 8],
  [22, 38],
  [50, 60],
  [80, 115],
  [185, 205],
  [205, 228],
  [240, 275],
  [285, 325],
];
const leastLightness = 40;
const toRgb = ([h, s, v]) =>
  [5, 3, 1].map((n) => {
    const k = (n + (h + 360) / 60) % 6;
    return Math.round(255 * (v - v * s * Math.max(0, Math.min(k, 4 - k, 1))));
  });
function worth(points) {
  const colours = points.map(toRgb);
  const { grey, near, pair } = least(colours);
  const dark = colours.reduce((sum, rgb) => sum + Math.max(0, leastLightness - seen(rgb, visions[0])[0]), 0);
  const vivid = points.reduce((sum, [, s, v]) => sum + s + v / 2, 0);
  return 3 * Math.min(grey, pair, 13) + 0.15 * Math.min(near, 22) - 2 * dark + 0.4 * vivid;
}

/** Simulated annealing. */
function search(seed, steps) {
  let state = seed;
  const random = () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
  const within = (value, low, high) => Math.min(Math.max(value, low), high);
  let now = hues.map(([low, high]) => [(low + high) / 2, 0.9, 0.9]);
  let [best, nowWorth] = [now, worth(now)];
  let bestWorth = nowWorth;
  for (let t = 0; t < steps; t += 1) {
    const [heat, reach] = [1.5 * (1 - t / steps) + 0.01, 0.6 * (1 - t / steps) + 0.04];
    const i = Math.floor(random() * hues.length);
    const [low, high] = hues[i];
    const [h, s, v] = now[i];
    const moved = [
      within(h + (random() - 0.5) * (high - low) * reach * 2, low, high),
      within(s + (random() - 0.5) * reach, 0.5, 1),
      within(v + (random() - 0.5) * reach, 0.35, 1),
    ];
    const next = now.map((point, k) => (k === i ? moved : point));
    const nextWorth = worth(next);
    if (nextWorth > nowWorth || random() < Math.exp((nextWorth - nowWorth) / heat)) [now, nowWorth] = [next, nextWorth];
    if (nowWorth > bestWorth) [best, bestWorth] = [now, nowWorth];
  }
  return best.map(toRgb);
}

const found = search(Number(process.argv[2] ?? 4), Number(process.argv[3] ?? 3000));
console.log(found.map((rgb) => `#${rgb.map((byte) => byte.toString(16).padStart(2, '0')).join('')}`).join(' '));
console.log(least(found));
