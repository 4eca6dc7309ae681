/* Fills the voxels enclosed by the contours of one region: planes, then raster, then facts. */
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/region/contour/contour_check.h"
#include "core/region/contour/contour_raster.h"

#define PARALLEL_COSINE (1 - 1e-9) /* as in contour_reach.c: nearly parallel planes were snapped */
#define MOVED_MM 0.05              /* rounding of decimals in files */

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

/* The part of a plane's slab between the outermost faces of the grid along the normal. */
static double thickness_within_mm(const struct contour_plane *plane, const double faces_mm[2])
{
    return fmax(0, fmin(faces_mm[1], plane->high_mm) - fmax(faces_mm[0], plane->low_mm));
}

static void find_faces(const struct grid *grid, struct vec3 normal, double faces_mm[2])
{
    faces_mm[0] = INFINITY;
    faces_mm[1] = -INFINITY;
    for (int corner = 0; corner < 8; corner++) {
        struct vec3 at = vec3(corner & 1 ? grid->size[0] - 0.5 : -0.5, corner & 2 ? grid->size[1] - 0.5 : -0.5,
                              corner & 4 ? grid->size[2] - 0.5 : -0.5);
        double d = vec3_dot(normal, affine_point(&grid->lps_mm_from_ijk, at));
        faces_mm[0] = fmin(faces_mm[0], d);
        faces_mm[1] = fmax(faces_mm[1], d);
    }
}

/* Estimates the volume from the outlines, without the raster. */
static void check(const struct contour_combining *combining, const struct contour_planes *planes,
                  const struct grid *grid, struct contour_facts *facts)
{
    uint64_t n_steps = 0;
    double faces_mm[2];
    find_faces(grid, planes->normal_lps, faces_mm);
    facts->n_repeated += combining->n_repeated;
    facts->n_overlap_planes = combining->n_overlap_planes;
    for (size_t i = 0; i < planes->n_planes; i++) {
        size_t first = combining->layers[combining->layer_starts[i]].first,
               end = combining->layers[combining->layer_starts[i + 1] - 1].end;
        double mm2 = contour_outlines_mm2(combining->members + first, end - first, planes->normal_lps, &n_steps);
        facts->outlines_cm3 += mm2 * thickness_within_mm(&planes->planes[i], faces_mm) / 1000;
    }
}

/* Finds planes that lie beside the slices, where the grid's slices are parallel to the planes. */
static void find_moved(const struct contour_planes *planes, const struct grid *grid, struct contour_facts *facts)
{
    const struct vec3 *columns = grid->lps_mm_from_ijk.columns;
    for (int axis = 0; axis < 3; axis++) {
        struct vec3 normal = vec3_normalize(vec3_cross(columns[(axis + 1) % 3], columns[(axis + 2) % 3]));
        double pitch_mm = fabs(vec3_dot(columns[axis], planes->normal_lps));
        if (fabs(vec3_dot(normal, planes->normal_lps)) < PARALLEL_COSINE || grid->size[axis] < 2)
            continue;
        double first_mm = vec3_dot(planes->normal_lps, grid->lps_mm_from_ijk.origin);
        for (size_t i = 0; i < planes->n_planes; i++) {
            double at = (planes->planes[i].at_mm - first_mm) / pitch_mm, off_mm = fabs(at - floor(at + 0.5)) * pitch_mm;
            facts->n_moved_planes += off_mm > MOVED_MM;
            if (off_mm > MOVED_MM)
                facts->moved_mm = fmax(facts->moved_mm, off_mm);
        }
    }
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
        check(contour_raster_combining(raster), &planes, grid, &found);
        find_moved(&planes, grid, &found);
        *facts = found;
    }
    contour_raster_destroy(raster);
    contour_planes_finish(&planes);
    return mask;
}
