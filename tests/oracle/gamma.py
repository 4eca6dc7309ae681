"""Gamma indices by brute force in numpy: gamma.py FOLDER DOSE_PERCENT REFERENCE LOCAL DISTANCE_MM THRESHOLD MOST

FOLDER holds first.raw and second.raw (float32, x fastest) and grids.txt: for each, size, spacing and origin, mm.
Samples the second dose, tri-linear, on a lattice of 1/20 of the distance around each voxel of the first; prints one
index a line, "nan" where there is none. Exits with 77 without numpy."""
import sys

try:
    import numpy as np
except ImportError:
    sys.exit(77)

folder, dose_percent, reference, is_local, distance, threshold, most = sys.argv[1], *map(float, sys.argv[2:8])
grids = [list(map(float, line.split())) for line in open(folder + '/grids.txt')]
first, second = (np.fromfile(f'{folder}/{name}.raw', '<f4').reshape([int(n) for n in grid[2::-1]]).astype(float)
                 for name, grid in zip(('first', 'second'), grids))
(s1, o1), (s2, o2) = (((np.array(g[3:6])), np.array(g[6:9])) for g in grids)
size2 = np.array(second.shape[::-1])


def sample(points):
    at = (points - o2) / s2
    outside = np.any((at < -0.5) | (at > size2 - 0.5), axis=1)
    at = np.clip(at, 0, size2 - 1)
    low = np.minimum(at.astype(int), size2 - 2)
    w = at - low
    value = np.zeros(len(points))
    for corner in range(8):
        bits = np.array([corner & 1, corner >> 1 & 1, corner >> 2 & 1])
        share = np.prod(np.where(bits, w, 1 - w), axis=1)
        x, y, z = (low + bits).T
        value += np.where(share > 0, share * second[z, y, x], 0)
    return np.where(outside, np.nan, value)


steps = int(20 * most)
axis = np.arange(-steps, steps + 1) / 20
away = np.stack(np.meshgrid(axis, axis, axis, indexing='ij'), -1).reshape(-1, 3)
distance2 = np.sum(away ** 2, axis=1)
away, distance2 = away[distance2 < most ** 2], distance2[distance2 < most ** 2]
for k, j, i in np.ndindex(first.shape):
    value = first[k, j, i]
    point = o1 + s1 * np.array([i, j, k])
    if np.isnan(value) or value < threshold or (is_local and value <= 0) or np.isnan(sample(point[None])[0]):
        print('nan')
        continue
    tolerance = dose_percent / 100 * (value if is_local else reference)
    here = ((sample(point[None])[0] - value) / tolerance) ** 2
    near = distance2 < min(here, most ** 2)
    squares = ((sample(point + distance * away[near]) - value) / tolerance) ** 2 + distance2[near]
    squares = squares[~np.isnan(squares)]
    print(f'{np.sqrt(min(here, most ** 2, squares.min() if len(squares) else here)):.9g}')
