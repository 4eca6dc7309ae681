"""Reads a folder of DICOM-RT files with pydicom and numpy: rt_plan.py FOLDER. Prints lines of tab-separated fields:
dose, largest value, patient point (3), value there: twenty voxels of every dose that is not all zero
beam, name, isocentre (3), gantry angle
region, name, cm3: polygon areas times the distance of planes, for regions whose planes hold one contour each
Exit status 77: no pydicom here."""
import os
import sys

try:
    import numpy
    import pydicom
except ImportError:
    sys.exit(77)


def doses(one):
    values = one.pixel_array.astype(float) * float(one.DoseGridScaling)
    if values.max() == 0:
        return
    row, column = numpy.array(one.ImageOrientationPatient[:3], float), numpy.array(one.ImageOrientationPatient[3:], float)
    origin, spacing = numpy.array(one.ImagePositionPatient, float), [float(v) for v in one.PixelSpacing]
    offsets = [float(v) for v in one.GridFrameOffsetVector]
    random = numpy.random.default_rng(11)
    for _ in range(20):
        k, j, i = (int(random.integers(0, n)) for n in values.shape)
        point = origin + row * spacing[1] * i + column * spacing[0] * j + numpy.cross(row, column) * (offsets[k] - offsets[0])
        print("dose", repr(float(values.max())), *(repr(float(v)) for v in point), repr(float(values[k, j, i])), sep="\t")


def beams(one):
    for beam in one.BeamSequence:
        point = beam.ControlPointSequence[0]
        print("beam", beam.BeamName, *(repr(float(v)) for v in point.IsocenterPosition), repr(float(point.GantryAngle)), sep="\t")


def regions(one):
    names = {roi.ROINumber: roi.ROIName for roi in one.StructureSetROISequence}
    for roi in one.ROIContourSequence:
        areas = {}
        for contour in roi.get("ContourSequence", []):
            points = numpy.array(contour.ContourData, float).reshape(-1, 3)
            x, y = points[:, 0], points[:, 1]
            areas.setdefault(round(points[0, 2], 2), []).append(abs(numpy.dot(x, numpy.roll(y, 1)) - numpy.dot(y, numpy.roll(x, 1))) / 2)
        if len(areas) < 2 or any(len(plane) > 1 for plane in areas.values()):
            continue
        planes = sorted(areas)
        pitch = numpy.median(numpy.diff(planes))
        print("region", names[roi.ReferencedROINumber], repr(float(sum(plane[0] for plane in areas.values()) * pitch / 1000)), sep="\t")


for path, _, names in os.walk(sys.argv[1]):
    for name in sorted(names):
        try:
            one = pydicom.dcmread(os.path.join(path, name))
        except Exception:
            continue
        {"RTDOSE": doses, "RTPLAN": beams, "RTSTRUCT": regions}.get(one.get("Modality"), lambda _: None)(one)
