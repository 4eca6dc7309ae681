/* Marching cubes of a field on bit rows, as marching_cubes.c: the same working grid, cases and numbers of vertices.
 * What differs:
 *
 *   - A vertex is interpolated from the values at the ends of its edge, and has the field's gradient as its normal.
 *   - Where voxels have no value, some crossed edges are no vertices (isosurface_gaps.c). */
#include "core/surface/isosurface.h"

#include <math.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/surface/isosurface_bits.h"
#include "core/surface/marching_triangles.h"

enum { FETCH_ROWS = 3 };

struct iso_job {
    struct iso_bits bits;
    double iso;
    float lps_from_ijk[9]; /* for gradients: transposed inverse of the map, negated, row by row */
};

static void count_part(void *context, int part, int n_parts)
{
    struct iso_job *job = context;
    uint32_t from, end;
    marching_range(job->bits.grid.size[2], part, n_parts, &from, &end);
    if (!job->bits.valued.bits)
        marching_rows_count(job->bits.code, &job->bits.grid, from, end);
    else
        for (uint32_t z = from; z < end; z++)
            iso_count_kept(&job->bits, z);
}

/* ---- vertices ---------------------------------------------------------------------------------------------------- */

struct float3 {
    float x, y, z;
};

/* Twice the derivative along an axis. */
static float difference(const float *at, ptrdiff_t step, bool has_before, bool has_after)
{
    float here = *at, before = has_before ? at[-step] : NAN, after = has_after ? at[step] : NAN;
    if (!isfinite(before))
        return isfinite(after) ? 2 * (after - here) : 0;
    return isfinite(after) ? after - before : 2 * (here - before);
}

/* Twice the gradient at a voxel, in index space. */
static struct float3 gradient_at(const struct volume *field, const uint32_t ijk[3], const float *at)
{
    const uint32_t *size = field->grid.size;
    float g[3];
    ptrdiff_t step = 1;
    for (int axis = 0; axis < 3; axis++) {
        g[axis] = difference(at, step, ijk[axis] > 0, ijk[axis] + 1 < size[axis]);
        step *= (ptrdiff_t)size[axis];
    }
    return (struct float3){ g[0], g[1], g[2] };
}

INLINED struct float3 gradient_inside(const float *at, ptrdiff_t row, ptrdiff_t slice)
{
    return (struct float3){ at[1] - at[-1], at[row] - at[-row], at[slice] - at[-slice] };
}

INLINED struct float3 mix(struct float3 a, struct float3 b, float t)
{
    return (struct float3){ a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.z + t * (b.z - a.z) };
}

/* Turns a gradient in index space into the unit normal. False: it has no direction. */
INLINED bool put_normal(const struct iso_job *job, struct float3 g, float *to)
{
    const float *m = job->lps_from_ijk;
    float x = m[0] * g.x + m[1] * g.y + m[2] * g.z, y = m[3] * g.x + m[4] * g.y + m[5] * g.z,
          z = m[6] * g.x + m[7] * g.y + m[8] * g.z, square = x * x + y * y + z * z;
    float scale = 1 / sqrtf(square);
    to[0] = x * scale;
    to[1] = y * scale;
    to[2] = z * scale;
    return square > 1e-30f && square < 1e30f;
}

/* At the border of the field or of what has a value, and where floats are too coarse. */
static void put_normal_slowly(const struct iso_job *job, const uint32_t ijk[3], const float *at, int axis,
                              ptrdiff_t step, float t, float *to)
{
    uint32_t next[3] = { ijk[0], ijk[1], ijk[2] };
    next[axis]++;
    struct float3 low = gradient_at(job->bits.field, ijk, at), high = gradient_at(job->bits.field, next, at + step);
    struct float3 g = mix(low, high, t);
    float largest = fmaxf(fabsf(g.x), fmaxf(fabsf(g.y), fabsf(g.z)));
    bool has_direction = largest > 0 && isfinite(largest);
    if (has_direction) {
        int exponent = -ilogbf(largest);
        has_direction =
            put_normal(job, (struct float3){ ldexpf(g.x, exponent), ldexpf(g.y, exponent), ldexpf(g.z, exponent) }, to);
    }
    if (!has_direction) { /* along the edge the value does change */
        float along = at[step] > *at ? 1.0f : -1.0f;
        (void)put_normal(job, (struct float3){ axis == 0 ? along : 0, axis == 1 ? along : 0, axis == 2 ? along : 0 },
                         to);
    }
}

struct vertex_row {
    const struct iso_job *job;
    const float *values; /* of the row's first voxel in the working grid */
    uint32_t ijk[3];     /* of that voxel in the field */
    bool is_inner;       /* the row is not at the field's border, nor are the next ones */
    float *positions, *normals;
    struct vec3 base; /* of the row's first voxel in the field, patient mm */
};

