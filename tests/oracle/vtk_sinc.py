#!/usr/bin/python3
"""Measures the error of the normals of a smoothed surface of an ellipsoid by VTK, independently of our code.

usage: vtk_sinc.py FILE NX NY NZ  DX DY DZ  X0 Y0 Z0  RX RY RZ  TILT
FILE: bytes, 0 or 1, [z][y][x]; spacing, place of the first voxel, radii in mm; tilted by TILT radians about x, then about y

The surface is vtkDiscreteFlyingEdges3D's, smoothed by vtkWindowedSincPolyDataFilter with 20 iterations and a pass band of 0.1. Prints
the root mean squares, over its area, of the angle in degrees and of the distance in mm. Exit status 77: no VTK for Python here.
"""
import sys

try:
    import numpy
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkFiltersCore import vtkWindowedSincPolyDataFilter
    from vtkmodules.vtkFiltersGeneral import vtkDiscreteFlyingEdges3D
except ImportError as problem:
    print(problem)
    sys.exit(77)

size = list(map(int, sys.argv[2:5]))
numbers = list(map(float, sys.argv[5:15]))
radii, tilt = numpy.array(numbers[6:9]), numbers[9]
image = vtkImageData()
image.SetDimensions(size)
image.SetSpacing(numbers[0:3])
image.SetOrigin(numbers[3:6])
image.GetPointData().SetScalars(numpy_to_vtk(numpy.fromfile(sys.argv[1], dtype=numpy.uint8), deep=1))
edges = vtkDiscreteFlyingEdges3D()
edges.SetInputData(image)
edges.SetValue(0, 1)
edges.ComputeNormalsOff()
smooth = vtkWindowedSincPolyDataFilter()
smooth.SetInputConnection(edges.GetOutputPort())
smooth.SetNumberOfIterations(20)
smooth.SetPassBand(0.1)
smooth.BoundarySmoothingOff()
smooth.FeatureEdgeSmoothingOff()
smooth.NonManifoldSmoothingOn()
smooth.NormalizeCoordinatesOn()
smooth.Update()
points = vtk_to_numpy(smooth.GetOutput().GetPoints().GetData()).astype(float)
triangles = vtk_to_numpy(smooth.GetOutput().GetPolys().GetConnectivityArray()).reshape(-1, 3)
a, b, c = (points[triangles[:, corner]] for corner in range(3))
cross = numpy.cross(b - a, c - a)
area = numpy.linalg.norm(cross, axis=1)
good = area > 0
cos, sin = numpy.cos(tilt), numpy.sin(tilt)
to_body = numpy.array([[cos, 0, -sin], [0, 1, 0], [sin, 0, cos]]) @ numpy.array([[1, 0, 0], [0, cos, -sin], [0, sin, cos]])
place = ((a + b + c) / 3)[good] @ to_body.T
gradient = place / radii**2
length = numpy.linalg.norm(gradient, axis=1)
distance = ((place * gradient).sum(1) - 1) / (2 * length)
cosine = (cross[good] / area[good][:, None] * ((gradient / length[:, None]) @ to_body)).sum(1)
cosine *= numpy.sign((cosine * area[good]).sum())
angle = numpy.degrees(numpy.arccos(numpy.clip(cosine, -1, 1)))
print(*(repr(float(numpy.sqrt((area[good] * off**2).sum() / area[good].sum()))) for off in (angle, distance)))
