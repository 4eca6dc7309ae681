"""seraMC's contours of the sample head, read with numpy: values at points in LPS mm, and how they agree with the cells of its .rst file.

usage: sera_contours.py FOLDER
"point x y z total boron gamma nitrogen fast fast-fluence epithermal-fluence thermal-fluence other" (seraMC's order of columns)
"agreement QUANTITY correlation median-ratio", over the points in scalp, brain and tumor (seraMC's regions 6, 7, 8)
"""
import gzip
import sys
import zlib

try:
    import numpy as np
except ImportError:
    sys.exit(77)

folder = sys.argv[1] + "/generated/"
lines = zlib.decompress(open(folder + "head1.cdf.sz", "rb").read()).decode().splitlines()
cuts = [0, 10, 20, 30, 34] + [34 + 10 * (i + 1) for i in range(9)]
table = np.array([[float(line[a:b]) for a, b in zip(cuts, cuts[1:])] for line in lines])
rl, pa, up = table[:, 0] * 13, table[:, 1] * 13, table[:, 2] * 13  # cm
region, values = table[:, 3], table[:, 4:]

rst = gzip.open(folder + "head1.rst.gz", "rt").read().split("\n")
n, corner, cell = 30, np.array([-15.0, -15.0, -29.0]), 1.0
header_lines = 10 + 3 * 9
words = [line[i:i + 15] for line in rst[header_lines:] for i in range(0, len(line.rstrip()), 15)]
cells = np.array([float(word) for word in words]).reshape(n, n, n, 14)  # x (PA), y (RL), z (IS)
source, gammas = 6.112503e13, 5.895142e-3
neutron = source * (1 - gammas) / cell ** 3
photon = source * ((1 - gammas) * cells[..., 4].sum() + gammas) / 3600 / cell ** 3

index = np.floor((np.stack([pa, rl, up], 1) - corner) / cell).astype(int)
inside = ((index >= 0) & (index < n)).all(1) & (region >= 6)
at = tuple(index[inside].T)
for name, column, own, factor in (("boron", 3, 1, neutron), ("gamma", 0, 2, photon), ("nitrogen", 5, 3, neutron),
                                  ("thermal-fluence", 8, 7, neutron)):
    a, b = values[inside, own], cells[..., column][at] * factor
    good = b > 0.02 * b.max()
    print("agreement", name, np.corrcoef(a[good], b[good])[0, 1], np.median(a[good] / b[good]))

z_of = {}
for line in open(folder + "head1.chd"):
    if line.startswith("z_value_"):
        z_of[round(float(line.split(":")[1]) / 13, 3)] = float(line.split(":")[1])
planes = np.array(sorted(z_of.values()))
for i in range(7, len(table), 701):
    if region[i] not in (4, 6, 7, 8) or (values[i] == 0).any():
        continue
    z = planes[np.argmin(np.abs(planes - up[i]))]
    column, row = i % 40, i // 40 % 40
    x, y = 13 * (-1 + 2 * column / 39), 13 * (-1 + 2 * row / 39)
    print("point", 10 * x, -10 * y, 10 * z, *values[i])
