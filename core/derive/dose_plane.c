/* Samples a dose's field on a lattice, row by row in several threads. */
#include "core/derive/dose_plane.h"

#include <math.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"

/* Fewer are sampled before further threads have started. */
enum { MIN_SHARED_SAMPLES = 1 << 17 };

/* A line of samples in the index space of a grid. */
struct stride {
    struct vec3 first, step;
};

static struct stride stride_of(const struct grid *grid, const struct dose_lattice *lattice, uint32_t v)
{
    const struct affine *map = &lattice->lps_mm_from_uv;
    struct vec3 from = vec3_add(map->origin, vec3_scale(map->columns[1], v)),
                first = affine_point(&grid->ijk_from_lps_mm, from),
                second = affine_point(&grid->ijk_from_lps_mm, vec3_add(from, map->columns[0]));
    return (struct stride){ first, vec3_sub(second, first) };
}

static inline double clamp(double value, double high)
{
    return value < 0 ? 0 : value > high ? high : value;
}

/* The value at a place in index space, as volume_sample gives it; NaN: none. */
static float sample(const struct volume *volume, double x, double y, double z, bool is_by_slice)
{
    const uint32_t *size = volume->grid.size;
    if (!(x >= -0.5 && y >= -0.5 && z >= -0.5 && x < size[0] - 0.5 && y < size[1] - 0.5 && z < size[2] - 0.5))
        return NAN;
    x = clamp(x, size[0] - 1.0);
    y = clamp(y, size[1] - 1.0);
    z = clamp(is_by_slice ? floor(z + 0.5) : z, size[2] - 1.0);
    size_t i = (size_t)x, j = (size_t)y, k = (size_t)z, row = size[0], slice = row * size[1];
    double wx = x - (double)i, wy = y - (double)j, wz = z - (double)k;
    /* a neighbour of no weight is not read: it may be outside, or without value */
    size_t di = wx > 0, dj = wy > 0 ? row : 0, dk = wz > 0 ? slice : 0;
    const float *p = (const float *)volume->voxels + i + row * j + slice * k;
    double a = p[0] + wx * (p[di] - p[0]), b = p[dj] + wx * (p[dj + di] - p[dj]), c = p[dk] + wx * (p[dk + di] - p[dk]),
           d = p[dk + dj] + wx * (p[dk + dj + di] - p[dk + dj]);
    a += wy * (b - a);
    c += wy * (d - c);
    return (float)(a + wz * (c - a));
}

/* The tissue's row at a place in the index space of the rows. */
static uint8_t row_at(const struct volume *rows, double x, double y, double z)
{
    const uint32_t *size = rows->grid.size;
    x += 0.5;
    y += 0.5;
    z += 0.5;
    if (!(x >= 0 && y >= 0 && z >= 0 && x < size[0] && y < size[1] && z < size[2]))
        return DOSE_NO_ROW;
    return ((const uint8_t *)rows->voxels)[(size_t)x + size[0] * ((size_t)y + size[1] * (size_t)z)];
}

struct sampling {
    struct dose_plane *plane;
    const struct dose_field *field;
};

static void sample_some(void *context, int part, int n_parts)
{
    const struct sampling *sampling = context;
    const struct dose_plane *plane = sampling->plane;
    const struct dose_field *field = sampling->field;
    const struct dose_lattice *lattice = &plane->lattice;
    size_t width = lattice->size[0];
    for (uint32_t v = (uint32_t)part; v < lattice->size[1]; v += (uint32_t)n_parts) {
        float *values = plane->values + width * v;
        const struct stride at = stride_of(&field->rows[0]->grid, lattice, v);
        uint8_t *rows = plane->rows ? plane->rows + width * v : NULL;
        if (rows) {
            const struct stride in = stride_of(&field->tissue->rows->grid, lattice, v);
            for (uint32_t u = 0; u < width; u++)
                rows[u] = row_at(field->tissue->rows, in.first.x + in.step.x * u, in.first.y + in.step.y * u,
                                 in.first.z + in.step.z * u);
        }
        for (uint32_t u = 0; u < width; u++) {
            uint8_t row = rows ? rows[u] : 0;
            values[u] = row == DOSE_NO_ROW
                            ? NAN
                            : sample(field->rows[row], at.first.x + at.step.x * u, at.first.y + at.step.y * u,
                                     at.first.z + at.step.z * u, lattice->is_by_slice);
        }
    }
}

struct dose_plane *dose_plane_create(const struct dose_field *field, const struct dose_lattice *lattice,
                                     struct error *err)
{
    size_t n = (size_t)lattice->size[0] * lattice->size[1];
    struct dose_plane *plane = mem_new(sizeof *plane);
    plane->lattice = *lattice;
    plane->values = mem_array(n, sizeof *plane->values, UINT64_MAX, err);
    if (plane->values && field->tissue)
        plane->rows = mem_array(n, 1, UINT64_MAX, err);
    if (!plane->values || (field->tissue && !plane->rows)) {
        dose_plane_destroy(plane);
        return NULL;
    }
    parallel_run(n < MIN_SHARED_SAMPLES ? 1 : parallel_cores(), sample_some, &(struct sampling){ plane, field });
    return plane;
}

void dose_plane_destroy(struct dose_plane *plane)
{
    if (!plane)
        return;
    free(plane->values);
    free(plane->rows);
    free(plane);
}

size_t dose_plane_n_bytes(const struct dose_plane *plane)
{
    return (size_t)plane->lattice.size[0] * plane->lattice.size[1] * (plane->rows ? 5 : 4);
}

/* Context of the tracing. */
struct trace {
    const struct dose_plane *plane;
    const struct dose_field *field;
};

static bool is_above_at(const struct trace *trace, double u, double v, double level)
{
    const struct dose_field *field = trace->field;
    struct vec3 point = affine_point(&trace->plane->lattice.lps_mm_from_uv, vec3(u, v, 0));
    uint8_t row = dose_field_row(field, point);
    if (row == DOSE_NO_ROW)
        return false;
    struct vec3 at = affine_point(&field->rows[row]->grid.ijk_from_lps_mm, point);
    return sample(field->rows[row], at.x, at.y, at.z, trace->plane->lattice.is_by_slice) >= level;
}

/* Finds the jump by halving: a step of the lattice is at most a few univels. */
static double find_jump(const void *context, size_t a, size_t b, double level)
{
    enum { HALVINGS = 12 };
    const struct trace *trace = context;
    size_t width = trace->plane->lattice.size[0];
    double u = (double)(a % width), v = (double)(a / width), du = b == a + 1, dv = 1 - du, low = 0, high = 1;
    bool is_above = trace->plane->values[a] >= level;
    for (int i = 0; i < HALVINGS; i++) {
        double middle = (low + high) / 2;
        if (is_above_at(trace, u + middle * du, v + middle * dv, level) == is_above)
            low = middle;
        else
            high = middle;
    }
    return (low + high) / 2;
}

bool dose_plane_trace(const struct dose_plane *plane, const struct dose_field *field, double level,
                      struct isolines *lines, struct error *err)
{
    const struct isoline_samples samples = { .values = plane->values,
                                             .size = { plane->lattice.size[0], plane->lattice.size[1] },
                                             .kinds = plane->rows,
                                             .jump = find_jump,
                                             .context = &(struct trace){ plane, field } };
    return isolines_trace(&samples, level, lines, err);
}
