#pragma once
/* Closed planar contours, and the voxels they enclose. Knows nothing of DICOM, files or reports.
 *
 * To fill regions that were drawn together:
 *     options.spacing_mm = contour_usual_spacing_mm(sets, n_sets, image_grid);
 *     contour_choose_grids(sets, n_sets, image_grid, &options, choices, &err);
 *     for each: mask = contour_fill(&sets[i], &choices[i].grid, &options, &facts, &err);
 *               add it to a label layer on that grid (contour_layer.h), then mask_destroy(mask) */
#include "core/region/mask.h"

enum {
    CONTOUR_MAX_POINTS = 10000000, /* per set */
    CONTOUR_MAX_PLANES = 8192,     /* per set */
    CONTOUR_MAX_SUBDIVISION = 16   /* parts of an image voxel along each axis */
};
#define CONTOUR_MAX_MEETINGS ((uint64_t)1 << 27) /* intersections of edges with rows of voxels, per filling */
#define CONTOUR_MAX_MM 1e5                       /* a contour with a larger coordinate is left out */
/* How far beyond the image a region is still covered by a grid: no patient is longer. */
#define CONTOUR_MAX_REACH_MM 2000.0

struct contour {
    double *points_lps_mm; /* [n_points][3] */
    size_t n_points;       /* the last point is joined to the first */
    bool is_xor;           /* CLOSEDPLANAR_XOR: planes of these alone combine by exclusive or */
};

/* The contours of one region. Those of one plane combine so: an outline inside another (up to 0.05 mm) is a hole, an
 * outline in that hole an island. A hole joined to its outline by a channel of zero width (keyhole) gives the same
 * result. Outlines that partly overlap are a union. One that repeats another is left out: outlines that lie 0.35 mm
 * apart on the mean or less, or a coarser copy with all its points on the other. A contour alone is filled by even-odd.
 */
struct contour_set {
    struct contour *contours;
    size_t n_contours;
};

struct contour_options {
    int n_threads;        /* at least 1 */
    double spacing_mm;    /* plane spacing for sets whose planes do not tell it: a single plane, or fewer than four that
                             are over 1.5 times further apart. 0: trust the planes; a single one is as thick as the grid's
                             spacing along its normal */
    uint64_t most_voxels; /* largest grid that contour_choose_grids may make itself */
};
extern const struct contour_options contour_defaults; /* 2 threads, 0 mm, 64 Mi voxels */

struct contour_facts {
    size_t n_planes;
    double polygon_cm3;    /* sum over the planes: area of the combined contours times the thickness of its slab */
    double filled_cm3;     /* volume of the voxels */
    double outlines_cm3;   /* a check by another way: shoelace areas with the sign of their nesting, times the thickness
                              of   their slab as far as it is on the grid; NaN if too intricate */
    double spacing_mm;     /* median distance of neighbouring planes; with a single plane, the thickness given to it */
    size_t n_gaps;         /* places where the next plane is over 1.5 times further away; not filled there */
    double widest_gap_mm;  /* 0 if there is no gap */
    size_t n_outside;      /* contours that reach beyond the grid */
    size_t n_not_planar;   /* contours that leave their plane by more than 0.01 mm; they are flattened into it */
    size_t n_not_parallel; /* contours tilted by more than 5 degrees against the largest one; left out */
    size_t n_degenerate;   /* contours with fewer than 3 points or no area; left out */
    size_t n_repeated;     /* contours that repeat another of their plane; left out */
    size_t n_overlap_planes; /* planes with contours that partly overlap */
    size_t n_moved_planes;   /* planes that lie beside the slices of the grid they were filled on */
    double moved_mm;         /* largest distance of such a plane from the nearest slice */
    size_t n_close_planes;   /* planes joined with a neighbour, as they are much closer than the usual distance */
    size_t n_not_finite;     /* contours with a coordinate that is not finite or beyond CONTOUR_MAX_MM; left out */
};

/* Sets the voxels of the grid whose centres the contours enclose.
 *
 * Each plane stands for a slab: half way to its neighbours on both sides; the slab of an outermost plane is a full
 * spacing thick. The spacing is the median distance of neighbouring planes (options->spacing_mm where there are fewer
 * than four and they are further apart). A distance over 1.5 spacings is a gap, into which the slab on either side
 * reaches half a spacing. A voxel is inside if its centre is in a slab and the contours of that plane enclose its
 * projection along the normal. A centre on an edge belongs to one side only, so regions that share an edge
 * share no voxel. Planes may have any orientation to the grid.
 *
 *   facts    filled on success; may be NULL
 *   returns  a mask on the whole grid, the caller's, possibly empty; NULL on failure
 *   errors   ERROR_LIMIT CONTOUR_MAX_POINTS, CONTOUR_MAX_PLANES, CONTOUR_MAX_MEETINGS; ERROR_MEMORY
 *   thread   any; equal bits for any number of threads */
NODISCARD struct mask *contour_fill(const struct contour_set *set, const struct grid *grid,
                                    const struct contour_options *options, struct contour_facts *facts,
                                    struct error *err);

/* The plane spacing of most sets, weighted by their number of planes. If no set has two planes: the slice distance of
 * the image along the planes' normal, or 1 mm if image is NULL. */
double contour_usual_spacing_mm(const struct contour_set *sets, size_t n_sets, const struct grid *image);

struct contour_choice {
    struct grid grid;
    uint32_t subdivision[3]; /* parts of an image voxel (or of its continuation) along each
                                axis, 1..CONTOUR_MAX_SUBDIVISION; 1 1 1 on the image's own grid */
    uint32_t group; /* sets of equal group have equal grids and may share a layer; group 0 has the image's own grid */
    double volume_error; /* relative error of the volume on this grid; NaN for an empty set, and for a set beyond the
                            limits of contour_fill */
    bool is_short;       /* volume_error is over the target, and no finer grid was allowed */
    bool is_beyond;      /* the contours leave the image, and this grid covers them; its voxels are not the image's */
};

/* Chooses a label grid for each set. It is the image's own grid if the volume on it is accurate enough; else the
 * coarsest whole subdivision of it that is, cropped to the regions that need the same. Contours that leave the image
 * get a grid cropped to them that continues the image's voxels; if their planes reach beyond the image's slices and are
 * not on its slice positions, that grid has a slice per plane. It is coarsened to most_voxels. Contours further than
 * CONTOUR_MAX_REACH_MM beyond the image, or beyond a limit of contour_fill on such a grid, stay on the image's grid,
 * which cuts them.
 *
 *   accuracy  1 % of the polygon volume from 1 cm3 on, 5 % below; and at least one voxel
 *   image     NULL: the grid has the planes' orientation and spacing, and 1 mm in the plane or as coarse as most_voxels
 *             requires
 *   errors    ERROR_RANGE no set has a contour and there is no image; ERROR_LIMIT (without an image); ERROR_MEMORY
 *   thread    any */
NODISCARD bool contour_choose_grids(const struct contour_set *sets, size_t n_sets, const struct grid *image,
                                    const struct contour_options *options, struct contour_choice *choices,
                                    struct error *err);

void contour_set_finish(struct contour_set *set);
