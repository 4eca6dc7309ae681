#pragma once
/* From a mask to its boundary as a triangle mesh. Knows nothing of plans, scenes or GL. */
#include "core/region/mask.h"
#include "core/surface/mesh.h"

enum surface_algorithm { SURFACE_MARCHING_CUBES, SURFACE_EIGHT_CELL, SURFACE_SMOOTH, SURFACE_N_ALGORITHMS };
/* As in scene and API: "marching-cubes", "eight-cell", "smooth". */
const char *surface_algorithm_word(enum surface_algorithm algorithm);
NODISCARD bool surface_algorithm_from_word(const char *word,
                                           enum surface_algorithm *algorithm); /* false: none, unchanged */

struct surface_options {
    int n_threads;        /* 0: all cores */
    size_t max_triangles; /* refuse to build more than this */
    bool close_at_border; /* what lies beyond the grid counts as outside, so a region cut by the scan is closed */
    bool without_normals; /* surface_smooth alone: no normals, as the others */
};
extern const struct surface_options surface_defaults; /* 0, 40 million, true */

/* Marching cubes: vertices at the middle of the grid edges between inside and outside.
 *
 *   returns  a closed mesh (if close_at_border), triangles wind outward for either handedness of the grid, without
 * normals; equal input gives equal bytes for any n_threads. One reference, the caller's; NULL on failure. errors
 * ERROR_RANGE the mask is empty; ERROR_LIMIT; ERROR_MEMORY source   W. E. Lorensen, H. E. Cline, Marching Cubes,
 * SIGGRAPH 1987; the case table is generated so that the two cells at an ambiguous face always agree. Triangle counts
 * equal vtkFlyingEdges3D's on the same padded mask. */
NODISCARD struct mesh *surface_marching_cubes(const struct mask *mask, const struct surface_options *options,
                                              struct error *err);

/* The same of a field, a dose say: inside is where its value is at least iso. Vertices lie where the value along a grid
 * edge, taken as linear between the two ends, is iso; in the middle of the edge where an end has no value: it is not
 * finite, which counts as outside, or lies beyond the grid (close_at_border), half a voxel behind the outermost values.
 *
 *   returns  as above; triangles may have no area where a value is exactly iso
 *   errors   ERROR_RANGE no value is inside, or iso is not finite; ERROR_LIMIT; ERROR_MEMORY
 *   thread   any; the field is shared and frozen
 *   source   as above. Triangles and vertices equal vtkFlyingEdges3D's on the same field. */
NODISCARD struct mesh *surface_marching_cubes_field(const struct volume *field, double iso,
                                                    const struct surface_options *options, struct error *err);

/* The 8-cell algorithm: vertices at the centres of inside voxels. A region within a cell is the convex hull of the
 * cell's inside corners, and the surface is the boundary of all of them together (corner_cases.c).
 *
 *   returns  as above but for thin parts: what is one voxel thick is two sheets back to back (so an edge may have four
 * triangles, two each way), a line or a lone voxel is not drawn at all. A mesh without triangles when nothing else is
 * there. The two sheets share their vertices, so those have no normal of their own: only faceted shading lights them
 * rightly. errors   as above source   the thesis on Sera3d, "8-cell algorithm". Triangle counts equal the original's on
 * its own sample head with the border left open as it does: scalp 137,132, brain 85,240, tumour 10,236. */
NODISCARD struct mesh *surface_eight_cell(const struct mask *mask, const struct surface_options *options,
                                          struct error *err);

/* Marching cubes, smoothed within bounds: every vertex stays on its grid edge, and at least SURFACE_SMOOTH_MARGIN of
 * that edge away from either end. So each vertex moves along one axis of the grid by less than half a univel, and the
 * centre of every univel stays on the side it is on: a mask made from the surface is the mask again. The same vertices
 * and triangles as by marching cubes, so a closed manifold as there: at an ambiguous face each of the two inside
 * corners is cut off alone.
 *
 *   returns  as above, and with vertex normals unless without_normals: those of the surface as it would be without
 * bounds, so that light does not fall on where vertices are held back, unless it would face another way. When closed,
 * each piece encloses the volume of its univels to 0.1 %, or as near as the edges allow: things of a univel or two may
 * stay some percent off. errors   as above memory   112 bytes a vertex while it works source   the bound is that of S.
 * F. F. Gibson, Constrained Elastic Surface Nets, MICCAI 1998, on the vertices of marching cubes instead of nets; the
 * filter is of G. Taubin, T. Zhang, G. Golub, Optimal Surface Smoothing as Filter Design, ECCV 1996. */
#define SURFACE_SMOOTH_MARGIN 0.05
NODISCARD struct mesh *surface_smooth(const struct mask *mask, const struct surface_options *options,
                                      struct error *err);

/* Any of them. */
NODISCARD struct mesh *surface_make(enum surface_algorithm algorithm, const struct mask *mask,
                                    const struct surface_options *options, struct error *err);
