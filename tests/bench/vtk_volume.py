#!/usr/bin/python3
"""The other side of bench_volume.c: times VTK's volume mappers when asked, so that both sides run in turn.

usage: vtk_volume.py SETUP.json

SETUP.json: {"file": "raw voxels, [z][y][x]", "type": "int16", "size": [nx, ny, nz], "spacing_mm": [x, y, z], "origin_mm": [x, y, z],
"direction": [9 numbers: the matrix from grid axes to patient axes, row by row], "background": [r, g, b], "is_shaded", "is_linear",
"points": [{"value", "color": [r, g, b], "opacity"}]}. The first voxel's centre is origin_mm; colours are 0 to 1; opacity is that of 1 mm;
"type" is a numpy type; all after spacing_mm have a default: 0, not turned, black, true, true, no points.

First prints VTK's version, its number of threads and the OpenGL renderer, "_" for a space. Then, for each line on the standard input,
"MAPPER METHOD STEP_MM WIDTH_PX HEIGHT_PX EYE_X EYE_Y EYE_Z TARGET_X TARGET_Y TARGET_Z UP_X UP_Y UP_Z ANGLE_DEG [FILE]", draws a picture
and prints "MILLISECONDS PROCESSOR_MILLISECONDS PIXELS": until the picture is in memory; of all threads together; how many of its pixels
the volume covers. MAPPER: fixed (vtkFixedPointVolumeRayCastMapper) or smart (vtkSmartVolumeMapper); METHOD: ray, mip or average (smart
only); STEP_MM: between samples; a positive ANGLE_DEG is the vertical angle of view, a negative one half the height in mm in parallel
projection, negated. FILE gets the picture, RGB, 8 bits, row by row from the top. The first picture of a mapper includes what it prepares.
Pictures are drawn by Mesa in software, without a display. Exit status 77: no VTK for Python here, or no such Mesa.
"""
import ctypes
import json
import sys
import time

try:
    import numpy
    import vtkmodules.vtkRenderingVolumeOpenGL2 as volume_gl
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkLogger, vtkMultiThreader, vtkUnsignedCharArray, vtkVersion
    from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
    from vtkmodules.vtkCommonMath import vtkMatrix4x4
    from vtkmodules.vtkRenderingCore import vtkColorTransferFunction, vtkRenderer, vtkVolume, vtkVolumeProperty
    from vtkmodules.vtkRenderingOpenGL2 import vtkGenericOpenGLRenderWindow
    from vtkmodules.vtkRenderingVolume import vtkFixedPointVolumeRayCastMapper
except ImportError:
    sys.exit(77)


def make_context():
    """A surfaceless EGL context of Mesa, current on this thread; VTK's own windows need an X display."""
    platform_surfaceless, opengl_api, config_kind, opengl_bit, none = 0x31DD, 0x30A2, 0x3040, 0x0008, 0x3038
    try:
        egl = ctypes.CDLL("libEGL.so.1")
    except OSError:
        sys.exit(77)
    egl.eglGetPlatformDisplay.restype = egl.eglCreateContext.restype = ctypes.c_void_p
    display = ctypes.c_void_p(egl.eglGetPlatformDisplay(platform_surfaceless, None, None))
    config, n = ctypes.c_void_p(), ctypes.c_int()
    if not egl.eglInitialize(display, None, None) or not egl.eglBindAPI(opengl_api):
        sys.exit(77)
    egl.eglChooseConfig(display, (ctypes.c_int * 3)(config_kind, opengl_bit, none), ctypes.byref(config), 1, ctypes.byref(n))
    version = (ctypes.c_int * 5)(0x3098, 3, 0x30FB, 3, none)
    context = ctypes.c_void_p(egl.eglCreateContext(display, config, None, version))
    if not context or not egl.eglMakeCurrent(display, None, None, context):
        sys.exit(77)


def make_image(setup):
    """The grid without its direction, which the volume's matrix has: the fixed point mapper ignores an image's own."""
    size = setup["size"]
    voxels = numpy.fromfile(setup["file"], dtype=setup["type"])
    image = vtkImageData()
    image.SetDimensions(*size)
    image.SetSpacing(*setup["spacing_mm"])
    image.GetPointData().SetScalars(numpy_to_vtk(voxels, deep=1))
    matrix = vtkMatrix4x4()
    direction, origin = setup.get("direction", [1, 0, 0, 0, 1, 0, 0, 0, 1]), setup.get("origin_mm", [0, 0, 0])
    for row in range(3):
        for column in range(3):
            matrix.SetElement(row, column, direction[3 * row + column])
        matrix.SetElement(row, 3, origin[row])
    return image, matrix


