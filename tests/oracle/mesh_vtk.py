#!/usr/bin/python3
"""Reads STL, PLY and GLB files with VTK, independently of our code.

usage: mesh_vtk.py FILE...     the ending says the format

Prints a line per file: triangles, area, enclosed volume, then the smallest and largest x, y and z, in the file's own unit and
axes; a GLB's with the matrices of its nodes. Exit status 77: this machine has no VTK for Python.
"""
import sys

try:
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline  # noqa: F401, registers the pipeline
    from vtkmodules.vtkFiltersCore import vtkMassProperties, vtkTriangleFilter
    from vtkmodules.vtkFiltersGeometry import vtkCompositeDataGeometryFilter
    from vtkmodules.vtkIOGeometry import vtkGLTFReader, vtkSTLReader
    from vtkmodules.vtkIOPLY import vtkPLYReader
except ImportError as problem:
    print(problem)
    sys.exit(77)


def read(path):
    ending = path.rsplit(".", 1)[1]
    reader = {"stl": vtkSTLReader, "ply": vtkPLYReader, "glb": vtkGLTFReader}[ending]()
    reader.SetFileName(path)
    if ending == "glb":
        flat = vtkCompositeDataGeometryFilter()
        flat.SetInputConnection(reader.GetOutputPort())
        reader = flat
    triangles = vtkTriangleFilter()
    triangles.SetInputConnection(reader.GetOutputPort())
    triangles.Update()
    return triangles.GetOutput()


for name in sys.argv[1:]:
    surface = read(name)
    mass = vtkMassProperties()
    mass.SetInputData(surface)
    low_high = surface.GetBounds()
    print(surface.GetNumberOfPolys(), repr(mass.GetSurfaceArea()), repr(mass.GetVolume()), *map(repr, low_high[0::2] + low_high[1::2]))
