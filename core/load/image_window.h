#pragma once
/* Inside core/load: a first window for an image. */
#include "core/plan/plan.h"

/* CT: soft tissue. Else from the values: percentiles 0.1 and 99.9. The volume is measured. */
void plan_image_window(struct plan_image *image);
/* Into what a scene can show: WINDOW_... */
void plan_image_window_limit(struct plan_image *image);
