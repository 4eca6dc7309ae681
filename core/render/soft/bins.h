#pragma once
/* Sorts the triangles of a chunk into the bands of the picture. Threads sort chunks side by side; each band is then
 * drawn from the chunks in their order, so that the picture does not depend on the number of threads. */
#include "core/render/soft/chunk.h"

/* Fills kept, extras, refs and starts of the chunk, for n_bands bands of a picture of width x height samples. False: no
 * memory. */
NODISCARD bool soft_chunk_sort(struct soft_chunk *chunk, int width, int height, int n_bands);
