"""Beams of RTPLAN files as pydicom sees them: FILE...; one line per beam, fields separated by tabs; nan for a missing value."""
import sys

try:
    import numpy
    import pydicom
except ImportError:
    sys.exit(77)


def number(item, keyword):
    value = item.get(keyword)
    return repr(float(value)) if value not in (None, "") else "nan"


def jaws(point, kinds):
    for device in point.get("BeamLimitingDevicePositionSequence", []):
        if device.RTBeamLimitingDeviceType in kinds:
            return [repr(float(v)) for v in device.LeafJawPositions]
    return ["nan", "nan"]


def area_cm2(beam, point):
    """Of the opening that jaws and leaves leave, counted on points half a mm apart."""
    y, x = numpy.meshgrid(*[numpy.arange(-299.75, 300, 0.5)] * 2, indexing="ij")
    is_open = numpy.ones(x.shape, bool)
    bounds = {d.RTBeamLimitingDeviceType: d.get("LeafPositionBoundaries") for d in beam.BeamLimitingDeviceSequence}
    for device in point.get("BeamLimitingDevicePositionSequence", []):
        kind, at = device.RTBeamLimitingDeviceType, numpy.array(device.LeafJawPositions, float)
        along, across = (x, y) if kind.endswith("X") else (y, x)
        if kind.startswith("MLC"):
            pair = numpy.searchsorted(numpy.array(bounds[kind], float), across, side="right") - 1
            n = len(at) // 2
            held = (pair >= 0) & (pair < n)
            pair = pair.clip(0, n - 1)
            is_open &= held & (along >= at[pair]) & (along < at[n + pair])
        else:
            is_open &= (along >= at[0]) & (along < at[1])
    return is_open.sum() / 400


for path in sys.argv[1:]:
    data = pydicom.dcmread(path, force=True)
    doses = {r.ReferencedBeamNumber: r for g in data.FractionGroupSequence for r in g.ReferencedBeamSequence}
    setups = {s.PatientSetupNumber: s.get("PatientPosition", "") for s in data.get("PatientSetupSequence", [])}
    for beam in data.BeamSequence:
        points = beam.ControlPointSequence
        dose = doses.get(beam.BeamNumber, {})
        last = [p.GantryAngle for p in points if "GantryAngle" in p][-1]
        print(beam.BeamNumber, beam.get("BeamName") or "-", beam.get("RadiationType", "-"), len(points),
              *[repr(float(v)) for v in points[0].IsocenterPosition], number(points[0], "GantryAngle"), repr(float(last)),
              number(points[0], "BeamLimitingDeviceAngle"), number(points[0], "PatientSupportAngle"), number(points[0], "NominalBeamEnergy"),
              number(beam, "SourceAxisDistance"), number(points[0], "SourceToSurfaceDistance"),
              *jaws(points[0], ("X", "ASYMX")), *jaws(points[0], ("Y", "ASYMY")), repr(float(area_cm2(beam, points[0]))),
              number(dose, "BeamDose"), number(dose, "BeamMeterset"), data.FractionGroupSequence[0].get("NumberOfFractionsPlanned", 0),
              setups.get(beam.get("ReferencedPatientSetupNumber"), "-") or "-", sep="\t")
