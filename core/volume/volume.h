#pragma once
/* A voxel grid with its values: an image, a label layer or a dose component. Frozen once published. Knows nothing of
 * files, regions or doses. Any thread. */
#include <stddef.h>
#include <stdint.h>

#include "core/base/error.h"
#include "core/math/vec.h"

enum { VOLUME_MAX_SIDE = 4096 };
#define VOLUME_MAX_BYTES ((uint64_t)4 << 30)

/* Limit on the distance of a voxel from the origin along any axis, equal to the limit of a scene's slices
 * (proto/scene.json): no treatment room is larger. */
#define GRID_FARTHEST_MM 10000.0

struct grid {
    uint32_t size[3]; /* number of voxels along i, j, k; each 1..VOLUME_MAX_SIDE */
    struct affine
        lps_mm_from_ijk; /* voxel centres are at whole indices; any orientation, either handedness, never singular */
    struct affine ijk_from_lps_mm; /* the inverse; grid_init keeps both consistent */
};

/* Sets size and map. Errors: ERROR_RANGE a side out of range, a matrix that is singular or not finite or has spacings
 * outside 1e-4..1e4 mm, a voxel beyond GRID_FARTHEST_MM. */
NODISCARD bool grid_init(struct grid *grid, const uint32_t size[3], const struct affine *lps_mm_from_ijk,
                         struct error *err);
size_t grid_n_voxels(const struct grid *grid);
double grid_voxel_mm3(const struct grid *grid);
/* True if the corners of both are within 0.01 voxel of each other. */
bool grid_is_same(const struct grid *a, const struct grid *b);
struct vec3 grid_spacing_mm(const struct grid *grid);    /* lengths of the three columns */
struct box3 grid_bounds_lps_mm(const struct grid *grid); /* to the outer faces of the outermost voxels */
/* The centre of the voxel nearest to a patient point in index space; of an outermost voxel if the point lies outside.
 */
struct vec3 grid_nearest_centre_lps_mm(const struct grid *grid, struct vec3 point_lps_mm);
/* Index axis (0, 1, 2) nearest to a patient axis (0 = L, 1 = P, 2 = S). The three form a permutation, assigned by
 * largest remaining cosine. sign, unless NULL, is +1 if the index grows along the patient axis, else -1. */
int grid_index_axis(const struct grid *grid, int patient_axis, int *sign);
/* The patient side towards which each index grows, as three letters of L R, P A, S I; "LPS" for a standard axial
 * scan. */
void grid_letters(const struct grid *grid, char letters[4]);

enum voxel_type { VOXEL_U8, VOXEL_I16, VOXEL_U16, VOXEL_F32 };
size_t voxel_size(enum voxel_type type);

struct volume {
    struct grid grid;
    enum voxel_type type;
    void *voxels;         /* [k][j][i], i fastest; raw values */
    double slope, offset; /* value = raw * slope + offset */
    double low, high; /* smallest and largest finite value, set by volume_measure; 0 and 0 before that, and without a
                         finite value */
    _Atomic int references;
};

/* Creates a volume with all voxels 0, slope 1, offset 0. One reference, the caller's. Errors: ERROR_RANGE, ERROR_LIMIT
 * (VOLUME_MAX_BYTES), ERROR_MEMORY. */
NODISCARD struct volume *volume_create(const struct grid *grid, enum voxel_type type, struct error *err);
/* Like volume_create, with uninitialized voxels, for a caller who writes them all. Large volumes use huge pages where
 * available. */
NODISCARD struct volume *volume_create_unset(const struct grid *grid, enum voxel_type type, struct error *err);
/* Like volume_create, with voxels allocated by malloc; takes them over. */
struct volume *volume_take(const struct grid *grid, enum voxel_type type, void *voxels);
struct volume *volume_ref(const struct volume *volume);
void volume_unref(const struct volume *volume);

void volume_measure(struct volume *volume); /* sets low and high; call before publishing */
double volume_value(const struct volume *volume, uint32_t i, uint32_t j, uint32_t k);
/* Raw label at an index; 0 outside the grid, and for a float that is no label. */
uint16_t volume_label(const struct volume *volume, uint32_t i, uint32_t j, uint32_t k);
/* Finds the voxel that contains a patient point; false outside the grid's outer faces. */
bool volume_voxel_at(const struct volume *volume, struct vec3 point_lps_mm, uint32_t ijk[3]);
/* Trilinear value between voxel centres, clamped to the outermost centres. Returns false outside the outer faces, or if
 * a value is not finite that counts: at a voxel's centre only its own does. */
bool volume_sample(const struct volume *volume, struct vec3 point_lps_mm, double *value);
/* volume_sample in two steps, for several volumes on one grid: where the point lies, and the value there. */
struct volume_place {
    uint32_t low[3], high[3]; /* voxels on either side, by axis */
    double weight[3];         /* of those at high */
};
bool volume_place_find(const struct grid *grid, struct vec3 point_lps_mm, struct volume_place *place);
bool volume_place_value(const struct volume *volume, const struct volume_place *place, double *value);
