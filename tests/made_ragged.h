#pragma once
/* A made-up region with everything that is hard to draw: spikes one univel wide (straight, slanting, and one that the
 * scan cuts), lone univels, two that touch at a corner, a plate one univel thick, a cavity, a tunnel, separate pieces,
 * a piece at the corner of the scan, and another region inside. 48 x 40 x 24 univels of 1 x 1 x 2.5 mm. Regions: 0
 * "ragged", 1 "core" inside it. */
#include "tests/made_plan.h"

enum { RAGGED_NI = 48, RAGGED_NJ = 40, RAGGED_NK = 24 };
#define RAGGED_SLICE_MM 2.5

static inline bool ragged_ball(int i, int j, int k, int ci, int cj, int ck, int radius)
{
    int di = i - ci, dj = j - cj, dk = k - ck;
    return di * di + dj * dj + dk * dk <= radius * radius;
}

static inline bool ragged_block(int i, int j, int k, int i0, int i1, int j0, int j1, int k0, int k1)
{
    return i >= i0 && i <= i1 && j >= j0 && j <= j1 && k >= k0 && k <= k1;
}

/* 0 nothing, 1 ragged, 2 core. */
static inline int ragged_label(int i, int j, int k)
{
    if (ragged_ball(i, j, k, 16, 15, 10, 3))
        return 2;
    if (ragged_ball(i, j, k, 12, 20, 12, 2) || (ragged_ball(i, j, 0, 19, 22, 0, 2) && k < 22))
        return 0;                                                        /* cavity; tunnel through the body */
    bool is_in = ragged_ball(i, j, k, 16, 18, 11, 9);                    /* body */
    is_in = is_in || (j == 18 && k == 11 && i >= 25 && i < 35);          /* spike along i */
    is_in = is_in || (i == 14 && j == 14 && k >= 16);                    /* along k, cut by the scan */
    is_in = is_in || (k == 11 && i - 23 == j - 24 && i >= 20 && i < 32); /* slanting */
    is_in = is_in || ragged_block(i, j, k, 38, 44, 4, 12, 6, 6);         /* plate */
    is_in = is_in || ragged_block(i, j, k, 38, 43, 24, 32, 8, 15);       /* separate piece */
    is_in = is_in || ragged_block(i, j, k, 0, 3, 32, 39, 0, 4);          /* at the corner of the scan */
    is_in = is_in || (i == 3 && j == 3 && k == 3) || (i == 30 && j == 5 && k == 20); /* alone */
    return is_in || (i == 40 && j == 16 && k == 18) ||
           (i == 41 && j == 17 && k == 19); /* these two touch at a corner */
}

static inline struct grid ragged_grid(void)
{
    struct affine map = { { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, RAGGED_SLICE_MM } }, { 0, 0, 0 } };
    return made_grid(RAGGED_NI, RAGGED_NJ, RAGGED_NK, map);
}

/* The label at a patient point of ragged_grid. */
static inline double ragged_label_at(struct vec3 lps_mm)
{
    return ragged_label((int)floor(lps_mm.x + 0.5), (int)floor(lps_mm.y + 0.5),
                        (int)floor(lps_mm.z / RAGGED_SLICE_MM + 0.5));
}

static inline struct plan *ragged_plan(void)
{
    static const struct made_region regions[] = { { "ragged", -1, 0xd08060 }, { "core", 0, 0x60a0d0 } };
    struct grid grid = ragged_grid();
    return made_plan(&grid, ragged_label_at, regions, 2);
}
