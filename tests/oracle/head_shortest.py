"""The shortest way out of SERA's sample head, by sampling in numpy: HEAD.uv.gz x y z ... (points, patient LPS in mm). Rays in the directions
of a Fibonacci lattice 2.9 degrees apart are sampled every 0.5 mm, up to 400 mm; then every 0.25 mm ever closer ones around the eight best.
Prints for each point the least depth."""
import gzip
import sys

try:
    import numpy
except ImportError:
    sys.exit(77)

SPACING, FIRST = numpy.array([1.01562, 1.01562, 5.49991], "f4"), numpy.array([-129.492, -129.492, -264.996], "f4")
inside = numpy.zeros((50, 258, 258), bool)  # with a border that is outside
inside[1:-1, 1:-1, 1:-1] = numpy.frombuffer(gzip.open(sys.argv[1]).read(), "u1").reshape(48, 256, 256) >= 2


def depths(point, directions, step):
    """The greatest multiple of the step at which each ray is in a region."""
    distances = numpy.arange(0, 400, step, dtype="f4")
    found = numpy.zeros(len(directions))
    start, way = ((point - FIRST) / SPACING + 1.5).astype("f4"), (directions / SPACING).astype("f4")
    for begin in range(0, len(directions), 400):
        i, j, k = ((start[axis] + way[begin:begin + 400, axis, None] * distances).clip(0, size - 1).astype("i4")
                   for axis, size in enumerate((258, 258, 50)))
        hit = inside[k, j, i]
        found[begin:begin + 400] = numpy.where(hit.any(axis=1), distances[len(distances) - 1 - hit[:, ::-1].argmax(axis=1)], 0)
    return found


def around(direction, degrees):
    side = numpy.cross(direction, [1, 0, 0] if abs(direction[0]) < 0.6 else [0, 1, 0])
    side /= numpy.linalg.norm(side)
    a, b = (part.ravel()[:, None] for part in numpy.meshgrid(*[numpy.radians(degrees) * numpy.linspace(-1, 1, 9)] * 2))
    rays = direction + a * side + b * numpy.cross(direction, side)
    return rays / numpy.linalg.norm(rays, axis=1)[:, None]


for point in numpy.array(sys.argv[2:], float).reshape(-1, 3):
    n = 5000
    z, turn = 1 - (2 * numpy.arange(n) + 1) / n, numpy.pi * (1 + 5 ** 0.5) * numpy.arange(n)
    rays = numpy.stack([numpy.sqrt(1 - z * z) * numpy.cos(turn), numpy.sqrt(1 - z * z) * numpy.sin(turn), z], axis=1)
    found = depths(point, rays, 0.5)
    for width in (3.0, 0.75, 0.19):
        rays = numpy.concatenate([around(ray, width) for ray in rays[numpy.argsort(found, kind="stable")[:8]]])
        found = depths(point, rays, 0.25)
    print(found.min())
