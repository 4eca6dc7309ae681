#pragma once
/* Makes the shape of a region: one file per representation. Knows nothing of plans, scenes or GL; keeps nothing.
 *
 *   outline  on every slice across the index axis nearest patient S; in 3-D a stack of lines. A single pixel is drawn
 *            as a small diamond.
 *   points   one point per border voxel; solid has the same points. Without has_inner_boundary only the outer border.
 *   univels  the faces between inside and outside voxels, two triangles each, with shared corners. Closed; where two
 *            voxels touch along an edge alone, that edge has four triangles. Encloses exactly the voxels.
 *   nurbs    spline surfaces through samples of the outlines (nurbs_nets.h), as a mesh
 *   fan      triangles between neighbouring border voxels (shape_parts.h)
 *   surface  surface_make with surface_defaults
 *
 * All but points and solid with has_inner_boundary use the region with everything inside it (mask_from_region).
 * Everything beyond the grid is outside. Meshes have vertex normals. */
#include "core/region/mask.h"
#include "core/surface/shape.h"

enum { SHAPE_MAX_TRIANGLES = 40000000, SHAPE_MAX_POINTS = 10000000, SHAPE_MAX_SEGMENTS = 40000000 };

/* Makes a shape in patient LPS, mm.
 *
 *   key      normalised
 *   returns  one reference, the caller's; equal input gives equal bytes for any n_threads (0: all cores)
 *   errors   ERROR_RANGE no such region, or it has no voxel; nurbs_order or nurbs_bins out of range; ERROR_UNSUPPORTED
 *            nurbs by degree bins cannot show the region: the text says on which slice and why; ERROR_LIMIT more than
 *            the limits above; ERROR_MEMORY
 *   thread   any */
NODISCARD struct shape *shape_make(const struct shape_key *key, const struct region_set *set, size_t region,
                                   int n_threads, struct error *err);
/* Like shape_make, from the mask of the region: mask_from_region_own with has_inner_boundary, else mask_from_region. */
NODISCARD struct shape *shape_make_from_mask(const struct shape_key *key, const struct mask *mask, int n_threads,
                                             struct error *err);
