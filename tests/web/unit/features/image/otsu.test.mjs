// Otsu's threshold from a histogram, beside the variance between classes worked out from every value for every threshold.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../../page.mjs';

const { otsu } = await load('features/image/histograms.js');

const histogramOf = (values, bins = 256) => {
  const [low, high] = [Math.min(...values), Math.max(...values)];
  const counts = Array(bins).fill(0);
  for (const value of values) counts[Math.min(bins - 1, Math.floor(((value - low) / (high - low)) * bins))] += 1;
  return { low, high, counts };
};
const mean = (values) => values.reduce((sum, value) => sum + value, 0) / values.length;
const betweenOf = (values, threshold) => {
  const [dark, bright] = [values.filter((value) => value < threshold), values.filter((value) => value >= threshold)];
  if (!dark.length || !bright.length) return 0;
  return dark.length * bright.length * (mean(dark) - mean(bright)) ** 2;
};

let seed = 1;
const random = () => {
  seed = (seed * 48271) % 2147483647;
  return seed / 2147483647;
};
const bell = (middle, width) => middle + (width * (random() + random() + random() + random() - 2)) / 2;

test('it parts values as the largest variance between the classes does, whatever the range', () => {
  for (const [dark, bright, share] of [
    [0, 100, 0.5],
    [-1000, 40, 0.3],
    [0.001, 0.004, 0.7],
    [12, 118, 0.6],
  ]) {
    const gap = bright - dark;
    const values = Array.from({ length: 3000 }, () => (random() < share ? bell(dark, gap / 3) : bell(bright, gap / 3)));
    const histogram = histogramOf(values);
    const threshold = otsu(histogram);
    const candidates = Array.from({ length: 400 }, (_, at) => histogram.low + ((at + 0.5) * (histogram.high - histogram.low)) / 400);
    const most = Math.max(...candidates.map((one) => betweenOf(values, one)));
    assert.ok(betweenOf(values, threshold) > 0.995 * most, `${threshold} between ${dark} and ${bright}`); // bins and three figures
  }
});

test('between two heaps with nothing between it is in the middle; one bin more than all is no threshold', () => {
  const counts = Array(256).fill(0);
  [counts[10], counts[200]] = [500, 500];
  assert.equal(otsu({ low: 0, high: 256, counts }), 106); // the bins 10 to 199 part them alike: (10 + 199) / 2 + 1, to three figures
  assert.ok(Number.isFinite(otsu({ low: 0, high: 1, counts: [7] })));
});
