#pragma once
/* Which of a chunk's triangles lie in which bands of the picture. Chunks are sorted side by side, each by one thread;
 * bands then go through the chunks in order, so that pictures do not depend on the number of threads. */
#include "core/render/soft/chunk.h"

/* Sorts the chunk's triangles that face the viewer (or are seen from both sides) and hold a sample into n_bands bands
 * of a picture of width x height samples. errors ERROR_MEMORY */
NODISCARD bool soft_chunk_sort(struct soft_chunk *chunk, int width, int height, int n_bands);
