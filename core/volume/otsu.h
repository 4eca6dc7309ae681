#pragma once
/* The threshold between the dark and the bright values of a volume, and where the bright ones are. */
#include "core/volume/volume.h"

/* The value that parts the values of the volume so that the variance between the two classes is largest; of large
 * volumes a part of the voxels is looked at. NaN: without two different finite values. low and high of the volume are
 * measured.
 *   source  N. Otsu, A Threshold Selection Method from Gray-Level Histograms, IEEE Trans. Syst. Man Cybern. 9 (1979)
 *           62. web/js/features/image/histograms.js has the same. */
double otsu_threshold(const struct volume *volume);
/* The box of the voxels with at least a value, to the outer faces of these; empty without one. In large volumes it is
 * up to a few voxels larger. */
struct box3 otsu_box_lps_mm(const struct volume *volume, double least);
