/* Extraction of regions of a 256 x 256 x 128 volume, against vtkFlyingEdges3D: the two take turns on the same labels,
 * in one run, and the median of each counts. Ours starts from the labels and includes making the mask; VTK's starts
 * from a ready mask. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/phantom/head.h"
#include "core/region/mask.h"
#include "core/surface/surface.h"
#include "tests/bench/peer.h"

enum { REPEATS = 15, N_SETS = 3, N_VOLUMES = 2 };

static const struct {
    const char *name, *text;
    uint16_t labels[8];
    size_t n;
} sets[N_SETS] = { { "head", "1,2,3,4,5", { 1, 2, 3, 4, 5 }, 5 },
                   { "brain", "3,4,5", { 3, 4, 5 }, 3 },
                   { "tumour", "5", { 5 }, 1 } };
static const char *const volumes[N_VOLUMES] = { "demo plan", "ragged" };

static _Noreturn void die(const char *what, const struct error *err)
{
    fprintf(stderr, "bench_surface: %s: %s\n", what, err ? err->text : "failed");
    exit(1);
}

/* ---- labels ----------------------------------------------------------------------------------------------------- */

static double noise_at_cell(int64_t x, int64_t y, int64_t z)
{
    uint64_t mixed = phantom_mix((uint64_t)(x + 4096) << 42 | (uint64_t)(y + 4096) << 21 | (uint64_t)(z + 4096));
    return (double)(mixed >> 11) / (double)((uint64_t)1 << 53) * 2 - 1;
}

/* Smooth between -1 and 1, changing over cell_mm. */
static double noise(struct vec3 p, double cell_mm)
{
    double x = floor(p.x / cell_mm), y = floor(p.y / cell_mm), z = floor(p.z / cell_mm), sum = 0;
    double fx = p.x / cell_mm - x, fy = p.y / cell_mm - y, fz = p.z / cell_mm - z;
    for (int c = 0; c < 8; c++)
        sum += (c & 1 ? fx : 1 - fx) * (c & 2 ? fy : 1 - fy) * (c & 4 ? fz : 1 - fz) *
               noise_at_cell((int64_t)x + (c & 1), (int64_t)y + (c >> 1 & 1), (int64_t)z + (c >> 2));
    return sum;
}

/* The demo head; ragged: its surfaces pushed about by some millimetres, as hand-drawn or noisy segmentations are. */
static struct volume *make_labels(bool is_ragged)
{
    struct error err = { 0 };
    struct grid grid;
    if (!phantom_image_grid((const uint32_t[3]){ 256, 256, 128 }, &grid, &err))
        die("grid", &err);
    struct volume *labels = volume_create(&grid, VOXEL_U8, &err);
    if (!labels)
        die("labels", &err);
    uint8_t *voxel = labels->voxels;
    for (uint32_t k = 0; k < 128; k++)
        for (uint32_t j = 0; j < 256; j++)
            for (uint32_t i = 0; i < 256; i++) {
                struct vec3 p = affine_point(&grid.lps_mm_from_ijk, vec3(i, j, k));
                double scale = is_ragged ? 1 + 0.03 * noise(p, 11) + 0.02 * noise(p, 4.5) : 1;
                *voxel++ = (uint8_t)phantom_label_at(vec3_scale(p, scale));
            }
    return labels;
}

/* ---- VTK -------------------------------------------------------------------------------------------------------- */

struct vtk {
    struct peer peer;
    char path[PEER_PATH_SIZE];
    char name[2][64]; /* on one thread, on all */
};

static bool vtk_start(struct vtk *vtk, const struct volume *labels)
{
    char size[3][16], line[64], version[16];
    int n_threads;
    if (!peer_write_file(vtk->path, labels->voxels, grid_n_voxels(&labels->grid)))
        die("temporary file", NULL);
    for (size_t axis = 0; axis < 3; axis++)
        snprintf(size[axis], sizeof size[axis], "%u", labels->grid.size[axis]);
    const char *arguments[] = { peer_python(), "tests/bench/vtk_flying_edges.py",
                                vtk->path,     size[0],
                                size[1],       size[2],
                                sets[0].text,  sets[1].text,
                                sets[2].text,  NULL };
    if (!peer_start(&vtk->peer, arguments, line, sizeof line) || sscanf(line, "%15s %d", version, &n_threads) != 2)
        return false;
    snprintf(vtk->name[0], sizeof vtk->name[0], "vtkFlyingEdges3D %s, 1 thread", version);
    snprintf(vtk->name[1], sizeof vtk->name[1], "vtkFlyingEdges3D %s, %d threads", version, n_threads);
    return true;
}

/* 0 without VTK. */
static double vtk_time_ms(struct vtk *vtk, size_t set, bool with_normals, bool on_all, size_t n_triangles)
{
    if (!vtk)
        return 0;
    char question[64], line[128];
    double ms;
    size_t n_theirs;
    snprintf(question, sizeof question, "%zu %d %d\n", set, with_normals, !on_all);
    if (!peer_ask(&vtk->peer, question, line, sizeof line) || sscanf(line, "%lf %zu", &ms, &n_theirs) != 2)
        die("the VTK side", NULL);
    if (n_theirs != n_triangles)
        die("not the same number of triangles as VTK", NULL);
    return ms;
}

/* ---- ours ------------------------------------------------------------------------------------------------------- */

struct times {                                         /* ms */
    double mask, surface, normals, with_normals;       /* surface starts from the labels */
    double vtk, vtk_normals, vtk_all, vtk_all_normals; /* on one thread; on all */
};

