#pragma once
/* Inside of reading images: interpolation between two planes of cells. Any thread. */
#include "core/volume/volume.h"

/* Mixes two planes of cells linearly, out = low + weight (high - low); whole numbers are rounded. */
void dicom_planes_mix(enum voxel_type type, const void *low, const void *high, double weight, void *out, size_t n);
