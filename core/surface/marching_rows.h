#pragma once
/* Inside marching cubes: the working grid, and which crossed edges and cells each row owns. See marching_cubes.c. */
#include "core/region/mask.h"
#include "core/surface/cube_cases.h"
#include "core/surface/marching_cubes.h"

enum { CELLS_A_WORD = 63, MAX_MASK_WORDS = VOLUME_MAX_SIDE / 64 };
#define LOW_63 (~(uint64_t)0 >> 1)

/* Counts of one row; after the running totals, the number of the row's first vertex or triangle. */
struct row {
    uint32_t x, y, z; /* vertices on edges along x, y, z, numbered in this order */
    uint32_t triangles;
};

struct marching_rows {
    const struct cube_case *cases;
    struct affine lps_mm_from_ijk; /* of the mask */
    int32_t start[3]; /* mask index of the working grid's voxel 0; -1 when an empty layer was added in front */
    uint32_t size[3]; /* in voxels */
    uint32_t words;   /* 64-bit words per row */
    uint64_t *bits;   /* [z][y][words]; the rows are in the same allocation */
    struct row *rows; /* [z][y], and one more at the end */
    struct mesh *mesh;
};

/* Marks code that is compiled twice: portably, and for AVX2 and bit counting. */
#define INLINED static inline __attribute__((always_inline))
#if defined(__x86_64__)
#define FAST __attribute__((target("avx2,popcnt,bmi,bmi2")))
#endif

/* A row with its neighbours. At the end of an axis the row replaces its missing neighbour, so that no edge is crossed
 * there. */
struct around {
    const uint64_t *here, *next_y, *next_z, *next_yz;
    bool has_cells;
};

INLINED struct around rows_around(const struct marching_rows *grid, uint32_t y, uint32_t z)
{
    const uint64_t *here = grid->bits + ((size_t)z * grid->size[1] + y) * grid->words;
    bool has_y = y + 1 < grid->size[1], has_z = z + 1 < grid->size[2];
    size_t to_y = has_y ? grid->words : 0, to_z = has_z ? (size_t)grid->words * grid->size[1] : 0;
    return (struct around){ here, here + to_y, here + to_z, here + to_y + to_z, has_y && has_z && grid->size[0] > 1 };
}

/* The crossed edges and active cells that belong to one word of a row. */
struct crossings {
    uint64_t x, y, z; /* crossed edges by the voxel they start at */
    uint64_t active;  /* cells with triangles */
};

INLINED struct crossings find_crossings(const struct marching_rows *grid, const struct around *rows, uint32_t w)
{
    bool is_last = w + 1 == grid->words;
    uint32_t n_cells = is_last ? grid->size[0] - 1 - CELLS_A_WORD * w : CELLS_A_WORD;
    uint64_t cells = n_cells ? LOW_63 >> (CELLS_A_WORD - n_cells) : 0;
    uint64_t voxels = is_last ? ~(uint64_t)0 : LOW_63; /* else the 64th bit belongs to the next word */
    uint64_t here = rows->here[w], next_y = rows->next_y[w], next_z = rows->next_z[w], next_yz = rows->next_yz[w];
    uint64_t any = here | next_y | next_z | next_yz, all = here & next_y & next_z & next_yz;
    return (struct crossings){
        .x = (here ^ here >> 1) & cells,
        .y = (here ^ next_y) & voxels,
        .z = (here ^ next_z) & voxels,
        .active = rows->has_cells ? (any | any >> 1) & ~(all & all >> 1) & cells : 0,
    };
}

/* Returns true if no edge is crossed and no cell active, as for most words. */
INLINED bool is_uniform(const struct around *rows, uint32_t w)
{
    uint64_t here = rows->here[w], next_y = rows->next_y[w], next_z = rows->next_z[w], next_yz = rows->next_yz[w];
    return !(here | next_y | next_z | next_yz) || !~(here & next_y & next_z & next_yz);
}

INLINED uint32_t case_at(const struct around *rows, uint32_t w, int bit)
{
    return (uint32_t)((rows->here[w] >> bit & 3) | (rows->next_y[w] >> bit & 3) << 2 |
                      (rows->next_z[w] >> bit & 3) << 4 | (rows->next_yz[w] >> bit & 3) << 6);
}

/* Initial running numbers of a row: the vertex that each of edges 0..7 (cube_cases.h) of its first cell would have. */
#define FIRST_VERTICES(grid, row) \
    { \
        (row)->x, (row)[1].x, (row)[(grid)->size[1]].x, (row)[(grid)->size[1] + 1].x, (row)->y, \
            (row)[(grid)->size[1]].y, (row)->z, (row)[1].z \
    }

/* Part `part` of n_parts of the numbers 0..n. */
INLINED void marching_range(uint32_t n, int part, int n_parts, uint32_t *from, uint32_t *end)
{
    *from = (uint32_t)((uint64_t)n * (uint64_t)part / (uint64_t)n_parts);
    *end = (uint32_t)((uint64_t)n * (uint64_t)(part + 1) / (uint64_t)n_parts);
}

/* 64 bits of a row from bit `at` on, -1 allowed; bits beyond the row are 0. */
static inline uint64_t bits_from(const uint64_t *row, uint32_t words, int32_t at)
{
    if (at < 0)
        return row[0] << -at;
    uint32_t word = (uint32_t)at / 64, shift = (uint32_t)at % 64;
    uint64_t low = word < words ? row[word] >> shift : 0;
    return shift && word + 1 < words ? low | row[word + 1] << (64 - shift) : low;
}

/* The case table for a grid of this handedness. */
const struct cube_case *marching_rows_cases(const struct affine *lps_mm_from_ijk);
/* The portable version if this processor cannot run the best. */
enum marching_cubes_code marching_rows_code(enum marching_cubes_code wanted);
/* Counts what each row of slices from..end owns. */
void marching_rows_count(enum marching_cubes_code code, struct marching_rows *grid, uint32_t from, uint32_t end);
/* Replaces the counts by running totals and creates the mesh. Errors: ERROR_LIMIT, ERROR_MEMORY. */
NODISCARD bool marching_rows_number(struct marching_rows *grid, const struct surface_options *options,
                                    struct error *err);
/* First row at or after this share of the triangles, so that parts have equal work wherever the surface is. */
size_t marching_rows_at_share(const struct marching_rows *grid, size_t n_rows, int part, int n_parts);
