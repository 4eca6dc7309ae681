#pragma once
/* From a mask to its boundary as a triangle mesh. Knows nothing of plans, scenes or GL. */
#include "core/region/mask.h"
#include "core/surface/mesh.h"

struct surface_options {
    int n_threads;        /* 0: all cores */
    size_t max_triangles; /* refuse to build more than this */
    bool close_at_border; /* what lies beyond the grid counts as outside, so a region cut by the scan is closed */
};
extern const struct surface_options surface_defaults; /* 0, 40 million, true */

/* Marching cubes: vertices at the middle of the grid edges between inside and outside.
 *
 *   returns  a closed mesh (if close_at_border), triangles wind outward for either handedness of the grid, without normals;
 *            equal input gives equal bytes for any n_threads. One reference, the caller's; NULL on failure.
 *   errors   ERROR_RANGE the mask is empty; ERROR_LIMIT; ERROR_MEMORY
 *   source   W. E. Lorensen, H. E. Cline, Marching Cubes, SIGGRAPH 1987; the case table is generated so that the two cells at an
 *            ambiguous face always agree. Triangle counts equal vtkFlyingEdges3D's on the same padded mask. */
NODISCARD struct mesh *surface_marching_cubes(const struct mask *mask, const struct surface_options *options, struct error *err);
