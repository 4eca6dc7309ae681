#pragma once
/* Inside core/load: the plan's particle tracks, and the beam they show when no other is given. */
#include "core/formats/folder.h"
#include "core/formats/plan_file.h"
#include "core/plan/plan.h"

/* After regions, images and beams: the unit of tracks is judged by the plan's box. What is in a format that is not read
 * is reported and left out. errors as pp_parse and folder_read */
NODISCARD bool plan_add_tracks(struct plan *plan, const struct folder *folder, const struct plan_file *file,
                               struct error *err);
