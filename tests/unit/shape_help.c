/* Grids, a ball and voxel tests for shapes. */
#include "tests/unit/shape_help.h"

#include <stdlib.h>

#include "tests/check.h"

const struct affine maps[N_MAPS] = {
    { { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, { 0, 0, 0 } },
    { { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 5.5 } }, { -20, 7, -130 } },
    { { { 1, 0, 0 }, { 0, -2, 0 }, { 0, 0, 3 } }, { 3, 4, 5 } },
    { { { 0.3, 0.4, 2 }, { 1.2, -0.9, 0 }, { 0.72, 0.96, -0.3 } }, { 11, -12, 13 } },
};

struct vec3 load_vec3(const float *at)
{
    return vec3((double)at[0], (double)at[1], (double)at[2]);
}

struct vec3 mesh_position(const struct mesh *mesh, uint32_t vertex)
{
    const float *p = mesh->positions_lps_mm + 3 * (size_t)vertex;
    return vec3((double)p[0], (double)p[1], (double)p[2]);
}

struct vec3 index_of(const struct mask *mask, struct vec3 lps_mm)
{
    struct affine back;
    assert_true(affine_invert(&mask->lps_mm_from_ijk, &back));
    return affine_point(&back, lps_mm);
}

bool is_border(const struct mask *mask, int64_t i, int64_t j, int64_t k)
{
    return mask_has(mask, i, j, k) &&
           !(mask_has(mask, i - 1, j, k) && mask_has(mask, i + 1, j, k) && mask_has(mask, i, j - 1, k) &&
             mask_has(mask, i, j + 1, k) && mask_has(mask, i, j, k - 1) && mask_has(mask, i, j, k + 1));
}

size_t count_border(const struct mask *mask)
{
    size_t n = 0;
    for (int64_t k = 0; k < mask->size[2]; k++)
        for (int64_t j = 0; j < mask->size[1]; j++)
            for (int64_t i = 0; i < mask->size[0]; i++)
                n += is_border(mask, i, j, k);
    return n;
}

struct mask *ball_mask(double radius_mm, const struct affine *map)
{
    struct mask *mask = mask_make(30, 30, 30, map);
    for (uint32_t k = 0; k < 30; k++)
        for (uint32_t j = 0; j < 30; j++)
            for (uint32_t i = 0; i < 30; i++) {
                struct vec3 d = affine_vector(map, vec3(i - 14.5, j - 14.5, k - 14.5));
                if (vec3_length(d) <= radius_mm)
                    mask_put(mask, i, j, k);
            }
    return mask;
}

struct point_set *made_points(const struct mask *mask, int n_threads)
{
    struct error err = { 0 };
    struct point_set *set = shape_points(mask, n_threads, &err);
    assert_string_equal(err.text, "");
    assert_non_null(set);
    return set;
}

void made_points_finish(struct point_set *set)
{
    free(set->positions_lps_mm);
    free(set->normals);
    free(set->shade);
    free(set);
}
