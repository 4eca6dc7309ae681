#pragma once
/* Inside core/load: SERA's parts of a plan, each of several files or of several quantities. */
#include "core/formats/sera_chd.h"
#include "core/formats/sera_qhd.h"
#include "core/formats/sera_rst.h"
#include "core/formats/sera_uvh.h"

/* given_mm: of one unit of the header, as the plan says; 0: it does not.
 * errors of all: as folder_read and the formats; the text names the file */
NODISCARD bool plan_read_univels(const struct folder *folder, const char *path, double given_mm, struct uvh *uvh,
                                 struct volume **univels, struct report *report, struct error *err);
/* path is the file of pixels, or the header when the plan names that; header is "" when the plan names only one of
 * them. is_grid_doubtful: the header describes another image. */
NODISCARD bool plan_read_qsh(const struct folder *folder, const char *path, const char *header, double given_mm,
                             struct volume **image, char modality[16], bool *is_grid_doubtful, struct report *report,
                             struct error *err);
NODISCARD bool plan_read_rst(const struct folder *folder, const char *path, struct sera_doses *doses,
                             struct report *report, struct error *err);
/* path is the header; the table and the images of regions lie beside it. */
NODISCARD bool plan_read_chd(const struct folder *folder, const char *path, struct sera_doses *doses,
                             struct report *report, struct error *err);
