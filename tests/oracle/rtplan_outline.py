"""Compares outlines with the opening that jaws and leaves of an RTPLAN leave at the first control point, on points half a mm
apart: PLAN OUTLINES, a text with a line for each polygon: beam number, then x and y of its points. Prints for each beam its
number, the open points, and those that are open and outside of every polygon, or the other way round."""
import sys

try:
    import numpy
    import pydicom

    from rtplan_open import X, Y, points_of
except ImportError:
    sys.exit(77)

def inside(points):
    """Even-odd rule."""
    found = numpy.zeros(X.shape, bool)
    for (x0, y0), (x1, y1) in zip(points, numpy.roll(points, -1, axis=0)):
        if y0 != y1:
            found ^= ((y0 <= Y) != (y1 <= Y)) & (X < x0 + (Y - y0) * (x1 - x0) / (y1 - y0))
    return found


polygons = {}
for line in open(sys.argv[2]):
    number, *values = line.split()
    polygons.setdefault(int(number), []).append(numpy.array(values, float).reshape(-1, 2))
for beam in pydicom.dcmread(sys.argv[1], force=True).BeamSequence:
    expected, found = points_of(beam, beam.ControlPointSequence[0]), numpy.zeros(X.shape, bool)
    for points in polygons.get(beam.BeamNumber, []):
        found |= inside(points)
    print(beam.BeamNumber, expected.sum(), (expected != found).sum())
