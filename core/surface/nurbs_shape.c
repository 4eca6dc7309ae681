/* Meshes spline surfaces: each net gives a grid of points, closed around, with a flat fan of triangles at each end. */
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/surface/nurbs.h"
#include "core/surface/nurbs_nets.h"
#include "core/surface/shape_make.h"
#include "core/surface/shape_parts.h"

/* The part of the mesh that one net gives. */
struct patch {
    struct nurbs_tube tube;
    size_t n_around, n_rows; /* of mesh vertices; after them come the centres of the two ends */
    size_t first_vertex, first_triangle;
};

struct nurbs_job {
    struct patch *patches;
    size_t n_patches;
    bool is_mirrored; /* the directions around and along have the opposite handedness in space */
    struct mesh *mesh;
};

static size_t patch_vertices(const struct patch *patch)
{
    return patch->n_around * patch->n_rows + 2;
}

static size_t patch_triangles(const struct patch *patch)
{
    return 2 * patch->n_around * (patch->n_rows - 1) + 2 * patch->n_around;
}

/* Sets the sizes of all patches for a number of steps between control points; returns the total of triangles. */
static uint64_t size_patches(struct nurbs_job *job, size_t steps)
{
    uint64_t n_vertices = 0, n_triangles = 0;
    for (size_t p = 0; p < job->n_patches; p++) {
        struct patch *patch = &job->patches[p];
        patch->n_around = steps * patch->tube.n_around;
        patch->n_rows = steps * (size_t)nurbs_tube_v_end(&patch->tube) + 1;
        patch->first_vertex = n_vertices;
        patch->first_triangle = n_triangles;
        n_vertices += patch_vertices(patch);
        n_triangles += patch_triangles(patch);
    }
    return n_triangles;
}

/* ---- one patch -------------------------------------------------------------------------------------------------- */

static void put(float *at, struct vec3 p)
{
    at[0] = (float)p.x;
    at[1] = (float)p.y;
    at[2] = (float)p.z;
}

static void write_row(const struct nurbs_job *job, const struct patch *patch, size_t row)
{
    double v = nurbs_tube_v_end(&patch->tube) * (double)row / (double)(patch->n_rows - 1);
    float *out = job->mesh->positions_lps_mm + 3 * (patch->first_vertex + row * patch->n_around);
    struct vec3 sum = vec3(0, 0, 0);
    for (size_t a = 0; a < patch->n_around; a++, out += 3) {
        struct vec3 p = nurbs_tube_point(&patch->tube, (double)(a * patch->tube.n_around) / (double)patch->n_around, v);
        put(out, p);
        sum = vec3_add(sum, p);
    }
    bool is_last = row + 1 == patch->n_rows;
    if (row == 0 || is_last)
        put(job->mesh->positions_lps_mm + 3 * (patch->first_vertex + patch_vertices(patch) - (is_last ? 1 : 2)),
            vec3_scale(sum, 1 / (double)patch->n_around));
}

static uint32_t *put_triangle(const struct nurbs_job *job, uint32_t *out, size_t a, size_t b, size_t c)
{
    *out++ = (uint32_t)a;
    *out++ = (uint32_t)(job->is_mirrored ? c : b);
    *out++ = (uint32_t)(job->is_mirrored ? b : c);
    return out;
}

/* Writes the triangles between a row and the next, or those of an end. */
static void write_triangles(const struct nurbs_job *job, const struct patch *patch, size_t row)
{
    size_t n = patch->n_around, low = patch->first_vertex + row * n, end = patch->first_vertex + patch_vertices(patch);
    bool is_last = row + 1 == patch->n_rows;
    uint32_t *out = job->mesh->indices + 3 * (patch->first_triangle + 2 * n * row);
    for (size_t a = 0; !is_last && a < n; a++) {
        size_t b = (a + 1) % n;
        out = put_triangle(job, out, low + a, low + b, low + n + b);
        out = put_triangle(job, out, low + a, low + n + b, low + n + a);
    }
    if (row == 0)
        out = job->mesh->indices + 3 * (patch->first_triangle + 2 * n * (patch->n_rows - 1));
    for (size_t a = 0; row == 0 && a < n; a++)
        out = put_triangle(job, out, end - 2, low + (a + 1) % n, low + a);
    if (is_last)
        out = job->mesh->indices + 3 * (patch->first_triangle + 2 * n * (patch->n_rows - 1) + n);
    for (size_t a = 0; is_last && a < n; a++)
        out = put_triangle(job, out, end - 1, low + a, low + (a + 1) % n);
}