static double since_ms(int64_t began_us)
{
    return (double)(clock_now_us() - began_us) / 1e3;
}

static struct times run_once(const struct volume *labels, size_t set, int n_threads, size_t *n_triangles)
{
    struct error err = { 0 };
    struct surface_options options = surface_defaults;
    options.n_threads = n_threads;
    struct times times = { 0 };
    int64_t began = clock_now_us();
    struct mask *mask = mask_from_labels(labels, sets[set].labels, sets[set].n, n_threads, &err);
    times.mask = since_ms(began);
    if (!mask)
        die("mask", &err);
    struct mesh *mesh = surface_marching_cubes(mask, &options, &err);
    times.surface = since_ms(began);
    mask_destroy(mask);
    if (!mesh)
        die("surface", &err);
    began = clock_now_us();
    if (!mesh_make_normals(mesh, n_threads, &err))
        die("normals", &err);
    times.normals = since_ms(began);
    times.with_normals = times.surface + times.normals;
    *n_triangles = mesh->n_triangles;
    mesh_unref(mesh);
    return times;
}

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Spread of one of the numbers in times, by its offset there. */
struct spread {
    double median, fastest;
};

static struct spread spread_of(const struct times all[REPEATS], size_t offset)
{
    double values[REPEATS];
    for (int r = 0; r < REPEATS; r++)
        memcpy(&values[r], (const char *)&all[r] + offset, sizeof values[r]);
    qsort(values, REPEATS, sizeof *values, compare_doubles);
    return (struct spread){ values[REPEATS / 2], values[0] };
}

static void print_result(const char *name, struct spread ours, const char *peer, struct spread theirs,
                         size_t n_triangles)
{
    printf("{\"name\":\"%s\",\"value\":%.3f,\"unit\":\"ms\"", name, ours.median);
    if (peer)
        printf(
            ",\"peer\":\"%s\",\"peer_value\":%.3f,\"ratio\":%.2f,\"note\":\"%zu triangles; fastest %.2f, theirs %.2f\"}\n",
            peer, theirs.median, theirs.median / ours.median, n_triangles, ours.fastest, theirs.fastest);
    else
        printf(",\"note\":\"%zu triangles; fastest %.2f\"}\n", n_triangles, ours.fastest);
    fflush(stdout);
}

static void bench_set(const struct volume *labels, const char *volume, size_t set, struct vtk *vtk)
{
    struct times all[2][REPEATS]; /* on one thread, on two */
    size_t n_triangles = 0;
    for (int repeat = -1; repeat < REPEATS; repeat++) /* the first warms up and does not count */
        for (int two = 0; two < 2; two++) {
            struct times *times = &all[two][repeat < 0 ? 0 : repeat];
            *times = run_once(labels, set, 1 + two, &n_triangles);
            times->vtk = vtk_time_ms(vtk, set, false, false, n_triangles);
            times->vtk_all = vtk_time_ms(vtk, set, false, true, n_triangles);
            times->vtk_normals = vtk_time_ms(vtk, set, true, false, n_triangles);
            times->vtk_all_normals = vtk_time_ms(vtk, set, true, true, n_triangles);
        }
    static const char *const threads[2] = { "1 thread", "2 threads" };
    const char *region = sets[set].name, *one = vtk ? vtk->name[0] : NULL, *every = vtk ? vtk->name[1] : NULL;
    for (size_t two = 0; two < 2; two++) {
        const struct times *times = all[two];
        char name[128];
        struct spread surface = spread_of(times, offsetof(struct times, surface));
        struct spread with_normals = spread_of(times, offsetof(struct times, with_normals));
        struct spread theirs[2] = { spread_of(times, offsetof(struct times, vtk)),
                                    spread_of(times, offsetof(struct times, vtk_all)) };
        snprintf(name, sizeof name, "surface of %s, %s, %s", region, volume, threads[two]);
        print_result(name, surface, two ? every : one, theirs[two], n_triangles);
        if (set > 0)
            continue;
        if (!two)
            print_result(name, surface, every, theirs[1], n_triangles);
        snprintf(name, sizeof name, "surface with normals of %s, %s, %s", region, volume, threads[two]);
        print_result(name, with_normals, two ? every : one,
                     spread_of(times,
                               two ? offsetof(struct times, vtk_all_normals) : offsetof(struct times, vtk_normals)),
                     n_triangles);
        snprintf(name, sizeof name, "of it: mask of %s, %s, %s", region, volume, threads[two]);
        print_result(name, spread_of(times, offsetof(struct times, mask)), NULL, surface, n_triangles);
        snprintf(name, sizeof name, "of it: normals of %s, %s, %s", region, volume, threads[two]);
        print_result(name, spread_of(times, offsetof(struct times, normals)), NULL, surface, n_triangles);
    }
}

int main(void)
{
    for (int v = 0; v < N_VOLUMES; v++) {
        struct volume *labels = make_labels(v == 1);
        struct vtk vtk;
        bool has_vtk = vtk_start(&vtk, labels);
        if (!has_vtk)
            fprintf(stderr, "bench_surface: no VTK for Python here: our times only\n");
        for (size_t set = 0; set < N_SETS; set++)
            bench_set(labels, volumes[v], set, has_vtk ? &vtk : NULL);
        (void)peer_end(&vtk.peer);
        unlink(vtk.path);
        volume_unref(labels);
    }
    return 0;
}
