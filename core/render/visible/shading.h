#pragma once
/* Normals to shade with. A surface made of voxels has normals that jump from one terrace to the next and drown the
 * shape in stripes; averaged over their neighbours they show the shape. Only the light changes: every vertex stays
 * where the plan has it, and so does the silhouette. */
#include "core/surface/mesh.h"

/* Unit normals [n_vertices][3], free(); each the mean over its neighbourhood, n_passes triangles wide. Equal input,
 * equal bytes. errors ERROR_MEMORY */
NODISCARD float *shading_normals(const struct mesh *mesh, int n_passes, struct error *err);
/* How many passes suit a surface of this reduction (1: full). */
int shading_passes(uint32_t reduction);