/* Threads take rows in turn, over all patches. */
static void write_part(void *context, int part, int n_parts)
{
    const struct nurbs_job *job = context;
    size_t turn = 0;
    for (size_t p = 0; p < job->n_patches; p++)
        for (size_t row = 0; row < job->patches[p].n_rows; row++)
            if (turn++ % (size_t)n_parts == (size_t)part) {
                write_row(job, &job->patches[p], row);
                write_triangles(job, &job->patches[p], row);
            }
}

/* ---- shape_nurbs ------------------------------------------------------------------------------------------------ */

static bool make_mesh(struct nurbs_job *job, int order, int n_threads, struct error *err)
{
    size_t steps = order == 2 ? 1 : (size_t)order; /* straight lines need no points in between */
    uint64_t n_triangles;
    while ((n_triangles = size_patches(job, steps)) > NURBS_FINE_TRIANGLES && steps > 1)
        steps--;
    if (n_triangles > SHAPE_MAX_TRIANGLES)
        return error_set(err, ERROR_LIMIT, "spline surfaces of %llu triangles: at most %d are allowed",
                         (unsigned long long)n_triangles, SHAPE_MAX_TRIANGLES);
    const struct patch *last = &job->patches[job->n_patches - 1];
    job->mesh = mesh_create(last->first_vertex + patch_vertices(last), (size_t)n_triangles, err);
    if (!job->mesh)
        return false;
    parallel_run(n_threads, write_part, job);
    mesh_measure_bounds(job->mesh);
    return true;
}

/* Outlines turn counter-clockwise in the axes across the stack, in ascending order. Whether they also do so in space,
 * seen against the stacking direction, depends on that order and on the handedness of the grid. */
static bool is_mirrored(const struct mask *mask)
{
    struct grid grid;
    if (!grid_init(&grid, mask->size, &mask->lps_mm_from_ijk, NULL))
        return false;
    int axis = grid_index_axis(&grid, 2, NULL);
    return (affine_determinant(&mask->lps_mm_from_ijk) < 0) != (axis == 1);
}

struct mesh *shape_nurbs(const struct mask *mask, const struct shape_key *key, int n_threads, struct error *err)
{
    if (key->nurbs_order < NURBS_MIN_ORDER || key->nurbs_order > NURBS_MAX_ORDER) {
        error_set(err, ERROR_RANGE, "a spline of order %d: expected %d to %d", key->nurbs_order, NURBS_MIN_ORDER,
                  NURBS_MAX_ORDER);
        return NULL;
    }
    struct nurbs_nets nets;
    if (!nurbs_nets_make(mask, key->nurbs_sampling, key->nurbs_bins, n_threads, &nets, err))
        return NULL;
    struct nurbs_job job = { .n_patches = nets.n_nets, .is_mirrored = is_mirrored(mask) };
    job.patches = mem_array(nets.n_nets, sizeof *job.patches, UINT64_MAX, err);
    for (size_t p = 0; job.patches && p < nets.n_nets; p++) {
        const struct nurbs_net *net = &nets.nets[p];
        job.patches[p].tube = (struct nurbs_tube){
            .points = net->points,
            .n_around = net->n_around,
            .n_rows = net->n_rows,
            .order = key->nurbs_order,
            .order_along = net->n_rows < (size_t)key->nurbs_order ? (int)net->n_rows : key->nurbs_order,
        };
    }
    if (job.patches)
        (void)make_mesh(&job, key->nurbs_order, n_threads, err);
    free(job.patches);
    nurbs_nets_finish(&nets);
    return job.mesh;
}
