/* Numbers the border voxels of a mask and estimates the direction each faces from its 26 neighbours. */
#include "core/surface/shape_border.h"

#include <stdlib.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/region/boundary.h"

struct border_job {
    struct shape_border *border;
    struct vec3 of_row[9][8]; /* by row of three neighbours and inside bits: sum of the directions to the outside ones,
                                 in index steps */
    struct vec3 covector[3];  /* converts a gradient per index step to one per mm */
};

size_t shape_border_number(const struct shape_border *border, int64_t i, int64_t j, int64_t k)
{
    const struct mask *mask = border->border;
    if (i < 0 || j < 0 || k < 0 || i >= mask->size[0] || j >= mask->size[1] || k >= mask->size[2])
        return SIZE_MAX;
    size_t at = ((size_t)k * mask->size[1] + (size_t)j) * mask->words + (size_t)i / 64;
    if (!(mask->bits[at] >> i % 64 & 1))
        return SIZE_MAX;
    return border->first[at] + (size_t)__builtin_popcountll(mask->bits[at] & (((uint64_t)1 << i % 64) - 1));
}

uint32_t shape_border_around(const struct mask *mask, uint32_t i, uint32_t j, uint32_t k)
{
    uint32_t around = 0;
    for (uint32_t row = 0; row < 9; row++) {
        int64_t y = (int64_t)j + row % 3 - 1, z = (int64_t)k + row / 3 - 1;
        if (y < 0 || z < 0 || y >= mask->size[1] || z >= mask->size[2])
            continue;
        const uint64_t *bits = mask->bits + ((size_t)z * mask->size[1] + (size_t)y) * mask->words;
        uint32_t w = i / 64, bit = i % 64, three;
        if (bit > 0)
            three = (uint32_t)(bits[w] >> (bit - 1)) & 7;
        else
            three = (uint32_t)(bits[w] << 1 & 6) | (w > 0 ? (uint32_t)(bits[w - 1] >> 63) : 0);
        if (bit == 63)
            three = (three & 3) | (w + 1 < mask->words ? (uint32_t)(bits[w + 1] & 1) << 2 : 0);
        around |= three << 3 * row;
    }
    return around;
}

/* Prepares unit steps in each of the 26 directions (S. W. Zucker, R. A. Hummel, A three-dimensional edge operator, IEEE
 * Trans. PAMI 3, 1981). The inverse transpose of the map converts a gradient per step to one per mm, so that slopes are
 * right in space also where slices are far apart. */
static void prepare(struct border_job *job)
{
    for (int row = 0; row < 9; row++)
        for (int inside = 0; inside < 8; inside++) {
            struct vec3 sum = vec3(0, 0, 0);
            for (int x = 0; x < 3; x++)
                if (!(inside >> x & 1))
                    sum = vec3_add(sum, vec3_normalize(vec3(x - 1, row % 3 - 1, row / 3 - 1)));
            job->of_row[row][inside] = sum;
        }
    const struct vec3 *c = job->border->mask->lps_mm_from_ijk.columns;
    double sign = affine_determinant(&job->border->mask->lps_mm_from_ijk) < 0 ? -1 : 1;
    for (int axis = 0; axis < 3; axis++)
        job->covector[axis] = vec3_scale(vec3_cross(c[(axis + 1) % 3], c[(axis + 2) % 3]), sign);
}

static struct vec3 normal_at(const struct border_job *job, uint32_t i, uint32_t j, uint32_t k)
{
    uint32_t around = shape_border_around(job->border->mask, i, j, k);
    struct vec3 sum = vec3(0, 0, 0);
    for (int row = 0; row < 9; row++)
        sum = vec3_add(sum, job->of_row[row][around >> 3 * row & 7]);
    if (vec3_dot(sum, sum) < 1e-12) /* opposite sides cancel except for rounding */
        return vec3(0, 0, 0);
    struct vec3 normal = vec3_add(vec3_scale(job->covector[0], sum.x),
                                  vec3_add(vec3_scale(job->covector[1], sum.y), vec3_scale(job->covector[2], sum.z)));
    return vec3_normalize(normal);
}

static void fill_part(void *context, int part, int n_parts)
{
    const struct border_job *job = context;
    const struct shape_border *border = job->border;
    const struct mask *mask = border->border;
    size_t n_rows = (size_t)mask->size[1] * mask->size[2], end = n_rows * (size_t)(part + 1) / (size_t)n_parts;
    for (size_t row = n_rows * (size_t)part / (size_t)n_parts; row < end; row++) {
        size_t at = border->first[row * mask->words];
        uint32_t j = (uint32_t)(row % mask->size[1]), k = (uint32_t)(row / mask->size[1]);
        for (uint32_t w = 0; w < mask->words; w++)
            for (uint64_t left = mask->bits[row * mask->words + w]; left; left &= left - 1, at++) {
                uint32_t i = 64 * w + (uint32_t)__builtin_ctzll(left);
                struct vec3 normal = normal_at(job, i, j, k);
                border->ijk[3 * at] = (uint16_t)i;
                border->ijk[3 * at + 1] = (uint16_t)j;
                border->ijk[3 * at + 2] = (uint16_t)k;
                border->normals[3 * at] = (float)normal.x;
                border->normals[3 * at + 1] = (float)normal.y;
                border->normals[3 * at + 2] = (float)normal.z;
            }
    }
}

static bool number_voxels(struct shape_border *border, size_t max_voxels, struct error *err)
{
    const struct mask *mask = border->border;
    size_t n_words = (size_t)mask->size[1] * mask->size[2] * mask->words;
    uint64_t n = mask_count(mask);
    if (n > max_voxels)
        return error_set(err, ERROR_LIMIT, "a border of %llu voxels: at most %zu are allowed", (unsigned long long)n,
                         max_voxels);
    border->n = (size_t)n;
    border->first = mem_array(n_words, sizeof *border->first, UINT64_MAX, err);
    border->ijk = border->first ? mem_array(border->n, 3 * sizeof *border->ijk, UINT64_MAX, err) : NULL;
    border->normals = border->ijk ? mem_large_array(border->n, 3 * sizeof *border->normals, UINT64_MAX, err) : NULL;
    if (!border->normals)
        return false;
    uint32_t total = 0;
    for (size_t at = 0; at < n_words; at++) {
        border->first[at] = total;
        total += (uint32_t)__builtin_popcountll(mask->bits[at]);
    }
    return true;
}

struct shape_border *shape_border_create(const struct mask *mask, size_t max_voxels, int n_threads, struct error *err)
{
    struct shape_border *border = mem_new(sizeof *border);
    border->mask = mask;
    border->border = mask_boundary(mask, false, n_threads, err);
    if (!border->border || !number_voxels(border, max_voxels, err)) {
        shape_border_destroy(border);
        return NULL;
    }
    struct border_job job = { .border = border };
    prepare(&job);
    parallel_run(n_threads, fill_part, &job);
    return border;
}

void shape_border_destroy(struct shape_border *border)
{
    if (!border)
        return;
    mask_destroy(border->border);
    free(border->first);
    free(border->ijk);
    free(border->normals);
    free(border);
}
