"""Regions of RTSTRUCT files as pydicom and numpy see them: FILE...; one line per region, fields separated by tabs."""
import sys

try:
    import numpy
    import pydicom
except ImportError:
    sys.exit(77)


def area_mm2(points):
    """By the shoelace formula in space."""
    from_first = points - points[0]
    return numpy.linalg.norm(numpy.cross(from_first[:-1], from_first[1:]).sum(axis=0)) / 2


for path in sys.argv[1:]:
    data = pydicom.dcmread(path, force=True)
    kinds = {o.ReferencedROINumber: o.get("RTROIInterpretedType", "") for o in data.get("RTROIObservationsSequence", [])}
    drawn = {c.ReferencedROINumber: c for c in data.ROIContourSequence}
    for roi in data.StructureSetROISequence:
        item = drawn.get(roi.ROINumber)
        contours = [numpy.array(c.ContourData, dtype=float).reshape(-1, 3) for c in item.get("ContourSequence", [])] if item else []
        if not contours:
            continue
        points = numpy.concatenate(contours)
        color = item.get("ROIDisplayColor") or [-1, -1, -1]
        print(roi.ROINumber, roi.ROIName, kinds.get(roi.ROINumber) or "-", *color, len(contours), len(points),
              *[repr(float(v)) for v in points.sum(axis=0)], repr(float(sum(area_mm2(c) for c in contours))),
              roi.get("ReferencedFrameOfReferenceUID") or "-", sep="\t")
