/* Laying blocks and cells over a volume of materials. */
#include "core/transport/geometry.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

static bool goes_on(const atomic_bool *cancel, struct error *err)
{
    return !(cancel && atomic_load(cancel)) || error_set(err, ERROR_CANCELLED, "the simulation was cancelled");
}

/* Spans in voxels along each axis that hold matter. */
static bool bounds(const struct geometry *geometry, const atomic_bool *cancel, uint32_t low[3], uint32_t high[3],
                   struct error *err)
{
    memcpy(low, geometry->n, 3 * sizeof *low);
    memset(high, 0, 3 * sizeof *high);
    bool has_matter = false;
    const uint8_t *at = geometry->voxels;
    for (uint32_t k = 0; k < geometry->n[2]; k++) {
        if (!goes_on(cancel, err))
            return false;
        for (uint32_t j = 0; j < geometry->n[1]; j++)
            for (uint32_t i = 0; i < geometry->n[0]; i++, at++) {
                if (*at == 0)
                    continue;
                has_matter = true;
                const uint32_t index[3] = { i, j, k };
                for (int axis = 0; axis < 3; axis++) {
                    low[axis] = index[axis] < low[axis] ? index[axis] : low[axis];
                    high[axis] = index[axis] + 1 > high[axis] ? index[axis] + 1 : high[axis];
                }
            }
    }
    return has_matter || error_set(err, ERROR_RANGE, "no voxel holds matter: every region is air");
}

static bool make_frame(struct geometry *geometry, const struct grid *grid, struct error *err)
{
    struct vec3 spacing_mm = grid_spacing_mm(grid);
    for (int axis = 0; axis < 3; axis++) {
        struct vec3 column = grid->lps_mm_from_ijk.columns[axis];
        double length_mm = axis == 0 ? spacing_mm.x : axis == 1 ? spacing_mm.y : spacing_mm.z;
        geometry->axis_lps[axis] = vec3_scale(column, 1 / length_mm);
        geometry->per_cm[axis] = (float)(10 / length_mm);
        geometry->n[axis] = grid->size[axis];
        for (int other = 0; other < axis; other++)
            if (fabs(vec3_dot(geometry->axis_lps[axis], geometry->axis_lps[other])) > 1e-3)
                return error_set(err, ERROR_RANGE, "the regions' grid has axes that are not at right angles");
    }
    return true;
}

static bool make_box(struct geometry *geometry, const struct grid *grid, double step_cm, const atomic_bool *cancel,
                     struct error *err)
{
    uint32_t low[3], high[3];
    if (!bounds(geometry, cancel, low, high, err))
        return false;
    double corner[3];
    for (int axis = 0; axis < 3; axis++) {
        double per_cm = (double)geometry->per_cm[axis];
        corner[axis] = low[axis] / per_cm - GEOMETRY_PAD_CM;
        double steps = ceil(((high[axis] - low[axis]) / per_cm + 2 * GEOMETRY_PAD_CM) / step_cm);
        geometry->size_cm[axis] = (float)(steps * step_cm);
        geometry->shift[axis] = (float)(corner[axis] * per_cm);
        geometry->n_blocks[axis] = (int32_t)ceil(steps * step_cm / GEOMETRY_BLOCK_CM - 1e-6);
        corner[axis] = corner[axis] * per_cm - .5; /* as an index */
    }
    geometry->corner_lps_mm = affine_point(&grid->lps_mm_from_ijk, (struct vec3){ corner[0], corner[1], corner[2] });
    return true;
}

/* Voxels that a span of blocks overlaps along an axis, within the volume; false: none. */
static bool overlapped(const struct geometry *geometry, int axis, int32_t block, uint32_t *from, uint32_t *to,
                       bool *is_cut)
{
    double per_cm = (double)geometry->per_cm[axis], shift = (double)geometry->shift[axis];
    double low = floor(block * GEOMETRY_BLOCK_CM * per_cm + shift),
           high = ceil((block + 1) * GEOMETRY_BLOCK_CM * per_cm + shift);
    *is_cut |= low < 0 || high > geometry->n[axis];
    *from = (uint32_t)fmax(low, 0);
    *to = (uint32_t)fmax(0, fmin(high, geometry->n[axis]));
    return *from < *to;
}

