#pragma once
/* Closed planar contours, and the voxels they enclose. Knows nothing of DICOM, files or reports.
 *
 * How a caller goes about a set of regions that were drawn together:
 *     options.spacing_mm = contour_usual_spacing_mm(sets, n_sets, image_grid);
 *     contour_choose_grids(sets, n_sets, image_grid, &options, choices, &err);
 *     for each: mask = contour_fill(&sets[i], &choices[i].grid, &options, &facts, &err);
 *               lay it into a label layer on that grid (contour_layer.h), then mask_destroy(mask) */
#include "core/region/mask.h"

enum {
    CONTOUR_MAX_POINTS = 10000000, /* of one set */
    CONTOUR_MAX_PLANES = 8192,     /* of one set */
    CONTOUR_MAX_SUBDIVISION = 16   /* of a voxel of the image, along each axis */
};
#define CONTOUR_MAX_MEETINGS ((uint64_t)1 << 27) /* of an edge and a row of voxels, in one filling */
#define CONTOUR_MAX_MM 1e5                       /* a contour with a coordinate beyond is left out */
#define CONTOUR_MAX_REACH_MM 2000.0 /* how far beyond the image a region is still shown whole: no patient is longer */

struct contour {
    double *points_lps_mm; /* [n_points][3] */
    size_t n_points;       /* the last is joined to the first */
};

/* The contours of one region. On one plane they combine by even-odd: an outline inside another is a hole, one inside
 * that an island; a hole joined to its outline by a channel of no width (keyhole) comes out the same. */
struct contour_set {
    struct contour *contours;
    size_t n_contours;
};

struct contour_options {
    int n_threads;     /* at least 1 */
    double spacing_mm; /* of planes where a region's own do not tell (fewer than four); 0: they tell, and a single one
                        * is as thick as the grid's spacing along its normal */
    uint64_t most_voxels; /* in one grid that contour_choose_grids makes itself */
};
extern const struct contour_options contour_defaults; /* 2 threads, 0 mm, 64 Mi voxels */

struct contour_facts {
    size_t n_planes;
    double polygon_cm3;   /* area of each plane by even-odd, times the slab it stands for */
    double filled_cm3;    /* of the voxels */
    double spacing_mm;    /* of neighbouring planes, the usual one; with a single plane the thickness it was given */
    size_t n_gaps;        /* places where the next plane is further away than that; nothing is filled there */
    double widest_gap_mm; /* 0 without one */
    size_t n_outside;     /* contours that reach beyond the grid */
    size_t
        n_not_planar; /* contours that leave their plane by more than a hundredth of a mm; they are flattened into it */
    size_t n_not_parallel; /* contours tilted by more than 5 degrees against the largest one; left out */
    size_t n_degenerate;   /* fewer than 3 points, or no area; left out */
    size_t n_repeated;     /* the same points as another contour; left out, as even-odd would make a hole of the pair */
    size_t n_not_finite;   /* contours with a point that is no number or beyond CONTOUR_MAX_MM; left out */
};

/* The voxels of the grid whose centres the contours enclose.
 *
 *   method   A plane stands for a slab: half way to its neighbours on both sides, a full spacing for the outermost
 * planes. The spacing is the median distance of neighbouring planes (options->spacing_mm where there are fewer than
 * four and they lie further apart); a distance over 1.5 of it is a gap, into which either side reaches half a spacing.
 * A voxel is inside when its centre lies in a slab and its projection along the planes' normal is enclosed by that
 * plane's contours (even-odd). Centres that lie on an edge belong to one side only, so regions that share an edge share
 * no voxel. Planes may have any orientation to the grid. facts    filled on success; may be NULL returns  a mask on the
 * whole grid, the caller's, possibly empty; NULL on failure errors   ERROR_LIMIT CONTOUR_MAX_POINTS,
 * CONTOUR_MAX_PLANES, CONTOUR_MAX_MEETINGS; ERROR_MEMORY thread   any; equal bits for any number of threads */
NODISCARD struct mask *contour_fill(const struct contour_set *set, const struct grid *grid,
                                    const struct contour_options *options, struct contour_facts *facts,
                                    struct error *err);

/* The spacing of planes most sets have, weighted by their planes; when no set has two planes, that of the image's
 * slices along the planes' normal (image may be NULL: 1 mm). */
double contour_usual_spacing_mm(const struct contour_set *sets, size_t n_sets, const struct grid *image);

struct contour_choice {
    struct grid grid;
    uint32_t subdivision[3]; /* of the image's voxels, or of those beyond it, each 1..CONTOUR_MAX_SUBDIVISION; 1 1 1
                                with the image's own grid */
    uint32_t group;      /* sets with equal numbers have equal grids and may share a layer; 0 is the image's own grid */
    double volume_error; /* relative, on this grid; not-a-number for an empty set and one beyond the limits of
                            contour_fill */
    bool is_short;       /* more than was asked for, and no finer grid was allowed */
    bool is_beyond; /* the contours leave the image, and the grid covers them; its voxels are then not the image's */
};

/* A label grid for each set: the image's own where it holds the volume, else the coarsest whole subdivision of it that
 * does, cropped to the regions that need the same. Contours that leave the image get a grid that covers them, cropped
 * to them: the image's voxels continued, with a slice for each plane where their planes reach beyond the image's slices
 * and do not lie on those. It is as coarse as most_voxels asks; contours further than CONTOUR_MAX_REACH_MM beyond the
 * image, or beyond a limit of contour_fill there, stay on the image's grid, which cuts them.
 *
 *   accuracy  1 % of the polygon volume from 1 cm3 on, 5 % below; and at least one voxel
 *   image     NULL: a grid from the planes: their orientation, their spacing, 1 mm in the plane or as coarse as
 * most_voxels asks errors    ERROR_RANGE no set has a contour and there is no image; ERROR_LIMIT (without an image),
 * ERROR_MEMORY */
NODISCARD bool contour_choose_grids(const struct contour_set *sets, size_t n_sets, const struct grid *image,
                                    const struct contour_options *options, struct contour_choice *choices,
                                    struct error *err);

void contour_set_finish(struct contour_set *set);
