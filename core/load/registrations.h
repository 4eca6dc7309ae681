#pragma once
/* Brings the parts of a plan into one frame of reference, that of the first image of the shown patient, where a
 * registration object of the folder says how. Part, image and registration have to be of one patient. */
#include "core/load/loading.h"

/* Reads the registration objects of the folder into plan->registrations. */
void registrations_read(struct loading *loading);
/* Each moves the grids or points of its parts, marks their origins as is_registered and says it. Regions: before they
 * are measured. */
void registrations_move_images_and_regions(struct plan *plan);
void registrations_move_doses(struct plan *plan);
void registrations_move_beam(struct plan *plan, size_t beam);
/* Warns of images that stay in different frames of reference. */
void registrations_warn(struct plan *plan);
