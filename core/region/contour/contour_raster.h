#pragma once
/* Inside of contour filling: intersects the edges of sorted contours with the rows of a grid. */
#include "core/region/contour/contour_combine.h"

struct contour_raster;

/* Projects the edges for a grid; then any grid with the same axis directions can be filled. planes is borrowed. Errors:
 * ERROR_LIMIT and
 * ERROR_MEMORY, as contour_combine. */
NODISCARD struct contour_raster *contour_raster_create(const struct contour_planes *planes, const struct grid *grid,
                                                       struct error *err);
void contour_raster_destroy(struct contour_raster *raster);
/* How the contours of each plane were combined; the raster's. */
const struct contour_combining *contour_raster_combining(const struct contour_raster *raster);

/* Enclosed area of every plane, mm2. Exact, except for contours that cross each other or themselves and for planes of
 * more than 4096 points: there it is integrated on lines 1/256 of the plane's height apart, or nearer. Errors:
 * ERROR_LIMIT CONTOUR_MAX_MEETINGS, ERROR_MEMORY. */
NODISCARD bool contour_raster_areas(const struct contour_raster *raster, double *areas_mm2, struct error *err);

/* Sets the bits of the enclosed voxels and counts them.
 *
 *   grid    the one of contour_raster_create, or a subdivided or cropped one
 *   bits    rows of words as in struct mask, zeroed by the caller; NULL: only counts
 *   most    limit on the intersections of edges and rows
 *   errors  ERROR_LIMIT more than `most`; ERROR_MEMORY */
NODISCARD bool contour_raster_fill(const struct contour_raster *raster, const struct grid *grid, uint64_t *bits,
                                   int n_threads, uint64_t most, uint64_t *n_voxels, struct error *err);
