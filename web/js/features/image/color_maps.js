// The colour maps of images as the page names and draws them. Pure.
import { colorMapStops } from '../../../gen/color_maps.js';
import { say } from './later_words.js';

const evenly = (colours) => colours.map((color, index) => [index / (colours.length - 1), color]);
const table = (id, name, about) => [id, name, about, evenly(colorMapStops[id])];

/** Colour maps: word, name, what it is, the stops of its gradient (DICOM PS3.6 B.1.1 for hot iron). */
export const colorMaps = [
  ['grey', say.grey, say.greyIs, evenly(['#000000', '#ffffff'])],
  table('viridis', say.viridis, say.viridisIs),
  table('cividis', say.cividis, say.cividisIs),
  table('inferno', say.inferno, say.infernoIs),
  table('magma', say.magma, say.magmaIs),
  table('plasma', say.plasma, say.plasmaIs),
  [
    'hot-iron',
    say.hotIron,
    say.hotIronIs,
    [
      [0, '#000000'],
      [0.5, '#ff0000'],
      [0.75, '#ffff00'],
      [1, '#ffffff'],
    ],
  ],
  ['rainbow', say.rainbow, say.rainbowIs, evenly(['#0000ff', '#00ffff', '#00ff00', '#ffff00', '#ff0000'])],
  table('turbo', say.turbo, say.turboIs),
];

const bytes = (color) => [1, 3, 5].map((at) => Number.parseInt(color.slice(at, at + 2), 16));

/** The colour of a map at 0..1, as "#rrggbb". */
export function colorAt(id, at) {
  const [, , , stops] = colorMaps.find(([other]) => other === id);
  const next = Math.max(
    1,
    stops.findIndex(([place]) => place >= at),
  );
  const [[low, from], [high, to]] = [stops[next - 1], stops[next]];
  const part = Math.min(Math.max((at - low) / (high - low), 0), 1);
  const [a, b] = [bytes(from), bytes(to)];
  return `#${a
    .map((byte, c) =>
      Math.round(byte + part * (b[c] - byte))
        .toString(16)
        .padStart(2, '0'),
    )
    .join('')}`;
}
