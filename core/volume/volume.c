/* Grids and their maps; creates, shares, measures and samples volumes. */
#include "core/volume/volume.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "core/base/mem.h"

bool grid_init(struct grid *grid, const uint32_t size[3], const struct affine *lps_mm_from_ijk, struct error *err)
{
    for (int axis = 0; axis < 3; axis++) {
        if (size[axis] < 1 || size[axis] > VOLUME_MAX_SIDE)
            return error_set(err, ERROR_RANGE, "grid of %u x %u x %u voxels: each side must be 1 to %d", size[0],
                             size[1], size[2], VOLUME_MAX_SIDE);
        double spacing_mm = vec3_length(lps_mm_from_ijk->columns[axis]);
        if (!(spacing_mm >= 1e-4 && spacing_mm <= 1e4))
            return error_set(err, ERROR_RANGE, "voxel spacing %g mm along index axis %d is outside 0.0001 to 10000 mm",
                             spacing_mm, axis);
    }
    struct affine inverse;
    if (!affine_invert(lps_mm_from_ijk, &inverse))
        return error_set(err, ERROR_RANGE, "the index-to-patient matrix is singular or not finite");
    for (int corner = 0; corner < 8; corner++) {
        struct vec3 at = affine_point(lps_mm_from_ijk, vec3(corner & 1 ? size[0] - 1 : 0, corner & 2 ? size[1] - 1 : 0,
                                                            corner & 4 ? size[2] - 1 : 0));
        if (!(fmax(fmax(fabs(at.x), fabs(at.y)), fabs(at.z)) <= GRID_FARTHEST_MM))
            return error_set(
                err, ERROR_RANGE,
                "a grid's corner lies at L %g P %g S %g mm; expected within %g mm of the origin: are origin and spacing in mm?",
                at.x, at.y, at.z, GRID_FARTHEST_MM);
    }
    for (int axis = 0; axis < 3; axis++)
        grid->size[axis] = size[axis];
    grid->lps_mm_from_ijk = *lps_mm_from_ijk;
    grid->ijk_from_lps_mm = inverse;
    return true;
}

bool grid_is_same(const struct grid *a, const struct grid *b)
{
    for (int axis = 0; axis < 3; axis++)
        if (a->size[axis] != b->size[axis])
            return false;
    for (int corner = 0; corner < 8; corner++) {
        struct vec3 at =
            vec3(corner & 1 ? a->size[0] - 1 : 0, corner & 2 ? a->size[1] - 1 : 0, corner & 4 ? a->size[2] - 1 : 0);
        struct vec3 off = vec3_sub(affine_point(&b->ijk_from_lps_mm, affine_point(&a->lps_mm_from_ijk, at)), at);
        if (!(vec3_length(off) < 0.01))
            return false;
    }
    return true;
}

size_t grid_n_voxels(const struct grid *grid)
{
    return (size_t)grid->size[0] * grid->size[1] * grid->size[2];
}

double grid_voxel_mm3(const struct grid *grid)
{
    return fabs(affine_determinant(&grid->lps_mm_from_ijk));
}

struct vec3 grid_spacing_mm(const struct grid *grid)
{
    const struct vec3 *c = grid->lps_mm_from_ijk.columns;
    return vec3(vec3_length(c[0]), vec3_length(c[1]), vec3_length(c[2]));
}

struct box3 grid_bounds_lps_mm(const struct grid *grid)
{
    struct box3 box = box3_empty();
    for (int corner = 0; corner < 8; corner++)
        box3_add(&box, affine_point(&grid->lps_mm_from_ijk, vec3(corner & 1 ? grid->size[0] - 0.5 : -0.5,
                                                                 corner & 2 ? grid->size[1] - 0.5 : -0.5,
                                                                 corner & 4 ? grid->size[2] - 0.5 : -0.5)));
    return box;
}

static double nearest_index(double at, uint32_t size)
{
    return fmin(fmax(floor(at + 0.5), 0), size - 1.0);
}

struct vec3 grid_nearest_centre_lps_mm(const struct grid *grid, struct vec3 point_lps_mm)
{
    struct vec3 ijk = affine_point(&grid->ijk_from_lps_mm, point_lps_mm);
    return affine_point(&grid->lps_mm_from_ijk,
                        vec3(nearest_index(ijk.x, grid->size[0]), nearest_index(ijk.y, grid->size[1]),
                             nearest_index(ijk.z, grid->size[2])));
}

