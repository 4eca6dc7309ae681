#!/usr/bin/python3
"""The other side of bench_isosurface.c: times vtkFlyingEdges3D on a field of floats when asked, so that both sides run in turn.

usage: vtk_isosurface.py FILE N     FILE: floats, [z][y][x], N each

First prints VTK's version. Then, for each line "LEVEL NORMALS" on the standard input (1 with normals, 0 without), prints
"MILLISECONDS TRIANGLES" of one thread. Exit status 77: no VTK for Python here.
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

side = int(sys.argv[2])
image = vtkImageData()
image.SetDimensions(side, side, side)
image.GetPointData().SetScalars(numpy_to_vtk(numpy.fromfile(sys.argv[1], dtype=numpy.float32), deep=1))
edges = vtkFlyingEdges3D()
edges.SetInputData(image)
edges.ComputeGradientsOff()
edges.ComputeScalarsOff()
vtkSMPTools.SetBackend("Sequential")
print(vtkVersion.GetVTKVersion(), flush=True)
for line in sys.stdin:
    words = line.split()
    edges.SetValue(0, float(words[0]))
    edges.SetComputeNormals(int(words[1]))
    edges.Modified()
    began = time.perf_counter()
    edges.Update()
    print((time.perf_counter() - began) * 1e3, edges.GetOutput().GetNumberOfPolys(), flush=True)
