#pragma once
/* Chooses the first grey-level window of an image. */
#include "core/plan/plan.h"

/* CT: soft tissue, centre 40 HU, width 400 HU. Others: from percentile 0.1 to 99.9 of the values. The volume must be
 * measured (low, high). */
void plan_image_window(struct plan_image *image);
/* Clamps the window to what a scene can show, the limits in core/volume/window.h. */
void plan_image_window_limit(struct plan_image *image);
