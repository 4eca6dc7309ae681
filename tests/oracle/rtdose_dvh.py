#!/usr/bin/python3
"""Gives the RT Dose objects of the set dicomrt-oncentra-phantom stored histograms (DVH Sequence), computed with numpy.

usage: rtdose_dvh.py FOLDER     a copy of the set; its RTDOSE files are written anew

The dose of each structure is that at the centres of the image's pixels whose slice has a contour around them (even-odd), trilinear.
Cumulative curves in cm3, bins of 1/500 of the dose's maximum; mean, minimum and maximum for the odd ROI numbers only, so that the others' mean comes
from the curve. Prints "FILE ROI MEAN" lines. Exit status 77: no pydicom or numpy here.
"""
import glob
import os
import sys

try:
    import numpy
    import pydicom
    from pydicom.dataset import Dataset
    from pydicom.sequence import Sequence
except ImportError as problem:
    print(problem)
    sys.exit(77)

folder = sys.argv[1]
objects = {}
for path in glob.glob(os.path.join(folder, '*')):
    try:
        dataset = pydicom.dcmread(path)
    except Exception:
        continue
    objects.setdefault(dataset.Modality, []).append((path, dataset))
images = sorted((d for _, d in objects['CT']), key=lambda d: float(d.ImagePositionPatient[2]))
structs = objects['RTSTRUCT'][0][1]
first = images[0]
xs = float(first.ImagePositionPatient[0]) + numpy.arange(first.Columns) * float(first.PixelSpacing[1])
ys = float(first.ImagePositionPatient[1]) + numpy.arange(first.Rows) * float(first.PixelSpacing[0])
X, Y = numpy.meshgrid(xs, ys)


def inside(points):
    odd = numpy.zeros(X.shape, bool)
    for (ax, ay), (bx, by) in zip(points, numpy.roll(points, -1, axis=0)):
        if ay != by:
            odd ^= ((ay > Y) != (by > Y)) & (X < ax + (Y - ay) * (bx - ax) / (by - ay))
    return odd


def points_of(roi):
    found = []
    for image in images:
        z = float(image.ImagePositionPatient[2])
        mask = numpy.zeros(X.shape, bool)
        for contour in roi.ContourSequence:
            data = numpy.array(contour.ContourData, float).reshape(-1, 3)
            if contour.ContourGeometricType == 'CLOSED_PLANAR' and abs(data[0, 2] - z) < 1:
                mask ^= inside(data[:, :2])
        found.append(numpy.c_[X[mask], Y[mask], numpy.full(mask.sum(), z)])
    return numpy.concatenate(found)


def values_at(dose, points):
    values = dose.pixel_array.astype(float) * float(dose.DoseGridScaling)
    origin, spacing = numpy.array(dose.ImagePositionPatient, float), dose.PixelSpacing
    offsets = numpy.array(dose.GridFrameOffsetVector, float)
    at = numpy.c_[(points[:, 2] - origin[2] - offsets[0]) / (offsets[1] - offsets[0]), (points[:, 1] - origin[1]) / float(spacing[0]), (points[:, 0] - origin[0]) / float(spacing[1])]
    size = numpy.array(values.shape)
    known = ((at >= -0.5) & (at < size - 0.5)).all(axis=1)
    at = numpy.clip(at[known], 0, size - 1)
    low = numpy.minimum(at.astype(int), size - 2)
    rest = at - low
    return sum(numpy.prod(numpy.where(c, rest, 1 - rest), axis=1) * values[tuple((low + numpy.array(c)).T)] for c in numpy.ndindex(2, 2, 2))


for path, dose in objects['RTDOSE']:
    items = []
    for roi in structs.ROIContourSequence:
        points = points_of(roi) if 'ContourSequence' in roi else []
        values = values_at(dose, points) if len(points) else numpy.zeros(0)
        if len(values) == 0 or values.max() <= 0:
            continue
        width = values.max() / 500
        cm3 = abs(float(first.PixelSpacing[0]) * float(first.PixelSpacing[1]) * (float(images[1].ImagePositionPatient[2]) - float(images[0].ImagePositionPatient[2]))) / 1000
        above = [(values >= bin * width).sum() * cm3 for bin in range(501)]
        item = Dataset()
        item.DVHType, item.DoseUnits, item.DoseType, item.DVHDoseScaling, item.DVHVolumeUnits = 'CUMULATIVE', 'GY', 'PHYSICAL', '1', 'CM3'
        item.DVHNumberOfBins = 501
        item.DVHData = [f'{number:.8g}' for pair in ((width, volume) for volume in above) for number in pair]
        reference = Dataset()
        reference.DVHROIContributionType, reference.ReferencedROINumber = 'INCLUDED', roi.ReferencedROINumber
        item.DVHReferencedROISequence = Sequence([reference])
        if int(roi.ReferencedROINumber) % 2:
            item.DVHMinimumDose, item.DVHMaximumDose, item.DVHMeanDose = (f'{v:.8g}' for v in (values.min(), values.max(), values.mean()))
        items.append(item)
        print(os.path.basename(path), int(roi.ReferencedROINumber), values.mean(), len(values))
    if items:
        dose.DVHSequence = Sequence(items)
        dose.save_as(path)
