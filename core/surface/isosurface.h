#pragma once
/* Isosurfaces: the surface on which a field of floats, for instance a dose, has a given value, as a triangle mesh.
 * Knows nothing of plans, doses, scenes or GL. Any thread. */
#include "core/surface/surface.h"
#include "core/volume/volume.h"

/* Smallest and largest value in each brick of a field, kept so that another level looks only at the bricks that it
 * passes through. Brick b of an axis has the voxels from extent * b up to and including extent * (b + 1): every cell
 * between voxels is within one brick. Frozen. */
enum { ISO_BRICK_I = 8, ISO_BRICK_J = 4, ISO_BRICK_K = 4 };
struct iso_bricks {
    uint32_t n[3];     /* along i, j, k */
    float *low, *high; /* [k][j][i] of the finite values; low > high: there is none */
    uint8_t *has_gaps; /* [k][j][i] 1: some voxel has no value */
    size_t n_bytes;    /* memory in bytes */
};
/* field: VOXEL_F32 with slope 1 and offset 0. errors ERROR_MEMORY */
NODISCARD struct iso_bricks *iso_bricks_create(const struct volume *field, int n_threads, struct error *err);
void iso_bricks_destroy(struct iso_bricks *bricks);

/* The surface where a field has the value iso. Inside is where it is at least iso. A voxel whose value is not finite
 * has no value.
 *
 *   marching cubes, smooth
 *            A vertex is where the field, interpolated linearly along the edge between two voxels, is iso. A cell of
 *            eight voxels of which one has no value gives no triangle: nothing is known there. Nor is anything known
 *            beyond the grid. So the surface is open where it meets either, and closed everywhere else: each edge has
 *            two triangles. Normals are the gradient of the field in patient mm, towards smaller values: the gradient
 *            at a voxel is of central differences, one-sided beside a voxel without a value, and linear along the edge.
 *            Smooth is the same as marching cubes: a field needs no smoothing to have no steps.
 *   eight-cell
 *            surface_eight_cell of the mask of the voxels inside, open where the grid ends, as in Sera3d: vertices are
 *            voxel centres. A voxel without a value is outside. Normals are mesh_make_normals'.
 *
 *   field    VOXEL_F32 with slope 1 and offset 0
 *   bricks   of this field, or NULL: all voxels are read
 *   options  n_threads, max_triangles, without_normals
 *   returns  patient LPS, mm; triangles wind outward; without triangles if nothing is inside or everything is; some
 *            triangles have no area where a value is exactly iso. Equal input gives equal bytes for any n_threads, with
 *            or without bricks. One reference, the caller's; NULL on failure
 *   errors   ERROR_RANGE iso is not finite; ERROR_LIMIT; ERROR_MEMORY
 *   thread   any; field and bricks are shared and frozen
 *   source   as surface_marching_cubes. Triangles and vertices equal vtkFlyingEdges3D's on the same field. */
NODISCARD struct mesh *isosurface_make(enum surface_algorithm algorithm, const struct volume *field,
                                       const struct iso_bricks *bricks, double iso,
                                       const struct surface_options *options, struct error *err);
