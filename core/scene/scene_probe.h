#pragma once
/* Regions, image values and doses at a patient point, of the parts that a snapshot uses. Any thread. */
#include "core/scene/snapshot.h"

/* Like plan_probe, without the regions, images and doses that are not used (fit_use.h). */
void scene_probe(const struct snapshot *snapshot, struct vec3 point_lps_mm, struct plan_probe *probe);