static uint8_t block_material(const struct geometry *geometry, const int32_t block[3])
{
    uint32_t from[3], to[3];
    bool is_cut = false;
    for (int axis = 0; axis < 3; axis++)
        if (!overlapped(geometry, axis, block[axis], &from[axis], &to[axis], &is_cut))
            return 0;
    uint8_t first =
        is_cut ? 0 : geometry->voxels[((size_t)from[2] * geometry->n[1] + from[1]) * geometry->n[0] + from[0]];
    for (uint32_t k = from[2]; k < to[2]; k++)
        for (uint32_t j = from[1]; j < to[1]; j++) {
            const uint8_t *row = geometry->voxels + ((size_t)k * geometry->n[1] + j) * geometry->n[0];
            for (uint32_t i = from[0]; i < to[0]; i++)
                if (row[i] != first)
                    return GEOMETRY_MIXED;
        }
    return first;
}

/* Steps to the nearest block that is not all air, diagonals as one; air beyond the box. There and back (A. Rosenfeld,
 * J. L. Pfaltz, 1966), through the half of the neighbours that came before. */
static void measure_air(struct geometry *geometry)
{
    enum { FAR = 255, HALF = 13 };
    const int32_t *n = geometry->n_blocks;
    size_t n_blocks = (size_t)n[0] * (size_t)n[1] * (size_t)n[2];
    for (size_t i = 0; i < n_blocks; i++)
        geometry->clear[i] = geometry->blocks[i] == 0 ? FAR : 0;
    for (int way = 0; way < 2; way++)
        for (size_t count = 0; count < n_blocks; count++) {
            size_t block = way ? n_blocks - 1 - count : count;
            const int32_t i = (int32_t)(block % (size_t)n[0]), j = (int32_t)(block / (size_t)n[0] % (size_t)n[1]),
                          k = (int32_t)(block / (size_t)n[0] / (size_t)n[1]);
            for (int near = 0; near < HALF && geometry->clear[block] > 0; near++) {
                int sign = way ? -1 : 1, a = i + sign * (near % 3 - 1), b = j + sign * (near / 3 % 3 - 1),
                    c = k + sign * (near / 9 - 1);
                if (a < 0 || b < 0 || c < 0 || a >= n[0] || b >= n[1] || c >= n[2])
                    continue;
                uint8_t steps = geometry->clear[((size_t)c * (size_t)n[1] + (size_t)b) * (size_t)n[0] + (size_t)a];
                if (steps + 1 < geometry->clear[block])
                    geometry->clear[block] = (uint8_t)(steps + 1);
            }
        }
    for (size_t i = 0; i < n_blocks; i++)
        geometry->clear[i] = (uint8_t)(geometry->clear[i] > 0 ? geometry->clear[i] - 1 : 0);
}

static bool make_blocks(struct geometry *geometry, const atomic_bool *cancel, struct error *err)
{
    const int32_t *n = geometry->n_blocks;
    size_t n_blocks = (size_t)n[0] * (size_t)n[1] * (size_t)n[2];
    geometry->blocks = mem_array(n_blocks, 1, (uint64_t)1 << 30, err);
    geometry->clear = geometry->blocks ? mem_array(n_blocks, 1, (uint64_t)1 << 30, err) : NULL;
    if (!geometry->clear)
        return false;
    uint8_t *at = geometry->blocks;
    for (int32_t k = 0; k < n[2]; k++) {
        if (!goes_on(cancel, err))
            return false;
        for (int32_t j = 0; j < n[1]; j++)
            for (int32_t i = 0; i < n[0]; i++)
                *at++ = block_material(geometry, (int32_t[]){ i, j, k });
    }
    measure_air(geometry);
    return true;
}

