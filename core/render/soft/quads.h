#pragma once
/* The lines and points of a shape in a chunk, as rectangles square to the picture. */
#include "core/render/soft/chunk.h"

/* Keep the chunk's lines or points. False: no memory. */
NODISCARD bool soft_keep_lines(struct soft_chunk *chunk, int width, int height);
NODISCARD bool soft_keep_points(struct soft_chunk *chunk, int width, int height);
