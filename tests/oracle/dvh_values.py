#!/usr/bin/python3
"""Figures of dose-volume histograms with numpy, from the files of a plan folder, independently of our code.

usage: dvh_values.py eclipse FOLDER    the set eclipse-ent-dose: an NRRD dose and NIfTI masks; with the table of the planning program
       dvh_values.py openkbp FOLDER    the set openkbp-pt99: NIfTI

Prints a line per structure: name, univels, then mean, min, max, D98%, D95%, D50%, D2%, and V20 in %, of the sorted trilinear values at
the centres; and, for eclipse, mean, D95%, D50%, D2% and the volume in cm3 of the table (else 0). Exit status 77: no numpy or nibabel here.
"""
import csv
import glob
import gzip
import os
import re
import sys

try:
    import nibabel
    import numpy
except ImportError as problem:
    print(problem)
    sys.exit(77)


def read_nrrd(path):
    """Values [x][y][z] and the LPS matrix of a gzipped float NRRD."""
    data = open(path, 'rb').read()
    at = data.index(b'\n\n')
    head = dict(line.split(': ', 1) for line in data[:at].decode().splitlines() if ': ' in line)
    sizes = [int(word) for word in head['sizes'].split()]
    vectors = re.findall(r'\(([^)]*)\)', head['space directions'] + head['space origin'])
    matrix = numpy.eye(4)
    for column, vector in enumerate(vectors):
        matrix[:3, column] = [float(word) for word in vector.split(',')]
    values = numpy.frombuffer(gzip.decompress(data[at + 2:]), '<f4').reshape(sizes[::-1]).T
    return values.astype(float), matrix


def read_nifti(path):
    image = nibabel.load(path)
    return numpy.asarray(image.get_fdata()), numpy.diag([-1.0, -1.0, 1.0, 1.0]) @ image.affine


def trilinear(values, at):
    """Values at index positions [n][3], all inside the outer voxels' centres up to rounding."""
    at = numpy.clip(at, 0, numpy.array(values.shape) - 1.0)
    low = numpy.minimum(at.astype(int), numpy.maximum(numpy.array(values.shape) - 2, 0))
    rest = at - low
    total = 0
    for corner in numpy.ndindex(2, 2, 2):
        share = numpy.prod(numpy.where(corner, rest, 1 - rest), axis=1)
        index = low + numpy.array(corner)
        total = total + share * values[index[:, 0], index[:, 1], index[:, 2]]
    return total


def table_of(folder):
    """Per structure the curve of the planning program: doses, percents, volume."""
    rows = list(csv.reader(open(os.path.join(folder, 'EclipseEnt_DvhTable_Eclipse.csv'))))
    tables = {}
    for column in range(0, len(rows[0]) - 1, 2):
        name = rows[0][column].split('_DvhArray')[0]
        points = [(float(r[column]), float(r[column + 1])) for r in rows[1:] if len(r) > column + 1 and r[column] and r[column + 1]]
        volume = float(re.search(r'of ([0-9.]+) cc', rows[0][column + 1]).group(1))
        tables[name] = (*map(numpy.array, zip(*points)), volume)
    return tables


def table_figures(table):
    doses, percents, volume = table
    parts = percents[:-1] - percents[1:]
    mean = (parts * (doses[:-1] + doses[1:]) / 2).sum() / parts.sum()
    return [mean, *(numpy.interp(-share, -percents, doses) for share in (95, 50, 2)), volume]


kind, folder = sys.argv[1:3]
if kind == 'eclipse':
    dose, matrix = read_nrrd(os.path.join(folder, 'EclipseEnt_Dose.nrrd'))
    tables = table_of(folder)
else:
    dose, matrix = read_nifti(os.path.join(folder, 'dose.nii.gz'))
    tables = {}
for path in sorted(glob.glob(os.path.join(folder, 'struct', '*.nii.gz'))):
    name = os.path.basename(path)[:-7]
    mask, place = read_nifti(path)
    inside = numpy.argwhere(mask > 0)
    points = numpy.linalg.inv(matrix) @ place @ numpy.c_[inside, numpy.ones(len(inside))].T
    values = numpy.sort(trilinear(dose, points[:3].T))
    ranked = [values[len(values) - max(1, int(numpy.ceil(share / 100 * len(values))))] for share in (98, 95, 50, 2)]
    words = [name, len(values), values.mean(), values[0], values[-1], *ranked, 100 * (values >= 20).mean()]
    words += table_figures(tables[name]) if name in tables else [0] * 5
    print(*words)