/* Cells of cell_mm over the whole box. */
static bool own_cells(struct geometry *geometry, double cell_mm, struct error *err)
{
    struct affine map = { 0 };
    uint32_t size[3];
    struct vec3 centre = geometry->corner_lps_mm;
    for (int axis = 0; axis < 3; axis++) {
        struct vec3 column = vec3_scale(geometry->axis_lps[axis], cell_mm);
        centre = vec3_add(centre, vec3_scale(column, .5));
        map.columns[axis] = column;
        size[axis] = (uint32_t)lround((double)geometry->size_cm[axis] * 10 / cell_mm);
    }
    map.origin = centre;
    return grid_init(&geometry->cells, size, &map, err);
}

/* How positions become indices of the cells' grid, which has to have the box's axes. */
static bool aim_cells(struct geometry *geometry, struct error *err)
{
    const struct grid *cells = &geometry->cells;
    struct vec3 origin = affine_point(&cells->ijk_from_lps_mm, geometry->corner_lps_mm);
    const double at[3] = { origin.x, origin.y, origin.z };
    for (int axis = 0; axis < 3; axis++) {
        struct vec3 end = vec3_add(geometry->corner_lps_mm, vec3_scale(geometry->axis_lps[axis], 10));
        struct vec3 step = vec3_sub(affine_point(&cells->ijk_from_lps_mm, end), origin);
        const double along[3] = { step.x, step.y, step.z };
        for (int other = 0; other < 3; other++)
            if (other != axis && fabs(along[other]) > 1e-3 * fabs(along[axis]))
                return error_set(err, ERROR_RANGE, "the cells' grid does not have the axes of the regions' grid");
        geometry->cells_per_cm[axis] = (float)along[axis];
        geometry->cells_shift[axis] = (float)(at[axis] + .5);
        geometry->n_cells[axis] = (int32_t)cells->size[axis];
    }
    if (grid_n_voxels(cells) > GEOMETRY_MAX_CELLS)
        return error_set(err, ERROR_LIMIT, "%zu cells, at most %d expected: take larger ones", grid_n_voxels(cells),
                         GEOMETRY_MAX_CELLS);
    return true;
}

/* The span of a voxel along an axis, in cells. */
static void span(const struct geometry *geometry, int axis, uint32_t voxel, double *low, double *high)
{
    double per = (double)geometry->cells_per_cm[axis] / (double)geometry->per_cm[axis];
    double a = (voxel - (double)geometry->shift[axis]) * per + (double)geometry->cells_shift[axis], b = a + per;
    *low = fmax(0, fmin(a, b));
    *high = fmin(geometry->n_cells[axis], fmax(a, b));
}

/* Adds a voxel's volume to the cells that it overlaps, in their volumes. */
static void add_voxel(struct geometry *geometry, const uint32_t voxel[3])
{
    double low[3], high[3];
    for (int axis = 0; axis < 3; axis++) {
        span(geometry, axis, voxel[axis], &low[axis], &high[axis]);
        if (low[axis] >= high[axis])
            return;
    }
    for (int32_t k = (int32_t)low[2]; k < high[2]; k++)
        for (int32_t j = (int32_t)low[1]; j < high[1]; j++)
            for (int32_t i = (int32_t)low[0]; i < high[0]; i++) {
                double share = (fmin(high[0], i + 1) - fmax(low[0], i)) * (fmin(high[1], j + 1) - fmax(low[1], j)) *
                               (fmin(high[2], k + 1) - fmax(low[2], k));
                geometry->matter[((size_t)k * (size_t)geometry->n_cells[1] + (size_t)j) * (size_t)geometry->n_cells[0] +
                                 (size_t)i] += (float)share;
            }
}

