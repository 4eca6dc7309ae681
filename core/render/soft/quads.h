#pragma once
/* Keeps the lines and points of a chunk as rectangles that face the viewer. */
#include "core/render/soft/chunk.h"

/* False: no memory. */
NODISCARD bool soft_keep_lines(struct soft_chunk *chunk, int width, int height);
NODISCARD bool soft_keep_points(struct soft_chunk *chunk, int width, int height);
