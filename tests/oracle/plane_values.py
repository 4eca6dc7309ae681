#!/usr/bin/python3
"""Samples voxel grids on planes with numpy, independently of our code.

usage: plane_values.py FOLDER

For each FOLDER/*.case, words of one line:
  type      uint8, int16, uint16 or float32, of the voxels in the .raw beside it, [k][j][i]
  ni nj nk  number of voxels
  slope offset
  matrix    12: index to patient, column by column, origin last
  origin right up   3 each: the plane
  width height pixels_per_mm    of the picture, whose middle is the plane's origin
  linear    1: linear between voxel centres, constant beyond the outermost; 0: the nearest voxel's value
writes .values beside it, float64 [height][width]: NaN outside the grid's outer faces and where a voxel that counts is not
finite; and .sure, uint8 [height][width]: 0 within a thousandth of a voxel of a place where the value jumps.
Exit status 77: this machine has no numpy.
"""
import glob
import os
import sys

try:
    import numpy
except ImportError as problem:
    print(problem)
    sys.exit(77)

EDGE = 1e-3  # voxels: single precision at the far end of 512 voxels is good to 6e-5


def sample(stem):
    with open(stem + '.case') as file:
        words = file.read().split()
    numbers = numpy.array(words[1:], dtype=float)
    size = numbers[:3].astype(int)
    slope, offset = numbers[3:5]
    matrix = numbers[5:14].reshape(3, 3).T
    start = numbers[14:17]
    origin, right, up = numbers[17:26].reshape(3, 3)
    width, height = numbers[26:28].astype(int)
    scale, linear = numbers[28], numbers[29] == 1
    raw = numpy.fromfile(stem + '.raw', dtype=words[0]).reshape(size[::-1]).transpose(2, 1, 0)
    voxels = raw.astype(float) * slope + offset

    x = (numpy.arange(width) + 0.5 - width / 2) / scale
    y = (height / 2 - numpy.arange(height) - 0.5) / scale
    points = origin + x[None, :, None] * right + y[:, None, None] * up
    at = numpy.linalg.solve(matrix, (points - start).reshape(-1, 3).T).T.reshape(height, width, 3)
    room = numpy.minimum(at + 0.5, size - 0.5 - at).min(axis=2)
    sure = numpy.abs(room) > EDGE
    free = at  # beyond the outermost centres, too
    if linear:
        at = numpy.clip(at, 0, size - 1)
        low = numpy.minimum(at.astype(int), numpy.maximum(size - 2, 0))
        weight = at - low
        values = numpy.zeros((height, width))
        for corner in numpy.ndindex(2, 2, 2):
            index = numpy.minimum(low + corner, size - 1)
            share = numpy.prod(numpy.where(numpy.array(corner) == 1, weight, 1 - weight), axis=2)
            values = values + share * voxels[index[..., 0], index[..., 1], index[..., 2]]
        # a voxel that is not finite spoils its neighbours where its share is nought, too
        bad = ~numpy.isfinite(voxels)
        if bad.any():
            spoiled = numpy.zeros((height, width), dtype=bool)
            for corner in numpy.ndindex(2, 2, 2):
                index = numpy.minimum(low + corner, size - 1)
                spoiled |= bad[index[..., 0], index[..., 1], index[..., 2]]
            values[spoiled] = numpy.nan
            sure &= (numpy.abs(free - numpy.round(free)) > EDGE).all(axis=2)
    else:
        sure &= (numpy.abs(at - 0.5 - numpy.round(at - 0.5)) > EDGE).all(axis=2)
        index = numpy.clip(numpy.floor(at + 0.5).astype(int), 0, size - 1)
        values = voxels[index[..., 0], index[..., 1], index[..., 2]]
    values = numpy.where((room > 0) & numpy.isfinite(values), values, numpy.nan)
    values.astype(numpy.float64).tofile(stem + '.values')
    sure.astype(numpy.uint8).tofile(stem + '.sure')


with numpy.errstate(all='ignore'):
    for case in glob.glob(os.path.join(sys.argv[1], '*.case')):
        sample(case[:-len('.case')])
