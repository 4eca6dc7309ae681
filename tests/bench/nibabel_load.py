"""Unpacks every NIfTI volume of a plan folder to arrays, nine times; prints the median time in milliseconds."""
import glob
import statistics
import sys
import time

import nibabel
import numpy

files = sorted(glob.glob(sys.argv[1] + "/**/*.nii.gz", recursive=True))
times = []
for _ in range(9):
    began = time.perf_counter()
    volumes = [numpy.asanyarray(nibabel.load(file).dataobj) for file in files]
    times.append((time.perf_counter() - began) * 1e3)
print(statistics.median(times))
