#pragma once
/* Normals for shading. The normals of a surface made of voxels jump from terrace to terrace, and the picture shows
 * stripes instead of the shape; averaged over neighbouring vertices they show the shape. Positions are not changed, nor
 * is the silhouette. */
#include "core/surface/mesh.h"

/* Unit normals [n_vertices][3], each the mean over the vertices up to n_passes triangles away. The caller frees them.
 * Equal input gives equal bytes. NULL on failure. errors ERROR_MEMORY */
NODISCARD float *shading_normals(const struct mesh *mesh, int n_passes, struct error *err);
/* The number of passes for a surface of this reduction (1: full). */
int shading_passes(uint32_t reduction);
