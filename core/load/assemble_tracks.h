#pragma once
/* Adds particle tracks to a plan, and the beam they show when the plan has no other. */
#include "core/formats/folder.h"
#include "core/formats/plan_file.h"
#include "core/plan/plan.h"

/* Call it after regions, images and beams: the unit of the tracks is judged by the plan's box. Tracks in a format that
 * is not read are reported and left out. errors as pp_parse and folder_read; ERROR_NOT_FOUND */
NODISCARD bool plan_add_tracks(struct plan *plan, const struct folder *folder, const struct plan_file *file,
                               struct error *err);