int grid_index_axis(const struct grid *grid, int patient_axis, int *sign)
{
    double cosines[3][3]; /* [index axis][patient axis] */
    for (int index = 0; index < 3; index++) {
        struct vec3 unit = vec3_normalize(grid->lps_mm_from_ijk.columns[index]);
        cosines[index][0] = unit.x;
        cosines[index][1] = unit.y;
        cosines[index][2] = unit.z;
    }
    bool index_used[3] = { false }, patient_used[3] = { false };
    for (int round = 0; round < 3; round++) {
        int best_index = -1, best_patient = -1;
        for (int index = 0; index < 3; index++)
            for (int patient = 0; patient < 3; patient++)
                if (!index_used[index] && !patient_used[patient] &&
                    (best_index < 0 || fabs(cosines[index][patient]) > fabs(cosines[best_index][best_patient]))) {
                    best_index = index;
                    best_patient = patient;
                }
        index_used[best_index] = patient_used[best_patient] = true;
        if (best_patient == patient_axis) {
            if (sign)
                *sign = cosines[best_index][best_patient] < 0 ? -1 : 1;
            return best_index;
        }
    }
    return patient_axis;
}

void grid_letters(const struct grid *grid, char letters[4])
{
    static const char toward[3][2] = { { 'L', 'R' }, { 'P', 'A' }, { 'S', 'I' } };
    for (int patient_axis = 0; patient_axis < 3; patient_axis++) {
        int sign, index_axis = grid_index_axis(grid, patient_axis, &sign);
        letters[index_axis] = toward[patient_axis][sign < 0];
    }
    letters[3] = 0;
}

size_t voxel_size(enum voxel_type type)
{
    switch (type) {
    case VOXEL_U8: return 1;
    case VOXEL_I16:
    case VOXEL_U16: return 2;
    case VOXEL_F32: return 4;
    }
    return 0;
}

static struct volume *create(const struct grid *grid, enum voxel_type type,
                             void *(*allocate)(size_t n, size_t size, uint64_t limit_bytes, struct error *err),
                             struct error *err)
{
    struct volume *volume = mem_new(sizeof *volume);
    volume->grid = *grid;
    volume->type = type;
    volume->slope = 1;
    atomic_init(&volume->references, 1);
    volume->voxels = allocate(grid_n_voxels(grid), voxel_size(type), VOLUME_MAX_BYTES, err);
    if (!volume->voxels) {
        free(volume);
        return NULL;
    }
    return volume;
}

struct volume *volume_create(const struct grid *grid, enum voxel_type type, struct error *err)
{
    return create(grid, type, mem_array, err);
}

struct volume *volume_create_unset(const struct grid *grid, enum voxel_type type, struct error *err)
{
    return create(grid, type, mem_large_array, err);
}

struct volume *volume_take(const struct grid *grid, enum voxel_type type, void *voxels)
{
    struct volume *volume = mem_new(sizeof *volume);
    volume->grid = *grid;
    volume->type = type;
    volume->slope = 1;
    volume->voxels = voxels;
    atomic_init(&volume->references, 1);
    return volume;
}

struct volume *volume_ref(const struct volume *volume)
{
    struct volume *shared = (struct volume *)volume;
    atomic_fetch_add(&shared->references, 1);
    return shared;
}

void volume_unref(const struct volume *volume)
{
    struct volume *shared = (struct volume *)volume;
    if (!shared || atomic_fetch_sub(&shared->references, 1) != 1)
        return;
    free(shared->voxels);
    free(shared);
}

static double raw_value(const struct volume *volume, size_t at)
{
    switch (volume->type) {
    case VOXEL_U8: return ((const uint8_t *)volume->voxels)[at];
    case VOXEL_I16: return ((const int16_t *)volume->voxels)[at];
    case VOXEL_U16: return ((const uint16_t *)volume->voxels)[at];
    case VOXEL_F32: return (double)((const float *)volume->voxels)[at];
    }
    return 0;
}

static size_t voxel_offset(const struct grid *grid, uint32_t i, uint32_t j, uint32_t k)
{
    return ((size_t)k * grid->size[1] + j) * grid->size[0] + i;
}

