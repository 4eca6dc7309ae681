"""The opening that jaws and leaves of an RTPLAN beam leave in the isocentre plane, counted on points; other scripts import it."""
import numpy

STEP_MM = 0.5
Y, X = numpy.meshgrid(*[numpy.arange(-300 + STEP_MM / 2, 300, STEP_MM)] * 2, indexing="ij")


def points_of(beam, point):
    """Which points are open at a control point."""
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
