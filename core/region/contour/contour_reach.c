/* Continues the image's voxel lattice around contours that leave the image. */
#include "core/region/contour/contour_reach.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

#define ALIGNED_COSINE \
    (1 - 1e-9)              /* contour planes count as parallel to the grid's; nearly parallel ones were snapped by \
                               contour_planes_init */
#define SAME_STEP 1e-3      /* in slices: tolerance for planes being the image's slices */
#define LEAST_IN_PLANE 64.0 /* in voxels of the image: coarsest in-plane step; after that, slices are joined */
#define OUTSIDE_VOXELS 1e-3 /* tolerance for rounding */

/* Extent of one set, in voxels of the image. */
struct extent {
    double low[3], high[3];
    bool is_known;
};

/* The lattice along each index axis of the image: index = first + step * whole number. */
struct lattice {
    double first[3], step[3];
    int along; /* the index axis along the contours' normal */
};

static struct extent extent_of(const struct contour_planes *planes, const struct grid *image)
{
    struct extent extent = { { INFINITY, INFINITY, INFINITY },
                             { -INFINITY, -INFINITY, -INFINITY },
                             planes->n_contours > 0 };
    for (size_t c = 0; c < planes->n_contours; c++)
        for (size_t i = 0; i < planes->contours[c]->n_points; i++) {
            const double *p = planes->contours[c]->points_lps_mm + 3 * i;
            struct vec3 at = affine_point(&image->ijk_from_lps_mm, vec3(p[0], p[1], p[2]));
            const double index[3] = { at.x, at.y, at.z };
            for (int a = 0; a < 3; a++) {
                extent.low[a] = fmin(extent.low[a], index[a]);
                extent.high[a] = fmax(extent.high[a], index[a]);
            }
        }
    return extent;
}

bool contour_is_within(const struct contour_planes *planes, const struct grid *grid)
{
    struct extent extent = extent_of(planes, grid);
    bool is_within = true;
    for (int a = 0; a < 3 && extent.is_known; a++)
        is_within = is_within && extent.low[a] >= -0.5 - OUTSIDE_VOXELS &&
                    extent.high[a] <= grid->size[a] - 0.5 + OUTSIDE_VOXELS;
    return is_within;
}

static bool is_in_reach(const struct extent *extent, const struct grid *image)
{
    struct vec3 spacing = grid_spacing_mm(image);
    const double mm[3] = { spacing.x, spacing.y, spacing.z };
    for (int a = 0; a < 3; a++)
        if (!(-extent->low[a] * mm[a] <= CONTOUR_MAX_REACH_MM &&
              (extent->high[a] - image->size[a]) * mm[a] <= CONTOUR_MAX_REACH_MM))
            return false;
    return true;
}

/* Extends by the slabs of the outermost planes, which reach beyond the contours' points. */
static void add_slabs(struct extent *extent, const struct contour_planes *planes, const struct grid *image)
{
    double thickest_mm = 0;
    for (size_t i = 0; i < planes->n_planes; i++)
        thickest_mm = fmax(thickest_mm, planes->planes[i].high_mm - planes->planes[i].low_mm);
    struct vec3 half = affine_vector(&image->ijk_from_lps_mm, vec3_scale(planes->normal_lps, thickest_mm / 2));
    const double more[3] = { fabs(half.x), fabs(half.y), fabs(half.z) };
    for (int a = 0; a < 3; a++) {
        extent->low[a] -= more[a];
        extent->high[a] += more[a];
    }
}

/* Puts slices on the planes of this set, unless they are the image's slices already or are not parallel to the image's
 * planes. */
static void fit_planes(struct lattice *lattice, const struct contour_planes *planes, const struct grid *image)
{
    const struct vec3 *columns = image->lps_mm_from_ijk.columns;
    for (int a = 0; a < 3; a++) {
        lattice->first[a] = 0;
        lattice->step[a] = 1;
        if (fabs(vec3_dot(planes->normal_lps, vec3_normalize(columns[a]))) >
            fabs(vec3_dot(planes->normal_lps, vec3_normalize(columns[lattice->along]))))
            lattice->along = a;
    }
    int a = lattice->along;
    struct vec3 own = vec3_normalize(vec3_cross(columns[(a + 1) % 3], columns[(a + 2) % 3]));
    if (fabs(vec3_dot(own, planes->normal_lps)) < ALIGNED_COSINE)
        return;
    double pitch_mm = vec3_dot(columns[a], planes->normal_lps); /* negative if the index decreases along the normal */
    double step = planes->facts.spacing_mm / fabs(pitch_mm);
    double first = (planes->planes[0].at_mm - vec3_dot(planes->normal_lps, image->lps_mm_from_ijk.origin)) / pitch_mm;
    if (fabs(step - 1) <= SAME_STEP && fabs(first - floor(first + 0.5)) <= SAME_STEP)
        return;
    lattice->first[a] = first;
    lattice->step[a] = step;
}

