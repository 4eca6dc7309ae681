#pragma once
/* The view of a member who leaves the presenter: made of a shared view so that it goes on from what was shown. A pure
 * function on documents. Internal to server/room. */
#include "server/wire/document.h"

/* A copy of shared, a complete view document, for a picture of size_px. A parallel camera's height_mm (slices are
 * always parallel) is scaled with the smaller side, so that a millimetre keeps its number of pixels. The override gets
 * the three slice positions of scene, and of an oblique view the place of its plane; scene is the complete one that
 * shared shows; NULL: the plan is not loaded, and the override stays as it was. Returns the caller's document, or NULL
 * with problem when there is no memory. */
NODISCARD cJSON *own_view(const cJSON *shared, const cJSON *scene, const int size_px[2], struct problem *problem);
