#pragma once
/* Draws caps: row by row, the samples whose centres are inside the outlines of a region in the clip plane. Outlines and
 * the triangles that are cut at the plane have the same rounded corners and the same rule for samples on an edge, so
 * that no sample between a cap and the surface around it is left out. */
#include "core/render/soft/chunk.h"
#include "core/render/soft/planes.h"

/* An edge of an outline in the picture, from above to below; in sub-samples. */
struct soft_cap_edge {
    int64_t x0, x1;
    int32_t y0, y1;
};

struct soft_cap_region {
    struct soft_cap_edge *edges;
    size_t n_edges, capacity;
    uint32_t *refs, *starts; /* of edges by band, as in struct soft_chunk */
};

struct soft_cap {
    const struct draw *draw;
    struct soft_plane plane;         /* of the image; without a grid if the plan has none */
    const struct soft_wash *wash;    /* over all of it; the caller fills it; NULL: none */
    uint32_t dark;                   /* the colour where there is no image */
    struct soft_cap_region *regions; /* as in draw_cap */
};

/* The memory in which a thread draws caps of a picture of this width, in samples. */
struct soft_cap_scratch {
    uint64_t *inside, *all; /* [SOFT_BAND_ROWS][n_words] bits by sample: of one region, of all */
    uint32_t *tints;        /* [SOFT_BAND_ROWS][64 n_words] colour of the uppermost region */
    size_t n_words;
};
NODISCARD bool soft_cap_scratch_resize(struct soft_cap_scratch *scratch, int width, struct error *err);
void soft_cap_scratch_finish(struct soft_cap_scratch *scratch);

/* Fills regions from the draw, which is borrowed; the caller fills plane and dark. projection: rows of a
 * soft_lighting. On failure soft_cap_finish frees what there is. errors ERROR_MEMORY */
NODISCARD bool soft_cap_init(struct soft_cap *cap, const struct draw *draw, const struct soft_lighting *projection,
                             int height, int n_bands, struct error *err);
void soft_cap_finish(struct soft_cap *cap);
/* index: the band's number. */
void soft_cap_draw(const struct soft_cap *cap, const struct soft_kernels *kernels, const struct soft_band *band,
                   int index, const struct soft_cap_scratch *scratch);
