#pragma once
/* Inside core/render/soft: one picture in the making, and what is to be drawn in it. */
#include <stdatomic.h>

#include "core/render/soft/bins.h"
#include "core/render/soft/planes.h"
#include "core/render/visible/back_end.h"

struct soft_renderer;

enum { SOFT_MAX_PLANES = 3 + REGION_MAX_LAYERS };

struct soft_frame {
    struct soft_frame *next_frame; /* of the renderer's list */
    uint64_t number;               /* of the picture, as the cache counts */
    struct soft_renderer *renderer;
    struct soft_cache *cache;
    struct soft_sorted *sorted; /* while it is drawn on */
    const struct render_pause *pause;
    const struct snapshot *snapshot;
    const struct camera *camera;
    struct render_options options;
    int width, height, samples, n_bands; /* width and height in samples */
    struct soft_item *items;             /* opaque ones front to back, then translucent ones back to front */
    size_t n_items, n_translucent, n_chunks, n_blocks;
    int layer_rows;                            /* of the translucent layers */
    struct soft_plane planes[SOFT_MAX_PLANES]; /* in the order of drawing: after the opaque items */
    size_t n_planes;
    uint32_t *palettes;            /* of the planes, [][VISIBLE_N_LABELS] */
    struct image *image;           /* NULL: nothing is collected yet */
    atomic_size_t next, next_band; /* piece of work, band, nobody has taken */
    atomic_bool is_out_of_memory;
};

/* Fill items and planes. errors as soft_picture_go_on */
NODISCARD bool soft_collect_shapes(struct soft_frame *frame, struct render_timing *timing, struct error *err);
NODISCARD bool soft_collect_planes(struct soft_frame *frame, struct error *err);
