"""Compares outlines with the opening that jaws and leaves of an RTPLAN leave at the first control point, on points half a mm
apart: PLAN OUTLINES, a text with a line for each polygon: beam number, then x and y of its points. Prints for each beam its
number, the open points, and those that are open and outside of every polygon, or the other way round."""
import sys

try:
    import numpy
    import pydicom
except ImportError:
    sys.exit(77)

Y, X = numpy.meshgrid(*[numpy.arange(-299.75, 300, 0.5)] * 2, indexing="ij")


def open_of(beam, point):
    is_open = numpy.ones(X.shape, bool)
    bounds = {d.RTBeamLimitingDeviceType: d.get("LeafPositionBoundaries") for d in beam.BeamLimitingDeviceSequence}
    for device in point.get("BeamLimitingDevicePositionSequence", []):
        kind, at = device.RTBeamLimitingDeviceType, numpy.array(device.LeafJawPositions, float)
        along, across = (X, Y) if kind.endswith("X") else (Y, X)
        if kind.startswith("MLC"):
            pair = numpy.searchsorted(numpy.array(bounds[kind], float), across, side="right") - 1
            n = len(at) // 2
            held = (pair >= 0) & (pair < n)
            pair = pair.clip(0, n - 1)
            is_open &= held & (along >= at[pair]) & (along < at[n + pair])
        else:
            is_open &= (along >= at[0]) & (along < at[1])
    return is_open


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
    expected, found = open_of(beam, beam.ControlPointSequence[0]), numpy.zeros(X.shape, bool)
    for points in polygons.get(beam.BeamNumber, []):
        found |= inside(points)
    print(beam.BeamNumber, expected.sum(), (expected != found).sum())
