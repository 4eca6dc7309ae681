"""Beams through SERA's sample head, by ray casting in numpy: HEAD.uv.gz FILE. Each line of the file is a beam: a point, a direction of
unit length, both patient LPS in mm, and a radius. Every univel is taken as a box, and every box is cut by the line (slabs).

Prints for each beam, for scalp, brain and tumour: where the line enters and leaves its univels (the least and the greatest distance from the
point; nan: never), how long it runs in them, how many of their centres lie within the radius of the line, and the least distance along the
line of these centres (nan: none)."""
import gzip
import sys

try:
    import numpy
except ImportError:
    sys.exit(77)

SPACING, FIRST = numpy.array([1.01562, 1.01562, 5.49991]), numpy.array([-129.492, -129.492, -264.996])
labels = numpy.frombuffer(gzip.open(sys.argv[1]).read(), "u1").reshape(48, 256, 256)
centres = {}
for label in (2, 3, 4):
    k, j, i = numpy.nonzero(labels == label)
    centres[label] = FIRST + SPACING * numpy.stack([i, j, k], axis=1)

for line in open(sys.argv[2]):
    values = numpy.array(line.split(), float)
    point, direction, radius = values[:3], values[3:6], values[6]
    for label in (2, 3, 4):
        offset = centres[label] - point
        low, high = numpy.full(len(offset), -numpy.inf), numpy.full(len(offset), numpy.inf)
        for axis in range(3):
            near, far = offset[:, axis] - SPACING[axis] / 2, offset[:, axis] + SPACING[axis] / 2
            if direction[axis] == 0:
                low[(near > 0) | (far <= 0)] = numpy.inf
                continue
            a, b = near / direction[axis], far / direction[axis]
            low, high = numpy.maximum(low, numpy.minimum(a, b)), numpy.minimum(high, numpy.maximum(a, b))
        hit = low < high
        along = offset @ direction
        inside = numpy.linalg.norm(offset - along[:, None] * direction, axis=1) <= radius
        print(low[hit].min() if hit.any() else "nan", high[hit].max() if hit.any() else "nan", (high - low)[hit].sum(), inside.sum(),
              along[inside].min() if inside.any() else "nan")
