#pragma once
/* Settles what the files of a folder without plan.json are, once their values are known: names hint, content decides.
 */
#include "core/load/loading.h"

/* Turns files that are no labels, or no dose, by their values into images, and reports them; leaves out doses that are
 * 0 everywhere. Call it after plan_read_parts. Does nothing with a plan.json, which says what its files are. */
void plan_settle_parts(struct loading *loading);
/* The place of an image among the others of such a folder, lowest first: DICOM, a CT by its name, any other, what may
 * be a label map. */
int plan_image_rank(const struct loading *loading, const struct part_reading *reading);
enum { PLAN_IMAGE_RANKS = 4 };
