#pragma once
/* The triangles of a mesh in a chunk. */
#include "core/render/soft/chunk.h"

/* Keeps the chunk's triangles: by the mesh's own vertices where these will do, else (clipped, lit by the triangle, seen
 * from behind) with corners of their own. False: no memory. */
NODISCARD bool soft_keep_triangles(struct soft_chunk *chunk, int width, int height);
