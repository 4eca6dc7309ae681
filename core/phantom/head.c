/* The phantom's tissues as ellipsoids, and its image and labels. */
#include "core/phantom/head.h"

#include "core/base/parallel.h"

/* Scalp, cranium and brain: Goorley, Kiger and Zamenhof 2002, in mm; x = L, y = P, z = S, common origin. Target and
 * tumour are our own: to the patient's left and posterior, so that a mirrored picture is noticed at once. */
const struct phantom_tissue phantom_tissues[PHANTOM_N_LABELS] = {
    [PHANTOM_AIR] = { "air", "#000000", { { 0, 0, 0 }, { 0, 0, 0 } }, -1000 },
    [PHANTOM_SCALP] = { "scalp", "#e0bca0", { { 0, 0, 0 }, { 73, 103, 88 } }, 60 },
    [PHANTOM_CRANIUM] = { "cranium", "#e9e3d3", { { 0, 0, 0 }, { 68, 98, 83 } }, 950 },
    [PHANTOM_BRAIN] = { "brain", "#d696a0", { { 0, 0, 10 }, { 60, 90, 65 } }, 38 },
    [PHANTOM_TARGET] = { "target", "#e3c95b", { { 22, 20, 32 }, { 20, 22, 18 } }, 35 },
    [PHANTOM_TUMOUR] = { "tumour", "#46be50", { { 24, 24, 34 }, { 11, 12, 10 } }, 48 },
};

const struct ellipsoid phantom_marker = { { 76, 0, 0 }, { 5, 5, 5 } };
const double phantom_marker_hounsfield = 2000;

static const double field_of_view_mm[3] = { 256, 256, 204.8 };
static const double noise_hounsfield = 5; /* standard deviation, inside the body */

/* Squared distance from the centre in units of the semi-axes; at most 1 inside. */
static double ellipsoid_level(const struct ellipsoid *shape, struct vec3 p)
{
    struct vec3 d = vec3_sub(p, shape->centre_lps_mm);
    double x = d.x / shape->semi_axes_mm.x, y = d.y / shape->semi_axes_mm.y, z = d.z / shape->semi_axes_mm.z;
    return x * x + y * y + z * z;
}

enum phantom_label phantom_label_at(struct vec3 point_lps_mm)
{
    int label = PHANTOM_AIR;
    while (label + 1 < PHANTOM_N_LABELS && ellipsoid_level(&phantom_tissues[label + 1].shape, point_lps_mm) <= 1)
        label++;
    return (enum phantom_label)label;
}

double phantom_scalp_top_mm(double x_lps_mm, double y_lps_mm)
{
    const struct ellipsoid *scalp = &phantom_tissues[PHANTOM_SCALP].shape;
    double x = (x_lps_mm - scalp->centre_lps_mm.x) / scalp->semi_axes_mm.x;
    double y = (y_lps_mm - scalp->centre_lps_mm.y) / scalp->semi_axes_mm.y;
    double rest = 1 - x * x - y * y;
    return rest >= 0 ? scalp->centre_lps_mm.z + scalp->semi_axes_mm.z * sqrt(rest) : (double)NAN;
}

bool phantom_image_grid(const uint32_t size[3], struct grid *grid, struct error *err)
{
    struct affine map = { { { 0, 0, 0 }, { 0, 0, 0 }, { 0, 0, 0 } }, { 0, 0, 0 } };
    double spacing_mm[3], first_mm[3];
    for (int axis = 0; axis < 3; axis++) {
        spacing_mm[axis] = size[axis] ? field_of_view_mm[axis] / size[axis] : 0;
        first_mm[axis] = (spacing_mm[axis] - field_of_view_mm[axis]) / 2; /* centre of the first voxel */
    }
    map.columns[0].x = spacing_mm[0];
    map.columns[1].y = spacing_mm[1];
    map.columns[2].z = spacing_mm[2];
    map.origin = vec3(first_mm[0], first_mm[1], first_mm[2]);
    return grid_init(grid, size, &map, err);
}

uint64_t phantom_mix(uint64_t value)
{
    /* finaliser of splitmix64: G. L. Steele, D. Lea, C. H. Flood, Fast splittable pseudorandom number generators, 2014
     */
    value += 0x9e3779b97f4a7c15u;
    value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9u;
    value = (value ^ (value >> 27)) * 0x94d049bb133111ebu;
    return value ^ (value >> 31);
}

/* Sum of four uniform numbers: approximately normal, mean 0, standard deviation 1, never beyond 3.5. */
static double noise(uint64_t seed, uint64_t voxel)
{
    uint64_t bits = phantom_mix(seed ^ (voxel * 0xd1342543de82ef95u));
    double sum =
        (double)(bits & 0xffff) + (double)(bits >> 16 & 0xffff) + (double)(bits >> 32 & 0xffff) + (double)(bits >> 48);
    return (sum / 65535 - 2) * sqrt(3.0);
}

struct fill {
    const struct grid *grid;
    uint64_t seed;
    int16_t *ct;
    uint8_t *labels;
};

static void fill_part(void *context, int part, int n_parts)
{
    const struct fill *fill = context;
    const struct grid *grid = fill->grid;
    uint64_t seed = phantom_mix(fill->seed);
    for (uint32_t k = (uint32_t)part; k < grid->size[2]; k += (uint32_t)n_parts)
        for (uint32_t j = 0; j < grid->size[1]; j++) {
            size_t at = ((size_t)k * grid->size[1] + j) * grid->size[0];
            for (uint32_t i = 0; i < grid->size[0]; i++, at++) {
                struct vec3 p = affine_point(&grid->lps_mm_from_ijk, vec3(i, j, k));
                enum phantom_label label = phantom_label_at(p);
                double value = phantom_tissues[label].hounsfield;
                if (ellipsoid_level(&phantom_marker, p) <= 1)
                    value = phantom_marker_hounsfield;
                if (label != PHANTOM_AIR)
                    value += noise_hounsfield * noise(seed, at);
                fill->labels[at] = (uint8_t)label;
                fill->ct[at] = (int16_t)lround(value);
            }
        }
}

bool phantom_fill_head(const struct grid *grid, uint64_t seed, struct volume **ct, struct volume **labels,
                       struct error *err)
{
    *ct = volume_create(grid, VOXEL_I16, err);
    *labels = *ct ? volume_create(grid, VOXEL_U8, err) : NULL;
    if (!*labels) {
        volume_unref(*ct);
        *ct = NULL;
        return false;
    }
    struct fill fill = { grid, seed, (*ct)->voxels, (*labels)->voxels };
    parallel_run(parallel_cores(), fill_part, &fill);
    return true;
}