/* The whole lattice steps around an extent, one more on each side. */
static void whole_steps(const struct lattice *lattice, const struct extent *extent, double first[3], double n[3])
{
    for (int a = 0; a < 3; a++) {
        first[a] = floor((extent->low[a] - lattice->first[a]) / lattice->step[a]) - 1;
        n[a] = ceil((extent->high[a] - lattice->first[a]) / lattice->step[a]) + 2 - first[a];
    }
}

/* Doubles steps until the lattice fits into a grid and the part around each set into most_voxels. */
static void coarsen(struct lattice *lattice, const struct extent *extents, const bool *is_marked, size_t n_sets,
                    const struct extent *all, double most_voxels)
{
    for (bool is_changed = true; is_changed;) {
        double first[3], n[3];
        bool is_large = false, is_narrow = false;
        is_changed = false;
        whole_steps(lattice, all, first, n);
        for (int a = 0; a < 3; a++)
            if (n[a] > VOLUME_MAX_SIDE) {
                lattice->step[a] *= 2;
                is_changed = true;
            }
        for (size_t i = 0; i < n_sets && !is_changed && !is_large; i++)
            if (is_marked[i]) {
                whole_steps(lattice, &extents[i], first, n);
                is_large = n[0] * n[1] * n[2] > most_voxels;
                is_narrow = n[0] * n[1] * n[2] <= LEAST_IN_PLANE * n[lattice->along];
            }
        for (int a = 0; a < 3 && is_large; a++)
            if ((a == lattice->along) == is_narrow) {
                lattice->step[a] *= 2;
                is_changed = true;
            }
    }
}

static bool make_grid(struct grid *grid, const struct lattice *lattice, const struct extent *all,
                      const struct grid *image)
{
    struct affine map;
    uint32_t size[3];
    double first[3], n[3], origin[3];
    whole_steps(lattice, all, first, n);
    for (int a = 0; a < 3; a++) {
        size[a] = (uint32_t)n[a];
        origin[a] = lattice->first[a] + first[a] * lattice->step[a];
        map.columns[a] = vec3_scale(image->lps_mm_from_ijk.columns[a], lattice->step[a]);
    }
    map.origin = affine_point(&image->lps_mm_from_ijk, vec3(origin[0], origin[1], origin[2]));
    return grid_init(grid, size, &map, NULL);
}

bool contour_reach_grid(const struct contour_set *sets, bool *is_marked, size_t n_sets, const struct grid *image,
                        const struct contour_options *options, struct grid *reach, bool *has_grid, struct error *err)
{
    struct extent *extents = mem_array(n_sets, sizeof *extents, UINT64_MAX, err);
    if (!extents)
        return false;
    struct extent all = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY }, false };
    struct lattice lattice = { .along = 0 };
    size_t most_planes = 0;
    bool is_sorted = true;
    for (size_t i = 0; i < n_sets && is_sorted; i++) {
        struct contour_planes planes;
        if (!is_marked[i])
            continue;
        is_sorted = contour_planes_init(&planes, &sets[i], options->spacing_mm, image, err);
        if (!is_sorted)
            break;
        extents[i] = extent_of(&planes, image);
        is_marked[i] = extents[i].is_known && is_in_reach(&extents[i], image);
        if (is_marked[i]) {
            add_slabs(&extents[i], &planes, image);
            for (int a = 0; a < 3; a++) {
                all.low[a] = fmin(all.low[a], extents[i].low[a]);
                all.high[a] = fmax(all.high[a], extents[i].high[a]);
            }
            all.is_known = true;
        }
        if (is_marked[i] && planes.n_planes > most_planes) {
            most_planes = planes.n_planes;
            lattice = (struct lattice){ .along = 0 };
            fit_planes(&lattice, &planes, image);
        }
        contour_planes_finish(&planes);
    }
    *has_grid = is_sorted && all.is_known;
    if (*has_grid && all.low[lattice.along] >= -0.5 && all.high[lattice.along] <= image->size[lattice.along] - 0.5) {
        lattice.first[lattice.along] = 0; /* the image has slices all along: continue them */
        lattice.step[lattice.along] = 1;
    }
    if (*has_grid) {
        coarsen(&lattice, extents, is_marked, n_sets, &all, (double)options->most_voxels);
        *has_grid = make_grid(reach, &lattice, &all, image);
    }
    for (size_t i = 0; i < n_sets && !*has_grid; i++)
        is_marked[i] = false;
    free(extents);
    return is_sorted;
}
