#pragma once
/* Reads SERA's files of a plan's folder: univels and images with the data beside their header, and doses. */
#include "core/formats/sera/sera_chd.h"
#include "core/formats/sera/sera_qhd.h"
#include "core/formats/sera/sera_rst.h"
#include "core/formats/sera/sera_uvh.h"

/* given_mm: length of one unit of the header, as the plan gives it; 0: not given.
 * errors of all: as folder_read and the readers in core/formats; the text names the file */
NODISCARD bool plan_read_univels(const struct folder *folder, const char *path, double given_mm, struct uvh *uvh,
                                 struct volume **univels, struct report *report, struct error *err);
/* path: the file of pixels, or the header. header: the header when the plan names both, else "". is_grid_doubtful: set
 * when the header describes another image. */
NODISCARD bool plan_read_qsh(const struct folder *folder, const char *path, const char *header, double given_mm,
                             struct volume **image, char modality[16], bool *is_grid_doubtful, struct report *report,
                             struct error *err);
NODISCARD bool plan_read_rst(const struct folder *folder, const char *path, struct sera_doses *doses,
                             struct report *report, struct error *err);
/* path: the .chd header; the .cdf table and the .cmf images of regions lie beside it. */
NODISCARD bool plan_read_chd(const struct folder *folder, const char *path, struct sera_doses *doses,
                             struct report *report, struct error *err);
