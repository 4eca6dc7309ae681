#!/usr/bin/python3
"""Compares a surface of a field of floats with vtkFlyingEdges3D's, independently of our code.

usage: vtk_field.py FIELD VERTICES NX NY NZ ISO     FIELD: floats, [z][y][x]; VERTICES: floats, x y z, in voxels

Prints VTK's number of triangles and of vertices, and the largest distance of one of our vertices from the nearest of VTK's and the
other way round. Exit status 77: this machine has no VTK for Python.
"""
import sys

try:
    import numpy
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPolyData, vtkStaticPointLocator
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D
except ImportError as problem:
    print(problem)
    sys.exit(77)


def farthest(points, others):
    data = vtkPolyData()
    cloud = vtkPoints()
    cloud.SetData(numpy_to_vtk(numpy.ascontiguousarray(others, dtype=numpy.float64), deep=1))
    data.SetPoints(cloud)
    locator = vtkStaticPointLocator()
    locator.SetDataSet(data)
    locator.BuildLocator()
    return max(float(numpy.linalg.norm(others[locator.FindClosestPoint(point)] - point)) for point in points)


field, ours = numpy.fromfile(sys.argv[1], dtype=numpy.float32), numpy.fromfile(sys.argv[2], dtype=numpy.float32).reshape(-1, 3)
image = vtkImageData()
image.SetDimensions(*map(int, sys.argv[3:6]))
image.GetPointData().SetScalars(numpy_to_vtk(field, deep=1))
edges = vtkFlyingEdges3D()
edges.SetInputData(image)
edges.SetValue(0, float(sys.argv[6]))
edges.ComputeNormalsOff()
edges.ComputeGradientsOff()
edges.ComputeScalarsOff()
edges.Update()
theirs = vtk_to_numpy(edges.GetOutput().GetPoints().GetData()).astype(numpy.float64)
ours = ours.astype(numpy.float64)
print(edges.GetOutput().GetNumberOfPolys(), len(theirs), repr(farthest(ours, theirs)), repr(farthest(theirs, ours)))
