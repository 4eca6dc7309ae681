/* Counts and numbers the vertices and triangles of the rows of marching cubes. */
#include "core/surface/marching_rows.h"

#include <pthread.h>

static struct cube_case cases[2][256]; /* [is_mirrored] */
static pthread_once_t cases_once = PTHREAD_ONCE_INIT;

static void make_cases(void)
{
    cube_cases_make(cases[0], false);
    cube_cases_make(cases[1], true);
}

const struct cube_case *marching_rows_cases(const struct affine *lps_mm_from_ijk)
{
    pthread_once(&cases_once, make_cases);
    return cases[affine_determinant(lps_mm_from_ijk) < 0];
}

INLINED void count_slices(struct marching_rows *grid, uint32_t from, uint32_t end)
{
    for (uint32_t z = from; z < end; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            struct around rows = rows_around(grid, y, z);
            struct row sum = { 0 };
            for (uint32_t w = 0; w < grid->words; w++) {
                if (is_uniform(&rows, w))
                    continue;
                struct crossings found = find_crossings(grid, &rows, w);
                sum.x += (uint32_t)__builtin_popcountll(found.x);
                sum.y += (uint32_t)__builtin_popcountll(found.y);
                sum.z += (uint32_t)__builtin_popcountll(found.z);
                for (uint64_t cells = found.active; cells; cells &= cells - 1)
                    sum.triangles += grid->cases[case_at(&rows, w, __builtin_ctzll(cells))].n_triangles;
            }
            grid->rows[(size_t)z * grid->size[1] + y] = sum;
        }
}

#if defined(__x86_64__)
FAST static void count_slices_fast(struct marching_rows *grid, uint32_t from, uint32_t end)
{
    count_slices(grid, from, end);
}
enum marching_cubes_code marching_rows_code(enum marching_cubes_code wanted)
{
    bool has_fast = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("popcnt") &&
                    __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
    return has_fast ? wanted : MARCHING_CUBES_PORTABLE;
}
#else
static void count_slices_fast(struct marching_rows *grid, uint32_t from, uint32_t end)
{
    count_slices(grid, from, end);
}
enum marching_cubes_code marching_rows_code(enum marching_cubes_code wanted)
{
    (void)wanted;
    return MARCHING_CUBES_PORTABLE;
}
#endif

void marching_rows_count(enum marching_cubes_code code, struct marching_rows *grid, uint32_t from, uint32_t end)
{
    if (code == MARCHING_CUBES_PORTABLE)
        count_slices(grid, from, end);
    else
        count_slices_fast(grid, from, end);
}

bool marching_rows_number(struct marching_rows *grid, const struct surface_options *options, struct error *err)
{
    size_t n_rows = (size_t)grid->size[1] * grid->size[2];
    uint64_t vertices = 0, triangles = 0;
    for (size_t at = 0; at <= n_rows; at++) {
        struct row n = grid->rows[at];
        grid->rows[at] = (struct row){ (uint32_t)vertices, (uint32_t)(vertices + n.x), (uint32_t)(vertices + n.x + n.y),
                                       (uint32_t)triangles };
        vertices += (uint64_t)n.x + n.y + n.z;
        triangles += n.triangles;
    }
    if (triangles > options->max_triangles || triangles > UINT32_MAX || vertices > UINT32_MAX)
        return error_set(err, ERROR_LIMIT, "a surface of %llu triangles: at most %zu are allowed",
                         (unsigned long long)triangles,
                         options->max_triangles < UINT32_MAX ? options->max_triangles : (size_t)UINT32_MAX);
    grid->mesh = mesh_create((size_t)vertices, (size_t)triangles, err);
    return grid->mesh != NULL;
}

size_t marching_rows_at_share(const struct marching_rows *grid, size_t n_rows, int part, int n_parts)
{
    if (part == n_parts)
        return n_rows;
    uint64_t wanted = (uint64_t)grid->rows[n_rows].triangles * (uint64_t)part / (uint64_t)n_parts;
    size_t low = 0, high = part ? n_rows : 0;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (grid->rows[middle].triangles < wanted)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}
