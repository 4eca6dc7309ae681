#!/usr/bin/python3
"""Triangle counts of vtkFlyingEdges3D on a mask of labels, independently of our code.

usage: vtk_counts.py FILE NX NY NZ LABELS...     FILE: bytes, [z][y][x], x fastest; LABELS: 3 or 3,4,5

Prints, for each set of labels, the count with the border of the grid left open and the count with one empty voxel around it.
Exit status 77: this machine has no VTK for Python.
"""
import sys

try:
    import numpy
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D
except ImportError as problem:
    print(problem)
    sys.exit(77)


def n_triangles(mask):
    image = vtkImageData()
    image.SetDimensions(mask.shape[2], mask.shape[1], mask.shape[0])
    values = numpy.ascontiguousarray(mask, dtype=numpy.uint8).ravel()
    image.GetPointData().SetScalars(numpy_to_vtk(values))
    edges = vtkFlyingEdges3D()
    edges.SetInputData(image)
    edges.SetValue(0, 0.5)
    edges.ComputeNormalsOff()
    edges.ComputeGradientsOff()
    edges.ComputeScalarsOff()
    edges.Update()
    return edges.GetOutput().GetNumberOfPolys()


def main():
    path, nx, ny, nz = sys.argv[1], *map(int, sys.argv[2:5])
    labels = numpy.fromfile(path, dtype=numpy.uint8).reshape(nz, ny, nx)
    for wanted in sys.argv[5:]:
        mask = numpy.isin(labels, [int(label) for label in wanted.split(",")])
        print(n_triangles(mask), n_triangles(numpy.pad(mask, 1)))


main()
