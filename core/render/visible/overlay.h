#pragma once
/* What is painted over a finished picture, alike for every back end: on slice panes the regions' outlines and the check
 * of a segmentation, on all pictures the box of a dose's grid. Lines have smooth edges, in moving pictures too. */
#include "core/render/visible/check.h"
#include "core/scene/snapshot.h"

/* Keeps the lines of the slices it was last asked for. */
struct overlay;

struct overlay *overlay_create(void);
void overlay_destroy(struct overlay *overlay);
void overlay_forget(struct overlay *overlay, const struct plan *plan);

/* camera: the snapshot's, resolved. check: NULL when nobody wants to know. errors ERROR_MEMORY, those of derive_shape
 */
NODISCARD bool overlay_draw(struct overlay *overlay, const struct snapshot *snapshot, const struct camera *camera,
                            struct image *image, struct check_counts *check, struct error *err);
