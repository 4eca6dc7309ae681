#!/usr/bin/python3
"""The other side of bench_smooth.c: times VTK when asked, so that both sides run in turn.

usage: vtk_smooth.py FILE NX NY NZ N     FILE: bytes, [z][y][x]; labels 1 to N, each a region

First prints VTK's version and number of threads. Then, for each line on the standard input, extracts and smooths all N regions anew
and prints "EXTRACT_MS SMOOTH_MS PROCESSOR_MS TRIANGLES": vtkDiscreteFlyingEdges3D with N values, then vtkWindowedSincPolyDataFilter with 20
iterations and its pass band of 0.1. One layer of zeros around the labels, put there beforehand, closes what the grid cuts.
Exit status 77: no VTK for Python here.
"""
import sys
import time

try:
    import numpy
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonCore import vtkSMPTools, vtkVersion
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkFiltersCore import vtkWindowedSincPolyDataFilter
    from vtkmodules.vtkFiltersGeneral import vtkDiscreteFlyingEdges3D
except ImportError:
    sys.exit(77)

path, nx, ny, nz, n = sys.argv[1], *map(int, sys.argv[2:6])
labels = numpy.pad(numpy.fromfile(path, dtype=numpy.uint8).reshape(nz, ny, nx), 1)
image = vtkImageData()
image.SetDimensions(nx + 2, ny + 2, nz + 2)
image.SetSpacing(0.6, 0.6, 1.5)
image.GetPointData().SetScalars(numpy_to_vtk(labels.ravel(), deep=1))
edges = vtkDiscreteFlyingEdges3D()
edges.SetInputData(image)
edges.GenerateValues(n, 1, n)
edges.ComputeNormalsOff()
edges.ComputeGradientsOff()
edges.ComputeScalarsOff()
smooth = vtkWindowedSincPolyDataFilter()
smooth.SetInputConnection(edges.GetOutputPort())
smooth.SetNumberOfIterations(20)
smooth.SetPassBand(0.1)
smooth.BoundarySmoothingOff()
smooth.FeatureEdgeSmoothingOff()
smooth.NonManifoldSmoothingOn()
smooth.NormalizeCoordinatesOn()
print(vtkVersion.GetVTKVersion(), vtkSMPTools.GetEstimatedNumberOfThreads(), flush=True)
for line in sys.stdin:
    edges.Modified()
    began, busy = time.perf_counter(), time.process_time()
    edges.Update()
    extracted = time.perf_counter()
    smooth.Update()
    ended = time.perf_counter()
    print((extracted - began) * 1e3, (ended - extracted) * 1e3, (time.process_time() - busy) * 1e3,
          smooth.GetOutput().GetNumberOfPolys(), flush=True)
