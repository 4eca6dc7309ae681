#pragma once
/* Keeps the triangles of a chunk that can be seen. */
#include "core/render/soft/chunk.h"

/* A triangle refers to the mesh's vertices; one that is clipped, flat or seen from behind gets corners of its own.
 * False: no memory. */
NODISCARD bool soft_keep_triangles(struct soft_chunk *chunk, int width, int height);
