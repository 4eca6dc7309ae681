#pragma once
/* Inside of contour filling: the edges of sorted contours against the rows of a grid. */
#include "core/region/contour_planes.h"

struct contour_raster;

/* Edges as the grid's rows will meet them; any grid with the same directions of axes may then be filled. planes is
 * borrowed. errors ERROR_MEMORY */
NODISCARD struct contour_raster *contour_raster_create(const struct contour_planes *planes, const struct grid *grid,
                                                       struct error *err);
void contour_raster_destroy(struct contour_raster *raster);

/* Area of every plane by even-odd, mm2: exact but for contours that cross each other or themselves, and for planes of
 * more than 4096 points; there on lines 1/256 of the plane's height apart, or nearer. errors ERROR_LIMIT
 * CONTOUR_MAX_MEETINGS, ERROR_MEMORY */
NODISCARD bool contour_raster_areas(const struct contour_raster *raster, double *areas_mm2, struct error *err);

/* Sets the bits of enclosed voxels and counts them.
 *   grid     that of contour_raster_create or a subdivided or cropped one
 *   bits     rows of words as in struct mask, zeroed; NULL: only counts
 *   most     of meetings of edges and rows
 *   errors   ERROR_LIMIT more than most meetings, ERROR_MEMORY */
NODISCARD bool contour_raster_fill(const struct contour_raster *raster, const struct grid *grid, uint64_t *bits,
                                   int n_threads, uint64_t most, uint64_t *n_voxels, struct error *err);
