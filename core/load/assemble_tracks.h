#pragma once
/* Adds particle tracks to a plan, and the beam they show when the plan has no other. */
#include "core/load/loading.h"

/* Call it after regions, images and beams: the unit of the tracks is judged by the plan's box. Files that cannot be
 * read are reported and left out. errors ERROR_MEMORY */
NODISCARD bool plan_add_tracks(struct loading *loading, struct error *err);
