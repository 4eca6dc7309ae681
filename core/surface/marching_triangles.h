#pragma once
/* Inside marching cubes: writes the triangles of one row of cells. In a header, because each caller compiles it into
 * its own loop over rows. */
#include <string.h>

#include "core/surface/marching_rows.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

INLINED void write_triangles(const struct marching_rows *grid, const struct row *row, const struct around *rows)
{
    uint32_t vertex[CUBE_EDGES] = FIRST_VERTICES(grid, row);
    uint32_t *out = grid->mesh->indices + 3 * (size_t)row->triangles;
    for (uint32_t w = 0; w < grid->words; w++) {
        if (is_uniform(rows, w))
            continue;
        for (uint64_t cells = find_crossings(grid, rows, w).active; cells; cells &= cells - 1) {
            const struct cube_case *cube = &grid->cases[case_at(rows, w, __builtin_ctzll(cells))];
            uint32_t following[8];
            for (int e = 0; e < 8; e++)
                following[e] = vertex[e] + cube->is_crossed[e];
            /* edges 8..11 on the face x = 1 are edges 4..7 of the next cell */
            memcpy(vertex + 8, following + 4, 4 * sizeof *vertex);
            for (int corner = 0; corner < 3 * cube->n_triangles; corner++)
                *out++ = vertex[cube->edges[corner]];
            memcpy(vertex, following, sizeof following);
        }
    }
}

#if defined(__x86_64__)
/* Like write_triangles, with the running numbers in one register. Always writes the five triangles that a cell can
 * have; the next cell overwrites the surplus. `end`: end of this thread's triangles, which the last writes must not
 * cross. */
FAST static void write_triangles_avx2(const struct marching_rows *grid, const struct row *row,
                                      const struct around *rows, const uint32_t *end)
{
    const uint32_t first[8] = FIRST_VERTICES(grid, row);
    __m256i vertex = _mm256_loadu_si256((const __m256i *)first);
    uint32_t *out = grid->mesh->indices + 3 * (size_t)row->triangles;
    for (uint32_t w = 0; w < grid->words; w++) {
        if (is_uniform(rows, w))
            continue;
        for (uint64_t cells = find_crossings(grid, rows, w).active; cells; cells &= cells - 1) {
            const struct cube_case *cube = &grid->cases[case_at(rows, w, __builtin_ctzll(cells))];
            __m256i crossed = _mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)cube->is_crossed));
            __m256i following = _mm256_add_epi32(vertex, crossed);
            __m256i far_face = _mm256_permute4x64_epi64(following, 0xee); /* edges 8..11 */
            __m256i triangles[2];
            for (int half = 0; half < 2; half++) {
                __m256i edges = _mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)(cube->edges + 8 * half)));
                __m256i is_far = _mm256_cmpgt_epi32(edges, _mm256_set1_epi32(7));
                triangles[half] = _mm256_blendv_epi8(_mm256_permutevar8x32_epi32(vertex, edges),
                                                     _mm256_permutevar8x32_epi32(far_face, edges), is_far);
            }
            vertex = following;
            if (end - out >= 16) {
                _mm256_storeu_si256((__m256i *)out, triangles[0]);
                _mm256_storeu_si256((__m256i *)(out + 8), triangles[1]);
            } else {
                memcpy(out, triangles, 3 * sizeof *out * cube->n_triangles);
            }
            out += 3 * cube->n_triangles;
        }
    }
}
#endif
