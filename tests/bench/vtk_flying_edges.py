#!/usr/bin/python3
"""The other side of bench_surface.c: times vtkFlyingEdges3D when asked, so that both sides run in turn.

usage: vtk_flying_edges.py FILE NX NY NZ LABELS...     FILE: bytes, [z][y][x]; LABELS: 3 or 3,4,5

First prints VTK's version and number of threads. Then, for each line "SET NORMALS SEQUENTIAL" on the standard input (the number
of a set of labels; 1 with normals, 0 without; 1 on one thread, 0 on all), prints "MILLISECONDS TRIANGLES". The masks are made and
padded by one empty voxel beforehand: only the filter is timed. Exit status 77: no VTK for Python here.
"""
import sys
import time

try:
    import numpy
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonCore import vtkSMPTools, vtkVersion
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D
except ImportError:
    sys.exit(77)


def make_filter(mask, with_normals):
    image = vtkImageData()
    image.SetDimensions(mask.shape[2], mask.shape[1], mask.shape[0])
    image.GetPointData().SetScalars(numpy_to_vtk(mask.ravel(), deep=1))
    edges = vtkFlyingEdges3D()
    edges.SetInputData(image)
    edges.SetValue(0, 0.5)
    edges.SetComputeNormals(with_normals)
    edges.ComputeGradientsOff()
    edges.ComputeScalarsOff()
    return edges


def main():
    path, nx, ny, nz = sys.argv[1], *map(int, sys.argv[2:5])
    labels = numpy.fromfile(path, dtype=numpy.uint8).reshape(nz, ny, nx)
    filters = []
    for wanted in sys.argv[5:]:
        mask = numpy.pad(numpy.isin(labels, [int(label) for label in wanted.split(",")]), 1).astype(numpy.uint8)
        filters.append([make_filter(mask, with_normals) for with_normals in (0, 1)])
    backends = vtkSMPTools.GetBackend(), "Sequential"
    print(vtkVersion.GetVTKVersion(), vtkSMPTools.GetEstimatedNumberOfThreads(), flush=True)
    for line in sys.stdin:
        which, with_normals, sequential = map(int, line.split())
        vtkSMPTools.SetBackend(backends[sequential])
        edges = filters[which][with_normals]
        edges.Modified()
        began = time.perf_counter()
        edges.Update()
        print((time.perf_counter() - began) * 1e3, edges.GetOutput().GetNumberOfPolys(), flush=True)


main()
