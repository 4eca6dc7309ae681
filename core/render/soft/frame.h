#pragma once
/* A picture by the software rasteriser, begun: its draws as the rasteriser wants them. */
#include <stdatomic.h>

#include "core/render/soft/bins.h"
#include "core/render/soft/planes.h"
#include "core/render/visible/back_end.h"
#include "core/render/visible/draw.h"

struct soft_renderer;

struct soft_frame {
    struct soft_frame *next_frame; /* of the renderer's list */
    struct soft_renderer *renderer;
    struct soft_sorted *sorted; /* while it is drawn on */
    const struct render_pause *pause;
    const struct draw_list *list;
    const struct draw_scope *scope;
    struct render_options options;
    int width, height, n_bands; /* width and height in samples */
    struct soft_item *items;    /* of the list's shapes, in its order */
    struct soft_plane *planes;  /* of the list's images and labels, in its order */
    size_t n_items, n_planes, n_chunks, n_blocks;
    size_t n_layers;               /* most layers that are composed at a time */
    int layer_rows;                /* of a layer, drawn at a time */
    struct image *image;           /* NULL: nothing is prepared yet */
    atomic_size_t next, next_band; /* piece of work, band, nobody has taken */
    atomic_bool is_out_of_memory;
};

/* Fills items, planes and n_layers from the list. errors ERROR_MEMORY */
NODISCARD bool soft_frame_prepare(struct soft_frame *frame, struct error *err);
