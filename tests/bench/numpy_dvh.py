#!/usr/bin/python3
"""The other side of bench_dvh.c: dose-volume histograms with numpy, when asked, so that both sides run in turn.

usage: numpy_dvh.py LABELS DOSE     bytes [200][512][512]; floats [124][128][130]

First prints numpy's version. Then, for each line on the standard input, interpolates the dose at all univels (axis by axis, in single
precision, slices at a time so that they stay in the cache), counts label and dose together by one bincount a slice, and prints
"MS MEAN D50% MEAN D50% ..." of labels 1 to 12. Exit status 77: no numpy here.
"""
import sys
import time

try:
    import numpy
except ImportError:
    sys.exit(77)

N_BINS, N_LABELS = 8192, 13
labels = numpy.fromfile(sys.argv[1], dtype=numpy.uint8).reshape(200, 512, 512)
dose = numpy.fromfile(sys.argv[2], dtype=numpy.float32).reshape(124, 128, 130)


def axis(n, origin, step, dose_origin, dose_step):
    """Lower voxel and the part of the way to the next, for each univel."""
    at = (origin + step * numpy.arange(n) - dose_origin) / dose_step
    low = numpy.floor(at).astype(int)
    return low, (at - low).astype(numpy.float32)


X, Y, Z = axis(512, -153.3, 0.6, -160.1, 2.5), axis(512, -153.3, 0.6, -158.2, 2.5), axis(200, -149.25, 1.5, -153.4, 2.5)


def histograms():
    low, rest = Z
    scale = numpy.float32(N_BINS / (float(dose.max()) * (1 + 1e-6)))
    counts = numpy.zeros((N_LABELS, N_BINS), dtype=numpy.int64)
    sums = numpy.zeros(N_LABELS)
    for k in range(200):
        plane = dose[low[k]] + rest[k] * (dose[low[k] + 1] - dose[low[k]])
        rows = plane[Y[0]] + Y[1][:, None] * (plane[Y[0] + 1] - plane[Y[0]])
        steps = rows[:, 1:] - rows[:, :-1]
        inside = numpy.flatnonzero(labels[k])
        values = (rows[:, X[0]] + X[1] * steps[:, X[0]]).ravel()[inside]
        label = labels[k].ravel()[inside]
        key = (values * scale).astype(numpy.int32) + label.astype(numpy.int32) * N_BINS
        counts += numpy.bincount(key, minlength=N_LABELS * N_BINS).reshape(N_LABELS, N_BINS)
        sums += numpy.bincount(label, weights=values, minlength=N_LABELS)
    return counts, sums, 1 / float(scale)


print("numpy", numpy.__version__, flush=True)
for line in sys.stdin:
    began = time.perf_counter()
    counts, sums, width = histograms()
    ms = (time.perf_counter() - began) * 1e3
    words = []
    for label in range(1, N_LABELS):
        n = counts[label].sum()
        from_above = numpy.cumsum(counts[label][::-1])
        at = int(numpy.searchsorted(from_above, n / 2))
        before = from_above[at - 1] if at else 0
        half = (N_BINS - at - (n / 2 - before) / (from_above[at] - before)) * width
        words += [sums[label] / n, half]
    print(ms, *words, flush=True)
