#pragma once
/* Closed planar contours, and the voxels they enclose. Knows nothing of DICOM. */
#include "core/volume/volume.h"

struct contour {
    double *points_lps_mm; /* [n_points][3] */
    size_t n_points;       /* at least 3; the last is joined to the first */
};

/* The contours of one region. On one plane they combine by even-odd: an outline inside another is a hole, one inside that an island;
 * a hole joined to its outline by a channel of no width (keyhole) comes out the same. */
struct contour_set {
    struct contour *contours;
    size_t n_contours;
};

struct contour_facts {
    size_t n_planes;
    double polygon_cm3;  /* area of each plane times the slab it stands for */
    double filled_cm3;   /* of the voxels */
    size_t n_outside;    /* contours that reach beyond the grid */
    size_t n_not_planar; /* contours that leave their plane by more than a hundredth of a mm */
    double spacing_mm;   /* of the planes; 0 when there is one */
};

void contour_set_finish(struct contour_set *set);
