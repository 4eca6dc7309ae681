#!/usr/bin/python3
"""Reads NIfTI files with nibabel, independently of our code.

usage: nifti_values.py make FOLDER     writes files of every data type, byte order, version and many orientations, and reads them
       nifti_values.py pairs FOLDER    the same as pairs of .hdr and .img; the name of either stands in the line
       nifti_values.py FILE...

Prints a line per file: name, size (3), index-to-patient matrix in LPS (12, column by column, origin last), smallest and
largest value, and the values at five voxels: i j k value. Exit status 77: this machine has no nibabel.
"""
import sys

try:
    import nibabel
    import numpy
except ImportError as problem:
    print(problem)
    sys.exit(77)


def tell(path):
    image = nibabel.load(path)
    values = numpy.asarray(image.get_fdata(dtype=numpy.float64))
    values = values.reshape(values.shape + (1,) * (3 - values.ndim))[..., :].reshape((list(values.shape) + [1, 1, 1])[:3])
    lps = numpy.diag([-1.0, -1.0, 1.0, 1.0]) @ image.affine
    finite = values[numpy.isfinite(values)]
    words = [path, *values.shape]
    words += [repr(float(lps[row, column])) for column in range(4) for row in range(3)]
    words += [repr(float(finite.min())), repr(float(finite.max()))]
    random = numpy.random.default_rng(7)
    for _ in range(5):
        at = tuple(int(random.integers(0, side)) for side in values.shape)
        words += [*at, repr(float(values[at]))]
    print(*words)


def rotation(random):
    turn, _ = numpy.linalg.qr(random.normal(size=(3, 3)))
    return turn


def make(folder, versions, endings):
    random = numpy.random.default_rng(3)
    names = []
    for number, kind in enumerate(["u1", "i1", "i2", "u2", "i4", "u4", "i8", "u8", "f4", "f8"]):
        for order in "<>":
            for version in versions:
                affine = numpy.eye(4)
                affine[:3, :3] = rotation(random) @ numpy.diag(random.uniform(0.4, 5, 3))
                affine[:3, 3] = random.uniform(-200, 200, 3)
                low, high = (-3.0, 3.0) if kind[0] == "f" else (0 if kind[0] == "u" else -100, 120)
                values = random.uniform(low, high, (5, 4, 3)).astype(order + kind)
                header = version.header_class(endianness=order)
                header.set_data_dtype(values.dtype)
                image = version(values, affine, header)
                image.set_sform(affine, 1 if number % 2 else 0)
                image.set_qform(affine, 1)
                if number % 3 == 0:
                    image.header.set_slope_inter(-0.25, 7)
                name = f"{folder}/{kind}-{'little' if order == '<' else 'big'}-{version.__name__}{endings[len(names) % len(endings)]}" + (".gz" if number % 2 else "")
                nibabel.save(image, name)
                names.append(name)
    return names


if sys.argv[1] == "make":
    files = make(sys.argv[2], (nibabel.Nifti1Image, nibabel.Nifti2Image), [".nii"])
elif sys.argv[1] == "pairs":
    files = make(sys.argv[2], (nibabel.Nifti1Pair, nibabel.Nifti2Pair), [".img", ".hdr", ".hdr"])
else:
    files = sys.argv[1:]
for name in files:
    tell(name)
