#pragma once
/* Images and label layers on planes as draws: slices in space, and what a slice pane shows. */
#include "core/render/visible/draw.h"

/* The image shown with the scene's window, colours and blended image; the snapshot has one. is_culled: values below the
 * scene's cull_below are not drawn. */
struct draw_image draw_image_shown(const struct draw_list *list, const struct snapshot *snapshot, bool is_culled);

/* Appends the image's slices in space; on a slice pane the image, or without one the label layers: at each point
 * the colour of the uppermost visible region that holds it (visible_rank), whatever layers the regions are on.
 * errors ERROR_MEMORY, ERROR_UNSUPPORTED a label layer of real numbers */
NODISCARD bool draw_planes(struct draw_list *list, const struct draw_scope *scope, struct error *err);