/* Writes the vertices of one word on edges along an axis; the number after the last one. */
INLINED size_t put_vertices(const struct vertex_row *row, int axis, uint64_t crossed, uint32_t first, size_t vertex)
{
    const struct iso_job *job = row->job;
    const uint32_t *size = job->bits.field->grid.size;
    const ptrdiff_t to_row = (ptrdiff_t)size[0], to_slice = to_row * (ptrdiff_t)size[1];
    const ptrdiff_t step = axis == 0 ? 1 : axis == 1 ? to_row : to_slice;
    const struct affine *map = &job->bits.grid.lps_mm_from_ijk;
    /* what a later row's gradients likely need, and no earlier one's did */
    const uintptr_t ahead = (uintptr_t)(2 * to_slice + FETCH_ROWS * to_row) * sizeof(float);
    for (; crossed; crossed &= crossed - 1, vertex++) {
        uint32_t x = first + (uint32_t)__builtin_ctzll(crossed), i = row->ijk[0] + x;
        const float *at = row->values + x;
        __builtin_prefetch((const void *)((uintptr_t)at + ahead));
        double low = (double)at[0], high = (double)at[step], t = (job->iso - low) / (high - low);
        struct vec3 along = vec3_scale(map->columns[axis], t);
        struct vec3 p = vec3_add(vec3_add(row->base, vec3_scale(map->columns[0], (double)i)), along);
        float *to = row->positions + 3 * vertex;
        to[0] = (float)p.x;
        to[1] = (float)p.y;
        to[2] = (float)p.z;
        if (!row->normals)
            continue;
        to = row->normals + 3 * vertex;
        if (row->is_inner && i > 0 && i + 1 + (axis == 0) < size[0]) {
            struct float3 g =
                mix(gradient_inside(at, to_row, to_slice), gradient_inside(at + step, to_row, to_slice), (float)t);
            if (put_normal(job, g, to))
                continue;
        }
        put_normal_slowly(job, (const uint32_t[3]){ i, row->ijk[1], row->ijk[2] }, at, axis, step, (float)t, to);
    }
    return vertex;
}

INLINED void write_vertices(const struct iso_job *job, const struct row *own, const struct around *rows, uint32_t y,
                            uint32_t z)
{
    const struct iso_bits *bits = &job->bits;
    const struct marching_rows *grid = &bits->grid;
    const uint32_t *size = bits->field->grid.size;
    uint32_t i = (uint32_t)grid->start[0], j = (uint32_t)grid->start[1] + y, k = (uint32_t)grid->start[2] + z;
    struct vertex_row row = {
        .job = job,
        .values = (const float *)bits->field->voxels + ((size_t)k * size[1] + j) * size[0] + i,
        .ijk = { i, j, k },
        .is_inner = j > 0 && j + 2 < size[1] && k > 0 && k + 2 < size[2],
        .positions = grid->mesh->positions_lps_mm,
        .normals = grid->mesh->normals,
        .base = affine_point(&grid->lps_mm_from_ijk, vec3(0, j, k)),
    };
    size_t at_x = own->x, at_y = own->y, at_z = own->z;
    for (uint32_t w = 0; w < grid->words; w++) {
        if (is_uniform(rows, w))
            continue;
        struct crossings found =
            bits->valued.bits ? iso_kept_crossings(bits, rows, y, z, w) : find_crossings(grid, rows, w);
        at_x = put_vertices(&row, 0, found.x, CELLS_A_WORD * w, at_x);
        at_y = put_vertices(&row, 1, found.y, CELLS_A_WORD * w, at_y);
        at_z = put_vertices(&row, 2, found.z, CELLS_A_WORD * w, at_z);
    }
}

/* ---- isosurface_make --------------------------------------------------------------------------------------------- */

INLINED void write_rows(const struct iso_job *job, size_t from, size_t end, bool use_avx2)
{
    const struct marching_rows *grid = &job->bits.grid;
    const uint32_t *end_of_triangles = grid->mesh->indices + 3 * (size_t)grid->rows[end].triangles;
    for (size_t at = from; at < end; at++) {
        const struct row *row = &grid->rows[at];
        if (row[1].x == row->x && row[1].triangles == row->triangles)
            continue; /* the row owns nothing */
        uint32_t y = (uint32_t)(at % grid->size[1]), z = (uint32_t)(at / grid->size[1]);
        struct around rows = rows_around(grid, y, z);
        write_vertices(job, row, &rows, y, z);
        if (!rows.has_cells || row[1].triangles == row->triangles)
            continue;
        if (job->bits.valued.bits) {
            iso_write_kept_triangles(&job->bits, row, &rows, y, z);
            continue;
        }
#if defined(__x86_64__)
        if (use_avx2) {
            write_triangles_avx2(grid, row, &rows, end_of_triangles);
            continue;
        }
#endif
        write_triangles(grid, row, &rows);
    }
    (void)use_avx2;
    (void)end_of_triangles;
}