void volume_measure(struct volume *volume)
{
    double low = INFINITY, high = -INFINITY;
    size_t n = grid_n_voxels(&volume->grid);
#define SCAN(type) \
    do { \
        const type *v = volume->voxels; \
        type least = v[0], most = v[0]; \
        for (size_t at = 1; at < n; at++) { \
            least = v[at] < least ? v[at] : least; \
            most = v[at] > most ? v[at] : most; \
        } \
        low = (double)least; \
        high = (double)most; \
    } while (0)
    switch (volume->type) {
    case VOXEL_U8: SCAN(uint8_t); break;
    case VOXEL_I16: SCAN(int16_t); break;
    case VOXEL_U16: SCAN(uint16_t); break;
    case VOXEL_F32:
        for (size_t at = 0; at < n; at++) {
            double value = raw_value(volume, at);
            if (isfinite(value)) {
                low = fmin(low, value);
                high = fmax(high, value);
            }
        }
        break;
    }
#undef SCAN
    if (low > high)
        low = high = 0;
    double a = low * volume->slope + volume->offset, b = high * volume->slope + volume->offset;
    volume->low = fmin(a, b);
    volume->high = fmax(a, b);
}

double volume_value(const struct volume *volume, uint32_t i, uint32_t j, uint32_t k)
{
    return raw_value(volume, voxel_offset(&volume->grid, i, j, k)) * volume->slope + volume->offset;
}

uint16_t volume_label(const struct volume *volume, uint32_t i, uint32_t j, uint32_t k)
{
    const uint32_t *size = volume->grid.size;
    if (i >= size[0] || j >= size[1] || k >= size[2])
        return 0;
    double raw = raw_value(volume, voxel_offset(&volume->grid, i, j, k));
    return raw >= 0 && raw <= UINT16_MAX ? (uint16_t)raw : 0;
}

bool volume_voxel_at(const struct volume *volume, struct vec3 point_lps_mm, uint32_t ijk[3])
{
    struct vec3 p = affine_point(&volume->grid.ijk_from_lps_mm, point_lps_mm);
    const double at[3] = { p.x, p.y, p.z };
    for (int axis = 0; axis < 3; axis++) {
        double nearest = floor(at[axis] + 0.5);
        if (!(nearest >= 0 && nearest < volume->grid.size[axis]))
            return false;
        ijk[axis] = (uint32_t)nearest;
    }
    return true;
}

/* Nearer to a voxel's centre than rounding can tell: there a neighbour without a value does not count. In voxels. */
#define NEAR_CENTRE 1e-7

bool volume_place_find(const struct grid *grid, struct vec3 point_lps_mm, struct volume_place *place)
{
    const struct vec3 p = affine_point(&grid->ijk_from_lps_mm, point_lps_mm);
    const double at[3] = { p.x, p.y, p.z };
    for (int axis = 0; axis < 3; axis++) {
        const double nearest = floor(at[axis] + 0.5);
        if (!(nearest >= 0 && nearest < grid->size[axis]))
            return false;
        double last = grid->size[axis] - 1.0;
        double inside = fmin(fmax(at[axis], 0), last), nearest_centre = floor(inside + 0.5);
        if (fabs(inside - nearest_centre) < NEAR_CENTRE)
            inside = nearest_centre;
        place->low[axis] = (uint32_t)inside;
        place->high[axis] = place->low[axis] < (uint32_t)last ? place->low[axis] + 1 : place->low[axis];
        place->weight[axis] = inside - place->low[axis];
    }
    return true;
}

bool volume_place_value(const struct volume *volume, const struct volume_place *place, double *value)
{
    const uint32_t *low = place->low, *high = place->high;
    const double *weight = place->weight;
    double sum = 0;
    for (int corner = 0; corner < 8; corner++) {
        double share = (corner & 1 ? weight[0] : 1 - weight[0]) * (corner & 2 ? weight[1] : 1 - weight[1]) *
                       (corner & 4 ? weight[2] : 1 - weight[2]);
        if (share > 0)
            sum +=
                share * raw_value(volume, voxel_offset(&volume->grid, corner & 1 ? high[0] : low[0],
                                                       corner & 2 ? high[1] : low[1], corner & 4 ? high[2] : low[2]));
    }
    if (!isfinite(sum))
        return false;
    *value = sum * volume->slope + volume->offset;
    return true;
}

bool volume_sample(const struct volume *volume, struct vec3 point_lps_mm, double *value)
{
    struct volume_place place;
    return volume_place_find(&volume->grid, point_lps_mm, &place) && volume_place_value(volume, &place, value);
}
