/* Fills the voxels enclosed by the contours of one region: planes, then raster, then facts. */
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/region/contour_raster.h"

const struct contour_options contour_defaults = { .n_threads = 2, .spacing_mm = 0, .most_voxels = (uint64_t)64 << 20 };

void contour_set_finish(struct contour_set *set)
{
    for (size_t i = 0; i < set->n_contours; i++)
        free(set->contours[i].points_lps_mm);
    free(set->contours);
    *set = (struct contour_set){ 0 };
}

/* Returns true if a point of the contour is beyond the outer faces of the grid by more than rounding. */
static bool is_outside(const struct contour *contour, const struct grid *grid)
{
    const double most = 1e-3; /* in voxels */
    for (size_t i = 0; i < contour->n_points; i++) {
        const double *p = contour->points_lps_mm + 3 * i;
        struct vec3 at = affine_point(&grid->ijk_from_lps_mm, vec3(p[0], p[1], p[2]));
        if (!(fmin(at.x, fmin(at.y, at.z)) >= -0.5 - most && at.x <= grid->size[0] - 0.5 + most &&
              at.y <= grid->size[1] - 0.5 + most && at.z <= grid->size[2] - 0.5 + most))
            return true;
    }
    return false;
}

static bool measure(const struct contour_raster *raster, const struct contour_planes *planes,
                    struct contour_facts *facts, struct error *err)
{
    double *areas_mm2 = mem_array(planes->n_planes, sizeof *areas_mm2, UINT64_MAX, err);
    if (!areas_mm2)
        return false;
    bool is_measured = contour_raster_areas(raster, areas_mm2, err);
    for (size_t i = 0; is_measured && i < planes->n_planes; i++)
        facts->polygon_cm3 += areas_mm2[i] * (planes->planes[i].high_mm - planes->planes[i].low_mm) / 1000;
    free(areas_mm2);
    return is_measured;
}

struct mask *contour_fill(const struct contour_set *set, const struct grid *grid, const struct contour_options *options,
                          struct contour_facts *facts, struct error *err)
{
    struct contour_planes planes;
    if (!contour_planes_init(&planes, set, options->spacing_mm, grid, err))
        return NULL;
    struct contour_facts found = planes.facts;
    uint64_t n_voxels = 0;
    struct contour_raster *raster = contour_raster_create(&planes, grid, err);
    struct mask *mask = raster ? mask_create_empty(grid->size, &grid->lps_mm_from_ijk, err) : NULL;
    if (mask &&
        (!contour_raster_fill(raster, grid, mask->bits, options->n_threads, CONTOUR_MAX_MEETINGS, &n_voxels, err) ||
         (facts && !measure(raster, &planes, &found, err)))) {
        mask_destroy(mask);
        mask = NULL;
    }
    if (mask && facts) {
        found.filled_cm3 = (double)n_voxels * grid_voxel_mm3(grid) / 1000;
        for (size_t i = 0; i < planes.n_contours; i++)
            found.n_outside += is_outside(planes.contours[i], grid);
        *facts = found;
    }
    contour_raster_destroy(raster);
    contour_planes_finish(&planes);
    return mask;
}
