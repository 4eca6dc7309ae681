#pragma once
/* The marks on an annotated picture: letters at the ends of the patient axes, and the scene's measures. */
#include "core/annotate/annotate.h"
#include "core/scene/snapshot.h"

/* Fills lines and labels of the annotations, for annotations_finish, also on failure. Axes: in 3-D where the scene
 * shows them. Measures: those that are visible, in 3-D all, on a slice pane those whose points all lie within half a
 * voxel of the image shown from its plane (without an image 0.5 mm), as the page does. What lies behind the eye is left
 * out. Leaves room for marks_add_crosshair. errors  ERROR_MEMORY thread  any */
NODISCARD bool marks_describe(struct annotations *annotations, const struct snapshot *snapshot,
                              const struct camera *camera, struct error *err);

/* Adds the crosshair to the lines of a slice pane, free around its middle and at the picture's edges. Annotations as
 * marks_describe left them; other pictures have none. */
void marks_add_crosshair(struct annotations *annotations, const struct snapshot *snapshot);
