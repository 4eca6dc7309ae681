/* Masks for tests, and the Euler number of their surface by counting. */
#include "tests/unit/made_mask.h"

#include "core/base/mem.h"
#include "tests/check.h"

const struct affine unit_map = { { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, { 0, 0, 0 } };

struct volume *layer_make(uint32_t nx, uint32_t ny, uint32_t nz, enum voxel_type type, const struct affine *map)
{
    struct grid grid;
    struct error err = { 0 };
    assert_true(grid_init(&grid, (uint32_t[3]){ nx, ny, nz }, map, &err));
    struct volume *layer = volume_create(&grid, type, &err);
    assert_non_null(layer);
    return layer;
}

struct mask *mask_make(uint32_t nx, uint32_t ny, uint32_t nz, const struct affine *map)
{
    struct error err = { 0 };
    struct mask *mask = mask_create_empty((const uint32_t[3]){ nx, ny, nz }, map, &err);
    assert_non_null(mask);
    return mask;
}

void mask_put(struct mask *mask, uint32_t i, uint32_t j, uint32_t k)
{
    mask->bits[((size_t)k * mask->size[1] + j) * mask->words + i / 64] |= (uint64_t)1 << i % 64;
}

bool mask_has(const struct mask *mask, int64_t i, int64_t j, int64_t k)
{
    if (i < 0 || j < 0 || k < 0 || i >= mask->size[0] || j >= mask->size[1] || k >= mask->size[2])
        return false;
    return mask->bits[((size_t)k * mask->size[1] + (size_t)j) * mask->words + (size_t)i / 64] >> (i % 64) & 1;
}

struct mask *mask_of_corners(int inside, const struct affine *map)
{
    struct mask *mask = mask_make(2, 2, 2, map);
    for (uint32_t c = 0; c < 8; c++)
        if (inside >> c & 1)
            mask_put(mask, c & 1, c >> 1 & 1, c >> 2);
    return mask;
}

uint32_t next_random(uint64_t *state)
{
    uint64_t z = (*state += 0x9e3779b97f4a7c15u);
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return (uint32_t)((z ^ z >> 31) >> 32);
}

struct mask *random_mask(uint32_t nx, uint32_t ny, uint32_t nz, uint32_t percent, uint64_t seed,
                         const struct affine *map)
{
    struct mask *mask = mask_make(nx, ny, nz, map);
    for (uint32_t k = 0; k < nz; k++)
        for (uint32_t j = 0; j < ny; j++)
            for (uint32_t i = 0; i < nx; i++)
                if (next_random(&seed) % 100 < percent)
                    mask_put(mask, i, j, k);
    mask_put(mask, nx / 2, ny / 2, nz / 2);
    return mask;
}

struct mesh *made_surface(enum surface_algorithm algorithm, const struct mask *mask, int n_threads,
                          bool close_at_border)
{
    struct surface_options options = surface_defaults;
    options.n_threads = n_threads;
    options.close_at_border = close_at_border;
    struct error err = { 0 };
    struct mesh *mesh = surface_make(algorithm, mask, &options, &err);
    assert_string_equal(err.text, "");
    assert_non_null(mesh);
    return mesh;
}

void assert_same_bytes(const struct mesh *a, const struct mesh *b)
{
    assert_int_equal(a->n_vertices, b->n_vertices);
    assert_int_equal(a->n_triangles, b->n_triangles);
    assert_memory_equal(a->positions_lps_mm, b->positions_lps_mm, 3 * a->n_vertices * sizeof(float));
    assert_memory_equal(a->indices, b->indices, 3 * a->n_triangles * sizeof(uint32_t));
}

/* Number of groups of inside corners of a cell that are connected along its edges. */
static int groups_of_corners(const bool inside[8])
{
    int group[8], n = 0;
    for (int c = 0; c < 8; c++)
        group[c] = inside[c] ? c : -1;
    for (int round = 0; round < 8; round++)
        for (int c = 0; c < 8; c++)
            for (int bit = 1; bit < 8; bit <<= 1)
                if (inside[c] && inside[c ^ bit] && group[c ^ bit] < group[c])
                    group[c] = group[c ^ bit];
    for (int c = 0; c < 8; c++)
        n += group[c] == c;
    return n;
}

/* Euler number of the solid that the surface bounds, summed over cells: a cell holds one piece per group of its inside
 * corners; pieces on the faces between cells were counted twice and are subtracted, then those on grid edges (one piece
 * if an end is inside) are added, and those at points subtracted. All pieces are contractible, so each counts 1. The
 * Euler number of a closed surface is twice that of its solid. */
long euler_of_surface(const struct mask *mask)
{
    long euler = 0;
    const uint32_t *n = mask->size;
    for (int64_t k = -1; k < n[2]; k++)
        for (int64_t j = -1; j < n[1]; j++)
            for (int64_t i = -1; i < n[0]; i++) {
                bool in[8];
                for (int c = 0; c < 8; c++)
                    in[c] = mask_has(mask, i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
                euler -= in[0];
                for (int axis = 1; axis < 8; axis <<= 1)
                    euler += in[0] || in[axis];
                for (int leave_out = 1; leave_out < 8; leave_out <<= 1) {
                    bool face[8] = { false };
                    for (int c = 0; c < 8; c++)
                        face[c] = in[c] && !(c & leave_out);
                    euler -= groups_of_corners(face);
                }
                euler += groups_of_corners(in);
            }
    return 2 * euler;
}