#if defined(__x86_64__)
FAST static void write_rows_fast(const struct iso_job *job, size_t from, size_t end)
{
    write_rows(job, from, end, true);
}
#else
static void write_rows_fast(const struct iso_job *job, size_t from, size_t end)
{
    write_rows(job, from, end, false);
}
#endif

static void write_part(void *context, int part, int n_parts)
{
    const struct iso_job *job = context;
    const struct marching_rows *grid = &job->bits.grid;
    size_t n_rows = (size_t)grid->size[1] * grid->size[2];
    size_t from = marching_rows_at_share(grid, n_rows, part, n_parts),
           end = marching_rows_at_share(grid, n_rows, part + 1, n_parts);
    if (job->bits.code == MARCHING_CUBES_PORTABLE)
        write_rows(job, from, end, false);
    else
        write_rows_fast(job, from, end);
}

static void place_job(struct iso_job *job)
{
    const struct grid *grid = &job->bits.field->grid;
    job->bits.grid.lps_mm_from_ijk = grid->lps_mm_from_ijk;
    job->bits.grid.cases = marching_rows_cases(&grid->lps_mm_from_ijk);
    const struct vec3 *columns = grid->ijk_from_lps_mm.columns; /* column a, row b: change of index b per mm along a */
    for (int a = 0; a < 3; a++) {
        job->lps_from_ijk[3 * a] = (float)-columns[a].x;
        job->lps_from_ijk[3 * a + 1] = (float)-columns[a].y;
        job->lps_from_ijk[3 * a + 2] = (float)-columns[a].z;
    }
}

static struct mesh *run_marching_cubes(struct iso_job *job, const struct surface_options *options, int n_parts,
                                       struct error *err)
{
    struct marching_rows *grid = &job->bits.grid;
    place_job(job);
    bool is_made = iso_bits_make(&job->bits, n_parts, err);
    if (is_made) {
        parallel_run(n_parts, count_part, job);
        is_made = marching_rows_number(grid, options, err);
    }
    if (is_made && !options->without_normals) {
        grid->mesh->normals = mem_large_array(grid->mesh->n_vertices, 3 * sizeof(float), UINT64_MAX, err);
        is_made = grid->mesh->normals != NULL;
    }
    if (is_made) {
        parallel_run(n_parts, write_part, job);
        mesh_measure_bounds(grid->mesh);
    } else {
        mesh_unref(grid->mesh);
        grid->mesh = NULL;
    }
    iso_bits_finish(&job->bits);
    return grid->mesh;
}

static struct mesh *empty_mesh(const struct surface_options *options, struct error *err)
{
    struct mesh *mesh = mesh_create(0, 0, err);
    if (mesh && !options->without_normals)
        mesh->normals = mem_array(0, sizeof(float), UINT64_MAX, err);
    return mesh;
}

static struct mesh *run_eight_cell(struct iso_job *job, const struct surface_options *options, int n_parts,
                                   struct error *err)
{
    struct surface_options open = *options;
    open.close_at_border = false;
    struct mask *mask = iso_bits_mask(&job->bits, n_parts, err);
    struct error why = { 0 };
    struct mesh *mesh = mask ? surface_eight_cell(mask, &open, &why) : NULL;
    mask_destroy(mask);
    if (mask && !mesh && why.code == ERROR_RANGE) /* none is inside */
        return empty_mesh(options, err);
    if (mask && !mesh)
        error_set(err, why.code, "%s", why.text);
    if (mesh && !options->without_normals && !mesh_make_normals(mesh, n_parts, err)) {
        mesh_unref(mesh);
        return NULL;
    }
    return mesh;
}

struct mesh *isosurface_make(enum surface_algorithm algorithm, const struct volume *field,
                             const struct iso_bricks *bricks, double iso, const struct surface_options *options,
                             struct error *err)
{
    return isosurface_with(MARCHING_CUBES_BEST, algorithm, field, bricks, iso, options, err);
}

struct mesh *isosurface_with(enum marching_cubes_code code, enum surface_algorithm algorithm,
                             const struct volume *field, const struct iso_bricks *bricks, double iso,
                             const struct surface_options *options, struct error *err)
{
    if (!isfinite(iso)) {
        error_set(err, ERROR_RANGE, "a surface at the value %g: expected a finite one", iso);
        return NULL;
    }
    struct iso_job job = { .bits = { .field = field, .bricks = bricks, .code = marching_rows_code(code) }, .iso = iso };
    int n_parts = options->n_threads > 0 ? options->n_threads : parallel_cores();
    if (!iso_bits_place(&job.bits, iso))
        return empty_mesh(options, err);
    return algorithm == SURFACE_EIGHT_CELL ? run_eight_cell(&job, options, n_parts, err)
                                           : run_marching_cubes(&job, options, n_parts, err);
}
