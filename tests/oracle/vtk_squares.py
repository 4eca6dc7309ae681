#!/usr/bin/python3
"""Marching squares by vtkContourFilter on the slices of a mask, independently of our code.

usage: vtk_squares.py FILE NX NY NZ     FILE: bytes 0 and 1, [z][y][x], x fastest

Prints, for each slice with one empty pixel around it, the number of different points and of segments, and the length of all of them.
Where two pixels touch at a corner VTK may join what others part: none of the three depends on it.
Exit status 77: this machine has no VTK for Python.
"""
import sys

try:
    import numpy
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkFiltersCore import vtkContourFilter
except ImportError as problem:
    print(problem)
    sys.exit(77)


def contour(mask):
    image = vtkImageData()
    image.SetDimensions(mask.shape[1], mask.shape[0], 1)
    values = numpy.ascontiguousarray(mask, dtype=numpy.float32).ravel()
    image.GetPointData().SetScalars(numpy_to_vtk(values))
    contours = vtkContourFilter()
    contours.SetInputData(image)
    contours.SetValue(0, 0.5)
    contours.Update()
    lines = contours.GetOutput()
    if lines.GetNumberOfLines() == 0:
        return 0, 0, 0.0
    points = vtk_to_numpy(lines.GetPoints().GetData())
    ends = vtk_to_numpy(lines.GetLines().GetConnectivityArray()).reshape(-1, 2)
    return len(numpy.unique(points, axis=0)), len(ends), numpy.linalg.norm(points[ends[:, 0]] - points[ends[:, 1]], axis=1).sum()


def main():
    nx, ny, nz = map(int, sys.argv[2:5])
    for mask in numpy.fromfile(sys.argv[1], dtype=numpy.uint8).reshape(nz, ny, nx):
        print("%d %d %.4f" % contour(numpy.pad(mask, 1)))


main()
