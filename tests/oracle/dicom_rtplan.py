"""Beams of RTPLAN files as pydicom sees them: FILE...; one line per beam, fields separated by tabs; nan for a missing value."""
import sys

try:
    import pydicom

    import rtplan_open
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
    return rtplan_open.points_of(beam, point).sum() * rtplan_open.STEP_MM**2 / 100


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
