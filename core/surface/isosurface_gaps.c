/* Isosurfaces of a field in which some voxels have no value. A crossed edge is a vertex only if one of the four cells
 * around it has all values. Running numbers along a row of cells would then go wrong, so the kept edges of each word
 * are counted instead. */
#include "core/surface/isosurface_bits.h"

/* Cells of row y, z of which all eight voxels have a value; -1 and the last row allowed: they have no cells. */
INLINED uint64_t valued_cells(const struct marching_rows *valued, uint32_t y, uint32_t z, uint32_t w)
{
    if (y + 1 >= valued->size[1] || z + 1 >= valued->size[2])
        return 0;
    struct around rows = rows_around(valued, y, z);
    uint64_t all = rows.here[w] & rows.next_y[w] & rows.next_z[w] & rows.next_yz[w];
    return all & all >> 1 & LOW_63;
}

struct crossings iso_kept_crossings(const struct iso_bits *bits, const struct around *rows, uint32_t y, uint32_t z,
                                    uint32_t w)
{
    const struct marching_rows *valued = &bits->valued;
    struct crossings found = find_crossings(&bits->grid, rows, w);
    if (!(found.x | found.y | found.z | found.active))
        return found;
    uint64_t here = valued_cells(valued, y, z, w), before_y = y ? valued_cells(valued, y - 1, z, w) : 0,
             before_z = z ? valued_cells(valued, y, z - 1, w) : 0,
             before_yz = y && z ? valued_cells(valued, y - 1, z - 1, w) : 0;
    uint64_t beside_y = here | before_z, beside_z = here | before_y, last_y = 0, last_z = 0;
    if (w > 0) {
        uint64_t last = valued_cells(valued, y, z, w - 1);
        last_y = (last | (z ? valued_cells(valued, y, z - 1, w - 1) : 0)) >> (CELLS_A_WORD - 1);
        last_z = (last | (y ? valued_cells(valued, y - 1, z, w - 1) : 0)) >> (CELLS_A_WORD - 1);
    }
    found.x &= here | before_y | before_z | before_yz;
    found.y &= beside_y | beside_y << 1 | last_y;
    found.z &= beside_z | beside_z << 1 | last_z;
    found.active &= here;
    return found;
}

void iso_count_kept(const struct iso_bits *bits, uint32_t z)
{
    const struct marching_rows *grid = &bits->grid;
    for (uint32_t y = 0; y < grid->size[1]; y++) {
        struct around rows = rows_around(grid, y, z);
        struct row sum = { 0 };
        for (uint32_t w = 0; w < grid->words; w++) {
            if (is_uniform(&rows, w))
                continue;
            struct crossings found = iso_kept_crossings(bits, &rows, y, z, w);
            sum.x += (uint32_t)__builtin_popcountll(found.x);
            sum.y += (uint32_t)__builtin_popcountll(found.y);
            sum.z += (uint32_t)__builtin_popcountll(found.z);
            for (uint64_t cells = found.active; cells; cells &= cells - 1)
                sum.triangles += grid->cases[case_at(&rows, w, __builtin_ctzll(cells))].n_triangles;
        }
        grid->rows[(size_t)z * grid->size[1] + y] = sum;
    }
}

/* The kept edges around a row of cells, one word of each row that owns some. */
struct kept_word {
    uint64_t bits[8];   /* edges 0..7 (cube_cases.h) */
    uint32_t number[8]; /* the vertex of the first */
};

void iso_write_kept_triangles(const struct iso_bits *bits, const struct row *row, const struct around *rows, uint32_t y,
                              uint32_t z)
{
    const struct marching_rows *grid = &bits->grid;
    struct kept_word kept = { .number = FIRST_VERTICES(grid, row) };
    uint32_t *out = grid->mesh->indices + 3 * (size_t)row->triangles;
    for (uint32_t w = 0; w < grid->words; w++) {
        struct crossings of[4]; /* of rows (y, z), (y + 1, z), (y, z + 1), (y + 1, z + 1) */
        for (uint32_t r = 0; r < 4; r++) {
            struct around around = rows_around(grid, y + (r & 1), z + (r >> 1));
            of[r] = iso_kept_crossings(bits, &around, y + (r & 1), z + (r >> 1), w);
            kept.bits[r] = of[r].x;
        }
        kept.bits[4] = of[0].y;
        kept.bits[5] = of[2].y;
        kept.bits[6] = of[0].z;
        kept.bits[7] = of[1].z;
        for (uint64_t cells = of[0].active; cells; cells &= cells - 1) {
            int bit = __builtin_ctzll(cells);
            const struct cube_case *cube = &grid->cases[case_at(rows, w, bit)];
            uint64_t before = ((uint64_t)1 << bit) - 1, before_next = before << 1 | 1;
            for (int corner = 0; corner < 3 * cube->n_triangles; corner++) {
                int edge = cube->edges[corner] < 8 ? cube->edges[corner] : cube->edges[corner] - 4;
                uint64_t earlier = kept.bits[edge] & (cube->edges[corner] < 8 ? before : before_next);
                *out++ = kept.number[edge] + (uint32_t)__builtin_popcountll(earlier);
            }
        }
        for (int edge = 0; edge < 8; edge++)
            kept.number[edge] += (uint32_t)__builtin_popcountll(kept.bits[edge]);
    }
}
