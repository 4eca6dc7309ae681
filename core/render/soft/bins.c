/* Sorts the triangles of a chunk into the bands of the picture: a counting sort. */
#include "core/render/soft/bins.h"

#include <string.h>

#include "core/render/soft/quads.h"
#include "core/render/soft/triangles.h"

static bool keep_all(struct soft_chunk *chunk, int width, int height)
{
    chunk->n_kept = chunk->n_extras = 0;
    switch (chunk->item->shape->kind) {
    case SHAPE_TRIANGLES: return soft_keep_triangles(chunk, width, height);
    case SHAPE_LINES: return soft_keep_lines(chunk, width, height);
    case SHAPE_POINTS: return soft_keep_points(chunk, width, height);
    }
    return true;
}

bool soft_chunk_sort(struct soft_chunk *chunk, int width, int height, int n_bands)
{
    size_t n_starts = (size_t)n_bands + 1;
    if (!keep_all(chunk, width, height) ||
        !soft_reserve(&chunk->starts, &chunk->starts_capacity, n_starts, sizeof *chunk->starts))
        return false;
    /* counts by band, summed up to the ends of the bands; filling each band from its end leaves the starts */
    uint32_t *starts = chunk->starts;
    memset(starts, 0, n_starts * sizeof *starts);
    for (size_t i = 0; i < chunk->n_kept; i++)
        for (int band = chunk->kept[i].first_band; band <= chunk->kept[i].last_band; band++)
            starts[band]++;
    uint64_t n_refs = 0;
    for (int band = 0; band < n_bands; band++) {
        n_refs += starts[band];
        starts[band] = (uint32_t)n_refs;
    }
    starts[n_bands] = (uint32_t)n_refs;
    if (n_refs > UINT32_MAX || !soft_reserve(&chunk->refs, &chunk->refs_capacity, (size_t)n_refs, sizeof *chunk->refs))
        return false;
    for (size_t i = chunk->n_kept; i-- > 0;)
        for (int band = chunk->kept[i].first_band; band <= chunk->kept[i].last_band; band++)
            chunk->refs[--starts[band]] = chunk->kept[i].ref;
    return true;
}
