#pragma once
/* A picture that the software rasteriser has begun: the draws of its list as items and planes. */
#include <stdatomic.h>

#include "core/render/soft/bins.h"
#include "core/render/soft/caps.h"
#include "core/render/soft/marks.h"
#include "core/render/soft/planes.h"
#include "core/render/soft/tracks.h"
#include "core/render/soft/volume.h"
#include "core/render/soft/wash.h"
#include "core/render/visible/back_end.h"
#include "core/render/visible/draw.h"

struct soft_renderer;

struct soft_frame {
    struct soft_frame *next_frame; /* of the renderer's list */
    struct soft_renderer *renderer;
    struct soft_sorted *sorted; /* valid during soft_picture_go_on */
    const struct render_pause *pause;
    const struct draw_list *list;
    const struct draw_scope *scope;
    struct render_options options;
    int width, height, n_bands;  /* width and height in samples */
    struct soft_item *items;     /* the list's shapes and the outlines in its caps, in its order */
    struct soft_plane *planes;   /* the list's images and label layers, in its order */
    struct soft_marks *marks;    /* the list's marks, in its order */
    struct soft_volume *volume;  /* the list's, or NULL */
    struct soft_cap *caps;       /* the list's caps, in its order */
    struct soft_shape *outlines; /* of the regions of caps, in their order; each is an item too */
    size_t n_caps, n_outlines, n_marks;
    struct soft_track_view *tracks; /* the list's, or NULL */
    struct soft_wash *washes;       /* of planes, caps, shapes and the volume */
    size_t n_washes;
    struct soft_paint *paints;   /* of items */
    struct soft_volume *texture; /* of paints; NULL: none shows an image */
    size_t n_paints;
    size_t n_items, n_planes, n_chunks, n_blocks, n_track_chunks;
    size_t n_layers;               /* composed at a time, at most */
    int layer_rows;                /* rows of a layer that are drawn at a time */
    struct image *image;           /* NULL: not prepared yet */
    atomic_size_t next, next_band; /* the next piece of work, the next band, for any thread */
    atomic_bool is_out_of_memory;
};

/* Fills items, planes, marks, caps, volume and n_layers from the list. errors ERROR_MEMORY */
NODISCARD bool soft_frame_prepare(struct soft_frame *frame, struct error *err);
/* Frees what was filled, also by a preparation that failed. */
void soft_frame_finish(struct soft_frame *frame);