static bool measure_matter(struct geometry *geometry, const atomic_bool *cancel, struct error *err)
{
    geometry->matter = mem_array(grid_n_voxels(&geometry->cells), sizeof(float), UINT64_MAX, err);
    if (!geometry->matter)
        return false;
    const uint8_t *at = geometry->voxels;
    for (uint32_t k = 0; k < geometry->n[2]; k++) {
        if (!goes_on(cancel, err))
            return false;
        for (uint32_t j = 0; j < geometry->n[1]; j++)
            for (uint32_t i = 0; i < geometry->n[0]; i++, at++)
                if (*at != 0)
                    add_voxel(geometry, (uint32_t[]){ i, j, k });
    }
    return true;
}

static bool make_rows(struct geometry *geometry, struct error *err)
{
    size_t n = (size_t)geometry->n_cells[0], n_rows = (size_t)geometry->n_cells[1] * (size_t)geometry->n_cells[2];
    geometry->rows = mem_array(n_rows, sizeof *geometry->rows, UINT64_MAX, err);
    for (size_t row = 0; geometry->rows && row < n_rows; row++) {
        size_t begin = row * n, end = begin + n;
        while (begin < end && !(geometry->matter[begin] > 0))
            begin++;
        while (end > begin && !(geometry->matter[end - 1] > 0))
            end--;
        if (begin < end)
            geometry->rows[geometry->n_rows++] = (struct cell_row){ (uint32_t)begin, (uint32_t)(end - begin) };
    }
    return geometry->rows != NULL;
}

bool geometry_init(struct geometry *geometry, const struct grid *grid, const uint8_t *voxels, const struct grid *cells,
                   double cell_mm, const atomic_bool *cancel, struct error *err)
{
    *geometry = (struct geometry){ .voxels = voxels };
    if (!cells && !(cell_mm >= 1 && cell_mm <= 50))
        return error_set(err, ERROR_RANGE, "cells of %g mm, 1 to 50 expected", cell_mm);
    double step_cm = cells ? GEOMETRY_BLOCK_CM : cell_mm / 10;
    if (!make_frame(geometry, grid, err) || !make_box(geometry, grid, step_cm, cancel, err))
        return false;
    if (cells)
        geometry->cells = *cells;
    else if (!own_cells(geometry, cell_mm, err))
        return false;
    geometry->are_cells_blocks = !cells && cell_mm / 10 == GEOMETRY_BLOCK_CM;
    if (aim_cells(geometry, err) && make_blocks(geometry, cancel, err) && measure_matter(geometry, cancel, err) &&
        make_rows(geometry, err))
        return true;
    geometry_finish(geometry);
    return false;
}

bool geometry_holds_cell(const struct geometry *geometry, size_t cell)
{
    size_t row = (size_t)geometry->n_cells[0], slice = row * (size_t)geometry->n_cells[1];
    const size_t index[3] = { cell % row, cell % slice / row, cell / slice };
    for (int axis = 0; axis < 3; axis++) {
        double per_cm = (double)geometry->cells_per_cm[axis], shift = (double)geometry->cells_shift[axis],
               a = ((double)index[axis] - shift) / per_cm, b = a + 1 / per_cm;
        if (fmin(a, b) < -1e-3 || fmax(a, b) > (double)geometry->size_cm[axis] + 1e-3)
            return false;
    }
    return true;
}

void geometry_finish(struct geometry *geometry)
{
    free(geometry->blocks);
    free(geometry->clear);
    free(geometry->matter);
    free(geometry->rows);
    geometry->blocks = NULL;
    geometry->clear = NULL;
    geometry->matter = NULL;
    geometry->rows = NULL;
}

void geometry_direct(const struct geometry *geometry, struct vec3 direction_lps, double direction[3])
{
    for (int axis = 0; axis < 3; axis++)
        direction[axis] = vec3_dot(direction_lps, geometry->axis_lps[axis]);
}

void geometry_place(const struct geometry *geometry, struct vec3 point_lps_mm, double position_cm[3])
{
    geometry_direct(geometry, vec3_scale(vec3_sub(point_lps_mm, geometry->corner_lps_mm), .1), position_cm);
}
