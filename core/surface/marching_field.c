/* Marching cubes on a field: the voxels at or above the iso value form a mask, whose surface has the right triangles;
 * then every vertex is moved along its edge. */
#include <math.h>
#include <stdlib.h>

#include "core/base/parallel.h"
#include "core/surface/marching_cubes.h"

enum { MAX_THREADS = 64 };

struct field_job {
    const struct volume *field;
    double iso;
    struct mask *mask;
    const struct marching_graph *graph;
    struct mesh *mesh;
};

static size_t share(size_t n, int part, int n_parts)
{
    return n * (size_t)part / (size_t)n_parts;
}

static void mask_part(void *context, int part, int n_parts)
{
    struct field_job *job = context;
    const uint32_t *size = job->mask->size;
    size_t n_rows = (size_t)size[1] * size[2], end = share(n_rows, part + 1, n_parts);
    for (size_t row = share(n_rows, part, n_parts); row < end; row++) {
        uint64_t *bits = job->mask->bits + row * job->mask->words;
        for (uint32_t w = 0; w < job->mask->words; w++)
            bits[w] = 0;
        for (uint32_t i = 0; i < size[0]; i++) {
            double value = volume_value(job->field, i, (uint32_t)(row % size[1]), (uint32_t)(row / size[1]));
            bits[i / 64] |= (uint64_t)(isfinite(value) && value >= job->iso) << i % 64;
        }
    }
}

/* The field's value at an index; NaN beyond the grid. */
static double value_at(const struct volume *field, const int32_t at[3])
{
    for (int axis = 0; axis < 3; axis++)
        if (at[axis] < 0 || (uint32_t)at[axis] >= field->grid.size[axis])
            return NAN;
    return volume_value(field, (uint32_t)at[0], (uint32_t)at[1], (uint32_t)at[2]);
}

static double crossing(double low, double high, double iso)
{
    double share = (iso - low) / (high - low); /* one end is at least iso, the other below, so never 0 / 0 */
    return isfinite(low) && isfinite(high) ? fmin(fmax(share, 0), 1) : 0.5;
}

static void move_part(void *context, int part, int n_parts)
{
    struct field_job *job = context;
    size_t n = job->mesh->n_vertices, end = share(n, part + 1, n_parts);
    for (size_t v = share(n, part, n_parts); v < end; v++) {
        const struct marching_point *point = &job->graph->points[v];
        int32_t low[3], high[3];
        double at[3];
        for (int axis = 0; axis < 3; axis++) {
            int32_t place = point->at2[axis] >> 1; /* the lower end of the edge */
            at[axis] = place;
            low[axis] = high[axis] = place + job->graph->start[axis];
        }
        high[point->axis]++;
        at[point->axis] += crossing(value_at(job->field, low), value_at(job->field, high), job->iso);
        struct vec3 p = affine_point(&job->graph->lps_mm_from_at, vec3(at[0], at[1], at[2]));
        float *to = job->mesh->positions_lps_mm + 3 * v;
        to[0] = (float)p.x;
        to[1] = (float)p.y;
        to[2] = (float)p.z;
    }
}

struct mesh *surface_marching_cubes_field(const struct volume *field, double iso, const struct surface_options *options,
                                          struct error *err)
{
    struct marching_graph graph = { .has_no_links = true };
    struct field_job job = { .field = field, .iso = iso, .graph = &graph };
    int n_threads = options->n_threads > 0 ? options->n_threads : parallel_cores();
    n_threads = n_threads < MAX_THREADS ? n_threads : MAX_THREADS;
    if (!isfinite(iso)) {
        error_set(err, ERROR_RANGE, "a surface at the value %g: expected a finite one", iso);
        return NULL;
    }
    job.mask = mask_create(field->grid.size, &field->grid.lps_mm_from_ijk, err);
    if (!job.mask)
        return NULL;
    parallel_run(n_threads, mask_part, &job);
    job.mesh = marching_cubes_run(MARCHING_CUBES_BEST, job.mask, options, &graph, err);
    mask_destroy(job.mask);
    if (!job.mesh)
        return NULL;
    parallel_run(n_threads, move_part, &job);
    mesh_measure_bounds(job.mesh);
    marching_graph_finish(&graph);
    return job.mesh;
}