def make_property(setup):
    opacity, color = vtkPiecewiseFunction(), vtkColorTransferFunction()
    for point in setup.get("points", []):
        opacity.AddPoint(point["value"], point["opacity"])
        color.AddRGBPoint(point["value"], *point["color"])
    prop = vtkVolumeProperty()
    prop.SetScalarOpacity(opacity)
    prop.SetColor(color)
    prop.SetScalarOpacityUnitDistance(1.0)
    prop.SetShade(setup.get("is_shaded", True))
    prop.SetInterpolationType(1 if setup.get("is_linear", True) else 0)
    return prop


def make_mapper(name, image):
    mapper = vtkFixedPointVolumeRayCastMapper() if name == "fixed" else volume_gl.vtkSmartVolumeMapper()
    mapper.SetInputData(image)
    mapper.SetAutoAdjustSampleDistances(0)
    if name == "fixed":
        mapper.SetImageSampleDistance(1.0)
    else:
        mapper.SetInteractiveAdjustSampleDistances(0)
    return mapper


class Pictures:
    def __init__(self, setup):
        self.setup = setup
        self.window = vtkGenericOpenGLRenderWindow()
        self.window.SetOwnContext(0)
        self.window.SetIsDirect(1)
        self.window.SetIsCurrent(True)
        self.window.SetSupportsOpenGL(1)
        self.window.SetReadyForRendering(True)
        self.window.SetMultiSamples(0)
        self.window.SetOffScreenRendering(1)
        self.window.SetSize(64, 64)
        self.window.OpenGLInit()
        self.image, self.matrix = make_image(setup)
        self.property = make_property(setup)
        self.renderers = {}

    def gl_name(self):
        lines = self.window.ReportCapabilities().splitlines()
        return next((line.split(":", 1)[1].strip() for line in lines if "renderer string" in line), "unknown")

    def renderer_of(self, name):
        if name not in self.renderers:
            volume, renderer = vtkVolume(), vtkRenderer()
            volume.SetMapper(make_mapper(name, self.image))
            volume.SetProperty(self.property)
            volume.SetUserMatrix(self.matrix)
            renderer.AddVolume(volume)
            renderer.SetBackground(*self.setup.get("background", [0, 0, 0]))
            self.renderers[name] = renderer, volume.GetMapper()
        return self.renderers[name]

    def draw(self, name, method, step_mm, size_px, eye, target, up, angle_deg):
        """(milliseconds, those of all processors, picture as [height][width][4], row 0 at the bottom)"""
        renderer, mapper = self.renderer_of(name)
        mapper.SetBlendMode({"ray": 0, "mip": 1, "average": 3}[method])
        mapper.SetSampleDistance(step_mm)
        camera = renderer.GetActiveCamera()
        camera.SetPosition(*eye)
        camera.SetFocalPoint(*target)
        camera.SetViewUp(*up)
        camera.SetParallelProjection(angle_deg < 0)
        if angle_deg < 0:
            camera.SetParallelScale(-angle_deg)
        else:
            camera.SetViewAngle(angle_deg)
        renderer.ResetCameraClippingRange()
        self.window.AddRenderer(renderer)
        rgba = vtkUnsignedCharArray()
        width, height = size_px
        self.window.SetSize(width, height)
        began, busy = time.perf_counter(), time.process_time()
        self.window.Render()
        self.window.GetRGBACharPixelData(0, 0, width - 1, height - 1, 0, rgba)
        took_ms, busy_ms = (time.perf_counter() - began) * 1e3, (time.process_time() - busy) * 1e3
        self.window.RemoveRenderer(renderer)
        return took_ms, busy_ms, vtk_to_numpy(rgba).reshape(height, width, 4)


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        setup = json.load(file)
    make_context()
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)  # its OpenGL loader complains that there is no X display
    pictures = Pictures(setup)
    print(vtkVersion.GetVTKVersion(), vtkMultiThreader.GetGlobalDefaultNumberOfThreads(), pictures.gl_name().replace(" ", "_"),
          flush=True)
    background = numpy.round(numpy.array(setup.get("background", [0, 0, 0])) * 255).astype(int)
    for line in sys.stdin:
        words = line.split()
        size_px = int(words[3]), int(words[4])
        numbers = [float(word) for word in words[5:15]]
        took_ms, busy_ms, picture = pictures.draw(words[0], words[1], float(words[2]), size_px, numbers[0:3], numbers[3:6],
                                                  numbers[6:9], numbers[9])
        covered = (numpy.abs(picture[:, :, :3].astype(int) - background).max(axis=2) > 1).sum()
        if len(words) > 15:
            picture[::-1, :, :3].tofile(words[15])
        print(f"{took_ms:.3f} {busy_ms:.3f} {covered}", flush=True)


main()
