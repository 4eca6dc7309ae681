"""Reads a phantom's folder with nibabel, which shares no code with ours, and compares with geometry and the paper.

usage: phantom_oracle.py FOLDER, of the default size. Exit 0 agrees, 1 differs (says where), 77 nibabel is not installed.
"""
import json
import math
import sys

try:
    import nibabel
    import numpy
except ImportError:
    sys.exit(77)

folder = sys.argv[1]
failures = []


def check(is_right, what):
    if not is_right:
        failures.append(what)


def load(name):
    file = nibabel.load(f"{folder}/{name}")
    for code in ("sform_code", "qform_code"):
        check(int(file.header[code]) == 1, f"{name}: {code} is {file.header[code]}")
    check(numpy.allclose(file.get_sform(), file.get_qform(), atol=1e-4), f"{name}: sform and qform differ")
    check(file.header.get_xyzt_units()[0] == "mm", f"{name}: unit")
    return file, numpy.asanyarray(file.dataobj)


def voxel_ras(file, values):
    """World coordinates of the voxels where values holds, as n x 3."""
    return nibabel.affines.apply_affine(file.affine, numpy.argwhere(values))


ct, hu = load("ct.nii.gz")
check(hu.shape == (256, 256, 128) and hu.dtype == numpy.int16, f"ct: {hu.shape} {hu.dtype}")
check(nibabel.aff2axcodes(ct.affine) == ("L", "P", "S"), f"ct: {nibabel.aff2axcodes(ct.affine)}")
check(numpy.allclose(ct.header.get_zooms(), (1, 1, 1.6)), f"ct: spacing {ct.header.get_zooms()}")
# the field of view is centred: the mean of first and last voxel centre is the origin
ends = nibabel.affines.apply_affine(ct.affine, [[0, 0, 0], [255, 255, 127]])
check(numpy.allclose(ends.mean(axis=0), 0, atol=1e-4), f"ct: not centred, {ends}")
check(hu[0, 0, 0] == -1000, f"ct: air is {hu[0, 0, 0]}")

# the marker is the only thing above 1500 HU: at RAS x = -76, that is on the left
marker = voxel_ras(ct, hu > 1500)
check(len(marker) > 200 and marker[:, 0].max() < 0, "marker: not on the left")
check(numpy.allclose(marker.mean(axis=0), (-76, 0, 0), atol=0.3), f"marker: at {marker.mean(axis=0)}")

names = {entry["value"]: entry["name"] for entry in json.load(open(f"{folder}/labels.json"))["labels"]}
check(names == {1: "scalp", 2: "cranium", 3: "brain", 4: "target", 5: "tumour"}, f"labels.json: {names}")
labels_file, labels = load("labels.nii.gz")
check(labels.dtype == numpy.uint8 and set(numpy.unique(labels)) == {0, 1, 2, 3, 4, 5}, "labels: values")
check(numpy.array_equal(labels_file.affine, ct.affine), "labels: another grid than the image")
tumour = voxel_ras(labels_file, labels == 5).mean(axis=0)
check(numpy.allclose(tumour, (-24, -24, 34), atol=0.2), f"tumour: at {tumour}, not left, behind, above")
for label, expected in ((1, 60), (2, 950), (3, 38), (4, 35), (5, 48)):
    inside = hu[(labels == label) & (hu <= 1500)]
    check(abs(inside.mean() - expected) < 0.5, f"{names[label]}: {inside.mean()} HU, expected {expected}")
    check(4.5 < inside.std() < 5.5, f"{names[label]}: noise {inside.std()} HU")

table = {  # depth in mm: nitrogen, fast, gamma, boron per ppm (Goorley, Kiger, Zamenhof 2002)
    2: (.0913, .1404, .506, .0477), 10: (.1565, .1130, .726, .0793), 18: (.1974, .0812, .895, .0981),
    22: (.2056, .0687, .941, .1016), 26: (.2063, .0585, .970, .1015), 30: (.2011, .0500, .971, .0986),
    38: (.1781, .0372, .937, .0869), 50: (.1315, .0246, .800, .0639), 70: (.0654, .0131, .533, .0316),
    90: (.0279, .00708, .322, .0135), 110: (.0112, .00392, .192, .00539), 130: (.00411, .00217, .115, .00198)}
valid_file, valid = load("dose/valid.nii.gz")
for column, name in enumerate(("nitrogen", "fast", "gamma", "boron")):
    file, dose = load(f"dose/{name}.nii.gz")
    check(dose.dtype == numpy.float32 and dose.shape == valid.shape, f"{name}: {dose.dtype} {dose.shape}")
    check(numpy.all(dose[valid == 0] == 0) and numpy.all(dose[valid == 1] > 0), f"{name}: not zero exactly outside the mask")
    for depth, row in table.items():
        at = nibabel.affines.apply_affine(numpy.linalg.inv(file.affine), (0, 0, 88 - depth))
        check(numpy.allclose(at, numpy.round(at), atol=1e-4), f"{name}: depth {depth} is no cell's centre")
        found = float(dose[tuple(numpy.round(at).astype(int))])
        check(math.isclose(found, row[column], rel_tol=1e-6), f"{name} at {depth} mm: {found}, expected {row[column]}")
points = voxel_ras(valid_file, numpy.ones_like(valid)) / (73, 103, 88)
check(numpy.array_equal(valid.ravel() == 1, (points ** 2).sum(axis=1) <= 1), "valid: not the scalp's ellipsoid")

for failure in failures:
    print(failure)
sys.exit(1 if failures else 0)
