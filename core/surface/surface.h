#pragma once
/* Extracts the boundary of a mask as a triangle mesh. Knows nothing of plans, scenes or GL. */
#include "core/region/mask.h"
#include "core/surface/mesh.h"

enum surface_algorithm { SURFACE_MARCHING_CUBES, SURFACE_EIGHT_CELL, SURFACE_SMOOTH, SURFACE_N_ALGORITHMS };
/* Words as in scene and API: "marching-cubes", "eight-cell", "smooth". */
const char *surface_algorithm_word(enum surface_algorithm algorithm);
/* False for any other word; *algorithm is unchanged. */
NODISCARD bool surface_algorithm_from_word(const char *word, enum surface_algorithm *algorithm);

struct surface_options {
    int n_threads;        /* 0: all cores */
    size_t max_triangles; /* refuse to build more than this */
    bool close_at_border; /* everything beyond the grid is outside, so a region cut by the scan is closed */
    bool without_normals; /* surface_smooth: give no normals, as the other algorithms */
};
extern const struct surface_options surface_defaults; /* 0, 40 million, true */

/* Marching cubes: vertices at the midpoints of the grid edges between inside and outside.
 *
 *   returns  a closed mesh (if close_at_border) without normals; triangles wind outward for either handedness of the
 *            grid; equal input gives equal bytes for any n_threads. One reference, the caller's; NULL on failure
 *   errors   ERROR_RANGE the mask is empty; ERROR_LIMIT; ERROR_MEMORY
 *   thread   any
 *   source   W. E. Lorensen, H. E. Cline, Marching Cubes, SIGGRAPH 1987; the case table is generated so that the two
 *            cells at an ambiguous face always agree. Triangle counts equal vtkFlyingEdges3D's on the same padded
 *            mask. */
NODISCARD struct mesh *surface_marching_cubes(const struct mask *mask, const struct surface_options *options,
                                              struct error *err);

/* The 8-cell algorithm: vertices at the centres of inside voxels. Within a cell the region is the convex hull of the
 * cell's inside corners; the surface is the boundary of all hulls together (corner_cases.c).
 *
 *   returns  as surface_marching_cubes, except for thin parts: a part one voxel thick gives two sheets back to back (an
 *            edge may have four triangles, two each way), a line of voxels or a single voxel gives nothing. A mesh
 *            without triangles if nothing else is there. The two sheets share their vertices, which therefore have no
 *            normal of their own: only faceted shading illuminates them correctly.
 *   errors   as surface_marching_cubes
 *   source   the thesis on Sera3d, "8-cell algorithm". Triangle counts equal the original's on its own sample head with
 *            the border left open as it does: scalp 137,132, brain 85,240, tumour 10,236. */
NODISCARD struct mesh *surface_eight_cell(const struct mask *mask, const struct surface_options *options,
                                          struct error *err);

/* Marching cubes, smoothed within bounds: every vertex stays on its grid edge, at least SURFACE_SMOOTH_MARGIN of the
 * univel's shortest edge away from either end. So each vertex moves along one grid axis by less than half a univel, and
 * the centre of every univel stays on its side: a mask made from the surface is the same mask again. Vertices and
 * triangles are those of marching cubes, so the mesh is a closed manifold like it: at an ambiguous face each of the two
 * inside corners is cut off alone.
 *
 * If the slices, across whichever grid axis, are more than 1.2 times as far apart as the univels along either other
 * axis, the surface between them is interpolated first (smooth_slices.c). What ends between two slices gets the top
 * that its last contours suggest; what ends where the grid ends is cut off half a slice beyond. docs/surfaces.md has
 * figures.
 *
 *   returns  as surface_marching_cubes, and with vertex normals unless without_normals. The normals are those of the
 *            surface without bounds, so that the light does not show where vertices are held back, except where such a
 *            normal would face another way. If closed, each piece encloses the volume of its univels to 0.1 %, or as
 *            near as the edges allow: pieces of one or two univels may be off by some percent.
 *   errors   as surface_marching_cubes
 *   memory   112 bytes per vertex while it works, 117 with interpolation
 *   source   the bound is that of S. F. F. Gibson, Constrained Elastic Surface Nets, MICCAI 1998, on the vertices of
 *            marching cubes instead of nets; the filter is of G. Taubin, T. Zhang, G. Golub, Optimal Surface Smoothing
 *            as Filter Design, ECCV 1996; the interpolation is of S. P. Raya, J. K. Udupa, Shape-based interpolation of
 *            multidimensional objects, IEEE Trans. Med. Imaging 9(1), 1990, cubic instead of linear, and only on the
 *            edges that the surface crosses. */
#define SURFACE_SMOOTH_MARGIN 0.05
NODISCARD struct mesh *surface_smooth(const struct mask *mask, const struct surface_options *options,
                                      struct error *err);

/* Runs the named algorithm. */
NODISCARD struct mesh *surface_make(enum surface_algorithm algorithm, const struct mask *mask,
                                    const struct surface_options *options, struct error *err);
