#pragma once
/* A voxel grid and its values: an image, a label layer or a dose component. Frozen once published.
 * Knows nothing of files, regions or doses. */
#include <stddef.h>
#include <stdint.h>

#include "core/base/error.h"
#include "core/math/vec.h"

enum { VOLUME_MAX_SIDE = 4096 };
#define VOLUME_MAX_BYTES ((uint64_t)4 << 30)

/* No voxel is further from the origin along any axis, as a scene's slices (proto/scene.json): no treatment room is as
 * large. */
#define GRID_FARTHEST_MM 10000.0

struct grid {
    uint32_t size[3]; /* voxels along i, j, k; each 1..VOLUME_MAX_SIDE */
    struct affine
        lps_mm_from_ijk; /* voxel centres at whole indices; any orientation, either handedness, never singular */
    struct affine ijk_from_lps_mm; /* its inverse; grid_init keeps the two in step */
};

/* errors ERROR_RANGE a side out of range, a singular or not finite matrix (spacings outside 1e-4..1e4 mm included), a
 * voxel beyond GRID_FARTHEST_MM */
NODISCARD bool grid_init(struct grid *grid, const uint32_t size[3], const struct affine *lps_mm_from_ijk,
                         struct error *err);
size_t grid_n_voxels(const struct grid *grid);
double grid_voxel_mm3(const struct grid *grid);
bool grid_is_same(const struct grid *a,
                  const struct grid *b); /* corners of the one lie within a hundredth of a voxel of the other's */
struct vec3 grid_spacing_mm(const struct grid *grid);    /* lengths of the three columns */
struct box3 grid_bounds_lps_mm(const struct grid *grid); /* outer faces of the outermost voxels */
/* Index axis (0, 1, 2) most nearly along the patient axis (0 = L, 1 = P, 2 = S). A permutation: axes are dealt out by
 * the largest remaining cosine. sign, if given, is +1 or -1: whether the index grows with the axis. */
int grid_index_axis(const struct grid *grid, int patient_axis, int *sign);
/* Which side of the patient each index grows toward, as three letters of L R, P A, S I; "LPS" for a standard axial
 * scan. */
void grid_letters(const struct grid *grid, char letters[4]);

enum voxel_type { VOXEL_U8, VOXEL_I16, VOXEL_U16, VOXEL_F32 };
size_t voxel_size(enum voxel_type type);

struct volume {
    struct grid grid;
    enum voxel_type type;
    void *voxels;         /* [k][j][i], i fastest; raw values */
    double slope, offset; /* value = raw * slope + offset */
    double low,
        high; /* smallest and largest finite value; set by volume_measure, 0 and 0 before or when there is none */
    _Atomic int references;
};

/* Zeroed voxels, slope 1, offset 0. One reference, the caller's. errors ERROR_RANGE, ERROR_LIMIT (VOLUME_MAX_BYTES),
 * ERROR_MEMORY */
NODISCARD struct volume *volume_create(const struct grid *grid, enum voxel_type type, struct error *err);
/* The same with voxels that hold anything: for a caller who fills them all. Large ones come on huge pages where there
 * are any. */
NODISCARD struct volume *volume_create_unset(const struct grid *grid, enum voxel_type type, struct error *err);
/* The same with voxels that are there already, from malloc; takes them. */
struct volume *volume_take(const struct grid *grid, enum voxel_type type, void *voxels);
struct volume *volume_ref(const struct volume *volume);
void volume_unref(const struct volume *volume);

void volume_measure(struct volume *volume); /* before publishing */
double volume_value(const struct volume *volume, uint32_t i, uint32_t j, uint32_t k);
/* Raw label at an index; 0 outside or where a float is not a label. */
uint16_t volume_label(const struct volume *volume, uint32_t i, uint32_t j, uint32_t k);
/* Index of the voxel that holds a patient point; false outside the grid's outer faces. */
bool volume_voxel_at(const struct volume *volume, struct vec3 point_lps_mm, uint32_t ijk[3]);
/* Tri-linear between voxel centres, clamped to the outermost centres; false outside the outer faces or at a value that
 * is not finite. */
bool volume_sample(const struct volume *volume, struct vec3 point_lps_mm, double *value);
