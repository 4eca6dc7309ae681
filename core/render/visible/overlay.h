#pragma once
/* What is painted over a finished picture, alike for every back end: on slice panes the regions' outlines and the check
 * of a segmentation, on all pictures the box of a dose's grid. Lines have smooth edges, in moving pictures too. */
#include "core/base/image.h"
#include "core/scene/snapshot.h"

/* Keeps the lines of the slices it was last asked for. */
struct overlay;

struct overlay *overlay_create(void);
void overlay_destroy(struct overlay *overlay);
void overlay_forget(struct overlay *overlay, const struct plan *plan);

/* What the check of a segmentation found on a picture, in pixels of it. */
struct overlay_check {
    size_t n_added;    /* the surface encloses them and they are no univels of the region */
    size_t n_left_out; /* univels outside the surface */
};

/* camera: the snapshot's, resolved. check: NULL when nobody wants to know. errors ERROR_MEMORY, those of plan_shape */
NODISCARD bool overlay_draw(struct overlay *overlay, const struct snapshot *snapshot, const struct camera *camera,
                            struct image *image, struct overlay_check *check, struct error *err);
