#pragma once
/* Which region is a target of the treatment, and the point in the middle of a region. Knows no scene. */
#include "core/region/region.h"

/* True if a name has a word for a target: GTV, CTV, PTV, tumor, tumour, target, lesion, in any case, also in the
 * plural. A word ends at anything but a letter (ASCII), so "PTV1" and "tumour_bed" have one, and "targeted" and
 * "nontumour" have none. In capitals GTV, CTV and PTV may carry a classifier of AAPM TG-263 in small letters: "GTVp",
 * "PTVsb". Not a target is what is taken away ("Lungs-PTV", after TG-263's names of differences), and what has a word
 * of a structure made around a target: ring, shell, not, minus, without, outside. */
bool region_name_is_target(const char *name);
/* True if a region is a target by its type in the file or by its name. */
bool region_is_target(const struct region *region);
/* The first region in file order that has a voxel and is a target by its type in the file or by its name; -1: none.
 * Regions with descendants count the descendants' voxels. */
int region_first_target(const struct region_set *set);

/* The centroid of a region with its descendants if it lies in one of their univels, else the centre of their univel
 * nearest to it (so that it is never in the hole of a ring). The region or a descendant has a voxel. */
struct vec3 region_middle_lps_mm(const struct region_set *set, size_t index);
