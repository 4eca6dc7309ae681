#!/usr/bin/python3
"""Reads a folder of DICOM slices with pydicom and numpy, independently of our code.

usage: dicom_series.py FOLDER OUT      every image series below FOLDER, in the order of their UIDs, voxels to OUT.0, OUT.1, ...

Prints a line per series: its UID, number of columns, rows and slices, and the index-to-patient matrix in LPS (12, column by column, origin
last). OUT.n holds the values after rescale as 64-bit numbers, x fastest. Exit status 77: this machine has no pydicom.
"""
import os
import sys
import warnings

try:
    import numpy
    import pydicom
except ImportError as problem:
    print(problem)
    sys.exit(77)
warnings.simplefilter("ignore")


def series_below(folder):
    found = {}
    for where, _, names in sorted(os.walk(folder)):
        for name in sorted(names):
            try:
                one = pydicom.dcmread(os.path.join(where, name))
            except Exception:
                continue
            if "ImagePositionPatient" in one and "PixelData" in one and one.Modality in ("CT", "MR", "PT"):
                found.setdefault(str(one.SeriesInstanceUID), []).append(one)
    return found


def tell(uid, slices, out):
    row, column = numpy.array(slices[0].ImageOrientationPatient, float).reshape(2, 3)
    normal = numpy.cross(row, column)
    slices.sort(key=lambda one: float(numpy.dot(normal, numpy.array(one.ImagePositionPatient, float))))
    first, last = (numpy.array(slices[at].ImagePositionPatient, float) for at in (0, -1))
    between_rows, between_columns = (float(value) for value in slices[0].PixelSpacing)
    step = (last - first) / (len(slices) - 1) if len(slices) > 1 else normal * float(slices[0].SliceThickness)
    matrix = numpy.concatenate([row * between_columns, column * between_rows, step, first])
    values = numpy.stack([one.pixel_array.astype(float) * float(getattr(one, "RescaleSlope", 1)) + float(getattr(one, "RescaleIntercept", 0))
                          for one in slices])
    values.astype("<f8").tofile(out)
    print(uid, values.shape[2], values.shape[1], values.shape[0], *[repr(float(number)) for number in matrix])


for number, (series, members) in enumerate(sorted(series_below(sys.argv[1]).items())):
    tell(series, members, f"{sys.argv[2]}.{number}")
